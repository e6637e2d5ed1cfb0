//! The decisions a study records.

use crate::fitting::fit::FitMethod;
use crate::mechanics::spectrum::{Modes, Target};
use pcc_evaluate::components::{Margin, Verdict};

/// What of the spectrum is expanded.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumSettings {
    /// What the components are.
    pub target: Target,
    /// Which modes.
    pub modes: Modes,
    /// Number of eigenvalues that are rigid-body motion, if the study says it.
    pub rigid_body_modes: Option<usize>,
    /// How far eigenvalues must stay from instability.
    pub margin: Margin,
    /// Relative error of the model's eigenvalues, as a share of |λ|; 0 if it is not known.
    pub noise: f64,
}

/// How design points are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DesignKind {
    /// Nested Latin hypercube levels.
    NestedLhs,
    /// The same with points spread apart.
    NestedMaximinLhs,
    /// The nodes of a tensor Gauss rule.
    TensorGauss,
}

impl DesignKind {
    /// Name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Self::NestedLhs => "nested-lhs",
            Self::NestedMaximinLhs => "nested-maximin-lhs",
            Self::TensorGauss => "tensor-gauss",
        }
    }
}

/// The experimental design and how it grows.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignSettings {
    /// How points are chosen.
    pub kind: DesignKind,
    /// Number of points of the first level, at least 2; for methods that fix it, of the whole design, or of each
    /// element.
    pub initial: usize,
    /// Points added by each enrichment, at least 1.
    pub step: usize,
    /// Number of points the design never exceeds, at least `initial`.
    pub maximum: usize,
}

impl DesignSettings {
    /// The size of the level after `size`, or `None` at the maximum.
    pub fn next_size(&self, size: usize) -> Option<usize> {
        (size < self.maximum).then(|| size.saturating_add(self.step).min(self.maximum))
    }
}

/// How expansions are fitted, and when the design is large enough.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSettings {
    /// Fitting method with its settings.
    pub method: FitMethod,
    /// Estimated error of the share p of points that are not unstable at which the design is large enough, as a
    /// fraction of √(p (1 − p)), in (0, 1\]; without it the fits of the components alone decide.
    pub proportion_tolerance: Option<f64>,
    /// Whether derivatives of the components enter the fit.
    pub derivatives: Derivatives,
    /// Where runs are made beside those of the design.
    pub enrich: Enrich,
    /// Verdicts whose shares the tolerance is of as well, beside those of stable and unstable points, in the order of
    /// [`NAMED_SHARES`].
    pub shares: Vec<Verdict>,
}

/// Verdicts whose shares a study can name.
pub const NAMED_SHARES: [Verdict; 3] = [Verdict::Marginal, Verdict::Flutter, Verdict::Divergence];

/// Where runs are made beside those of the design.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Enrich {
    /// Near the boundary of stability, where the rarer side is rare or has not been seen.
    #[default]
    Decision,
    /// Nowhere.
    None,
}

impl Enrich {
    /// Its word in a study.
    pub fn name(self) -> &'static str {
        match self {
            Self::Decision => "decision",
            Self::None => "none",
        }
    }
}

impl FitSettings {
    /// Whether derivatives enter the fit, if there are some.
    pub(super) fn use_derivatives(&self, target: Target, has_derivatives: bool) -> bool {
        self.method.can_use_derivatives() && self.derivatives.are_used(target, has_derivatives)
    }
}

/// Whether derivatives of the components by the inputs enter a fit beside the values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivatives {
    /// For invariants, if the model or given runs have them.
    Auto,
    /// Yes; a model without them is an error.
    Always,
    /// No.
    Never,
}

impl Derivatives {
    pub(super) fn are_used(self, target: Target, has_derivatives: bool) -> bool {
        match self {
            Self::Auto => target == Target::Invariants && has_derivatives,
            Self::Always => true,
            Self::Never => false,
        }
    }

    /// The value in study files.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Auto => "\"auto\"",
            Self::Always => "true",
            Self::Never => "false",
        }
    }
}
