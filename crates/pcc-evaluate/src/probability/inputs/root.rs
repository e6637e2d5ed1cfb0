//! Roots of rising functions.

/// The root of a rising function inside `bracket`, by Newton's steps where they stay inside, else by halving; an end if
/// there is no root between them.
pub(super) fn rising(function: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64, bracket: [f64; 2]) -> f64 {
    /// Halving alone would take fewer.
    const MOST_STEPS: u32 = 100;
    let [mut lower, mut upper] = bracket;
    let mut x = 0.5 * (lower + upper);
    for _ in 0..MOST_STEPS {
        let value = function(x);
        if value < 0.0 {
            lower = x;
        } else {
            upper = x;
        }
        let newton = x - value / slope(x);
        let next = if newton > lower && newton < upper { newton } else { 0.5 * (lower + upper) };
        let step = (next - x).abs();
        x = next;
        if step <= f64::EPSILON * (1.0 + x.abs()) {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_found_where_slopes_mislead_too() {
        let cube = rising(|x| x * x * x - 8.0, |x| 3.0 * x * x, [0.0, 100.0]);
        assert!((cube - 2.0).abs() < 1e-14, "{cube}");
        assert!((rising(|x| x - 0.25, |_| 1e-3, [0.0, 1.0]) - 0.25).abs() < 1e-14);
        assert!((rising(|x| x - 3.0, |_| 0.0, [0.0, 1.0]) - 1.0).abs() < 1e-14);
    }
}
