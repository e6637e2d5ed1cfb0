//! How exact eigenvalues are that a program printed with few digits.
//!
//! Numbers in twofold precision have 16 or 17 digits; if none of a model's answer has more than twelve, they were
//! rounded when they were printed: to so many significant digits (`%.7g`), or to so many decimals (`%.6f`). Each part
//! then is off by half a unit of its last place at most. Fewer than five digits are taken for exact numbers, like 0.25.

use crate::numerics::accuracy::Accuracy;
use nalgebra::Complex;

/// Numbers of digits that are taken for rounded: more are all that there are, fewer may be exact.
const ROUNDED: std::ops::RangeInclusive<i32> = 5..=12;

/// Numbers that must be there to tell.
const ENOUGH: usize = 4;

/// A number as its shortest decimal: significant digits and the power of ten of the last.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Decimal {
    digits: i32,
    last_place: i32,
}

impl Decimal {
    fn of(value: f64) -> Option<Self> {
        let text = format!("{value:e}");
        let (mantissa, exponent) = text.trim_start_matches('-').split_once('e')?;
        let digits = mantissa.chars().filter(char::is_ascii_digit).count() as i32;
        Some(Self { digits, last_place: exponent.parse::<i32>().ok()? + 1 - digits })
    }
}

/// The errors of eigenvalues whose decimals are short, in their order; `None` if they are not.
pub(super) fn printed_errors(eigenvalues: &[Complex<f64>]) -> Option<Vec<Accuracy>> {
    let parts = eigenvalues.iter().flat_map(|lambda| [lambda.re, lambda.im]).filter(|&part| part != 0.0);
    let mut decimals = Vec::new();
    for part in parts {
        let decimal = Decimal::of(part)?;
        // Most answers are ruled out by their first number.
        if decimal.digits > *ROUNDED.end() {
            return None;
        }
        decimals.push(decimal);
    }
    let most = decimals.iter().map(|decimal| decimal.digits).max()?;
    if decimals.len() < ENOUGH || !ROUNDED.contains(&most) {
        return None;
    }
    let finest = decimals.iter().map(|decimal| decimal.last_place).min()?;
    // Zeros at the end are not seen, so it is the majority that tells one notation from the other.
    let have = |is_it: &dyn Fn(&Decimal) -> bool| decimals.iter().filter(|decimal| is_it(decimal)).count();
    let has_decimals = have(&|decimal| decimal.last_place == finest) > have(&|decimal| decimal.digits == most);
    let half_unit = |part: f64| {
        let place = match Decimal::of(part).filter(|_| part != 0.0 && !has_decimals) {
            Some(Decimal { digits, last_place }) => last_place + digits - most,
            None => finest,
        };
        0.5 * 10f64.powi(place)
    };
    let error = |lambda: &Complex<f64>| {
        let (re, im) = (half_unit(lambda.re), half_unit(lambda.im));
        Accuracy { re, whole: re.hypot(im) }
    };
    Some(eigenvalues.iter().map(error).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(texts: &[[&str; 2]]) -> Vec<Complex<f64>> {
        texts.iter().map(|[re, im]| Complex::new(re.parse().unwrap(), im.parse().unwrap())).collect()
    }

    #[test]
    fn significant_digits_and_decimals_are_told_apart() {
        let significant = parsed(&[["-0.01234567", "123.4567"], ["2.345678e-5", "9876.5"]]);
        let errors = printed_errors(&significant).unwrap();
        assert!(
            (errors[0].re / 0.5e-8 - 1.0).abs() < 1e-9 && (errors[1].re / 0.5e-11 - 1.0).abs() < 1e-9,
            "{errors:?}"
        );
        assert!((errors[1].whole / 0.5e-3 - 1.0).abs() < 1e-6, "a zero at the end is a digit: {errors:?}");

        let decimals = parsed(&[["-0.012346", "123.456789"], ["0.000023", "9876.5"], ["0.000000", "3.141593"]]);
        let errors = printed_errors(&decimals).unwrap();
        assert!(errors.iter().all(|error| (error.re / 0.5e-6 - 1.0).abs() < 1e-9), "{errors:?}");
    }

    #[test]
    fn full_precision_and_exact_numbers_are_not_rounded() {
        assert_eq!(printed_errors(&[Complex::new(-0.1, 2f64.sqrt()), Complex::new(-0.2, 3f64.sqrt())]), None);
        assert_eq!(printed_errors(&parsed(&[["-0.25", "20"], ["-0.125", "30.5"]])), None, "four digits at most");
        assert_eq!(printed_errors(&parsed(&[["-0.1234567", "20.12345"]])), None, "two numbers can be short by chance");
        assert_eq!(printed_errors(&[]), None);
    }
}
