//! What is asked, in words: names of quantities, bins that may be left open.

use super::error::SessionError;
use crate::evaluation::{Condition, Event, Pilot, Quantity, Question, Sampler, SurveyError, Sweep};
use crate::surrogate::Surrogate;

/// A histogram, with or without its bins.
#[derive(Debug, Clone, PartialEq)]
pub struct HistogramRequest {
    /// Name of the quantity, see [`Quantity`].
    pub quantity: String,
    /// Lower edge, upper edge, number of bins; about forty over the range of the quantity if left open.
    pub bins: Option<(f64, f64, u32)>,
}

/// What is asked of a surrogate.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::foundation::{InstructionSet, Silent};
/// use pcc_evaluate::session::{Request, Session};
/// use pcc_evaluate::{artifact, evaluation::Condition};
/// let surrogate = artifact::decode(include_bytes!("../../../../surrogates/clutch-r2.pcc"))?.surrogate;
/// let little_friction = Condition { input: "mu".to_owned(), lower: 0.0, upper: 0.05 };
/// let request = Request { conditions: vec![little_friction], ..Request::plain(10_000, 1) };
/// let question = request.question(&surrogate)?;
/// let session = Session::new(&surrogate, &question, request.critical.as_deref(), InstructionSet::best())?;
/// let found = session.run(&Silent)?;
/// assert!(found.is_complete);
/// let stable = found.answer.cells[0].total.summary.stable_proportion();
/// assert_eq!(stable.value(), 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Number of samples, of every point of the sweeps.
    pub samples: u64,
    /// Seed of the samples.
    pub seed: u64,
    /// How samples are drawn.
    pub sampler: Sampler,
    /// Independent randomisations that the samples are divided among; what suits the sampler if left open.
    pub replicates: Option<u32>,
    /// Inputs that are confined or fixed.
    pub conditions: Vec<Condition>,
    /// Inputs that are set to one value after the other.
    pub sweeps: Vec<Sweep>,
    /// Events that are counted.
    pub events: Vec<Event>,
    /// Histograms.
    pub histograms: Vec<HistogramRequest>,
    /// Probabilities of quantiles of max Re λ and of every mode.
    pub quantile_levels: Vec<f64>,
    /// Name of the input whose critical value is looked for; a [`super::Session`] is told it beside the question.
    pub critical: Option<String>,
}

impl Request {
    /// The stability of random samples of the whole domain.
    pub fn plain(samples: u64, seed: u64) -> Self {
        Self {
            samples,
            seed,
            sampler: Sampler::MonteCarlo,
            replicates: None,
            conditions: Vec::new(),
            sweeps: Vec::new(),
            events: Vec::new(),
            histograms: Vec::new(),
            quantile_levels: Vec::new(),
            critical: None,
        }
    }

    /// What is asked, in numbers: bins that were left open are laid by a pilot, the same for all shards of a question.
    ///
    /// # Errors
    ///
    /// [`SessionError`] names the quantity, input or condition that does not fit the surrogate.
    pub fn question(&self, surrogate: &Surrogate) -> Result<Question, SessionError> {
        let mut question = Question {
            sampler: self.sampler,
            replicates: self.replicates.unwrap_or(self.sampler.default_replicates()),
            conditions: self.conditions.clone(),
            sweeps: self.sweeps.clone(),
            events: self.events.clone(),
            quantile_levels: self.quantile_levels.clone(),
            ..Question::plain(self.samples, self.seed)
        };
        if self.histograms.is_empty() && self.quantile_levels.is_empty() {
            return Ok(question);
        }
        let pilot = Pilot::new(surrogate, self.seed, &question.conditions)?;
        for request in &self.histograms {
            let quantity = Quantity::named(&request.quantity, surrogate)
                .ok_or_else(|| SurveyError::unknown_quantity(&request.quantity, surrogate))?;
            let mut bins = pilot.bins(quantity, &request.quantity);
            if let Some((lower, upper, count)) = request.bins {
                (bins.lower, bins.upper, bins.bins) = (lower, upper, count);
            }
            question.histograms.push(bins);
        }
        if !self.quantile_levels.is_empty() {
            let of_modes =
                Quantity::all(surrogate).into_iter().filter(|quantity| !matches!(quantity, Quantity::Component(_)));
            question.quantile_bins =
                of_modes.map(|quantity| pilot.fine_bins(quantity, &quantity.name(surrogate))).collect();
        }
        Ok(question)
    }
}
