//! Models that are functions of the program that reads the study.

use super::{ModelSettings, quoted, table};
use crate::mechanics::model::{FunctionModel, Model};
use crate::study::defaults;
use crate::study::error::StudyError;
use crate::study::print::Printer;
use crate::study::raw;
use crate::study::validate::Lines;
use std::fmt::Write;
use std::fmt::{self, Debug};
use std::sync::Arc;
use toml::Spanned;

/// The keys that say what it answers.
pub(super) const KEYS: [&str; 3] = ["answers", "on_failure", "version"];

/// What a function answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FunctionAnswers {
    /// M, C and K, or A, with derivatives.
    Matrices,
    /// Eigenvalues alone.
    Eigenvalues,
}

impl FunctionAnswers {
    const ALL: [(&str, Self); 2] = [("matrices", Self::Matrices), ("eigenvalues", Self::Eigenvalues)];

    /// Name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Matrices => "matrices",
            Self::Eigenvalues => "eigenvalues",
        }
    }
}

/// A function of the program that reads the study: what the study says of it, and the function once it is given.
#[derive(Clone)]
pub struct Function {
    /// What it answers.
    pub answers: FunctionAnswers,
    /// Handed along with the inputs: by name, sorted.
    pub constants: Vec<(String, f64)>,
    /// Set by the user when the function begins to answer otherwise: earlier runs then no longer count.
    pub version: String,
    /// Whether runs that fail are left out.
    pub skips_failures: bool,
    /// The function.
    pub(in crate::study) model: Option<Arc<dyn Model + Send>>,
}

impl Function {
    /// The function, ready to run if it was given.
    pub(in crate::study) fn model(&self) -> FunctionModel {
        FunctionModel::new(self.model.clone(), self.answers == FunctionAnswers::Matrices)
    }
}

impl Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Function")
            .field("answers", &self.answers)
            .field("constants", &self.constants)
            .field("version", &self.version)
            .field("skips_failures", &self.skips_failures)
            .field("is_given", &self.model.is_some())
            .finish()
    }
}

/// Functions cannot be compared: two are the same if the studies say the same of them.
impl PartialEq for Function {
    fn eq(&self, other: &Self) -> bool {
        let said = |function: &Self| (function.answers, function.skips_failures);
        said(self) == said(other) && self.constants == other.constants && self.version == other.version
    }
}

impl Lines<'_> {
    pub(super) fn function(
        &self,
        mut raw: raw::Model,
        constants: Vec<(String, f64)>,
    ) -> Result<ModelSettings, StudyError> {
        let answers = raw.answers.take().map(|word| self.word("model.answers", &word, &FunctionAnswers::ALL));
        Ok(ModelSettings::Function(Function {
            answers: answers.transpose()?.unwrap_or(FunctionAnswers::Matrices),
            constants,
            version: raw.version.take().map_or(defaults::VERSION.to_owned(), Spanned::into_inner),
            skips_failures: self.skips_failures(&mut raw)?,
            model: None,
        }))
    }
}

pub(super) fn print(file: &mut Printer, function: &Function) {
    let meaning = "what the function gives: \"matrices\", or \"eigenvalues\"";
    file.line("answers", format!("{:?}", function.answers.name()), meaning);
    table::print_policy(file, function.skips_failures);
    file.line("version", quoted(&function.version), "change it when the function answers otherwise");
}

/// What is asked, as text for hashes.
pub(super) fn identify(text: &mut String, function: &Function) {
    let _ = writeln!(text, "answers {}\nversion {:?}", function.answers.name(), function.version);
    for (name, value) in &function.constants {
        let _ = writeln!(text, "constant {name} {value:?}");
    }
}
