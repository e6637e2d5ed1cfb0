//! Which eigenvalues are nearest to which.

use crate::numerics::assignment::assignment;
use nalgebra::{Complex, DMatrix};

/// Stands for a distance that is no number.
const FAR: f64 = 1e300;

/// For each of the eigenvalues `wanted` the position of one among others, none twice, so that the sum of all distances
/// |λ − λ′| is least.
///
/// # Panics
///
/// If more are wanted than there are.
///
/// # Examples
///
/// ```
/// use nalgebra::Complex;
/// use pcc_compile::mechanics::spectrum::nearest;
/// let [a, b, c] = [10.0, 20.0, 30.0].map(|im| Complex::new(-1.0, im));
/// assert_eq!(nearest(&[b, a], &[a, b, c]), [1, 0]);
/// ```
pub fn nearest(wanted: &[Complex<f64>], among: &[Complex<f64>]) -> Vec<usize> {
    let distances = DMatrix::from_fn(wanted.len(), among.len(), |i, j| {
        let distance = (wanted[i] - among[j]).norm();
        if distance.is_finite() { distance } else { FAR }
    });
    assignment(&distances)
}

/// The largest difference between eigenvalues, whatever their order, and the largest |λ|; infinite of lists that differ
/// in length.
pub fn largest_difference(a: &[Complex<f64>], b: &[Complex<f64>]) -> (f64, f64) {
    let scale = a.iter().chain(b).map(|lambda| lambda.norm()).fold(0.0, f64::max);
    let mut left: Vec<Complex<f64>> = b.to_vec();
    let mut largest = if a.len() == b.len() { 0.0 } else { f64::INFINITY };
    for lambda in a {
        let nearest = (0..left.len()).min_by(|&i, &k| (left[i] - lambda).norm().total_cmp(&(left[k] - lambda).norm()));
        let Some(nearest) = nearest else { break };
        largest = (left.swap_remove(nearest) - lambda).norm().max(largest);
    }
    (largest, scale)
}
