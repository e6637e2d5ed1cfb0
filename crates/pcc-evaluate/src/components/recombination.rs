//! From components to eigenvalues: the part of the spectrum that an evaluator needs.

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
}

/// Frequencies that differ by at most this share of |λ| are equal but for rounding, and rank by growth rate.
const EQUAL_FREQUENCY: f64 = 1e-12;

impl OutputKind {
    /// Number of components of such an output for so many modes; `None` if it cannot have so many.
    pub fn components(self, modes: usize) -> Option<usize> {
        match (self, modes) {
            (Self::Eigenvalue, 1) => Some(2),
            (Self::Cluster, 2..=MOST_MODES) => Some(2 * modes),
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
    /// Frequency ranks of the modes it yields, from 1.
    pub modes: Vec<usize>,
    /// Name in tables.
    pub name: String,
    /// Unit of the eigenvalues.
    pub unit: String,
    /// Its components, in the order the kind prescribes.
    pub components: Vec<Component>,
}

impl Output {
    /// Appends the eigenvalues of this output's modes, by frequency, to `eigenvalues`, given the values of all
    /// components by id.
    #[inline]
    pub fn recombine(&self, values: &[f64], eigenvalues: &mut Vec<Complex<f64>>) {
        let part = |k: usize| Complex::new(values[self.components[2 * k].id], values[self.components[2 * k + 1].id]);
        match (self.kind, self.modes.len()) {
            (OutputKind::Eigenvalue, _) => eigenvalues.push(part(0)),
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
                roots(&coefficients[..found.len()], found);
                found.iter_mut().for_each(|root| *root += part(0));
                sort_by_frequency(found);
                eigenvalues.extend_from_slice(found);
            }
        }
    }
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
