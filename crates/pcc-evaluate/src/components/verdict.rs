//! What eigenvalues say of stability.

use num_complex::Complex;

/// How far an eigenvalue has to stay from instability to count as stable.
///
/// It is judged by its *excess* e: Re λ and the margin together, which is negative where the eigenvalue decays faster
/// than the margin asks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Margin {
    /// e = Re λ + this growth rate, in 1/s.
    GrowthRate(f64),
    /// e = Re λ + ζ|λ| for this damping ratio ζ = −Re λ/|λ|, between 0 and 1.
    DampingRatio(f64),
}

impl Default for Margin {
    /// None: an eigenvalue is judged by the sign of Re λ.
    fn default() -> Self {
        Self::GrowthRate(0.0)
    }
}

impl Margin {
    /// Whether there is none.
    pub fn is_none(self) -> bool {
        matches!(self, Self::GrowthRate(margin) | Self::DampingRatio(margin) if margin == 0.0)
    }

    /// e of an eigenvalue, in 1/s.
    ///
    /// # Examples
    ///
    /// ```
    /// use num_complex::Complex;
    /// use pcc_evaluate::components::Margin;
    /// let lambda = Complex::new(-0.06, 10.0);
    /// assert!(Margin::GrowthRate(0.05).excess(lambda) < 0.0);
    /// assert!(Margin::DampingRatio(0.01).excess(lambda) > 0.0);
    /// ```
    #[inline(always)]
    pub fn excess(self, lambda: Complex<f64>) -> f64 {
        match self {
            Self::GrowthRate(margin) => lambda.re + margin,
            Self::DampingRatio(ratio) => lambda.re + ratio * (lambda.re * lambda.re + lambda.im * lambda.im).sqrt(),
        }
    }
}

/// What is told from zero is told from zero; what is not, is zero.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::components::beyond_rounding;
/// assert_eq!([1e-9, -1e-15].map(|excess| beyond_rounding(excess, 1e-12)), [1e-9, 0.0]);
/// ```
#[inline(always)]
pub fn beyond_rounding(excess: f64, tolerance: f64) -> f64 {
    // NaN stays.
    if excess.abs() <= tolerance { 0.0 } else { excess }
}

/// What the eigenvalue with the largest excess says of a system.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// e < 0.
    Stable,
    /// e = 0 as far as can be told: it neither grows nor decays, as in an undamped system.
    Marginal,
    /// e > 0, and it oscillates.
    Flutter,
    /// e > 0, and it is real.
    Divergence,
}

impl Verdict {
    /// That of the largest excess, 0 where it cannot be told from zero, of an eigenvalue with this Im λ. What is not a
    /// number is never stable.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::components::Verdict;
    /// assert_eq!(Verdict::of(-0.1, 20.0), Verdict::Stable);
    /// assert_eq!(Verdict::of(0.0, 20.0), Verdict::Marginal);
    /// assert_eq!(Verdict::of(0.1, 20.0), Verdict::Flutter);
    /// assert_eq!(Verdict::of(0.1, 0.0), Verdict::Divergence);
    /// ```
    pub fn of(excess: f64, frequency: f64) -> Self {
        if excess < 0.0 {
            Self::Stable
        } else if excess == 0.0 {
            Self::Marginal
        } else if frequency == 0.0 {
            Self::Divergence
        } else {
            Self::Flutter
        }
    }

    /// In one word, for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stable => "stable",
            Self::Marginal => "marginal",
            Self::Flutter => "flutter",
            Self::Divergence => "divergence",
        }
    }
}
