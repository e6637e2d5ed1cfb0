//! What of a spectrum is expanded: from a spectrum to the components that polynomials approximate.

use super::modes::{Spectrum, SpectrumError};
use super::recombination::{Component, Output, OutputKind};

/// What the components of a surrogate are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Target {
    /// Re λ and Im λ of each mode, as in the paper.
    Eigenvalues,
}

impl Target {
    /// Name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Eigenvalues => "eigenvalues",
        }
    }

    /// The outputs for the modes with the given ranks. Component ids count from 0 in the order of the outputs.
    pub fn outputs(self, modes: &[usize]) -> Vec<Output> {
        match self {
            Self::Eigenvalues => modes.iter().enumerate().map(|(k, &mode)| eigenvalue(mode, 2 * k)).collect(),
        }
    }

    /// The values of all components at one spectrum, in the order of their ids.
    ///
    /// # Errors
    ///
    /// [`SpectrumError::NoSuchMode`].
    pub fn components(self, modes: &[usize], spectrum: &Spectrum) -> Result<Vec<f64>, SpectrumError> {
        match self {
            Self::Eigenvalues => {
                let mut components = Vec::with_capacity(2 * modes.len());
                for &mode in modes {
                    let lambda = spectrum.mode(mode)?;
                    components.extend([lambda.re, lambda.im]);
                }
                Ok(components)
            }
        }
    }
}

/// Which modes a surrogate carries.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Modes {
    /// All that oscillate.
    All,
    /// Those with these frequency ranks, ascending, from 1.
    Ranks(Vec<usize>),
}

impl Modes {
    /// The ranks, given how many modes oscillate.
    ///
    /// # Errors
    ///
    /// [`SpectrumError::NoSuchMode`] if a rank is beyond `count`.
    pub fn ranks(&self, count: usize) -> Result<Vec<usize>, SpectrumError> {
        match self {
            Self::All if count == 0 => Err(SpectrumError::NoSuchMode { mode: 1, count }),
            Self::All => Ok((1..=count).collect()),
            Self::Ranks(ranks) => match ranks.iter().find(|&&mode| mode > count) {
                Some(&mode) => Err(SpectrumError::NoSuchMode { mode, count }),
                None => Ok(ranks.clone()),
            },
        }
    }
}

fn eigenvalue(mode: usize, first_id: usize) -> Output {
    let component =
        |offset, part| Component { id: first_id + offset, name: format!("{part}_{mode}"), center: 0.0, scale: 1.0 };
    Output {
        kind: OutputKind::Eigenvalue,
        modes: vec![mode],
        name: format!("mode {mode}"),
        unit: "1/s".to_owned(),
        components: vec![component(0, "re"), component(1, "im")],
    }
}
