//! What a level of a build has shown and what the build waits for, in a line.

use super::components::ComponentResult;
use super::judgement::Judgement;
use pcc_evaluate::components::{Component, Output};
use pcc_evaluate::foundation::plural;
use pcc_evaluate::surrogate::StopReason;
use std::time::Duration;

/// Wall-clock time of a level, which nothing but this line depends on.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Spent {
    /// Of model runs.
    pub runs: Duration,
    /// Of everything else.
    pub fits: Duration,
}

/// The component that is farthest from accurate, with its S².
pub(super) fn slowest<'o>(outputs: &'o [Output], fitted: &[ComponentResult]) -> Option<(&'o Component, f64)> {
    let waits = |component: &'o Component| {
        let fit = &fitted[component.id].result;
        let s2 = fit.errors.and_then(|errors| errors.s2).unwrap_or(f64::NEG_INFINITY);
        (fit.stop == StopReason::DesignExhausted).then_some((component, s2))
    };
    outputs.iter().flat_map(|output| &output.components).filter_map(waits).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The line.
pub(super) fn remark(
    (runs, tolerance): (usize, Option<f64>),
    slowest: Option<(&Component, f64)>,
    judgement: &Judgement,
    spent: Spent,
) -> String {
    let blind = judgement.sight.filter(|sight| sight.is_blind());
    let error = match judgement.share.zip(judgement.error) {
        _ if blind.is_some() => {
            let unstable = blind.map_or(0, |sight| sight.unstable);
            format!("{unstable} of them unstable, too few on one side to tell how often")
        }
        Some((share, error)) => {
            let stable = share.value;
            let (name, rarer) = if stable <= 0.5 { ("stable", stable) } else { ("unstable", 1.0 - stable) };
            let asked = tolerance
                .map_or(String::new(), |tolerance| format!(", asked for ± {}", percent(tolerance * share.deviation())));
            format!("{name} {} ± {}{asked}", percent(rarer), percent(error))
        }
        None => "error of the proportion not known yet".to_owned(),
    };
    let waits = match slowest {
        Some((component, s2)) if s2.is_finite() => format!("; slowest: {}, S² {s2:.4}", component.name),
        Some((component, _)) => format!("; slowest: {}, not judged yet", component.name),
        None if judgement.is_doubtful => "; some eigenvalues are not known well enough near zero".to_owned(),
        None => String::new(),
    };
    let seconds = |time: Duration| format!("{:.1} s", time.as_secs_f64());
    format!("{}: {error}{waits}; runs {}, fits {}", plural(runs, "run"), seconds(spent.runs), seconds(spent.fits))
}

/// A share in percent, with two digits.
fn percent(share: f64) -> String {
    if share == 0.0 {
        return "0 %".to_owned();
    }
    let percent = 100.0 * share;
    let decimals = (1.0 - percent.max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{percent:.decimals$} %")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compilation::judgement::JudgedShare;

    #[test]
    fn a_line_has_what_the_build_waits_for() {
        let share = JudgedShare { value: 0.8, points: 50_000 };
        let judgement = Judgement { share: Some(share), error: Some(0.0012), ..Judgement::default() };
        let component = Component { id: 0, name: "re_1".to_owned(), center: 0.0, scale: 1.0 };
        let spent = Spent { runs: Duration::from_millis(1500), fits: Duration::from_millis(240) };
        assert_eq!(
            remark((36, Some(1e-3)), Some((&component, 0.97)), &judgement, spent),
            "36 runs: unstable 20 % ± 0.12 %, asked for ± 0.040 %; slowest: re_1, S² 0.9700; runs 1.5 s, fits 0.2 s"
        );
    }
}
