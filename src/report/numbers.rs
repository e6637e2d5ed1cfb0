//! Numbers as people read them: one style in terminal, tables, pages and pictures.
//!
//! Shares are percentages with three decimals, and powers of ten where those would say 0 or 100: 19.978 %, 4.4·10⁻⁶, 1
//! − 4.4·10⁻⁶. The ends of an interval are rounded outward to two significant digits of its half-width, so that what is
//! printed never excludes what it is made from.

use pcc_evaluate::probability::statistics::Interval;

/// A share, or what is left of 1, below this is a power of ten.
const SMALL: f64 = 1e-4;

/// Decimals of a percentage.
const DECIMALS: usize = 3;

/// More decimals than this say nothing.
const MOST_DECIMALS: usize = 12;

/// Where a digit is rounded to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rounding {
    Nearest,
    Down,
    Up,
}

impl Rounding {
    fn reversed(self) -> Self {
        match self {
            Self::Nearest => Self::Nearest,
            Self::Down => Self::Up,
            Self::Up => Self::Down,
        }
    }

    /// The whole number of units near `value`, where `read` says what so many units are as numbers are read.
    fn units(self, value: f64, unit: f64, read: impl Fn(f64) -> f64) -> f64 {
        let nearest = (value / unit).round();
        match self {
            Self::Down if read(nearest) > value => nearest - 1.0,
            Self::Up if read(nearest) < value => nearest + 1.0,
            _ => nearest,
        }
    }
}

/// The number that a decimal says.
fn read(decimal: &str) -> f64 {
    decimal.parse().unwrap_or(f64::NAN)
}

/// `value` with so many significant digits; powers of ten only for very large and very small numbers.
///
/// # Examples
///
/// ```
/// use pcc::report::significant;
/// assert_eq!(significant(3641.65497, 5), "3641.7");
/// assert_eq!(significant(-0.00012345, 3), "-0.000123");
/// assert_eq!(significant(1.5e-9, 3), "1.50·10⁻⁹");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if !(-4..9).contains(&exponent) {
        return power_of_ten(mantissa, exponent);
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// A number as people write it, with six digits at most and no zeros after the last: for values that were chosen.
///
/// # Examples
///
/// ```
/// use pcc::report::plain;
/// assert_eq!(plain(0.1 + 0.2), "0.3");
/// assert_eq!((plain(15.2e6), plain(-1e-9)), ("15200000".to_owned(), "-1·10⁻⁹".to_owned()));
/// ```
pub fn plain(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    let size = rounded.abs();
    if size == 0.0 || !size.is_finite() || (1e-4..1e9).contains(&size) {
        return rounded.to_string();
    }
    let text = format!("{rounded:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    power_of_ten(mantissa, exponent.parse().unwrap_or(0))
}

fn power_of_ten(mantissa: &str, exponent: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '0'..='9' => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][c as usize - '0' as usize],
        other => other,
    };
    let exponent: String = exponent.to_string().chars().map(raised).collect();
    format!("{mantissa}·10{exponent}")
}

/// Whether a share is so small that it is written as a power of ten.
pub(super) fn is_small(share: f64) -> bool {
    share > 0.0 && share < SMALL
}

/// A share from 0 to 1.
///
/// # Examples
///
/// ```
/// use pcc::report::share;
/// assert_eq!([0.19978, 0.0, 1.0].map(share), ["19.978 %", "0 %", "100 %"]);
/// assert_eq!([4.43e-6, 1.0 - 4.43e-6].map(share), ["4.4·10⁻⁶", "1 − 4.4·10⁻⁶"]);
/// ```
pub fn share(value: f64) -> String {
    match value {
        value if value <= 0.0 => "0 %".to_owned(),
        value if value >= 1.0 => "100 %".to_owned(),
        value if value < SMALL => small(value, Rounding::Nearest, exponent(value) - 1),
        value if 1.0 - value < SMALL => {
            let rest = 1.0 - value;
            format!("1 − {}", small(rest, Rounding::Nearest, exponent(rest) - 1))
        }
        value => format!("{:.DECIMALS$} %", 100.0 * value),
    }
}

/// The ends of an interval of shares, rounded outward to two significant digits of the half-width.
///
/// # Examples
///
/// ```
/// use pcc::report::share_range;
/// assert_eq!(share_range(0.198991, 0.200561), "19.899 to 20.057 %");
/// assert_eq!(share_range(0.1921, 0.2079), "19.21 to 20.79 %");
/// assert_eq!(share_range(0.15, 0.25), "15.0 to 25.0 %");
/// assert_eq!(share_range(4.043e-6, 4.85e-6), "4.04·10⁻⁶ to 4.85·10⁻⁶");
/// assert_eq!(share_range(1.0 - 4.85e-6, 1.0 - 4.043e-6), "1 − 4.85·10⁻⁶ to 1 − 4.04·10⁻⁶");
/// assert_eq!(share_range(0.0, 3.689e-8), "0 to 3.7·10⁻⁸");
/// ```
pub fn share_range(lower: f64, upper: f64) -> String {
    range(lower, upper, MOST_DECIMALS)
}

/// The same with so many decimals of a percentage at most, where both ends are seen with them: for what is known better
/// than the share that it belongs to is printed.
pub(super) fn plain_range(lower: f64, upper: f64) -> String {
    range(lower, upper, DECIMALS)
}

fn range(lower: f64, upper: f64, most: usize) -> String {
    let (low, high) = (Rounding::Down, Rounding::Up);
    if lower <= 0.0 && upper <= 0.0 || lower >= 1.0 && upper >= 1.0 {
        return share(lower);
    }
    let half_width = 0.5 * (upper - lower);
    let unit = if half_width > 0.0 { exponent(half_width) - 1 } else { -(DECIMALS as i32) - 2 };
    if upper < SMALL {
        let lower = if lower <= 0.0 { "0".to_owned() } else { small(lower, low, unit) };
        return format!("{lower} to {}", small(upper, high, unit));
    }
    if 1.0 - lower < SMALL {
        let upper = match upper {
            upper if upper >= 1.0 => "1".to_owned(),
            upper => format!("1 − {}", small(1.0 - upper, high.reversed(), unit)),
        };
        return format!("1 − {} to {upper}", small(1.0 - lower, low.reversed(), unit));
    }
    // Ends that are not 0 or 1 are not to look as if they were.
    let visible = |rest: f64| if rest > 0.0 { (-(100.0 * rest).log10()).ceil().max(0.0) as usize } else { 0 };
    let of_width = ((-unit - 2).max(0) as usize).min(most);
    let decimals = visible(lower).max(visible(1.0 - upper)).max(of_width).min(MOST_DECIMALS);
    let end = |value: f64, rounding| percent(value, rounding, decimals);
    format!("{} to {} %", end(lower, low), end(upper, high))
}

/// A share that is less than this with the confidence of an interval from 0: the upper end.
///
/// # Examples
///
/// ```
/// use pcc::report::share_below;
/// assert_eq!([3.689e-8, 0.0036832].map(share_below), ["below 3.7·10⁻⁸", "below 0.37 %"]);
/// ```
pub fn share_below(upper: f64) -> String {
    let range = share_range(0.0, upper);
    format!("below {}", range.strip_prefix("0 to ").unwrap_or(&range))
}

/// The same of an upper end above a share that is known: as many digits as its distance from that has.
pub(super) fn below(known: f64, upper: f64) -> String {
    let range = share_range(known.min(upper), upper);
    format!("below {}", range.rsplit(" to ").next().unwrap_or(&range))
}

/// A lower end below a share that is known.
pub(super) fn above(lower: f64, known: f64) -> String {
    let range = share_range(lower, known.max(lower));
    match range.split_once(" to ") {
        Some((end, _)) if range.ends_with('%') => format!("above {end} %"),
        Some((end, _)) => format!("above {end}"),
        None => format!("above {range}"),
    }
}

/// A share in percent, without the sign.
fn percent(value: f64, rounding: Rounding, decimals: usize) -> String {
    if value <= 0.0 || value >= 1.0 {
        return if value <= 0.0 { "0".to_owned() } else { "100".to_owned() };
    }
    let unit = 10f64.powi(-(decimals as i32) - 2);
    let text = |units: f64| format!("{:.decimals$}", units / 10f64.powi(decimals as i32));
    text(rounding.units(value, unit, |units| read(&format!("{}e-2", text(units)))))
}

/// [`share_range`] of an interval.
pub(super) fn interval(interval: &Interval) -> String {
    share_range(interval.lower, interval.upper)
}

/// The power of ten of the first significant digit.
fn exponent(value: f64) -> i32 {
    value.log10().floor() as i32
}

/// Digits down to that of 10^`unit`, one at least, and a power of ten.
fn small(value: f64, rounding: Rounding, unit: i32) -> String {
    let exponent = exponent(value);
    let decimals = (exponent - unit).clamp(0, MOST_DECIMALS as i32);
    let unit = exponent - decimals;
    let units = rounding.units(value, 10f64.powi(unit), |units| read(&format!("{units}e{unit}")));
    let (shown, scale) = (decimals as usize, 10f64.powi(decimals));
    match units >= 10.0 * scale {
        true => power_of_ten(&format!("{:.shown$}", units / (10.0 * scale)), exponent + 1),
        false => power_of_ten(&format!("{:.shown$}", units / scale), exponent),
    }
}

/// A probability of an interval, as in "95 %".
pub(super) fn level(level: f64) -> String {
    format!("{} %", plain(100.0 * level))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number that a text says.
    fn read(text: &str, is_percent: bool) -> f64 {
        let (rest, sign) = text.strip_prefix("1 − ").map_or((text, 1.0), |rest| (rest, -1.0));
        let value = match rest.split_once("·10⁻") {
            None => rest.trim_end_matches(" %").parse::<f64>().unwrap() / if is_percent { 100.0 } else { 1.0 },
            Some((mantissa, raised)) => {
                let digit = |c: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|known| known == c).unwrap().to_string();
                let exponent: String = raised.chars().map(digit).collect();
                format!("{mantissa}e-{exponent}").parse().unwrap()
            }
        };
        if sign < 0.0 { 1.0 - value } else { value }
    }

    #[test]
    fn printed_intervals_hold_what_they_are_made_from() {
        let mut ends = vec![0.0, 1.0, 0.5, 0.19978, 0.00012, 1e-4, 9.96e-5];
        for k in 1..15 {
            let small = 1.2345678 * 10f64.powi(-k);
            ends.extend([small, 1.0 - small, 9.9999 * 10f64.powi(-k - 1)]);
        }
        for &lower in &ends {
            for &upper in ends.iter().filter(|&&upper| upper >= lower) {
                let text = share_range(lower, upper);
                let Some((low, high)) = text.split_once(" to ") else { continue };
                let is_percent = text.ends_with('%');
                let (low, high) = (read(low, is_percent), read(high, is_percent));
                // Reading 1 − x rounds.
                let rounding = 2.0 * f64::EPSILON;
                assert!(low <= lower + rounding && high >= upper - rounding, "{lower:e} to {upper:e}: {text}");
                assert!((low > 0.0) == (lower > 0.0) || lower < 1e-13, "{lower:e} to {upper:e}: {text}");
                assert!((high < 1.0) == (upper < 1.0) || upper > 1.0 - 1e-13, "{lower:e} to {upper:e}: {text}");
            }
        }
    }

    #[test]
    fn shares_are_told_from_none_and_all() {
        for k in 1..16 {
            let value = 4.43 * 10f64.powi(-k);
            assert!(!share(value).starts_with("0.000") && share(value) != "0 %", "{}", share(value));
            let rest = share(1.0 - value);
            assert!(!rest.starts_with("100"), "{value:e}: {rest}");
        }
        assert_eq!(share(9.96e-6), "1.0·10⁻⁵");
    }
}
