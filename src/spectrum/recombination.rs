//! From components to eigenvalues: the part of the spectrum that an evaluator needs.

use nalgebra::Complex;

/// How the components of an output form eigenvalues.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum OutputKind {
    /// Two components, Re λ and Im λ of one mode.
    Eigenvalue,
}

impl OutputKind {
    /// Number of components and number of modes of such an output.
    pub fn shape(self) -> (usize, usize) {
        match self {
            Self::Eigenvalue => (2, 1),
        }
    }
}

/// One real function of the inputs, given by an expansion: value = center + scale × expansion.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Position among all components of a surrogate, from 0.
    pub id: usize,
    /// Name in tables and as a column of results.
    pub name: String,
    /// Added to the scaled expansion.
    pub center: f64,
    /// Multiplies the expansion.
    pub scale: f64,
}

/// A group of components that forms one or more eigenvalues.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// How components become eigenvalues.
    pub kind: OutputKind,
    /// Frequency ranks of the modes it yields, from 1.
    pub modes: Vec<usize>,
    /// Name in tables.
    pub name: String,
    /// Unit of the eigenvalues.
    pub unit: String,
    /// Its components, in the order the kind prescribes.
    pub components: Vec<Component>,
}

impl Output {
    /// Writes the eigenvalues of this output's modes into `eigenvalues`, given the values of all components by id.
    #[inline]
    pub fn recombine(&self, values: &[f64], eigenvalues: &mut Vec<Complex<f64>>) {
        match self.kind {
            OutputKind::Eigenvalue => {
                let value = |k: usize| values[self.components[k].id];
                eigenvalues.push(Complex::new(value(0), value(1)));
            }
        }
    }
}
