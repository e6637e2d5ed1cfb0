//! What can be wrong with a study file.

use super::column::TableError;
use super::dependence::DependenceError;
use crate::mechanics::model::matrices::MatricesError;
use crate::tables::DataError;
use pcc_evaluate::probability::inputs::{DescriptionError, InputError, MarginalError};
use thiserror::Error;

/// A key of the study and its line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Dotted key, as in `inputs.k_p.lower`.
    pub key: String,
    /// Line in the file, from 1.
    pub line: usize,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "line {}: {}", self.line, self.key)
    }
}

/// Why a study cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StudyError {
    /// Not TOML, an unknown or missing key, or a value of the wrong type. The text shows the place.
    #[error("{0}")]
    Syntax(String),
    /// The file is of another format.
    #[error("{place}: is {found}, but this pcc reads format {known}; update pcc or the study")]
    Format {
        /// Where.
        place: Place,
        /// Format found.
        found: i64,
        /// Format this version reads.
        known: u32,
    },
    /// A value is out of range.
    #[error("{place}: is {found}, but must be {expected}")]
    OutOfRange {
        /// Where.
        place: Place,
        /// Value found.
        found: String,
        /// What it must be.
        expected: String,
    },
    /// Two ways to say which modes.
    #[error("{place}: spectrum.modes chooses modes, too; remove one of them")]
    TwoSelections {
        /// Where.
        place: Place,
    },
    /// A band of frequencies for modes that have ranks.
    #[error(
        "{place}: with target = \"eigenvalues\" modes are frequency ranks, which spectrum.modes lists; use that, or target = \
         \"invariants\""
    )]
    BandOfRanks {
        /// Where.
        place: Place,
    },
    /// A word that is not among the known ones.
    #[error("{place}: \"{found}\" is not known; choose {expected}")]
    UnknownWord {
        /// Where.
        place: Place,
        /// Word found.
        found: String,
        /// Words that are known.
        expected: String,
    },
    /// A setting of other models.
    #[error("{place}: belongs to models of kind {kinds}; choose that kind or remove the key")]
    KeyOfKind {
        /// Where.
        place: Place,
        /// The kinds it belongs to.
        kinds: String,
    },
    /// A setting without which the model does not work.
    #[error("line {line}: model.{key} is missing: {meaning}; add it")]
    MissingKey {
        /// Line of `model.kind`.
        line: usize,
        /// The key.
        key: &'static str,
        /// What it is.
        meaning: &'static str,
    },
    /// The name of an input or constant that is no name.
    #[error(
        "{place}: names have letters, digits and '_', start with a letter or '_', and at most {most} characters; rename it"
    )]
    Name {
        /// Where.
        place: Place,
        /// Longest name.
        most: usize,
    },
    /// A name that is a column of tables of results.
    #[error("{place}: is a column of tables of results, as are run, error, re_1, im_1 and so on; rename it")]
    ReservedName {
        /// Where.
        place: Place,
    },
    /// Something is wrong with matrices.
    #[error("{place}: {cause}")]
    Matrices {
        /// Where.
        place: Place,
        /// What.
        #[source]
        cause: Box<MatricesError>,
    },
    /// An argument that names a file beside the study, which runs in folders of their own would not find.
    #[error(
        "{place}: {argument} is a file beside the study, but runs have folders of their own; write {{study}}/{argument}"
    )]
    FileBesideStudy {
        /// Where.
        place: Place,
        /// The argument.
        argument: String,
    },
    /// Runs that may be skipped, with a method that needs every one.
    #[error(
        "{place}: quadrature needs the answer at every node, so no run can be skipped; use \"stop\" or another fit.method"
    )]
    SkippingOfQuadrature {
        /// Where.
        place: Place,
    },
    /// Elements along an input that is not uniform.
    #[error(
        "{place}: elements divide uniform and log-uniform inputs only, and this law is {law}; use one of these two laws, \
         or another fit.method"
    )]
    ElementsOfOthers {
        /// Where.
        place: Place,
        /// The input's law.
        law: &'static str,
    },
    /// Derivatives of a model that has none.
    #[error(
        "{place}: programs, servers and tables answer eigenvalues alone, so there are no derivatives; remove the key"
    )]
    NoDerivatives {
        /// Where.
        place: Place,
    },
    /// An input or constant the model does not have.
    #[error("{place}: the model has no such parameter; it has {known}")]
    UnknownParameter {
        /// Where.
        place: Place,
        /// Parameters of the model.
        known: String,
    },
    /// A setting of other methods.
    #[error("{place}: belongs to method = {methods}; choose that method or remove the key")]
    KeyOfMethod {
        /// Where.
        place: Place,
        /// The methods it belongs to.
        methods: String,
    },
    /// A kind of design that the method cannot take.
    #[error("{place}: the method does not run the model on \"{kind}\"; use \"{fitting}\" or remove the key")]
    DesignOfMethod {
        /// Where.
        place: Place,
        /// Kind found.
        kind: &'static str,
        /// The kind it takes.
        fitting: &'static str,
    },
    /// A size of a design whose size follows from the degree.
    #[error("{place}: the method takes {runs} model runs, by its degree; remove the key or change fit.max_degree")]
    FixedDesign {
        /// Where.
        place: Place,
        /// What it takes.
        runs: usize,
    },
    /// A full expansion needs more runs than the study allows.
    #[error(
        "fit.max_degree {degree} with {inputs} inputs takes {runs} model runs, more than design.maximum ({maximum}); raise the \
         maximum, lower a degree above 1, or choose least squares or a sparse method"
    )]
    TooManyRuns {
        /// Degree p.
        degree: u16,
        /// Number of inputs.
        inputs: usize,
        /// Number of model runs, of one element if there are several.
        runs: String,
        /// What is allowed.
        maximum: usize,
    },
    /// A full expansion is too large for least squares.
    #[error(
        "fit.max_degree {degree} with {inputs} inputs and {runs} model runs needs a matrix of more than two gigabytes; lower the \
         degree or fit.oversampling"
    )]
    TooLargeMatrix {
        /// Degree p.
        degree: u16,
        /// Number of inputs.
        inputs: usize,
        /// Number of model runs.
        runs: String,
    },
    /// A setting that means nothing with the value of another.
    #[error("{place}: belongs to {setting}; choose that solver or remove the key")]
    KeyOfSetting {
        /// Where.
        place: Place,
        /// The other setting with the value it belongs to.
        setting: &'static str,
    },
    /// A key that no method has.
    #[error("{place}: is no key of [fit], which are {known}")]
    UnknownFitKey {
        /// Where.
        place: Place,
        /// The keys there are.
        known: String,
    },
    /// Derivatives with quadrature.
    #[error(
        "{place}: quadrature takes values alone; use method = \"gpc\" with solver = \"least-squares\", another method, or remove \
         the key"
    )]
    DerivativesOfQuadrature {
        /// Where.
        place: Place,
    },
    /// Derivatives of eigenvalues.
    #[error(
        "{place}: eigenvalues have no bounded derivatives where they coalesce; use spectrum.target = \"invariants\" or \
         remove the key"
    )]
    DerivativesOfEigenvalues {
        /// Where.
        place: Place,
    },
    /// A parameter is both a constant and an input.
    #[error("{place}: is also an uncertain input; remove one of the two")]
    ConstantAndInput {
        /// Where.
        place: Place,
    },
    /// A distribution's parameters are unusable.
    #[error("{place}: {cause}")]
    Distribution {
        /// Where.
        place: Place,
        /// Why.
        #[source]
        cause: MarginalError,
    },
    /// A law over more orders of magnitude than an expansion follows.
    #[error(
        "{place}: values of this {law} law span {}, and expansions follow {most} at most, the digits of double \
         precision; {}",
        orders(*found),
        narrower(law)
    )]
    TooWide {
        /// Where.
        place: Place,
        /// The law.
        law: &'static str,
        /// Orders of magnitude that its values span.
        found: f64,
        /// The most.
        most: f64,
    },
    /// A table of measured values that gives none.
    #[error("{place}: {cause}")]
    Table {
        /// Where.
        place: Place,
        /// Why.
        #[source]
        cause: Box<TableError>,
    },
    /// Tables of runs that give none.
    #[error("{}{cause}", place.as_ref().map_or_else(String::new, |place| format!("{place}: ")))]
    Data {
        /// Where; nowhere in the study, if the command line names them.
        place: Option<Place>,
        /// Why.
        #[source]
        cause: Box<DataError>,
    },
    /// It is said how runs are read, but not where they are.
    #[error(
        "delimiter, decimal and holdout belong to tables of runs, and none is named; add --data FILE, or data in [model]"
    )]
    NoData,
    /// Runs at any points for a method that needs those of a rule.
    #[error(
        "{place}: fit.method = \"{method}\" runs the model at the nodes of a rule, which tables of runs do not have; choose another"
    )]
    DataOfQuadrature {
        /// Where.
        place: Place,
        /// The method.
        method: &'static str,
    },
    /// A unit or label that cannot be shown.
    #[error("{place}: {cause}")]
    Description {
        /// Where.
        place: Place,
        /// Why.
        #[source]
        cause: DescriptionError,
    },
    /// The distribution is given in neither or both of its two forms.
    #[error("{place}: give either lower and upper, or nominal and spread")]
    DistributionForm {
        /// Where.
        place: Place,
    },
    /// The design and the degree together need more memory than there is.
    #[error(
        "design.maximum ({maximum}) with {inputs} inputs and fit.max_degree {max_degree} would need more than two \
         gigabytes of polynomial values; lower one of them"
    )]
    TooLarge {
        /// Number of inputs.
        inputs: usize,
        /// Highest degree.
        max_degree: u16,
        /// Largest design.
        maximum: usize,
    },
    /// The design with derivatives has more runs than a fit can hold in memory.
    #[error("design.maximum ({maximum}) is more than a fit with derivatives can hold in memory; lower it to {most}")]
    TooLargeDesign {
        /// Largest design.
        maximum: usize,
        /// The most.
        most: usize,
    },
    /// An input has the name of a column of results.
    #[error("{place}: results have a column {name}, so that no input can have this name; choose another")]
    ResultColumn {
        /// Where.
        place: Place,
        /// The name.
        name: String,
    },
    /// The inputs cannot depend on each other like this.
    #[error("{place}: {cause}")]
    Dependence {
        /// Where.
        place: Place,
        /// Why.
        #[source]
        cause: Box<DependenceError>,
    },
    /// The inputs do not form a space.
    #[error("{place}: {cause}")]
    Inputs {
        /// Where.
        place: Place,
        /// Why.
        #[source]
        cause: InputError,
    },
}

fn orders(found: f64) -> String {
    match found.is_finite() {
        true => format!("{found:.0} orders of magnitude"),
        false => "more orders of magnitude than there are numbers".to_owned(),
    }
}

fn narrower(law: &str) -> &'static str {
    match law {
        "log-uniform" => "bring lower and upper closer together, around the values that matter",
        _ => "narrow it, or take a log-uniform law between the values that matter",
    }
}
