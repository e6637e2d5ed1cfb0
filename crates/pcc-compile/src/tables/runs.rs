//! Runs of a model that somebody has made already, as the rows of a table.

use super::columns::{Columns, Slot};
use super::error::{DataError, RowProblem, RowProblemKind};
use super::text::{Decimal, Dialect, LineCounter, delimiter, is_decimal_comma, read_text};
use crate::mechanics::spectrum::{Spectrum, largest_difference};
use csv::StringRecord;
use nalgebra::Complex;
use pcc_evaluate::foundation::sha256_bytes;
use pcc_evaluate::probability::inputs::InputSpace;
use std::collections::HashMap;
use std::path::PathBuf;

/// Two answers at the same point may differ by this share of the largest eigenvalue: solvers round otherwise.
const ANSWER_TOLERANCE: f64 = 1e-9;

/// Characters of a foreign cell in a message.
const SHOWN_CELL: usize = 60;

/// What a run answered.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Eigenvalues, in 1/s; of a conjugate pair at least that with Im λ > 0.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Derivatives of some of them, by number, by each input in its own unit.
    pub slopes: Vec<(usize, Vec<Complex<f64>>)>,
}

/// The point of a row, and what it says of it.
type Row = (Vec<f64>, Result<Answer, String>);

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenRun {
    /// The inputs, in physical units.
    pub point: Vec<f64>,
    /// What it answered, or why it failed.
    pub answer: Result<Answer, String>,
    file: usize,
    line: u64,
}

/// The runs of one or several tables, each point once.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenRuns {
    /// The runs, in the order of the rows.
    pub runs: Vec<GivenRun>,
    /// Names of the files.
    pub files: Vec<String>,
    /// Rows that said what others say, too: the first few, in words.
    pub repeated: Vec<String>,
    /// Their number.
    pub repetitions: usize,
    /// Columns that mean nothing.
    pub ignored: Vec<String>,
    /// Eigenvalues of each run, as the columns have them.
    pub eigenvalues: usize,
    /// Whether some runs come with derivatives.
    pub has_derivatives: bool,
}

/// A table, and what it is called in messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataFile {
    /// Where it is.
    pub path: PathBuf,
    /// What it is called.
    pub shown: String,
}

/// How tables of runs are read.
#[derive(Debug, Clone, Copy)]
pub struct RunsReader<'r> {
    /// The inputs, which columns are called by.
    pub inputs: &'r InputSpace,
    /// How tables are written.
    pub dialect: Dialect,
    /// Eigenvalues of each run, if it is known.
    pub eigenvalues: Option<usize>,
    /// Whether runs that failed are left out; else they are an error.
    pub skips_failures: bool,
    /// Relative error of eigenvalues, as a share of the largest |λ|.
    pub noise: f64,
}

impl RunsReader<'_> {
    /// Reads tables one after the other, and puts them together.
    ///
    /// # Errors
    ///
    /// [`DataError`]: of files and their headers the first that is wrong, of rows all that are.
    pub fn read(&self, files: &[DataFile]) -> Result<GivenRuns, DataError> {
        let mut found = GivenRuns {
            runs: Vec::new(),
            files: files.iter().map(|file| file.shown.clone()).collect(),
            repeated: Vec::new(),
            repetitions: 0,
            ignored: Vec::new(),
            eigenvalues: 0,
            has_derivatives: false,
        };
        let mut problems = Vec::new();
        for (number, file) in files.iter().enumerate() {
            let text = read_text(&file.path, &file.shown)?;
            self.read_text((number, &file.shown), &text, &mut found, &mut problems)?;
        }
        self.unite(&mut found, &mut problems);
        if !problems.is_empty() {
            problems.sort_by_key(|(file, problem)| (*file, problem.line));
            return Err(DataError::Rows(problems.into_iter().map(|(_, problem)| problem).collect()));
        }
        if found.runs.is_empty() {
            return Err(DataError::NoRows { files: found.files.join(", ") });
        }
        found.has_derivatives =
            found.runs.iter().any(|run| run.answer.as_ref().is_ok_and(|answer| !answer.slopes.is_empty()));
        Ok(found)
    }

    fn read_text(
        &self,
        (number, shown): (usize, &str),
        text: &str,
        found: &mut GivenRuns,
        problems: &mut Vec<(usize, RowProblem)>,
    ) -> Result<(), DataError> {
        let mut reader = csv::ReaderBuilder::new();
        // Separators beyond ASCII are refused where they are read.
        let byte = self.dialect.delimiter.and_then(|separator| u8::try_from(separator).ok());
        let reader = reader.delimiter(byte.unwrap_or_else(|| delimiter(text)));
        let mut reader = reader.has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
        let unreadable = |error: csv::Error| {
            let cause = error.to_string();
            DataError::Text(super::TextError::Unreadable { file: shown.to_owned(), cause })
        };
        let mut row = StringRecord::new();
        if !reader.read_record(&mut row).map_err(unreadable)? {
            return Err(DataError::Empty { file: shown.to_owned() });
        }
        let inputs: Vec<String> = self.inputs.names().map(str::to_owned).collect();
        let columns = Columns::find(shown, row.iter().map(str::to_owned).collect(), &inputs)?;
        self.check_count(shown, &columns, found)?;
        for name in &columns.ignored {
            if !found.ignored.contains(name) {
                found.ignored.push(name.clone());
            }
        }
        let mut lines = LineCounter::new(text);
        while reader.read_record(&mut row).map_err(unreadable)? {
            if row.iter().all(str::is_empty) {
                continue;
            }
            let line = lines.line(row.position().map_or(0, |position| position.byte() as usize));
            match self.run(&columns, &row) {
                Ok((point, answer)) => found.runs.push(GivenRun { point, answer, file: number, line }),
                Err(kind) => problems.push((number, RowProblem { file: shown.to_owned(), line, kind })),
            }
        }
        Ok(())
    }

    /// As many eigenvalues as the study says, and as tables before.
    fn check_count(&self, shown: &str, columns: &Columns, found: &mut GivenRuns) -> Result<(), DataError> {
        let eigenvalues = columns.eigenvalues();
        let before =
            Some(found.eigenvalues).filter(|&before| before > 0).map(|before| (before, found.files[0].clone()));
        let expected = self.eigenvalues.map(|stated| (stated, "model.eigenvalues of the study".to_owned())).or(before);
        found.eigenvalues = eigenvalues;
        match expected.filter(|(expected, _)| *expected != eigenvalues) {
            Some((expected, by)) => {
                Err(DataError::OtherEigenvalues { file: shown.to_owned(), found: eigenvalues, expected, by })
            }
            None => Ok(()),
        }
    }

    /// The point of a row, and what it says of it.
    fn run(&self, columns: &Columns, row: &StringRecord) -> Result<Row, RowProblemKind> {
        if row.len() != columns.names.len() {
            return Err(RowProblemKind::CellCount { found: row.len(), expected: columns.names.len() });
        }
        let cells = Cells { columns, row, decimal: self.dialect.decimal };
        let point = columns.inputs.iter().map(|&at| cells.number(at)).collect::<Result<Vec<f64>, _>>()?;
        self.inputs.check(&point).map_err(RowProblemKind::Outside)?;
        let error = columns.error.map_or("", |at| cells.text(at));
        if !error.is_empty() {
            let cause = cut(error);
            return if self.skips_failures { Ok((point, Err(cause))) } else { Err(RowProblemKind::Failed { cause }) };
        }
        let mut answer = Answer { eigenvalues: Vec::with_capacity(columns.eigenvalues()), slopes: Vec::new() };
        for slot in &columns.slots {
            cells.eigenvalue(slot, &mut answer)?;
        }
        with_upper_halves(&mut answer);
        match answer.eigenvalues.iter().all(|lambda| lambda.norm() == 0.0) {
            true => Err(RowProblemKind::OnlyZeros),
            false => Ok((point, Ok(answer))),
        }
    }

    /// Keeps every point once, and notes rows that contradict others.
    fn unite(&self, found: &mut GivenRuns, problems: &mut Vec<(usize, RowProblem)>) {
        let mut first: HashMap<Vec<u64>, usize> = HashMap::with_capacity(found.runs.len());
        let mut kept: Vec<GivenRun> = Vec::with_capacity(found.runs.len());
        let mut expected = None;
        for run in std::mem::take(&mut found.runs) {
            let mut refuse = |kind| {
                problems.push((run.file, RowProblem { file: found.files[run.file].clone(), line: run.line, kind }));
            };
            if let Ok(answer) = &run.answer
                && let Ok(spectrum) = Spectrum::new(&answer.eigenvalues)
            {
                let count = spectrum.eigenvalues().len() + spectrum.rigid_body_modes();
                let expected = *expected.get_or_insert(count);
                if count != expected {
                    refuse(RowProblemKind::Eigenvalues { found: count, expected });
                    continue;
                }
            }
            // −0 is 0.
            let bits = run.point.iter().map(|value| (value + 0.0).to_bits()).collect();
            let Some(&at) = first.get(&bits) else {
                first.insert(bits, kept.len());
                kept.push(run);
                continue;
            };
            let place = |other: &GivenRun| match other.file == run.file {
                true => format!("line {}", other.line),
                false => format!("{}, line {}", found.files[other.file], other.line),
            };
            match (&kept[at].answer, &run.answer) {
                (Ok(before), Ok(now)) => {
                    let (difference, scale) = largest_difference(&before.eigenvalues, &now.eigenvalues);
                    if difference > ANSWER_TOLERANCE.max(2.0 * self.noise) * scale {
                        refuse(RowProblemKind::Contradiction { other: place(&kept[at]), difference });
                        continue;
                    }
                }
                // An answer says more than a failure.
                (Err(_), Ok(_)) => kept[at] = GivenRun { point: kept[at].point.clone(), ..run.clone() },
                (_, Err(_)) => {}
            }
            found.repetitions += 1;
            if found.repeated.len() < SHOWN_REPETITIONS {
                found.repeated.push(format!("{}, line {}", found.files[run.file], run.line));
            }
        }
        found.runs = kept;
    }
}

/// Rows that said what others say which a report names.
const SHOWN_REPETITIONS: usize = 5;

/// The cells of a row.
struct Cells<'c> {
    columns: &'c Columns,
    row: &'c StringRecord,
    decimal: Decimal,
}

impl Cells<'_> {
    fn text(&self, at: usize) -> &str {
        self.row.get(at).unwrap_or_default()
    }

    fn number(&self, at: usize) -> Result<f64, RowProblemKind> {
        let cell = self.text(at);
        self.decimal.number(cell).ok_or_else(|| {
            let (column, found) = (cut(&self.columns.names[at]), cut(cell));
            let is_point = || cell.parse().is_ok_and(f64::is_finite);
            match self.decimal {
                _ if cell.is_empty() => RowProblemKind::EmptyCell { column },
                Decimal::Point if is_decimal_comma(cell) => RowProblemKind::DecimalComma { column, found },
                Decimal::Comma if is_point() => RowProblemKind::DecimalPoint { column, found },
                _ => RowProblemKind::NotANumber { column, found },
            }
        })
    }

    /// The eigenvalue of a slot, or both where it has two, with its derivatives.
    fn eigenvalue(&self, slot: &Slot, answer: &mut Answer) -> Result<(), RowProblemKind> {
        let im = slot.im.map_or(Ok(0.0), |at| self.number(at))?;
        let lambda = Complex::new(self.number(slot.re)?, im);
        if let Some(columns) = &slot.slopes {
            let cells = || columns.iter().flatten().flatten();
            if cells().any(|&at| !self.text(at).is_empty()) {
                let part = |at: Option<usize>| at.map_or(Ok(0.0), |at| self.number(at));
                let slope = |&[re, im]: &[Option<usize>; 2]| Ok(Complex::new(part(re)?, part(im)?));
                let slopes = columns.iter().map(slope).collect::<Result<_, _>>()?;
                answer.slopes.push((answer.eigenvalues.len(), slopes));
            }
        }
        answer.eigenvalues.push(lambda);
        if let Some(second) = slot.second {
            // Where the mode oscillates, its second eigenvalue is the conjugate.
            answer.eigenvalues.push(if im == 0.0 { Complex::new(self.number(second)?, 0.0) } else { lambda.conj() });
        }
        Ok(())
    }
}

/// Turns lower halves of pairs whose upper halves are not given. Solvers of complex matrices give conjugates but for
/// rounding.
fn with_upper_halves(answer: &mut Answer) {
    /// Eigenvalues nearer to each other than this share of the largest are one.
    const ROUNDING: f64 = 1e-6;
    let near = ROUNDING * answer.eigenvalues.iter().map(|lambda| lambda.norm()).fold(0.0, f64::max);
    let is_upper = |lambda: Complex<f64>| {
        let others = answer.eigenvalues.iter().filter(|other| other.im > 0.0);
        others.into_iter().any(|other| (other - lambda.conj()).norm() <= near)
    };
    let has_upper: Vec<bool> = answer.eigenvalues.iter().map(|lambda| is_upper(*lambda)).collect();
    for (number, has_upper) in has_upper.into_iter().enumerate() {
        let lambda = answer.eigenvalues[number];
        if lambda.im < 0.0 && !has_upper {
            answer.eigenvalues[number] = lambda.conj();
            let own = answer.slopes.iter_mut().filter(|(of, _)| *of == number);
            own.flat_map(|(_, slopes)| slopes).for_each(|slope| *slope = slope.conj());
        }
    }
}

/// The beginning of a foreign text, without what moves a cursor.
pub(super) fn cut(text: &str) -> String {
    let shown = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let mut characters = text.chars().map(shown);
    let mut beginning: String = characters.by_ref().take(SHOWN_CELL).collect();
    if characters.next().is_some() {
        beginning.push('…');
    }
    beginning
}

impl GivenRuns {
    /// Where a run stands, in words.
    pub fn place(&self, run: &GivenRun) -> String {
        format!("{}, line {}", self.files[run.file], run.line)
    }

    /// The name and value of an input that has one value in all runs.
    pub fn constant_input(&self, inputs: &InputSpace) -> Option<DataError> {
        let first = &self.runs.first()?.point;
        let is_constant = |&j: &usize| self.runs.iter().all(|run| run.point[j] == first[j]);
        let j = (0..first.len()).find(is_constant)?;
        Some(DataError::ConstantInput { name: inputs.inputs()[j].name.clone(), value: first[j] })
    }

    /// SHA-256 of all numbers in their order.
    pub fn digest(&self) -> [u8; 32] {
        let mut bytes = Vec::new();
        let mut note = |number: f64| bytes.extend_from_slice(&number.to_le_bytes());
        for run in &self.runs {
            run.point.iter().copied().for_each(&mut note);
            let Ok(answer) = &run.answer else { continue };
            let slopes = answer.slopes.iter().flat_map(|(_, slopes)| slopes);
            answer.eigenvalues.iter().chain(slopes).for_each(|number| {
                note(number.re);
                note(number.im);
            });
        }
        sha256_bytes(&bytes)
    }
}
