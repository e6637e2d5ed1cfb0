//! Which modes belong together: groups of neighbours in frequency that come close somewhere on a design.
//!
//! Where two eigenvalues come close, each alone changes fast with the inputs, and like a square root where they
//! coalesce; the symmetric functions of both stay smooth. A gap between neighbours that closes to a small share of what
//! it is elsewhere is the sign of it. The same holds for a mode and its own conjugate near the real axis, and for
//! rigid-body motion, but there no group of oscillating modes can be formed: that is reported.

use super::modes::Spectrum;
use pcc_evaluate::components::MOST_MODES;
use thiserror::Error;

/// Neighbours whose frequencies come closer than this share of the largest distance |λ_{k+1} − λ_k| on the design
/// belong together. The coalescing pair of the clutch reaches 10⁻³, its next neighbours stay above 0.8.
pub const CLOSE: f64 = 0.2;

/// A mode whose frequency falls below this share of its largest on the design cannot be told from its conjugate.
const NEAR_REAL_AXIS: f64 = 0.05;

/// Why modes could not be grouped. `at` is the position of the spectrum that shows it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ClusterError {
    /// A list of modes has some of a group, but not all.
    #[error(
        "modes {listed} and {missing} touch ({first:.6} and {second:.6} rad/s) and belong together, but only mode \
         {listed} is listed; use modes = {smallest:?}, or leave {listed} out as well"
    )]
    Split {
        /// The mode in the list.
        listed: usize,
        /// The mode that is not.
        missing: usize,
        /// The smallest list that has all that the given one has, and splits nothing.
        smallest: Vec<usize>,
        /// Frequency of the lower one.
        first: f64,
        /// Frequency of the upper one.
        second: f64,
        /// Where.
        at: usize,
    },
    /// More modes come close than can be told apart again.
    #[error(
        "modes {first} to {last} all touch one another in turn, more than {MOST_MODES}; use target = \"eigenvalues\" or \
         narrow the inputs"
    )]
    TooMany {
        /// The lowest mode of the group.
        first: usize,
        /// The highest.
        last: usize,
    },
    /// A mode comes too close to the real axis.
    #[error(
        "mode {mode} slows down to {frequency:.6} rad/s, a small part of its {largest:.6} rad/s elsewhere: it cannot be \
         separated from its conjugate or from rigid-body motion; use target = \"eigenvalues\" or narrow the inputs"
    )]
    NearRealAxis {
        /// The mode.
        mode: usize,
        /// Its lowest frequency.
        frequency: f64,
        /// Its highest frequency.
        largest: f64,
        /// Where it is lowest.
        at: usize,
    },
}

/// A list of modes and all that touch one of them, and so on; entry k of `touching` is of modes k + 1 and k + 2.
fn with_all_that_touch(modes: &[usize], touching: &[Option<usize>]) -> Vec<usize> {
    let mut smallest = modes.to_vec();
    let links = || touching.iter().enumerate().filter(|(_, at)| at.is_some()).map(|(k, _)| [k + 1, k + 2]);
    // Upwards, then downwards: links are between neighbours.
    for [lower, upper] in links() {
        if smallest.contains(&lower) && !smallest.contains(&upper) {
            smallest.push(upper);
        }
    }
    for [lower, upper] in links().collect::<Vec<_>>().into_iter().rev() {
        if smallest.contains(&upper) && !smallest.contains(&lower) {
            smallest.push(lower);
        }
    }
    smallest.sort_unstable();
    smallest
}

/// Groups the modes with the given ranks, ascending, by the spectra of a design. All spectra have as many modes.
///
/// # Errors
///
/// [`ClusterError`].
///
/// # Examples
///
/// ```
/// use nalgebra::Complex;
/// use pcc_compile::mechanics::spectrum::{clusters, Spectrum};
/// let spectrum = |a: f64, b: f64, c: f64| Spectrum::new(&[a, b, c].map(|im| Complex::new(-1.0, im))).unwrap();
/// let design = [spectrum(10.0, 50.0, 60.0), spectrum(11.0, 54.9, 55.0)];
/// assert_eq!(clusters(&design, &[1, 2, 3])?, [vec![1], vec![2, 3]]);
/// # Ok::<(), pcc_compile::mechanics::spectrum::ClusterError>(())
/// ```
pub fn clusters(spectra: &[Spectrum], modes: &[usize]) -> Result<Vec<Vec<usize>>, ClusterError> {
    let count = spectra.iter().map(Spectrum::count).min().unwrap_or(0);
    let touching: Vec<Option<usize>> = (1..count).map(|mode| where_close(spectra, mode)).collect();
    for (k, at) in touching.iter().enumerate().filter_map(|(k, at)| at.map(|at| (k, at))) {
        let (lower, upper) = (k + 1, k + 2);
        let frequency = |mode: usize| spectra[at].oscillating()[mode - 1].im;
        let (has_lower, has_upper) = (modes.contains(&lower), modes.contains(&upper));
        if has_lower != has_upper {
            let (listed, missing) = if has_lower { (lower, upper) } else { (upper, lower) };
            let smallest = with_all_that_touch(modes, &touching);
            let (first, second) = (frequency(lower), frequency(upper));
            return Err(ClusterError::Split { listed, missing, smallest, first, second, at });
        }
    }
    modes.iter().filter(|&&mode| mode <= count).try_for_each(|&mode| off_the_real_axis(spectra, mode))?;
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for &mode in modes {
        let joins = mode > 1 && touching.get(mode - 2).is_some_and(Option::is_some);
        match groups.last_mut() {
            Some(group) if joins => group.push(mode),
            _ => groups.push(vec![mode]),
        }
    }
    match groups.iter().find(|group| group.len() > MOST_MODES) {
        Some(group) => Err(ClusterError::TooMany { first: group[0], last: group[group.len() - 1] }),
        None => Ok(groups),
    }
}

/// The spectrum in which `mode` and the next are closest, if that is close.
fn where_close(spectra: &[Spectrum], mode: usize) -> Option<usize> {
    let pair = |spectrum: &Spectrum| (spectrum.oscillating()[mode - 1], spectrum.oscillating()[mode]);
    let gap = |spectrum: &Spectrum| pair(spectrum).1.im - pair(spectrum).0.im;
    let largest = spectra.iter().map(|spectrum| (pair(spectrum).1 - pair(spectrum).0).norm()).fold(0.0, f64::max);
    let (at, smallest) = spectra.iter().map(gap).enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (smallest < CLOSE * largest).then_some(at)
}

fn off_the_real_axis(spectra: &[Spectrum], mode: usize) -> Result<(), ClusterError> {
    let frequency = |spectrum: &Spectrum| spectrum.oscillating()[mode - 1].im;
    let largest = spectra.iter().map(frequency).fold(0.0, f64::max);
    let lowest = spectra.iter().map(frequency).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    match lowest {
        Some((at, frequency)) if frequency < NEAR_REAL_AXIS * largest => {
            Err(ClusterError::NearRealAxis { mode, frequency, largest, at })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    fn spectrum(frequencies: &[f64]) -> Spectrum {
        Spectrum::new(&frequencies.iter().map(|&im| Complex::new(-1.0, im)).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn chains_of_touching_neighbours_form_one_group() {
        let design = [spectrum(&[10.0, 11.0, 20.0, 50.0]), spectrum(&[10.0, 19.0, 20.0, 50.0])];
        assert_eq!(clusters(&design, &[1, 2, 3, 4]).unwrap(), [vec![1, 2, 3], vec![4]]);
        assert_eq!(clusters(&design[..1], &[1, 2, 3, 4]).unwrap(), [vec![1], vec![2], vec![3], vec![4]]);
    }

    #[test]
    fn a_list_may_leave_out_groups_but_not_parts_of_them() {
        let design = [spectrum(&[10.0, 20.0, 30.0]), spectrum(&[10.0, 20.0, 21.0])];
        assert_eq!(clusters(&design, &[1]).unwrap(), [vec![1]]);
        assert_eq!(clusters(&design, &[2, 3]).unwrap(), [vec![2, 3]]);
        let smallest = vec![1, 2, 3];
        let error = ClusterError::Split { listed: 3, missing: 2, smallest, first: 20.0, second: 21.0, at: 1 };
        assert_eq!(clusters(&design, &[1, 3]), Err(error));
        let chain = [Some(0), Some(0), None, Some(0)];
        assert_eq!(with_all_that_touch(&[2], &chain), [1, 2, 3]);
        assert_eq!(with_all_that_touch(&[1, 5], &chain), [1, 2, 3, 4, 5]);
    }

    #[test]
    fn groups_that_no_polynomial_can_carry_are_refused() {
        let apart: Vec<f64> = (1..=20).map(|k| 10.0 * f64::from(k)).collect();
        let close: Vec<f64> = (1..=20).map(|k| 100.0 + 0.1 * f64::from(k)).collect();
        let modes: Vec<usize> = (1..=20).collect();
        let found = clusters(&[spectrum(&apart), spectrum(&close)], &modes);
        assert_eq!(found, Err(ClusterError::TooMany { first: 1, last: 20 }));
    }

    #[test]
    fn modes_that_almost_stop_oscillating_are_reported() {
        let design = [spectrum(&[10.0, 20.0]), spectrum(&[0.1, 20.0])];
        let error = ClusterError::NearRealAxis { mode: 1, frequency: 0.1, largest: 10.0, at: 1 };
        assert_eq!(clusters(&design, &[1, 2]), Err(error));
        assert_eq!(clusters(&design, &[2]).unwrap(), [vec![2]]);
    }
}
