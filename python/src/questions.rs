//! Questions as Python asks them; answers as JSON, text and pictures.

use crate::background::Service;
use pcc::report::{
    CampbellMode, CampbellPoint, EvalReport, InspectReport, SurrogatePage, SweepReport, campbell_chart, page_points,
    sensitivity_charts, sweep_chart,
};
use pcc::{
    Artifact, Condition, Error, EvalError, Event, HistogramRequest, InstructionSet, Interrupted, Interval, Proportion,
    Request, Sampler, Session, Surrogate, Sweep,
};
use pyo3::prelude::*;

/// Between what a share lies at this level, if so many of random samples have it.
#[pyfunction]
pub fn interval(hits: u64, samples: u64, level: f64) -> (f64, f64) {
    let Interval { lower, upper, .. } = Proportion { hits, samples }.interval(level);
    (lower, upper)
}

/// A mode as Python has it: its number, and at each value of the input the lower end, the median and the upper end of
/// its frequency, and the share of samples in which it is unstable.
pub type ModeAlong = (usize, Vec<([f64; 3], f64)>);

/// A Campbell diagram as SVG; nothing if there is no such input.
pub fn campbell(surrogate: &Surrogate, input: &str, values: &[f64], modes: Vec<ModeAlong>) -> String {
    let point = |(frequency, unstable_share)| CampbellPoint { frequency, unstable_share };
    let mode = |(mode, points): ModeAlong| CampbellMode { mode, points: points.into_iter().map(point).collect() };
    let modes: Vec<CampbellMode> = modes.into_iter().map(mode).collect();
    let input = surrogate.inputs.inputs().iter().find(|known| known.name == input);
    input.map_or_else(String::new, |input| campbell_chart(&surrogate.provenance.study_name, input, values, &modes))
}

/// What is asked.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Asked {
    samples: u64,
    seed: u64,
    sampler: String,
    replicates: Option<u32>,
    conditions: Vec<(String, f64, f64)>,
    sweeps: Vec<(String, f64, f64, u32)>,
    events: Vec<(String, bool, f64)>,
    histograms: Vec<String>,
    quantiles: Vec<f64>,
    critical: Option<String>,
}

impl Asked {
    fn request(&self) -> Request {
        let samplers = [Sampler::MonteCarlo, Sampler::Sobol, Sampler::LatinHypercube];
        let named = samplers.into_iter().find(|sampler| sampler.name() == self.sampler);
        let condition = |(input, lower, upper): &(String, f64, f64)| Condition {
            input: input.clone(),
            lower: *lower,
            upper: *upper,
        };
        let sweep = |(input, from, to, points): &(String, f64, f64, u32)| Sweep {
            input: input.clone(),
            from: *from,
            to: *to,
            points: *points,
        };
        Request {
            sampler: named.unwrap_or(Sampler::MonteCarlo),
            replicates: self.replicates,
            conditions: self.conditions.iter().map(condition).collect(),
            sweeps: self.sweeps.iter().map(sweep).collect(),
            events: self.events.iter().map(event).collect(),
            histograms: self
                .histograms
                .iter()
                .map(|quantity| HistogramRequest { quantity: quantity.clone(), bins: None })
                .collect(),
            quantile_levels: self.quantiles.clone(),
            critical: self.critical.clone(),
            ..Request::plain(self.samples, self.seed)
        }
    }
}

/// A quantity below or above a threshold; `flutter` and other kinds of instability have none.
fn event((quantity, below, threshold): &(String, bool, f64)) -> Event {
    Event::of_kind(quantity).unwrap_or(Event { quantity: quantity.clone(), below: *below, threshold: *threshold })
}

/// The answer: JSON, text, and pictures as SVG.
pub fn answer(surrogate: &Surrogate, asked: &Asked, service: &Service) -> Result<(String, String, Vec<String>), Error> {
    let request = asked.request();
    let question = request.question(surrogate)?;
    let session = Session::new(surrogate, &question, request.critical.as_deref(), InstructionSet::best())?;
    let found = session.run(service)?;
    if !question.sweeps.is_empty() {
        let report = SweepReport::new(&found);
        let charts = if question.sweeps.len() <= 2 { vec![sweep_chart(&report)] } else { Vec::new() };
        return Ok((json(&report), format!("{report:100}"), charts));
    }
    let report = EvalReport::of_surrogate(&found).ok_or(Interrupted)?;
    Ok((json(&report), format!("{report:100}"), sensitivity_charts(&report)))
}

/// The page of `pcc report`, without a model.
pub fn page(
    artifact: &Artifact,
    (file, bytes): (String, u64),
    samples: u64,
    seed: u64,
    service: &Service,
) -> Result<String, Error> {
    let surrogate = &artifact.surrogate;
    let request = Request::plain(samples, seed);
    let question = request.question(surrogate)?;
    let found = Session::new(surrogate, &question, None, InstructionSet::best())?.run(service)?;
    let eval = EvalReport::of_surrogate(&found).ok_or(EvalError::NoSamples)?;
    let (points, block) = page_points(surrogate, seed);
    let inspect = InspectReport::new(artifact, file, bytes);
    let page =
        SurrogatePage { surrogate, inspect: &inspect, eval: &eval, points: &points, block: &block, validation: None };
    Ok(page.to_html())
}

/// Reports hold numbers and texts, which can always be written.
pub fn json(report: &impl serde::Serialize) -> String {
    serde_json::to_string(report).unwrap_or_default()
}
