//! One matrix as a sum: what is fixed, entries that vary, and fixed matrices with factors that vary.

use nalgebra::DMatrix;
use pcc_expressions::Output;

/// An entry sign · factor · value that depends on inputs.
#[derive(Debug)]
pub(super) struct Varying {
    pub row: usize,
    pub column: usize,
    /// −1 for the mirror images of a skew-symmetric term.
    pub sign: f64,
    pub value: Output,
    pub factor: Option<Output>,
}

/// A factor that depends on inputs, and the numbers it multiplies: row, column, number.
#[derive(Debug)]
pub(super) struct Scaled {
    pub factor: Output,
    pub entries: Vec<(usize, usize, f64)>,
}

/// A matrix that depends on inputs.
#[derive(Debug)]
pub(super) struct Assembly {
    /// The sum of all that does not.
    pub fixed: DMatrix<f64>,
    pub varying: Vec<Varying>,
    pub scaled: Vec<Scaled>,
}

impl Assembly {
    pub fn zeros(size: usize) -> Self {
        Self { fixed: DMatrix::zeros(size, size), varying: Vec::new(), scaled: Vec::new() }
    }

    pub fn size(&self) -> usize {
        self.fixed.nrows()
    }

    /// Whether it is the same for all inputs.
    pub fn is_fixed(&self) -> bool {
        self.varying.is_empty() && self.scaled.is_empty()
    }

    /// The matrix, given the values of all outputs by position.
    pub fn value(&self, values: &[f64]) -> DMatrix<f64> {
        let mut matrix = self.fixed.clone();
        for Varying { row, column, sign, value, factor } in &self.varying {
            let factor = factor.map_or(1.0, |factor| values[factor.position()]);
            matrix[(*row, *column)] += sign * factor * values[value.position()];
        }
        for Scaled { factor, entries } in &self.scaled {
            let factor = values[factor.position()];
            entries.iter().for_each(|&(row, column, number)| matrix[(row, column)] += factor * number);
        }
        matrix
    }

    /// Its derivative by an input, given values and slopes of all outputs.
    pub fn derivative(&self, values: &[f64], slopes: &[f64]) -> DMatrix<f64> {
        let slope = |output: Output| slopes[output.position()];
        let mut matrix = DMatrix::zeros(self.size(), self.size());
        for Varying { row, column, sign, value, factor } in &self.varying {
            let by_input = match *factor {
                None => slope(*value),
                Some(factor) => slope(factor) * values[value.position()] + values[factor.position()] * slope(*value),
            };
            matrix[(*row, *column)] += sign * by_input;
        }
        for Scaled { factor, entries } in &self.scaled {
            let by_input = slope(*factor);
            if by_input != 0.0 {
                entries.iter().for_each(|&(row, column, number)| matrix[(row, column)] += by_input * number);
            }
        }
        matrix
    }
}
