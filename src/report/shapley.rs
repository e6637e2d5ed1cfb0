//! Which inputs decide stability where inputs depend on each other: Shapley effects.

use super::layout::{width, wrapped};
use super::sensitivity::{Bounded, cell};
use super::table::{Align, Table};
use pcc_evaluate::evaluation::{Estimate, SENSITIVITY_LEVEL, ShapleyEffects};
use serde::Serialize;
use std::fmt;

/// Shapley effects on max Re λ and on the stability indicator: shares of the variance, which sum to 1.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShapleyReport {
    /// Samples of the estimate.
    pub samples: u64,
    /// Level of the intervals.
    pub level: f64,
    /// One entry per input.
    pub inputs: Vec<InputEffects>,
}

/// Effects of one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InputEffects {
    /// Name.
    pub input: String,
    /// Effect on max Re λ; null if it does not vary.
    pub max_re: Option<Bounded>,
    /// Effect on the indicator of samples that are not unstable; null if it does not vary.
    pub stability: Option<Bounded>,
}

impl ShapleyReport {
    /// The report for inputs with these names.
    pub(super) fn new<'a>(names: impl Iterator<Item = &'a str>, found: &ShapleyEffects) -> Self {
        let effect = |effects: &Option<Vec<Estimate>>, j: usize| {
            effects.as_ref().and_then(|effects| effects.get(j)).copied().map(Bounded::from)
        };
        let input = |(j, name): (usize, &str)| InputEffects {
            input: name.to_owned(),
            max_re: effect(&found.max_re, j),
            stability: effect(&found.stability, j),
        };
        Self { samples: found.samples, level: SENSITIVITY_LEVEL, inputs: names.enumerate().map(input).collect() }
    }

    /// Numbers of the inputs, the one that decides most first.
    pub(super) fn order(&self) -> Vec<usize> {
        let effect = |j: usize| self.inputs[j].stability.or(self.inputs[j].max_re).map_or(0.0, |effect| effect.value);
        let mut order: Vec<usize> = (0..self.inputs.len()).collect();
        order.sort_by(|&a, &b| effect(b).total_cmp(&effect(a)));
        order
    }

    /// Their names and effects on stability, if those are known well enough to tell one from another.
    pub(super) fn ranked_for_stability(&self) -> Option<Vec<(&str, f64)>> {
        let known = |j: usize| {
            let effect = self.inputs[j].stability.filter(Bounded::says_something)?;
            Some((self.inputs[j].input.as_str(), effect.value))
        };
        self.order().into_iter().map(known).collect()
    }

    /// The inputs that decide most; `None` if nothing varies.
    pub(super) fn causes(&self, most: usize) -> Option<Table> {
        let is_of_stability = self.inputs.iter().all(|input| input.stability.is_some());
        let head = if is_of_stability { "what decides" } else { "what max Re λ depends on" };
        let mut table = Table::new(&[(head, Align::Left), ("Shapley effect", Align::Right)]);
        for j in self.order().into_iter().take(most) {
            let effect = self.inputs[j].stability.or(self.inputs[j].max_re)?;
            table.row([self.inputs[j].input.clone(), cell(Some(effect))]);
        }
        Some(table)
    }
}

impl fmt::Display for ShapleyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.inputs.iter().all(|input| input.max_re.is_none() && input.stability.is_none()) {
            return Ok(());
        }
        let right = Align::Right;
        let mut table = Table::new(&[("Shapley effect", Align::Left), ("on max Re λ", right), ("on stability", right)]);
        for input in &self.inputs {
            table.row([input.input.clone(), cell(input.max_re), cell(input.stability)]);
        }
        let note = "share of the variance that knowing an input takes away, on average over all orders in which \
                    inputs become known, ± at 95 %; inputs depend on each other, so Sobol' indices and moments do not \
                    follow from coefficients";
        let columns = width(f);
        writeln!(f, "\n{table:columns$}{}", wrapped(note, columns, 0))
    }
}
