//! The sections of format 1 as they are written: data only, nothing checked but types.
//!
//! bincode is positional, so a published struct never gains, loses or moves a field, and enums grow at the end only.
//! New features are new sections, new section versions or new kinds.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::certificates::AnyCertificates;
use super::v2::{AnyOutputs, Coverage, Descriptions, Domain, LeftOut, Verdict};

/// A whole surrogate file: the sections by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "schema", schemars(title = "pcc surrogate, format 1"))]
pub struct Document {
    /// Version of the format.
    pub format: FormatVersion,
    /// Section 1.
    pub meta: Meta,
    /// Section 2.
    pub inputs: Inputs,
    /// Section 3.
    pub outputs: AnyOutputs,
    /// Section 4.
    pub elements: Elements,
    /// Section 5.
    pub expansions: Expansions,
    /// Section 6.
    pub training: Training,
    /// Section 7.
    pub decision: Decision,
    /// Section 8.
    pub self_test: SelfTest,
    /// Section 9, absent if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certificates: Option<AnyCertificates>,
    /// Section 10, absent if stability is judged by the sign of Re λ alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// Section 11, if the model did not answer everywhere. Since format 1.3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coverage: Option<Coverage>,
    /// Section 12, if an input has a unit or a label. Since format 1.3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub descriptions: Option<Descriptions>,
    /// Section 13, if some standardized variable is not uniform. Since format 1.3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub domain: Option<Domain>,
    /// Section 14, if runs were left out one by one. Since format 1.3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<LeftOut>,
}

/// Version of the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FormatVersion {
    /// Changes when older readers could misunderstand a file.
    pub major: u16,
    /// Changes when sections or kinds are added.
    pub minor: u16,
}

/// Section 1: where the surrogate comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Meta {
    /// Version of pcc that built it.
    pub tool_version: String,
    /// Name of the study.
    pub study_name: String,
    /// Hexadecimal SHA-256 of model, constants, inputs and spectrum in canonical form.
    pub problem_hash: String,
    /// Hexadecimal SHA-256 of the study with its defaults; informative.
    pub study_hash: String,
    /// Hexadecimal SHA-256 of sections 2 to 8, and 10 if there is one, in binary form, headers included.
    pub content_id: String,
}

/// Section 2: the uncertain inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Inputs {
    /// One per standardized variable, in order.
    pub inputs: Vec<Input>,
    /// How they depend on each other.
    pub dependence: Dependence,
}

/// One input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Name.
    pub name: String,
    /// Distribution of the physical variable x.
    pub distribution: Distribution,
    /// Map from x to the standardized variable ξ.
    pub transform: Transform,
    /// Family of polynomials in ξ.
    pub family: Family,
    /// Its recurrence, to the highest degree any expansion uses.
    pub recurrence: Recurrence,
    /// Bounds of x, if it is bounded.
    pub bounds: Option<Bounds>,
}

/// Distribution of a physical variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Distribution {
    /// Uniform on [lower, upper].
    Uniform {
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// A law by its name and parameters (since minor version 3).
    Law {
        /// Its name in study files.
        name: String,
        /// Its parameters, with their names in study files.
        parameters: Vec<Parameter>,
    },
}

/// A parameter of a law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Its name in study files.
    pub name: String,
    /// Its value.
    pub value: f64,
}

/// Map from the physical to the standardized variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Transform {
    /// ξ = (x − center)/half_width.
    Affine {
        /// Physical value at ξ = 0.
        center: f64,
        /// Physical distance from ξ = 0 to ξ = 1.
        half_width: f64,
    },
    /// x = exp(center + half_width ξ) (since minor version 3).
    Exponential {
        /// ln x at ξ = 0.
        center: f64,
        /// Change of ln x from ξ = 0 to ξ = 1.
        half_width: f64,
    },
    /// x = origin + scale q(z), z being a standard normal variable, in pieces (since minor version 3). Where the family
    /// is Hermite's, ξ = z; else ξ = q.
    Pieces {
        /// Physical value at q = 0.
        origin: f64,
        /// Physical distance from q = 0 to q = 1.
        scale: f64,
        /// Where pieces begin and end, from −8.5 to 8.5; beyond, the ends count.
        breaks: Vec<f64>,
        /// Of each piece c_0, …, c_12 in q = Σ c_k t^k, where t goes from −1 to 1 along the piece.
        coefficients: Vec<Vec<f64>>,
    },
}

/// Family of orthonormal polynomials.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Orthonormal under the uniform density on [−1, 1].
    Legendre,
    /// Orthonormal under the standard normal density (since minor version 3).
    Hermite,
    /// Orthonormal under a gamma or exponential law (since minor version 3).
    Laguerre,
    /// Orthonormal under a beta law (since minor version 3).
    Jacobi,
    /// Orthonormal under another law, whose they are (since minor version 3).
    Own,
}

/// φ_0 = 1, b_{k+1} φ_{k+1} = (ξ − a_k) φ_k − b_k φ_{k−1}.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Recurrence {
    /// a_0, a_1, ….
    pub diagonal: Vec<f64>,
    /// b_1, b_2, ….
    pub off_diagonal: Vec<f64>,
}

/// An interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

/// Dependence of the inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Dependence {
    /// All inputs are independent.
    Independent,
    /// A Gaussian copula (since minor version 3).
    GaussianCopula {
        /// The correlations of normal scores that are not zero, by first, then second input.
        correlations: Vec<Correlation>,
    },
}

/// The correlation of the normal scores Φ⁻¹(F(x)) of two inputs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Correlation {
    /// Position of the one that comes first, from 0.
    pub first: u32,
    /// Position of the other.
    pub second: u32,
    /// Between −1 and 1.
    pub value: f64,
}

/// Section 3: what the components form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Outputs {
    /// The outputs in order.
    pub outputs: Vec<Output>,
}

/// A group of components.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// How its components are combined.
    pub kind: OutputKind,
    /// Frequency ranks of the modes it yields, from 1; empty for a scalar.
    pub modes: Vec<u32>,
    /// Name.
    pub name: String,
    /// Unit of what it yields.
    pub unit: String,
    /// Its components in the order that the kind prescribes.
    pub components: Vec<Component>,
}

/// How components are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum OutputKind {
    /// Two components: Re λ and Im λ of one mode.
    Eigenvalue,
    /// 2k components for k modes: Re s, Im s of the mean s of the eigenvalues, then Re and Im of the coefficients
    /// c_{k−2}, …, c_0 of z^k + c_{k−2} z^{k−2} + … + c_0, whose roots are λ − s.
    Cluster,
    /// One component: the quantity itself.
    Scalar,
}

/// One expanded quantity: value = center + scale × expansion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Component {
    /// Id, from 0, unique among all outputs.
    pub id: u32,
    /// Name.
    pub name: String,
    /// Added to the scaled expansion.
    pub center: f64,
    /// Multiplies the expansion.
    pub scale: f64,
}

/// Section 4: the parts of the input space, each with its own expansions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Elements {
    /// The elements; exactly one for a global expansion.
    pub elements: Vec<Element>,
    /// How to find the element of a point; the first split is the root. Empty for one element.
    pub splits: Vec<Split>,
}

/// A box in standardized coordinates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Element {
    /// Probability of the element.
    pub weight: f64,
    /// Per input, the side of the box and its map to the local variable.
    pub sides: Vec<Side>,
}

/// One side of an element: local variable = (ξ − center)/half_width.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Side {
    /// Bounds of ξ; absent where the standardized variable is unbounded.
    pub bounds: Option<Bounds>,
    /// Centre of the local variable.
    pub center: f64,
    /// Half width of the local variable.
    pub half_width: f64,
}

/// A node of the split tree: points with ξ_input < at go below, others above.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// Position of the input, from 0.
    pub input: u32,
    /// Where it is split.
    pub at: f64,
    /// What lies below.
    pub below: Branch,
    /// What lies above.
    pub above: Branch,
}

/// A child in the split tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Branch {
    /// An element, by its position.
    Element(u32),
    /// A further split, by its position.
    Split(u32),
}

/// Section 5: index sets and coefficients.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Expansions {
    /// Pool of index sets: each a list of multi-indices, by total degree, then larger degrees of earlier inputs first.
    pub index_sets: Vec<Vec<Vec<u16>>>,
    /// One expansion per element and component.
    pub expansions: Vec<Expansion>,
}

/// Σ c_α ψ_α with ψ_α = Π φ_{α_j}(ζ_j) in the local variables ζ of the element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Expansion {
    /// Position of the element.
    pub element: u32,
    /// Id of the component.
    pub component: u32,
    /// Position in the pool of index sets.
    pub index_set: u32,
    /// c_α, one per multi-index.
    pub coefficients: Vec<f64>,
    /// R² on the design; with several elements errors are relative to the variance over all of them.
    pub r2: Option<f64>,
    /// Leave-one-out S².
    pub s2: Option<f64>,
    /// S² with the correction for small designs.
    pub corrected_s2: Option<f64>,
    /// What the leave-one-out errors leave out.
    pub leave_out: LeaveOut,
    /// Degree at which the search ended.
    pub degree: u16,
    /// Why the search ended.
    pub stop: Stop,
}

/// What a leave-one-out error leaves out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LeaveOut {
    /// One value.
    Row,
    /// One model run with all it answered.
    Run,
}

/// Why the search for an expansion ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// S² reached its target.
    Accurate,
    /// The highest degree was reached.
    HighestDegree,
    /// The design could not grow any further.
    DesignExhausted,
    /// The values do not vary.
    Constant,
    /// The degree was given: nothing was searched. Since format 1.2.
    GivenDegree,
    /// No element asks to be divided any more. Since format 1.2.
    Settled,
    /// Elements that ask to be divided are left. Since format 1.2.
    Limited,
    /// The error no longer fell as the design grew. Since format 1.3.
    Stalled,
}

/// Section 6: how the surrogate was trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Training {
    /// Fitting method.
    pub method: String,
    /// Its settings.
    pub settings: Vec<Setting>,
    /// Kind of experimental design.
    pub design: String,
    /// Seed of the design.
    pub seed: u64,
    /// Number of points of each level.
    pub levels: Vec<u64>,
    /// Numbers of model runs.
    pub counts: Counts,
}

/// One setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// Its key in the study.
    pub key: String,
    /// Its value.
    pub value: SettingValue,
}

/// Value of a setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SettingValue {
    /// A whole number.
    Integer(u64),
    /// A real number.
    Number(f64),
    /// A word.
    Text(String),
    /// Yes or no.
    Flag(bool),
}

/// Numbers of model runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Counts {
    /// Runs whose values entered the fit.
    pub values: u64,
    /// Runs whose derivatives entered the fit.
    pub gradients: u64,
    /// Runs that failed.
    pub failed: u64,
    /// Runs of the final mesh of elements.
    pub final_mesh: u64,
    /// Every run the build spent.
    pub direct_computations: u64,
}

/// Section 7: what is known of the error where stability is decided.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Decision {
    /// Quantiles of max Re λ of the model minus its leave-one-out prediction, in 1/s; empty if undetermined.
    pub max_re_residuals: Vec<Quantile>,
    /// Estimated relative error of the stability proportion, as a fraction.
    pub proportion_error: Option<f64>,
}

/// A quantile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Quantile {
    /// Probability to be undercut.
    pub level: f64,
    /// Its value.
    pub value: f64,
}

/// Section 8: points with the values an evaluator must find.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SelfTest {
    /// Points in physical coordinates.
    pub points: Vec<Vec<f64>>,
    /// Per point, all components by id.
    pub components: Vec<Vec<f64>>,
    /// Per point, max Re λ over all modes, in 1/s.
    pub max_re: Vec<f64>,
    /// Largest difference allowed, relative to max(1, |expected|).
    pub tolerance: f64,
}

/// Section 9: verified bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Certificates {
    /// In the order in which they were added; never empty.
    pub certificates: Vec<Certificate>,
}

/// A verified bound on the stability proportion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// Seed of its points.
    pub seed: u64,
    /// Number of fresh model runs.
    pub samples: u64,
    /// How the points were drawn.
    pub scheme: String,
    /// Points that the surrogate calls stable and the model unstable.
    pub falsely_stable: u64,
    /// Points that the surrogate calls unstable and the model stable.
    pub falsely_unstable: u64,
    /// Confidence level.
    pub level: f64,
    /// Lower end of the bound.
    pub lower: f64,
    /// Upper end of the bound.
    pub upper: f64,
    /// Problem hash of the model that was run.
    pub problem_hash: String,
}
