//! The part of the domain that samples are drawn from.

use super::question::Question;
use super::survey_error::SurveyError;
use crate::evaluation::kernel::lanes::{BLOCK_POINTS, Lanes};
use crate::probability::inputs::{Germ, InputSpace};

/// Replicates of all points of all sweeps together, at most: their counts are kept in memory, some 500 bytes each.
const MOST_SERIES: u64 = 1 << 18;

/// A part of the domain: every input is confined to an interval, or fixed. Intervals are of the centred probability
/// η = 2F − 1 of each input: an input that is confined has its own law on condition that it lies there.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// η = lower + width · u for u uniform on (0, 1), per input.
    lower: Vec<f64>,
    width: Vec<f64>,
    /// What standardized variables are distributed like.
    germs: Vec<Germ>,
}

impl Region {
    /// The whole domain.
    pub fn whole(inputs: &InputSpace) -> Self {
        let dimension = inputs.dimension();
        let germs = inputs.inputs().iter().map(|input| input.marginal.germ().clone()).collect();
        Self { lower: vec![-1.0; dimension], width: vec![2.0; dimension], germs }
    }

    /// Confines an input to this interval of its centred probability; equal ends fix it.
    ///
    /// # Panics
    ///
    /// If there is no such input.
    pub fn confine(&mut self, input: usize, lower: f64, upper: f64) {
        self.lower[input] = lower;
        self.width[input] = upper - lower;
    }

    /// Whether an input is fixed.
    pub fn is_fixed(&self, input: usize) -> bool {
        self.width[input] == 0.0
    }

    /// Whether nothing is confined.
    pub fn is_whole(&self) -> bool {
        self.lower.iter().all(|&lower| lower == -1.0) && self.width.iter().all(|&width| width == 2.0)
    }

    /// The standardized coordinate at a place u ∈ (0, 1) inside the interval of an input. In the whole domain η is
    /// 2u − 1 without rounding.
    #[inline(always)]
    pub fn place(&self, input: usize, unit: f64) -> f64 {
        self.germs[input].at(self.width[input].mul_add(unit, self.lower[input]))
    }

    /// [`Self::place`] in all lanes.
    #[inline(always)]
    pub(crate) fn place_lanes(&self, input: usize, units: &mut Lanes) {
        let (lower, width) = (self.lower[input], self.width[input]);
        for lane in 0..BLOCK_POINTS {
            units.0[lane] = width.mul_add(units.0[lane], lower);
        }
        match &self.germs[input] {
            Germ::Uniform => {}
            Germ::Normal => {
                for lane in 0..BLOCK_POINTS {
                    units.0[lane] = Germ::Normal.at(units.0[lane]);
                }
            }
            Germ::Own(own) => {
                // Normal scores in lanes, then the pieces, which are looked up one by one.
                for lane in 0..BLOCK_POINTS {
                    units.0[lane] = Germ::Normal.at(units.0[lane]);
                }
                for lane in 0..BLOCK_POINTS {
                    units.0[lane] = own.at_score(units.0[lane]);
                }
            }
        }
    }
}

/// The boxes of all points of the sweeps, the last sweep varying fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions {
    base: Region,
    /// Swept inputs with the centred probabilities of their values.
    swept: Vec<(usize, Vec<f64>)>,
}

impl Regions {
    /// The boxes of a question.
    ///
    /// # Errors
    ///
    /// [`SurveyError`]: an input that does not exist or is named twice, values outside the domain, too many points.
    pub(crate) fn new(inputs: &InputSpace, question: &Question) -> Result<Self, SurveyError> {
        let mut used = Vec::new();
        let mut position = |name: &str| {
            let found = inputs.names().position(|known| known == name);
            let found = found.ok_or_else(|| SurveyError::unknown_input(name, inputs))?;
            if used.contains(&found) {
                return Err(SurveyError::InputTwice { input: name.to_owned() });
            }
            used.push(found);
            Ok(found)
        };
        let mut base = Region::whole(inputs);
        for condition in &question.conditions {
            let input = position(&condition.input)?;
            let lower = coordinate(inputs, input, condition.lower)?;
            let upper = coordinate(inputs, input, condition.upper)?;
            if condition.lower > condition.upper {
                return Err(SurveyError::Inverted { condition: condition.clone() });
            }
            base.confine(input, lower, upper);
        }
        let mut series = u64::from(question.replicates.max(1));
        let mut swept = Vec::with_capacity(question.sweeps.len());
        for sweep in &question.sweeps {
            let input = position(&sweep.input)?;
            if sweep.points < 2 {
                return Err(SurveyError::TooFewSteps { sweep: sweep.clone() });
            }
            series = series.saturating_mul(u64::from(sweep.points));
            if series > MOST_SERIES {
                return Err(SurveyError::TooManyCells { replicates: question.replicates.max(1), most: MOST_SERIES });
            }
            // The ends first: they are what was typed.
            [sweep.from, sweep.to].into_iter().try_for_each(|end| coordinate(inputs, input, end).map(drop))?;
            let values = (0..sweep.points).map(|number| coordinate(inputs, input, sweep.value(number)));
            swept.push((input, values.collect::<Result<_, _>>()?));
        }
        Ok(Self { base, swept })
    }

    /// Number of boxes.
    pub fn count(&self) -> u64 {
        self.swept.iter().map(|(_, values)| values.len() as u64).product()
    }

    /// Box number `number`, counted modulo [`Self::count`].
    pub fn at(&self, number: usize) -> Region {
        let (mut region, mut rest) = (self.base.clone(), number);
        for (input, values) in self.swept.iter().rev() {
            let centred = values[rest % values.len()];
            region.confine(*input, centred, centred);
            rest /= values.len();
        }
        region
    }
}

/// The centred probability of a value inside the domain.
fn coordinate(inputs: &InputSpace, input: usize, value: f64) -> Result<f64, SurveyError> {
    let chosen = &inputs.inputs()[input];
    if !chosen.marginal.contains(value) {
        let [lower, upper] = chosen.marginal.support();
        return Err(SurveyError::Outside { input: chosen.name.clone(), value, lower, upper });
    }
    // No farther out than random values come.
    const OUTERMOST: f64 = 1.0 - f64::EPSILON / 2.0;
    let most = if chosen.marginal.is_divisible() { 1.0 } else { OUTERMOST };
    Ok(chosen.marginal.centred_probability(value).clamp(-most, most))
}
