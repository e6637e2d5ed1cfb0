//! Gauss quadrature from a three-term recurrence, by the method of Golub and Welsch (1969),
//! <https://doi.org/10.1090/S0025-5718-69-99647-1>.

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
/// let (nodes, weights) = pcc_evaluate::polynomials::gauss(&[0.0, 0.0], &[1.0 / 3f64.sqrt()]);
/// assert!((nodes[1] - 1.0 / 3f64.sqrt()).abs() < 1e-15 && (weights[0] - 0.5).abs() < 1e-15);
/// ```
pub fn gauss(diagonal: &[f64], off_diagonal: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let size = diagonal.len();
    let mut nodes = diagonal.to_vec();
    let mut coupling = off_diagonal[..size.saturating_sub(1)].to_vec();
    // First entries of the eigenvectors: the first row of the identity, turned by every rotation.
    let mut first = vec![0.0; size];
    first.iter_mut().take(1).for_each(|entry| *entry = 1.0);
    for k in 0..size {
        for _ in 0..MOST_SWEEPS {
            let end = (k..size - 1)
                .find(|&i| coupling[i].abs() <= f64::EPSILON * (nodes[i].abs() + nodes[i + 1].abs()))
                .unwrap_or(size - 1);
            if end == k {
                break;
            }
            sweep(k, end, &mut nodes, &mut coupling, &mut first);
        }
    }
    let mut rule: Vec<(f64, f64)> = nodes.into_iter().zip(first.iter().map(|entry| entry * entry)).collect();
    rule.sort_by(|a, b| a.0.total_cmp(&b.0));
    rule.into_iter().unzip()
}

/// Sweeps per node after which what is reached has to do: two or three are usual.
const MOST_SWEEPS: usize = 60;

/// One implicit QL step with Wilkinson's shift on rows `start` to `end` of the Jacobi matrix: a rotation at the lower
/// end makes an entry outside the three diagonals, which the other rotations move up and out.
fn sweep(start: usize, end: usize, nodes: &mut [f64], coupling: &mut [f64], first: &mut [f64]) {
    let half_gap = (nodes[start + 1] - nodes[start]) / (2.0 * coupling[start]);
    let shift = nodes[start] - coupling[start] / (half_gap + half_gap.mul_add(half_gap, 1.0).sqrt().copysign(half_gap));
    let (mut sine, mut cosine, mut correction) = (1.0, 1.0, 0.0);
    let mut remainder = nodes[end] - shift;
    for i in (start..end).rev() {
        let (outside, inside) = (sine * coupling[i], cosine * coupling[i]);
        let length = (outside * outside + remainder * remainder).sqrt();
        if i + 1 < end {
            coupling[i + 1] = length;
        }
        if length == 0.0 {
            // The matrix has split by itself.
            nodes[i + 1] -= correction;
            return;
        }
        (sine, cosine) = (outside / length, remainder / length);
        let moved = nodes[i + 1] - correction;
        let turned = (nodes[i] - moved) * sine + 2.0 * cosine * inside;
        correction = sine * turned;
        nodes[i + 1] = moved + correction;
        remainder = cosine * turned - inside;
        (first[i], first[i + 1]) = (cosine * first[i] - sine * first[i + 1], sine * first[i] + cosine * first[i + 1]);
    }
    nodes[start] -= correction;
    coupling[start] = remainder;
    if end < coupling.len() {
        coupling[end] = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a rule of twenty nodes stays below this.
    const TOLERANCE: f64 = 1e-14;

    /// Chebyshev polynomials of the second kind: nodes cos(jπ/(n+1)), weights 2/(n+1) sin²(jπ/(n+1)).
    #[test]
    fn the_rule_of_the_semicircle_has_its_closed_form() {
        for size in 1..=20 {
            let (nodes, weights) = gauss(&vec![0.0; size], &vec![0.5; size]);
            for (j, (node, weight)) in nodes.iter().zip(&weights).enumerate() {
                let angle = (size - j) as f64 * std::f64::consts::PI / (size + 1) as f64;
                let expected = 2.0 / (size + 1) as f64 * angle.sin().powi(2);
                assert!((node - angle.cos()).abs() < TOLERANCE, "{size} nodes: {node}");
                assert!((weight - expected).abs() < TOLERANCE, "{size} nodes: {weight}");
            }
        }
    }

    /// Laguerre polynomials of two degrees: nodes 2 ± √2, weights (2 ∓ √2)/4.
    #[test]
    fn diagonals_that_are_not_zero_are_kept() {
        let (nodes, weights) = gauss(&[1.0, 3.0], &[1.0]);
        let root = 2f64.sqrt();
        for (found, expected) in
            nodes.iter().chain(&weights).zip([2.0 - root, 2.0 + root, 0.5 + root / 4.0, 0.5 - root / 4.0])
        {
            assert!((found - expected).abs() < TOLERANCE, "{found}, not {expected}");
        }
    }

    #[test]
    fn matrices_that_fall_apart_and_empty_ones_are_rules_too() {
        assert_eq!(gauss(&[], &[]), (vec![], vec![]));
        assert_eq!(gauss(&[2.0, 1.0], &[0.0]), (vec![1.0, 2.0], vec![0.0, 1.0]));
    }
}
