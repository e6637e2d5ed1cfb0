//! Laws by name and parameters, as study files and surrogate files give them.

use super::beta::{beta, beta_with_moments};
use super::extremes::{exponential, gumbel, gumbel_with_moments, weibull};
use super::forms::complaint;
use super::gamma::{gamma, gamma_with_moments};
use super::law::{finite, positive};
use super::levels::{self, discrete};
use super::log_uniform::LogUniform;
use super::lognormal::LogNormal;
use super::marginal::{Marginal, Polynomials};
use super::marginal_error::{MarginalError, plain};
use super::normal::Normal;
use super::shaped::{self, Draft, Shaped, Stored};
use super::triangular::triangular;
use super::uniform::Uniform;

/// Parameters of a law, with their names in study files, and the polynomials that are asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters<'a> {
    numbers: Vec<(&'a str, f64)>,
    polynomials: Option<Polynomials>,
}

/// A law: finished, or to be made from its density.
enum Made {
    Finished(Marginal),
    Draft(Draft),
    Levels(Shaped),
}

type Making = Result<Made, MarginalError>;

/// A law's name, what its parameters can be, and how it is made of them; `None` if they are others.
type Known = (&'static str, &'static str, fn(&Parameters<'_>) -> Option<Making>);

/// All laws, in the order in which they are listed.
const LAWS: [Known; 12] = [
    ("uniform", "lower and upper, or nominal and spread", uniform),
    ("normal", "mean and std, mean and cv, or nominal and cv; lower or upper or both cut it off", normal),
    ("lognormal", "mean and std, mean and cv, or median and cv, of the variable itself", lognormal),
    ("gamma", "mean and std, mean and cv, or shape and scale", |given| {
        let law = match given.exactly(["shape", "scale"]) {
            Some([shape, scale]) => gamma(shape, scale),
            None => given.moments()?.and_then(|[mean, std]| gamma_with_moments(mean, std)),
        };
        Some(law.map(Made::Draft))
    }),
    ("beta", "alpha and beta, or mean and std; lower and upper if they are not 0 and 1", of_beta),
    ("triangular", "lower, mode and upper", |given| {
        let [lower, mode, upper] = given.exactly(["lower", "mode", "upper"])?;
        Some(triangular(lower, mode, upper).map(Made::Draft))
    }),
    ("log-uniform", "lower and upper", |given| {
        let [lower, upper] = given.exactly(["lower", "upper"])?;
        Some(LogUniform::new(lower, upper).map(Marginal::of).map(Made::Finished))
    }),
    ("exponential", "mean", |given| given.exactly(["mean"]).map(|[mean]| exponential(mean).map(Made::Draft))),
    ("weibull", "shape and scale", |given| {
        given.exactly(["shape", "scale"]).map(|[shape, scale]| weibull(shape, scale).map(Made::Draft))
    }),
    ("gumbel", "location and scale, or mean and std", |given| {
        let law = match given.exactly(["location", "scale"]) {
            Some([location, scale]) => gumbel(location, scale),
            None => given.exactly(["mean", "std"]).map(|[mean, std]| gumbel_with_moments(mean, std))?,
        };
        Some(law.map(Made::Draft))
    }),
    ("discrete", "values, and weights if these are not equal", |given| {
        let of = |name| given.numbers.iter().filter(move |(known, _)| *known == name).map(|(_, value)| *value);
        let (values, weights): (Vec<f64>, Vec<f64>) = (of("value").collect(), of("weight").collect());
        let is_it = !values.is_empty() && values.len() == weights.len() && given.numbers.len() == 2 * values.len();
        is_it.then(|| discrete(&values, &weights).map(Made::Levels))
    }),
    // Of values that are measured: `Marginal::measured`.
    ("data", "file, and column if the file has several; lower or upper or both cut it off", |_| None),
];

impl<'a> Parameters<'a> {
    /// These names with these values.
    pub fn of(given: impl IntoIterator<Item = (&'a str, f64)>) -> Self {
        Self { numbers: given.into_iter().collect(), polynomials: None }
    }

    /// With these polynomials, where a law leaves the choice.
    pub fn with_polynomials(self, polynomials: Option<Polynomials>) -> Self {
        Self { polynomials, ..self }
    }

    fn get(&self, name: &str) -> Option<f64> {
        self.numbers.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }

    /// The values of these names, if they are all that is given.
    fn exactly<const N: usize>(&self, names: [&str; N]) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for (value, name) in values.iter_mut().zip(names) {
            *value = self.get(name)?;
        }
        (self.numbers.len() == N).then_some(values)
    }

    fn without(&self, names: &[&str]) -> Self {
        let numbers = self.numbers.iter().copied().filter(|(name, _)| !names.contains(name)).collect();
        Self { numbers, polynomials: self.polynomials }
    }

    /// What is wrong, in the words of what is given: with that before it, where it speaks of what follows from that.
    fn explain(&self, cause: MarginalError) -> MarginalError {
        let speaks_of: &[&str] = match &cause {
            MarginalError::Parameter { name, .. } => &[name],
            MarginalError::NotFinite { .. } | MarginalError::Inverted { .. } | MarginalError::Unresolved { .. } => {
                &["lower", "upper"]
            }
            _ => &[],
        };
        // Of levels there are many.
        let is_given = |name: &&str| self.get(name).is_some() || self.get("value").is_some();
        if speaks_of.iter().all(is_given) {
            return cause;
        }
        let given: Vec<String> =
            self.numbers.iter().map(|(name, value)| format!("{name} = {}", plain(value))).collect();
        MarginalError::Following { given: given.join(", "), cause: Box::new(cause) }
    }

    /// Mean and standard deviation.
    fn moments(&self) -> Option<Result<[f64; 2], MarginalError>> {
        if let Some([mean, std]) = self.exactly(["mean", "std"]) {
            return Some(Ok([mean, std]));
        }
        let (key, [mean, cv]) =
            ["mean", "nominal"].into_iter().find_map(|key| Some((key, self.exactly([key, "cv"])?)))?;
        if !mean.is_finite() {
            return Some(Err(MarginalError::parameter(key, mean, "a finite number")));
        }
        Some(match mean == 0.0 {
            true => Err(MarginalError::NoScatter { name: "cv", value: cv, of: key, instead: "mean and std" }),
            false => Ok([mean, cv * mean.abs()]),
        })
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
        let (law, made) = made(name, given)?;
        let marginal = match made {
            Made::Finished(marginal) => marginal,
            Made::Draft(draft) => draft.law(given.polynomials)?,
            Made::Levels(levels) => Marginal::of(levels),
        };
        match given.polynomials.is_some() && marginal.chosen_polynomials().is_none() {
            true => Err(MarginalError::NoChoice { law }),
            false => Ok(marginal),
        }
    }

    /// The same with the map that a file has, where that was made from the density.
    ///
    /// # Errors
    ///
    /// A sentence: no such law, or not its map.
    pub(crate) fn stored(name: &str, given: &Parameters<'_>, stored: Stored) -> Result<Self, String> {
        if name == "data" {
            return of_data(given, stored).map_err(str::to_owned);
        }
        let given = given.clone().with_polynomials(Some(stored.polynomials));
        match made(name, &given).map_err(|error| error.to_string())? {
            (law, Made::Finished(_)) => Err(format!("a {law} law has no pieces")),
            (_, Made::Levels(levels)) => levels.with_stored(stored).map(Self::of).map_err(str::to_owned),
            (_, Made::Draft(draft)) => draft.stored(stored).map_err(str::to_owned),
        }
    }
}

fn made(name: &str, given: &Parameters<'_>) -> Result<(&'static str, Made), MarginalError> {
    let Some((law, expected, make)) = LAWS.iter().find(|(known, ..)| *known == name) else {
        let known = Marginal::names().collect::<Vec<_>>().join(", ");
        return Err(MarginalError::Unknown { found: name.to_owned(), known });
    };
    let names = || given.numbers.iter().map(|(name, _)| *name);
    let other = || Err(MarginalError::Form { law, expected, complaint: complaint(law, names()) });
    let made = make(given).unwrap_or_else(other);
    Ok((law, made.map_err(|cause| given.explain(cause))?))
}

/// A law of measured values, which are not in the file.
fn of_data(given: &Parameters<'_>, stored: Stored) -> Result<Marginal, &'static str> {
    const KNOWN: [&str; 6] = ["count", "mean", "std", "least", "largest", "bandwidth"];
    let names: Vec<&str> = given.numbers.iter().map(|(name, _)| *name).collect();
    let bounds: Vec<&str> = ["lower", "upper"].into_iter().filter(|name| given.get(name).is_some()).collect();
    let value = |name| given.get(name).unwrap_or(f64::NAN);
    if names != [&KNOWN[..], &bounds].concat() || !(value("least") < value("largest") && value("bandwidth") >= 0.0) {
        return Err("its parameters are not those of measured values");
    }
    let parameters = KNOWN.into_iter().chain(bounds).map(|name| (name, value(name))).collect();
    let [lower, upper] = [("lower", f64::NEG_INFINITY), ("upper", f64::INFINITY)]
        .map(|(name, unbounded)| given.get(name).unwrap_or(unbounded));
    match value("bandwidth") == 0.0 {
        true => levels::of_file("data", parameters, [value("least"), value("largest")], stored).map(Marginal::of),
        false => shaped::of_file("data", parameters, [lower, upper], "own", stored),
    }
}

fn uniform(given: &Parameters<'_>) -> Option<Making> {
    let bounds = match given.exactly(["nominal", "spread"]) {
        Some([nominal, spread]) => around(nominal, spread),
        None => Ok(given.exactly(["lower", "upper"])?),
    };
    let law = bounds.and_then(|[lower, upper]| Uniform::new(lower, upper));
    Some(law.map(Marginal::Uniform).map(Made::Finished))
}

/// The interval of a spread, also of what is negative.
fn around(nominal: f64, spread: f64) -> Result<[f64; 2], MarginalError> {
    let nominal = finite("nominal", nominal)?;
    if nominal == 0.0 {
        let instead = "lower and upper";
        return Err(MarginalError::NoScatter { name: "spread", value: spread, of: "nominal", instead });
    }
    let [nearer, farther] = [nominal * (1.0 - spread), nominal * (1.0 + spread)];
    Ok([nearer.min(farther), nearer.max(farther)])
}

fn normal(given: &Parameters<'_>) -> Option<Making> {
    let bounds = [given.get("lower"), given.get("upper")];
    let law = given.without(&["lower", "upper"]).moments()?.and_then(|[mean, std]| Normal::new(mean, std));
    Some(law.and_then(|law| match bounds {
        [None, None] => Ok(Made::Finished(Marginal::of(law))),
        [lower, upper] => law.between(lower, upper).map(Made::Draft),
    }))
}

fn lognormal(given: &Parameters<'_>) -> Option<Making> {
    let moments = match given.exactly(["median", "cv"]) {
        // The mean of a lognormal variable is median √(1 + cv²).
        Some([median, cv]) => {
            positive("median", median).map(|median| [median * cv.hypot(1.0), cv * median * cv.hypot(1.0)])
        }
        None => given.moments()?,
    };
    let law = moments.and_then(|[mean, std]| LogNormal::new(mean, std, given.polynomials));
    Some(law.map(|law| match law.polynomials() {
        Polynomials::Own => Made::Draft(law.of_its_own()),
        Polynomials::Hermite => Made::Finished(Marginal::of(law)),
    }))
}

fn of_beta(given: &Parameters<'_>) -> Option<Making> {
    let [lower, upper] = match [given.get("lower"), given.get("upper")] {
        [None, None] => [0.0, 1.0],
        [lower, upper] => [lower?, upper?],
    };
    let shapes = given.without(&["lower", "upper"]);
    let law = match shapes.exactly(["alpha", "beta"]) {
        Some([alpha, beta_]) => beta(alpha, beta_, [lower, upper]),
        None => shapes.moments()?.and_then(|[mean, std]| beta_with_moments(mean, std, [lower, upper])),
    };
    Some(law.map(Made::Draft))
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
            ("gamma", vec![("mean", 2.0), ("cv", 0.3)]),
            ("beta", vec![("alpha", 2.0), ("beta", 0.5)]),
            ("beta", vec![("mean", 2.0), ("std", 0.5), ("lower", 1.0), ("upper", 4.0)]),
            ("triangular", vec![("lower", 2.0), ("mode", 2.5), ("upper", 4.0)]),
        ] {
            let law = Marginal::named(name, &Parameters::of(parameters)).unwrap();
            assert_eq!(law.name(), name);
            let again = Marginal::named(name, &Parameters::of(law.parameters())).unwrap();
            assert_eq!(again.parameters(), law.parameters());
        }
    }

    #[test]
    fn a_median_is_the_middle() {
        for polynomials in [None, Some(Polynomials::Own), Some(Polynomials::Hermite)] {
            let given = Parameters::of([("median", 2.0), ("cv", 0.3)]).with_polynomials(polynomials);
            let law = Marginal::named("lognormal", &given).unwrap();
            assert!((law.at_centred_probability(0.0) - 2.0).abs() < 1e-13);
            assert_eq!(law.chosen_polynomials(), polynomials);
        }
    }

    #[test]
    fn polynomials_are_chosen_where_there_is_a_choice() {
        let given = Parameters::of([("mean", 2.0), ("std", 0.3)]).with_polynomials(Some(Polynomials::Hermite));
        let gamma = Marginal::named("gamma", &given).unwrap();
        assert_eq!(gamma.family(), crate::polynomials::Family::Hermite);
        let refused = Marginal::named("normal", &given).unwrap_err();
        assert_eq!(refused, MarginalError::NoChoice { law: "normal" });
    }

    #[test]
    fn wrong_parameters_are_refused_with_what_is_expected() {
        let refusal = |name, parameters: &[(&'static str, f64)]| {
            Marginal::named(name, &Parameters::of(parameters.iter().copied())).unwrap_err().to_string()
        };
        assert!(refusal("normal", &[("mean", 1.0)]).contains("mean and std"));
        assert!(refusal("normal", &[("mean", 1.0), ("std", 0.0)]).contains("std is 0"));
        assert!(refusal("normal", &[("mean", 0.0), ("cv", 0.1)]).contains("share of mean, which is 0"));
        for (bounds, expected) in [
            (&[("lower", 9.0)][..], "lower = 9 leaves nothing of the probability, but at least 1e-9 must be left"),
            (&[("lower", 6.0)], "lower = 6 leaves 9.9e-10 of the probability"),
            (&[("upper", -7.0)], "upper = -7 leaves 1.3e-12 of the probability"),
            (&[("lower", 9.0), ("upper", 10.5)], "lower = 9 and upper = 10.5 leave nothing of the probability"),
        ] {
            let given = [&[("mean", 0.0), ("std", 1.0)], bounds].concat();
            assert!(refusal("normal", &given).starts_with(expected), "{}", refusal("normal", &given));
        }
        assert_eq!(refusal("exponential", &[]), "an exponential law has mean; mean is missing");
        assert!(refusal("normal", &[("mean", 0.0), ("std", 1.0), ("lower", 1.0), ("upper", 0.0)]).contains("below"));
        assert!(refusal("lognormal", &[("mean", -1.0), ("std", 0.5)]).contains("mean is -1"));
        assert!(refusal("log-uniform", &[("lower", 0.0), ("upper", 1.0)]).contains("lower is 0"));
        assert!(refusal("weibull", &[("shape", -1.0), ("scale", 1.0)]).contains("shape is -1"));
        assert!(refusal("cauchy", &[]).contains("uniform, normal, lognormal"));
    }

    /// The keys that are given, with their values; those that follow from them only after these.
    #[test]
    fn refusals_speak_of_the_keys_that_are_given() {
        for (name, given, expected) in [
            ("gamma", &[("mean", 1.0), ("std", 10.0)][..], "std is 10, but must be from 0.001 to 4.47 times the mean"),
            ("gamma", &[("mean", 1.0), ("cv", 10.0)], "with mean = 1, cv = 10, std is 10, but must be from 0.001"),
            ("gamma", &[("mean", -1.0), ("std", 1.0)], "mean is -1, but must be a positive number"),
            ("gamma", &[("shape", 1e5), ("scale", 1e305)], "with shape = 100000, scale = 1e305, mean is inf"),
            ("gamma", &[("nominal", f64::NAN), ("cv", 0.1)], "nominal is NaN, but must be a finite number"),
            ("beta", &[("mean", 2.0), ("std", 0.1)], "mean is 2, but must be between lower (0) and upper (1)"),
            ("beta", &[("mean", 0.5), ("std", 0.6)], "std is 0.6, but must be from 0.000354 to 0.477 with this mean"),
            ("beta", &[("mean", 0.5), ("cv", 1.2)], "with mean = 0.5, cv = 1.2, std is 0.6, but must be from"),
            ("lognormal", &[("median", -2.0), ("cv", 0.3)], "median is -2, but must be a positive number"),
            ("lognormal", &[("mean", 1.0), ("std", 1e200)], "std is 1e200, but must be less beside the mean"),
            ("lognormal", &[("median", 1.0), ("cv", 1e-20)], "with median = 1, cv = 1e-20, std is 1e-20, but must be"),
            ("normal", &[("nominal", 3.0), ("cv", 1e-20)], "with nominal = 3, cv = 1e-20, std is "),
            (
                "normal",
                &[("nominal", 0.0), ("cv", 0.1)],
                "cv = 0.1 is a share of nominal, which is 0; give mean and std",
            ),
            ("gumbel", &[("mean", -1.5e308), ("std", 1e308)], "with mean = -1.5e308, std = 1e308, location is -inf"),
            (
                "uniform",
                &[("nominal", 0.0), ("spread", 0.1)],
                "spread = 0.1 is a share of nominal, which is 0; give lower",
            ),
            ("uniform", &[("nominal", f64::INFINITY), ("spread", 0.1)], "nominal is inf"),
            ("uniform", &[("nominal", 1.0), ("spread", 1e-16)], "with nominal = 1, spread = 1e-16,"),
        ] {
            let found = Marginal::named(name, &Parameters::of(given.iter().copied()));
            let found = found.map_err(|error| error.to_string());
            assert!(found.as_ref().is_err_and(|message| message.starts_with(expected)), "{name} {given:?}: {found:?}");
        }
    }

    #[test]
    fn a_spread_of_what_is_negative_is_an_interval() {
        let law = Marginal::named("uniform", &Parameters::of([("nominal", -2.0), ("spread", 0.1)])).unwrap();
        assert_eq!(law.support(), [-2.2, -1.8]);
    }

    #[test]
    fn what_is_not_resolved_is_said_of_parameters_or_of_values() {
        let shape = |law| MarginalError::Shape { law }.to_string();
        assert!(shape("gamma").contains("a gamma law with these parameters") && shape("beta").contains("extremes"));
        assert!(shape("data").contains("these values") && !shape("data").contains("parameters"));
        assert!(shape("discrete").contains("values and") || shape("discrete").contains("their weights"));
    }
}
