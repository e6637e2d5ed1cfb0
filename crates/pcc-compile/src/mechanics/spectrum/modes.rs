//! From eigenvalues to numbered modes.

use super::printed_digits::printed_errors;
use super::solution::without_smallest;
use crate::numerics::accuracy::Accuracy;
use nalgebra::Complex;
use pcc_evaluate::components::{Margin, Top, Verdict, beyond_rounding};
use thiserror::Error;

/// Eigenvalues with |λ| at most this share of max |λ| are rigid-body motion. Fourfold zero eigenvalues come out of the
/// solver at about 1e-8 max |λ|.
const RIGID: f64 = 1e-6;

/// Eigenvalues that a study calls zero may be up to this share of the next: matrices with few digits leave them some
/// stiffness.
const CLEARLY_SMALLER: f64 = 1e-2;

/// Bounds of errors are taken at their word up to this share of |λ|, and up to this share of the largest |λ|: they are
/// of first order, and grow beyond all measure where eigenvalues coalesce.
const KNOWN: f64 = 1e-6;
const KNOWN_BESIDE: f64 = 1e-9;

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
    /// The study says how much is rigid-body motion, and the spectrum says otherwise.
    #[error(
        "spectrum.rigid_body_modes = {stated}, but {found}; {stated} eigenvalues are to be zero and no more: correct the number, or \
         leave it out, so that it is found by structure"
    )]
    RigidBodyModes {
        /// Number in the study.
        stated: usize,
        /// What was found.
        found: String,
    },
    /// A mode was asked for that does not exist.
    #[error(
        "spectrum.modes: mode {mode} was asked for, but only {count} modes oscillate; modes are numbered by frequency from 1"
    )]
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
    /// Of all of them.
    all_accuracies: Vec<Accuracy>,
    rigid_body_modes: usize,
    margin: Margin,
    /// Error of each eigenvalue at least, as a share of |λ|.
    noise: f64,
    /// Whether the eigenvalues were rounded to few digits.
    is_rounded: bool,
    eigenvalues: Vec<Complex<f64>>,
    accuracies: Vec<Accuracy>,
    oscillating: Vec<Complex<f64>>,
    top: Top,
    largest: f64,
}

impl Spectrum {
    /// Sorts eigenvalues, in 1/s: rigid-body zeros (|λ| ≤ 10⁻⁶ max |λ|) are dropped, one of each conjugate pair becomes
    /// a mode, modes are ranked by Im λ. A mode whose conjugate is not given has one all the same. They are taken to be
    /// as accurate as a solver can make them.
    ///
    /// # Errors
    ///
    /// [`SpectrumError::OnlyRigid`] if no eigenvalue remains.
    pub fn new(eigenvalues: &[Complex<f64>]) -> Result<Self, SpectrumError> {
        Self::with_zeros(eigenvalues, &[], Self::negligible(eigenvalues), Margin::default())
    }

    /// The same of eigenvalues of known accuracy, none if it is not known, which are judged with a margin: growth rates
    /// that cannot be told from zero are zero. So many are dropped as rigid-body motion, those with the smallest |λ|.
    ///
    /// # Errors
    ///
    /// As [`Spectrum::new`].
    pub fn with_zeros(
        eigenvalues: &[Complex<f64>],
        accuracies: &[Accuracy],
        rigid_body_modes: usize,
        margin: Margin,
    ) -> Result<Self, SpectrumError> {
        let accuracies = if accuracies.len() == eigenvalues.len() { accuracies } else { &[] };
        Self::without_rigid_body(eigenvalues.to_vec(), accuracies.to_vec(), rigid_body_modes, (margin, 0.0))
    }

    /// The same eigenvalues, each with an error of this share of |λ| at least, as the model's answers carry noise.
    ///
    /// # Errors
    ///
    /// As [`Spectrum::new`].
    pub fn with_noise(self, noise: f64) -> Result<Self, SpectrumError> {
        match noise == self.noise {
            true => Ok(self),
            false => {
                Self::without_rigid_body(self.all, self.all_accuracies, self.rigid_body_modes, (self.margin, noise))
            }
        }
    }

    /// How many of these eigenvalues are negligible beside the largest.
    pub fn negligible(eigenvalues: &[Complex<f64>]) -> usize {
        let sizes: Vec<f64> = eigenvalues.iter().map(|lambda| lambda.norm()).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        sizes.into_iter().filter(|&size| size <= RIGID * largest).count()
    }

    /// The same eigenvalues with so many of them dropped as rigid-body motion, those with the smallest |λ|.
    ///
    /// # Errors
    ///
    /// As [`Spectrum::new`].
    pub fn with_rigid_body_modes(self, count: usize) -> Result<Self, SpectrumError> {
        match count == self.rigid_body_modes {
            true => Ok(self),
            false => Self::without_rigid_body(self.all, self.all_accuracies, count, (self.margin, self.noise)),
        }
    }

    fn without_rigid_body(
        all: Vec<Complex<f64>>,
        all_accuracies: Vec<Accuracy>,
        rigid_body_modes: usize,
        (margin, noise): (Margin, f64),
    ) -> Result<Self, SpectrumError> {
        let sizes: Vec<f64> = all.iter().map(|lambda| lambda.norm()).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let least = Accuracy::least(largest);
        // First-order bounds of eigenvalues that are nearly defective say nothing.
        let meaningful = |error: f64, size: f64| error <= KNOWN * size || error <= KNOWN_BESIDE * largest;
        let printed = if all_accuracies.is_empty() { printed_errors(&all) } else { None };
        let accuracy = |at: usize| {
            let Accuracy { re, whole } = all_accuracies.get(at).copied().unwrap_or(least);
            let or_least = |error: f64| if meaningful(error, sizes[at]) { error } else { least.whole };
            let rounded = printed.as_ref().map_or(Accuracy::default(), |errors| errors[at]);
            let known = [or_least(re).max(rounded.re), or_least(whole).max(rounded.whole)]
                .map(|error| error.max(noise * sizes[at]));
            Accuracy { re: known[0], whole: known[1] }
        };
        let one = |at: usize| Eigenvalue::new(all[at], sizes[at], accuracy(at));
        let mut kept = without_smallest(&sizes, rigid_body_modes);
        // A pair is not cut in two.
        let is_whole = |kept: &[usize]| {
            let has = |lambda: Complex<f64>| kept.iter().any(|&at| all[at] == lambda);
            let is_cut = |at: &usize| all[*at].im < 0.0 && all.contains(&all[*at].conj()) && !has(all[*at].conj());
            !kept.iter().any(is_cut)
        };
        let mut rigid_body_modes = rigid_body_modes;
        if rigid_body_modes % 2 == 1 && !is_whole(&kept) {
            rigid_body_modes -= 1;
            kept = without_smallest(&sizes, rigid_body_modes);
        }
        let kept: Vec<Eigenvalue> = kept.into_iter().map(one).collect();
        let top = top(&kept, margin).ok_or(SpectrumError::OnlyRigid)?;
        let mut oscillating: Vec<&Eigenvalue> = kept.iter().filter(|one| one.lambda.im > 0.0).collect();
        oscillating.sort_by(|a, b| a.lambda.im.total_cmp(&b.lambda.im).then(a.lambda.re.total_cmp(&b.lambda.re)));
        for k in 1..oscillating.len() {
            let (before, after) = (oscillating[k - 1].lambda, oscillating[k].lambda);
            if after.im - before.im <= EQUAL_FREQUENCY * largest && after.re < before.re {
                oscillating.swap(k - 1, k);
            }
        }
        let ranked = oscillating.iter().map(|one| one.lambda).collect();
        // A pair is one entry until all are sorted.
        let mut halves = oscillating;
        halves.extend(kept.iter().filter(|one| one.lambda.im == 0.0));
        halves.sort_by(|a, b| a.size.total_cmp(&b.size));
        let (mut eigenvalues, mut accuracies) = (Vec::with_capacity(kept.len()), Vec::with_capacity(kept.len()));
        for one in halves {
            eigenvalues.push(one.lambda);
            accuracies.push(one.accuracy);
            if one.lambda.im != 0.0 {
                eigenvalues.push(one.lambda.conj());
                accuracies.push(one.accuracy);
            }
        }
        Ok(Self {
            eigenvalues,
            accuracies,
            oscillating: ranked,
            all,
            all_accuracies,
            rigid_body_modes,
            margin,
            noise,
            is_rounded: printed.is_some(),
            top,
            largest,
        })
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
        let all: Vec<Complex<f64>> = halves.iter().flat_map(both).collect();
        let accuracies = vec![Accuracy::default(); all.len()];
        Self::without_rigid_body(all, accuracies, 0, (Margin::default(), 0.0))
    }

    /// Why so many of these eigenvalues cannot all be rigid-body motion, those with the smallest |λ|; `None` if they
    /// can.
    pub fn contradiction(eigenvalues: &[Complex<f64>], rigid_body_modes: usize) -> Option<String> {
        let mut sizes: Vec<f64> = eigenvalues.iter().map(|lambda| lambda.norm()).collect();
        sizes.sort_by(f64::total_cmp);
        let Some(&next) = sizes.get(rigid_body_modes) else {
            return Some(format!("there are only {} eigenvalues", sizes.len()));
        };
        let largest = sizes.last().copied().unwrap_or(0.0);
        let largest_zero = rigid_body_modes.checked_sub(1).map_or(0.0, |last| sizes[last]);
        let is_zero = largest_zero <= RIGID * largest || largest_zero <= CLEARLY_SMALLER * next;
        (!is_zero).then(|| {
            format!("the eigenvalues with the smallest |λ| reach {largest_zero:.3e} 1/s and the next is {next:.3e} 1/s")
        })
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

    /// The accuracy of every one of [`Spectrum::eigenvalues`].
    pub fn accuracies(&self) -> &[Accuracy] {
        &self.accuracies
    }

    /// What the eigenvalue at a position says of stability.
    pub fn verdict_at(&self, position: usize) -> Verdict {
        let lambda = self.eigenvalues[position];
        let error = error_of_excess(self.margin, &self.accuracies[position]);
        Verdict::of(beyond_rounding(self.margin.excess(lambda), error), lambda.im)
    }

    /// Whether the accuracy of an eigenvalue was looked at, and is not just what no solver avoids.
    pub fn is_accuracy_known(&self, position: usize) -> bool {
        self.accuracies[position] != Accuracy::least(self.largest)
    }

    /// Whether the eigenvalues came with so few digits that they tell how far off they may be.
    pub fn is_rounded(&self) -> bool {
        self.is_rounded
    }

    /// Spectral abscissa max Re λ over every eigenvalue that is not a rigid-body zero, real ones included, in 1/s.
    pub fn max_re(&self) -> f64 {
        self.top.max_re
    }

    /// What decides on stability: of all eigenvalues that are no rigid-body motion the one with the largest excess, Re
    /// λ with the margin.
    pub fn top(&self) -> Top {
        self.top
    }

    /// Whether all eigenvalues lie on the imaginary axis or symmetric to it, as far as can be told.
    pub fn is_undamped(&self) -> bool {
        let all = || self.eigenvalues.iter().zip(&self.accuracies);
        let mirrors = |(lambda, own): (&Complex<f64>, &Accuracy)| {
            all().any(|(other, accuracy)| (lambda + other.conj()).norm() <= own.whole + accuracy.whole)
        };
        all().all(mirrors)
    }

    /// The largest error of an excess that cannot be told from zero, in 1/s, if there is one that decides.
    pub fn marginal_error(&self) -> Option<f64> {
        let error = |accuracy: &Accuracy| error_of_excess(self.margin, accuracy);
        let is_marginal = |lambda: &Complex<f64>, accuracy: &Accuracy| {
            beyond_rounding(self.margin.excess(*lambda), error(accuracy)) == 0.0
        };
        let decides = self.eigenvalues.iter().zip(&self.accuracies).filter(|(lambda, own)| is_marginal(lambda, own));
        decides.map(|(_, accuracy)| error(accuracy)).reduce(f64::max).filter(|_| self.top.excess == 0.0)
    }
}

/// Whether an eigenvalue is real but for rounding.
pub(super) fn is_nearly_real(lambda: Complex<f64>) -> bool {
    lambda.im.abs() <= REAL * lambda.norm()
}

/// One eigenvalue: real if it is nearly so, on the imaginary axis if it cannot be told from it.
#[derive(Debug, Clone, Copy)]
struct Eigenvalue {
    lambda: Complex<f64>,
    /// |λ|, as it was solved.
    size: f64,
    accuracy: Accuracy,
}

impl Eigenvalue {
    fn new(lambda: Complex<f64>, size: f64, accuracy: Accuracy) -> Self {
        let im = if lambda.im.abs() <= REAL * size { 0.0 } else { lambda.im };
        Self { lambda: Complex::new(beyond_rounding(lambda.re, accuracy.re), im), size, accuracy }
    }
}

/// What decides, and by how much: nothing, where that is less than the accuracy of its growth rate.
fn top(eigenvalues: &[Eigenvalue], margin: Margin) -> Option<Top> {
    let excess = |one: &Eigenvalue| beyond_rounding(margin.excess(one.lambda), error_of_excess(margin, &one.accuracy));
    let larger = |a: Eigenvalue, b: Eigenvalue| if excess(&b) > excess(&a) { b } else { a };
    let decides = eigenvalues.iter().copied().reduce(larger)?;
    let max_re = eigenvalues.iter().map(|one| one.lambda.re).fold(f64::NEG_INFINITY, f64::max);
    Some(Top { max_re, excess: excess(&decides), frequency: decides.lambda.im })
}

/// How far the excess of an eigenvalue of this accuracy may be off: Re λ, and with a damping ratio ζ also ζ|λ|.
fn error_of_excess(margin: Margin, accuracy: &Accuracy) -> f64 {
    match margin {
        Margin::GrowthRate(_) => accuracy.re,
        Margin::DampingRatio(ratio) => accuracy.re + ratio * accuracy.whole,
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

    #[test]
    fn conjugates_stand_side_by_side_and_real_ones_are_exact() {
        let found = spectrum(&[(-1.0, 20.0), (-1.0, -20.0), (3.0, 1e-12), (-5.0, 4.0), (-5.0, -4.0), (-30.0, 0.0)]);
        let expected = [(3.0, 0.0), (-5.0, 4.0), (-5.0, -4.0), (-1.0, 20.0), (-1.0, -20.0), (-30.0, 0.0)];
        assert_eq!(found.eigenvalues(), expected.map(|(re, im)| Complex::new(re, im)));
        assert_eq!((0..6).map(|at| found.conjugate(at)).collect::<Vec<_>>(), [0, 2, 1, 4, 3, 5]);
        assert_eq!(found.top(), Top { max_re: 3.0, excess: 3.0, frequency: 0.0 });
    }

    #[test]
    fn errors_beyond_all_measure_do_not_make_growth_rates_zero() {
        let lambdas =
            [Complex::new(-0.5, 0.0), Complex::new(0.5, 0.0), Complex::new(1e-11, 30.0), Complex::new(-9.0, 0.0)];
        let infinite = Accuracy { re: f64::INFINITY, whole: f64::INFINITY };
        let small = Accuracy { re: 1e-10, whole: 1e-10 };
        let found = Spectrum::with_zeros(&lambdas, &[infinite, infinite, small, small], 0, Margin::default()).unwrap();
        assert_eq!(found.top(), Top { max_re: 0.5, excess: 0.5, frequency: 0.0 });
        assert_eq!(found.mode(1).unwrap().re, 0.0);
    }

    #[test]
    fn noise_hides_growth_rates_below_it() {
        let parts = [(-1e-7, 100.0), (-1e-7, -100.0), (-0.1, 1e4), (-0.1, -1e4)];
        let lambdas: Vec<Complex<f64>> = parts.iter().map(|&(re, im)| Complex::new(re, im)).collect();
        let exact = Spectrum::new(&lambdas).unwrap();
        assert_eq!(exact.top().max_re, -1e-7);
        let noisy = exact.with_noise(1e-8).unwrap();
        assert_eq!((noisy.top().max_re, noisy.mode(2).unwrap().re), (0.0, -0.1));
        assert_eq!(noisy.with_rigid_body_modes(2).unwrap().max_re(), -0.1);
    }

    /// ζ|λ| is known no better than |λ|.
    #[test]
    fn a_damping_ratio_as_margin_takes_the_error_of_the_frequency_with_it() {
        let lambdas = [Complex::new(-0.1 + 2e-8, 10.0), Complex::new(-0.1 + 2e-8, -10.0)];
        let errors = [Accuracy { re: 1e-12, whole: 1e-5 }; 2];
        let judged = |margin| Spectrum::with_zeros(&lambdas, &errors, 0, margin).unwrap().top().excess;
        let ratio = 0.1 / lambdas[0].norm();
        assert_eq!(judged(Margin::DampingRatio(ratio)), 0.0);
        assert!(judged(Margin::GrowthRate(0.1)) > 0.0);
    }

    #[test]
    fn pairs_are_dropped_whole_or_not_at_all() {
        let parts = [(0.0, 1e-9), (0.0, -1e-9), (-1.0, 100.0), (-1.0, -100.0)];
        let lambdas: Vec<Complex<f64>> = parts.iter().map(|&(re, im)| Complex::new(re, im)).collect();
        let found = Spectrum::with_zeros(&lambdas, &[], 1, Margin::default()).unwrap();
        assert_eq!((found.rigid_body_modes(), found.eigenvalues().len()), (0, 4));
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
