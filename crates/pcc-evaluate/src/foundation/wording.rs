//! Numbers of things, as people read them.

/// A count with thin groups of three digits: 1 000 000.
///
/// # Examples
///
/// ```
/// assert_eq!(pcc_evaluate::foundation::count(1_234_567), "1 234 567");
/// ```
pub fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut grouped = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped
}

/// `1 run`, `2 runs`.
///
/// # Examples
///
/// ```
/// assert_eq!(pcc_evaluate::foundation::plural(1200, "run"), "1 200 runs");
/// ```
pub fn plural(number: usize, noun: &str) -> String {
    let digits = count(number as u64);
    if number == 1 { format!("{digits} {noun}") } else { format!("{digits} {noun}s") }
}
