//! What stability is judged by, in words.

use super::numbers::plain;
use pcc_evaluate::components::{Label, Margin};
use pcc_evaluate::surrogate::{Band, Surrogate, VerdictBasis};
use serde::Serialize;

/// The margin that eigenvalues are judged with: one of the two.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum MarginReport {
    /// In 1/s.
    GrowthRate(f64),
    /// −Re λ/|λ|.
    DampingRatio(f64),
}

impl MarginReport {
    /// That of a study or surrogate, if there is one.
    pub fn of(margin: Margin) -> Option<Self> {
        match margin {
            margin if margin.is_none() => None,
            Margin::GrowthRate(rate) => Some(Self::GrowthRate(rate)),
            Margin::DampingRatio(ratio) => Some(Self::DampingRatio(ratio)),
        }
    }
}

/// The eigenvalues that a surrogate carries, and with which margin.
pub(super) fn judged_by(surrogate: &Surrogate) -> String {
    let labels = surrogate.labels();
    let mut modes: Vec<usize> = labels.iter().filter_map(|label| label.mode()).collect();
    modes.sort_unstable();
    let reals = labels.iter().filter(|label| matches!(label, Label::Real(_))).map(|label| label.growth_rate());
    let modes = (!modes.is_empty()).then(|| modes_text(&modes));
    let carried = modes.into_iter().chain(reals).collect::<Vec<_>>().join(", ");
    with_margin(carried, surrogate.verdict.margin)
}

/// The same with the margin, if there is one.
pub(super) fn with_margin(judged_by: String, margin: Margin) -> String {
    match margin {
        margin if margin.is_none() => judged_by,
        Margin::GrowthRate(rate) => format!("{judged_by}, each to decay faster than {} 1/s", plain(rate)),
        Margin::DampingRatio(ratio) => format!("{judged_by}, each with a damping ratio above {}", plain(ratio)),
    }
}

/// How much of the model is rigid-body motion, if the file says it: it does where it says anything of the verdict.
pub(super) fn rigid_body_modes(surrogate: &Surrogate) -> Option<usize> {
    let says = surrogate.has_real_eigenvalues() || surrogate.verdict != VerdictBasis::default();
    says.then_some(surrogate.verdict.rigid_body_modes)
}

/// What of the model lies outside the band of frequencies that chose a surrogate's modes.
pub(super) fn outside_band(surrogate: &Surrogate) -> Option<String> {
    let Band { lower, upper, modes, reals } = surrogate.verdict.band?;
    let held = surrogate.labels();
    let missing = |label: Label| !held.contains(&label);
    let modes: Vec<usize> = (1..=modes).filter(|&mode| missing(Label::Mode(mode))).collect();
    let reals = (1..=reals).map(Label::Real).filter(|&label| missing(label)).map(Label::growth_rate);
    let modes = (!modes.is_empty()).then(|| modes_text(&modes));
    let outside = modes.into_iter().chain(reals).collect::<Vec<_>>().join(", ");
    Some(match outside.is_empty() {
        true => format!("{lower} to {upper} Hz, which holds all modes"),
        false => format!("{lower} to {upper} Hz; outside and not judged: {outside}"),
    })
}

/// "mode 4", "modes 1–3, 5".
pub(super) fn modes_text(ascending: &[usize]) -> String {
    format!("{} {}", if ascending.len() == 1 { "mode" } else { "modes" }, ranges(ascending))
}

/// Ascending numbers, those that follow each other in one.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b).map(|run| match run {
        [first, .., last] => format!("{first}–{last}"),
        [only] => only.to_string(),
        [] => String::new(),
    });
    runs.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_follow_each_other_are_one_range() {
        assert_eq!(ranges(&[1, 2, 3, 5, 8, 9]), "1–3, 5, 8–9");
        assert_eq!(ranges(&[]), "");
    }

    #[test]
    fn margins_are_said() {
        assert_eq!(with_margin("mode 1".to_owned(), Margin::default()), "mode 1");
        assert!(with_margin("mode 1".to_owned(), Margin::DampingRatio(0.01)).ends_with("damping ratio above 0.01"));
        assert!(with_margin("mode 1".to_owned(), Margin::GrowthRate(0.5)).ends_with("faster than 0.5 1/s"));
    }
}
