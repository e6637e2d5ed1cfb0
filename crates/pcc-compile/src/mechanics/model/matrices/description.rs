//! Matrices as a study writes them: terms of numbers and expressions, not yet compiled.

use super::matrix_market::CoordinateMatrix;

/// What a matrix does in M ü + (C + G) u̇ + (K + N) u = 0 or in ẋ = A x.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// M.
    Mass,
    /// C.
    Damping,
    /// K.
    Stiffness,
    /// G, beside C: gyroscopic forces.
    Gyroscopic,
    /// N, beside K: circulatory forces, as of friction.
    Circulatory,
    /// A, alone.
    State,
}

impl Role {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Mass, Self::Damping, Self::Stiffness, Self::Gyroscopic, Self::Circulatory, Self::State];

    /// Name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mass => "M",
            Self::Damping => "C",
            Self::Stiffness => "K",
            Self::Gyroscopic => "G",
            Self::Circulatory => "N",
            Self::State => "A",
        }
    }
}

/// A number, or an expression of inputs, constants and helpers.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// A number.
    Number(f64),
    /// An expression.
    Expression(String),
}

/// Which entries follow from those that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// None.
    General,
    /// Those above the diagonal are those below it.
    Symmetric,
    /// Those above the diagonal are the negative of those below it; the diagonal is zero.
    SkewSymmetric,
}

impl Form {
    /// Name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Self::General => "general",
            Self::Symmetric => "symmetric",
            Self::SkewSymmetric => "skew-symmetric",
        }
    }

    /// The factor of entry (j, i) if entry (i, j) is written, if it follows.
    pub(super) fn mirror(self) -> Option<f64> {
        match self {
            Self::General => None,
            Self::Symmetric => Some(1.0),
            Self::SkewSymmetric => Some(-1.0),
        }
    }
}

/// How the entries of a term are written.
#[derive(Debug, Clone, PartialEq)]
pub enum Layout {
    /// Row by row; of symmetric and skew-symmetric terms the lower triangle, row i with i entries.
    Rows(Vec<Vec<Entry>>),
    /// The diagonal of a diagonal matrix.
    Diagonal(Vec<Entry>),
    /// Entries with their rows and columns, from 1; all others are zero.
    Entries {
        /// Number of rows and columns.
        size: usize,
        /// Row, column, entry.
        list: Vec<(usize, usize, Entry)>,
    },
    /// Numbers from a Matrix Market file.
    File {
        /// The file, as the study names it.
        name: String,
        /// What is in it.
        matrix: CoordinateMatrix,
    },
}

/// One term of a matrix: factor × entries.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Multiplies all entries; 1 if there is none.
    pub factor: Option<Entry>,
    /// Which entries follow.
    pub form: Form,
    /// The entries.
    pub layout: Layout,
}

/// A matrix: the sum of its terms, at least one.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// What it does.
    pub role: Role,
    /// The terms.
    pub terms: Vec<Term>,
}

/// A model by matrices.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Constants by name, sorted.
    pub constants: Vec<(String, f64)>,
    /// Helpers in the order of the study: each may use those before it.
    pub helpers: Vec<(String, String)>,
    /// The matrices, in the order of [`Role::ALL`].
    pub matrices: Vec<Matrix>,
}
