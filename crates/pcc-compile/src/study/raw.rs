//! The study file as written: every value with its place, nothing checked but names and types.

use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::marker::PhantomData;
use toml::Spanned;

use super::error::StudyError;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Study {
    /// Read by [`format`] already.
    #[serde(rename = "format")]
    pub _format: i64,
    pub name: Spanned<String>,
    pub seed: Option<Spanned<i64>>,
    pub model: Model,
    pub inputs: Spanned<Ordered<Input>>,
    pub dependence: Option<Spanned<Dependence>>,
    #[serde(default)]
    pub spectrum: Spectrum,
    #[serde(default)]
    pub design: Design,
    #[serde(default)]
    pub fit: Ordered<FitValue>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Model {
    pub kind: Spanned<String>,
    #[serde(default)]
    pub constants: Ordered<f64>,
    #[serde(rename = "let")]
    pub helpers: Option<Spanned<Ordered<Helper>>>,
    #[serde(rename = "M")]
    pub mass: Option<Spanned<toml::Value>>,
    #[serde(rename = "C")]
    pub damping: Option<Spanned<toml::Value>>,
    #[serde(rename = "K")]
    pub stiffness: Option<Spanned<toml::Value>>,
    #[serde(rename = "G")]
    pub gyroscopic: Option<Spanned<toml::Value>>,
    #[serde(rename = "N")]
    pub circulatory: Option<Spanned<toml::Value>>,
    #[serde(rename = "A")]
    pub state: Option<Spanned<toml::Value>>,
    pub command: Option<Spanned<Command>>,
    pub shell: Option<Spanned<bool>>,
    pub mode: Option<Spanned<String>>,
    pub eigenvalues: Option<Spanned<i64>>,
    pub jobs: Option<Spanned<i64>>,
    pub timeout: Option<Spanned<f64>>,
    pub retries: Option<Spanned<i64>>,
    pub on_failure: Option<Spanned<String>>,
    pub work: Option<Spanned<String>>,
    pub keep: Option<Spanned<String>>,
    pub version: Option<Spanned<String>>,
    pub answers: Option<Spanned<String>>,
    pub data: Option<Spanned<Files>>,
    pub delimiter: Option<Spanned<String>>,
    pub decimal: Option<Spanned<String>>,
    pub holdout: Option<Spanned<f64>>,
    pub url: Option<Spanned<String>>,
    pub name: Option<Spanned<String>>,
    pub config: Option<Spanned<toml::Table>>,
    pub parameters: Option<Spanned<Vec<String>>>,
}

impl Model {
    /// The keys that only some kinds have, as far as they are given, with the bytes where their values start.
    pub fn given(&self) -> Vec<(&'static str, usize)> {
        fn start<T>(value: &Option<Spanned<T>>) -> Option<usize> {
            value.as_ref().map(|value| value.span().start)
        }
        let keys = [
            ("let", start(&self.helpers)),
            ("M", start(&self.mass)),
            ("C", start(&self.damping)),
            ("K", start(&self.stiffness)),
            ("G", start(&self.gyroscopic)),
            ("N", start(&self.circulatory)),
            ("A", start(&self.state)),
            ("command", start(&self.command)),
            ("shell", start(&self.shell)),
            ("mode", start(&self.mode)),
            ("jobs", start(&self.jobs)),
            ("timeout", start(&self.timeout)),
            ("retries", start(&self.retries)),
            ("work", start(&self.work)),
            ("keep", start(&self.keep)),
            ("eigenvalues", start(&self.eigenvalues)),
            ("on_failure", start(&self.on_failure)),
            ("version", start(&self.version)),
            ("answers", start(&self.answers)),
            ("url", start(&self.url)),
            ("name", start(&self.name)),
            ("config", start(&self.config)),
            ("parameters", start(&self.parameters)),
        ];
        keys.into_iter().filter_map(|(key, start)| Some((key, start?))).collect()
    }
}

/// A program and its arguments, or a line for the shell.
#[derive(Debug, Clone, Deserialize)]
#[serde(
    untagged,
    expecting = "write the program and its arguments as a list, like [\"python3\", \"{study}/model.py\"]"
)]
pub(super) enum Command {
    Line(String),
    Arguments(Vec<String>),
}

/// One file, or several.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "write the name of a file, like \"runs.csv\", or a list of names")]
pub(super) enum Files {
    One(String),
    Several(Vec<String>),
}

/// The value of a helper.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "a helper must be an expression in quotes, like \"k_p / 4\"")]
pub(super) enum Helper {
    Number(f64),
    Expression(String),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Input {
    pub distribution: Spanned<String>,
    pub lower: Option<f64>,
    pub upper: Option<f64>,
    pub nominal: Option<f64>,
    pub spread: Option<Spanned<Relative>>,
    pub mean: Option<f64>,
    pub std: Option<f64>,
    pub cv: Option<Spanned<Relative>>,
    pub median: Option<f64>,
    pub shape: Option<f64>,
    pub scale: Option<f64>,
    pub location: Option<f64>,
    pub alpha: Option<f64>,
    pub beta: Option<f64>,
    pub mode: Option<f64>,
    pub values: Option<Vec<f64>>,
    pub weights: Option<Vec<f64>>,
    pub file: Option<Spanned<String>>,
    pub column: Option<String>,
    pub smoothing: Option<Spanned<String>>,
    pub polynomials: Option<Spanned<String>>,
    pub unit: Option<Spanned<String>>,
    pub label: Option<Spanned<String>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Dependence {
    pub kind: Spanned<String>,
    pub spearman: Option<Spanned<Vec<Spanned<Pair>>>>,
    pub pearson: Option<Spanned<Vec<Spanned<Pair>>>>,
}

/// Two inputs and their correlation.
#[derive(Debug)]
pub(super) struct Pair(pub String, pub String, pub f64);

/// Written out, because what is derived reads over entries after the third.
impl<'de> Deserialize<'de> for Pair {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries;
        impl<'de> Visitor<'de> for Entries {
            type Value = Pair;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("two inputs and their correlation, like [\"k\", \"c\", 0.6]")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Pair, A::Error> {
                let short = |found| A::Error::invalid_length(found, &self);
                let one = entries.next_element()?.ok_or_else(|| short(0))?;
                let other = entries.next_element()?.ok_or_else(|| short(1))?;
                let value = entries.next_element()?.ok_or_else(|| short(2))?;
                let mut found = 3;
                while entries.next_element::<IgnoredAny>()?.is_some() {
                    found += 1;
                }
                if found > 3 { Err(A::Error::invalid_length(found, &self)) } else { Ok(Pair(one, other, value)) }
            }
        }
        deserializer.deserialize_seq(Entries)
    }
}

/// A quantity relative to another: a number, or a text in percent.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected a number like 0.1, or a text in percent like \"10%\"")]
pub(super) enum Relative {
    Number(f64),
    Text(String),
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spectrum {
    pub target: Option<Spanned<String>>,
    pub modes: Option<Spanned<Modes>>,
    pub frequencies: Option<Spanned<Vec<f64>>>,
    pub rigid_body_modes: Option<Spanned<i64>>,
    pub margin: Option<Spanned<Margin>>,
    pub noise: Option<Spanned<f64>>,
}

#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "a margin is a growth rate in 1/s, or { damping_ratio = 0.005 }, or { log_decrement = 0.03 }, one of them"
)]
pub(super) enum Margin {
    GrowthRate(f64),
    DampingRatio(DampingRatio),
    LogDecrement(LogDecrement),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DampingRatio {
    pub damping_ratio: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LogDecrement {
    pub log_decrement: f64,
}

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "modes must be \"all\" or a list of mode numbers like [3, 4]")]
pub(super) enum Modes {
    Word(String),
    Ranks(Vec<i64>),
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Design {
    pub kind: Option<Spanned<String>>,
    pub initial: Option<Spanned<i64>>,
    pub step: Option<Spanned<i64>>,
    pub maximum: Option<Spanned<i64>>,
}

/// The keys of `[fit]` that go with every method, read once more for their types alone: then the parser's excerpt says
/// where a value is none.
#[derive(Debug, Deserialize)]
struct OfEveryMethod {
    #[serde(rename = "fit")]
    _fit: Option<EveryMethod>,
}

#[derive(Debug, Deserialize)]
struct EveryMethod {
    #[serde(rename = "method")]
    _method: Option<String>,
    #[serde(rename = "proportion_tolerance")]
    _proportion_tolerance: Option<f64>,
    #[serde(rename = "enrich")]
    _enrich: Option<String>,
    #[serde(rename = "shares")]
    _shares: Option<Vec<String>>,
    #[serde(rename = "derivatives")]
    _derivatives: Option<Derivatives>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "derivatives must be \"auto\", true or false")]
enum Derivatives {
    Flag(#[expect(dead_code, reason = "only its type is read")] bool),
    Word(#[expect(dead_code, reason = "only its type is read")] String),
}

/// A value of `[fit]`, whose other keys are those of the methods.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected a number, a text in quotes, true or false")]
pub(super) enum FitValue {
    Flag(bool),
    Whole(i64),
    Number(f64),
    Text(String),
    Texts(Vec<String>),
}

impl fmt::Display for FitValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(value) => write!(f, "{value}"),
            Self::Whole(value) => write!(f, "{value}"),
            Self::Number(value) => write!(f, "{value:?}"),
            Self::Text(value) => write!(f, "{value:?}"),
            Self::Texts(values) => write!(f, "{values:?}"),
        }
    }
}

/// A table whose order matters: the order of inputs is the order of the standardized variables.
#[derive(Debug)]
pub(super) struct Ordered<T>(pub Vec<(String, Spanned<T>)>);

impl<T> Default for Ordered<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Ordered<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = Ordered<T>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a table")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Ordered(entries))
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

/// The format decides how the rest is read, so it is read first.
#[derive(Debug, Deserialize)]
pub(super) struct Versioned {
    pub format: Option<Spanned<i64>>,
}

pub(super) fn format(text: &str) -> Result<Versioned, StudyError> {
    toml::from_str(text).map_err(syntax)
}

pub(super) fn parse(text: &str) -> Result<Study, StudyError> {
    let study = toml::from_str(text).map_err(syntax)?;
    toml::from_str::<OfEveryMethod>(text).map_err(syntax)?;
    Ok(study)
}

/// The parser's message with its excerpt of the file, in words of the file instead of words of the program.
fn syntax(error: toml::de::Error) -> StudyError {
    const WORDS: [(&str, &str); 11] = [
        ("missing field", "missing key"),
        ("unknown field", "unknown key"),
        ("expected i64", "expected a whole number"),
        ("expected f64", "expected a number"),
        ("expected struct Input", "expected a table like { distribution = \"uniform\", lower = 0.0, upper = 1.0 }"),
        ("expected struct", "expected a table"),
        ("expected a sequence", "expected a list"),
        ("expected a map", "expected a table"),
        ("expected a string", "expected a text in quotes"),
        ("floating point", "number"),
        (" as i128", ""),
    ];
    let mut message = WORDS.iter().fold(error.to_string(), |text, (theirs, ours)| text.replace(theirs, ours));
    message.truncate(message.trim_end().len());
    if message.contains("missing key") {
        message.push_str("; add it");
    }
    StudyError::Syntax(message)
}
