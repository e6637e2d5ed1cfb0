//! The list of fitting methods, and what each of them says of itself.
//!
//! Every method is a file beside this one. It names itself and its settings with their ranges and defaults ([`Entry`]),
//! says what a build must know of it ([`Profile`]), and fits one component on one design ([`Solver`]). Studies are
//! read, printed and hashed from that, so a new method is its file, a variant of [`FitMethod`] and a line of
//! [`METHODS`].

use super::{Fitted, auto, gpc, minimum_norm, multi_element, omp, stepwise};
use crate::fitting::regression::{BasisTables, Response};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::polynomials::IndexSetError;

/// Degrees above this are of no use for functions that a design can resolve.
const HIGHEST_DEGREE: i64 = 100;

/// The paper's highest degree, and its target of accuracy.
pub(super) const DEFAULT_DEGREE: u16 = 15;
pub(super) const DEFAULT_S2: f64 = 0.999;

/// Values that a key may have.
#[derive(Debug, Clone, Copy)]
pub enum Domain {
    /// Whole numbers of a range.
    Whole {
        /// The first.
        least: i64,
        /// The last.
        most: i64,
    },
    /// Numbers.
    Number {
        /// Which, in words.
        expected: &'static str,
        /// Whether a number is one of them.
        holds: fn(f64) -> bool,
    },
    /// One of some words.
    Word(&'static [&'static str]),
}

/// A setting of a method as studies name it.
#[derive(Debug)]
pub struct Key {
    /// Name, below `fit`.
    pub name: &'static str,
    /// Its values.
    pub domain: Domain,
}

impl Key {
    /// Numbers above 0 up to 1.
    pub(super) const fn share(name: &'static str) -> Self {
        let (expected, holds): (_, fn(f64) -> bool) =
            ("a number above 0 and at most 1", |value| value > 0.0 && value <= 1.0);
        Self { name, domain: Domain::Number { expected, holds } }
    }
}

/// Highest degree of any method.
pub(super) const MAX_DEGREE: Key = Key { name: "max_degree", domain: Domain::Whole { least: 1, most: HIGHEST_DEGREE } };

/// S² at which a component is accurate enough.
pub(super) const S2_TARGET: Key = Key::share("s2_target");

/// The value of a key.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// A word.
    Word(String),
}

/// The values that a study gives, each of a key of the method and within its domain.
#[derive(Debug, Default)]
pub struct Given(pub Vec<(&'static str, Value)>);

impl Given {
    fn find(&self, key: &Key) -> Option<&Value> {
        self.0.iter().find(|(name, _)| *name == key.name).map(|(_, value)| value)
    }

    /// A whole number, if given.
    pub(super) fn whole(&self, key: &Key) -> Option<i64> {
        self.find(key).and_then(|value| if let Value::Whole(value) = value { Some(*value) } else { None })
    }

    /// A number, if given.
    pub(super) fn number(&self, key: &Key) -> Option<f64> {
        self.find(key).and_then(|value| if let Value::Number(value) = value { Some(*value) } else { None })
    }

    /// A word, if given.
    pub(super) fn word(&self, key: &Key) -> Option<&str> {
        self.find(key).and_then(|value| if let Value::Word(value) = value { Some(value.as_str()) } else { None })
    }

    /// The highest degree.
    pub(super) fn degree(&self, default: u16) -> u16 {
        self.whole(&MAX_DEGREE).map_or(default, |degree| degree as u16)
    }
}

/// A key that is given beside a value of another key with which it means nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Meaningless {
    /// The key.
    pub key: &'static str,
    /// What it belongs to, like `solver = "least-squares"`.
    pub belongs_to: &'static str,
}

/// A method by name.
#[derive(Debug)]
pub struct Entry {
    /// Name in study files.
    pub name: &'static str,
    /// The settings it has.
    pub keys: &'static [&'static Key],
    /// Whether its design grows until the fit is good enough; else the degree fixes it.
    pub grows: bool,
    /// The method with its settings, those that are given and the defaults of the others, for a number of inputs.
    pub read: fn(&Given, usize) -> Result<FitMethod, Meaningless>,
}

/// All methods, in the order in which messages name them.
pub const METHODS: [Entry; 6] =
    [stepwise::METHOD, auto::METHOD, minimum_norm::METHOD, omp::METHOD, gpc::METHOD, multi_element::METHOD];

/// A method with its settings.
#[derive(Debug, Clone, PartialEq)]
pub enum FitMethod {
    /// The paper's stepwise regression.
    Stepwise(stepwise::Stepwise),
    /// For each component the better of pursuit and minimum norm.
    Auto(Smooth),
    /// Weighted minimum norm.
    MinimumNorm(Smooth),
    /// Orthogonal matching pursuit.
    Omp(Smooth),
    /// A full expansion.
    Gpc(gpc::FullExpansion),
    /// Full expansions on elements.
    MultiElement(multi_element::MultiElement),
}

/// Settings of the methods that choose degree, norm and number of terms by cross-validation.
#[derive(Debug, Clone, PartialEq)]
pub struct Smooth {
    /// Highest degree, at least 1: in each input for the minimum-norm fit, whose terms can have a higher total degree;
    /// of the index set for pursuit.
    pub max_degree: u16,
    /// S² at which a component is accurate enough, in (0, 1\].
    pub s2_target: f64,
}

impl Smooth {
    pub(super) fn read(given: &Given) -> Self {
        Self { max_degree: given.degree(DEFAULT_DEGREE), s2_target: given.number(&S2_TARGET).unwrap_or(DEFAULT_S2) }
    }

    pub(super) fn profile(&self, name: &'static str, explanation: &'static str, degree: &'static str) -> Profile {
        Profile {
            name,
            explanation,
            degree,
            max_degree: self.max_degree,
            settings: vec![s2_setting(self.s2_target)],
            design: Design::Growing,
            is_least_squares: false,
            chooses: false,
        }
    }
}

/// Where a method needs the model to be run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Design {
    /// On a design that grows until the fit is good enough.
    Growing,
    /// On a design with so many equations per term.
    Oversampled(f64),
    /// At the nodes of a tensor Gauss rule.
    Quadrature,
    /// At the nodes of a rule for every element.
    QuadraturePerElement,
}

/// A setting with its value and what it means.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodSetting {
    /// Name in study files.
    pub key: &'static str,
    /// Value.
    pub value: Value,
    /// What it means, for people.
    pub explanation: &'static str,
}

pub(super) fn s2_setting(s2_target: f64) -> MethodSetting {
    number_setting(&S2_TARGET, s2_target, "leave-one-out S² that is accurate enough")
}

pub(super) fn number_setting(key: &Key, value: f64, explanation: &'static str) -> MethodSetting {
    MethodSetting { key: key.name, value: Value::Number(value), explanation }
}

/// What a method says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Name in study files.
    pub name: &'static str,
    /// What it is, for people.
    pub explanation: &'static str,
    /// What its highest degree bounds, for people.
    pub degree: &'static str,
    /// Highest degree.
    pub max_degree: u16,
    /// Its other settings, in the order of study files.
    pub settings: Vec<MethodSetting>,
    /// Where the model is run.
    pub design: Design,
    /// Whether it solves for as many unknowns as it has terms; others have one per equation, and need a matrix of that
    /// size.
    pub is_least_squares: bool,
    /// Whether it chooses another method for every component.
    pub chooses: bool,
}

/// What a solver prepares for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FitSize {
    /// Number of inputs.
    pub inputs: usize,
    /// Model runs at most.
    pub maximum: usize,
    /// Derivatives that come with every run.
    pub derivatives: usize,
}

/// What the fit of a component on one design leaves for the next larger one.
pub type Previous = auto::Previous;

/// A fitted component, the name of the method that fitted it, and what the next design starts from.
pub type MethodFit = (Fitted, &'static str, Previous);

/// A method that is ready to fit components.
pub trait Solver: Sync {
    /// Fits one component: `response.values[i]` belongs to point i of `tables`. `None` if the method asks for a larger
    /// design, as long as the design `can_grow`; else the component settles for what the design carries.
    ///
    /// # Errors
    ///
    /// [`Interrupted`] soon after the observer asks to stop.
    fn fit(
        &self,
        tables: &BasisTables,
        response: Response<'_>,
        previous: &Previous,
        can_grow: bool,
        observer: &dyn Observer,
    ) -> Result<Option<MethodFit>, Interrupted>;

    /// The same where a trial solver ([`FitMethod::trial_solver`]) has fitted the same component on the same design,
    /// from the same `previous`. Methods that have no use for that begin anew.
    ///
    /// # Errors
    ///
    /// [`Interrupted`] soon after the observer asks to stop.
    fn complete(
        &self,
        _trial: MethodFit,
        tables: &BasisTables,
        response: Response<'_>,
        previous: &Previous,
        can_grow: bool,
        observer: &dyn Observer,
    ) -> Result<Option<MethodFit>, Interrupted> {
        self.fit(tables, response, previous, can_grow, observer)
    }
}

impl FitMethod {
    /// What it says of itself.
    pub fn profile(&self) -> Profile {
        match self {
            Self::Stepwise(settings) => settings.profile(),
            Self::Auto(settings) => auto::profile(settings),
            Self::MinimumNorm(settings) => minimum_norm::profile(settings),
            Self::Omp(settings) => omp::profile(settings),
            Self::Gpc(settings) => settings.profile(),
            Self::MultiElement(settings) => settings.profile(),
        }
    }

    /// The method, ready to fit components. Quadrature has a build of its own, in which projections take the place of
    /// fits.
    ///
    /// # Errors
    ///
    /// [`IndexSetError`] if there are too many candidate terms.
    pub fn solver(&self, size: FitSize) -> Result<Box<dyn Solver + '_>, IndexSetError> {
        match self {
            Self::Stepwise(settings) => Ok(Box::new(stepwise::ready(settings, size)?)),
            Self::Auto(settings) => Ok(Box::new(auto::ready(settings, size)?)),
            Self::MinimumNorm(settings) => Ok(Box::new(minimum_norm::ready(settings))),
            Self::Omp(settings) => Ok(Box::new(omp::ready(settings, size)?)),
            Self::Gpc(_) | Self::MultiElement(_) => Ok(Box::new(gpc::ready(self.max_degree(), size)?)),
        }
    }

    /// A quicker solver to compare what might be fitted; `None` if the method itself is as quick.
    pub fn trial_solver(&self) -> Option<Box<dyn Solver + '_>> {
        match self {
            Self::Auto(settings) | Self::Omp(settings) => Some(Box::new(minimum_norm::ready(settings))),
            Self::MinimumNorm(_) | Self::Stepwise(_) | Self::Gpc(_) | Self::MultiElement(_) => None,
        }
    }

    /// Name in study files.
    pub fn name(&self) -> &'static str {
        self.profile().name
    }

    /// Highest degree.
    pub fn max_degree(&self) -> u16 {
        self.profile().max_degree
    }

    /// Whether it takes every design, however small, and says how well it predicts runs left out.
    pub fn fits_every_design(&self) -> bool {
        matches!(self, Self::Auto(_) | Self::MinimumNorm(_) | Self::Omp(_))
    }

    /// Whether coefficients are integrals over a tensor Gauss rule.
    pub fn is_quadrature(&self) -> bool {
        matches!(self.profile().design, Design::Quadrature | Design::QuadraturePerElement)
    }

    /// Whether the degree says where the model is run, and how often.
    pub fn has_fixed_design(&self) -> bool {
        self.profile().design != Design::Growing
    }

    /// Whether a fit can take derivatives beside values.
    pub fn can_use_derivatives(&self) -> bool {
        !self.is_quadrature()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn default(entry: &Entry, inputs: usize) -> FitMethod {
        (entry.read)(&Given::default(), inputs).unwrap()
    }

    #[test]
    fn every_method_says_its_own_name_and_has_the_settings_it_names() {
        for entry in &METHODS {
            let profile = default(entry, 3).profile();
            assert_eq!(profile.name, entry.name);
            assert_eq!(profile.design == Design::Growing, entry.grows, "{}", entry.name);
            for setting in &profile.settings {
                assert!(entry.keys.iter().any(|key| key.name == setting.key), "{}: {}", entry.name, setting.key);
            }
        }
    }

    /// What is printed with every default filled in means the same when it is read.
    #[test]
    fn settings_that_are_said_and_read_again_are_the_same() {
        for entry in &METHODS {
            let method = default(entry, 5);
            let profile = method.profile();
            let mut given = Given(vec![(MAX_DEGREE.name, Value::Whole(profile.max_degree.into()))]);
            given.0.extend(profile.settings.into_iter().map(|setting| (setting.key, setting.value)));
            assert_eq!((entry.read)(&given, 5), Ok(method));
        }
    }

    #[test]
    fn a_key_means_the_same_in_every_method() {
        let keys = || METHODS.iter().flat_map(|entry| entry.keys);
        let said = |key: &Key| match key.domain {
            Domain::Whole { least, most } => format!("{least} to {most}"),
            Domain::Number { expected, .. } => expected.to_owned(),
            Domain::Word(words) => words.join(", "),
        };
        for key in keys() {
            assert!(
                keys().filter(|other| other.name == key.name).all(|other| said(other) == said(key)),
                "{}",
                key.name
            );
        }
    }
}
