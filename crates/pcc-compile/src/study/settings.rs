//! The decisions a study records.

use crate::fitting::fit::FitMethod;
use crate::mechanics::model::command::{CommandModel, CommandSettings, Keep, Mode};
use crate::mechanics::model::matrices::Description;
use crate::mechanics::spectrum::{Modes, Target};
use std::path::PathBuf;
use std::time::Duration;

/// The model and what it is given besides the uncertain inputs.
#[derive(Debug, Clone, PartialEq)]
pub enum ModelSettings {
    /// The built-in clutch.
    Clutch {
        /// Constants that replace nominal values, by name, sorted.
        constants: Vec<(String, f64)>,
    },
    /// Matrices of the user's.
    Matrices(Box<Description>),
    /// A program of the user's.
    Command(Command),
    /// Nothing that pcc runs: answers come in tables.
    Table(Table),
}

/// A program that answers eigenvalues.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// The program and its arguments; `{study}` stands for the folder of the study, `{work}` for that of the run.
    pub arguments: Vec<String>,
    /// Whether the one argument is a line for the shell.
    pub shell: bool,
    /// One run per process, or many.
    pub mode: Mode,
    /// What is asked and answered.
    pub answers: Table,
    /// Processes that go on at once, at least 1.
    pub jobs: usize,
    /// Seconds after which a process is stopped.
    pub timeout: Option<f64>,
    /// Further attempts at a run that failed.
    pub retries: u32,
    /// Where the folders of runs are.
    pub work_folder: String,
    /// Which of them are kept.
    pub keep: Keep,
    /// The folder of the study.
    pub study_folder: PathBuf,
}

impl Command {
    /// The program, ready to run at points of these inputs.
    pub(super) fn program(&self, inputs: &[&str]) -> CommandModel {
        CommandModel::new(CommandSettings {
            command: self.arguments.clone(),
            shell: self.shell,
            mode: self.mode,
            jobs: self.jobs,
            timeout: self.timeout.map(Duration::from_secs_f64),
            retries: self.retries,
            eigenvalues: self.answers.eigenvalues,
            work_folder: PathBuf::from(&self.work_folder),
            keep: self.keep,
            // Arguments and working folders need it whole, wherever the program is started.
            study_folder: std::path::absolute(&self.study_folder).unwrap_or_else(|_| self.study_folder.clone()),
            inputs: inputs.iter().map(|&name| name.to_owned()).collect(),
            constants: self.answers.constants.clone(),
        })
    }
}

/// Answers in numbers: what is asked, and how many eigenvalues each run answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Eigenvalues of each run, at least 1.
    pub eigenvalues: usize,
    /// Handed along with the inputs: by name, sorted.
    pub constants: Vec<(String, f64)>,
    /// Set by the user when the program begins to answer otherwise: earlier runs then no longer count.
    pub version: String,
    /// Whether runs that fail are left out.
    pub skips_failures: bool,
}

impl ModelSettings {
    /// Name in study files.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Clutch { .. } => "clutch",
            Self::Matrices(_) => "matrices",
            Self::Command(_) => "command",
            Self::Table(_) => "table",
        }
    }

    /// Whether runs that fail are left out of a build instead of ending it.
    pub fn skips_failures(&self) -> bool {
        match self {
            Self::Clutch { .. } | Self::Matrices(_) => false,
            Self::Command(command) => command.answers.skips_failures,
            Self::Table(table) => table.skips_failures,
        }
    }

    /// Whether a run is a program's, which may take hours, and not pcc's own.
    pub fn is_external(&self) -> bool {
        matches!(self, Self::Command(_) | Self::Table(_))
    }

    /// What runs of programs and tables answer.
    pub fn answers(&self) -> Option<&Table> {
        match self {
            Self::Clutch { .. } | Self::Matrices(_) => None,
            Self::Command(command) => Some(&command.answers),
            Self::Table(table) => Some(table),
        }
    }

    /// Whether the model knows the derivatives of its state matrix.
    pub fn has_derivatives(&self) -> bool {
        match self {
            Self::Clutch { .. } | Self::Matrices(_) => true,
            Self::Command(_) | Self::Table(_) => false,
        }
    }
}

/// What of the spectrum is expanded.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumSettings {
    /// What the components are.
    pub target: Target,
    /// Which modes.
    pub modes: Modes,
}

/// How design points are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DesignKind {
    /// Nested Latin hypercube levels.
    NestedLhs,
    /// The same with points spread apart.
    NestedMaximinLhs,
    /// The nodes of a tensor Gauss rule.
    TensorGauss,
}

impl DesignKind {
    /// Name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Self::NestedLhs => "nested-lhs",
            Self::NestedMaximinLhs => "nested-maximin-lhs",
            Self::TensorGauss => "tensor-gauss",
        }
    }
}

/// The experimental design and how it grows.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignSettings {
    /// How points are chosen.
    pub kind: DesignKind,
    /// Number of points of the first level, at least 2; for methods that fix it, of the whole design, or of each
    /// element.
    pub initial: usize,
    /// Points added by each enrichment, at least 1.
    pub step: usize,
    /// Number of points the design never exceeds, at least `initial`.
    pub maximum: usize,
}

impl DesignSettings {
    /// The size of the level after `size`, or `None` at the maximum.
    pub fn next_size(&self, size: usize) -> Option<usize> {
        (size < self.maximum).then(|| size.saturating_add(self.step).min(self.maximum))
    }
}

/// How expansions are fitted, and when the design is large enough.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSettings {
    /// Fitting method with its settings.
    pub method: FitMethod,
    /// Estimated relative error of the stability proportion at which the design is large enough, in (0, 1\]; without it
    /// the fits of the components alone decide.
    pub proportion_tolerance: Option<f64>,
    /// Whether derivatives of the components enter the fit.
    pub derivatives: Derivatives,
}

impl FitSettings {
    pub(super) fn use_derivatives(&self, target: Target, model: &ModelSettings) -> bool {
        self.method.can_use_derivatives() && self.derivatives.are_used(target, model)
    }
}

/// Whether derivatives of the components by the inputs enter a fit beside the values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivatives {
    /// For invariants, if the model has them.
    Auto,
    /// Yes; a model without them is an error.
    Always,
    /// No.
    Never,
}

impl Derivatives {
    pub(super) fn are_used(self, target: Target, model: &ModelSettings) -> bool {
        match self {
            Self::Auto => target == Target::Invariants && model.has_derivatives(),
            Self::Always => true,
            Self::Never => false,
        }
    }

    /// The value in study files.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Auto => "\"auto\"",
            Self::Always => "true",
            Self::Never => "false",
        }
    }
}
