//! The fit of a study: which method, and the settings that belong to it.

use toml::Spanned;

use super::error::StudyError;
use super::settings::{
    Derivatives, FitMethod, FitSettings, FullExpansion, ModelSettings, MultiElement, Smooth, Solver, Stepwise,
};
use super::validate::Lines;
use super::{defaults, raw};
use crate::mechanics::spectrum::Target;

/// Degrees above this are of no use for functions that a design can resolve.
const HIGHEST_DEGREE: i64 = 100;

/// More elements are refused: each has expansions of its own, and finding room for the next looks at all splits.
const MOST_ELEMENTS: i64 = 10_000;

/// Entries of the matrix of a least-squares fit: two gigabytes.
const LARGEST_MATRIX: f64 = 2.5e8;

/// A method without its settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Method {
    Stepwise,
    Auto,
    MinimumNorm,
    Omp,
    Gpc,
    MultiElement,
}

const METHODS: [(&str, Method); 6] = [
    ("stepwise", Method::Stepwise),
    ("auto", Method::Auto),
    ("minimum-norm", Method::MinimumNorm),
    ("omp", Method::Omp),
    ("gpc", Method::Gpc),
    ("me-gpc", Method::MultiElement),
];

/// Methods whose settings are found by search or by looking at the error, on a growing design.
const GROWING: [Method; 4] = [Method::Stepwise, Method::Auto, Method::MinimumNorm, Method::Omp];

/// The values of keys that are given, with the methods they belong to.
struct Keys<'a> {
    lines: &'a Lines<'a>,
    method: Method,
}

impl Keys<'_> {
    /// Fails if `value` is given and the method is none of `methods`.
    fn only<T>(&self, key: &str, value: &Option<Spanned<T>>, methods: &[Method]) -> Result<(), StudyError> {
        match value {
            Some(value) if !methods.contains(&self.method) => {
                let names = METHODS.iter().filter(|(_, method)| methods.contains(method));
                let methods: Vec<String> = names.map(|(name, _)| format!("\"{name}\"")).collect();
                let place = self.lines.place(key, value);
                Err(StudyError::KeyOfMethod { place, methods: methods.join(", ") })
            }
            _ => Ok(()),
        }
    }
}

impl Lines<'_> {
    pub(super) fn fit(
        &self,
        raw: raw::Fit,
        target: Target,
        inputs: usize,
        model: &ModelSettings,
    ) -> Result<FitSettings, StudyError> {
        let method = match &raw.method {
            Some(word) => self.word("fit.method", word, &METHODS)?,
            None if target == Target::Invariants => Method::Auto,
            None => Method::Stepwise,
        };
        self.keys_fit(&raw, method)?;
        let derivatives_place = raw.derivatives.as_ref().map(|value| self.place("fit.derivatives", value));
        let derivatives = match raw.derivatives.clone() {
            Some(derivatives) => self.derivatives(derivatives, target)?,
            None => Derivatives::Auto,
        };
        let proportion_tolerance = match &raw.proportion_tolerance {
            Some(value) => {
                let (resolved, expected) = (|value| (1e-5..=1.0).contains(&value), "a number from 1e-5 to 1");
                Some(self.number("fit.proportion_tolerance", Some(value.clone()), 1.0, expected, resolved)?)
            }
            None => (target == Target::Invariants && GROWING.contains(&method)).then(|| {
                let with_derivatives = derivatives.are_used(target, model);
                defaults::proportion_tolerance(with_derivatives, method == Method::Stepwise)
            }),
        };
        let method = match method {
            Method::Stepwise => FitMethod::Stepwise(self.stepwise(raw)?),
            Method::Auto => FitMethod::Auto(self.smooth(raw)?),
            Method::MinimumNorm => FitMethod::MinimumNorm(self.smooth(raw)?),
            Method::Omp => FitMethod::Omp(self.smooth(raw)?),
            Method::Gpc => FitMethod::Gpc(self.full_expansion(raw, inputs)?),
            Method::MultiElement => FitMethod::MultiElement(self.multi_element(raw)?),
        };
        match derivatives_place {
            Some(place) if derivatives == Derivatives::Always && !model.has_derivatives() => {
                Err(StudyError::NoDerivatives { place })
            }
            Some(place) if derivatives == Derivatives::Always && !method.can_use_derivatives() => {
                Err(StudyError::DerivativesOfQuadrature { place })
            }
            // Values alone, whatever is asked for.
            _ if !method.can_use_derivatives() => {
                Ok(FitSettings { method, proportion_tolerance, derivatives: Derivatives::Auto })
            }
            _ => Ok(FitSettings { method, proportion_tolerance, derivatives }),
        }
    }

    /// Every key that is given belongs to the method.
    fn keys_fit(&self, raw: &raw::Fit, method: Method) -> Result<(), StudyError> {
        let keys = Keys { lines: self, method };
        for (key, value) in [
            ("fit.q_norm", &raw.q_norm),
            ("fit.epsilon_forward", &raw.epsilon_forward),
            ("fit.epsilon_backward", &raw.epsilon_backward),
        ] {
            keys.only(key, value, &[Method::Stepwise])?;
        }
        keys.only("fit.s2_target", &raw.s2_target, &GROWING)?;
        keys.only("fit.proportion_tolerance", &raw.proportion_tolerance, &GROWING)?;
        keys.only("fit.solver", &raw.solver, &[Method::Gpc])?;
        keys.only("fit.oversampling", &raw.oversampling, &[Method::Gpc])?;
        for (key, value) in [("fit.theta_1", &raw.theta_1), ("fit.theta_2", &raw.theta_2), ("fit.gamma", &raw.gamma)] {
            keys.only(key, value, &[Method::MultiElement])?;
        }
        keys.only("fit.elements", &raw.elements, &[Method::MultiElement])
    }

    fn derivatives(&self, raw: Spanned<raw::Derivatives>, target: Target) -> Result<Derivatives, StudyError> {
        let place = self.place("fit.derivatives", &raw);
        match raw.into_inner() {
            raw::Derivatives::Flag(true) if target == Target::Eigenvalues => {
                Err(StudyError::DerivativesOfEigenvalues { place })
            }
            raw::Derivatives::Flag(true) => Ok(Derivatives::Always),
            raw::Derivatives::Flag(false) => Ok(Derivatives::Never),
            raw::Derivatives::Word(word) if word == "auto" => Ok(Derivatives::Auto),
            raw::Derivatives::Word(word) => {
                let expected = "\"auto\", true or false".to_owned();
                Err(StudyError::OutOfRange { place, found: format!("{word:?}"), expected })
            }
        }
    }

    fn max_degree(&self, value: Option<Spanned<i64>>, default: u16) -> Result<u16, StudyError> {
        match value {
            Some(value) => Ok(self.integer("fit.max_degree", value, 1..=HIGHEST_DEGREE)? as u16),
            None => Ok(default),
        }
    }

    fn share(&self, key: &str, value: Option<Spanned<f64>>, default: f64) -> Result<f64, StudyError> {
        self.number(key, value, default, "a number above 0 and at most 1", |value| value > 0.0 && value <= 1.0)
    }

    fn smooth(&self, raw: raw::Fit) -> Result<Smooth, StudyError> {
        Ok(Smooth {
            max_degree: self.max_degree(raw.max_degree, defaults::MAX_DEGREE)?,
            s2_target: self.share("fit.s2_target", raw.s2_target, defaults::S2_TARGET)?,
        })
    }

    fn stepwise(&self, raw: raw::Fit) -> Result<Stepwise, StudyError> {
        let epsilon = |key, value, default| {
            self.number(key, value, default, "a number from 0 to below 1", |value| (0.0..1.0).contains(&value))
        };
        Ok(Stepwise {
            max_degree: self.max_degree(raw.max_degree, defaults::MAX_DEGREE)?,
            s2_target: self.share("fit.s2_target", raw.s2_target, defaults::S2_TARGET)?,
            q_norm: self.share("fit.q_norm", raw.q_norm, defaults::Q_NORM)?,
            epsilon_forward: epsilon("fit.epsilon_forward", raw.epsilon_forward, defaults::EPSILON_FORWARD)?,
            epsilon_backward: epsilon("fit.epsilon_backward", raw.epsilon_backward, defaults::EPSILON_BACKWARD)?,
        })
    }

    fn full_expansion(&self, raw: raw::Fit, inputs: usize) -> Result<FullExpansion, StudyError> {
        let is_quadrature = match &raw.solver {
            Some(word) => self.word("fit.solver", word, &[("quadrature", true), ("least-squares", false)])?,
            None => true,
        };
        let solver = match (is_quadrature, raw.oversampling) {
            (true, Some(value)) => {
                return Err(StudyError::OversamplingOfQuadrature { place: self.place("fit.oversampling", &value) });
            }
            (true, None) => Solver::Quadrature,
            (false, value) => {
                let (expected, is_more) = ("a number from 1 to 100", |value: f64| (1.0..=100.0).contains(&value));
                let oversampling = self.number("fit.oversampling", value, defaults::OVERSAMPLING, expected, is_more)?;
                Solver::LeastSquares { oversampling }
            }
        };
        let default_degree = defaults::full_degree(inputs, is_quadrature);
        Ok(FullExpansion { max_degree: self.max_degree(raw.max_degree, default_degree)?, solver })
    }

    fn multi_element(&self, raw: raw::Fit) -> Result<MultiElement, StudyError> {
        let not_negative = |value: f64| value >= 0.0 && value.is_finite();
        let elements = match raw.elements {
            Some(value) => self.integer("fit.elements", value, 1..=MOST_ELEMENTS)? as usize,
            None => defaults::ELEMENTS,
        };
        Ok(MultiElement {
            max_degree: self.max_degree(raw.max_degree, defaults::ELEMENT_DEGREE)?,
            theta_1: self.number("fit.theta_1", raw.theta_1, defaults::THETA_1, "0 or more", not_negative)?,
            theta_2: self.share("fit.theta_2", raw.theta_2, defaults::THETA_2)?,
            gamma: self.share("fit.gamma", raw.gamma, defaults::GAMMA)?,
            elements,
        })
    }

    /// The number of model runs that a method without a growing design takes, of one element for several; `None` for the others.
    pub(super) fn fixed_runs(
        &self,
        fit: &FitSettings,
        inputs: usize,
        derivatives: bool,
        maximum: usize,
    ) -> Result<Option<usize>, StudyError> {
        let degree = fit.method.max_degree();
        let equations_per_run = if derivatives { 1 + inputs } else { 1 };
        let runs = match &fit.method {
            FitMethod::Gpc(FullExpansion { solver: Solver::LeastSquares { oversampling }, .. }) => {
                (oversampling * terms(inputs, degree) / equations_per_run as f64).ceil().max(2.0)
            }
            FitMethod::Gpc(_) | FitMethod::MultiElement(_) => f64::from(degree + 1).powi(inputs as i32),
            _ => return Ok(None),
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
