//! From eigenvalues to numbered modes.

use nalgebra::Complex;
use thiserror::Error;

/// Eigenvalues with |λ| at most this share of max |λ| are rigid-body motion. Fourfold zero eigenvalues come out of the
/// solver at about 1e-8 max |λ|.
const RIGID: f64 = 1e-6;

/// Imaginary parts at most this share of |λ| are rounding: the eigenvalue is real.
const REAL: f64 = 1e-9;

/// Frequencies that differ by at most this share of max |λ| are equal but for rounding; the growth rate then decides
/// the order, as it does for an undamped pair in flutter.
const EQUAL_FREQUENCY: f64 = 1e-12;

/// Why eigenvalues could not be sorted into modes.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SpectrumError {
    /// Every eigenvalue is zero: there is nothing that could be unstable.
    #[error("all eigenvalues are zero: the system has only rigid-body motion")]
    OnlyRigid,
    /// A mode was asked for that does not exist.
    #[error("mode {mode} was asked for, but only {count} modes oscillate; modes are numbered by frequency from 1")]
    NoSuchMode {
        /// Rank asked for, from 1.
        mode: usize,
        /// Number of oscillating modes.
        count: usize,
    },
}

/// The eigenvalues of one direct computation.
///
/// # Examples
///
/// ```
/// use nalgebra::Complex;
/// use pcc_compile::mechanics::spectrum::Spectrum;
/// let pair = |re: f64, im: f64| [Complex::new(re, im), Complex::new(re, -im)];
/// let spectrum = Spectrum::new(&[pair(0.5, 20.0), pair(-0.1, 10.0)].concat())?;
/// assert_eq!(spectrum.mode(1)?, Complex::new(-0.1, 10.0));
/// assert_eq!(spectrum.max_re(), 0.5);
/// # Ok::<(), pcc_compile::mechanics::spectrum::SpectrumError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    all: Vec<Complex<f64>>,
    rigid_body_modes: usize,
    eigenvalues: Vec<Complex<f64>>,
    oscillating: Vec<Complex<f64>>,
    top: Complex<f64>,
    largest: f64,
}

impl Spectrum {
    /// Sorts eigenvalues, in 1/s: rigid-body zeros (|λ| ≤ 10⁻⁶ max |λ|) are dropped, one of each conjugate pair becomes
    /// a mode, modes are ranked by Im λ. A mode whose conjugate is not given has one all the same.
    ///
    /// # Errors
    ///
    /// [`SpectrumError::OnlyRigid`] if no eigenvalue remains.
    pub fn new(eigenvalues: &[Complex<f64>]) -> Result<Self, SpectrumError> {
        let largest = eigenvalues.iter().map(|lambda| lambda.norm()).fold(0.0, f64::max);
        let rigid = eigenvalues.iter().filter(|lambda| lambda.norm() <= RIGID * largest).count();
        Self::without_rigid_body(eigenvalues.to_vec(), rigid)
    }

    /// The same eigenvalues with so many of them dropped as rigid-body motion, those with the smallest |λ|.
    ///
    /// # Errors
    ///
    /// As [`Spectrum::new`].
    pub fn with_rigid_body_modes(self, count: usize) -> Result<Self, SpectrumError> {
        if count == self.rigid_body_modes { Ok(self) } else { Self::without_rigid_body(self.all, count) }
    }

    fn without_rigid_body(all: Vec<Complex<f64>>, rigid_body_modes: usize) -> Result<Self, SpectrumError> {
        let largest = all.iter().map(|lambda| lambda.norm()).fold(0.0, f64::max);
        let kept = without_smallest(&all, rigid_body_modes);
        let larger = |a: Complex<f64>, b: Complex<f64>| if b.re > a.re { b } else { a };
        let top = kept.iter().copied().reduce(larger).ok_or(SpectrumError::OnlyRigid)?;
        let is_real = |lambda: &Complex<f64>| lambda.im.abs() <= REAL * lambda.norm();
        let mut oscillating: Vec<_> =
            kept.iter().filter(|lambda| lambda.im > 0.0 && !is_real(lambda)).copied().collect();
        oscillating.sort_by(|a, b| a.im.total_cmp(&b.im).then(a.re.total_cmp(&b.re)));
        for k in 1..oscillating.len() {
            let (before, after) = (oscillating[k - 1], oscillating[k]);
            if after.im - before.im <= EQUAL_FREQUENCY * largest && after.re < before.re {
                oscillating.swap(k - 1, k);
            }
        }
        let reals = kept.iter().filter(|lambda| is_real(lambda)).map(|lambda| Complex::new(lambda.re, 0.0));
        // A pair is one entry until all are sorted.
        let mut halves: Vec<_> = oscillating.iter().copied().chain(reals).collect();
        halves.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        let both = |lambda: Complex<f64>| match lambda.im == 0.0 {
            true => vec![lambda],
            false => vec![lambda, lambda.conj()],
        };
        let eigenvalues = halves.into_iter().flat_map(both).collect();
        let top = if is_real(&top) { Complex::new(top.re, 0.0) } else { top };
        Ok(Self { all, rigid_body_modes, eigenvalues, oscillating, top, largest })
    }

    /// The eigenvalues that are no rigid-body motion, one of each conjugate pair: enough to make the spectrum again.
    pub fn halves(&self) -> impl Iterator<Item = Complex<f64>> {
        self.eigenvalues.iter().copied().filter(|lambda| lambda.im >= 0.0)
    }

    /// The spectrum with these [`Spectrum::halves`].
    ///
    /// # Errors
    ///
    /// [`SpectrumError::OnlyRigid`] if there are none.
    pub fn from_halves(halves: &[Complex<f64>]) -> Result<Self, SpectrumError> {
        let both = |&lambda: &Complex<f64>| match lambda.im == 0.0 {
            true => vec![lambda],
            false => vec![lambda, lambda.conj()],
        };
        Self::without_rigid_body(halves.iter().flat_map(both).collect(), 0)
    }

    /// Number of eigenvalues that were dropped as rigid-body motion.
    pub fn rigid_body_modes(&self) -> usize {
        self.rigid_body_modes
    }

    /// All eigenvalues that are no rigid-body motion, by |λ|. Conjugates are exact and side by side, that with Im λ > 0
    /// first; real ones have Im λ = 0 exactly.
    pub fn eigenvalues(&self) -> &[Complex<f64>] {
        &self.eigenvalues
    }

    /// The position of the conjugate of the eigenvalue at `position` of [`Spectrum::eigenvalues`]: its own, if it is
    /// real.
    pub fn conjugate(&self, position: usize) -> usize {
        let im = self.eigenvalues[position].im;
        if im > 0.0 {
            position + 1
        } else if im < 0.0 {
            position - 1
        } else {
            position
        }
    }

    /// Number of oscillating modes.
    pub fn count(&self) -> usize {
        self.oscillating.len()
    }

    /// The eigenvalue of the mode with frequency rank `mode`, from 1.
    ///
    /// # Errors
    ///
    /// [`SpectrumError::NoSuchMode`].
    pub fn mode(&self, mode: usize) -> Result<Complex<f64>, SpectrumError> {
        mode.checked_sub(1)
            .and_then(|at| self.oscillating.get(at))
            .copied()
            .ok_or(SpectrumError::NoSuchMode { mode, count: self.count() })
    }

    /// The eigenvalues of all modes, by frequency rank.
    pub fn oscillating(&self) -> &[Complex<f64>] {
        &self.oscillating
    }

    /// max |λ|, in 1/s: the scale of rounding errors in all eigenvalues.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// Spectral abscissa max Re λ over every eigenvalue that is not a rigid-body zero, real ones included, in 1/s. The
    /// system is stable if it is negative.
    pub fn max_re(&self) -> f64 {
        self.top.re
    }

    /// The eigenvalue with the largest Re λ. Unstable systems diverge if it is real, and flutter if it is not.
    pub fn top(&self) -> Complex<f64> {
        self.top
    }
}

/// All eigenvalues but so many with the smallest |λ|, in their order.
pub(super) fn without_smallest(all: &[Complex<f64>], count: usize) -> Vec<Complex<f64>> {
    let mut by_size: Vec<usize> = (0..all.len()).collect();
    by_size.sort_by(|&a, &b| all[a].norm().total_cmp(&all[b].norm()).then(a.cmp(&b)));
    let mut kept = by_size.split_off(count.min(all.len()));
    kept.sort_unstable();
    kept.into_iter().map(|at| all[at]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spectrum(parts: &[(f64, f64)]) -> Spectrum {
        Spectrum::new(&parts.iter().map(|&(re, im)| Complex::new(re, im)).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn rigid_zeros_are_no_modes_and_do_not_decide_stability() {
        let spectrum = spectrum(&[(1e-9, 0.0), (0.0, 1e-8), (0.0, -1e-8), (-1.0, 100.0), (-1.0, -100.0)]);
        assert_eq!((spectrum.count(), spectrum.max_re()), (1, -1.0));
    }

    #[test]
    fn real_eigenvalues_decide_stability_without_being_modes() {
        let spectrum = spectrum(&[(2.0, 0.0), (-2.0, 0.0), (-1.0, 100.0), (-1.0, -100.0)]);
        assert_eq!((spectrum.count(), spectrum.max_re()), (1, 2.0));
    }

    #[test]
    fn equal_frequencies_are_ranked_by_growth_rate() {
        for rounding in [-1e-11, 1e-11] {
            let found = spectrum(&[(5.0, 100.0 + rounding), (5.0, -100.0), (-5.0, 100.0), (-5.0, -100.0)]);
            assert_eq!((found.mode(1).unwrap().re, found.mode(2).unwrap().re), (-5.0, 5.0));
        }
    }

    #[test]
    fn missing_modes_are_reported() {
        let spectrum = spectrum(&[(-1.0, 100.0), (-1.0, -100.0)]);
        assert_eq!(spectrum.mode(2), Err(SpectrumError::NoSuchMode { mode: 2, count: 1 }));
        assert_eq!(spectrum.mode(0), Err(SpectrumError::NoSuchMode { mode: 0, count: 1 }));
        assert_eq!(Spectrum::new(&[]), Err(SpectrumError::OnlyRigid));
        assert_eq!(Spectrum::new(&[Complex::new(0.0, 0.0); 4]), Err(SpectrumError::OnlyRigid));
    }

    #[test]
    fn conjugates_stand_side_by_side_and_real_ones_are_exact() {
        let found = spectrum(&[(-1.0, 20.0), (-1.0, -20.0), (3.0, 1e-12), (-5.0, 4.0), (-5.0, -4.0), (-30.0, 0.0)]);
        let expected = [(3.0, 0.0), (-5.0, 4.0), (-5.0, -4.0), (-1.0, 20.0), (-1.0, -20.0), (-30.0, 0.0)];
        assert_eq!(found.eigenvalues(), expected.map(|(re, im)| Complex::new(re, im)));
        assert_eq!((0..6).map(|at| found.conjugate(at)).collect::<Vec<_>>(), [0, 2, 1, 4, 3, 5]);
        assert_eq!(found.top(), Complex::new(3.0, 0.0));
    }

    #[test]
    fn rigid_body_motion_can_be_counted_elsewhere() {
        let pair = [(-1.0, 100.0), (-1.0, -100.0)];
        let slow = spectrum(&[pair.as_slice(), &[(1e-9, 0.0), (1e-5, 0.0)]].concat());
        assert_eq!((slow.rigid_body_modes(), slow.max_re()), (2, -1.0));
        let all = slow.with_rigid_body_modes(1).unwrap();
        assert_eq!((all.eigenvalues().len(), all.max_re()), (3, 1e-5));
    }
}
