//! From fitted components to a surrogate that carries its own history.

use super::blindness::Sight;
use super::components::ComponentResult;
use super::evaluations::{Evaluations, Level};
use super::given_use::GivenUse;
use super::judgement::Judgement;
use super::stopping::EarlyEnd;
use super::uncovered::Uncovered;
use super::undecided::excess_of_marginal;
use super::validation::Validation;
use crate::campaign::Run;
use crate::fitting::design::NestedLatinHypercube;
use crate::fitting::fit::method::{MethodSetting, Value};
use crate::fitting::fit::{FitMethod, Fitted};
use crate::fitting::regression::Gradients;
use crate::study::Study;
use pcc_evaluate::components::{Component, Output};
use pcc_evaluate::polynomials::Mesh;
use pcc_evaluate::surrogate::{
    Counts, Decision, Expansion, LeaveOut, LeftOut, Provenance, SelfTest, Setting, SettingValue, Surrogate,
    TrainedDomain, Training, VerdictBasis,
};

fn setting(key: &str, value: SettingValue) -> Setting {
    Setting { key: key.to_owned(), value }
}

fn number(key: &str, value: f64) -> Setting {
    setting(key, SettingValue::Number(value))
}

/// Points of the self-test.
const SELF_TEST_POINTS: usize = 16;

/// What is missed at marginal runs may be so many times as much elsewhere.
const SAFETY: f64 = 10.0;

/// Beside the excess of other runs, as a rule, zero is known to this share of it.
const KNOWN: f64 = 1e-4;

/// The self-test has the same points in every surrogate of the same dimension.
const SELF_TEST_SEED: u64 = 0;

/// The surrogate of a mesh, not yet judged: `fitted` has one fit per component for every element.
pub(super) fn of_elements(
    study: &Study,
    mesh: Mesh,
    outputs: Vec<Output>,
    fitted: &[Vec<Fitted>],
    counts: Counts,
    levels: Vec<u64>,
) -> Surrogate {
    let method = &study.fit.method;
    let training = Training {
        method: method.name().to_owned(),
        settings: settings_of(method),
        design: study.design.kind.name().to_owned(),
        seed: study.seed,
        levels,
        counts,
    };
    new(study, mesh, outputs, fitted.iter().flatten(), training)
}

/// The surrogate of one level, not yet judged.
pub(super) fn surrogate(
    study: &Study,
    (evaluations, masses): (&Evaluations<'_>, Option<&[f64]>),
    level: &Level,
    fitted: &[ComponentResult],
    sizes: &[u64],
) -> Surrogate {
    let runs = (evaluations.runs().len(), evaluations.failed() as u64);
    let mut training = training(study, fitted, level.gradients.as_deref(), runs, sizes.to_vec());
    let lacking = without_derivatives(level, evaluations.runs().len());
    if !lacking.is_empty() {
        training.settings.push(setting("without_derivatives", SettingValue::Text(lacking.join(" and "))));
    }
    if level.is_by_modulus {
        training.settings.push(setting("labels", SettingValue::Text("modulus".to_owned())));
    }
    let whole = Mesh::whole(study.inputs.dimension());
    let mut surrogate = new(study, whole, level.outputs.clone(), fitted.iter().map(|fit| &fit.result), training);
    let is_given = evaluations.sizes().given > 0 && evaluations.sizes().design == 0;
    surrogate.trained_domain = match is_given {
        true => TrainedDomain::of_given(&study.inputs, level.samples.points()),
        false => TrainedDomain::of(&study.inputs, level.samples.points()),
    };
    surrogate.left_out = left_out(evaluations, fitted, masses);
    surrogate.verdict.band = level.band;
    surrogate.verdict.tolerance = tolerance(evaluations.runs());
    surrogate.verdict.is_self_adjoint = evaluations.is_self_adjoint();
    if let Some(missed) = missed_of_marginal(&surrogate, level, fitted, evaluations.runs()) {
        surrogate.verdict.tolerance = surrogate.verdict.tolerance.max(missed);
    }
    surrogate
}

/// What the surrogate cannot tell from zero, with [`SAFETY`], where the model is marginal at runs and the surrogate
/// knows zero well there, with these runs and without them; `None` if it does not, or misses nothing.
fn missed_of_marginal(surrogate: &Surrogate, level: &Level, fitted: &[ComponentResult], runs: &[Run]) -> Option<f64> {
    let left_out = fitted.iter().map(|fit| fit.result.leave_one_out_residuals.as_ref());
    let left_out: Vec<&Vec<f64>> = left_out.collect::<Option<_>>()?;
    if left_out.len() != level.values.len() || left_out.iter().any(|rest| rest.len() != runs.len()) {
        return None;
    }
    let residuals: Vec<Vec<f64>> = (0..runs.len()).map(|i| left_out.iter().map(|rest| rest[i]).collect()).collect();
    let all: Vec<usize> = (0..runs.len()).collect();
    let mut missed = excess_of_marginal(surrogate, &level.values, &residuals, runs, &all);
    let marginal = level.samples.points().zip(runs).filter(|(_, run)| run.spectrum.top().excess == 0.0);
    missed.extend(marginal.map(|(point, _)| surrogate.top(&surrogate.evaluate(point)).excess));
    let missed = SAFETY * missed.into_iter().map(f64::abs).reduce(f64::max).filter(|missed| *missed > 0.0)?;
    let mut others: Vec<f64> = runs.iter().map(|run| run.spectrum.top().excess.abs()).filter(|e| *e > 0.0).collect();
    others.sort_by(f64::total_cmp);
    others.get(others.len() / 2).filter(|median| missed <= KNOWN * **median).map(|_| missed)
}

/// What the components miss at points of the design that are left out: those near the boundary were chosen, and do not
/// stand for others. Runs that were given stand for as much as their masses say: of each so many are taken.
fn left_out(evaluations: &Evaluations<'_>, fitted: &[ComponentResult], masses: Option<&[f64]>) -> Option<LeftOut> {
    let residuals = fitted.iter().map(|fit| fit.result.leave_one_out_residuals.as_ref());
    let residuals: Vec<&Vec<f64>> = residuals.collect::<Option<_>>()?;
    let mut runs: Vec<usize> = (0..evaluations.runs().len()).filter(|&i| !evaluations.is_chosen(i)).collect();
    if let Some(masses) = masses {
        runs = by_mass(&runs, masses);
    }
    LeftOut::new(runs.into_iter().map(|i| residuals.iter().map(|list| list[i]).collect()).collect())
}

/// As many of these as count effectively, (Σm)²/Σm², evenly spread over their masses.
fn by_mass(runs: &[usize], masses: &[f64]) -> Vec<usize> {
    let (sum, squares) =
        runs.iter().fold((0.0, 0.0), |(sum, squares), &i| (sum + masses[i], squares + masses[i].powi(2)));
    let count = if squares > 0.0 { (sum * sum / squares).floor() as usize } else { 0 };
    let mut chosen = Vec::with_capacity(count);
    let mut before = 0.0;
    for &i in runs {
        before += masses[i];
        while chosen.len() < count && (chosen.len() as f64 + 0.5) * sum < before * count as f64 {
            chosen.push(i);
        }
    }
    chosen
}

/// Names of the groups that came too close to other modes for derivatives at some run.
fn without_derivatives(level: &Level, runs: usize) -> Vec<String> {
    let Some(gradients) = &level.gradients else { return Vec::new() };
    let lacks =
        |output: &&Output| output.components.iter().any(|component| gradients[component.id].points.len() < runs);
    level.outputs.iter().filter(lacks).map(|output| output.name.clone()).collect()
}

/// What could not be told from zero at the runs that are marginal, as a rule; 0 where none is.
fn tolerance(runs: &[Run]) -> f64 {
    let errors = runs.iter().filter_map(|run| run.spectrum.marginal_error()).filter(|error| error.is_finite());
    let mut errors: Vec<f64> = errors.collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied().unwrap_or(0.0)
}

/// Takes down what is known of runs that were given.
pub(super) fn given(surrogate: &mut Surrogate, found: &GivenUse) {
    let settings = &mut surrogate.training.settings;
    settings.push(setting("given_runs", SettingValue::Integer(found.fitted)));
    if let Some(Validation { runs, misjudged, rms_error, .. }) = found.validation {
        settings.push(setting("validating_runs", SettingValue::Integer(runs)));
        settings.push(setting("validating_misjudged", SettingValue::Integer(misjudged)));
        settings.push(number("validating_rms_error", rms_error));
    }
    if let Some(Uncovered { share, place }) = &found.uncovered {
        settings.push(number("uncovered_share", *share));
        let ends = |(name, [lower, upper]): &(String, [f64; 2])| format!("{name} {lower:?} {upper:?}");
        if !place.is_empty() {
            let place = place.iter().map(ends).collect::<Vec<_>>().join(", ");
            settings.push(setting("uncovered_place", SettingValue::Text(place)));
        }
    }
}

/// A surrogate of one output alone, for trials.
pub(super) fn of_fits(study: &Study, output: &Output, fitted: &[ComponentResult]) -> Surrogate {
    let training = training(study, fitted, None, (0, 0), Vec::new());
    let whole = Mesh::whole(study.inputs.dimension());
    new(study, whole, vec![output.clone()], fitted.iter().map(|fit| &fit.result), training)
}

/// Takes down what is known of a surrogate's decision, and what of the spectra of `runs` takes no part in it. Files of
/// systems whose modes all oscillate do not say the latter, as they never did.
pub(super) fn judged(surrogate: &mut Surrogate, judgement: &Judgement, runs: &[Run]) {
    surrogate.decision.clone_from(&judgement.decision);
    if surrogate.has_real_eigenvalues() || surrogate.verdict != VerdictBasis::default() {
        surrogate.verdict.rigid_body_modes = super::rigid_body_modes(runs);
    }
    // Whoever asks for an error of a share is told what share it is of.
    if let (Some(share), true) = (judgement.share, has_tolerance(surrogate)) {
        surrogate.training.settings.push(number("stable_share", share.value));
    }
    for named in &judgement.named {
        let name = named.verdict.name();
        let settings = &mut surrogate.training.settings;
        settings.push(number(&format!("{name}_share"), named.share.value));
        match named.error {
            _ if named.is_blind() => {
                settings.push(setting(&format!("{name}_runs"), SettingValue::Integer(named.runs[0] as u64)));
            }
            Some(error) => settings.push(number(&format!("{name}_share_error"), error)),
            None => {}
        }
    }
    if judgement.unlisted > 0 {
        surrogate.training.settings.push(setting("unlisted_runs", SettingValue::Integer(judgement.unlisted)));
    }
}

fn has_tolerance(surrogate: &Surrogate) -> bool {
    surrogate.training.settings.iter().any(|setting| setting.key == "proportion_tolerance")
}

/// Takes down all runs that were spent, and why the build ended early, if it did.
pub(super) fn ended(
    surrogate: &mut Surrogate,
    (evaluations, at_end_levels): (&Evaluations<'_>, usize),
    sight: Option<Sight>,
    early_end: Option<EarlyEnd>,
) {
    surrogate.training.counts.direct_computations = (evaluations.runs().len() + evaluations.failed()) as u64;
    surrogate.training.counts.failed = evaluations.failed() as u64;
    surrogate.coverage = evaluations.coverage();
    let settings = &mut surrogate.training.settings;
    let near_boundary = evaluations.sizes().chosen - at_end_levels;
    for (name, runs) in [("runs_near_boundary", near_boundary), ("runs_at_end_levels", at_end_levels)] {
        if runs > 0 {
            settings.push(setting(name, SettingValue::Integer(runs as u64)));
        }
    }
    if let Some(sight) = sight.filter(Sight::is_blind) {
        settings.push(setting("unstable_runs", SettingValue::Integer(sight.unstable as u64)));
        if let Some(clearance) = sight.clearance {
            settings.extend([number("nearest_excess", clearance.nearest), number("nearest_error", clearance.error)]);
            if surrogate.inputs.is_unbounded() {
                settings.push(setting("nearest_points", SettingValue::Integer(sight.points as u64)));
            }
        }
    }
    let word = early_end.map(|end| setting("ended", SettingValue::Text(end.name().to_owned())));
    surrogate.training.settings.extend(word);
}

fn new<'a>(
    study: &Study,
    mesh: Mesh,
    outputs: Vec<Output>,
    fitted: impl Iterator<Item = &'a Fitted>,
    training: Training,
) -> Surrogate {
    let mut components: Vec<&Component> = outputs.iter().flat_map(|output| &output.components).collect();
    components.sort_by_key(|component| component.id);
    Surrogate {
        provenance: Provenance {
            tool_version: env!("CARGO_PKG_VERSION").to_owned(),
            study_name: study.name.clone(),
            problem_hash: study.problem_hash(),
            study_hash: study.study_hash(),
        },
        inputs: study.inputs.clone(),
        mesh,
        expansions: fitted
            .zip(components.into_iter().cycle())
            .map(|(fit, component)| expansion(fit, component))
            .collect(),
        outputs,
        training,
        decision: Decision::default(),
        self_test: SelfTest { points: Vec::new(), components: Vec::new(), max_re: Vec::new(), tolerance: 0.0 },
        coverage: None,
        trained_domain: None,
        left_out: None,
        certificates: Vec::new(),
        verdict: VerdictBasis { margin: study.spectrum.margin, ..VerdictBasis::default() },
    }
}

fn expansion(fitted: &Fitted, component: &Component) -> Expansion {
    Expansion {
        indices: fitted.indices.clone(),
        coefficients: fitted.coefficients.iter().map(|coefficient| coefficient / component.scale).collect(),
        r2: fitted.errors.map(|errors| errors.r2),
        s2: fitted.errors.and_then(|errors| errors.s2),
        corrected_s2: fitted.errors.and_then(|errors| errors.corrected_s2),
        leave_out: if fitted.derivative_weight.is_some() { LeaveOut::Run } else { LeaveOut::Row },
        degree: fitted.degree,
        stop: fitted.stop,
    }
}

fn training(
    study: &Study,
    fitted: &[ComponentResult],
    gradients: Option<&[Gradients]>,
    (runs, failed): (usize, u64),
    levels: Vec<u64>,
) -> Training {
    let method = &study.fit.method;
    let mut settings = settings_of(method);
    if let Some(tolerance) = study.fit.proportion_tolerance {
        settings.push(number("proportion_tolerance", tolerance));
    }
    if !study.fit.shares.is_empty() {
        let names: Vec<&str> = study.fit.shares.iter().map(|verdict| verdict.name()).collect();
        settings.push(setting("shares", SettingValue::Text(names.join(" "))));
    }
    if method.profile().chooses {
        let solvers: Vec<String> = fitted.iter().map(|fit| fit.solver.to_owned()).collect();
        settings.push(setting("chosen", SettingValue::Text(summary_of(&solvers))));
    }
    // Runs whose derivatives entered the fit of every component that takes any.
    let with_gradients = |i: usize| gradients.is_some_and(|all| all.iter().all(|one| one.points.contains(&i)));
    if gradients.is_some() {
        let weights = fitted.iter().map(|fit| fit.result.derivative_weight.map_or("-".to_owned(), |w| w.to_string()));
        settings.push(setting("derivatives", SettingValue::Flag(true)));
        settings.push(setting("derivative_weights", SettingValue::Text(summary_of(&weights.collect::<Vec<_>>()))));
    }
    let gradients = (0..runs).filter(|&i| with_gradients(i)).count() as u64;
    let runs = runs as u64;
    Training {
        method: method.name().to_owned(),
        settings,
        design: study.design.kind.name().to_owned(),
        seed: study.seed,
        levels,
        counts: Counts { values: runs, gradients, failed, final_mesh: runs, direct_computations: runs + failed },
    }
}

/// The settings of a method as they are in a study.
fn settings_of(method: &FitMethod) -> Vec<Setting> {
    let profile = method.profile();
    let max_degree = setting("max_degree", SettingValue::Integer(profile.max_degree.into()));
    let others = profile.settings.into_iter().map(|MethodSetting { key, value, .. }| match value {
        Value::Whole(value) => setting(key, SettingValue::Integer(value as u64)),
        Value::Number(value) => number(key, value),
        Value::Word(word) => setting(key, SettingValue::Text(word)),
    });
    std::iter::once(max_degree).chain(others).collect()
}

/// One name if all are equal, else all in the order of the components.
fn summary_of(words: &[String]) -> String {
    match words {
        [first, rest @ ..] if rest.iter().all(|word| word == first) => first.clone(),
        _ => words.join(" "),
    }
}

pub(super) fn self_test_points(study: &Study) -> Vec<Vec<f64>> {
    let mut design = NestedLatinHypercube::new(study.inputs.dimension(), SELF_TEST_SEED);
    design.grow_to(SELF_TEST_POINTS);
    let samples = design.placed(|units| study.inputs.place(units));
    samples.points().map(|point| study.inputs.physical(point)).collect()
}
