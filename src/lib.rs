//! How likely is a vibrating system to be stable, given what is not known about it?
//!
//! A [`Study`] names a model, its uncertain inputs and a method. [`build`] runs the model at a few dozen well-chosen
//! points and fits a sparse polynomial chaos expansion to each component: real and imaginary parts of eigenvalues, or
//! of symmetric functions of those that come close. The result is a [`Surrogate`], kept in a small versioned file.
//! [`monte_carlo`] samples it millions of times without the model; a [`Session`] answers more than that.
//! [`compare_with_model`] and [`certify_with_model`] run the model itself and say what the surrogate is worth.
//!
//! ```
//! use pcc::{Silent, Study, Surrogate, build, monte_carlo};
//!
//! let study = Study::from_toml(include_str!("../surrogates/clutch-r3-eigenvalues.toml"))?;
//! let surrogate = build(&study, &Silent)?;
//! # let folder = tempfile::tempdir()?;
//! # let file = folder.path().join("clutch.pcc");
//! surrogate.save(&file)?;
//!
//! let loaded = Surrogate::read(&file)?;
//! let stable = monte_carlo(&loaded, 100_000, 1, &Silent)?.stable_proportion();
//! let interval = stable.interval(0.95);
//! assert!(interval.lower < stable.value() && stable.value() < interval.upper);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A model of your own implements [`Model`] and goes to [`build_with`]; one that something else runs is stepped with
//! [`ask`] and [`tell`]. What is re-exported here is what users need; the crates below have the rest: `pcc-evaluate`,
//! which reads and samples surrogates and carries no model code, and `pcc-compile`, which makes them. `ARCHITECTURE.md`
//! is the map.
//!
//! Method and model: Kieu, Bergeot and Berger, *Sparse polynomial chaos expansion for stability analysis of a clutch
//! system with uncertain parameters*, 23ème Congrès Français de Mécanique, Lille 2017, called the paper throughout.

#![forbid(unsafe_code)]

#[doc(hidden)]
pub mod cli;
mod error;
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod reproduce;
mod serve;

pub use error::Error;

// Studies and models.
pub use pcc_compile::mechanics::model::command::results_table::ResultRow;
pub use pcc_compile::mechanics::model::{Concurrency, Linearization, Model, ModelAnswer, ModelError, SecondOrder};
pub use pcc_compile::study::{DataOptions, Function, FunctionAnswers, ModelSettings, Study, StudyFileError};
pub use pcc_compile::tables::Decimal;

// From a study to a surrogate, and the model's word on it.
pub use pcc_compile::ask_and_tell::{
    AskError, Step, TellError, Told, ask, ask_runs, build_from_answers, tell, tell_runs,
};
pub use pcc_compile::campaign::journal::{Contents, Journal};
pub use pcc_compile::campaign::{Books, Campaign, Failure, Ledger, Note, Recording, RunError};
pub use pcc_compile::compilation::{
    BuildError, BuiltFile, GivenUse, Uncovered, Validation, build, build_to_file, build_with,
};
pub use pcc_compile::reference::{Comparison, ReferenceError, certify_with_model, check_problem, compare_with_model};

// A surrogate and what it answers.
pub use pcc_evaluate::artifact::{Artifact, Format, ReadError, decode, encode, looks_like_a_surrogate};
pub use pcc_evaluate::components::{Label, Verdict};
pub use pcc_evaluate::evaluation::{
    Bins, Condition, EvalError, Event, GivenPoints, PointError, Question, Sampler, SurveyError, Sweep, monte_carlo,
};
pub use pcc_evaluate::foundation::{InstructionSet, Interrupted, Observer, Silent, save as save_file};
pub use pcc_evaluate::probability::inputs::Input;
pub use pcc_evaluate::probability::statistics::{Interval, Proportion};
pub use pcc_evaluate::session::{Evaluation, HistogramRequest, Request, Session, SessionError};
pub use pcc_evaluate::surrogate::{Certificate, Surrogate};

#[cfg(doctest)]
#[doc = include_str!("../docs/how-to/rust.md")]
struct DocumentExamples;
