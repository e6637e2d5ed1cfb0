//! The space of all uncertain inputs, independent of each other.

use super::description::Description;
use super::marginal::Marginal;
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
pub struct InputSpace(Vec<Input>);

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
        Ok(Self(inputs))
    }

    /// Number of inputs r.
    pub fn dimension(&self) -> usize {
        self.0.len()
    }

    /// The inputs in order.
    pub fn inputs(&self) -> &[Input] {
        &self.0
    }

    /// Names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|input| input.name.as_str())
    }

    /// Whether names and distributions are the same in the same order: then a point means the same in both, whatever
    /// units and labels say.
    pub fn is_same_as(&self, other: &Self) -> bool {
        let is_same = |(a, b): (&Input, &Input)| a.name == b.name && a.marginal == b.marginal;
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(is_same)
    }

    /// The same inputs with these units and labels in turn.
    pub fn described(mut self, descriptions: impl IntoIterator<Item = Description>) -> Self {
        self.0.iter_mut().zip(descriptions).for_each(|(input, description)| input.description = description);
        self
    }

    /// Whether some input has a unit or a label.
    pub fn has_descriptions(&self) -> bool {
        self.0.iter().any(|input| !input.description.is_empty())
    }

    /// Physical coordinates of the standardized point ξ.
    pub fn physical(&self, standardized: &[f64]) -> Vec<f64> {
        self.0.iter().zip(standardized).map(|(input, &xi)| input.marginal.physical(xi)).collect()
    }

    /// Standardized coordinates of a physical point.
    pub fn standardized(&self, physical: &[f64]) -> Vec<f64> {
        self.0.iter().zip(physical).map(|(input, &x)| input.marginal.standardized(x)).collect()
    }

    /// Whether every coordinate lies in its support.
    ///
    /// # Errors
    ///
    /// [`InputError::Outside`] names the first that does not.
    pub fn check(&self, physical: &[f64]) -> Result<(), InputError> {
        for (input, &value) in self.0.iter().zip(physical) {
            if !input.marginal.contains(value) {
                let [lower, upper] = input.marginal.support();
                return Err(InputError::Outside { name: input.name.clone(), value, lower, upper });
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
