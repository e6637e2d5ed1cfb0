//! What to know before trusting a surrogate, and what to do about it.

use super::build::is_quadrature;
use super::fit::FitReport;
use super::numbers::significant;
use super::sight::Sight;
use super::smallest_share::{SmallestShare, hardly_seen};
use pcc_evaluate::foundation::count;
use pcc_evaluate::surrogate::{Setting, SettingValue, StopReason, Surrogate};

/// S² below which a component is called poorly fitted.
const POOR: f64 = 0.9;

/// Estimated relative error of the proportion from which a study that set no tolerance is warned.
const LARGE_ERROR: f64 = 0.05;

/// The word for why a build ended early, if it did.
fn ended_early(surrogate: &Surrogate) -> Option<&str> {
    let setting = surrogate.training.settings.iter().find(|setting| setting.key == "ended")?;
    match &setting.value {
        SettingValue::Text(reason) => Some(reason),
        _ => None,
    }
}

/// Why a build ended before everything was as good as the study asks for.
fn ended(reason: &str, surrogate: &Surrogate) -> String {
    let runs = count(surrogate.training.counts.direct_computations);
    let best = match surrogate.training.levels.last() {
        Some(&last) if last < surrogate.training.counts.direct_computations => {
            format!(", of which the first {} gave the best fit,", count(last))
        }
        _ => String::new(),
    };
    let why = match reason {
        "error-stalled" => {
            "because the estimated error of the proportion hardly falls any more, as where answers are noisy or have \
             kinks"
        }
        "fits-cost-more" => {
            "because fits take far longer than the runs of this model; set design.maximum to let it go on"
        }
        "largest-design" => "because design.maximum allows no more",
        "data-exhausted" => "because no other runs were given; give more, or narrow the laws of the inputs",
        "interrupted" => "because it was stopped",
        other => other,
    };
    format!("the build ended after {runs} model runs{best} {why}")
}

impl FitReport {
    /// What a user must know before trusting the surrogate: components that are fitted poorly or not judged at all.
    pub fn warnings(fits: &[Self]) -> Vec<String> {
        let warning = |fit: &Self| {
            let name = &fit.name;
            match fit.s2 {
                _ if fit.has_stalled() => None,
                Some(s2) if s2 < 0.0 => Some(format!(
                    "{name} is predicted worse than by its mean (S² {s2:.2}); do not trust what depends on it"
                )),
                Some(s2) if s2 < POOR => Some(format!("{name} is poorly fitted (S² {s2:.2})")),
                None if fit.r2.is_some() => Some(format!("{name} could not be judged by leaving out points")),
                _ => None,
            }
        };
        fits.iter().filter_map(warning).chain(Self::stalled(fits)).collect()
    }

    /// Components of which more runs would not be known better.
    fn stalled(fits: &[Self]) -> Option<String> {
        let names: Vec<&str> = fits.iter().filter(|fit| fit.has_stalled()).map(|fit| fit.name.as_str()).collect();
        (!names.is_empty()).then(|| {
            format!(
                "the errors of {} no longer fall with more runs: what is left of them is noise of the model's answers, or \
                 detail beyond designs of this size",
                names.join(", ")
            )
        })
    }

    /// The same for a method, which says what else there is to know and what can be done.
    fn warnings_by_method(surrogate: &Surrogate, fits: &[Self]) -> Vec<String> {
        let has = |stop: StopReason| fits.iter().any(|fit| fit.stop == stop.describe());
        if is_quadrature(surrogate) {
            let is_poor = |fit: &&Self| fit.r2.is_some_and(|r2| r2 < POOR);
            let misfit = |fit: &Self| {
                format!("{} is poorly fitted at the nodes already (R² {:.2})", fit.name, fit.r2.unwrap_or(0.0))
            };
            let mut warnings: Vec<String> = fits.iter().filter(is_poor).map(misfit).collect();
            warnings.push(
                "quadrature leaves no point out, so nothing is known of the error between its nodes; check with pcc \
                 compare or certify"
                    .to_owned(),
            );
            if has(StopReason::Limited) {
                warnings.push(
                    "elements that fit.theta_1 asks to divide are left; raise fit.elements or design.maximum for more"
                        .to_owned(),
                );
            }
            return warnings;
        }
        let mut warnings = Self::warnings(fits);
        match surrogate.training.method.as_str() {
            "gpc" if has(StopReason::DesignExhausted) => {
                warnings.push("the points hardly determine all terms; raise fit.oversampling or lower the degree".to_owned());
            }
            "gpc" => warnings.push(
                "one design does not tell how far the proportion is off, and S² says little of it; check with pcc compare \
                 or certify"
                    .to_owned(),
            ),
            _ if has(StopReason::DesignExhausted) && ended_early(surrogate).is_none() => warnings
                .push("the design reached design.maximum before the fit was accurate; raise it for more".to_owned()),
            _ => {}
        }
        warnings
    }

    /// The same, and what is known of the proportion.
    pub fn warnings_of(surrogate: &Surrogate) -> Vec<String> {
        let mut warnings: Vec<String> = super::coverage::warning(surrogate).into_iter().collect();
        warnings.extend(super::given::warnings(surrogate));
        warnings.extend(Self::warnings_by_method(surrogate, &Self::of(surrogate)));
        let setting = |key: &str| surrogate.training.settings.iter().find(|setting| setting.key == key);
        let asked = setting("proportion_tolerance");
        let tolerance = asked.and_then(|setting| match setting.value {
            SettingValue::Number(tolerance) => Some(tolerance),
            _ => None,
        });
        let counts = surrogate.training.counts;
        let unlisted = setting("unlisted_runs");
        if let Some(Setting { value: SettingValue::Integer(unlisted), .. }) = unlisted {
            let error = surrogate.decision.proportion_error.map_or(String::new(), |error| {
                format!(", and the proportion may be off by {} % of itself", significant(100.0 * error, 2))
            });
            let advice = match surrogate.verdict.band {
                Some(_) => "widen spectrum.frequencies",
                None => "target = \"invariants\" without spectrum.modes holds all eigenvalues",
            };
            warnings.push(format!(
                "in {unlisted} of {} model runs an eigenvalue that the surrogate does not hold decides whether the \
                 system is stable{error}; {advice}",
                counts.final_mesh
            ));
        }
        if setting("derivatives").is_some() && counts.gradients < counts.values {
            let close = match setting("without_derivatives") {
                Some(Setting { value: SettingValue::Text(names), .. }) => names.as_str(),
                _ => "a group of modes",
            };
            warnings.push(format!(
                "in {} of {} model runs {close} came too close to other modes for derivatives; values alone entered the fit \
                 there",
                counts.values - counts.gradients,
                counts.values
            ));
        }
        if setting("labels").is_some() {
            warnings.push(
                "eigenvalues could not be followed by their vectors in every run; they are told apart by |λ|, and those \
                 that change places are fitted together"
                    .to_owned(),
            );
        }
        warnings.extend(Self::distrusted(surrogate));
        // Of a blind build all is said by what is not known.
        let reason = ended_early(surrogate).filter(|reason| *reason != "blind");
        warnings.extend(reason.map(|reason| ended(reason, surrogate)));
        let sight = Sight::of(surrogate);
        warnings.extend(sight.and_then(Sight::warning));
        warnings.extend(hardly_seen(surrogate));
        let smallest = SmallestShare::of(surrogate);
        match (surrogate.decision.proportion_error, tolerance) {
            _ if sight.is_some() => {}
            (Some(_), _) if unlisted.is_none() && smallest.is_some() => {
                let off = SmallestShare::all(surrogate).into_iter().filter(SmallestShare::is_off);
                warnings.extend(off.filter_map(|share| share.warning()));
            }
            (Some(error), tolerance) if unlisted.is_none() && error > tolerance.unwrap_or(LARGE_ERROR) => warnings.push(format!(
                "the proportion may be off by {} % of itself; if it is very small, that is how well it can be judged; \
                 else raise design.maximum or choose another fit.method, and check with pcc compare or certify",
                significant(100.0 * error, 2)
            )),
            (None, Some(_)) => warnings.push(
                "the error of the proportion could not be estimated: that takes two design levels".to_owned(),
            ),
            _ => {}
        }
        warnings
    }

    /// Components whose derivatives got no weight because they contradict the values.
    fn distrusted(surrogate: &Surrogate) -> Option<String> {
        let weights = surrogate.training.settings.iter().find(|setting| setting.key == "derivative_weights")?;
        let SettingValue::Text(weights) = &weights.value else { return None };
        // One word for all components, or a word each.
        let words: Vec<&str> = weights.split(' ').collect();
        let has_none = |id: usize| words.get(if words.len() == 1 { 0 } else { id }) == Some(&"0");
        let names: Vec<String> =
            surrogate.components().iter().filter(|c| has_none(c.id)).map(|component| component.name.clone()).collect();
        (!names.is_empty()).then(|| {
            format!(
                "the derivatives of {} do not fit the values, as where answers have kinks or noise, and were not used",
                names.join(", ")
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::build::with_derivatives;
    use pcc_evaluate::artifact::decode;

    #[test]
    fn runs_without_derivatives_are_counted_and_reported() {
        let mut surrogate = decode(include_bytes!("../../surrogates/clutch-r1.pcc")).unwrap().surrogate;
        assert_eq!(FitReport::warnings_of(&surrogate), Vec::<String>::new());
        let runs = surrogate.training.counts.values;
        assert_eq!(with_derivatives(surrogate.training.counts.gradients, runs), " with derivatives");
        surrogate.training.counts.gradients -= 2;
        assert_eq!(with_derivatives(surrogate.training.counts.gradients, runs), ", 11 with derivatives");
        let said = "in 2 of 13 model runs a group of modes came too close to other modes for derivatives";
        assert!(FitReport::warnings_of(&surrogate)[0].starts_with(said));

        surrogate.training.counts.gradients += 2;
        let weights = surrogate.training.settings.iter_mut().find(|setting| setting.key == "derivative_weights");
        weights.unwrap().value = SettingValue::Text("1 0 1 1 1 1 0.1 0".to_owned());
        let said = "the derivatives of im_1, im_c0_3_4 do not fit the values";
        assert!(FitReport::warnings_of(&surrogate)[0].starts_with(said));

        let labels = Setting { key: "labels".to_owned(), value: SettingValue::Text("modulus".to_owned()) };
        surrogate.training.settings.push(labels);
        assert!(FitReport::warnings_of(&surrogate)[0].contains("told apart by |λ|"));
    }
}
