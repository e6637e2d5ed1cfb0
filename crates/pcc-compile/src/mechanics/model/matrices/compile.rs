//! From a description to matrices that can be evaluated: names resolved, shapes checked, what is fixed added up.

use super::assembly::{Assembly, Scaled, Varying};
use super::description::{Description, Entry, Form, Layout, Matrix, Role, Term};
use super::error::MatricesError;
use super::{MOST_ROWS, Matrices, Source, System};
use pcc_expressions::{Compiler, ExpressionError, Output};
use std::collections::HashSet;
use std::sync::Mutex;

pub(super) fn compile(description: &Description, inputs: &[&str]) -> Result<Matrices, MatricesError> {
    let mut builder = Builder { compiler: compiler(description, inputs)?, sources: Vec::new(), size: 0 };
    builder.size = size(description)?;
    let mut assembly = |role: Role| builder.assembly(description, role);
    let system = if has(description, Role::State) {
        System::FirstOrder(assembly(Role::State)?)
    } else {
        let (mass, mut damping, mut stiffness) =
            (assembly(Role::Mass)?, assembly(Role::Damping)?, assembly(Role::Stiffness)?);
        add(&mut damping, assembly(Role::Gyroscopic)?);
        add(&mut stiffness, assembly(Role::Circulatory)?);
        if mass.is_fixed() && !mass.fixed.clone().lu().is_invertible() {
            return Err(MatricesError::SingularMass);
        }
        System::SecondOrder { mass, damping, stiffness }
    };
    if let Some(unused) = builder.compiler.unused_variables().first() {
        return Err(MatricesError::UnusedInput { name: (*unused).to_owned() });
    }
    let Builder { compiler, sources, .. } = builder;
    let program = compiler.finish().map_err(|cause| MatricesError::Program(Box::new(cause)))?;
    let inputs = inputs.iter().map(|&name| name.to_owned()).collect();
    Ok(Matrices { program, system, inputs, sources, workspaces: Mutex::new(Vec::new()) })
}

/// Inputs, constants and helpers.
fn compiler(description: &Description, inputs: &[&str]) -> Result<Compiler, MatricesError> {
    let wrong = |table, name: &str| {
        let name = name.to_owned();
        move |cause: ExpressionError| MatricesError::Name { table, name, cause: Box::new(cause) }
    };
    // One by one, so that the error names the input.
    for name in inputs {
        Compiler::new(&[name]).map_err(wrong("inputs", name))?;
    }
    let mut compiler = Compiler::new(inputs).map_err(wrong("inputs", ""))?;
    for (name, value) in &description.constants {
        compiler.constant(name, *value).map_err(wrong("model.constants", name))?;
    }
    for (name, text) in &description.helpers {
        compiler.define(name, text).map_err(wrong("model.let", name))?;
    }
    Ok(compiler)
}

fn has(description: &Description, role: Role) -> bool {
    description.matrices.iter().any(|matrix| matrix.role == role)
}

/// Rows of the system, by the first term of its first matrix; whether the needed matrices are there.
fn size(description: &Description) -> Result<usize, MatricesError> {
    let is_first_order = has(description, Role::State);
    if is_first_order && description.matrices.len() > 1 {
        return Err(MatricesError::Incomplete("A is the whole of a first-order system; remove M, C, K, G and N, or A"));
    }
    let is_second_order = has(description, Role::Mass) && has(description, Role::Stiffness);
    if !(is_first_order || is_second_order) {
        return Err(MatricesError::Incomplete(
            "a second-order system needs M and K (C, G and N are optional), a first-order one A; add them",
        ));
    }
    let first = &description.matrices[0];
    let size = first.terms.first().map_or(0, |term| match &term.layout {
        Layout::Rows(rows) => rows.len(),
        Layout::Diagonal(list) => list.len(),
        Layout::Entries { size, .. } => *size,
        Layout::File { matrix, .. } => matrix.rows,
    });
    match size {
        1..=MOST_ROWS => Ok(size),
        _ => Err(MatricesError::Size { matrix: first.role.name(), size, most: MOST_ROWS }),
    }
}

fn add(matrix: &mut Assembly, other: Assembly) {
    matrix.fixed += other.fixed;
    matrix.varying.extend(other.varying);
    matrix.scaled.extend(other.scaled);
}

/// A number or an output of the program.
#[derive(Clone, Copy)]
enum Value {
    Fixed(f64),
    Varying(Output),
}

/// Compiles one expression after the other.
struct Builder {
    compiler: Compiler,
    /// One per output of the program.
    sources: Vec<Source>,
    size: usize,
}

impl Builder {
    fn assembly(&mut self, description: &Description, role: Role) -> Result<Assembly, MatricesError> {
        let mut assembly = Assembly::zeros(self.size);
        let Some(Matrix { terms, .. }) = description.matrices.iter().find(|matrix| matrix.role == role) else {
            return Ok(assembly);
        };
        for (number, term) in (1..).zip(terms) {
            self.add_term(&mut assembly, role.name(), number, term)?;
        }
        if let Some(at) = assembly.fixed.iter().position(|value| !value.is_finite()) {
            let (row, column) = (at % self.size + 1, at / self.size + 1);
            let text = "the sum of its constant terms".to_owned();
            let value = assembly.fixed[(row - 1, column - 1)];
            return Err(MatricesError::NotFinite { matrix: role.name(), row, column, text, value });
        }
        Ok(assembly)
    }

    fn add_term(
        &mut self,
        assembly: &mut Assembly,
        matrix: &'static str,
        number: usize,
        term: &Term,
    ) -> Result<(), MatricesError> {
        let factor = match &term.factor {
            None => Value::Fixed(1.0),
            Some(factor) => self.factor(matrix, number, factor)?,
        };
        let entries = match &term.layout {
            Layout::File { matrix: found, .. } => {
                self.check_size(matrix, found.rows, found.columns)?;
                found.entries.iter().map(|&(row, column, value)| (row, column, 1.0, Value::Fixed(value))).collect()
            }
            layout => self.written_entries(matrix, layout, term.form)?,
        };
        let mut scaled = Vec::new();
        for (row, column, sign, value) in entries {
            match (factor, value) {
                (Value::Fixed(factor), Value::Fixed(value)) => assembly.fixed[(row, column)] += sign * factor * value,
                (Value::Varying(_), Value::Fixed(value)) => scaled.push((row, column, sign * value)),
                (Value::Fixed(factor), Value::Varying(value)) => {
                    assembly.varying.push(Varying { row, column, sign: sign * factor, value, factor: None });
                }
                (Value::Varying(factor), Value::Varying(value)) => {
                    assembly.varying.push(Varying { row, column, sign, value, factor: Some(factor) });
                }
            }
        }
        if let Value::Varying(factor) = factor {
            assembly.scaled.push(Scaled { factor, entries: scaled });
        }
        Ok(())
    }

    fn check_size(&self, matrix: &'static str, rows: usize, columns: usize) -> Result<(), MatricesError> {
        match (rows, columns) == (self.size, self.size) {
            true => Ok(()),
            false => Err(MatricesError::TermSize { matrix, rows, columns, size: self.size }),
        }
    }

    /// Row and column from 0, sign and value of every entry, mirror images included.
    fn written_entries(
        &mut self,
        matrix: &'static str,
        layout: &Layout,
        form: Form,
    ) -> Result<Vec<(usize, usize, f64, Value)>, MatricesError> {
        let mut found = Vec::new();
        for (row, column, entry) in self.places(matrix, layout, form)? {
            let value = self.entry(matrix, row, column, entry)?;
            if row == column && form == Form::SkewSymmetric {
                if !matches!(value, Value::Fixed(0.0)) {
                    return Err(MatricesError::SkewDiagonal { matrix, row });
                }
                continue;
            }
            found.push((row - 1, column - 1, 1.0, value));
            if let Some(sign) = form.mirror().filter(|_| row != column) {
                found.push((column - 1, row - 1, sign, value));
            }
        }
        Ok(found)
    }

    /// The entries that are written, with their rows and columns from 1.
    fn places<'a>(
        &self,
        matrix: &'static str,
        layout: &'a Layout,
        form: Form,
    ) -> Result<Vec<(usize, usize, &'a Entry)>, MatricesError> {
        match layout {
            Layout::Rows(rows) => {
                self.check_size(matrix, rows.len(), self.size)?;
                for (row, entries) in (1..).zip(rows) {
                    let expected = if form == Form::General { self.size } else { row };
                    if entries.len() != expected {
                        let hint = match form {
                            Form::General => "",
                            _ => ": with this form rows end at the diagonal",
                        };
                        return Err(MatricesError::RowLength { matrix, row, found: entries.len(), expected, hint });
                    }
                }
                let row = |(row, entries): (usize, &'a Vec<Entry>)| {
                    (1..).zip(entries).map(move |(column, entry)| (row, column, entry))
                };
                Ok((1..).zip(rows).flat_map(row).collect())
            }
            Layout::Diagonal(list) => {
                self.check_size(matrix, list.len(), list.len())?;
                Ok((1..).zip(list).map(|(row, entry)| (row, row, entry)).collect())
            }
            Layout::Entries { size, list } => {
                self.check_size(matrix, *size, *size)?;
                let mut seen = HashSet::new();
                for &(row, column, _) in list {
                    if row > *size || column > *size {
                        return Err(MatricesError::NoSuchEntry { matrix, row, column, size: *size });
                    }
                    let place = if form == Form::General { (row, column) } else { (row.max(column), row.min(column)) };
                    if !seen.insert(place) {
                        return Err(MatricesError::Repeated { matrix, row, column });
                    }
                }
                Ok(list.iter().map(|(row, column, entry)| (*row, *column, entry)).collect())
            }
            Layout::File { .. } => Ok(Vec::new()),
        }
    }

    fn entry(
        &mut self,
        matrix: &'static str,
        row: usize,
        column: usize,
        entry: &Entry,
    ) -> Result<Value, MatricesError> {
        let text = text(entry);
        let source = Source::Entry { matrix, row, column, text: text.clone() };
        match self.value(entry, source).map_err(|cause| MatricesError::Entry {
            matrix,
            row,
            column,
            cause: Box::new(cause),
        })? {
            Value::Fixed(value) if !value.is_finite() => {
                Err(MatricesError::NotFinite { matrix, row, column, text, value })
            }
            value => Ok(value),
        }
    }

    fn factor(&mut self, matrix: &'static str, term: usize, entry: &Entry) -> Result<Value, MatricesError> {
        let text = text(entry);
        let source = Source::Factor { matrix, term, text: text.clone() };
        match self.value(entry, source).map_err(|cause| MatricesError::Factor {
            matrix,
            term,
            cause: Box::new(cause),
        })? {
            Value::Fixed(value) if !value.is_finite() => {
                Err(MatricesError::FactorNotFinite { matrix, term, text, value })
            }
            value => Ok(value),
        }
    }

    fn value(&mut self, entry: &Entry, source: Source) -> Result<Value, ExpressionError> {
        let text = match entry {
            Entry::Number(value) => return Ok(Value::Fixed(*value)),
            Entry::Expression(text) => text,
        };
        let output = self.compiler.expression(text)?;
        self.sources.push(source);
        Ok(self.compiler.value_if_constant(output).map_or(Value::Varying(output), Value::Fixed))
    }
}

/// An entry as it is written.
fn text(entry: &Entry) -> String {
    match entry {
        Entry::Number(value) => format!("{value:?}"),
        Entry::Expression(text) => text.clone(),
    }
}
