//! A surrogate at points that somebody gives, in parallel.

use crate::components::Verdict;
use crate::evaluation::kernel::lanes::{BLOCK_POINTS, Lanes};
use crate::evaluation::kernel::plan::Plan;
use crate::evaluation::kernel::points::{Evaluator, top};
use crate::evaluation::kernel::results::Results;
use crate::foundation::{Interrupted, Observer};
use crate::probability::inputs::{InputError, Marginal};
use crate::surrogate::Surrogate;
use num_complex::Complex;
use rayon::prelude::*;
use std::cell::Cell;
use thiserror::Error;

/// Points that a thread evaluates before it looks whether to stop: they stay in the nearest cache.
const CHUNK: usize = 512;

/// Why a point has no value. Rows are numbered from 0.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PointError {
    /// The numbers are no rows of points.
    #[error("{numbers} numbers are no points of {inputs} inputs, or there is no room for the {places} values there")]
    Shape {
        /// How many numbers there are.
        numbers: usize,
        /// Number of inputs.
        inputs: usize,
        /// For how many values there is room.
        places: usize,
    },
    /// A coordinate is no number.
    #[error("row {row}: {name} = {value} is not a finite number")]
    NotANumber {
        /// The row.
        row: usize,
        /// Name of the input.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A point lies outside the domain.
    #[error("row {row}: {cause}")]
    Outside {
        /// The row.
        row: usize,
        /// Which coordinate.
        #[source]
        cause: InputError,
    },
    /// The surrogate overflows, or the point lies where a law ends, infinitely far from all model runs.
    #[error("row {row}: the surrogate has no finite value at {point}; move the point to where the model was run")]
    NotFinite {
        /// The row.
        row: usize,
        /// The point.
        point: String,
    },
    /// The user asked to stop.
    #[error("{0}")]
    Interrupted(#[from] Interrupted),
}

/// A surrogate, and how it is evaluated at given points.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::{artifact, evaluation::GivenPoints, foundation::Silent};
/// let surrogate = artifact::decode(include_bytes!("../../../../../surrogates/clutch-r2.pcc"))?.surrogate;
/// let points = GivenPoints { surrogate: &surrogate, extrapolates: false };
/// let mut max_re = [0.0; 2];
/// points.max_re(&[0.05, 16e6, 0.4, 16e6], &mut max_re, &Silent)?;
/// assert!(max_re[0] < 0.0 && max_re[1] > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct GivenPoints<'s> {
    /// The surrogate.
    pub surrogate: &'s Surrogate,
    /// Whether points outside the domain are evaluated all the same.
    pub extrapolates: bool,
}

impl GivenPoints<'_> {
    /// Writes every eigenvalue at every point, in the order of [`Surrogate::labels`], in 1/s. `rows` are the points,
    /// one value per input in physical units; rows of what is found follow each other, too.
    ///
    /// # Errors
    ///
    /// [`PointError`] names the first row that has no value.
    pub fn eigenvalues(
        &self,
        rows: &[f64],
        found: &mut [Complex<f64>],
        observer: &dyn Observer,
    ) -> Result<(), PointError> {
        let width = self.surrogate.labels().len();
        self.evaluate(rows, width, found, observer, |results, lane, row| {
            for (lambda, (re, im)) in row.iter_mut().zip(results.growth_rates.iter().zip(&results.angular_frequencies))
            {
                *lambda = Complex::new(re.0[lane], im.0[lane]);
            }
        })
    }

    /// Writes max Re λ at every point, in 1/s.
    ///
    /// # Errors
    ///
    /// As [`GivenPoints::eigenvalues`].
    pub fn max_re(&self, rows: &[f64], found: &mut [f64], observer: &dyn Observer) -> Result<(), PointError> {
        self.evaluate(rows, 1, found, observer, |results, lane, row| row[0] = results.max_re.0[lane])
    }

    /// Writes what is said of stability at every point.
    ///
    /// # Errors
    ///
    /// As [`GivenPoints::eigenvalues`].
    pub fn verdicts(&self, rows: &[f64], found: &mut [Verdict], observer: &dyn Observer) -> Result<(), PointError> {
        self.evaluate(rows, 1, found, observer, |results, lane, row| row[0] = top(results, lane).verdict())
    }

    /// `width` values for each point, which `write` takes from the results in a lane.
    fn evaluate<T: Send>(
        &self,
        rows: &[f64],
        width: usize,
        found: &mut [T],
        observer: &dyn Observer,
        write: impl Fn(&Results, usize, &mut [T]) + Sync,
    ) -> Result<(), PointError> {
        let (inputs, dimension) = (&self.surrogate.inputs, self.surrogate.inputs.dimension());
        let count = rows.len() / dimension;
        if !rows.len().is_multiple_of(dimension) || found.len() != count * width {
            return Err(PointError::Shape { numbers: rows.len(), inputs: dimension, places: found.len() });
        }
        let plan = Plan::new(self.surrogate);
        observer.begin("points", count as u64);
        let chunks = rows.par_chunks(CHUNK * dimension).zip(found.par_chunks_mut(CHUNK * width)).enumerate();
        let outcomes: Vec<Result<(), PointError>> = chunks
            .map_init(
                || Evaluator::new(self.surrogate, &plan),
                |evaluator, (number, (rows, found))| {
                    observer.check()?;
                    let points = rows.len() / dimension;
                    let (mut bad, mut done, is_outside) = (None, 0, Cell::new(false));
                    evaluator.each_block(points, self.standardized(rows, &is_outside), |_, results, lanes| {
                        for lane in 0..lanes {
                            if !results.max_re.0[lane].is_finite() {
                                bad.get_or_insert(done + lane);
                            }
                            write(results, lane, &mut found[(done + lane) * width..][..width]);
                        }
                        done += lanes;
                    });
                    observer.advance(points as u64);
                    if is_outside.get() {
                        self.check(rows, number * CHUNK)?;
                    }
                    let Some(at) = bad else { return Ok(()) };
                    let point = inputs.describe(&rows[at * dimension..][..dimension]);
                    Err(PointError::NotFinite { row: number * CHUNK + at, point })
                },
            )
            .collect();
        observer.finish();
        outcomes.into_iter().collect()
    }

    /// Writes the standardized coordinates of the points from a number on into lanes, and says if one is no point of
    /// the domain: which one is looked for afterwards.
    fn standardized(&self, rows: &[f64], is_outside: &Cell<bool>) -> impl FnMut(usize, &mut [Lanes]) {
        let inputs = self.surrogate.inputs.inputs();
        move |start, lanes| {
            let points = rows[start * inputs.len()..].chunks_exact(inputs.len());
            let count = points.len().min(BLOCK_POINTS);
            for (j, (input, coordinate)) in inputs.iter().zip(lanes).enumerate() {
                let values = &mut coordinate.0[..count];
                values.iter_mut().zip(points.clone()).for_each(|(value, point)| *value = point[j]);
                if !self.are_inside(&input.marginal, values) {
                    is_outside.set(true);
                }
                values.iter_mut().for_each(|value| *value = input.marginal.standardized(*value));
            }
        }
    }

    /// Whether all values are numbers, and in the support unless that does not matter. Supports are intervals, so that
    /// the least and the largest value say it, but for single values.
    fn are_inside(&self, law: &Marginal, values: &[f64]) -> bool {
        let (mut lower, mut upper, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for &value in values {
            lower = if value < lower { value } else { lower };
            upper = if value > upper { value } else { upper };
            // 0 · x is no number where x is none, and where it is infinite.
            sum += 0.0 * value;
        }
        let are_taken = || !law.is_discrete() || values.iter().all(|value| law.takes(*value));
        sum == 0.0 && (self.extrapolates || (law.contains(lower) && law.contains(upper) && are_taken()))
    }

    /// Refuses what is no point of the domain.
    fn check(&self, rows: &[f64], first: usize) -> Result<(), PointError> {
        let inputs = &self.surrogate.inputs;
        for (row, point) in (first..).zip(rows.chunks_exact(inputs.dimension())) {
            if let Some(j) = point.iter().position(|value| !value.is_finite()) {
                let name = inputs.inputs()[j].name.clone();
                return Err(PointError::NotANumber { row, name, value: point[j] });
            }
            if !self.extrapolates {
                inputs.check(point).map_err(|cause| PointError::Outside { row, cause })?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::decode;
    use crate::evaluation::{evaluate_points, test_surrogates};
    use crate::foundation::Silent;
    use crate::probability::inputs::{Input, InputSpace, Parameters, random_points};
    use crate::probability::random::Purpose;

    fn surrogate() -> Surrogate {
        decode(include_bytes!("../../../../../surrogates/clutch-r2.pcc")).unwrap().surrogate
    }

    #[test]
    fn rows_say_what_samples_say_to_the_bit() {
        let surrogate = surrogate();
        let count = 2 * CHUNK + 77;
        let mut max_re = vec![0.0; count];
        let points = random_points(&surrogate.inputs, 1, Purpose::Evaluation, 0..count as u64);
        let rows: Vec<f64> = points.iter().flat_map(|point| surrogate.inputs.physical(point)).collect();
        let back: Vec<Vec<f64>> = rows.chunks(2).map(|row| surrogate.inputs.standardized(row)).collect();
        let references: Vec<&[f64]> = back.iter().map(Vec::as_slice).collect();
        let block = evaluate_points(&surrogate, &Plan::new(&surrogate), &references);
        let given = GivenPoints { surrogate: &surrogate, extrapolates: false };
        given.max_re(&rows, &mut max_re, &Silent).unwrap();
        assert_eq!(max_re, block.max_re);
        let width = block.eigenvalues.len();
        let (mut eigenvalues, mut verdicts) = (vec![Complex::default(); count * width], vec![Verdict::Marginal; count]);
        given.eigenvalues(&rows, &mut eigenvalues, &Silent).unwrap();
        given.verdicts(&rows, &mut verdicts, &Silent).unwrap();
        for i in 0..count {
            let row: Vec<_> = block.eigenvalues.iter().map(|mode| mode[i]).collect();
            assert_eq!((&eigenvalues[i * width..][..width], verdicts[i]), (row.as_slice(), block.top(i).verdict()));
        }
    }

    #[test]
    fn values_between_those_of_an_input_are_refused() {
        let levels = [1.0, 2.0, 9.0].into_iter().flat_map(|value| [("value", value), ("weight", 1.0)]);
        let law = Marginal::named("discrete", &Parameters::of(levels)).unwrap();
        let inputs = InputSpace::new(vec![Input::new("n".to_owned(), law)]).unwrap();
        let surrogate = test_surrogates::surrogate(inputs, vec![test_surrogates::expansion(&[(&[1], 1.0)])]);
        let given = GivenPoints { surrogate: &surrogate, extrapolates: false };
        let mut found = [0.0; 3];
        given.max_re(&[9.0, 1.0, 2.0], &mut found, &Silent).unwrap();
        let error = given.max_re(&[9.0, 1.5, 2.0], &mut found, &Silent).unwrap_err();
        assert!(matches!(error, PointError::Outside { row: 1, .. }), "{error}");
    }

    #[test]
    fn the_first_row_without_a_value_is_named() {
        let surrogate = surrogate();
        let given = GivenPoints { surrogate: &surrogate, extrapolates: false };
        let mut rows: Vec<f64> = [0.1, 16e6].repeat(3 * CHUNK);
        let mut found = vec![0.0; 3 * CHUNK];
        for (rows, places) in [(&rows[1..], 3 * CHUNK), (&rows[2..], 3 * CHUNK), (&rows[..], 3)] {
            let error = given.max_re(rows, &mut found[..places], &Silent).unwrap_err();
            assert_eq!(error, PointError::Shape { numbers: rows.len(), inputs: 2, places });
        }
        (rows[2 * (2 * CHUNK + 5)], rows[2 * (CHUNK + 3)]) = (f64::NAN, 0.7);
        let error = given.max_re(&rows, &mut found, &Silent).unwrap_err();
        assert_eq!(error.to_string(), format!("row {}: mu = 0.7 lies outside [0.0, 0.5]", CHUNK + 3));
        let all = GivenPoints { extrapolates: true, ..given };
        let error = all.max_re(&rows, &mut found, &Silent).unwrap_err();
        assert_eq!(error.to_string(), format!("row {}: mu = NaN is not a finite number", 2 * CHUNK + 5));
        all.max_re(&[0.7, 16e6], &mut found[..1], &Silent).unwrap();
        let beyond = all.max_re(&[1e300, 16e6], &mut found[..1], &Silent);
        assert!(matches!(beyond, Err(PointError::NotFinite { row: 0, .. })), "{beyond:?}");
    }
}
