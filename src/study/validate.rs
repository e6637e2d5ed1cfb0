//! From the file as written to a study in which everything holds.

use std::fmt::Debug;
use std::ops::RangeInclusive;
use toml::Spanned;

use super::error::{Place, StudyError};
use super::settings::{
    Derivatives, DesignKind, DesignSettings, FitMethod, FitSettings, ModelSettings, Smooth, SpectrumSettings, Stepwise,
};
use super::{STUDY_FORMAT, Study, defaults, raw};
use crate::input::{Input, InputSpace, Marginal, Uniform};
use crate::model::{CLUTCH_PARAMETERS, Parameter};
use crate::spectrum::{Modes, Target};

/// Degrees above this are of no use for functions that a design can resolve.
const HIGHEST_DEGREE: i64 = 100;

/// Design sizes above this need more memory for the regression than a workstation has.
const LARGEST_DESIGN: i64 = 1_000_000;

const DESIGNS: [DesignKind; 2] = [DesignKind::NestedLhs, DesignKind::NestedMaximinLhs];

/// A method that takes no settings of the stepwise one.
type SmoothMethod = fn(Smooth) -> FitMethod;

/// The fitting methods; none of the smooth ones for "stepwise".
const METHODS: [(&str, Option<SmoothMethod>); 4] = [
    ("stepwise", None),
    ("auto", Some(FitMethod::Auto)),
    ("minimum-norm", Some(FitMethod::MinimumNorm)),
    ("omp", Some(FitMethod::Omp)),
];

const TARGETS: [Target; 2] = [Target::Eigenvalues, Target::Invariants];

/// Values and derivatives that a minimum-norm fit may take: matrices of half a gigabyte.
const MOST_EQUATIONS: usize = 8_000;

/// Univariate polynomial values that a design may need: two gigabytes.
const LARGEST_TABLES: usize = 250_000_000;

pub(super) fn study(text: &str) -> Result<Study, StudyError> {
    let lines = Lines { text };
    if let Some(format) = raw::format(text)?.format.filter(|format| *format.get_ref() != i64::from(STUDY_FORMAT)) {
        let place = lines.place("format", &format);
        return Err(StudyError::Format { place, found: format.into_inner(), known: STUDY_FORMAT });
    }
    let raw = raw::parse(text)?;
    let name = lines.name(raw.name)?;
    let seed = match raw.seed {
        Some(seed) => lines.integer("seed", seed, 0..=i64::MAX)? as u64,
        None => defaults::SEED,
    };
    lines.word("model.kind", &raw.model.kind, &[("clutch", ())])?;
    let inputs = lines.inputs(raw.inputs)?;
    let constants = lines.constants(raw.model.constants, &inputs)?;
    let dimension = inputs.dimension();
    let spectrum = lines.spectrum(raw.spectrum)?;
    let model = ModelSettings::Clutch { constants };
    let fit = lines.fit(raw.fit, spectrum.target, &model)?;
    let derivatives = fit.derivatives.are_used(spectrum.target, &model);
    let design = lines.design(raw.design, spectrum.target, dimension, derivatives)?;
    let max_degree = fit.method.max_degree();
    let numbers = dimension.saturating_mul(usize::from(max_degree) + 1).saturating_mul(design.maximum);
    if numbers > LARGEST_TABLES {
        return Err(StudyError::TooLarge { inputs: dimension, max_degree, maximum: design.maximum });
    }
    let equations = design.maximum.saturating_mul(1 + dimension);
    let is_stepwise = matches!(fit.method, FitMethod::Stepwise(_));
    if derivatives && !is_stepwise && equations > MOST_EQUATIONS {
        let (inputs, maximum, most) = (dimension, design.maximum, MOST_EQUATIONS);
        return Err(StudyError::TooManyEquations { inputs, maximum, equations, most, fitting: most / (1 + inputs) });
    }
    Ok(Study { name, seed, model, inputs, spectrum, design, fit })
}

/// Knows the text, so that errors can name lines.
struct Lines<'a> {
    text: &'a str,
}

impl Lines<'_> {
    fn place<T>(&self, key: impl Into<String>, value: &Spanned<T>) -> Place {
        let before = &self.text.as_bytes()[..value.span().start.min(self.text.len())];
        Place { key: key.into(), line: 1 + before.iter().filter(|&&byte| byte == b'\n').count() }
    }

    fn out_of_range<T: Debug>(&self, key: &str, value: &Spanned<T>, expected: impl Into<String>) -> StudyError {
        StudyError::OutOfRange {
            place: self.place(key, value),
            found: format!("{:?}", value.get_ref()),
            expected: expected.into(),
        }
    }

    fn integer(&self, key: &str, value: Spanned<i64>, range: RangeInclusive<i64>) -> Result<i64, StudyError> {
        if range.contains(value.get_ref()) {
            return Ok(value.into_inner());
        }
        Err(self.out_of_range(key, &value, format!("a whole number from {} to {}", range.start(), range.end())))
    }

    fn number(
        &self,
        key: &str,
        value: Option<Spanned<f64>>,
        default: f64,
        expected: &str,
        holds: impl Fn(f64) -> bool,
    ) -> Result<f64, StudyError> {
        match value {
            None => Ok(default),
            Some(value) if holds(*value.get_ref()) => Ok(value.into_inner()),
            Some(value) => Err(self.out_of_range(key, &value, expected)),
        }
    }

    fn word<T: Copy>(&self, key: &str, word: &Spanned<String>, known: &[(&str, T)]) -> Result<T, StudyError> {
        known.iter().find(|(name, _)| name == word.get_ref()).map(|&(_, meaning)| meaning).ok_or_else(|| {
            let names: Vec<_> = known.iter().map(|(name, _)| format!("\"{name}\"")).collect();
            StudyError::UnknownWord {
                place: self.place(key, word),
                found: word.get_ref().clone(),
                expected: names.join(" or "),
            }
        })
    }

    /// Names become file names, so they hold nothing that a file system or a shell gives a meaning.
    fn name(&self, name: Spanned<String>) -> Result<String, StudyError> {
        let allowed = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
        let text = name.get_ref();
        if (1..=100).contains(&text.len()) && text.chars().all(allowed) && !text.starts_with(['.', '-']) {
            return Ok(name.into_inner());
        }
        Err(StudyError::OutOfRange {
            place: self.place("name", &name),
            found: format!("{text:?}"),
            expected: "1 to 100 letters, digits, '.', '_' or '-', starting with a letter, digit or '_'".to_owned(),
        })
    }

    fn parameter<T>(&self, table: &str, name: &str, value: &Spanned<T>) -> Result<&'static Parameter, StudyError> {
        CLUTCH_PARAMETERS.iter().find(|parameter| parameter.name == name).ok_or_else(|| StudyError::UnknownParameter {
            place: self.place(format!("{table}.{name}"), value),
            known: CLUTCH_PARAMETERS.map(|parameter| parameter.name).join(", "),
        })
    }

    fn inputs(&self, table: Spanned<raw::Ordered<raw::Input>>) -> Result<InputSpace, StudyError> {
        let place = self.place("inputs", &table);
        let mut inputs = Vec::new();
        for (name, raw) in table.into_inner().0 {
            let parameter = self.parameter("inputs", &name, &raw)?;
            inputs.push(Input { marginal: self.marginal(parameter, &raw)?, name });
        }
        InputSpace::new(inputs).map_err(|cause| StudyError::Inputs { place, cause })
    }

    fn marginal(&self, parameter: &Parameter, raw: &Spanned<raw::Input>) -> Result<Marginal, StudyError> {
        let key = format!("inputs.{}", parameter.name);
        let input = raw.get_ref();
        self.word(&format!("{key}.distribution"), &input.distribution, &[("uniform", ())])?;
        let place = self.place(&key, raw);
        let (lower, upper) = match (input.lower, input.upper, input.nominal, input.spread) {
            (Some(lower), Some(upper), None, None) => (lower, upper),
            (None, None, Some(nominal), Some(spread)) => (nominal * (1.0 - spread), nominal * (1.0 + spread)),
            _ => return Err(StudyError::DistributionForm { place }),
        };
        let uniform =
            Uniform::new(lower, upper).map_err(|cause| StudyError::Distribution { place: place.clone(), cause })?;
        if !(parameter.range.contains(lower) && parameter.range.contains(upper)) {
            let expected = format!("{} over the whole interval", parameter.range.describe());
            return Err(StudyError::OutOfRange { place, found: format!("from {lower:?} to {upper:?}"), expected });
        }
        Ok(Marginal::Uniform(uniform))
    }

    fn constants(&self, table: raw::Ordered<f64>, inputs: &InputSpace) -> Result<Vec<(String, f64)>, StudyError> {
        let mut constants = Vec::new();
        for (name, value) in table.0 {
            let key = format!("model.constants.{name}");
            let parameter = self.parameter("model.constants", &name, &value)?;
            if inputs.names().any(|input| input == name) {
                return Err(StudyError::ConstantAndInput { place: self.place(key, &value) });
            }
            if !parameter.range.contains(*value.get_ref()) {
                return Err(self.out_of_range(&key, &value, format!("a number {}", parameter.range.describe())));
            }
            constants.push((name, value.into_inner()));
        }
        constants.sort_by(|a, b| a.0.cmp(&b.0));
        Ok(constants)
    }

    fn spectrum(&self, raw: raw::Spectrum) -> Result<SpectrumSettings, StudyError> {
        let target = match raw.target {
            Some(word) => self.word("spectrum.target", &word, &TARGETS.map(|target| (target.name(), target)))?,
            None => Target::Eigenvalues,
        };
        let modes = match raw.modes {
            Some(modes) => self.modes(modes)?,
            None => defaults::MODES,
        };
        Ok(SpectrumSettings { target, modes })
    }

    fn modes(&self, raw: Spanned<raw::Modes>) -> Result<Modes, StudyError> {
        let place = self.place("spectrum.modes", &raw);
        let wrong = |found: String| StudyError::OutOfRange {
            place,
            found,
            expected: "\"all\" or a list of distinct mode numbers from 1, like [3, 4]".to_owned(),
        };
        match raw.into_inner() {
            raw::Modes::Word(word) if word == "all" => Ok(Modes::All),
            raw::Modes::Word(word) => Err(wrong(format!("{word:?}"))),
            raw::Modes::Ranks(ranks) => {
                let mut sorted = ranks.clone();
                sorted.sort_unstable();
                sorted.dedup();
                if sorted.len() < ranks.len() || sorted.first().is_none_or(|&first| first < 1) {
                    return Err(wrong(format!("{ranks:?}")));
                }
                Ok(Modes::Ranks(sorted.into_iter().map(|rank| rank as usize).collect()))
            }
        }
    }

    fn design(
        &self,
        raw: raw::Design,
        target: Target,
        inputs: usize,
        derivatives: bool,
    ) -> Result<DesignSettings, StudyError> {
        let kind = match raw.kind {
            Some(word) => self.word("design.kind", &word, &DESIGNS.map(|kind| (kind.name(), kind)))?,
            None => defaults::design(target),
        };
        let size = |key: &str, value: Option<Spanned<i64>>, smallest: i64, default: usize| match value {
            Some(value) => self.integer(key, value, smallest..=LARGEST_DESIGN).map(|size| size as usize),
            None => Ok(default),
        };
        let maximum_place = raw.maximum.as_ref().map(|value| self.place("design.maximum", value));
        let default_initial = defaults::initial(target, inputs, derivatives);
        let default_step = defaults::step(target, inputs, derivatives);
        let initial_was_given = raw.initial.is_some();
        let maximum = size("design.maximum", raw.maximum, 2, defaults::maximum(target, inputs, derivatives))?;
        let initial = size("design.initial", raw.initial, 2, default_initial.min(maximum))?;
        let step = size("design.step", raw.step, 1, default_step)?;
        match maximum_place {
            Some(place) if initial_was_given && initial > maximum => Err(StudyError::OutOfRange {
                place,
                found: maximum.to_string(),
                expected: format!("at least design.initial ({initial})"),
            }),
            _ => Ok(DesignSettings { kind, initial, step, maximum: maximum.max(initial) }),
        }
    }

    fn fit(&self, raw: raw::Fit, target: Target, model: &ModelSettings) -> Result<FitSettings, StudyError> {
        let derivatives = match raw.derivatives {
            Some(derivatives) => self.derivatives(derivatives, target)?,
            None => Derivatives::Auto,
        };
        let share = |value: f64| value > 0.0 && value <= 1.0;
        let in_share = "a number above 0 and at most 1";
        let max_degree = match raw.max_degree {
            Some(value) => self.integer("fit.max_degree", value, 1..=HIGHEST_DEGREE)? as u16,
            None => defaults::MAX_DEGREE,
        };
        let s2_target = self.number("fit.s2_target", raw.s2_target, defaults::S2_TARGET, in_share, share)?;
        let method = match &raw.method {
            Some(word) => self.word("fit.method", word, &METHODS)?,
            None if target == Target::Invariants => Some(FitMethod::Auto as SmoothMethod),
            None => None,
        };
        let default_tolerance = defaults::proportion_tolerance(derivatives.are_used(target, model), method.is_none());
        let proportion_tolerance = match raw.proportion_tolerance {
            Some(value) => {
                let (resolved, expected) = (|value| (1e-5..=1.0).contains(&value), "a number from 1e-5 to 1");
                Some(self.number("fit.proportion_tolerance", Some(value), 1.0, expected, resolved)?)
            }
            None => (target == Target::Invariants).then_some(default_tolerance),
        };
        let (norm, forward, backward) = (raw.q_norm, raw.epsilon_forward, raw.epsilon_backward);
        let method = match method {
            None => FitMethod::Stepwise(self.stepwise(max_degree, s2_target, norm, forward, backward)?),
            Some(smooth_method) => {
                let keys = ["fit.q_norm", "fit.epsilon_forward", "fit.epsilon_backward"];
                for (key, value) in keys.into_iter().zip([norm, forward, backward]) {
                    if let Some(value) = value {
                        return Err(StudyError::KeyOfStepwise { place: self.place(key, &value) });
                    }
                }
                smooth_method(Smooth { max_degree, s2_target })
            }
        };
        Ok(FitSettings { method, proportion_tolerance, derivatives })
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

    fn stepwise(
        &self,
        max_degree: u16,
        s2_target: f64,
        q_norm: Option<Spanned<f64>>,
        forward: Option<Spanned<f64>>,
        backward: Option<Spanned<f64>>,
    ) -> Result<Stepwise, StudyError> {
        let share = |value: f64| value > 0.0 && value <= 1.0;
        let cutoff = |value: f64| (0.0..1.0).contains(&value);
        let (in_share, in_cutoff) = ("a number above 0 and at most 1", "a number from 0 to below 1");
        let epsilon = |key, value, default| self.number(key, value, default, in_cutoff, cutoff);
        Ok(Stepwise {
            max_degree,
            s2_target,
            q_norm: self.number("fit.q_norm", q_norm, defaults::Q_NORM, in_share, share)?,
            epsilon_forward: epsilon("fit.epsilon_forward", forward, defaults::EPSILON_FORWARD)?,
            epsilon_backward: epsilon("fit.epsilon_backward", backward, defaults::EPSILON_BACKWARD)?,
        })
    }
}
