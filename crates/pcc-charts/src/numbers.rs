//! Numbers as people write them: true minus signs, thin spaces between thousands, powers of ten.

/// `value` with a fixed number of decimals.
pub(super) fn decimal(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = digits.split_once('.').unwrap_or((&digits, ""));
    let mut text = String::new();
    if value < 0.0 && digits.contains(|digit: char| matches!(digit, '1'..='9')) {
        text.push('−');
    }
    text.push_str(&grouped(whole));
    if !fraction.is_empty() {
        text.push('.');
        text.push_str(fraction);
    }
    text
}

/// `mantissa` × 10^`exponent`, zero as such.
pub(super) fn scientific(mantissa: f64, decimals: usize, exponent: i32) -> String {
    if mantissa == 0.0 {
        return "0".to_string();
    }
    format!("{}\u{2009}×\u{2009}{}", decimal(mantissa, decimals), power_of_ten(exponent))
}

/// 10^`exponent`.
pub(super) fn power_of_ten(exponent: i32) -> String {
    let superscript = |digit: char| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        other => char::from_u32('⁰' as u32 + other.to_digit(10).unwrap_or(0)).unwrap_or('⁰'),
    };
    std::iter::once("10".to_string())
        .chain(exponent.to_string().chars().map(|digit| superscript(digit).into()))
        .collect()
}

/// Thin spaces between groups of three digits; four digits stay together, as is usual.
fn grouped(digits: &str) -> String {
    if digits.len() < 5 {
        return digits.to_string();
    }
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_have_no_noise_and_no_negative_zero() {
        assert_eq!(decimal(0.1 + 0.2, 1), "0.3");
        assert_eq!(decimal(-1234.5, 1), "−1234.5");
        assert_eq!(decimal(-0.01, 1), "0.0");
        assert_eq!(decimal(1_234_567.0, 0), "1\u{2009}234\u{2009}567");
    }

    #[test]
    fn powers_are_superscripts() {
        assert_eq!(power_of_ten(-123), "10⁻¹²³");
        assert_eq!(power_of_ten(4560), "10⁴⁵⁶⁰");
        assert_eq!(scientific(-2.5, 1, 9), "−2.5\u{2009}×\u{2009}10⁹");
        assert_eq!(scientific(0.0, 1, 9), "0");
    }
}
