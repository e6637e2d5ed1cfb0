//! From fitted components to a surrogate that carries its own history.

use super::decision::decision;
use super::evaluations::Evaluations;
use crate::design::NestedLatinHypercube;
use crate::fit::{Fitted, Stop};
use crate::study::{FitMethod, Study};
use crate::surrogate::{
    Counts, Expansion, LeaveOut, Provenance, SelfTest, Setting, SettingValue, StopReason, Surrogate, Training,
};

/// Points of the self-test.
const SELF_TEST_POINTS: usize = 16;

/// The self-test has the same points in every surrogate of the same dimension.
const SELF_TEST_SEED: u64 = 0;

pub(super) fn surrogate(
    study: &Study,
    evaluations: &Evaluations<'_>,
    fitted: Vec<Fitted>,
    levels: Vec<u64>,
) -> Surrogate {
    let outputs = evaluations.outputs();
    let decision = decision(&outputs, &fitted, evaluations.runs());
    let mut surrogate = Surrogate {
        provenance: Provenance {
            tool_version: env!("CARGO_PKG_VERSION").to_owned(),
            study_name: study.name.clone(),
            problem_hash: study.problem_hash(),
            study_hash: study.study_hash(),
        },
        inputs: study.inputs.clone(),
        outputs,
        expansions: fitted.into_iter().map(expansion).collect(),
        training: training(study, evaluations.runs().len() as u64, levels),
        decision,
        self_test: SelfTest { points: Vec::new(), components: Vec::new(), max_re: Vec::new(), tolerance: 0.0 },
        certificates: Vec::new(),
    };
    surrogate.self_test = surrogate.make_self_test(self_test_points(study));
    surrogate
}

fn expansion(fitted: Fitted) -> Expansion {
    Expansion {
        indices: fitted.indices,
        coefficients: fitted.coefficients,
        r2: fitted.errors.map(|errors| errors.r2),
        s2: fitted.errors.and_then(|errors| errors.s2),
        corrected_s2: fitted.errors.and_then(|errors| errors.corrected_s2),
        leave_out: LeaveOut::Row,
        degree: fitted.degree,
        stop: match fitted.stop {
            Stop::Accurate => StopReason::Accurate,
            Stop::HighestDegree => StopReason::HighestDegree,
            Stop::DesignExhausted => StopReason::DesignExhausted,
            Stop::Constant => StopReason::Constant,
        },
    }
}

fn training(study: &Study, runs: u64, levels: Vec<u64>) -> Training {
    let setting = |key: &str, value| Setting { key: key.to_owned(), value };
    let number = |key: &str, value| setting(key, SettingValue::Number(value));
    let fit = &study.fit;
    Training {
        method: FitMethod::Stepwise.name().to_owned(),
        settings: vec![
            setting("max_degree", SettingValue::Integer(fit.max_degree.into())),
            number("q_norm", fit.q_norm),
            number("s2_target", fit.s2_target),
            number("epsilon_forward", fit.epsilon_forward),
            number("epsilon_backward", fit.epsilon_backward),
        ],
        design: study.design.kind.name().to_owned(),
        seed: study.seed,
        levels,
        counts: Counts { values: runs, gradients: 0, failed: 0, final_mesh: runs, direct_computations: runs },
    }
}

fn self_test_points(study: &Study) -> Vec<Vec<f64>> {
    let mut design = NestedLatinHypercube::new(study.inputs.dimension(), SELF_TEST_SEED);
    design.grow_to(SELF_TEST_POINTS);
    let inputs = study.inputs.inputs();
    let samples = design.samples(|j, unit| inputs[j].marginal.standardized_quantile(unit));
    samples.points().map(|point| study.inputs.physical(point)).collect()
}
