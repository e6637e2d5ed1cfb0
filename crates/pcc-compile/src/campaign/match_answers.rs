//! Answers that others computed: rows of a table become records of a journal.

use super::ledger::{DesignPoint, bits};
use crate::campaign::journal::{HASH_BYTES, Record, RunOutcome};
use crate::mechanics::model::command::results_table::ResultRow;
use crate::mechanics::spectrum::{Computation, Spectrum, SpectrumError, Target, largest_difference};
use crate::study::Study;
use nalgebra::Complex;
use pcc_evaluate::probability::inputs::{Germ, Marginal};
use std::collections::{HashMap, HashSet};
use thiserror::Error;

/// Inputs of a numbered run may differ from the design's by this share of their width: tables are written with fewer
/// digits.
const INPUT_TOLERANCE: f64 = 1e-4;

/// Two answers to the same run may differ by this share of the largest eigenvalue: solvers on other machines round
/// otherwise.
const ANSWER_TOLERANCE: f64 = 1e-9;

/// Why a row of results cannot be taken.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RowProblem {
    /// There is no such run.
    #[error("line {line}: there is no run {run}; the design has asked for {asked} so far")]
    NoSuchRun {
        /// Line of the table.
        line: u64,
        /// Number of the run.
        run: u64,
        /// Runs of the design.
        asked: usize,
    },
    /// The inputs are not those of the run.
    #[error(
        "line {line}: run {run} of the design is at {expected}, not at {found}; is the table of another study or seed?"
    )]
    OtherPoint {
        /// Line of the table.
        line: u64,
        /// Number of the run.
        run: u64,
        /// The point of the design.
        expected: String,
        /// The point in the row.
        found: String,
    },
    /// The row says where it belongs by a number alone.
    #[error(
        "line {line}: has the number of a run, but not its inputs; keep the columns of the inputs, so that an answer cannot get to the \
         point of another study or seed"
    )]
    NoInputs {
        /// Line of the table.
        line: u64,
    },
    /// The model's answer has no modes.
    #[error("line {line}: run {run}: {cause}")]
    Spectrum {
        /// Line of the table.
        line: u64,
        /// Number of the run.
        run: u64,
        /// Why.
        #[source]
        cause: SpectrumError,
    },
    /// The inputs are no point of the design.
    #[error(
        "line {line}: {found} is no point that the design has asked for so far; keep all digits of the inputs, or the column run beside them"
    )]
    NoSuchPoint {
        /// Line of the table.
        line: u64,
        /// The point in the row.
        found: String,
    },
    /// Another answer is known.
    #[error(
        "line {line}: run {run} was answered otherwise before: eigenvalues differ by {difference:.1e} 1/s; remove the wrong \
         one, or take this one in its place with --replace"
    )]
    Contradiction {
        /// Line of the table.
        line: u64,
        /// Number of the run.
        run: u64,
        /// Largest difference of an eigenvalue.
        difference: f64,
    },
}

/// What a table of results brings.
#[derive(Debug, Clone, PartialEq)]
pub struct MatchedAnswers {
    /// Runs that were not known.
    pub records: Vec<Record>,
    /// Rows that say what is known already.
    pub repeated: usize,
}

/// Finds the run of each row among those `asked` for, in the order of the design, and what is new; `known` are the
/// outcomes of these runs as far as there are any.
///
/// A row belongs to the run with its number, whose inputs it must have to four digits of their widths, or else to that
/// with the bits of its inputs. Answers to a run that has failed are new; failures of a run that was answered are not.
/// With `replaces`, an answer that contradicts an earlier one takes its place.
///
/// # Errors
///
/// All rows that cannot be taken; then none is.
pub fn match_answers(
    study: &Study,
    asked: &[DesignPoint],
    known: impl Fn(&[f64]) -> Option<RunOutcome>,
    rows: &[ResultRow],
    replaces: bool,
) -> Result<MatchedAnswers, Vec<RowProblem>> {
    let by_bits: HashMap<Vec<u64>, usize> = (0..asked.len()).map(|i| (bits(&asked[i].point), i)).collect();
    let mut outcomes: HashMap<usize, RunOutcome> = HashMap::new();
    let (mut matched, mut problems) = (MatchedAnswers { records: Vec::new(), repeated: 0 }, Vec::new());
    let model: [u8; HASH_BYTES] = study.model_hash();
    for row in rows {
        let i = match find(study, asked, &by_bits, row) {
            Ok(i) => i,
            Err(problem) => {
                problems.push(problem);
                continue;
            }
        };
        let point = &asked[i].point;
        let (line, run) = (row.line, i as u64 + 1);
        let outcome = match &row.answer {
            Ok(eigenvalues) => {
                if let Err(cause) = usable(study, eigenvalues) {
                    problems.push(RowProblem::Spectrum { line, run, cause });
                    continue;
                }
                RunOutcome::Answered(Computation::of_eigenvalues(eigenvalues.clone()))
            }
            Err(cause) => RunOutcome::Failed { attempts: 1, cause: cause.clone(), by_circumstances: false },
        };
        let before = outcomes.get(&i).cloned().or_else(|| known(point));
        match (&before, &outcome) {
            (Some(RunOutcome::Answered(before)), RunOutcome::Answered(now)) => {
                let (difference, scale) = largest_difference(&before.eigenvalues, &now.eigenvalues);
                match (difference > ANSWER_TOLERANCE * scale, replaces) {
                    (false, _) => matched.repeated += 1,
                    (true, false) => problems.push(RowProblem::Contradiction { line, run, difference }),
                    (true, true) => {
                        outcomes.insert(i, outcome.clone());
                        matched.records.push(Record { model, point: point.clone(), outcome, seconds: 0.0 });
                    }
                }
            }
            (Some(RunOutcome::Answered(_)), RunOutcome::Failed { .. }) => matched.repeated += 1,
            (Some(before), now) if before == now => matched.repeated += 1,
            _ => {
                outcomes.insert(i, outcome.clone());
                matched.records.push(Record { model, point: point.clone(), outcome, seconds: 0.0 });
            }
        }
    }
    if problems.is_empty() { Ok(matched) } else { Err(problems) }
}

/// The same of runs that are told as they ended: a point is known by the bits of its inputs, and the last answer to it
/// counts. Problems name the place of a run in the list, from 1, as a line.
///
/// # Errors
///
/// All points that the design has not asked for; then no run is taken.
pub fn match_runs(
    study: &Study,
    asked: &[DesignPoint],
    known: impl Fn(&[f64]) -> Option<RunOutcome>,
    runs: impl Iterator<Item = (Vec<f64>, RunOutcome)>,
) -> Result<MatchedAnswers, Vec<RowProblem>> {
    let by_bits: HashSet<Vec<u64>> = asked.iter().map(|asked| bits(&asked.point)).collect();
    let (mut matched, mut problems) = (MatchedAnswers { records: Vec::new(), repeated: 0 }, Vec::new());
    let model: [u8; HASH_BYTES] = study.model_hash();
    for (line, (point, outcome)) in (1..).zip(runs) {
        if !by_bits.contains(&bits(&point)) {
            problems.push(RowProblem::NoSuchPoint { line, found: study.inputs.describe(&point) });
        } else if known(&point).as_ref() == Some(&outcome) {
            matched.repeated += 1;
        } else {
            matched.records.push(Record { model, point, outcome, seconds: 0.0 });
        }
    }
    if problems.is_empty() { Ok(matched) } else { Err(problems) }
}

/// The run a row belongs to.
fn find(
    study: &Study,
    asked: &[DesignPoint],
    by_bits: &HashMap<Vec<u64>, usize>,
    row: &ResultRow,
) -> Result<usize, RowProblem> {
    let (line, describe) = (row.line, |point: &[f64]| study.inputs.describe(point));
    let Some(run) = row.run else {
        let inputs = row.inputs.as_deref().unwrap_or_default();
        let found = || RowProblem::NoSuchPoint { line, found: describe(inputs) };
        return by_bits.get(&bits(inputs)).copied().ok_or_else(found);
    };
    let i = usize::try_from(run).ok().and_then(|run| run.checked_sub(1)).filter(|&i| i < asked.len());
    let i = i.ok_or(RowProblem::NoSuchRun { line, run, asked: asked.len() })?;
    let inputs = row.inputs.as_ref().ok_or(RowProblem::NoInputs { line })?;
    match is_close(study, inputs, &asked[i].point) {
        true => Ok(i),
        false => {
            let (expected, found) = (describe(&asked[i].point), describe(inputs));
            Err(RowProblem::OtherPoint { line, run, expected, found })
        }
    }
}

/// Whether the study's modes are among these eigenvalues.
fn usable(study: &Study, eigenvalues: &[Complex<f64>]) -> Result<(), SpectrumError> {
    let spectrum = Spectrum::new(eigenvalues)?;
    match study.spectrum.target {
        Target::Eigenvalues => study.spectrum.modes.ranks(spectrum.count()).map(drop),
        // Which eigenvalues are modes is known once all answers are there.
        Target::Invariants => Ok(()),
    }
}

fn is_close(study: &Study, found: &[f64], expected: &[f64]) -> bool {
    let inputs = study.inputs.inputs();
    inputs.iter().zip(found).zip(expected).all(|((input, found), expected)| {
        (found - expected).abs() <= INPUT_TOLERANCE * width(&input.marginal, *expected)
    })
}

/// The scale of an input's values at `value`: the whole interval of a uniform standardized variable, else twice that of
/// the middle half, or twice the distance from the median in the tails, whose values have digits of their own.
fn width(law: &Marginal, value: f64) -> f64 {
    match law.germ() {
        Germ::Uniform => law.physical(1.0) - law.physical(-1.0),
        _ => {
            let [lower, median, upper] = [-0.5, 0.0, 0.5].map(|centred| law.at_centred_probability(centred));
            2.0 * (upper - lower).max((value - median).abs())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::probability::inputs::{Parameters, Uniform};

    fn law(name: &str, given: &[(&'static str, f64)]) -> Marginal {
        Marginal::named(name, &Parameters::of(given.iter().copied())).unwrap()
    }

    #[test]
    fn widths_are_those_of_what_is_probable() {
        let uniform = Marginal::Uniform(Uniform::new(15.2e6, 16.8e6).unwrap());
        assert_eq!(width(&uniform, 0.0), uniform.physical(1.0) - uniform.physical(-1.0));
        // Twice the middle half of a normal law is 4 · 0.67449 standard deviations.
        let normal = law("normal", &[("mean", 10.0), ("std", 2.0)]);
        let known = 4.0 * 0.674_489_750_196_081_7 * 2.0;
        assert!((width(&normal, 11.0) - known).abs() < 1e-12);
        assert_eq!(width(&normal, 20.0), 20.0);
        // Where ξ is at most 1 there is nothing of this one.
        let beyond = law("normal", &[("mean", 0.0), ("std", 1.0), ("lower", 2.0), ("upper", 3.0)]);
        let width_beyond = width(&beyond, 2.1);
        assert!((0.5..1.0).contains(&width_beyond), "{width_beyond}");
        // Four digits are enough for large values of a law with a long tail, too.
        let long = law("lognormal", &[("mean", 1.0), ("std", 3.0)]);
        assert!((1234.4 - 1234.0) < INPUT_TOLERANCE * width(&long, 1234.4) * 4.0);
    }
}
