//! Gauss quadrature from a three-term recurrence, by the method of Golub and Welsch (1969),
//! <https://doi.org/10.1090/S0025-5718-69-99647-1>.
//!
//! Nodes of tensor rules are points at which models are run, and runs are recorded by the bits of their points. So
//! these nodes keep the bits that they had in the first version; [`pcc_evaluate::polynomials::gauss`], which needs no
//! matrix library, may differ in the last.

use nalgebra::DMatrix;

/// Nodes and weights of the Gauss rule with `diagonal.len()` nodes, in ascending order of the nodes.
///
/// `diagonal` holds a_0, a_1, … and `off_diagonal` holds √b_1, √b_2, … of the orthonormal recurrence
/// √b_{k+1} φ_{k+1} = (x − a_k) φ_k − √b_k φ_{k−1}. The nodes are the eigenvalues of the Jacobi matrix, the weights the
/// squared first entries of its eigenvectors; they sum to one.
///
/// # Panics
///
/// If `off_diagonal` holds fewer than `diagonal.len() − 1` entries.
///
/// # Examples
///
/// ```
/// // Two nodes for the uniform density on [−1, 1]: ±1/√3, each with weight 1/2.
/// let (nodes, weights) = pcc_compile::numerics::quadrature::gauss(&[0.0, 0.0], &[1.0 / 3f64.sqrt()]);
/// assert!((nodes[1] - 1.0 / 3f64.sqrt()).abs() < 1e-15 && (weights[0] - 0.5).abs() < 1e-15);
/// ```
pub fn gauss(diagonal: &[f64], off_diagonal: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let size = diagonal.len();
    let jacobi = DMatrix::from_fn(size, size, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off_diagonal[i.min(j)],
        _ => 0.0,
    });
    let eigen = jacobi.symmetric_eigen();
    let mut rule: Vec<(f64, f64)> = eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.row(0).iter())
        .map(|(&node, &first)| (node, first * first))
        .collect();
    rule.sort_by(|a, b| a.0.total_cmp(&b.0));
    rule.into_iter().unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::polynomials::{self, Family};

    /// Rounding of rules of twenty nodes.
    const TOLERANCE: f64 = 1e-14;

    #[test]
    fn both_ways_to_a_rule_give_the_same() {
        for size in 1..=20 {
            let recurrence = Family::Legendre.recurrence(size);
            let (diagonal, off_diagonal) = (&recurrence.diagonal, &recurrence.off_diagonal[..size - 1]);
            let (ours, theirs) = (gauss(diagonal, off_diagonal), polynomials::gauss(diagonal, off_diagonal));
            let pairs = ours.0.iter().zip(&theirs.0).chain(ours.1.iter().zip(&theirs.1));
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < TOLERANCE), "{size} nodes");
        }
    }
}
