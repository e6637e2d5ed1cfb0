//! Studies: what to build a surrogate of, and how. A TOML file becomes a validated problem.

mod column;
mod data;
mod defaults;
mod dependence;
mod error;
mod file;
mod fit;
mod identity;
mod inputs;
mod measured;
mod model;
mod print;
mod raw;
mod relative;
#[cfg(feature = "schema")]
mod schema;
mod settings;
mod validate;

pub use column::TableError;
pub use data::{DataOptions, GivenData, HOLDOUT, is_holdout};
pub use dependence::{DependenceError, DependenceSettings, Measure};
pub use error::{Place, StudyError};
pub use file::StudyFileError;
pub use model::{Attempts, Command, Function, FunctionAnswers, ModelSettings, Table, UmBridge};
#[cfg(feature = "schema")]
pub use schema::schema;
pub use settings::{Derivatives, DesignKind, DesignSettings, Enrich, FitSettings, NAMED_SHARES, SpectrumSettings};

use crate::mechanics::model::matrices::Matrices;
use crate::mechanics::model::{Clutch, Model, ModelError, TableModel};
use pcc_evaluate::probability::inputs::InputSpace;
use std::path::Path;
use std::sync::Arc;

/// The format of study files this version reads.
pub const STUDY_FORMAT: u32 = 1;

/// A validated study: every value is present and in range.
///
/// # Examples
///
/// ```
/// use pcc_compile::study::Study;
/// let study = Study::from_toml(
///     r#"
///     format = 1
///     name = "friction-only"
///     [model]
///     kind = "clutch"
///     [inputs]
///     mu = { distribution = "uniform", lower = 0.0, upper = 0.5 }
///     "#,
/// )?;
/// assert_eq!(study.fit.method.max_degree(), 15);
/// assert_eq!(Study::from_toml(&study.to_toml())?, study);
/// # Ok::<(), pcc_compile::study::StudyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Name of the study and of the files built from it.
    pub name: String,
    /// Seed of the design.
    pub seed: u64,
    /// The model and its constants.
    pub model: ModelSettings,
    /// Runs that have been made already.
    pub data: Option<GivenData>,
    /// The uncertain inputs.
    pub inputs: InputSpace,
    /// What was said of their dependence; independent if nothing. The inputs know what follows.
    pub dependence: Option<DependenceSettings>,
    /// What of the spectrum is expanded.
    pub spectrum: SpectrumSettings,
    /// Where the model is run.
    pub design: DesignSettings,
    /// How expansions are fitted.
    pub fit: FitSettings,
}

impl Study {
    /// Reads a study. Files that it names are looked for in the current folder.
    ///
    /// # Errors
    ///
    /// [`StudyError`] names the key and the line, what was found and what to do.
    pub fn from_toml(text: &str) -> Result<Self, StudyError> {
        Self::from_toml_in(text, Path::new("."))
    }

    /// Reads a study that lies in `folder`, where the files that it names are looked for.
    ///
    /// # Errors
    ///
    /// As [`Study::from_toml`].
    pub fn from_toml_in(text: &str, folder: &Path) -> Result<Self, StudyError> {
        Self::from_toml_with(text, folder, &DataOptions::default())
    }

    /// The same with given runs that a command line names.
    ///
    /// # Errors
    ///
    /// As [`Study::from_toml`].
    pub fn from_toml_with(text: &str, folder: &Path, options: &DataOptions) -> Result<Self, StudyError> {
        validate::study(text, folder, options)
    }

    /// The study as a file with every default filled in and every key explained.
    pub fn to_toml(&self) -> String {
        print::study(self)
    }

    /// The model, ready to run at points of the input space.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if constants or inputs do not fit the model; a study read from a file was checked for that.
    pub fn model(&self) -> Result<Box<dyn Model>, ModelError> {
        let uncertain: Vec<&str> = self.inputs.names().collect();
        match &self.model {
            ModelSettings::Clutch { constants } => {
                let constants: Vec<_> = constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
                Ok(Box::new(Clutch::new(&constants, &uncertain)?))
            }
            ModelSettings::Matrices(description) => Ok(Box::new(Matrices::new(description, &uncertain)?)),
            ModelSettings::Command(command) => Ok(Box::new(command.program(&uncertain))),
            ModelSettings::Table(_) => Ok(Box::new(TableModel)),
            ModelSettings::Function(function) => Ok(Box::new(function.model())),
            ModelSettings::UmBridge(server) => Ok(Box::new(server.server(&uncertain))),
        }
    }

    /// The same study with the function that its `model.kind = "function"` announces.
    ///
    /// # Errors
    ///
    /// [`ModelError::NotFunction`] if its model is of another kind.
    pub fn with_function(mut self, function: Arc<dyn Model + Send>) -> Result<Self, ModelError> {
        match &mut self.model {
            ModelSettings::Function(settings) => settings.model = Some(function),
            other => return Err(ModelError::NotFunction { kind: other.kind() }),
        }
        Ok(self)
    }

    /// Whether fits use derivatives: asked for, or left open for invariants of a model that has them.
    pub fn uses_derivatives(&self) -> bool {
        self.fit.use_derivatives(self.spectrum.target, self.has_derivatives())
    }

    /// Whether the model or given runs have derivatives.
    pub fn has_derivatives(&self) -> bool {
        self.model.has_derivatives() || self.data.as_ref().is_some_and(|data| data.runs.has_derivatives)
    }

    /// Whether it says itself how large the design may become: another number than the default.
    pub fn limits_runs(&self) -> bool {
        let (inputs, derivatives) = (self.inputs.dimension(), self.uses_derivatives());
        let default = defaults::maximum(self.spectrum.target, inputs, derivatives, &self.fit.method);
        self.design.maximum != default.max(self.design.initial)
    }

    /// Given runs that a fit takes at most: as many as the design may have, if the study says how many that is; else no
    /// more than the method fits in some seconds.
    pub fn most_given(&self) -> usize {
        match self.limits_runs() || self.fit.method.profile().is_least_squares {
            true => self.design.maximum,
            false => self.design.maximum.min(defaults::MOST_GIVEN),
        }
    }

    /// Hash of the model: its kind, its constants and the names of its inputs, not their distributions. Runs of models
    /// with the same hash at the same point have the same answer. SHA-256.
    pub fn model_hash(&self) -> [u8; 32] {
        identity::model_hash(self)
    }

    /// Hash of what is asked: model, constants, inputs and spectrum. Two studies with the same hash have the same true
    /// answer; `compare` demands that surrogate and study agree in it. Hexadecimal SHA-256.
    pub fn problem_hash(&self) -> String {
        identity::problem_hash(self)
    }

    /// Hash of the whole study with its defaults. Hexadecimal SHA-256.
    pub fn study_hash(&self) -> String {
        identity::study_hash(self)
    }
}
