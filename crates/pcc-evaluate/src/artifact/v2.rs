//! Section 3 in version 2: outputs with eigenvalues that are real, or can become so. Section 10: what else there is to
//! know of the verdict on stability. Section 11: where the model did not answer. Section 12: units and labels of the
//! inputs. Section 13: the box that the model runs spanned.
//!
//! Files are written with version 1 of a section wherever that can say it. The rules of [`super::v1`] hold: a
//! published body never changes.

use super::v1;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

/// What the components form, in the version that says it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum AnyOutputs {
    /// Modes that always oscillate.
    V1(v1::Outputs),
    /// Others beside them.
    V2(Outputs),
}

/// Section 10: what the verdict on stability rests on beside the sign of Re λ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Verdict {
    /// Number of eigenvalues of the model that are rigid-body motion: zero at every point, and left out of the verdict.
    pub rigid_body_modes: u32,
    /// Excesses up to this, in 1/s, are zero: the point is marginal.
    pub tolerance: f64,
    /// How far eigenvalues must stay from instability.
    pub margin: Margin,
    /// The band of frequencies by which modes were chosen.
    pub band: Option<Band>,
    /// Whether the model is undamped and symmetric. Eigenvalues are then real or imaginary: of one that is neither, the
    /// part with the smaller modulus is zero, Re λ if both are equal.
    pub is_self_adjoint: bool,
}

/// How far eigenvalues must stay from instability: the excess of λ is to be negative.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Margin {
    /// What is added to Re λ.
    pub kind: MarginKind,
    /// How much.
    pub value: f64,
}

/// What is added to Re λ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum MarginKind {
    /// The value, in 1/s.
    GrowthRate,
    /// The value times |λ|.
    DampingRatio,
}

/// A band of frequencies in the middle of the inputs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Lower end, in Hz.
    pub lower: f64,
    /// Upper end, in Hz.
    pub upper: f64,
    /// Number of modes of the model, inside and outside: they have the numbers from 1.
    pub modes: u32,
    /// Number of its real eigenvalues that belong to no mode.
    pub reals: u32,
}

/// Section 11, optional and outside the content id: runs of the model, in standardized variables, where some failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Coverage {
    /// Points that answered.
    pub answered: Vec<Vec<f64>>,
    /// Points that failed.
    pub unanswered: Vec<Vec<f64>>,
}

/// Section 12, optional and outside the content id: how the inputs are shown, in their order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Descriptions {
    /// One per input, in the order of section 2.
    pub inputs: Vec<Description>,
}

/// How an input is shown.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// Unit of its values: at most 40 characters.
    pub unit: Option<String>,
    /// What it is: at most 80 characters.
    pub label: Option<String>,
}

/// Section 13, optional and outside the content id: the box that the model runs spanned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Domain {
    /// One per input, in the order of section 2; null where the standardized variable is uniform and runs fill it.
    pub inputs: Vec<Option<TrainedInterval>>,
}

/// The smallest and the largest value of a standardized variable at a model run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TrainedInterval {
    /// The smallest.
    pub lower: f64,
    /// The largest.
    pub upper: f64,
}

/// Section 14, optional and outside the content id: residuals of the components at runs of the design, each by the fit
/// without the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LeftOut {
    /// One list per run, 200 at most: value less prediction of each component by id, in its unit.
    pub runs: Vec<Vec<f64>>,
}

/// Section 3, version 2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Outputs2"))]
#[serde(deny_unknown_fields)]
pub struct Outputs {
    /// The outputs in order.
    pub outputs: Vec<Output>,
}

/// A group of components.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Output2"))]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// How its components are combined.
    pub kind: OutputKind,
    /// Numbers of the modes it yields, from 1.
    pub modes: Vec<u32>,
    /// Numbers of the real eigenvalues it yields that belong to no mode, from 1.
    pub reals: Vec<u32>,
    /// Name.
    pub name: String,
    /// Unit of what it yields.
    pub unit: String,
    /// Its components in the order that the kind prescribes.
    pub components: Vec<v1::Component>,
}

/// How components are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "OutputKind2"))]
#[serde(rename_all = "snake_case")]
pub enum OutputKind {
    /// As in version 1.
    Eigenvalue,
    /// As in version 1.
    Cluster,
    /// As in version 1.
    Scalar,
    /// n components: the elementary symmetric functions e₁, …, eₙ of n eigenvalues that are closed under conjugation,
    /// the roots of λⁿ − e₁ λⁿ⁻¹ + e₂ λⁿ⁻² − …; two for each mode and one for each real eigenvalue. Roots with Im λ > 0
    /// belong to the modes in turn, by |λ|, of equal ones by Im λ, then Re λ; their conjugates are the modes' second
    /// eigenvalues. The real roots, the largest first, give two to each mode that is left, and then one to each real
    /// eigenvalue in turn. Both roots of pairs beyond the number of modes stand among the real ones, by Re λ, of equal
    /// ones that with Im λ > 0 first.
    Closed,
}

/// An output as JSON has it, in either version.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EitherOutput {
    kind: OutputKind,
    modes: Vec<u32>,
    reals: Option<Vec<u32>>,
    name: String,
    unit: String,
    components: Vec<v1::Component>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EitherOutputs {
    outputs: Vec<EitherOutput>,
}

impl<'de> Deserialize<'de> for AnyOutputs {
    /// Version 2 is told by `reals`, which all outputs have there.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let EitherOutputs { outputs } = EitherOutputs::deserialize(deserializer)?;
        if outputs.iter().all(|output| output.reals.is_none()) {
            let outputs: Option<Vec<v1::Output>> = outputs.into_iter().map(EitherOutput::into_v1).collect();
            let outputs = outputs.ok_or_else(|| serde::de::Error::missing_field("reals"))?;
            return Ok(Self::V1(v1::Outputs { outputs }));
        }
        let outputs: Option<Vec<Output>> = outputs.into_iter().map(EitherOutput::into_v2).collect();
        Ok(Self::V2(Outputs { outputs: outputs.ok_or_else(|| serde::de::Error::missing_field("reals"))? }))
    }
}

impl EitherOutput {
    fn into_v1(self) -> Option<v1::Output> {
        let Self { kind, modes, name, unit, components, .. } = self;
        let kind = match kind {
            OutputKind::Eigenvalue => v1::OutputKind::Eigenvalue,
            OutputKind::Cluster => v1::OutputKind::Cluster,
            OutputKind::Scalar => v1::OutputKind::Scalar,
            OutputKind::Closed => return None,
        };
        Some(v1::Output { kind, modes, name, unit, components })
    }

    fn into_v2(self) -> Option<Output> {
        let Self { kind, modes, reals, name, unit, components } = self;
        Some(Output { kind, modes, reals: reals?, name, unit, components })
    }
}

impl From<v1::Output> for Output {
    fn from(output: v1::Output) -> Self {
        let v1::Output { kind, modes, name, unit, components } = output;
        let kind = match kind {
            v1::OutputKind::Eigenvalue => OutputKind::Eigenvalue,
            v1::OutputKind::Cluster => OutputKind::Cluster,
            v1::OutputKind::Scalar => OutputKind::Scalar,
        };
        Self { kind, modes, reals: Vec::new(), name, unit, components }
    }
}

impl AnyOutputs {
    /// All outputs in the words of version 2.
    pub(super) fn into_latest(self) -> Vec<Output> {
        match self {
            Self::V1(v1::Outputs { outputs }) => outputs.into_iter().map(Output::from).collect(),
            Self::V2(Outputs { outputs }) => outputs,
        }
    }

    /// All components.
    pub(super) fn components(&self) -> Box<dyn Iterator<Item = &v1::Component> + '_> {
        match self {
            Self::V1(v1::Outputs { outputs }) => Box::new(outputs.iter().flat_map(|output| &output.components)),
            Self::V2(Outputs { outputs }) => Box::new(outputs.iter().flat_map(|output| &output.components)),
        }
    }
}
