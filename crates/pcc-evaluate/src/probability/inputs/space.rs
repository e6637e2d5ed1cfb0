//! The space of all uncertain inputs, independent of each other or not.

use super::correlated::{Confinement, Correlated};
use super::description::Description;
use super::marginal::Marginal;
use crate::probability::dependence::GaussianCopula;
use std::collections::HashSet;
use thiserror::Error;

/// One uncertain input.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// Name in studies, files and tables.
    pub name: String,
    /// Its distribution.
    pub marginal: Marginal,
    /// Its unit and label, which are shown and change nothing.
    pub description: Description,
}

impl Input {
    /// An input without unit and label.
    pub fn new(name: impl Into<String>, marginal: Marginal) -> Self {
        Self { name: name.into(), marginal, description: Description::default() }
    }

    /// Its name with its unit, `k_x, N/m`: heads a column.
    pub fn name_with_unit(&self) -> String {
        with_unit(&self.name, &self.description)
    }

    /// What it is with its unit, `contact stiffness, N/m`: the title of an axis. Its name, if it has no label.
    pub fn title(&self) -> String {
        with_unit(self.description.label().unwrap_or(&self.name), &self.description)
    }
}

fn with_unit(text: &str, description: &Description) -> String {
    match description.unit() {
        Some(unit) => format!("{text}, {unit}"),
        None => text.to_owned(),
    }
}

/// Why inputs do not form a space, or a point does not lie in it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum InputError {
    /// There are no inputs.
    #[error("there are no inputs; name at least one")]
    Empty,
    /// A name appears twice.
    #[error("input {name} is given twice")]
    Repeated {
        /// The name.
        name: String,
    },
    /// A dependence of another number of inputs.
    #[error("there are {inputs} inputs, but the dependence is one of {copula}")]
    OtherDimension {
        /// Number of inputs.
        inputs: usize,
        /// Number of inputs of the copula.
        copula: usize,
    },
    /// A coordinate lies outside its distribution's support.
    #[error("{name} = {value:?} lies outside [{lower:?}, {upper:?}]")]
    Outside {
        /// Name of the input.
        name: String,
        /// The coordinate.
        value: f64,
        /// Lower end of the support.
        lower: f64,
        /// Upper end of the support.
        upper: f64,
    },
    /// A coordinate lies between the single values that an input takes.
    #[error("{name} = {value:?} is none of its values; next to it are {:?} and {:?}", nearest[0], nearest[1])]
    BetweenLevels {
        /// Name of the input.
        name: String,
        /// The coordinate.
        value: f64,
        /// The values next to it.
        nearest: [f64; 2],
    },
}

/// Correlations closer than this are one that two machines have computed.
const PORTABLE: f64 = 1e-12;

/// Whether two copulas are one.
fn depend_alike(one: Option<&GaussianCopula>, other: Option<&GaussianCopula>) -> bool {
    let correlations =
        |copula: Option<&GaussianCopula>| copula.map_or(Vec::new(), |copula| copula.correlations().to_vec());
    let (one, other) = (correlations(one), correlations(other));
    one.len() == other.len()
        && one
            .iter()
            .zip(&other)
            .all(|(a, b)| (a.first, a.second) == (b.first, b.second) && (a.value - b.value).abs() <= PORTABLE)
}

/// At least one input, all names distinct. Their order fixes the order of the standardized variables.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::inputs::{Input, InputSpace, Marginal, Uniform};
/// let mu = Input::new("mu", Marginal::Uniform(Uniform::new(0.0, 0.5)?));
/// let space = InputSpace::new(vec![mu])?;
/// assert!(space.check(&[0.25]).is_ok());
/// assert!(space.check(&[0.75]).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct InputSpace {
    inputs: Vec<Input>,
    dependence: Option<Dependence>,
}

/// A copula of which not all inputs are independent, and how points are drawn under it.
#[derive(Debug, Clone, PartialEq)]
struct Dependence {
    copula: GaussianCopula,
    drawing: Correlated,
}

impl InputSpace {
    /// The space of `inputs`.
    ///
    /// # Errors
    ///
    /// [`InputError::Empty`] and [`InputError::Repeated`].
    pub fn new(inputs: Vec<Input>) -> Result<Self, InputError> {
        if inputs.is_empty() {
            return Err(InputError::Empty);
        }
        let mut names = HashSet::new();
        if let Some(input) = inputs.iter().find(|input| !names.insert(input.name.as_str())) {
            return Err(InputError::Repeated { name: input.name.clone() });
        }
        Ok(Self { inputs, dependence: None })
    }

    /// The same inputs, which depend on each other by this copula.
    ///
    /// # Errors
    ///
    /// [`InputError::OtherDimension`] if the copula is of another number of inputs.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::dependence::GaussianCopula;
    /// use pcc_evaluate::probability::inputs::{Input, InputSpace, Marginal, Parameters};
    /// let law = || Marginal::named("normal", &Parameters::of([("mean", 0.0), ("std", 1.0)]));
    /// let copula = GaussianCopula::new(2, [(0, 1, 0.8)])?;
    /// let space = InputSpace::new(vec![Input::new("k", law()?), Input::new("c", law()?)])?.with_dependence(copula)?;
    /// let mut point = [0.9, 0.5];
    /// space.place(&mut point);
    /// assert!((point[1] - 0.8 * point[0]).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_dependence(self, copula: GaussianCopula) -> Result<Self, InputError> {
        if copula.dimension() != self.dimension() {
            return Err(InputError::OtherDimension { inputs: self.dimension(), copula: copula.dimension() });
        }
        let confined = vec![Confinement::NONE; self.dimension()];
        let dependence = match Correlated::new(&copula, &self.inputs, &confined) {
            Ok(drawing) if !copula.members().is_empty() => Some(Dependence { copula, drawing }),
            // Nothing is confined, so that nothing is in conflict.
            Ok(_) | Err(_) => None,
        };
        Ok(Self { dependence, ..self })
    }

    /// How the inputs depend on each other, if some do.
    pub fn dependence(&self) -> Option<&GaussianCopula> {
        self.dependence.as_ref().map(|dependence| &dependence.copula)
    }

    /// The inputs that depend on input number `input`, itself among them; none if it is independent of all others.
    pub fn correlated_with(&self, input: usize) -> &[usize] {
        self.dependence().and_then(|copula| copula.block_of(input)).unwrap_or_default()
    }

    /// Replaces numbers of the open interval (0, 1), one for each input, by the standardized coordinates of the point
    /// that they stand for: a random point, if they are random and independent of each other.
    #[inline]
    pub fn place(&self, units: &mut [f64]) {
        let is_placed = |j: usize| self.dependence.as_ref().is_some_and(|dependence| dependence.drawing.places(j));
        for (j, (unit, input)) in units.iter_mut().zip(&self.inputs).enumerate() {
            if !is_placed(j) {
                *unit = input.marginal.standardized_quantile(*unit);
            }
        }
        if let Some(dependence) = &self.dependence {
            dependence.drawing.place(units.as_chunks_mut::<1>().0);
        }
    }

    /// Number of inputs r.
    pub fn dimension(&self) -> usize {
        self.inputs.len()
    }

    /// The inputs in order.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// Names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.inputs.iter().map(|input| input.name.as_str())
    }

    /// Whether names, distributions and dependence are the same in the same order: then a point means the same in both,
    /// whatever units and labels say.
    pub fn is_same_as(&self, other: &Self) -> bool {
        let is_same = |(a, b): (&Input, &Input)| a.name == b.name && a.marginal == b.marginal;
        self.inputs.len() == other.inputs.len()
            && self.inputs.iter().zip(&other.inputs).all(is_same)
            && depend_alike(self.dependence(), other.dependence())
    }

    /// The same inputs with these units and labels in turn.
    pub fn described(mut self, descriptions: impl IntoIterator<Item = Description>) -> Self {
        self.inputs.iter_mut().zip(descriptions).for_each(|(input, description)| input.description = description);
        self
    }

    /// Whether some input has a unit or a label.
    pub fn has_descriptions(&self) -> bool {
        self.inputs.iter().any(|input| !input.description.is_empty())
    }

    /// Physical coordinates of the standardized point ξ.
    pub fn physical(&self, standardized: &[f64]) -> Vec<f64> {
        self.inputs.iter().zip(standardized).map(|(input, &xi)| input.marginal.physical(xi)).collect()
    }

    /// Standardized coordinates of a physical point.
    pub fn standardized(&self, physical: &[f64]) -> Vec<f64> {
        self.inputs.iter().zip(physical).map(|(input, &x)| input.marginal.standardized(x)).collect()
    }

    /// Standardized coordinates of the point where every input has its median: zeros for uniform and normal laws.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::inputs::{Input, InputSpace, Marginal, Parameters};
    /// let law = Marginal::named("exponential", &Parameters::of([("mean", 3.0)]))?;
    /// let space = InputSpace::new(vec![Input::new("x", law)])?;
    /// assert!((space.physical(&space.middle())[0] - 3.0 * 2f64.ln()).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn middle(&self) -> Vec<f64> {
        self.inputs.iter().map(|input| input.marginal.germ().at(0.0)).collect()
    }

    /// Whether an input has no lower or no upper bound: no number of points sees all of its tail.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::inputs::{Input, InputSpace, Marginal, Parameters};
    /// let law = Marginal::named("exponential", &Parameters::of([("mean", 3.0)]))?;
    /// assert!(InputSpace::new(vec![Input::new("x", law)])?.is_unbounded());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn is_unbounded(&self) -> bool {
        self.inputs.iter().flat_map(|input| input.marginal.support()).any(f64::is_infinite)
    }

    /// Whether every coordinate is a value of its input.
    ///
    /// # Errors
    ///
    /// [`InputError::Outside`] names the first that lies outside its support, [`InputError::BetweenLevels`] the first
    /// that lies between single values.
    pub fn check(&self, physical: &[f64]) -> Result<(), InputError> {
        for (input, &value) in self.inputs.iter().zip(physical) {
            if !input.marginal.contains(value) {
                let [lower, upper] = input.marginal.support();
                return Err(InputError::Outside { name: input.name.clone(), value, lower, upper });
            }
            if let Some(nearest) = input.marginal.levels_around(value) {
                return Err(InputError::BetweenLevels { name: input.name.clone(), value, nearest });
            }
        }
        Ok(())
    }

    /// A point as text, `mu = 0.25, k_p = 16000000`: for messages.
    pub fn describe(&self, physical: &[f64]) -> String {
        let named: Vec<_> = self.names().zip(physical).map(|(name, value)| format!("{name} = {value:?}")).collect();
        named.join(", ")
    }
}
