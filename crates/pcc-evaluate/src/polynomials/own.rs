//! Polynomials that are orthonormal under any density, given by nodes and weights or by their recurrence.
//!
//! Stieltjes' procedure (Gautschi 2004, *Orthogonal Polynomials: Computation and Approximation*, section 2.2.3): every
//! coefficient of the recurrence is a mean under the weights, of the polynomials that are there already.

use super::recurrence::Recurrence;

/// Polynomials of one density. Gamma laws have those of Laguerre, beta laws those of Jacobi; most have no name.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnPolynomials {
    name: &'static str,
    source: Source,
}

#[derive(Debug, Clone, PartialEq)]
enum Source {
    Density { nodes: Vec<f64>, weights: Vec<f64> },
    Stored(Recurrence),
}

impl OwnPolynomials {
    /// Those that are orthonormal under a sum over `nodes` with these `weights`, which need not sum to one.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::polynomials::OwnPolynomials;
    /// // A fair coin: φ_1 = x.
    /// let coin = OwnPolynomials::of_density("own", vec![-1.0, 1.0], vec![1.0, 1.0]).recurrence(1);
    /// assert_eq!((coin.diagonal, coin.off_diagonal), (vec![0.0], vec![1.0]));
    /// ```
    pub fn of_density(name: &'static str, nodes: Vec<f64>, mut weights: Vec<f64>) -> Self {
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        Self { name, source: Source::Density { nodes, weights } }
    }

    /// Those of a recurrence that a file has.
    pub fn stored(name: &'static str, recurrence: Recurrence) -> Self {
        Self { name, source: Source::Stored(recurrence) }
    }

    /// What they are called.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The degree up to which a recurrence is stored, if one is.
    pub fn stored_degree(&self) -> Option<usize> {
        match &self.source {
            Source::Density { .. } => None,
            Source::Stored(known) => Some(known.degree()),
        }
    }

    /// The recurrence up to `degree`. One that is stored goes as far as it was used; the last coefficients repeat where
    /// more is asked for, which gives polynomials of a right kind, under another density.
    pub fn recurrence(&self, degree: usize) -> Recurrence {
        match &self.source {
            Source::Density { nodes, weights } => stieltjes(nodes, weights, degree),
            Source::Stored(known) => {
                let padded = |known: &[f64], otherwise: f64| {
                    let last = known.last().copied().unwrap_or(otherwise);
                    known.iter().copied().chain(std::iter::repeat(last)).take(degree).collect()
                };
                Recurrence { diagonal: padded(&known.diagonal, 0.0), off_diagonal: padded(&known.off_diagonal, 1.0) }
            }
        }
    }
}

/// A polynomial with a smaller share of the first one's standard deviation is zero but for rounding.
const VANISHED: f64 = 1e-9;

fn stieltjes(nodes: &[f64], weights: &[f64], degree: usize) -> Recurrence {
    let (mut diagonal, mut off_diagonal) = (Vec::with_capacity(degree), Vec::with_capacity(degree));
    let (mut before, mut current) = (vec![0.0; nodes.len()], vec![1.0; nodes.len()]);
    let mut coupling = 0.0;
    for _ in 0..degree {
        let mean: f64 = nodes.iter().zip(weights).zip(&current).map(|((x, w), value)| w * x * value * value).sum();
        for ((before, value), x) in before.iter_mut().zip(&current).zip(nodes) {
            *before = (x - mean) * value - coupling * *before;
        }
        let next: f64 = before.iter().zip(weights).map(|(next, w)| w * next * next).sum::<f64>().sqrt();
        // Beyond the degree at which a polynomial vanishes at all nodes there is none of unit variance: what follows
        // vanishes there, too.
        let least = off_diagonal.first().map_or(0.0, |first| VANISHED * first);
        coupling = if next.is_normal() && next > least { next } else { off_diagonal.first().copied().unwrap_or(1.0) };
        before.iter_mut().for_each(|next| *next /= coupling);
        std::mem::swap(&mut before, &mut current);
        diagonal.push(mean);
        off_diagonal.push(coupling);
    }
    Recurrence { diagonal, off_diagonal }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomials::{Family, gauss};

    #[test]
    fn the_polynomials_of_a_rule_are_those_that_made_it() {
        let legendre = Family::Legendre.recurrence(21);
        let (nodes, weights) = gauss(&legendre.diagonal, &legendre.off_diagonal[..20]);
        let own = OwnPolynomials::of_density("own", nodes, weights).recurrence(20);
        for (found, expected) in own.off_diagonal.iter().zip(&legendre.off_diagonal) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert!(own.diagonal.iter().all(|mean| mean.abs() < 1e-12), "{:?}", own.diagonal);
    }

    #[test]
    fn a_stored_recurrence_is_given_back_and_goes_on() {
        let hermite = Family::Hermite.recurrence(3);
        let own = OwnPolynomials::stored("own", hermite.clone());
        assert_eq!(own.recurrence(3), hermite);
        assert_eq!(own.recurrence(5).off_diagonal[3..], [hermite.off_diagonal[2]; 2]);
        assert_eq!(OwnPolynomials::stored("own", Family::Hermite.recurrence(0)).recurrence(1).off_diagonal, [1.0]);
    }

    #[test]
    fn more_degrees_than_nodes_are_no_division_by_zero() {
        let two = OwnPolynomials::of_density("own", vec![0.0, 1.0], vec![1.0, 1.0]).recurrence(5);
        assert!(two.off_diagonal.iter().chain(&two.diagonal).all(|value| value.is_finite()), "{two:?}");
    }
}
