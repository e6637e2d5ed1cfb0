//! Laws by name and parameters, as study files and surrogate files give them.

use super::extremes::{Exponential, Gumbel, Weibull};
use super::log_uniform::LogUniform;
use super::marginal::Marginal;
use super::normal::{LogNormal, Normal, TruncatedNormal};
use super::uniform::{MarginalError, Uniform};

/// Parameters of a law, with their names in study files.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters<'a>(Vec<(&'a str, f64)>);

/// A law's name, what its parameters can be, and how it is made of them; `None` if they are others.
type Known = (&'static str, &'static str, fn(&Parameters<'_>) -> Option<Result<Marginal, MarginalError>>);

/// All laws, in the order in which they are listed.
const LAWS: [Known; 7] = [
    ("uniform", "lower and upper, or nominal and spread", uniform),
    ("normal", "mean and std, mean and cv, or nominal and cv; lower or upper or both cut it off", normal),
    ("lognormal", "mean and std, mean and cv, or median and cv, of the variable itself", lognormal),
    ("log-uniform", "lower and upper", |given| {
        given.exactly(["lower", "upper"]).map(|[lower, upper]| LogUniform::new(lower, upper).map(Marginal::LogUniform))
    }),
    ("exponential", "mean", |given| {
        given.exactly(["mean"]).map(|[mean]| Exponential::new(mean).map(Marginal::Exponential))
    }),
    ("weibull", "shape and scale", |given| {
        given.exactly(["shape", "scale"]).map(|[shape, scale]| Weibull::new(shape, scale).map(Marginal::Weibull))
    }),
    ("gumbel", "location and scale, or mean and std", gumbel),
];

impl<'a> Parameters<'a> {
    /// These names with these values.
    pub fn of(given: impl IntoIterator<Item = (&'a str, f64)>) -> Self {
        Self(given.into_iter().collect())
    }

    fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }

    /// The values of these names, if they are all that is given.
    fn exactly<const N: usize>(&self, names: [&str; N]) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for (value, name) in values.iter_mut().zip(names) {
            *value = self.get(name)?;
        }
        (self.0.len() == N).then_some(values)
    }

    fn without(&self, names: &[&str]) -> Self {
        Self(self.0.iter().copied().filter(|(name, _)| !names.contains(name)).collect())
    }
}

impl Marginal {
    /// Names of all laws.
    pub fn names() -> impl Iterator<Item = &'static str> {
        LAWS.iter().map(|(name, ..)| *name)
    }

    /// The law of this name with these parameters.
    ///
    /// # Errors
    ///
    /// [`MarginalError`]: no such law, other parameters than it has, values that it cannot have.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::inputs::{Marginal, Parameters};
    /// let stiffness = Marginal::named("normal", &Parameters::of([("mean", 2e6), ("cv", 0.05)]))?;
    /// assert_eq!(stiffness.parameters(), [("mean", 2e6), ("std", 1e5)]);
    /// assert!(Marginal::named("normal", &Parameters::of([("mean", 2e6)])).is_err());
    /// # Ok::<(), pcc_evaluate::probability::inputs::MarginalError>(())
    /// ```
    pub fn named(name: &str, given: &Parameters<'_>) -> Result<Self, MarginalError> {
        let Some((law, expected, make)) = LAWS.iter().find(|(known, ..)| *known == name) else {
            let known = Self::names().collect::<Vec<_>>().join(", ");
            return Err(MarginalError::Unknown { found: name.to_owned(), known });
        };
        make(given).unwrap_or(Err(MarginalError::Form { law, expected }))
    }
}

fn uniform(given: &Parameters<'_>) -> Option<Result<Marginal, MarginalError>> {
    let [lower, upper] = match given.exactly(["nominal", "spread"]) {
        Some([nominal, spread]) => [nominal * (1.0 - spread), nominal * (1.0 + spread)],
        None => given.exactly(["lower", "upper"])?,
    };
    Some(Uniform::new(lower, upper).map(Marginal::Uniform))
}

/// Mean and standard deviation.
fn moments(given: &Parameters<'_>) -> Option<Result<[f64; 2], MarginalError>> {
    if let Some([mean, std]) = given.exactly(["mean", "std"]) {
        return Some(Ok([mean, std]));
    }
    let [mean, cv] = given.exactly(["mean", "cv"]).or_else(|| given.exactly(["nominal", "cv"]))?;
    Some(match mean == 0.0 {
        true => Err(MarginalError::NoScatter { cv }),
        false => Ok([mean, cv * mean.abs()]),
    })
}

fn normal(given: &Parameters<'_>) -> Option<Result<Marginal, MarginalError>> {
    let bounds = [given.get("lower"), given.get("upper")];
    let law = moments(&given.without(&["lower", "upper"]))?.and_then(|[mean, std]| Normal::new(mean, std));
    Some(law.and_then(|law| match bounds {
        [None, None] => Ok(Marginal::Normal(law)),
        [lower, upper] => TruncatedNormal::new(law, lower, upper).map(Marginal::TruncatedNormal),
    }))
}

fn lognormal(given: &Parameters<'_>) -> Option<Result<Marginal, MarginalError>> {
    let moments = match given.exactly(["median", "cv"]) {
        // The mean of a lognormal variable is median √(1 + cv²).
        Some([median, cv]) => Ok([median * cv.hypot(1.0), cv * median * cv.hypot(1.0)]),
        None => moments(given)?,
    };
    Some(moments.and_then(|[mean, std]| LogNormal::new(mean, std)).map(Marginal::LogNormal))
}

fn gumbel(given: &Parameters<'_>) -> Option<Result<Marginal, MarginalError>> {
    let law = match given.exactly(["location", "scale"]) {
        Some([location, scale]) => Gumbel::new(location, scale),
        None => given.exactly(["mean", "std"]).map(|[mean, std]| Gumbel::with_moments(mean, std))?,
    };
    Some(law.map(Marginal::Gumbel))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_is_made_of_the_parameters_that_it_says() {
        for (name, parameters) in [
            ("uniform", vec![("nominal", 2.0), ("spread", 0.1)]),
            ("normal", vec![("nominal", -2.0), ("cv", 0.1)]),
            ("normal", vec![("mean", 1.0), ("std", 0.5), ("lower", 0.0)]),
            ("normal", vec![("mean", 1.0), ("std", 0.5), ("lower", 0.0), ("upper", 1.5)]),
            ("lognormal", vec![("median", 2.0), ("cv", 0.3)]),
            ("log-uniform", vec![("lower", 1.0), ("upper", 10.0)]),
            ("exponential", vec![("mean", 3.0)]),
            ("weibull", vec![("shape", 1.5), ("scale", 2.0)]),
            ("gumbel", vec![("mean", 2.0), ("std", 0.3)]),
        ] {
            let law = Marginal::named(name, &Parameters::of(parameters)).unwrap();
            assert_eq!(law.name(), name);
            let again = Marginal::named(name, &Parameters::of(law.parameters())).unwrap();
            assert_eq!(again.parameters(), law.parameters());
        }
    }

    #[test]
    fn a_median_is_the_middle() {
        let law = Marginal::named("lognormal", &Parameters::of([("median", 2.0), ("cv", 0.3)])).unwrap();
        assert!((law.physical(0.0) - 2.0).abs() < 1e-14);
    }

    #[test]
    fn wrong_parameters_are_refused_with_what_is_expected() {
        let refusal = |name, parameters: &[(&'static str, f64)]| {
            Marginal::named(name, &Parameters::of(parameters.iter().copied())).unwrap_err().to_string()
        };
        assert!(refusal("normal", &[("mean", 1.0)]).contains("mean and std"));
        assert!(refusal("normal", &[("mean", 1.0), ("std", 0.0)]).contains("std is 0"));
        assert!(refusal("normal", &[("mean", 0.0), ("cv", 0.1)]).contains("mean is 0"));
        assert!(refusal("normal", &[("mean", 0.0), ("std", 1.0), ("lower", 9.0)]).contains("of the probability"));
        assert!(refusal("normal", &[("mean", 0.0), ("std", 1.0), ("lower", 1.0), ("upper", 0.0)]).contains("below"));
        assert!(refusal("lognormal", &[("mean", -1.0), ("std", 0.5)]).contains("mean is -1"));
        assert!(refusal("log-uniform", &[("lower", 0.0), ("upper", 1.0)]).contains("lower is 0"));
        assert!(refusal("weibull", &[("shape", -1.0), ("scale", 1.0)]).contains("shape is -1"));
        assert!(refusal("cauchy", &[]).contains("uniform, normal, lognormal"));
    }
}
