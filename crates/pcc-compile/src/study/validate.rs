//! From the file as written to a study in which everything holds.

use std::fmt::Debug;
use std::ops::RangeInclusive;
use std::path::Path;
use toml::Spanned;

use super::data::{DataOptions, Expected, check_alone};
use super::dependence::refuse_quadrature;
use super::error::{Place, StudyError};
use super::model::Kind;
use super::settings::{DesignKind, DesignSettings, FitSettings, SpectrumSettings};
use super::{STUDY_FORMAT, Study, defaults, raw};
use crate::fitting::fit::FitMethod;
use crate::mechanics::spectrum::{Modes, Target};
use pcc_evaluate::components::Margin;

/// Design sizes above this need more memory for the regression than a workstation has.
const LARGEST_DESIGN: i64 = 1_000_000;

const DESIGNS: [DesignKind; 3] = [DesignKind::NestedLhs, DesignKind::NestedMaximinLhs, DesignKind::TensorGauss];

const TARGETS: [Target; 2] = [Target::Eigenvalues, Target::Invariants];

/// Runs that a minimum-norm fit with derivatives may take: matrices of half a gigabyte.
const MOST_RUNS: usize = 8_000;

/// Answers with a larger relative error say nothing.
const MOST_NOISE: f64 = 0.1;

/// Rigid-body motion that a study may ask for: more than the largest model has.
const MOST_RIGID: usize = 2_000;

/// Univariate polynomial values that a design may need: two gigabytes.
const LARGEST_TABLES: usize = 250_000_000;

pub(super) fn study(text: &str, folder: &Path, options: &DataOptions) -> Result<Study, StudyError> {
    let lines = Lines { text };
    if let Some(format) = raw::format(text)?.format.filter(|format| *format.get_ref() != i64::from(STUDY_FORMAT)) {
        let place = lines.place("format", &format);
        return Err(StudyError::Format { place, found: format.into_inner(), known: STUDY_FORMAT });
    }
    let mut raw = raw::parse(text)?;
    let name = lines.name(raw.name)?;
    let seed = match raw.seed {
        Some(seed) => lines.integer("seed", seed, 0..=i64::MAX)? as u64,
        None => defaults::SEED,
    };
    let kind = lines.kind(&raw.model.kind)?;
    let places: Vec<Place> =
        raw.inputs.get_ref().0.iter().map(|(key, raw)| lines.place(format!("inputs.{key}"), raw)).collect();
    let inputs = lines.inputs(raw.inputs, kind, folder)?;
    let (dependence, inputs) = match &raw.dependence {
        Some(raw) => lines.dependence(raw, inputs)?,
        None => (None, inputs),
    };
    let dimension = inputs.dimension();
    let spectrum = lines.spectrum(raw.spectrum, kind)?;
    let failure_place = raw.model.on_failure.as_ref().map(|word| lines.place("model.on_failure", word));
    let data_place = raw.model.data.as_ref().map(|files| lines.place("model.data", files));
    let expected = Expected { inputs: &inputs, noise: spectrum.noise };
    let data = lines.data(&mut raw.model, options, folder, &expected)?;
    let model = lines.model(kind, raw.model, (&inputs, data.as_ref()), folder)?;
    if let (Some(data), Kind::Table) = (&data, kind) {
        check_alone(data, &inputs)
            .map_err(|cause| StudyError::Data { place: data_place.clone(), cause: Box::new(cause) })?;
    }
    let has_derivatives = model.has_derivatives() || data.as_ref().is_some_and(|data| data.runs.has_derivatives);
    let fit = lines.fit(raw.fit, spectrum.target, dimension, has_derivatives)?;
    if data.is_some() && fit.method.is_quadrature() {
        let place = data_place.unwrap_or_else(|| lines.nowhere("model.data"));
        return Err(StudyError::DataOfQuadrature { place, method: fit.method.name() });
    }
    if let Some(place) = failure_place.filter(|_| fit.method.is_quadrature() && model.skips_failures()) {
        return Err(StudyError::SkippingOfQuadrature { place });
    }
    if let Some(raw) = raw.dependence.filter(|_| dependence.is_some() && fit.method.is_quadrature()) {
        return Err(refuse_quadrature(lines.place("dependence", &raw), fit.method.name()));
    }
    if let FitMethod::MultiElement(_) = fit.method
        && let Some(at) = inputs.inputs().iter().position(|input| !input.marginal.is_divisible())
    {
        let law = inputs.inputs()[at].marginal.name();
        return Err(StudyError::ElementsOfOthers { place: places[at].clone(), law });
    }
    let derivatives = fit.use_derivatives(spectrum.target, has_derivatives);
    let design = lines.design(raw.design, spectrum.target, dimension, &fit, derivatives)?;
    let max_degree = fit.method.max_degree();
    let numbers = dimension.saturating_mul(usize::from(max_degree) + 1).saturating_mul(design.maximum);
    if !fit.method.has_fixed_design() && numbers > LARGEST_TABLES {
        return Err(StudyError::TooLarge { inputs: dimension, max_degree, maximum: design.maximum });
    }
    if derivatives && !fit.method.profile().is_least_squares && design.maximum > MOST_RUNS {
        return Err(StudyError::TooLargeDesign { maximum: design.maximum, most: MOST_RUNS });
    }
    Ok(Study { name, seed, model, data, inputs, dependence, spectrum, design, fit })
}

/// `"a", "b" or "c"`.
pub(super) fn alternatives(names: &[String]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => names.concat(),
    }
}

/// Knows the text, so that errors can name lines.
pub(super) struct Lines<'a> {
    text: &'a str,
}

impl Lines<'_> {
    pub(super) fn place<T>(&self, key: impl Into<String>, value: &Spanned<T>) -> Place {
        Place { key: key.into(), line: self.line(value.span().start) }
    }

    /// The line of a byte of the text, from 1.
    pub(super) fn line(&self, start: usize) -> usize {
        let before = &self.text.as_bytes()[..start.min(self.text.len())];
        1 + before.iter().filter(|&&byte| byte == b'\n').count()
    }

    /// The place of a key that is not in the file.
    pub(super) fn nowhere(&self, key: &str) -> Place {
        Place { key: key.to_owned(), line: 1 }
    }

    pub(super) fn out_of_range<T: Debug>(
        &self,
        key: &str,
        value: &Spanned<T>,
        expected: impl Into<String>,
    ) -> StudyError {
        StudyError::OutOfRange {
            place: self.place(key, value),
            found: format!("{:?}", value.get_ref()),
            expected: expected.into(),
        }
    }

    pub(super) fn integer(
        &self,
        key: &str,
        value: Spanned<i64>,
        range: RangeInclusive<i64>,
    ) -> Result<i64, StudyError> {
        if range.contains(value.get_ref()) {
            return Ok(value.into_inner());
        }
        Err(self.out_of_range(key, &value, format!("a whole number from {} to {}", range.start(), range.end())))
    }

    pub(super) fn number(
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

    pub(super) fn word<T: Copy>(
        &self,
        key: &str,
        word: &Spanned<String>,
        known: &[(&str, T)],
    ) -> Result<T, StudyError> {
        known.iter().find(|(name, _)| name == word.get_ref()).map(|&(_, meaning)| meaning).ok_or_else(|| {
            let names: Vec<_> = known.iter().map(|(name, _)| format!("\"{name}\"")).collect();
            StudyError::UnknownWord {
                place: self.place(key, word),
                found: word.get_ref().clone(),
                expected: alternatives(&names),
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

    fn spectrum(&self, raw: raw::Spectrum, kind: Kind) -> Result<SpectrumSettings, StudyError> {
        let target = match raw.target {
            Some(word) => self.word("spectrum.target", &word, &TARGETS.map(|target| (target.name(), target)))?,
            None => kind.default_target(),
        };
        let modes = match (raw.modes, raw.frequencies) {
            (Some(modes), None) => self.modes(modes)?,
            (None, Some(band)) => self.band(band, target)?,
            (None, None) => defaults::MODES,
            (Some(_), Some(band)) => {
                let place = self.place("spectrum.frequencies", &band);
                return Err(StudyError::TwoSelections { place });
            }
        };
        let rigid_body_modes = raw.rigid_body_modes.map(|count| self.rigid_body_modes(count)).transpose()?;
        let margin = raw.margin.map(|margin| self.margin(margin)).transpose()?.unwrap_or_default();
        let noise = raw.noise.map(|noise| self.noise(noise)).transpose()?.unwrap_or(0.0);
        Ok(SpectrumSettings { target, modes, rigid_body_modes, margin, noise })
    }

    fn noise(&self, raw: Spanned<f64>) -> Result<f64, StudyError> {
        let place = self.place("spectrum.noise", &raw);
        match raw.into_inner() {
            noise if (0.0..MOST_NOISE).contains(&noise) => Ok(noise),
            other => Err(StudyError::OutOfRange {
                place,
                found: format!("{other:?}"),
                expected: format!("a relative error of the eigenvalues from 0, below {MOST_NOISE}, like 1e-9"),
            }),
        }
    }

    fn band(&self, raw: Spanned<Vec<f64>>, target: Target) -> Result<Modes, StudyError> {
        let place = self.place("spectrum.frequencies", &raw);
        if target == Target::Eigenvalues {
            return Err(StudyError::BandOfRanks { place });
        }
        match raw.into_inner()[..] {
            [lower, upper] if lower >= 0.0 && lower < upper && upper.is_finite() => Ok(Modes::Band([lower, upper])),
            ref other => Err(StudyError::OutOfRange {
                place,
                found: format!("{other:?}"),
                expected: "a lower and a higher frequency in Hz, like [100.0, 5000.0]".to_owned(),
            }),
        }
    }

    fn rigid_body_modes(&self, raw: Spanned<i64>) -> Result<usize, StudyError> {
        let place = self.place("spectrum.rigid_body_modes", &raw);
        let found = raw.into_inner();
        let expected = "the number of eigenvalues that are rigid-body motion, two for a body that is free to move in one \
                        direction";
        usize::try_from(found).ok().filter(|&count| count <= MOST_RIGID).ok_or_else(|| StudyError::OutOfRange {
            place,
            found: found.to_string(),
            expected: format!("{expected}, at most {MOST_RIGID}"),
        })
    }

    fn margin(&self, raw: Spanned<raw::Margin>) -> Result<Margin, StudyError> {
        let place = self.place("spectrum.margin", &raw);
        let wrong = |found: f64, expected: &str| StudyError::OutOfRange {
            place,
            found: format!("{found:?}"),
            expected: expected.to_owned(),
        };
        match raw.into_inner() {
            raw::Margin::GrowthRate(rate) if rate >= 0.0 && rate.is_finite() => Ok(Margin::GrowthRate(rate)),
            raw::Margin::GrowthRate(rate) => Err(wrong(rate, "a growth rate in 1/s that is not negative")),
            raw::Margin::DampingRatio(raw::DampingRatio { damping_ratio: 0.0 })
            | raw::Margin::LogDecrement(raw::LogDecrement { log_decrement: 0.0 }) => Ok(Margin::default()),
            raw::Margin::DampingRatio(raw::DampingRatio { damping_ratio: ratio }) => match ratio > 0.0 && ratio < 1.0 {
                true => Ok(Margin::DampingRatio(ratio)),
                false => Err(wrong(ratio, "a damping ratio from 0, below 1")),
            },
            raw::Margin::LogDecrement(raw::LogDecrement { log_decrement: decrement }) => {
                match decrement > 0.0 && decrement.is_finite() {
                    // δ = 2πζ/√(1 − ζ²)
                    true => Ok(Margin::DampingRatio(decrement / decrement.hypot(std::f64::consts::TAU))),
                    false => Err(wrong(decrement, "a logarithmic decrement that is not negative")),
                }
            }
        }
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
        fit: &FitSettings,
        derivatives: bool,
    ) -> Result<DesignSettings, StudyError> {
        let kind_place = raw.kind.as_ref().map(|word| self.place("design.kind", word));
        let default_kind = if fit.method.is_quadrature() { DesignKind::TensorGauss } else { defaults::design(target) };
        let kind = match raw.kind {
            Some(word) => self.word("design.kind", &word, &DESIGNS.map(|kind| (kind.name(), kind)))?,
            None => default_kind,
        };
        match kind_place {
            Some(place) if (kind == DesignKind::TensorGauss) != fit.method.is_quadrature() => {
                return Err(StudyError::DesignOfMethod { place, kind: kind.name(), fitting: default_kind.name() });
            }
            _ => {}
        }
        let maximum_place = raw.maximum.as_ref().map(|value| self.place("design.maximum", value));
        let default_maximum = defaults::maximum(target, inputs, derivatives, &fit.method);
        let maximum = self.size("design.maximum", raw.maximum, 2, default_maximum)?;
        if let Some(runs) = self.fixed_runs(fit, inputs, derivatives, maximum)? {
            for (key, value) in [("design.initial", raw.initial), ("design.step", raw.step)] {
                if let Some(value) = value {
                    return Err(StudyError::FixedDesign { place: self.place(key, &value), runs });
                }
            }
            return Ok(DesignSettings { kind, initial: runs, step: runs, maximum });
        }
        let default_initial = defaults::initial(target, inputs, derivatives);
        let default_step = defaults::step(target, inputs, derivatives);
        let initial_was_given = raw.initial.is_some();
        // One level alone has nothing to be judged by.
        let default_initial = if default_initial < maximum { default_initial } else { maximum.div_ceil(2).max(2) };
        let initial = self.size("design.initial", raw.initial, 2, default_initial)?;
        let step = self.size("design.step", raw.step, 1, default_step)?;
        match maximum_place {
            Some(place) if initial_was_given && initial > maximum => Err(StudyError::OutOfRange {
                place,
                found: maximum.to_string(),
                expected: format!("at least design.initial ({initial})"),
            }),
            _ => Ok(DesignSettings { kind, initial, step, maximum: maximum.max(initial) }),
        }
    }

    fn size(&self, key: &str, value: Option<Spanned<i64>>, least: i64, default: usize) -> Result<usize, StudyError> {
        value.map_or(Ok(default), |value| Ok(self.integer(key, value, least..=LARGEST_DESIGN)? as usize))
    }
}
