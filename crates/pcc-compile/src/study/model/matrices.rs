//! Models that are matrices: from TOML values of many shapes to terms, and back.

use super::{ModelSettings, quoted};
use crate::mechanics::model::matrices::{
    Description, Entry, Form, Layout, Matrices, MatricesError, Matrix, Role, Term, read_matrix_market,
};
use crate::study::error::StudyError;
use crate::study::print::{Printer, float};
use crate::study::raw;
use crate::study::validate::Lines;
use pcc_evaluate::probability::inputs::InputSpace;
use std::fmt::Write;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;
use toml::{Spanned, Table, Value};

/// The keys of the kind.
pub(super) const KEYS: [&str; 7] = ["let", "M", "C", "K", "G", "N", "A"];

/// A matrix of 500 rows written out in full has some 7 megabytes.
const LARGEST_FILE: u64 = 1 << 28;

const FORMS: [Form; 3] = [Form::General, Form::Symmetric, Form::SkewSymmetric];

/// Keys that say how the entries of a term are written, one of which it has.
const LAYOUTS: [&str; 4] = ["rows", "diagonal", "entries", "file"];

impl Lines<'_> {
    /// A matrix: rows; one term; or a list of terms.
    pub(super) fn matrix(&self, role: Role, value: Spanned<Value>, folder: &Path) -> Result<Matrix, StudyError> {
        let place = self.place(format!("model.{}", role.name()), &value);
        terms(value.into_inner(), folder)
            .map(|terms| Matrix { role, terms })
            .map_err(|cause| StudyError::Matrices { place, cause: Box::new(cause) })
    }

    /// The helpers, in their order.
    pub(super) fn helpers(&self, table: raw::Ordered<raw::Helper>) -> Vec<(String, String)> {
        let text = |helper: raw::Helper| match helper {
            raw::Helper::Number(value) => format!("{value:?}"),
            raw::Helper::Expression(text) => text,
        };
        table.0.into_iter().map(|(name, helper)| (name, text(helper.into_inner()))).collect()
    }
}

fn terms(value: Value, folder: &Path) -> Result<Vec<Term>, MatricesError> {
    match value {
        Value::Table(table) => Ok(vec![term(table, folder)?]),
        Value::Array(list) if list.first().is_some_and(Value::is_table) => list
            .into_iter()
            .map(|item| match item {
                Value::Table(table) => term(table, folder),
                other => Err(unexpected(&other, "a table like the first one")),
            })
            .collect(),
        Value::Array(list) => Ok(vec![Term { factor: None, form: Form::General, layout: Layout::Rows(rows(list)?) }]),
        other => Err(unexpected(
            &other,
            "rows like [[\"k_1\", 0], [0, \"k_2\"]], a table like { file = \"K.mtx\", factor = \"k\" }, or a list of such tables",
        )),
    }
}

fn unexpected(found: &Value, expected: &'static str) -> MatricesError {
    MatricesError::Shape { found: shortened(&found.to_string()), expected }
}

/// Enough of a value to be recognized.
fn shortened(text: &str) -> String {
    const SHOWN: usize = 80;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

fn term(mut table: Table, folder: &Path) -> Result<Term, MatricesError> {
    let factor = table.remove("factor").map(entry).transpose()?;
    let form = match table.remove("form") {
        None => Form::General,
        Some(Value::String(name)) => FORMS
            .into_iter()
            .find(|form| form.name() == name)
            .ok_or_else(|| MatricesError::UnknownForm { found: shortened(&name) })?,
        Some(other) => return Err(MatricesError::UnknownForm { found: shortened(&other.to_string()) }),
    };
    let size = table.remove("size");
    let mut layouts = LAYOUTS.into_iter().filter_map(|key| table.remove(key).map(|value| (key, value)));
    let (key, value) = layouts.next().ok_or(MatricesError::NoLayout)?;
    if let Some((other, _)) = layouts.next() {
        return Err(MatricesError::TwoLayouts { first: key, second: other });
    }
    drop(layouts);
    if let Some(unknown) = table.keys().next() {
        return Err(MatricesError::UnknownKey { key: unknown.clone() });
    }
    if size.is_some() && key != "entries" {
        return Err(MatricesError::KeyOfLayout { key: "size", layout: "entries" });
    }
    if form != Form::General && matches!(key, "diagonal" | "file") {
        return Err(MatricesError::FormOfLayout { layout: key });
    }
    let layout = match key {
        "rows" => Layout::Rows(rows(list(value, "a list of rows")?)?),
        "diagonal" => {
            Layout::Diagonal(list(value, "a list of entries")?.into_iter().map(entry).collect::<Result<_, _>>()?)
        }
        "entries" => sparse(size, list(value, "a list of entries [row, column, value]")?)?,
        _ => file(value, folder)?,
    };
    Ok(Term { factor, form, layout })
}

fn list(value: Value, expected: &'static str) -> Result<Vec<Value>, MatricesError> {
    match value {
        Value::Array(list) => Ok(list),
        other => Err(unexpected(&other, expected)),
    }
}

fn entry(value: Value) -> Result<Entry, MatricesError> {
    match value {
        Value::Integer(whole) => Ok(Entry::Number(whole as f64)),
        Value::Float(number) => Ok(Entry::Number(number)),
        Value::String(text) => Ok(Entry::Expression(text)),
        other => Err(unexpected(&other, "a number or an expression in quotes")),
    }
}

fn rows(list_of_rows: Vec<Value>) -> Result<Vec<Vec<Entry>>, MatricesError> {
    let row = |value| list(value, "a row like [\"k_1\", 0]")?.into_iter().map(entry).collect();
    list_of_rows.into_iter().map(row).collect()
}

fn sparse(size: Option<Value>, entries: Vec<Value>) -> Result<Layout, MatricesError> {
    let index = |value: &Value| match value {
        Value::Integer(number) => usize::try_from(*number).ok().filter(|&number| number > 0),
        _ => None,
    };
    let size = size.ok_or(MatricesError::NoSize)?;
    let size = index(&size).ok_or_else(|| unexpected(&size, "a size from 1"))?;
    let mut found = Vec::with_capacity(entries.len());
    for item in entries {
        let expected = "an entry [row, column, value] with row and column from 1, like [1, 2, \"-k\"]";
        let Value::Array(mut parts) = item else { return Err(unexpected(&item, expected)) };
        let [row, column, _] = &parts[..] else { return Err(unexpected(&Value::Array(parts), expected)) };
        let (Some(row), Some(column)) = (index(row), index(column)) else {
            return Err(unexpected(&Value::Array(parts), expected));
        };
        found.push((row, column, entry(parts.remove(2))?));
    }
    Ok(Layout::Entries { size, list: found })
}

fn file(value: Value, folder: &Path) -> Result<Layout, MatricesError> {
    let Value::String(name) = value else { return Err(unexpected(&value, "the name of a file in quotes")) };
    let unreadable = |cause: String| MatricesError::Unreadable { file: name.clone(), cause };
    let path = folder.join(&name);
    if path.exists() && !path.is_file() {
        return Err(unreadable("it is no file".to_owned()));
    }
    let mut text = String::new();
    let read = File::open(path).and_then(|file| file.take(LARGEST_FILE + 1).read_to_string(&mut text));
    read.map_err(|error| match error.kind() {
        ErrorKind::InvalidData => {
            unreadable("it is no text, so no Matrix Market file; scipy.io.mmwrite writes them".to_owned())
        }
        _ => unreadable(format!("{error}; files are looked for in the folder of the study")),
    })?;
    if text.len() as u64 > LARGEST_FILE {
        return Err(unreadable(format!("it has more than {LARGEST_FILE} bytes")));
    }
    match read_matrix_market(&text) {
        Ok(matrix) => Ok(Layout::File { name, matrix }),
        Err(cause) => Err(MatricesError::MatrixMarket { file: name, cause: Box::new(cause) }),
    }
}

impl Lines<'_> {
    pub(super) fn description(
        &self,
        raw: raw::Model,
        constants: Vec<(String, f64)>,
        inputs: &InputSpace,
        folder: &Path,
    ) -> Result<ModelSettings, StudyError> {
        let place = self.place("model", &raw.kind);
        let helpers_place = raw.helpers.as_ref().map(|helpers| self.place("model.let", helpers));
        let helpers = raw.helpers.map_or(Vec::new(), |helpers| self.helpers(helpers.into_inner()));
        let values = [raw.mass, raw.damping, raw.stiffness, raw.gyroscopic, raw.circulatory, raw.state];
        let mut matrices = Vec::new();
        let mut places = Vec::new();
        for (role, value) in Role::ALL.into_iter().zip(values) {
            if let Some(value) = value {
                places.push((role.name(), self.place(format!("model.{}", role.name()), &value)));
                matrices.push(self.matrix(role, value, folder)?);
            }
        }
        let description = Description { constants, helpers, matrices };
        // Compiled once here, so that a study that is read is one that runs.
        Matrices::new(&description, &inputs.names().collect::<Vec<_>>()).map_err(|cause| {
            let of_matrix = |name: &str| places.iter().find(|(matrix, _)| *matrix == name).map(|(_, place)| place);
            let found = match cause.matrix() {
                Some(name) => of_matrix(name),
                None if matches!(cause, MatricesError::Name { table: "model.let", .. }) => helpers_place.as_ref(),
                None => None,
            };
            StudyError::Matrices { place: found.unwrap_or(&place).clone(), cause: Box::new(cause) }
        })?;
        Ok(ModelSettings::Matrices(Box::new(description)))
    }
}

pub(super) fn print(file: &mut Printer, description: &Description) {
    for matrix in &description.matrices {
        let name = matrix.role.name();
        match &matrix.terms[..] {
            [Term { factor: None, form: Form::General, layout: Layout::Rows(rows) }] => {
                let rows: Vec<String> = rows.iter().map(|row| format!("    {},\n", listed(row))).collect();
                file.line(name, format!("[\n{}]", rows.concat()), "");
            }
            [term] => file.line(name, inlined(term), ""),
            terms => {
                let terms: Vec<String> = terms.iter().map(|term| format!("    {},\n", inlined(term))).collect();
                file.line(name, format!("[\n{}]", terms.concat()), "");
            }
        }
    }
}

pub(super) fn print_helpers(file: &mut Printer, description: &Description) {
    if !description.helpers.is_empty() {
        file.table("model.let");
    }
    for (name, text) in &description.helpers {
        file.line(name, quoted(text), "");
    }
}

/// A term as a table in one line.
fn inlined(term: &Term) -> String {
    let mut parts = Vec::new();
    match &term.layout {
        Layout::Rows(rows) => {
            let rows: Vec<String> = rows.iter().map(|row| listed(row)).collect();
            parts.push(format!("rows = [{}]", rows.join(", ")));
        }
        Layout::Diagonal(entries) => parts.push(format!("diagonal = {}", listed(entries))),
        Layout::Entries { size, list } => {
            let entries: Vec<String> =
                list.iter().map(|(row, column, value)| format!("[{row}, {column}, {}]", written(value))).collect();
            parts.push(format!("size = {size}, entries = [{}]", entries.join(", ")));
        }
        Layout::File { name, .. } => parts.push(format!("file = {}", quoted(name))),
    }
    if term.form != Form::General {
        parts.push(format!("form = {:?}", term.form.name()));
    }
    if let Some(factor) = &term.factor {
        parts.push(format!("factor = {}", written(factor)));
    }
    format!("{{ {} }}", parts.join(", "))
}

fn listed(entries: &[Entry]) -> String {
    format!("[{}]", entries.iter().map(written).collect::<Vec<_>>().join(", "))
}

fn written(entry: &Entry) -> String {
    match entry {
        Entry::Number(value) => float(*value),
        Entry::Expression(text) => quoted(text),
    }
}

pub(super) fn identify(text: &mut String, description: &Description) {
    for (name, value) in &description.constants {
        let _ = writeln!(text, "constant {name} {value:?}");
    }
    for (name, expression) in &description.helpers {
        let _ = writeln!(text, "let {name} {expression:?}");
    }
    for matrix in &description.matrices {
        for Term { factor, form, layout } in &matrix.terms {
            let _ = write!(text, "{} {} ", matrix.role.name(), form.name());
            match factor {
                None => text.push_str("1 "),
                Some(factor) => {
                    let _ = write!(text, "{factor:?} ");
                }
            }
            let _ = match layout {
                Layout::Rows(rows) => writeln!(text, "rows {rows:?}"),
                Layout::Diagonal(list) => writeln!(text, "diagonal {list:?}"),
                Layout::Entries { size, list } => writeln!(text, "entries {size} {list:?}"),
                // Not the name of the file, but what is in it.
                Layout::File { matrix, .. } => {
                    writeln!(text, "file {} {} {:?}", matrix.rows, matrix.columns, matrix.entries)
                }
            };
        }
    }
}
