//! From the sections of format 1 to a surrogate in which everything holds.

use super::error::ReadError;
use super::inputs::close;
use super::meaning::{ensure, is_hash, is_printable, not_finite};
use super::{certified, descriptions, domain, inputs as section_2, left_out, v1, v2};
use crate::components::{Component, Margin, Output, OutputKind};
use crate::polynomials::{Branch, Element, IndexSet, Mesh, MultiIndex, Split};
use crate::probability::inputs::{Input, InputSpace};
use crate::surrogate::{
    Band, Counts, Coverage, Decision, Expansion, LeaveOut, Provenance, Quantile, SelfTest, Setting, SettingValue,
    StopReason, Surrogate, Training, VerdictBasis,
};

/// Degrees above this are refused, so that a forged index cannot exhaust memory.
pub(super) const HIGHEST_DEGREE: u16 = 1000;

/// Points of a self-test, and the largest difference it may allow and still be a test.
const SELF_TEST_POINTS: usize = 16;
const LARGEST_TOLERANCE: f64 = 1e-6;

/// Stored and computed recurrences and transforms differ by roundings at most.
pub(super) const ROUNDING: f64 = 1e-12;

pub(super) fn surrogate(document: v1::Document) -> Result<Surrogate, ReadError> {
    if let Some(section) = not_finite(&document) {
        return Err(ReadError::Meaning { section, message: "it holds a number that is not finite".to_owned() });
    }
    let provenance = provenance(document.meta)?;
    let inputs = section_2::space(&document.inputs)?;
    let outputs = outputs(document.outputs)?;
    let mesh = mesh(&document.elements, inputs.dimension())?;
    let components: usize = outputs.iter().map(|output| output.components.len()).sum();
    let expansions = expansions(document.expansions, inputs.dimension(), mesh.elements().len(), components)?;
    section_2::check_recurrences(&document.inputs, &inputs, &expansions)?;
    let self_test = self_test(document.self_test, &inputs, components)?;
    let coverage = coverage(document.coverage, &inputs)?;
    let divides_unbounded =
        mesh.elements().len() > 1 && inputs.inputs().iter().any(|input| !input.marginal.is_divisible());
    ensure("elements", !divides_unbounded, || "only bounded standardized variables have elements".to_owned())?;
    let divides_dependent = mesh.elements().len() > 1 && inputs.dependence().is_some();
    ensure("elements", !divides_dependent, || "inputs that depend on each other have no elements".to_owned())?;
    Ok(Surrogate {
        provenance,
        coverage,
        trained_domain: domain::trained(&inputs, document.domain)?,
        left_out: left_out::residuals(document.left_out, components, mesh.elements().len())?,
        inputs: descriptions::described(inputs, document.descriptions)?,
        outputs,
        mesh,
        expansions,
        training: training(document.training)?,
        decision: decision(document.decision)?,
        self_test,
        certificates: certified::certificates(document.certificates)?,
        verdict: verdict(document.verdict)?,
    })
}

fn provenance(meta: v1::Meta) -> Result<Provenance, ReadError> {
    let hashes = [&meta.problem_hash, &meta.study_hash, &meta.content_id];
    ensure("meta", hashes.iter().all(|hash| is_hash(hash)), || "a hash is not a hexadecimal SHA-256".to_owned())?;
    let texts = [&meta.tool_version, &meta.study_name];
    ensure("meta", texts.iter().all(|text| is_printable(text)), || "a name has control characters".to_owned())?;
    Ok(Provenance {
        tool_version: meta.tool_version,
        study_name: meta.study_name,
        problem_hash: meta.problem_hash,
        study_hash: meta.study_hash,
    })
}

fn outputs(section: v2::AnyOutputs) -> Result<Vec<Output>, ReadError> {
    let is_latest = matches!(section, v2::AnyOutputs::V2(_));
    let outputs: Vec<Output> = section.into_latest().into_iter().map(output).collect::<Result<_, _>>()?;
    let has_closed = outputs.iter().any(|output| output.kind == OutputKind::Closed);
    ensure("outputs", has_closed == is_latest, || "no output needs version 2 of the section".to_owned())?;
    let mut ids: Vec<usize> = outputs.iter().flat_map(|output| &output.components).map(|c| c.id).collect();
    ids.sort_unstable();
    let counted = ids.iter().enumerate().all(|(position, &id)| position == id);
    ensure("outputs", counted && !ids.is_empty(), || "component ids do not count from 0".to_owned())?;
    for (numbers, what) in [(|output| &output.modes) as fn(&Output) -> &Vec<usize>, |output| &output.reals]
        .into_iter()
        .zip(["mode", "real"])
    {
        let mut numbers: Vec<usize> = outputs.iter().flat_map(numbers).copied().collect();
        numbers.sort_unstable();
        let distinct = numbers.is_sorted_by(|a, b| a < b) && numbers.first().is_none_or(|&first| first > 0);
        ensure("outputs", distinct, || format!("{what} numbers repeat or are 0"))?;
    }
    Ok(outputs)
}

fn output(output: v2::Output) -> Result<Output, ReadError> {
    let kind = match output.kind {
        v2::OutputKind::Eigenvalue => OutputKind::Eigenvalue,
        v2::OutputKind::Cluster => OutputKind::Cluster,
        v2::OutputKind::Closed => OutputKind::Closed,
        v2::OutputKind::Scalar => return Err(ReadError::Unsupported { what: "scalar outputs".into() }),
    };
    let is_shaped = kind.components(output.modes.len(), output.reals.len()) == Some(output.components.len());
    ensure("outputs", is_shaped, || format!("{}: wrong number of components or modes", output.name))?;
    let printable = [&output.name, &output.unit].into_iter().all(|name| is_printable(name))
        && output.components.iter().all(|component| is_printable(&component.name));
    ensure("outputs", printable, || "a name has control characters".to_owned())?;
    let scaled = output.components.iter().all(|component| component.scale != 0.0);
    ensure("outputs", scaled, || format!("{}: a component has scale 0", output.name))?;
    let component = |component: v1::Component| Component {
        id: component.id as usize,
        name: component.name,
        center: component.center,
        scale: component.scale,
    };
    Ok(Output {
        kind,
        modes: output.modes.into_iter().map(|mode| mode as usize).collect(),
        reals: output.reals.into_iter().map(|number| number as usize).collect(),
        name: output.name,
        unit: output.unit,
        components: output.components.into_iter().map(component).collect(),
    })
}

/// The elements are what the splits leave of the whole box, and their maps and weights fit their bounds.
fn mesh(section: &v1::Elements, dimension: usize) -> Result<Mesh, ReadError> {
    let meaning = |message: String| ReadError::Meaning { section: "elements", message };
    let mut elements = Vec::with_capacity(section.elements.len());
    for (at, stored) in section.elements.iter().enumerate() {
        let bounds: Option<Vec<&v1::Bounds>> = stored.sides.iter().map(|side| side.bounds.as_ref()).collect();
        let bounds = bounds.filter(|bounds| bounds.len() == dimension);
        let bounds = bounds.ok_or_else(|| meaning(format!("element {at} does not have {dimension} bounded sides")))?;
        let (lower, upper) = bounds.iter().map(|bounds| (bounds.lower, bounds.upper)).unzip();
        let element = Element { weight: stored.weight, lower, upper };
        let fits = |(j, side): (usize, &v1::Side)| {
            let half_width = element.half_width(j);
            close(side.center, element.center(j), half_width) && close(side.half_width, half_width, half_width)
        };
        if !stored.sides.iter().enumerate().all(fits) {
            return Err(meaning(format!("element {at}: centre or half width do not fit the bounds")));
        }
        elements.push(element);
    }
    let branch = |branch| match branch {
        v1::Branch::Element(at) => Branch::Element(at as usize),
        v1::Branch::Split(at) => Branch::Split(at as usize),
    };
    let split = |split: &v1::Split| Split {
        input: split.input as usize,
        at: split.at,
        below: branch(split.below),
        above: branch(split.above),
    };
    let splits = section.splits.iter().map(split).collect();
    Mesh::from_parts(dimension, elements, splits).map_err(|error| meaning(error.to_string()))
}

fn expansions(
    section: v1::Expansions,
    inputs: usize,
    elements: usize,
    components: usize,
) -> Result<Vec<Expansion>, ReadError> {
    let index_sets: Vec<IndexSet> =
        section.index_sets.into_iter().map(|set| index_set(set, inputs)).collect::<Result<_, _>>()?;
    let mut expansions = section.expansions;
    expansions.sort_by_key(|expansion| (expansion.element, expansion.component));
    let is_next = |(number, e): (usize, &v1::Expansion)| {
        (e.element as usize, e.component as usize) == (number / components, number % components)
    };
    let complete =
        Some(expansions.len()) == elements.checked_mul(components) && expansions.iter().enumerate().all(is_next);
    ensure("expansions", complete, || {
        format!("there is not one expansion for each of {elements} elements and {components} components")
    })?;
    expansions.into_iter().map(|e| expansion(e, &index_sets)).collect()
}

fn index_set(set: Vec<Vec<u16>>, inputs: usize) -> Result<IndexSet, ReadError> {
    let shaped = set.iter().all(|alpha| alpha.len() == inputs && alpha.iter().all(|&k| k <= HIGHEST_DEGREE));
    ensure("expansions", shaped && !set.is_empty(), || {
        format!("an index set is empty, has indices without {inputs} degrees, or degrees above {HIGHEST_DEGREE}")
    })?;
    IndexSet::from_sorted(set.into_iter().map(MultiIndex::new).collect()).ok_or_else(|| ReadError::Meaning {
        section: "expansions",
        message: "an index set is not in canonical order or repeats an index".to_owned(),
    })
}

fn expansion(expansion: v1::Expansion, index_sets: &[IndexSet]) -> Result<Expansion, ReadError> {
    let component = expansion.component;
    let meaning = |message: &str| ReadError::Meaning {
        section: "expansions",
        message: format!("component {component}: {message}"),
    };
    let indices =
        index_sets.get(expansion.index_set as usize).ok_or_else(|| meaning("its index set does not exist"))?;
    if indices.len() != expansion.coefficients.len() {
        return Err(meaning("it does not have one coefficient per multi-index"));
    }
    if [expansion.r2, expansion.s2, expansion.corrected_s2].into_iter().flatten().any(|share| share > 1.0) {
        return Err(meaning("R² or S² is above 1"));
    }
    Ok(Expansion {
        indices: indices.clone(),
        coefficients: expansion.coefficients,
        r2: expansion.r2,
        s2: expansion.s2,
        corrected_s2: expansion.corrected_s2,
        leave_out: match expansion.leave_out {
            v1::LeaveOut::Row => LeaveOut::Row,
            v1::LeaveOut::Run => LeaveOut::Run,
        },
        degree: expansion.degree,
        stop: match expansion.stop {
            v1::Stop::Accurate => StopReason::Accurate,
            v1::Stop::HighestDegree => StopReason::HighestDegree,
            v1::Stop::DesignExhausted => StopReason::DesignExhausted,
            v1::Stop::Constant => StopReason::Constant,
            v1::Stop::GivenDegree => StopReason::GivenDegree,
            v1::Stop::Settled => StopReason::Settled,
            v1::Stop::Limited => StopReason::Limited,
            v1::Stop::Stalled => StopReason::Stalled,
        },
    })
}

fn training(training: v1::Training) -> Result<Training, ReadError> {
    let counts = training.counts;
    let largest = training.levels.last().copied().unwrap_or(0);
    let printable = is_printable(&training.method)
        && is_printable(&training.design)
        && training.settings.iter().all(|setting| match &setting.value {
            v1::SettingValue::Text(text) => is_printable(text) && is_printable(&setting.key),
            _ => is_printable(&setting.key),
        });
    ensure("training", printable, || "a word has control characters".to_owned())?;
    let ascending = training.levels.is_sorted_by(|a, b| a < b) && largest > 0;
    ensure("training", ascending, || "the levels of the design do not grow".to_owned())?;
    let parts = [counts.values, counts.gradients, counts.failed, counts.final_mesh];
    let counted = parts.iter().all(|&part| part <= counts.direct_computations);
    ensure("training", counted, || "a part of the model runs is more than all of them".to_owned())?;
    let setting = |setting: v1::Setting| Setting {
        key: setting.key,
        value: match setting.value {
            v1::SettingValue::Integer(value) => SettingValue::Integer(value),
            v1::SettingValue::Number(value) => SettingValue::Number(value),
            v1::SettingValue::Text(value) => SettingValue::Text(value),
            v1::SettingValue::Flag(value) => SettingValue::Flag(value),
        },
    };
    Ok(Training {
        method: training.method,
        settings: training.settings.into_iter().map(setting).collect(),
        design: training.design,
        seed: training.seed,
        levels: training.levels,
        counts: Counts {
            values: counts.values,
            gradients: counts.gradients,
            failed: counts.failed,
            final_mesh: counts.final_mesh,
            direct_computations: counts.direct_computations,
        },
    })
}

fn verdict(stored: Option<v2::Verdict>) -> Result<VerdictBasis, ReadError> {
    let Some(stored) = stored else { return Ok(VerdictBasis::default()) };
    let value = stored.margin.value;
    let is_margin = match stored.margin.kind {
        v2::MarginKind::GrowthRate => value >= 0.0,
        v2::MarginKind::DampingRatio => value > 0.0 && value < 1.0,
    };
    ensure("verdict", is_margin, || format!("its margin is {value}"))?;
    ensure("verdict", stored.tolerance >= 0.0, || format!("its tolerance is {}", stored.tolerance))?;
    let is_band = |band: &v2::Band| band.lower >= 0.0 && band.lower < band.upper;
    ensure("verdict", stored.band.as_ref().is_none_or(is_band), || "its band is empty".to_owned())?;
    let verdict = VerdictBasis {
        rigid_body_modes: stored.rigid_body_modes as usize,
        margin: match stored.margin.kind {
            v2::MarginKind::GrowthRate => Margin::GrowthRate(value),
            v2::MarginKind::DampingRatio => Margin::DampingRatio(value),
        },
        tolerance: stored.tolerance,
        band: stored.band.map(|band| Band {
            lower: band.lower,
            upper: band.upper,
            modes: band.modes as usize,
            reals: band.reals as usize,
        }),
        is_self_adjoint: stored.is_self_adjoint,
    };
    ensure("verdict", verdict != VerdictBasis::default(), || "it says nothing, and should not be there".to_owned())?;
    Ok(verdict)
}

fn coverage(stored: Option<v2::Coverage>, inputs: &InputSpace) -> Result<Option<Coverage>, ReadError> {
    let Some(v2::Coverage { answered, unanswered }) = stored else { return Ok(None) };
    let is_inside = |(input, xi): (&Input, &f64)| !input.marginal.is_divisible() || xi.abs() <= 1.0;
    let dimension = inputs.dimension();
    let is_point = |point: &Vec<f64>| point.len() == dimension && inputs.inputs().iter().zip(point).all(is_inside);
    let is_shaped = [&answered, &unanswered].into_iter().all(|runs| !runs.is_empty() && runs.iter().all(is_point));
    ensure("coverage", is_shaped, || {
        format!("it needs runs of both kinds, with {dimension} coordinates inside the domain each")
    })?;
    Ok(Some(Coverage { answered, unanswered }))
}

fn decision(decision: v1::Decision) -> Result<Decision, ReadError> {
    let quantiles = &decision.max_re_residuals;
    let ordered = quantiles.is_sorted_by(|a, b| a.level < b.level && a.value <= b.value);
    let levels = quantiles.iter().all(|quantile| quantile.level > 0.0 && quantile.level < 1.0);
    ensure("decision", ordered && levels, || "the quantiles are not in order".to_owned())?;
    let error = decision.proportion_error;
    ensure("decision", error.is_none_or(|error| error >= 0.0), || "proportion_error is negative".to_owned())?;
    let quantile = |quantile: v1::Quantile| Quantile { level: quantile.level, value: quantile.value };
    Ok(Decision {
        max_re_residuals: decision.max_re_residuals.into_iter().map(quantile).collect(),
        proportion_error: error,
    })
}

fn self_test(section: v1::SelfTest, inputs: &InputSpace, components: usize) -> Result<SelfTest, ReadError> {
    let points = section.points.len();
    let shaped = section.points.iter().all(|point| point.len() == inputs.dimension())
        && section.components.iter().all(|values| values.len() == components)
        && (section.components.len(), section.max_re.len()) == (points, points);
    ensure("self_test", shaped, || "points and values do not match in number".to_owned())?;
    let sensible = section.tolerance > 0.0 && section.tolerance <= LARGEST_TOLERANCE;
    ensure("self_test", sensible, || format!("the tolerance is not above 0 and at most {LARGEST_TOLERANCE}"))?;
    ensure("self_test", points == SELF_TEST_POINTS, || format!("there are not {SELF_TEST_POINTS} points"))?;
    Ok(SelfTest {
        points: section.points,
        components: section.components,
        max_re: section.max_re,
        tolerance: section.tolerance,
    })
}
