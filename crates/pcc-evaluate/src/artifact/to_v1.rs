//! From a surrogate to the sections of format 1.

use super::error::WriteError;
use super::meaning::not_finite;
use super::version::{MAJOR, minor};
use super::{binary, certified, descriptions, domain, inputs, left_out, v1, v2};
use crate::components::{Margin, Output, OutputKind};
use crate::polynomials::{Branch, Element, IndexSet, Mesh};
use crate::surrogate::{Band, LeaveOut, SettingValue, StopReason, Surrogate, VerdictBasis};
use std::collections::HashMap;

pub(super) fn document(surrogate: &Surrogate) -> Result<v1::Document, WriteError> {
    let provenance = &surrogate.provenance;
    let mut document = v1::Document {
        format: v1::FormatVersion { major: MAJOR, minor: minor(surrogate) },
        meta: v1::Meta {
            tool_version: provenance.tool_version.clone(),
            study_name: provenance.study_name.clone(),
            problem_hash: provenance.problem_hash.clone(),
            study_hash: provenance.study_hash.clone(),
            content_id: String::new(),
        },
        inputs: inputs::section(surrogate),
        outputs: outputs(surrogate),
        elements: elements(&surrogate.mesh),
        expansions: expansions(surrogate),
        training: training(surrogate),
        decision: decision(surrogate),
        self_test: v1::SelfTest {
            points: surrogate.self_test.points.clone(),
            components: surrogate.self_test.components.clone(),
            max_re: surrogate.self_test.max_re.clone(),
            tolerance: surrogate.self_test.tolerance,
        },
        certificates: certified::section(&surrogate.certificates),
        verdict: verdict(surrogate.verdict),
        coverage: surrogate.coverage.as_ref().map(|coverage| v2::Coverage {
            answered: coverage.answered.clone(),
            unanswered: coverage.unanswered.clone(),
        }),
        descriptions: descriptions::section(&surrogate.inputs),
        domain: domain::section(surrogate),
        left_out: left_out::section(surrogate),
    };
    if let Some(section) = not_finite(&document) {
        return Err(WriteError::NotFinite { section });
    }
    document.meta.content_id = binary::content_id(&document)?;
    Ok(document)
}

/// In version 1 of the section, if that can say it.
fn outputs(surrogate: &Surrogate) -> v2::AnyOutputs {
    let in_v1: Option<Vec<v1::Output>> = surrogate.outputs.iter().map(output_v1).collect();
    match in_v1 {
        Some(outputs) => v2::AnyOutputs::V1(v1::Outputs { outputs }),
        None => v2::AnyOutputs::V2(v2::Outputs { outputs: surrogate.outputs.iter().map(output_v2).collect() }),
    }
}

fn output_v1(output: &Output) -> Option<v1::Output> {
    Some(v1::Output {
        kind: match output.kind {
            OutputKind::Eigenvalue => v1::OutputKind::Eigenvalue,
            OutputKind::Cluster => v1::OutputKind::Cluster,
            OutputKind::Closed => return None,
        },
        modes: output.modes.iter().map(|&mode| mode as u32).collect(),
        name: output.name.clone(),
        unit: output.unit.clone(),
        components: components(output),
    })
}

fn output_v2(output: &Output) -> v2::Output {
    v2::Output {
        kind: match output.kind {
            OutputKind::Eigenvalue => v2::OutputKind::Eigenvalue,
            OutputKind::Cluster => v2::OutputKind::Cluster,
            OutputKind::Closed => v2::OutputKind::Closed,
        },
        modes: output.modes.iter().map(|&mode| mode as u32).collect(),
        reals: output.reals.iter().map(|&number| number as u32).collect(),
        name: output.name.clone(),
        unit: output.unit.clone(),
        components: components(output),
    }
}

fn components(output: &Output) -> Vec<v1::Component> {
    let component = |component: &crate::components::Component| v1::Component {
        id: component.id as u32,
        name: component.name.clone(),
        center: component.center,
        scale: component.scale,
    };
    output.components.iter().map(component).collect()
}

fn elements(mesh: &Mesh) -> v1::Elements {
    let branch = |branch| match branch {
        Branch::Element(at) => v1::Branch::Element(at as u32),
        Branch::Split(at) => v1::Branch::Split(at as u32),
    };
    let splits = mesh.splits().iter().map(|split| v1::Split {
        input: split.input as u32,
        at: split.at,
        below: branch(split.below),
        above: branch(split.above),
    });
    v1::Elements { elements: mesh.elements().iter().map(element).collect(), splits: splits.collect() }
}

fn element(element: &Element) -> v1::Element {
    let side = |j: usize| v1::Side {
        bounds: Some(v1::Bounds { lower: element.lower[j], upper: element.upper[j] }),
        center: element.center(j),
        half_width: element.half_width(j),
    };
    v1::Element { weight: element.weight, sides: (0..element.lower.len()).map(side).collect() }
}

/// Expansions with equal index sets share one.
fn expansions(surrogate: &Surrogate) -> v1::Expansions {
    let mut pool: Vec<&IndexSet> = Vec::new();
    let mut positions: HashMap<&IndexSet, usize> = HashMap::new();
    let components = surrogate.component_count();
    let expansions = surrogate
        .expansions
        .iter()
        .enumerate()
        .map(|(number, expansion)| {
            let indices = &expansion.indices;
            let index_set = *positions.entry(indices).or_insert_with(|| {
                pool.push(indices);
                pool.len() - 1
            });
            v1::Expansion {
                element: (number / components) as u32,
                component: (number % components) as u32,
                index_set: index_set as u32,
                coefficients: expansion.coefficients.clone(),
                r2: expansion.r2,
                s2: expansion.s2,
                corrected_s2: expansion.corrected_s2,
                leave_out: match expansion.leave_out {
                    LeaveOut::Row => v1::LeaveOut::Row,
                    LeaveOut::Run => v1::LeaveOut::Run,
                },
                degree: expansion.degree,
                stop: match expansion.stop {
                    StopReason::Accurate => v1::Stop::Accurate,
                    StopReason::HighestDegree => v1::Stop::HighestDegree,
                    StopReason::DesignExhausted => v1::Stop::DesignExhausted,
                    StopReason::Constant => v1::Stop::Constant,
                    StopReason::GivenDegree => v1::Stop::GivenDegree,
                    StopReason::Settled => v1::Stop::Settled,
                    StopReason::Limited => v1::Stop::Limited,
                    StopReason::Stalled => v1::Stop::Stalled,
                },
            }
        })
        .collect();
    let listed = |set: &IndexSet| set.iter().map(|alpha| alpha.to_vec()).collect();
    v1::Expansions { index_sets: pool.into_iter().map(listed).collect(), expansions }
}

fn training(surrogate: &Surrogate) -> v1::Training {
    let training = &surrogate.training;
    let setting = |setting: &crate::surrogate::Setting| v1::Setting {
        key: setting.key.clone(),
        value: match &setting.value {
            SettingValue::Integer(value) => v1::SettingValue::Integer(*value),
            SettingValue::Number(value) => v1::SettingValue::Number(*value),
            SettingValue::Text(value) => v1::SettingValue::Text(value.clone()),
            SettingValue::Flag(value) => v1::SettingValue::Flag(*value),
        },
    };
    let counts = training.counts;
    v1::Training {
        method: training.method.clone(),
        settings: training.settings.iter().map(setting).collect(),
        design: training.design.clone(),
        seed: training.seed,
        levels: training.levels.clone(),
        counts: v1::Counts {
            values: counts.values,
            gradients: counts.gradients,
            failed: counts.failed,
            final_mesh: counts.final_mesh,
            direct_computations: counts.direct_computations,
        },
    }
}

fn decision(surrogate: &Surrogate) -> v1::Decision {
    let quantiles = surrogate.decision.max_re_residuals.iter();
    v1::Decision {
        max_re_residuals: quantiles.map(|q| v1::Quantile { level: q.level, value: q.value }).collect(),
        proportion_error: surrogate.decision.proportion_error,
    }
}

/// Nothing, if there is nothing to say.
fn verdict(verdict: VerdictBasis) -> Option<v2::Verdict> {
    let (kind, value) = match verdict.margin {
        Margin::GrowthRate(value) => (v2::MarginKind::GrowthRate, value),
        Margin::DampingRatio(value) => (v2::MarginKind::DampingRatio, value),
    };
    let band = |band: Band| v2::Band {
        lower: band.lower,
        upper: band.upper,
        modes: band.modes as u32,
        reals: band.reals as u32,
    };
    let stored = v2::Verdict {
        rigid_body_modes: verdict.rigid_body_modes as u32,
        tolerance: verdict.tolerance,
        margin: v2::Margin { kind, value },
        band: verdict.band.map(band),
        is_self_adjoint: verdict.is_self_adjoint,
    };
    (verdict != VerdictBasis::default()).then_some(stored)
}
