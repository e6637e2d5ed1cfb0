//! What a surrogate records beside its coefficients.

use crate::components::{Margin, Top, beyond_rounding, spectral_abscissa};
use crate::polynomials::IndexSet;
use num_complex::Complex;

/// Where a surrogate comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// Version of pcc that built it.
    pub tool_version: String,
    /// Name of the study.
    pub study_name: String,
    /// `pcc_compile::study::Study::problem_hash`.
    pub problem_hash: String,
    /// `pcc_compile::study::Study::study_hash`.
    pub study_hash: String,
}

/// A polynomial chaos expansion Σ_α c_α ψ_α of one component in one element, in its local variables. Errors are
/// relative to the variance over all elements, so that their mean with the elements' weights is that of the whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Expansion {
    /// A, in canonical order.
    pub indices: IndexSet,
    /// c_α, one per index.
    pub coefficients: Vec<f64>,
    /// R² on the design.
    pub r2: Option<f64>,
    /// Leave-one-out S².
    pub s2: Option<f64>,
    /// S² with the correction for small designs.
    pub corrected_s2: Option<f64>,
    /// What the leave-one-out errors leave out.
    pub leave_out: LeaveOut,
    /// Degree p at which the search ended.
    pub degree: u16,
    /// Why the search ended.
    pub stop: StopReason,
}

/// What a leave-one-out error leaves out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LeaveOut {
    /// One value.
    Row,
    /// One model run with all it answered.
    Run,
}

/// Why the search for an expansion ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StopReason {
    /// S² reached its target.
    Accurate,
    /// The highest degree was reached.
    HighestDegree,
    /// The design could not grow any further.
    DesignExhausted,
    /// The error no longer falls as the design grows: what is left is noise, or detail beyond designs of this size.
    Stalled,
    /// The values do not vary: the mean is exact.
    Constant,
    /// The degree was given: nothing was searched.
    GivenDegree,
    /// No element asks to be divided any more.
    Settled,
    /// Elements that ask to be divided are left.
    Limited,
}

impl StopReason {
    /// In words, for tables.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Accurate => "accurate",
            Self::HighestDegree => "highest degree",
            Self::DesignExhausted => "design exhausted",
            Self::Stalled => "stalled",
            Self::Constant => "constant",
            Self::GivenDegree => "given degree",
            Self::Settled => "elements settled",
            Self::Limited => "limit on elements",
        }
    }
}

/// How a surrogate was trained.
#[derive(Debug, Clone, PartialEq)]
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
    /// What was computed.
    pub counts: Counts,
}

/// One setting of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Its key in the study.
    pub key: String,
    /// Its value.
    pub value: SettingValue,
}

/// The value of a setting.
#[derive(Debug, Clone, PartialEq)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
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

/// What the verdict on stability rests on beside the sign of Re λ. By default nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VerdictBasis {
    /// Number of eigenvalues of the model that are rigid-body motion: zero at every point, and left out of the verdict.
    pub rigid_body_modes: usize,
    /// How far eigenvalues must stay from instability.
    pub margin: Margin,
    /// Growth rates up to this, in 1/s, could not be told from zero by the model's eigenvalue solver.
    pub tolerance: f64,
    /// The band of frequencies that was asked for, if it was one.
    pub band: Option<Band>,
    /// Whether the model is undamped and its matrices are symmetric: then λ² is real, and nothing flutters.
    pub is_self_adjoint: bool,
}

/// The modes of a surrogate were chosen by their frequencies in the middle of the inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower end, in Hz.
    pub lower: f64,
    /// Upper end, in Hz.
    pub upper: f64,
    /// Number of modes of the model, inside and outside.
    pub modes: usize,
    /// Number of its real eigenvalues that belong to no mode.
    pub reals: usize,
}

impl VerdictBasis {
    /// An eigenvalue as it can be: of a self-adjoint model it is real or imaginary, and the smaller part of a predicted
    /// one is an error of the prediction.
    ///
    /// # Examples
    ///
    /// ```
    /// use num_complex::Complex;
    /// use pcc_evaluate::surrogate::VerdictBasis;
    /// let symmetric = VerdictBasis { is_self_adjoint: true, ..VerdictBasis::default() };
    /// assert_eq!(symmetric.settled(Complex::new(1e-3, 20.0)), Complex::new(0.0, 20.0));
    /// assert_eq!(VerdictBasis::default().settled(Complex::new(1e-3, 20.0)), Complex::new(1e-3, 20.0));
    /// ```
    #[inline(always)]
    pub fn settled(&self, lambda: Complex<f64>) -> Complex<f64> {
        // NaN stays.
        if !self.is_self_adjoint || lambda.re == 0.0 || lambda.im == 0.0 {
            lambda
        } else if lambda.im.abs() >= lambda.re.abs() {
            Complex::new(0.0, lambda.im)
        } else if lambda.re.abs() > lambda.im.abs() {
            Complex::new(lambda.re, 0.0)
        } else {
            lambda
        }
    }

    /// What decides: the largest excess, of eigenvalues none of which is NaN.
    ///
    /// # Examples
    ///
    /// ```
    /// use num_complex::Complex;
    /// use pcc_evaluate::components::Verdict;
    /// use pcc_evaluate::surrogate::VerdictBasis;
    /// let lambdas = [Complex::new(-2.0, 5.0), Complex::new(1e-14, 9.0)];
    /// let found = VerdictBasis { tolerance: 1e-12, ..VerdictBasis::default() }.top(&lambdas);
    /// assert_eq!((found.excess, found.frequency, found.verdict()), (0.0, 9.0, Verdict::Marginal));
    /// ```
    pub fn top(&self, eigenvalues: &[Complex<f64>]) -> Top {
        let larger = |a: Complex<f64>, b: Complex<f64>| {
            if self.margin.excess(b) > self.margin.excess(a) { b } else { a }
        };
        let decides = eigenvalues
            .iter()
            .map(|&lambda| self.settled(lambda))
            .reduce(larger)
            .unwrap_or(Complex::new(f64::NEG_INFINITY, 0.0));
        Top {
            max_re: if self.is_self_adjoint { decides.re } else { spectral_abscissa(eigenvalues) },
            excess: beyond_rounding(self.margin.excess(decides), self.tolerance),
            frequency: decides.im,
        }
    }
}

/// What is known of the error where stability is decided.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Decision {
    /// Quantiles of (max Re λ of the model) − (its leave-one-out prediction, all components together), in 1/s; empty if
    /// undetermined.
    pub max_re_residuals: Vec<Quantile>,
    /// Estimated relative error of the stability proportion, as a fraction; of quadratures, which leave no point out,
    /// the part alone that modes the surrogate does not carry have in it, by the share of the nodes that they decide.
    pub proportion_error: Option<f64>,
}

impl Decision {
    /// Probability with which max Re λ of the model minus its prediction lies between the shifts of the band.
    pub const BAND_LEVEL: f64 = 0.95;

    /// The quantiles of the residuals of max Re λ, in 1/s, that hold [`Decision::BAND_LEVEL`] between them; zero if
    /// they are undetermined.
    pub fn band_shifts(&self) -> [f64; 2] {
        [0.5 - 0.5 * Self::BAND_LEVEL, 0.5 + 0.5 * Self::BAND_LEVEL].map(|level| {
            let same = |quantile: &&Quantile| (quantile.level - level).abs() < 1e-9;
            self.max_re_residuals.iter().find(same).map_or(0.0, |quantile| quantile.value)
        })
    }
}

/// A quantile of a distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantile {
    /// Probability to be undercut.
    pub level: f64,
    /// Its value.
    pub value: f64,
}

/// Points with the values an evaluator must find.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfTest {
    /// Points in physical coordinates.
    pub points: Vec<Vec<f64>>,
    /// Values of all components by id, per point.
    pub components: Vec<Vec<f64>>,
    /// max Re λ over the surrogate's modes, per point, in 1/s.
    pub max_re: Vec<f64>,
    /// Largest difference allowed, relative to max(1, |expected|).
    pub tolerance: f64,
}
