//! From eigenvalues to numbered modes.

use nalgebra::Complex;
use thiserror::Error;

/// Eigenvalues with |λ| at most this share of max |λ| are rigid-body motion, and imaginary parts at most this share are
/// no oscillation. Fourfold zero eigenvalues come out of the solver at about 1e-8 max |λ|.
const NEGLIGIBLE: f64 = 1e-6;

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

/// The modes of one direct computation.
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
    oscillating: Vec<Complex<f64>>,
    max_re: f64,
    largest: f64,
}

impl Spectrum {
    /// Sorts eigenvalues, in 1/s: rigid-body zeros (|λ| ≤ 10⁻⁶ max |λ|) are dropped, one of each conjugate pair with
    /// Im λ > 10⁻⁶ max |λ| becomes a mode, modes are ranked by Im λ.
    ///
    /// # Errors
    ///
    /// [`SpectrumError::OnlyRigid`] if no eigenvalue remains.
    pub fn new(eigenvalues: &[Complex<f64>]) -> Result<Self, SpectrumError> {
        let largest = eigenvalues.iter().map(|lambda| lambda.norm()).fold(0.0, f64::max);
        let threshold = NEGLIGIBLE * largest;
        let max_re = eigenvalues
            .iter()
            .filter(|lambda| lambda.norm() > threshold)
            .map(|lambda| lambda.re)
            .reduce(f64::max)
            .ok_or(SpectrumError::OnlyRigid)?;
        let mut oscillating: Vec<_> = eigenvalues.iter().filter(|lambda| lambda.im > threshold).copied().collect();
        oscillating.sort_by(|a, b| a.im.total_cmp(&b.im).then(a.re.total_cmp(&b.re)));
        for k in 1..oscillating.len() {
            let (before, after) = (oscillating[k - 1], oscillating[k]);
            if after.im - before.im <= EQUAL_FREQUENCY * largest && after.re < before.re {
                oscillating.swap(k - 1, k);
            }
        }
        Ok(Self { oscillating, max_re, largest })
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
        self.max_re
    }
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
}
