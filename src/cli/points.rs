//! Points from a CSV file, results to another.

use num_complex::Complex;
use pcc_evaluate::components::{Label, Top, Verdict};
use pcc_evaluate::evaluation::PointIntervals;
use pcc_evaluate::foundation::{Observer, plural, save_with};
use pcc_evaluate::probability::inputs::{InputError, InputSpace};
use serde::Serialize;
use std::fmt;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use thiserror::Error;

/// The last columns.
const VERDICT_COLUMNS: [&str; 2] = ["stable", "verdict"];

/// Points that are read, evaluated and written together: memory does not grow with the file.
const GROUP: usize = 4096;

/// Why points could not be read.
#[derive(Debug, Error)]
pub(super) enum PointsError {
    #[error("cannot be read: {0}")]
    Csv(String),
    #[error("is not UTF-8 text; convert it, as with iconv -f LATIN1 -t UTF-8, or -f UTF-16")]
    NotText,
    #[error("there is no column {name}; the header is \"{found}\"; add the column, and separate columns by commas")]
    MissingColumn { name: String, found: String },
    #[error("column {name} is there twice; remove one")]
    RepeatedColumn { name: String },
    #[error("row {row}, column {name}: {found:?} is not a finite number")]
    NotANumber { row: u64, name: String, found: String },
    #[error("row {row}: {cause}; move the point, or pass --extrapolate to evaluate it all the same")]
    Outside { row: u64, cause: InputError },
    #[error(
        "row {row}: cells and columns differ in number, {found} and {expected}; write one cell per column, and 0.25, not 0,25"
    )]
    RowLength { row: u64, found: usize, expected: usize },
    #[error("row {row}: the surrogate has no finite value there; move the point closer to the domain")]
    NotFinite { row: u64 },
    #[error(
        "row {row}: {name} = {value:?} lies where its {law} law ends, infinitely far from all model runs in what the \
         surrogate is a polynomial of, so it has no value there; move the point to where the model was run (pcc inspect \
         says where)"
    )]
    AtEnd { row: u64, name: String, value: f64, law: &'static str },
    #[error("there are no points below the header")]
    Empty,
    #[error("{path}: {cause}")]
    InFile { path: String, cause: Box<PointsError> },
}

impl From<csv::Error> for PointsError {
    fn from(error: csv::Error) -> Self {
        match error.kind() {
            csv::ErrorKind::Utf8 { .. } => Self::NotText,
            _ => Self::Csv(error.to_string()),
        }
    }
}

/// What `eval` and `reference` say after writing points.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct PointsReport {
    pub points: u64,
    pub stable_points: u64,
    /// Points whose nearest run of the design failed; absent if none did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unanswered_points: Option<u64>,
    /// Points beyond all model runs in at least one input; absent if runs fill the laws of all inputs, and if the file
    /// does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extrapolated_points: Option<u64>,
    /// The intervals that were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval: Option<IntervalReport>,
    pub file: String,
}

/// What intervals at points rest on.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct IntervalReport {
    /// The level.
    pub level: f64,
    /// Model runs left out one by one.
    pub runs: u64,
    /// Runs from which on intervals have ends at this level.
    pub least_runs: u64,
    /// Whether they have none: they are infinite at every point.
    pub is_infinite: bool,
}

impl fmt::Display for PointsReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} points, {} of them stable, written to {}", self.points, self.stable_points, self.file)?;
        if let Some(count) = self.unanswered_points.filter(|&count| count > 0) {
            writeln!(f, "\nwarning: the model did not answer near {count} of them; there the surrogate extrapolates")?;
        }
        if let Some(count) = self.extrapolated_points.filter(|&count| count > 0) {
            writeln!(
                f,
                "\nwarning: {count} of them lie beyond all model runs in some input; there the surrogate extrapolates"
            )?;
        }
        match &self.interval {
            Some(IntervalReport { level, runs, least_runs, is_infinite: true }) => writeln!(
                f,
                "\nwarning: intervals at level {level} need {least_runs} model runs left out, and the surrogate keeps {runs}: \
                 they are infinite; lower the level, or let the build make more runs with design.initial"
            ),
            Some(IntervalReport { level, runs, .. }) => {
                writeln!(f, "\nintervals at level {level}, from what was missed at {}", left_out(*runs))
            }
            None => Ok(()),
        }
    }
}

fn left_out(runs: u64) -> String {
    format!("{} left out", plural(runs as usize, "model run"))
}

/// What points yield.
pub(super) struct Evaluated {
    /// Names of the eigenvalues.
    pub labels: Vec<Label>,
    /// Per point, the eigenvalues by label, and what decides.
    pub results: Vec<(Vec<Complex<f64>>, Top)>,
    /// Per point, the intervals, if they were asked for.
    pub intervals: Option<Vec<PointIntervals>>,
}

/// A CSV file with one column per input.
pub(super) struct PointsFile<'a> {
    path: String,
    reader: csv::Reader<ShortLines<File>>,
    header_length: usize,
    columns: Vec<usize>,
    inputs: &'a InputSpace,
    extrapolate: bool,
}

impl<'a> PointsFile<'a> {
    /// Opens the file and finds the inputs' columns. Rows count from 1 below the header.
    pub fn open(path: &Path, inputs: &'a InputSpace, extrapolate: bool) -> Result<Self, PointsError> {
        let path = path.display().to_string();
        Self::find_columns(&path, inputs, extrapolate)
            .map_err(|cause| PointsError::InFile { path, cause: Box::new(cause) })
    }

    fn find_columns(path: &str, inputs: &'a InputSpace, extrapolate: bool) -> Result<Self, PointsError> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(ShortLines { inner: File::open(path).map_err(csv::Error::from)?, since_newline: 0 });
        let header = reader.headers()?.clone();
        // Text in UTF-16 without a mark of it.
        if header.iter().any(|name| name.contains('\0')) {
            return Err(PointsError::NotText);
        }
        let mut columns = Vec::new();
        for name in inputs.names() {
            let mut found = header.iter().enumerate().filter(|(_, column)| *column == name).map(|(at, _)| at);
            columns.push(found.next().ok_or_else(|| PointsError::MissingColumn {
                name: name.to_owned(),
                found: header.iter().collect::<Vec<_>>().join(", "),
            })?);
            if found.next().is_some() {
                return Err(PointsError::RepeatedColumn { name: name.to_owned() });
            }
        }
        Ok(Self { path: path.to_owned(), reader, header_length: header.len(), columns, inputs, extrapolate })
    }

    /// The next points in physical coordinates; none at the end of the file.
    fn group(&mut self, first_row: u64) -> Result<Vec<Vec<f64>>, PointsError> {
        let mut points = Vec::new();
        let mut record = csv::StringRecord::new();
        while points.len() < GROUP && self.reader.read_record(&mut record)? {
            let row = first_row + points.len() as u64;
            if record.len() != self.header_length {
                return Err(PointsError::RowLength { row, found: record.len(), expected: self.header_length });
            }
            let mut point = Vec::with_capacity(self.columns.len());
            for (&column, name) in self.columns.iter().zip(self.inputs.names()) {
                let cell = record.get(column).unwrap_or_default();
                let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
                point.push(number.ok_or_else(|| PointsError::NotANumber {
                    row,
                    name: name.to_owned(),
                    found: cell.to_owned(),
                })?);
            }
            if !self.extrapolate {
                self.inputs.check(&point).map_err(|cause| PointsError::Outside { row, cause })?;
            }
            points.push(point);
        }
        Ok(points)
    }

    /// Evaluates all points in groups and writes `path`: the point, re_k and im_k of each mode (and re_k_b, where it
    /// can have two real eigenvalues), the other real eigenvalues, max_re, stable, verdict; after each number the ends
    /// of its interval, if it has one. Returns the number of points and of stable ones. Nothing is written if anything
    /// fails.
    pub fn evaluate(
        mut self,
        path: &Path,
        observer: &dyn Observer,
        mut evaluate: impl FnMut(&[Vec<f64>]) -> anyhow::Result<Evaluated>,
    ) -> anyhow::Result<(u64, u64)> {
        let mut failure = None;
        let (mut rows, mut stable) = (0, 0);
        let written = save_with(path, |file| {
            let mut writer = csv::Writer::from_writer(file);
            loop {
                let (points, found) = match self.evaluate_group(rows, observer, &mut evaluate) {
                    Ok(Some(group)) => group,
                    Ok(None) => return writer.flush(),
                    Err(error) => {
                        failure = Some(error);
                        return Err(io::Error::other("evaluation failed"));
                    }
                };
                if rows == 0 {
                    writer.write_record(header(self.inputs, &found.labels, found.intervals.is_some()))?;
                }
                let order = in_order(&found.labels);
                for (i, (point, (eigenvalues, top))) in points.iter().zip(&found.results).enumerate() {
                    let intervals = found.intervals.as_ref().map(|intervals| &intervals[i]);
                    let cells = order.iter().flat_map(|&at| {
                        cells(found.labels[at], eigenvalues[at], intervals.map(|own| own.eigenvalues[at]))
                    });
                    let cells = point
                        .iter()
                        .copied()
                        .chain(cells)
                        .chain(with_ends(top.max_re, intervals.map(|own| own.max_re)));
                    write_row(&mut writer, cells, *top)?;
                    stable += u64::from(top.verdict() == Verdict::Stable);
                }
                rows += points.len() as u64;
            }
        });
        match failure {
            Some(error) => Err(error),
            None => Ok(written.map(|()| (rows, stable))?),
        }
    }

    /// The next points with their results, or `None` at the end of the file.
    fn evaluate_group(
        &mut self,
        rows_before: u64,
        observer: &dyn Observer,
        evaluate: &mut impl FnMut(&[Vec<f64>]) -> anyhow::Result<Evaluated>,
    ) -> anyhow::Result<Option<(Vec<Vec<f64>>, Evaluated)>> {
        observer.check()?;
        let path = self.path.clone();
        let in_file = |cause| PointsError::InFile { path: path.clone(), cause: Box::new(cause) };
        let points = self.group(rows_before + 1);
        let points = points.map_err(in_file)?;
        if points.is_empty() {
            return if rows_before == 0 { Err(in_file(PointsError::Empty).into()) } else { Ok(None) };
        }
        let found = evaluate(&points)?;
        match found.results.iter().position(|(_, top)| !top.max_re.is_finite()) {
            Some(at) => Err(in_file(self.not_finite(rows_before + 1 + at as u64, &points[at])).into()),
            None => Ok(Some((points, found))),
        }
    }
}

impl PointsFile<'_> {
    /// Why there is no finite value at a point.
    fn not_finite(&self, row: u64, point: &[f64]) -> PointsError {
        let mut coordinates = self.inputs.inputs().iter().zip(point);
        let at_end = coordinates.find(|(input, value)| !input.marginal.standardized(**value).is_finite());
        match at_end {
            Some((input, &value)) => {
                PointsError::AtEnd { row, name: input.name.clone(), value, law: input.marginal.name() }
            }
            None => PointsError::NotFinite { row },
        }
    }
}

/// Refuses lines so long that they are not rows of numbers, before they fill the memory.
struct ShortLines<R> {
    inner: R,
    since_newline: usize,
}

/// Bytes of a row that are read at most: thousands of columns.
const LONGEST_LINE: usize = 1 << 20;

impl<R: Read> Read for ShortLines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = self.inner.read(buffer)?;
        match buffer[..length].iter().rposition(|&byte| byte == b'\n') {
            Some(newline) => self.since_newline = length - newline - 1,
            None => self.since_newline += length,
        }
        if self.since_newline > LONGEST_LINE {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                "a row is longer than a megabyte; is this a CSV file?",
            ));
        }
        Ok(length)
    }
}

/// Positions of the labels in the order of columns: mode by mode, then the real eigenvalues.
fn in_order(labels: &[Label]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..labels.len()).collect();
    order.sort_by_key(|&at| labels[at].column());
    order
}

fn header(inputs: &InputSpace, labels: &[Label], has_intervals: bool) -> Vec<String> {
    let with_ends = |name: String| {
        let ends = ["lower", "upper"].map(|end| format!("{name}_{end}"));
        std::iter::once(name).chain(ends.into_iter().filter(move |_| has_intervals))
    };
    let of_label = |at: usize| {
        let frequency = labels[at].mode().map(|mode| format!("im_{mode}"));
        std::iter::once(labels[at].growth_rate()).chain(frequency)
    };
    let results = in_order(labels).into_iter().flat_map(of_label).chain(["max_re".to_owned()]).flat_map(with_ends);
    let verdicts = VERDICT_COLUMNS.map(str::to_owned);
    inputs.names().map(str::to_owned).chain(results).chain(verdicts).collect()
}

/// Re λ, and Im λ of the first eigenvalue of a mode; each with the ends of its interval, if there are intervals.
fn cells(label: Label, lambda: Complex<f64>, ends: Option<[[f64; 2]; 2]>) -> impl Iterator<Item = f64> {
    let part = move |which: usize, value: f64| with_ends(value, ends.map(|ends| ends[which]));
    part(0, lambda.re).chain(label.mode().into_iter().flat_map(move |_| part(1, lambda.im)))
}

/// A value and the ends of its interval, if it has one.
fn with_ends(value: f64, ends: Option<[f64; 2]>) -> impl Iterator<Item = f64> {
    std::iter::once(value).chain(ends.into_iter().flatten())
}

/// Numbers by their shortest exact decimals.
fn write_row<W: Write>(writer: &mut csv::Writer<W>, numbers: impl Iterator<Item = f64>, top: Top) -> csv::Result<()> {
    for value in numbers {
        writer.write_field(format!("{value:?}"))?;
    }
    let verdict = top.verdict();
    writer.write_field(if verdict == Verdict::Stable { "1" } else { "0" })?;
    writer.write_field(verdict.name())?;
    writer.write_record(None::<&[u8]>)
}
