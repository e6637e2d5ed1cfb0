//! The part of the domain that samples are drawn from.

use super::question::Question;
use super::survey_error::SurveyError;
use crate::evaluation::kernel::lanes::{BLOCK_POINTS, Lanes};
use crate::probability::inputs::{Confinement, Conflict, Correlated, Germ, InputSpace, Marginal, OUTERMOST};

/// Replicates of all points of all sweeps together, at most: their counts are kept in memory, some 500 bytes each.
const MOST_SERIES: u64 = 1 << 18;

/// A part of the domain: every input is confined to an interval, or fixed. Intervals are of the centred probability
/// η = 2F − 1 of each input: an input that is confined has its own law on condition that it lies there, and inputs that
/// depend on it have theirs on the same condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Per input.
    confined: Vec<Confinement>,
    /// What standardized variables are distributed like.
    germs: Vec<Germ>,
    /// How inputs that depend on others follow from independent numbers.
    correlated: Correlated,
}

impl Region {
    /// The whole domain.
    pub fn whole(inputs: &InputSpace) -> Self {
        let confined = vec![Confinement::NONE; inputs.dimension()];
        // Nothing is confined, so that nothing is in conflict.
        let correlated = Self::correlations(inputs, &confined).unwrap_or_default();
        Self { confined, germs: Self::germs(inputs), correlated }
    }

    /// The whole domain with an input fixed at this centred probability.
    #[cfg(test)]
    pub(crate) fn with_fixed(inputs: &InputSpace, input: usize, centred: f64) -> Self {
        let mut confined = vec![Confinement::NONE; inputs.dimension()];
        confined[input] = Confinement { lower: centred, width: 0.0 };
        Self::new(inputs, confined).unwrap()
    }

    fn new(inputs: &InputSpace, confined: Vec<Confinement>) -> Result<Self, Conflict> {
        let correlated = Self::correlations(inputs, &confined)?;
        Ok(Self { confined, germs: Self::germs(inputs), correlated })
    }

    fn germs(inputs: &InputSpace) -> Vec<Germ> {
        inputs.inputs().iter().map(|input| input.marginal.germ().clone()).collect()
    }

    fn correlations(inputs: &InputSpace, confined: &[Confinement]) -> Result<Correlated, Conflict> {
        let of_copula = |copula| Correlated::new(copula, inputs.inputs(), confined);
        inputs.dependence().map_or(Ok(Correlated::default()), of_copula)
    }

    /// Whether an input is fixed.
    pub fn is_fixed(&self, input: usize) -> bool {
        self.confined[input].is_fixed()
    }

    /// Whether Shapley effects can be estimated: no input that others depend on is confined to an interval.
    pub fn has_effects(&self) -> bool {
        self.correlated.interval().is_none()
    }

    /// Mean and standard deviation of the normal score of an input that is not confined, if it is independent of all
    /// others here: 0 and 1, unless it depends on inputs that are fixed.
    pub(crate) fn score_alone(&self, inputs: &InputSpace, input: usize) -> Option<[f64; 2]> {
        match inputs.correlated_with(input).is_empty() {
            true => Some([0.0, 1.0]),
            false => self.correlated.alone(input),
        }
    }

    /// How inputs that depend on others are drawn.
    pub(crate) fn correlated(&self) -> &Correlated {
        &self.correlated
    }

    /// Replaces places u ∈ (0, 1) inside the intervals, one for each input, by the standardized coordinates of a point.
    #[inline(always)]
    pub fn place(&self, units: &mut [f64]) {
        for (input, unit) in units.iter_mut().enumerate() {
            if !self.correlated.places(input) {
                *unit = self.place_alone(input, *unit);
            }
        }
        self.correlated.place(units.as_chunks_mut::<1>().0);
    }

    /// The standardized coordinate of an input that depends on no other, or is fixed. In the whole domain η is 2u − 1
    /// without rounding.
    #[inline(always)]
    pub(crate) fn place_alone(&self, input: usize, unit: f64) -> f64 {
        let Confinement { lower, width } = self.confined[input];
        self.germs[input].at(width.mul_add(unit, lower))
    }

    /// The standardized coordinate of an input at a normal score.
    #[inline(always)]
    pub(crate) fn at_score(&self, input: usize, score: f64) -> f64 {
        self.germs[input].at_score(score)
    }

    /// [`Self::place`] in all lanes, a column per input.
    #[inline(always)]
    pub(crate) fn place_lanes(&self, columns: &mut [Lanes]) {
        for (input, units) in columns.iter_mut().enumerate() {
            if !self.correlated.places(input) {
                self.place_lanes_alone(input, units);
            }
        }
        self.correlated.place(columns);
    }

    #[inline(always)]
    fn place_lanes_alone(&self, input: usize, units: &mut Lanes) {
        let Confinement { lower, width } = self.confined[input];
        for lane in 0..BLOCK_POINTS {
            units.0[lane] = width.mul_add(units.0[lane], lower);
        }
        self.germs[input].at_lanes(&mut units.0);
    }
}

/// The boxes of all points of the sweeps, the last sweep varying fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions {
    inputs: InputSpace,
    /// What conditions leave, whatever the sweeps say.
    base: Vec<Confinement>,
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
        let mut base = vec![Confinement::NONE; inputs.dimension()];
        for condition in &question.conditions {
            let input = position(&condition.input)?;
            if condition.lower > condition.upper {
                inside(inputs, input, condition.lower).and_then(|_| inside(inputs, input, condition.upper))?;
                return Err(SurveyError::Inverted { condition: condition.clone() });
            }
            base[input] = confinement(inputs, input, [condition.lower, condition.upper])?;
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
        let regions = Self { inputs: inputs.clone(), base, swept };
        regions.check()?;
        Ok(regions)
    }

    /// Whether correlated inputs can be confined so, at every point of the sweeps.
    fn check(&self) -> Result<(), SurveyError> {
        let name = |input: usize| self.inputs.inputs()[input].name.clone();
        let conflict = |conflict| match conflict {
            Conflict::Intervals(one, other) => SurveyError::Intervals { one: name(one), other: name(other) },
            Conflict::Improbable(input) => SurveyError::Improbable { input: name(input) },
        };
        let first = self.region(0).map_err(conflict)?;
        if first.correlated.interval().is_some() {
            (1..self.count() as usize).try_for_each(|number| self.region(number).map(drop)).map_err(conflict)?;
        }
        Ok(())
    }

    /// Number of boxes.
    pub fn count(&self) -> u64 {
        self.swept.iter().map(|(_, values)| values.len() as u64).product()
    }

    /// Box number `number`, counted modulo [`Self::count`].
    pub fn at(&self, number: usize) -> Region {
        // Checked when these boxes were made.
        self.region(number).unwrap_or_else(|_| Region::whole(&self.inputs))
    }

    fn region(&self, number: usize) -> Result<Region, Conflict> {
        let (mut confined, mut rest) = (self.base.clone(), number);
        for (input, values) in self.swept.iter().rev() {
            confined[*input] = Confinement { lower: values[rest % values.len()], width: 0.0 };
            rest /= values.len();
        }
        Region::new(&self.inputs, confined)
    }
}

/// The law of an input, if a value lies in its support.
fn inside(inputs: &InputSpace, input: usize, value: f64) -> Result<&Marginal, SurveyError> {
    let chosen = &inputs.inputs()[input];
    if chosen.marginal.contains(value) {
        return Ok(&chosen.marginal);
    }
    let [lower, upper] = chosen.marginal.support();
    Err(SurveyError::Outside { input: chosen.name.clone(), value, lower, upper })
}

/// What a condition leaves of an input.
fn confinement(inputs: &InputSpace, input: usize, [lower, upper]: [f64; 2]) -> Result<Confinement, SurveyError> {
    if lower == upper {
        return Ok(Confinement { lower: coordinate(inputs, input, lower)?, width: 0.0 });
    }
    let law = inside(inputs, input, lower).and_then(|_| inside(inputs, input, upper))?;
    let [from, to] = law.centred_interval([lower, upper]).map(|centred| outermost(law, centred));
    match law.is_discrete() && from >= to {
        true => Err(SurveyError::NoLevel { input: inputs.inputs()[input].name.clone(), values: [lower, upper] }),
        false => Ok(Confinement { lower: from, width: to - from }),
    }
}

/// The centred probability of a value that the input can take.
fn coordinate(inputs: &InputSpace, input: usize, value: f64) -> Result<f64, SurveyError> {
    let law = inside(inputs, input, value)?;
    match law.takes(value) {
        true => Ok(outermost(law, law.centred_probability(value))),
        false => Err(SurveyError::NoLevel { input: inputs.inputs()[input].name.clone(), values: [value; 2] }),
    }
}

/// No farther out than random values come.
fn outermost(law: &Marginal, centred: f64) -> f64 {
    let most = if law.is_divisible() { 1.0 } else { OUTERMOST };
    centred.clamp(-most, most)
}

#[cfg(test)]
mod tests {
    use super::super::question::{Condition, Sweep};
    use super::super::source::{Drawing, Source};
    use super::*;
    use crate::evaluation::test_surrogates::inputs;
    use crate::foundation::InstructionSet;
    use crate::probability::dependence::GaussianCopula;
    use crate::probability::inputs::{Input, Parameters, random_point};
    use crate::probability::random::Purpose;

    /// Laws of all kinds, correlated but for the third.
    fn dependent() -> InputSpace {
        type Given = &'static [(&'static str, f64)];
        let laws: [(&str, Given); 6] = [
            ("uniform", &[("lower", 0.0), ("upper", 2.0)]),
            ("normal", &[("mean", 1.0), ("std", 0.5)]),
            ("uniform", &[("lower", -1.0), ("upper", 1.0)]),
            ("lognormal", &[("mean", 1.0), ("std", 0.3)]),
            ("normal", &[("mean", 1.0), ("std", 0.5), ("lower", 0.0)]),
            ("exponential", &[("mean", 2.0)]),
        ];
        let input = |(j, (name, given)): (usize, (&str, Given))| {
            let law = Marginal::named(name, &Parameters::of(given.iter().copied())).unwrap();
            Input::new(format!("x{j}"), law)
        };
        let inputs = laws.into_iter().enumerate().map(input).collect();
        let copula = GaussianCopula::new(6, [(0, 1, 0.5), (1, 4, -0.6), (3, 5, 0.9)]).unwrap();
        InputSpace::new(inputs).unwrap().with_dependence(copula).unwrap()
    }

    fn regions(conditions: &[(&str, f64, f64)], sweeps: &[(&str, f64, f64)]) -> Result<Regions, SurveyError> {
        let condition = |&(input, lower, upper): &(&str, f64, f64)| Condition { input: input.to_owned(), lower, upper };
        let sweep = |&(input, from, to): &(&str, f64, f64)| Sweep { input: input.to_owned(), from, to, points: 3 };
        let question = Question {
            conditions: conditions.iter().map(condition).collect(),
            sweeps: sweeps.iter().map(sweep).collect(),
            ..Question::plain(100, 1)
        };
        Regions::new(&dependent(), &question)
    }

    #[test]
    fn lanes_of_every_instruction_set_hold_the_random_points() {
        for space in [dependent(), inputs(&[(0.0, 1.0), (2.0, 3.0), (-1.0, 1.0)])] {
            let region = Region::whole(&space);
            let source = Source::MonteCarlo { seed: 7 };
            for instructions in InstructionSet::available() {
                let mut lanes = vec![Lanes::splat(0.0); space.dimension()];
                instructions.run(Drawing { source: &source, region: &region, first: 30, points: &mut lanes });
                for lane in 0..BLOCK_POINTS {
                    let mut point = vec![0.0; space.dimension()];
                    random_point(&space, 7, Purpose::Evaluation, 30 + lane as u64, &mut point);
                    let found: Vec<f64> = lanes.iter().map(|lanes| lanes.0[lane]).collect();
                    assert_eq!(found, point, "{instructions:?}");
                }
            }
        }
    }

    #[test]
    fn conditions_hold_and_leave_what_is_independent() {
        let space = dependent();
        let region = regions(&[("x1", 1.2, 1.2), ("x4", 0.5, 1.5), ("x2", 0.0, 0.5)], &[]).unwrap().at(0);
        let whole = Region::whole(&space);
        for k in 1..200 {
            let units: Vec<f64> = (1..=6).map(|j| (f64::from(k * j) / 211.7).fract()).collect();
            let (mut point, mut free) = (units.clone(), units.clone());
            region.place(&mut point);
            whole.place(&mut free);
            let physical = space.physical(&point);
            assert!((physical[1] - 1.2).abs() < 1e-12 && space.check(&physical).is_ok());
            assert!((0.5..=1.5).contains(&physical[4]) && (0.0..=0.5).contains(&physical[2]), "{physical:?}");
            assert_eq!((point[3], point[5]), (free[3], free[5]), "another block");
            assert_ne!(point[0], free[0]);
        }
    }

    #[test]
    fn intervals_of_inputs_that_depend_on_each_other_are_refused() {
        let both = regions(&[("x0", 0.5, 1.0), ("x4", 0.5, 1.5)], &[]).unwrap_err();
        assert_eq!(both, SurveyError::Intervals { one: "x0".to_owned(), other: "x4".to_owned() });
        assert!(regions(&[("x0", 0.5, 1.0), ("x3", 0.5, 1.5)], &[]).is_ok(), "two blocks");
        assert!(regions(&[("x0", 0.0, 2.0), ("x4", 0.5, 1.5)], &[]).is_ok(), "all of its range");
        // A sweep can reach where the interval is impossible.
        let strong = |value| {
            let copula = GaussianCopula::new(6, [(3, 5, value)]).unwrap();
            let space = InputSpace::new(dependent().inputs().to_vec()).unwrap().with_dependence(copula).unwrap();
            let condition = Condition { input: "x3".to_owned(), lower: 3.0, upper: 4.0 };
            let sweep = Sweep { input: "x5".to_owned(), from: 10.0, to: 1e-9, points: 3 };
            let question = Question { conditions: vec![condition], sweeps: vec![sweep], ..Question::plain(100, 1) };
            Regions::new(&space, &question)
        };
        assert_eq!(strong(0.99999), Err(SurveyError::Improbable { input: "x3".to_owned() }));
        assert!(strong(0.9).is_ok());
    }
}
