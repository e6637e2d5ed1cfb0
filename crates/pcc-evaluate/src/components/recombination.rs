//! From components to eigenvalues: the part of the spectrum that an evaluator needs.

use super::closed::{MOST_IN_CLOSED_GROUP, closed_eigenvalues, real_roots_or_pairs};
use super::label::Label;
use crate::components::roots::{roots, square_root};
use num_complex::Complex;

/// How the components of an output form eigenvalues.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum OutputKind {
    /// Two components, Re λ and Im λ of one mode.
    Eigenvalue,
    /// 2k components for k modes: Re and Im of the mean s of the eigenvalues, then Re and Im of the coefficients
    /// c_{k−2}, …, c_0 of z^k + c_{k−2} z^{k−2} + … + c_0, whose roots are λ − s. They are smooth where eigenvalues
    /// coalesce.
    Cluster,
    /// n real components: the elementary symmetric functions e₁, …, eₙ of n eigenvalues that are closed under
    /// conjugation, roots of λⁿ − e₁ λⁿ⁻¹ + e₂ λⁿ⁻² − …. They are two for every mode and one for every real eigenvalue
    /// that belongs to no mode, and smooth where a mode meets its conjugate on the real axis.
    Closed,
}

/// Frequencies that differ by at most this share of |λ| are equal but for rounding, and rank by growth rate.
const EQUAL_FREQUENCY: f64 = 1e-12;

impl OutputKind {
    /// Number of components of such an output for so many modes, and real eigenvalues beside them; `None` if it cannot
    /// have so many.
    pub fn components(self, modes: usize, reals: usize) -> Option<usize> {
        match (self, modes, reals) {
            (Self::Eigenvalue, 1, 0) => Some(2),
            (Self::Cluster, 2..=MOST_MODES, 0) => Some(2 * modes),
            (Self::Closed, 0..=MOST_IN_CLOSED_GROUP, 0..=MOST_IN_CLOSED_GROUP) => {
                Some(2 * modes + reals).filter(|count| (1..=MOST_IN_CLOSED_GROUP).contains(count))
            }
            _ => None,
        }
    }
}

/// Modes in one cluster at most: polynomials of higher degree have roots too sensitive to be of use.
pub const MOST_MODES: usize = 16;

/// One real function of the inputs, given by an expansion: value = center + scale × expansion.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Position among all components of a surrogate, from 0.
    pub id: usize,
    /// Name in tables and as a column of results.
    pub name: String,
    /// Added to the scaled expansion.
    pub center: f64,
    /// Multiplies the expansion.
    pub scale: f64,
}

/// A group of components that forms one or more eigenvalues.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// How components become eigenvalues.
    pub kind: OutputKind,
    /// Numbers of the modes it yields, from 1.
    pub modes: Vec<usize>,
    /// Numbers of the real eigenvalues it yields that belong to no mode, from 1.
    pub reals: Vec<usize>,
    /// Name in tables.
    pub name: String,
    /// Unit of the eigenvalues.
    pub unit: String,
    /// Its components, in the order the kind prescribes.
    pub components: Vec<Component>,
}

impl Output {
    /// The names of its eigenvalues, in the order in which [`Output::recombine`] yields them.
    pub fn labels(&self) -> impl Iterator<Item = Label> {
        let seconds = if self.kind == OutputKind::Closed { &self.modes[..] } else { &[] };
        let modes = self.modes.iter().map(|&mode| Label::Mode(mode));
        let seconds = seconds.iter().map(|&mode| Label::Second(mode));
        modes.chain(seconds).chain(self.reals.iter().map(|&number| Label::Real(number)))
    }

    /// Number of eigenvalues it yields.
    pub fn eigenvalue_count(&self) -> usize {
        if self.kind == OutputKind::Closed { self.components.len() } else { self.modes.len() }
    }

    /// Appends the eigenvalues of this output to `eigenvalues`, in the order of [`Output::labels`], given the values of
    /// all components by id. Modes of a cluster come by frequency.
    #[inline]
    pub fn recombine(&self, values: &[f64], eigenvalues: &mut Vec<Complex<f64>>) {
        let part = |k: usize| Complex::new(values[self.components[2 * k].id], values[self.components[2 * k + 1].id]);
        match (self.kind, self.modes.len()) {
            (OutputKind::Eigenvalue, _) => eigenvalues.push(part(0)),
            (OutputKind::Closed, modes) => {
                let (mut symmetric, mut found) =
                    ([0.0; MOST_IN_CLOSED_GROUP], [Complex::default(); MOST_IN_CLOSED_GROUP]);
                let count = self.components.len().min(MOST_IN_CLOSED_GROUP);
                for (e, component) in symmetric.iter_mut().zip(&self.components) {
                    *e = values[component.id];
                }
                closed_eigenvalues(&symmetric[..count], modes, &mut found[..count]);
                eigenvalues.extend_from_slice(&found[..count]);
            }
            (OutputKind::Cluster, 2) => {
                // λ = s ± √−c_0
                let (mean, root) = (part(0), square_root(-part(1)));
                let pair = [mean - root, mean + root];
                let swapped = ranks_after(&pair[0], &pair[1]);
                eigenvalues.extend([pair[usize::from(swapped)], pair[usize::from(!swapped)]]);
            }
            (OutputKind::Cluster, modes) => {
                let (mut coefficients, mut found) =
                    ([Complex::default(); MOST_MODES], [Complex::default(); MOST_MODES]);
                for (k, coefficient) in coefficients.iter_mut().enumerate().take(modes).skip(1) {
                    *coefficient = part(k);
                }
                let found = &mut found[..modes.min(MOST_MODES)];
                let coefficients = &coefficients[..found.len()];
                match on_imaginary_axis(part(0), coefficients) {
                    Some(symmetric) => undamped_roots(&symmetric[..found.len()], found),
                    None => roots(coefficients, found),
                }
                found.iter_mut().for_each(|root| *root += part(0));
                sort_by_frequency(found);
                eigenvalues.extend_from_slice(found);
            }
        }
    }
}

/// The elementary symmetric functions of y = z/i, if the mean and the polynomial in z with these `coefficients` are
/// those of an undamped group: its eigenvalues lie on the imaginary axis, or symmetric to it.
fn on_imaginary_axis(mean: Complex<f64>, coefficients: &[Complex<f64>]) -> Option<[f64; MOST_IN_CLOSED_GROUP]> {
    if mean.re != 0.0 || coefficients.len() > MOST_IN_CLOSED_GROUP {
        return None;
    }
    let mut symmetric = [0.0; MOST_IN_CLOSED_GROUP];
    for (degree, (symmetric, c)) in (1..).zip(symmetric.iter_mut().zip(coefficients)) {
        // c (−i)ᵐ is real, and (−1)ᵐ times the function of degree m.
        let (own, other) = if degree % 2 == 0 { (c.re, c.im) } else { (c.im, c.re) };
        if other != 0.0 {
            return None;
        }
        *symmetric = match degree % 4 {
            0 | 3 => own,
            _ => -own,
        };
    }
    Some(symmetric)
}

/// The roots z = iy for those functions of y.
fn undamped_roots(symmetric: &[f64], found: &mut [Complex<f64>]) {
    real_roots_or_pairs(symmetric, found);
    found.iter_mut().for_each(|y| *y = Complex::new(0.0 - y.im, y.re));
}

/// Whether `first` comes after `second` in the order of modes: by frequency, equal frequencies by growth rate.
fn ranks_after(first: &Complex<f64>, second: &Complex<f64>) -> bool {
    if is_equal_frequency(first.im, second.im) { first.re > second.re } else { first.im - second.im > 0.0 }
}

/// Whether two frequencies are equal but for rounding.
#[inline(always)]
pub fn is_equal_frequency(first: f64, second: f64) -> bool {
    (first - second).abs() <= EQUAL_FREQUENCY * first.abs()
}

/// Insertion sort: clusters are small, and equality within rounding is no total order.
fn sort_by_frequency(lambdas: &mut [Complex<f64>]) {
    for end in 1..lambdas.len() {
        let mut at = end;
        while at > 0 && ranks_after(&lambdas[at - 1], &lambdas[at]) {
            lambdas.swap(at - 1, at);
            at -= 1;
        }
    }
}

/// max Re λ, in 1/s; NaN if any part of an eigenvalue is NaN or infinite, so that no broken value passes for stable.
#[inline]
pub fn spectral_abscissa(eigenvalues: &[Complex<f64>]) -> f64 {
    eigenvalues.iter().fold(f64::NEG_INFINITY, |largest, lambda| {
        let is_finite = lambda.re.is_finite() && lambda.im.is_finite();
        if is_finite && !largest.is_nan() { largest.max(lambda.re) } else { f64::NAN }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// λ = i, 4i and 6i, and i, 5i ± 0.5: z = λ − s has c₁ real and c₀ imaginary.
    #[test]
    fn undamped_clusters_lie_on_the_axis_or_symmetric_to_it_exactly() {
        for lambdas in [[(0.0, 1.0), (0.0, 4.0), (0.0, 6.0)], [(0.0, 1.0), (0.5, 5.0), (-0.5, 5.0)]] {
            let lambdas = lambdas.map(|(re, im)| Complex::new(re, im));
            let mean = lambdas.iter().sum::<Complex<f64>>() / 3.0;
            let [a, b, c] = lambdas.map(|lambda| lambda - mean);
            let (c_1, c_0) = (a * b + b * c + c * a, -(a * b * c));
            let component = |id| Component { id, name: String::new(), center: 0.0, scale: 1.0 };
            let output = Output {
                kind: OutputKind::Cluster,
                modes: vec![1, 2, 3],
                reals: Vec::new(),
                name: String::new(),
                unit: String::new(),
                components: (0..6).map(component).collect(),
            };
            let mut found = Vec::new();
            output.recombine(&[0.0, mean.im, c_1.re, 0.0, 0.0, c_0.im], &mut found);
            let expected = lambdas.iter().map(|lambda| lambda.re).fold(0.0, f64::max);
            assert!((spectral_abscissa(&found) - expected).abs() < 1e-12, "{found:?}");
            assert_eq!(found[0].re, 0.0, "{found:?}");
            assert!((found[0].im - 1.0).abs() < 1e-12);
            assert_eq!(found.iter().map(|lambda| lambda.re).sum::<f64>(), 0.0, "{found:?}");
        }
    }

    #[test]
    fn spectral_abscissa_is_the_largest_real_part_and_never_hides_nan() {
        let lambda = Complex::new;
        assert_eq!(spectral_abscissa(&[lambda(-2.0, 1.0), lambda(-1.0, 5.0)]), -1.0);
        let infinite = f64::INFINITY;
        for broken in [lambda(f64::NAN, 1.0), lambda(-1.0, f64::NAN), lambda(-infinite, 1.0), lambda(-1.0, infinite)] {
            assert!(spectral_abscissa(&[broken, lambda(-1.0, 0.0)]).is_nan());
            assert!(spectral_abscissa(&[lambda(-1.0, 0.0), broken]).is_nan());
        }
    }
}
