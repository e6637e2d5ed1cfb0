//! From components to eigenvalues: the part of the spectrum that an evaluator needs.

use nalgebra::Complex;

/// How the components of an output form eigenvalues.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum OutputKind {
    /// Two components, Re λ and Im λ of one mode.
    Eigenvalue,
}

impl OutputKind {
    /// Number of components and number of modes of such an output.
    pub fn shape(self) -> (usize, usize) {
        match self {
            Self::Eigenvalue => (2, 1),
        }
    }
}

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
    /// Writes the eigenvalues of this output's modes into `eigenvalues`, given the values of all components by id.
    #[inline]
    pub fn recombine(&self, values: &[f64], eigenvalues: &mut Vec<Complex<f64>>) {
        match self.kind {
            OutputKind::Eigenvalue => {
                let value = |k: usize| values[self.components[k].id];
                eigenvalues.push(Complex::new(value(0), value(1)));
            }
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
