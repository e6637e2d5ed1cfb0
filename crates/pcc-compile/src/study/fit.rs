//! The fit of a study: which method, the settings that belong to it, and what goes with every method.

use toml::Spanned;

use super::defaults;
use super::error::StudyError;
use super::raw::{FitValue, Ordered};
use super::settings::{Derivatives, Enrich, FitSettings, NAMED_SHARES};
use super::validate::{Lines, alternatives};
use crate::fitting::fit::FitMethod;
use crate::fitting::fit::method::{Design, Domain, Entry, Given, Key, METHODS, Value};
use crate::mechanics::spectrum::Target;
use pcc_evaluate::components::Verdict;

/// Entries of the matrix of a least-squares fit: two gigabytes.
const LARGEST_MATRIX: f64 = 2.5e8;

/// Keys that go with every method.
const METHOD: &str = "method";
const DERIVATIVES: &str = "derivatives";
const TOLERANCE: &str = "proportion_tolerance";
const ENRICH: &str = "enrich";
const SHARES: &str = "shares";
const OF_EVERY_METHOD: [&str; 5] = [METHOD, DERIVATIVES, TOLERANCE, ENRICH, SHARES];

impl Lines<'_> {
    pub(super) fn fit(
        &self,
        Ordered(raw): Ordered<FitValue>,
        target: Target,
        inputs: usize,
        has_derivatives: bool,
    ) -> Result<FitSettings, StudyError> {
        let find = |name: &str| raw.iter().find(|(key, _)| key == name).map(|(_, value)| value);
        let entry = self.method(find(METHOD), target)?;
        let derivatives_place = find(DERIVATIVES).map(|value| self.place("fit.derivatives", value));
        let derivatives = match find(DERIVATIVES) {
            Some(value) => self.derivatives(value, target)?,
            None => Derivatives::Auto,
        };
        let proportion_tolerance = match find(TOLERANCE) {
            Some(value) => Some(self.tolerance(value, entry)?),
            None => (target == Target::Invariants && entry.grows).then(|| {
                let with_derivatives = derivatives.are_used(target, has_derivatives);
                defaults::proportion_tolerance(with_derivatives, entry.name)
            }),
        };
        let enrich = find(ENRICH).map_or(Ok(Enrich::default()), |value| self.enrich(value, entry))?;
        let shares = find(SHARES).map_or(Ok(Vec::new()), |value| self.shares(value, entry))?;
        let settings = raw.iter().filter(|(key, _)| !OF_EVERY_METHOD.contains(&key.as_str()));
        let method = self.settings(entry, settings, inputs)?;
        match derivatives_place {
            Some(place) if derivatives == Derivatives::Always && !has_derivatives => {
                Err(StudyError::NoDerivatives { place })
            }
            Some(place) if derivatives == Derivatives::Always && !method.can_use_derivatives() => {
                Err(StudyError::DerivativesOfQuadrature { place })
            }
            // Values alone, whatever is asked for.
            _ if !method.can_use_derivatives() => {
                Ok(FitSettings { method, proportion_tolerance, derivatives: Derivatives::Auto, enrich, shares })
            }
            _ => Ok(FitSettings { method, proportion_tolerance, derivatives, enrich, shares }),
        }
    }

    /// The paper's own method for eigenvalues, the better of two for invariants, unless the study names one.
    fn method(&self, value: Option<&Spanned<FitValue>>, target: Target) -> Result<&'static Entry, StudyError> {
        let default = if target == Target::Invariants { "auto" } else { "stepwise" };
        let word = match value {
            None => default,
            Some(value) => match value.get_ref() {
                FitValue::Text(word) => word,
                _ => return Err(self.wrong_value("fit.method", value, "the name of a method in quotes".to_owned())),
            },
        };
        METHODS.iter().find(|entry| entry.name == word).ok_or_else(|| {
            let names: Vec<String> = METHODS.iter().map(|entry| format!("{:?}", entry.name)).collect();
            let place = value.map_or_else(|| self.nowhere("fit.method"), |value| self.place("fit.method", value));
            StudyError::UnknownWord { place, found: word.to_owned(), expected: alternatives(&names) }
        })
    }

    fn tolerance(&self, value: &Spanned<FitValue>, entry: &Entry) -> Result<f64, StudyError> {
        const KEY: Key = Key {
            name: TOLERANCE,
            domain: Domain::Number {
                expected: "a number from 1e-5 to 1",
                holds: |value| (1e-5..=1.0).contains(&value),
            },
        };
        if !entry.grows {
            return Err(self.key_of_method(&KEY, value, |entry| entry.grows));
        }
        match self.within(&KEY, value)? {
            Value::Number(tolerance) => Ok(tolerance),
            _ => Err(self.wrong_value("fit.proportion_tolerance", value, "a number".to_owned())),
        }
    }

    fn enrich(&self, value: &Spanned<FitValue>, entry: &Entry) -> Result<Enrich, StudyError> {
        const WORDS: [Enrich; 2] = [Enrich::Decision, Enrich::None];
        const KEY: Key = Key { name: ENRICH, domain: Domain::Word(&["decision", "none"]) };
        if !entry.grows {
            return Err(self.key_of_method(&KEY, value, |entry| entry.grows));
        }
        let word = self.within(&KEY, value)?;
        let named = |enrich: &Enrich| matches!(&word, Value::Word(word) if word == enrich.name());
        Ok(WORDS.into_iter().find(named).unwrap_or_default())
    }

    fn shares(&self, value: &Spanned<FitValue>, entry: &Entry) -> Result<Vec<Verdict>, StudyError> {
        let words: Vec<&str> = NAMED_SHARES.into_iter().map(Verdict::name).collect();
        let expected = alternatives(&words.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>());
        if !entry.grows {
            const KEY: Key = Key { name: SHARES, domain: Domain::Word(&[]) };
            return Err(self.key_of_method(&KEY, value, |entry| entry.grows));
        }
        let FitValue::Texts(names) = value.get_ref() else {
            return Err(self.wrong_value("fit.shares", value, format!("a list of {expected}, like [\"divergence\"]")));
        };
        match names.iter().find(|name| !words.contains(&name.as_str())) {
            Some(name) => Err(StudyError::UnknownWord {
                place: self.place("fit.shares", value),
                found: name.clone(),
                expected: format!("{expected}; stable and unstable always count"),
            }),
            None => {
                Ok(NAMED_SHARES.into_iter().filter(|verdict| names.iter().any(|name| name == verdict.name())).collect())
            }
        }
    }

    fn derivatives(&self, value: &Spanned<FitValue>, target: Target) -> Result<Derivatives, StudyError> {
        match value.get_ref() {
            FitValue::Flag(true) if target == Target::Eigenvalues => {
                Err(StudyError::DerivativesOfEigenvalues { place: self.place("fit.derivatives", value) })
            }
            FitValue::Flag(true) => Ok(Derivatives::Always),
            FitValue::Flag(false) => Ok(Derivatives::Never),
            FitValue::Text(word) if word == "auto" => Ok(Derivatives::Auto),
            _ => Err(self.wrong_value("fit.derivatives", value, "\"auto\", true or false".to_owned())),
        }
    }

    /// The method with its settings: every key that is given belongs to it, every value to its key.
    fn settings<'k>(
        &self,
        entry: &Entry,
        raw: impl Iterator<Item = &'k (String, Spanned<FitValue>)> + Clone,
        inputs: usize,
    ) -> Result<FitMethod, StudyError> {
        let mut given = Given::default();
        for (name, value) in raw.clone() {
            let Some(key) = METHODS.iter().flat_map(|entry| entry.keys).find(|key| key.name == name) else {
                return Err(self.unknown_key(name, value));
            };
            if !entry.keys.iter().any(|own| own.name == key.name) {
                return Err(self.key_of_method(key, value, |entry| entry.keys.iter().any(|own| own.name == key.name)));
            }
            given.0.push((key.name, self.within(key, value)?));
        }
        (entry.read)(&given, inputs).map_err(|meaningless| {
            let value = raw.clone().find(|(name, _)| name == meaningless.key).map(|(_, value)| value);
            let key = format!("fit.{}", meaningless.key);
            let place = value.map_or_else(|| self.nowhere(&key), |value| self.place(key.clone(), value));
            StudyError::KeyOfSetting { place, setting: meaningless.belongs_to }
        })
    }

    /// The value, if the key may have it.
    fn within(&self, key: &Key, value: &Spanned<FitValue>) -> Result<Value, StudyError> {
        let full = format!("fit.{}", key.name);
        match (key.domain, value.get_ref()) {
            (Domain::Whole { least, most }, FitValue::Whole(number)) if (least..=most).contains(number) => {
                Ok(Value::Whole(*number))
            }
            (Domain::Whole { least, most }, _) => {
                Err(self.wrong_value(&full, value, format!("a whole number from {least} to {most}")))
            }
            (Domain::Number { holds, .. }, FitValue::Number(number)) if holds(*number) => Ok(Value::Number(*number)),
            (Domain::Number { holds, .. }, FitValue::Whole(number)) if holds(*number as f64) => {
                Ok(Value::Number(*number as f64))
            }
            (Domain::Number { expected, .. }, FitValue::Whole(number)) => {
                let found = format!("{:?}", *number as f64);
                Err(StudyError::OutOfRange { place: self.place(full, value), found, expected: expected.to_owned() })
            }
            (Domain::Number { expected, .. }, _) => Err(self.wrong_value(&full, value, expected.to_owned())),
            (Domain::Word(words), FitValue::Text(word)) if words.contains(&word.as_str()) => {
                Ok(Value::Word(word.clone()))
            }
            (Domain::Word(words), found) => {
                let names: Vec<String> = words.iter().map(|word| format!("{word:?}")).collect();
                match found {
                    FitValue::Text(word) => Err(StudyError::UnknownWord {
                        place: self.place(full, value),
                        found: word.clone(),
                        expected: alternatives(&names),
                    }),
                    _ => Err(self.wrong_value(&full, value, alternatives(&names))),
                }
            }
        }
    }

    fn wrong_value(&self, key: &str, value: &Spanned<FitValue>, expected: String) -> StudyError {
        StudyError::OutOfRange { place: self.place(key, value), found: value.get_ref().to_string(), expected }
    }

    fn key_of_method(&self, key: &Key, value: &Spanned<FitValue>, has: impl Fn(&Entry) -> bool) -> StudyError {
        let names = METHODS.iter().filter(|entry| has(entry)).map(|entry| format!("{:?}", entry.name));
        let place = self.place(format!("fit.{}", key.name), value);
        StudyError::KeyOfMethod { place, methods: names.collect::<Vec<_>>().join(", ") }
    }

    fn unknown_key(&self, name: &str, value: &Spanned<FitValue>) -> StudyError {
        let mut known = OF_EVERY_METHOD.to_vec();
        for key in METHODS.iter().flat_map(|entry| entry.keys) {
            if !known.contains(&key.name) {
                known.push(key.name);
            }
        }
        StudyError::UnknownFitKey {
            place: self.place(format!("fit.{}", name.escape_debug()), value),
            known: known.join(", "),
        }
    }

    /// The number of model runs that a method without a growing design takes, of one element for several; `None` for
    /// the others.
    pub(super) fn fixed_runs(
        &self,
        fit: &FitSettings,
        inputs: usize,
        derivatives: bool,
        maximum: usize,
    ) -> Result<Option<usize>, StudyError> {
        let degree = fit.method.max_degree();
        let equations_per_run = if derivatives { 1 + inputs } else { 1 };
        let runs = match fit.method.profile().design {
            Design::Oversampled(oversampling) => {
                (oversampling * terms(inputs, degree) / equations_per_run as f64).ceil().max(2.0)
            }
            Design::Quadrature | Design::QuadraturePerElement => f64::from(degree + 1).powi(inputs as i32),
            Design::Growing => return Ok(None),
        };
        if runs > maximum as f64 {
            return Err(StudyError::TooManyRuns { degree, inputs, runs: whole(runs), maximum });
        }
        let numbers = runs * equations_per_run as f64 * terms(inputs, degree);
        if !fit.method.is_quadrature() && numbers > LARGEST_MATRIX {
            return Err(StudyError::TooLargeMatrix { degree, inputs, runs: whole(runs) });
        }
        Ok(Some(runs as usize))
    }
}

/// A number of runs: exact as far as it can be counted, else its magnitude.
fn whole(runs: f64) -> String {
    if runs < 1e15 { format!("{runs}") } else { format!("{runs:.1e}") }
}

/// (r + p)!/(r! p!), equation 6 of the paper, exact below 2⁵³.
fn terms(inputs: usize, degree: u16) -> f64 {
    (1..=inputs).fold(1.0, |terms, j| terms * (f64::from(degree) + j as f64) / j as f64).round()
}
