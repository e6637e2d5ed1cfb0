//! Section 2: the inputs, to the wire and back.

use super::error::ReadError;
use super::from_v1::{HIGHEST_DEGREE, ROUNDING};
use super::meaning::{ensure, is_printable};
use super::v1;
use crate::polynomials::{Family, Recurrence};
use crate::probability::dependence::{Correlation, GaussianCopula};
use crate::probability::inputs::{
    Input, InputSpace, Marginal, Parameters, Pieces, Polynomials, Stored, Transform, Uniform,
};
use crate::surrogate::{Expansion, Surrogate};

/// The section of a surrogate's inputs.
pub(super) fn section(surrogate: &Surrogate) -> v1::Inputs {
    let dimension = surrogate.inputs.dimension();
    let mut degrees = vec![0; dimension];
    for expansion in &surrogate.expansions {
        for (degree, highest) in degrees.iter_mut().zip(expansion.indices.highest_degrees(dimension)) {
            *degree = highest.max(*degree);
        }
    }
    let input = |(input, degree): (&Input, u16)| {
        let family = input.marginal.family();
        let recurrence = family.recurrence(usize::from(degree));
        v1::Input {
            name: input.name.clone(),
            distribution: distribution(&input.marginal),
            transform: transform(&input.marginal),
            family: family_name(&family),
            recurrence: v1::Recurrence { diagonal: recurrence.diagonal, off_diagonal: recurrence.off_diagonal },
            bounds: match input.marginal.support() {
                [lower, upper] if lower.is_finite() && upper.is_finite() => Some(v1::Bounds { lower, upper }),
                _ => None,
            },
        }
    };
    let inputs = surrogate.inputs.inputs().iter().zip(degrees).map(input).collect();
    v1::Inputs { inputs, dependence: dependence(&surrogate.inputs) }
}

fn dependence(inputs: &InputSpace) -> v1::Dependence {
    let Some(copula) = inputs.dependence() else { return v1::Dependence::Independent };
    let correlation = |pair: &Correlation| v1::Correlation {
        first: pair.first as u32,
        second: pair.second as u32,
        value: pair.value,
    };
    v1::Dependence::GaussianCopula { correlations: copula.correlations().iter().map(correlation).collect() }
}

fn family_name(family: &Family) -> v1::Family {
    match family {
        Family::Legendre => v1::Family::Legendre,
        Family::Hermite => v1::Family::Hermite,
        Family::Own(own) => match own.name() {
            "laguerre" => v1::Family::Laguerre,
            "jacobi" => v1::Family::Jacobi,
            _ => v1::Family::Own,
        },
    }
}

fn transform(marginal: &Marginal) -> v1::Transform {
    match marginal.transform() {
        Transform::Affine { center, half_width } => v1::Transform::Affine { center, half_width },
        Transform::Exponential { center, half_width } => v1::Transform::Exponential { center, half_width },
        Transform::Pieces { origin, scale, quantile } => v1::Transform::Pieces {
            origin,
            scale,
            breaks: quantile.breaks(),
            coefficients: quantile.coefficients().map(<[f64]>::to_vec).collect(),
        },
    }
}

fn distribution(marginal: &Marginal) -> v1::Distribution {
    match marginal {
        Marginal::Uniform(law) => v1::Distribution::Uniform { lower: law.lower(), upper: law.upper() },
        other => {
            let parameter = |(name, value): (&str, f64)| v1::Parameter { name: name.to_owned(), value };
            let parameters = other.parameters().into_iter().map(parameter).collect();
            v1::Distribution::Law { name: other.name().to_owned(), parameters }
        }
    }
}

/// The inputs of a section.
pub(super) fn space(section: &v1::Inputs) -> Result<InputSpace, ReadError> {
    let mut inputs = Vec::with_capacity(section.inputs.len());
    for input in &section.inputs {
        let meaning =
            |message: String| ReadError::Meaning { section: "inputs", message: format!("{}: {message}", input.name) };
        let marginal = marginal(input).map_err(meaning)?;
        let transform_fits = is_transform_of(&input.transform, &marginal);
        let [lower, upper] = marginal.support();
        let bounds_fit = input.bounds.as_ref().is_none_or(|b| b.lower == lower && b.upper == upper);
        if !(transform_fits && bounds_fit && !input.name.is_empty() && is_printable(&input.name)) {
            return Err(meaning("name, transform or bounds do not fit the distribution".to_owned()));
        }
        inputs.push(Input::new(input.name.clone(), marginal));
    }
    let meaning = |message: String| ReadError::Meaning { section: "inputs", message };
    let inputs = InputSpace::new(inputs).map_err(|error| meaning(error.to_string()))?;
    match &section.dependence {
        v1::Dependence::Independent => Ok(inputs),
        v1::Dependence::GaussianCopula { correlations } => dependent(inputs, correlations).map_err(meaning),
    }
}

fn dependent(inputs: InputSpace, stored: &[v1::Correlation]) -> Result<InputSpace, String> {
    let position = |number: u32| usize::try_from(number).unwrap_or(usize::MAX);
    let pairs = stored.iter().map(|pair| (position(pair.first), position(pair.second), pair.value));
    let copula = GaussianCopula::new(inputs.dimension(), pairs.clone()).map_err(|error| error.to_string())?;
    // Said in the way that is written, and in no other: in order, without zeros.
    let is_same = copula.correlations().iter().map(|pair| (pair.first, pair.second, pair.value)).eq(pairs);
    match is_same && !stored.is_empty() {
        true => inputs.with_dependence(copula).map_err(|error| error.to_string()),
        false => Err("the correlations are none, zero, or not in order".to_owned()),
    }
}

fn marginal(input: &v1::Input) -> Result<Marginal, String> {
    match &input.distribution {
        v1::Distribution::Uniform { lower, upper } => {
            Uniform::new(*lower, *upper).map(Marginal::Uniform).map_err(|error| error.to_string())
        }
        v1::Distribution::Law { name, parameters } => {
            let known = Parameters::of(parameters.iter().map(|parameter| (parameter.name.as_str(), parameter.value)));
            let found = match &input.transform {
                v1::Transform::Pieces { origin, scale, breaks, coefficients } => {
                    let stored = Stored {
                        map: [*origin, *scale],
                        quantile: Pieces::stored(breaks, coefficients)?,
                        polynomials: match input.family {
                            v1::Family::Hermite => Polynomials::Hermite,
                            _ => Polynomials::Own,
                        },
                        recurrence: recurrence(&input.recurrence)?,
                    };
                    Marginal::stored(name, &known, stored)?
                }
                v1::Transform::Exponential { .. } if input.family == v1::Family::Hermite => {
                    let chosen = known.with_polynomials(Some(Polynomials::Hermite));
                    Marginal::named(name, &chosen).map_err(|error| error.to_string())?
                }
                _ => Marginal::named(name, &known).map_err(|error| error.to_string())?,
            };
            // Said in the way that is written, and in no other.
            let is_same = found.parameters().into_iter().eq(parameters.iter().map(|p| (p.name.as_str(), p.value)));
            let is_law = !matches!(found, Marginal::Uniform(_)) && is_same;
            if is_law { Ok(found) } else { Err("the parameters are not those of its law".to_owned()) }
        }
    }
}

fn recurrence(stored: &v1::Recurrence) -> Result<Recurrence, &'static str> {
    let v1::Recurrence { diagonal, off_diagonal } = stored.clone();
    let is_one = diagonal.len() == off_diagonal.len() && off_diagonal.len() <= usize::from(HIGHEST_DEGREE);
    if is_one { Ok(Recurrence { diagonal, off_diagonal }) } else { Err("the recurrence has no degree") }
}

/// Whether a map is that of its law: to rounding where it is said by two numbers, which were computed elsewhere.
fn is_transform_of(found: &v1::Transform, law: &Marginal) -> bool {
    use v1::Transform::{Affine, Exponential};
    match (found, &transform(law)) {
        (Affine { center, half_width }, Affine { center: expected, half_width: width })
        | (Exponential { center, half_width }, Exponential { center: expected, half_width: width }) => {
            close(*center, *expected, *width) && close(*half_width, *width, *width)
        }
        (found, expected) => found == expected,
    }
}

/// Equal but for rounding.
pub(super) fn close(found: f64, expected: f64, scale: f64) -> bool {
    (found - expected).abs() <= ROUNDING * expected.abs().max(scale)
}

/// The stored recurrences are those of the families, and reach the degrees that the expansions use.
pub(super) fn check_recurrences(
    section: &v1::Inputs,
    inputs: &InputSpace,
    expansions: &[Expansion],
) -> Result<(), ReadError> {
    for (j, input) in section.inputs.iter().enumerate() {
        let used = expansions.iter().flat_map(|expansion| expansion.indices.iter().map(move |alpha| alpha[j])).max();
        let degree = input.recurrence.off_diagonal.len();
        let family = inputs.inputs()[j].marginal.family();
        let is_its_own = family_name(&family) == input.family;
        ensure("inputs", is_its_own, || format!("{}: the family is not that of its law", input.name))?;
        let known = family.recurrence(degree.min(usize::from(HIGHEST_DEGREE)));
        let agrees = |found: &[f64], expected: &[f64]| {
            found.len() == expected.len() && found.iter().zip(expected).all(|(&a, &b)| close(a, b, 1.0))
        };
        let fits = agrees(&input.recurrence.diagonal, &known.diagonal)
            && agrees(&input.recurrence.off_diagonal, &known.off_diagonal)
            && degree >= usize::from(used.unwrap_or(0));
        ensure("inputs", fits, || format!("{}: the recurrence is not that of its family and degree", input.name))?;
    }
    Ok(())
}
