//! Uncertain inputs and their dependence.

use schemars::JsonSchema;

/// An uncertain parameter: a law, its parameters, and how the input is shown.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(super) struct Input {
    /// How its values are distributed.
    distribution: Distribution,
    /// Lowest value. Of: uniform, log-uniform, beta (0 unless given), triangular; normal, which it cuts off.
    lower: Option<f64>,
    /// Highest value. Of: uniform, log-uniform, beta (1 unless given), triangular; normal, which it cuts off.
    upper: Option<f64>,
    /// Value in the middle. Of: uniform, with `spread`; normal, lognormal, gamma, with `cv`: the mean.
    nominal: Option<f64>,
    /// Half the range, relative to `nominal`: 0.05, or "5%", means from 0.95 to 1.05 times nominal. Of: uniform.
    spread: Option<Relative>,
    /// Mean; of a normal law before it is cut off. Of: normal, lognormal, gamma, beta, exponential, gumbel.
    mean: Option<f64>,
    /// Standard deviation; of a normal law before it is cut off. Of: normal, lognormal, gamma, beta, gumbel.
    #[schemars(extend("exclusiveMinimum" = 0))]
    std: Option<f64>,
    /// Standard deviation relative to the mean: 0.05, or "5%". Of: normal, lognormal, gamma, beta.
    cv: Option<Relative>,
    /// Value that half of all values are below. Of: lognormal, with `cv`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    median: Option<f64>,
    /// Exponent of the law. Of: weibull, gamma.
    #[schemars(extend("exclusiveMinimum" = 0))]
    shape: Option<f64>,
    /// Width of the law. Of: weibull, gumbel, gamma.
    #[schemars(extend("exclusiveMinimum" = 0))]
    scale: Option<f64>,
    /// Most frequent value. Of: gumbel.
    location: Option<f64>,
    /// Exponent at the lower end. Of: beta.
    #[schemars(extend("exclusiveMinimum" = 0))]
    alpha: Option<f64>,
    /// Exponent at the upper end. Of: beta.
    #[schemars(extend("exclusiveMinimum" = 0))]
    beta: Option<f64>,
    /// Likeliest value. Of: triangular.
    mode: Option<f64>,
    /// The values that it takes. Of: discrete.
    #[schemars(length(min = 2))]
    values: Option<Vec<f64>>,
    /// How often it takes each, relative to the others. Default: equally often. Of: discrete.
    weights: Option<Vec<f64>>,
    /// A table of measured values (CSV), in the folder of the study. Of: data.
    file: Option<String>,
    /// The column of the table. Default: its only one. Of: data.
    column: Option<String>,
    /// Whether every measured value stands for others near it. Default: kernel. Of: data.
    smoothing: Option<Smoothing>,
    /// Which polynomials expansions have. Default: own, but for inputs over orders of magnitude. Of: lognormal, gamma,
    /// beta, triangular, exponential, weibull, gumbel; normal where it is cut off.
    polynomials: Option<Polynomials>,
    /// Unit of its values, shown beside them.
    unit: Option<String>,
    /// What it is, shown beside its name.
    label: Option<String>,
}

#[derive(JsonSchema)]
#[schemars(untagged)]
enum Relative {
    /// A number like 0.05.
    Number(f64),
    /// A text in percent like "5%".
    Percent(String),
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum Smoothing {
    /// Normal kernels, whose width follows from the number of values; mean and standard deviation stay.
    Kernel,
    /// Nothing but the measured values is drawn.
    None,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum Polynomials {
    /// Orthonormal under the law itself.
    Own,
    /// Of a standard normal variable of which the input is a function.
    Hermite,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum Distribution {
    /// All values of the range are equally likely: lower and upper, or nominal and spread.
    Uniform,
    /// Normal: mean and std, mean and cv, or nominal and cv. With lower or upper or both it is cut off there.
    Normal,
    /// The logarithm is normal: mean and std, mean and cv, or median and cv, of the variable itself.
    #[schemars(rename = "lognormal")]
    LogNormal,
    /// Gamma, from 0: mean and std, mean and cv, or shape and scale.
    Gamma,
    /// Beta: alpha and beta, or mean and std; between lower and upper, which are 0 and 1 unless given.
    Beta,
    /// Rises to its mode and falls: lower, mode and upper.
    Triangular,
    /// The logarithm is uniform: lower and upper.
    LogUniform,
    /// Exponential, from 0: mean.
    Exponential,
    /// Weibull, from 0: shape and scale.
    Weibull,
    /// Gumbel, of largest values: location and scale, or mean and std.
    Gumbel,
    /// Single values: values, and weights if they are not equally frequent.
    Discrete,
    /// Measured values: file, and column if the file has several. Lower or upper or both cut it off.
    Data,
}

/// A Gaussian copula, by correlations of pairs of inputs: `spearman` or `pearson`, one of them. Pairs that are not
/// listed are independent.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(super) struct Dependence {
    /// The kind of dependence.
    kind: DependenceKind,
    /// Correlations of ranks: two inputs and a number between -1 and 1 each.
    spearman: Option<Vec<(String, String, f64)>>,
    /// Correlations of values: two inputs and a number between -1 and 1 each.
    pearson: Option<Vec<(String, String, f64)>>,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
enum DependenceKind {
    /// Normal scores of the inputs are jointly normal.
    GaussianCopula,
}
