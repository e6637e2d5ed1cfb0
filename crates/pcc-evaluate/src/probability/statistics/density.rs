//! Densities from samples, for pictures.

/// A histogram as a density: the middles of `bins` equal bins from `lower` to `upper` with the share of all `values` in
/// the bin over its width. Values outside, and those that are not finite, count in the total only, so what is seen
/// keeps its height. Empty if there are no values or no bins, or if the interval is.
///
/// # Examples
///
/// ```
/// let found = pcc_evaluate::probability::statistics::density(&[0.1, 0.2, 0.3, 1.9], 0.0, 2.0, 2);
/// assert_eq!(found, [[0.5, 0.75], [1.5, 0.25]]);
/// ```
pub fn density(values: &[f64], lower: f64, upper: f64, bins: usize) -> Vec<[f64; 2]> {
    let width = (upper - lower) / bins as f64;
    if values.is_empty() || bins == 0 || !(width > 0.0 && width.is_finite()) {
        return Vec::new();
    }
    let mut counts = vec![0u64; bins];
    for value in values.iter().filter(|&&value| (lower..=upper).contains(&value)) {
        counts[(((value - lower) / width) as usize).min(bins - 1)] += 1;
    }
    let share =
        |(bin, count): (usize, u64)| [lower + (bin as f64 + 0.5) * width, count as f64 / (values.len() as f64 * width)];
    counts.into_iter().enumerate().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_shares() {
        let values: Vec<f64> = (0..1000).map(|i| f64::from(i) / 100.0).chain([f64::NAN, 99.0]).collect();
        let found = density(&values, 0.0, 10.0, 20);
        let inside: f64 = found.iter().map(|[_, height]| 0.5 * height).sum();
        assert!((inside - 1000.0 / 1002.0).abs() < 1e-12);
        assert_eq!(density(&[3.0], 3.0, 3.0, 5), Vec::<[f64; 2]>::new());
        assert_eq!(density(&[], 0.0, 1.0, 5), Vec::<[f64; 2]>::new());
    }
}
