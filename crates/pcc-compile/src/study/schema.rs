//! The JSON schema of study files, for editors that complete and explain keys.
//!
//! The types here say what the reader's types ([`raw`](super::raw)) cannot: which words and ranges there are, and what
//! each key means. A test of the tools holds the two together: keys that the reader knows, and no others.

#![allow(dead_code, reason = "a schema is made of these types; no value is")]

mod inputs;

use super::settings::NAMED_SHARES;
use crate::fitting::fit::method::{Domain, METHODS};
use inputs::{Dependence, Input};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The schema as text, the content of `schemas/study.v1.schema.json`.
pub fn schema() -> String {
    let mut schema = schemars::schema_for!(Study).to_value();
    remove_null(&mut schema);
    format!("{schema:#}\n")
}

/// TOML has no null: a key that may be absent is absent.
fn remove_null(schema: &mut Value) {
    match schema {
        Value::Array(values) => {
            values.retain(|value| *value != json!("null") && *value != json!({"type": "null"}));
            values.iter_mut().for_each(remove_null);
        }
        Value::Object(values) => values.values_mut().for_each(remove_null),
        _ => {}
    }
}

/// A study of pcc: a model, its uncertain inputs, what of its spectrum is asked, and how a surrogate is fitted.
#[derive(JsonSchema)]
#[schemars(title = "pcc study, format 1", deny_unknown_fields)]
struct Study {
    /// The version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    format: i64,
    /// Name of the study. It also names the files that are built from it: letters, digits, `-`, `_` and `.`.
    name: String,
    /// Seed of the design. Default 1.
    #[schemars(range(min = 0))]
    seed: Option<i64>,
    /// The model that is run.
    model: Model,
    /// The uncertain parameters, independent of each other but for `dependence`. Their order is that of the
    /// standardized variables.
    #[schemars(length(min = 1))]
    inputs: BTreeMap<String, Input>,
    /// Which inputs depend on each other. Default: none.
    dependence: Option<Dependence>,
    /// What of the spectrum is expanded, and what stable means.
    spectrum: Option<Spectrum>,
    /// Where the model is run.
    design: Option<Design>,
    /// How the surrogate is fitted.
    fit: Option<Fit>,
}

/// The model. Which keys it has depends on its kind.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct Model {
    /// What computes the eigenvalues.
    kind: Kind,
    /// Constants by name: of the clutch those that differ from the nominal values, else what expressions and programs
    /// are given beside the inputs.
    constants: Option<BTreeMap<String, f64>>,
    /// Matrices: names for expressions of inputs, constants and helpers that stand before.
    #[schemars(rename = "let")]
    helpers: Option<BTreeMap<String, String>>,
    /// Matrices: mass.
    #[schemars(rename = "M")]
    mass: Option<Matrix>,
    /// Matrices: damping, added to the gyroscopic matrix.
    #[schemars(rename = "C")]
    damping: Option<Matrix>,
    /// Matrices: stiffness.
    #[schemars(rename = "K")]
    stiffness: Option<Matrix>,
    /// Matrices: gyroscopic, added to damping.
    #[schemars(rename = "G")]
    gyroscopic: Option<Matrix>,
    /// Matrices: circulatory, added to stiffness.
    #[schemars(rename = "N")]
    circulatory: Option<Matrix>,
    /// Matrices: the state matrix of a first-order system ẋ = A x, alone.
    #[schemars(rename = "A")]
    state: Option<Matrix>,
    /// Command: the program and its arguments; with `shell = true` one line for the shell. `{study}` is the folder of
    /// the study, `{work}` that of the run.
    command: Option<CommandLine>,
    /// Command: whether `command` is a line for `sh -c`. Default false.
    shell: Option<bool>,
    /// Command: how many runs a process makes.
    mode: Option<Mode>,
    /// Command, table and um-bridge: number of eigenvalues that each run answers. A table of runs has it, too.
    #[schemars(range(min = 1))]
    eigenvalues: Option<i64>,
    /// Command and um-bridge: processes or requests at once. Default 1.
    #[schemars(range(min = 1))]
    jobs: Option<i64>,
    /// Command and um-bridge: time after which a process is stopped, or a request given up, in s. Default: none.
    #[schemars(extend("exclusiveMinimum" = 0))]
    timeout: Option<f64>,
    /// Command and um-bridge: further attempts at a run that failed. Default 0.
    #[schemars(range(min = 0))]
    retries: Option<i64>,
    /// Function: what it answers. Default "matrices".
    answers: Option<FunctionAnswers>,
    /// Command, table, function and um-bridge: what becomes of runs that fail.
    on_failure: Option<OnFailure>,
    /// Command: folder for the folders of runs, in the current one. Default "runs".
    work: Option<String>,
    /// Command: which folders of runs are kept.
    keep: Option<Keep>,
    /// Command, table, function and um-bridge: change it when the model answers otherwise; earlier runs then no longer
    /// count.
    version: Option<String>,
    /// Tables of runs that have been made already, beside the study.
    data: Option<Files>,
    /// What separates their columns: comma, semicolon, tab, space, bar or the character. Default: semicolons or tabs if
    /// the first line has some, else commas.
    delimiter: Option<String>,
    /// What their numbers have for a decimal point. Default "point".
    decimal: Option<Decimal>,
    /// Share of these runs that no fit sees: they validate the surrogate. Default 0.
    #[schemars(range(min = 0.0, max = 0.9))]
    holdout: Option<f64>,
    /// Um-bridge: where the server is, like "http://localhost:4242".
    url: Option<String>,
    /// Um-bridge: name of the model, as the server lists it.
    name: Option<String>,
    /// Um-bridge: handed on with every request. Default: empty.
    config: Option<BTreeMap<String, Value>>,
    /// Um-bridge: names of inputs and constants in the order in which the model takes them. Default: the inputs in
    /// their order.
    parameters: Option<Vec<String>>,
}

#[derive(JsonSchema)]
#[schemars(untagged)]
enum Files {
    /// One file.
    One(String),
    /// Several, whose runs are put together.
    Several(Vec<String>),
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum Decimal {
    /// 0.25
    Point,
    /// 0,25
    Comma,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum Kind {
    /// The clutch of the paper, built in.
    Clutch,
    /// Matrices that are written here or read from files: derivatives, so fewest runs.
    Matrices,
    /// A program that computes eigenvalues.
    Command,
    /// Runs that have been made already, and answers that something else computes, exchanged as tables by `pcc design`
    /// and `pcc ingest`.
    Table,
    /// A function of the program that reads the study, in Python.
    Function,
    /// A model on a server that speaks UM-Bridge.
    UmBridge,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum FunctionAnswers {
    /// M, C and K of M Ü + C U̇ + K U = 0, or A of ẋ = A x.
    Matrices,
    /// All eigenvalues.
    Eigenvalues,
}

#[derive(JsonSchema)]
#[schemars(untagged)]
enum CommandLine {
    /// A line for the shell.
    Line(String),
    /// The program and its arguments.
    Arguments(Vec<String>),
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum Mode {
    /// A process for each run: params.json in, results.json out. Default.
    Each,
    /// A process for all runs of a level: points.csv in, results.csv out.
    Batch,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum OnFailure {
    /// The build ends. Default.
    Stop,
    /// The run is left out and reported.
    Skip,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum Keep {
    /// Those of runs that failed. Default.
    Failed,
    /// All.
    Always,
    /// None.
    Never,
}

#[derive(JsonSchema)]
#[schemars(untagged)]
enum Matrix {
    /// Rows of entries.
    Rows(Vec<Vec<Entry>>),
    /// One matrix.
    Term(Term),
    /// Matrices that are added up.
    Sum(Vec<Term>),
}

/// A matrix in one of four layouts: rows, diagonal, entries or file.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct Term {
    /// Rows of entries; with `form` the lower triangle.
    rows: Option<Vec<Vec<Entry>>>,
    /// The diagonal.
    diagonal: Option<Vec<Entry>>,
    /// Row, column (from 1) and value of each entry; the rest is zero.
    entries: Option<Vec<(u32, u32, Entry)>>,
    /// A Matrix Market file, in the folder of the study.
    file: Option<String>,
    /// Number of rows, beside `entries`.
    #[schemars(range(min = 1))]
    size: Option<i64>,
    /// What mirrors the entries below the diagonal.
    form: Option<Form>,
    /// Multiplies all entries.
    factor: Option<Entry>,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum Form {
    /// As it is written.
    General,
    /// The same above the diagonal.
    Symmetric,
    /// The negative above the diagonal, which is zero.
    SkewSymmetric,
}

#[derive(JsonSchema)]
#[schemars(untagged)]
enum Entry {
    /// A number.
    Number(f64),
    /// An expression of inputs, constants and helpers.
    Expression(String),
}

/// What of the spectrum is expanded, and what stable means.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct Spectrum {
    /// What is expanded. Default "invariants", but of the clutch "eigenvalues".
    target: Option<Target>,
    /// Every eigenvalue (default), or some modes. A mode that is not listed is not looked at.
    modes: Option<Modes>,
    /// In place of `modes`: those with such a frequency in the middle of the inputs, from and to, in Hz.
    #[schemars(length(min = 2, max = 2))]
    frequencies: Option<Vec<f64>>,
    /// Eigenvalues that are zero because the body is free to move. Default: found by structure.
    #[schemars(range(min = 0))]
    rigid_body_modes: Option<i64>,
    /// Stable means to decay faster than this. Default 0.
    margin: Option<Margin>,
    /// Relative error of the model's eigenvalues, where it is known. Default 0.
    #[schemars(range(min = 0.0))]
    noise: Option<f64>,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum Target {
    /// Symmetric functions of modes that come close.
    Invariants,
    /// Re λ and Im λ of each mode, as in the paper.
    Eigenvalues,
}

#[derive(JsonSchema)]
#[schemars(untagged)]
enum Modes {
    /// Every eigenvalue.
    All(All),
    /// Numbers of modes, from 1, by frequency.
    Numbers(Vec<u32>),
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum All {
    /// Every eigenvalue.
    All,
}

#[derive(JsonSchema)]
#[schemars(untagged)]
enum Margin {
    /// A growth rate in 1/s.
    GrowthRate(f64),
    /// A damping ratio of each eigenvalue.
    DampingRatio(DampingRatio),
    /// A logarithmic decrement of each eigenvalue.
    LogDecrement(LogDecrement),
}

#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct DampingRatio {
    /// ζ, like 0.005.
    damping_ratio: f64,
}

#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct LogDecrement {
    /// δ, like 0.03.
    log_decrement: f64,
}

/// Where the model is run. Defaults depend on the number of inputs and on the method.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct Design {
    /// How points are chosen.
    kind: Option<DesignKind>,
    /// Model runs of the first level.
    #[schemars(range(min = 2))]
    initial: Option<i64>,
    /// Model runs that are added by each enrichment.
    #[schemars(range(min = 1))]
    step: Option<i64>,
    /// Model runs that are never exceeded.
    #[schemars(range(min = 1))]
    maximum: Option<i64>,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum DesignKind {
    /// Levels of Latin hypercubes, each containing the one before.
    NestedLhs,
    /// The same with points spread apart. Default for invariants.
    NestedMaximinLhs,
    /// The nodes of a tensor Gauss rule, for quadrature.
    TensorGauss,
}

/// The fit: its keys are those of the methods.
struct Fit;

/// What the keys of methods mean.
const MEANINGS: [(&str, &str); 11] = [
    ("max_degree", "Highest degree: in each input for minimum-norm, in all for the other methods."),
    ("s2_target", "Leave-one-out S² that is accurate enough. Default 0.999."),
    ("q_norm", "q of the hyperbolic index sets, the paper's m-norm. Default 0.6."),
    ("epsilon_forward", "ε₁: a term is kept if it raises R² by this much. Default 1e-5."),
    ("epsilon_backward", "ε₂: a term is dropped if that lowers R² by less. Default 1e-5."),
    ("solver", "How coefficients of a full expansion are found. Default \"quadrature\"."),
    ("oversampling", "Equations per term of a least-squares fit. Default 2."),
    ("theta_1", "θ₁: elements with η^γ × probability from here on are divided. Default 0.01."),
    ("theta_2", "θ₂: along inputs with this part of the largest share of the highest order. Default 0.5."),
    ("gamma", "γ. Default 0.5."),
    ("elements", "Elements at most. Default 100."),
];

impl JsonSchema for Fit {
    fn schema_name() -> Cow<'static, str> {
        "Fit".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names: Vec<&str> = METHODS.iter().map(|method| method.name).collect();
        let mut properties = Map::new();
        let method = "Fitting method. Default \"auto\" for invariants, \"stepwise\" for eigenvalues.";
        properties.insert("method".into(), json!({"description": method, "enum": names}));
        let derivatives = "Whether derivatives enter the fit: \"auto\", where the model has them and the target is \
                           invariants (default), true or false.";
        properties.insert("derivatives".into(), json!({"description": derivatives, "enum": ["auto", true, false]}));
        let tolerance =
            "Estimated error of the share p of stable cases that is small enough, as a fraction of √(p (1 − p)).";
        properties.insert(
            "proportion_tolerance".into(),
            json!({"description": tolerance, "type": "number", "minimum": 1e-5, "maximum": 1}),
        );
        let enrich = "Where runs are made beside those of the design: near the boundary of stability, where the rarer side \
                      is rare or not seen (\"decision\", default), or nowhere.";
        properties.insert("enrich".into(), json!({"description": enrich, "enum": ["decision", "none"]}));
        let shares =
            "Further shares that the tolerance is of, beside those of stable and unstable cases. Default none.";
        let names = NAMED_SHARES.map(|verdict| verdict.name());
        properties.insert("shares".into(), json!({"description": shares, "type": "array", "items": {"enum": names}}));
        for entry in &METHODS {
            for key in entry.keys {
                let of: Vec<&str> =
                    METHODS.iter().filter(|method| has(method.keys, key.name)).map(|m| m.name).collect();
                let meaning = MEANINGS.iter().find(|(name, _)| *name == key.name).map_or("", |(_, meaning)| meaning);
                let mut property = values(&key.domain);
                property["description"] = Value::from(format!("{meaning} Of: {}.", of.join(", ")).trim_start());
                properties.insert(key.name.into(), property);
            }
        }
        json_schema!({
            "type": "object",
            "description": "How the surrogate is fitted. Which keys there are depends on the method.",
            "properties": properties,
            "additionalProperties": false
        })
    }
}

fn has(keys: &[&crate::fitting::fit::method::Key], name: &str) -> bool {
    keys.iter().any(|key| key.name == name)
}

/// What a key may be.
fn values(domain: &Domain) -> Value {
    match domain {
        Domain::Whole { least, most } => json!({"type": "integer", "minimum": least, "maximum": most}),
        Domain::Number { .. } => json!({"type": "number"}),
        Domain::Word(words) => json!({"enum": words}),
    }
}
