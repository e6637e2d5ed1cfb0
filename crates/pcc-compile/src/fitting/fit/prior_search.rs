//! The search for the prior, and for the weight of derivatives.
//!
//! Without derivatives the parameters minimise the leave-one-out error itself. With derivatives a few runs give many
//! equations, but few left-out values: there the likelihood of all equations leads the search, which needs a fifth of
//! the steps and ends at priors that predict as well or better (the clutch with 8 inputs, 16 to 64 runs). What it finds
//! is judged by the values of left-out runs in either case: whether to start anew, and how much weight derivatives
//! deserve. Priors of different weights are comparable then, because none was tuned on the error that is compared.

use super::covariance::Kernel;
use super::prior::Prior;
use super::regularized::Regularized;
use crate::fitting::regression::{BasisTables, Equations};
use crate::numerics::minimize::{Evaluation, Limits, Start, minimize};
use nalgebra::{DMatrix, DVector};
use pcc_evaluate::foundation::{Interrupted, Observer};

/// The prior is found on so many equations at most, those of the first points: each step of the search costs the cube
/// of their number.
const MOST_EQUATIONS: usize = 450;

/// Equations times inputs at most, as their products cost as much, but for so many runs with derivatives. Of a chain
/// with 20 inputs, the search on 21 of 40 runs took a quarter of the time of that on all, and left the S² of the worst
/// component at 0.94, not 0.96.
const MOST_PRODUCTS: usize = 9_000;
const FEWEST_RUNS: usize = 3;

/// So many more equations than parameters of the prior are needed for a search; with fewer, it would fit noise.
const LEAST_SURPLUS: usize = 3;

/// A larger design is expected to lower ½ ln of the mean square error by this.
const EXPECTED_GAIN: f64 = 0.1;

/// A smaller weight of the derivatives must lower it by this, ln 2: half of the error is no chance.
const REWEIGHTING_GAIN: f64 = 0.7;

/// The search for the prior ends when its objective, per equation, falls by less: one per mille of an error.
const LIMITS: Limits = Limits { iterations: 60, decrease: 1e-3 };

/// So many times more values than parameters of the prior can judge the weight of derivatives.
const VALUES_PER_PARAMETER: usize = 2;

/// Weights of derivatives that are tried, from as good as values, but for rounding, to useless.
const WEIGHTS: [f64; 7] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 0.0];

/// A prior, the weight of derivatives, and ½ ln of the mean square error of left-out values.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    pub prior: Prior,
    pub weight: f64,
    pub error: f64,
    /// The inverse Hessian of the objective, as far as the search learnt it.
    pub curvature: Option<DMatrix<f64>>,
}

impl Found {
    /// Before the first search.
    pub fn nothing(inputs: usize) -> Self {
        Self { prior: Prior::start(inputs), weight: WEIGHTS[0], error: f64::INFINITY, curvature: None }
    }
}

/// Standardized values and derivatives on a design.
pub(super) struct Search<'a> {
    pub tables: &'a BasisTables,
    pub equations: &'a Equations,
    pub targets: &'a DVector<f64>,
    /// Rounding of the values.
    pub resolution: f64,
    pub degree: u16,
}

/// What a weight must make up for.
fn handicap(weight: f64) -> f64 {
    if weight == WEIGHTS[0] { 0.0 } else { REWEIGHTING_GAIN }
}

/// On how many runs, the first ones, priors are found.
pub(super) fn most_runs(equations: &Equations, inputs: usize) -> usize {
    if equations.points_with_derivatives().is_empty() {
        MOST_EQUATIONS
    } else {
        let equations = MOST_EQUATIONS.min(MOST_PRODUCTS / (1 + inputs));
        (equations / (1 + inputs)).max(FEWEST_RUNS)
    }
}

impl Search<'_> {
    /// Whether there are enough equations for a search.
    pub fn is_determined(&self) -> bool {
        self.equations.rows() >= self.fewest_equations()
    }

    fn fewest_equations(&self) -> usize {
        Prior::bounds(self.tables.inputs()).len() + LEAST_SURPLUS
    }

    /// The prior and weight found from those of a smaller design. A start that led into a side valley there is
    /// recognised by an error that no longer falls; then the search is repeated from the neutral prior.
    pub fn best(&self, start: &Found, observer: &dyn Observer) -> Result<Found, Interrupted> {
        let mut found = self.descend(start, observer)?;
        if found.error >= start.error - EXPECTED_GAIN {
            let neutral =
                self.descend(&Found { weight: start.weight, ..Found::nothing(start.prior.inputs()) }, observer)?;
            if neutral.error < found.error {
                found = neutral;
            }
        }
        let has_derivatives = !self.equations.points_with_derivatives().is_empty();
        let can_judge = self.equations.samples() >= VALUES_PER_PARAMETER * Prior::bounds(self.tables.inputs()).len();
        if has_derivatives && can_judge { self.reweighted(found, observer) } else { Ok(found) }
    }

    /// What was found or better with another weight of derivatives, by its own prior or by that of values alone: bad
    /// derivatives lead astray. Full weight is kept unless a smaller one makes the error half as large.
    fn reweighted(&self, found: Found, observer: &dyn Observer) -> Result<Found, Interrupted> {
        let judged_by = |found: &Found| found.error + handicap(found.weight);
        let alone = self.descend(&Found { weight: 0.0, ..Found::nothing(self.tables.inputs()) }, observer)?;
        let candidate = |prior: &Prior, weight: f64| {
            let error = self.error_of(prior, weight);
            Found { prior: prior.clone(), weight, error, curvature: None }
        };
        let mut by_weight = Vec::with_capacity(WEIGHTS.len());
        for weight in WEIGHTS {
            let [own, other] = [candidate(&found.prior, weight), candidate(&alone.prior, weight)];
            by_weight.push(if own.error <= other.error { own } else { other });
        }
        if by_weight.iter().all(|other| judged_by(other) >= judged_by(&found)) {
            return Ok(found);
        }
        // Derivatives are not what they seem: each weight deserves its own search.
        let mut best = alone;
        for start in by_weight {
            let tuned = self.descend(&start, observer)?;
            for other in [start, tuned] {
                if judged_by(&other) < judged_by(&best) {
                    best = other;
                }
            }
        }
        Ok(best)
    }

    /// A local minimum of the objective, rounded.
    fn descend(&self, from: &Found, observer: &dyn Observer) -> Result<Found, Interrupted> {
        let weight = from.weight;
        let start = Start { point: from.prior.parameters().to_vec(), inverse_hessian: from.curvature.clone() };
        let part = self.part(weight);
        let lowest = minimize(&start, &Prior::bounds(from.prior.inputs()), LIMITS, |parameters| {
            observer.check()?;
            Ok(part.objective(&Prior::with(parameters), weight))
        })?;
        let prior = Prior::rounded(&lowest.point);
        let error = part.error_of(&prior, weight);
        Ok(Found { prior, weight, error, curvature: lowest.inverse_hessian })
    }

    /// ½ ln of the mean square error of left-out values, infinite if it cannot be computed.
    pub fn error_of(&self, prior: &Prior, weight: f64) -> f64 {
        self.part(weight).error_of(prior, weight)
    }

    /// The equations that a search uses.
    fn part(&self, weight: f64) -> Part<'_> {
        let samples = self.equations.samples().min(most_runs(self.equations, self.tables.inputs()));
        let (equations, targets) = if weight > 0.0 {
            let targets = self.targets.select_rows(&self.equations.positions_of_first(samples));
            (self.equations.first(samples), targets)
        } else {
            (Equations::values_alone(samples), self.targets.rows(0, samples).into_owned())
        };
        let has_derivatives = !self.equations.points_with_derivatives().is_empty();
        let objective = if has_derivatives { Objective::Likelihood } else { Objective::LeaveOneOut };
        Part { tables: self.tables, equations, targets, resolution: self.resolution, degree: self.degree, objective }
    }
}

/// Some of the equations.
struct Part<'a> {
    tables: &'a BasisTables,
    equations: Equations,
    targets: DVector<f64>,
    resolution: f64,
    degree: u16,
    objective: Objective,
}

/// What a search minimises.
#[derive(Clone, Copy)]
enum Objective {
    Likelihood,
    LeaveOneOut,
}

impl Part<'_> {
    fn objective(&self, prior: &Prior, weight: f64) -> Evaluation {
        let objective = match self.objective {
            Objective::Likelihood => self.negative_log_likelihood(prior, weight),
            Objective::LeaveOneOut => self.leave_one_out_error(prior),
        };
        objective.filter(|(value, _)| value.is_finite())
    }

    /// −(ln of the likelihood)/n for n equations, with the scale of the prior at its best, and the derivatives by the
    /// parameters of the prior (Rasmussen and Williams 2006, section 5.4.1): with c = Ay and q = yᵀAy,
    ///
    /// f = ½ ln(q/n) + ln det(K + νI)/2n,   df = Σ G_ab dK_ab,   G = (A − n c cᵀ/q)/2n.
    fn negative_log_likelihood(&self, prior: &Prior, weight: f64) -> Evaluation {
        let kernel = Kernel::new(prior, self.tables, &self.equations, self.degree);
        let regularized = Regularized::new(&kernel.matrix, &self.equations, weight)?;
        let count = self.equations.rows() as f64;
        let weighted = &regularized.inverse * &self.targets;
        let square = weighted.dot(&self.targets);
        let value = 0.5 * (square / count).ln() + regularized.log_determinant / (2.0 * count);
        let mut by_matrix = &regularized.inverse / (2.0 * count);
        by_matrix.ger(-0.5 / square, &weighted, &weighted, 1.0);
        Some((value, kernel.gradient(&regularized.by_kernel(by_matrix, &self.equations))))
    }

    fn error_of(&self, prior: &Prior, weight: f64) -> f64 {
        self.left_out_error(prior, weight).unwrap_or(f64::INFINITY)
    }

    /// ½ ln of the mean of Δ² at left-out values, no smaller than rounding.
    fn left_out_error(&self, prior: &Prior, weight: f64) -> Option<f64> {
        let kernel = Kernel::new(prior, self.tables, &self.equations, self.degree);
        let regularized = Regularized::new(&kernel.matrix, &self.equations, weight)?;
        let left_out = regularized.left_out(&self.equations, &(&regularized.inverse * &self.targets))?;
        Some(0.5 * ((left_out.norm_squared() + self.floor()) / left_out.len() as f64).ln())
    }

    /// The same for values alone, with its derivatives by the parameters of the prior.
    ///
    /// With c = Ay and Δ_i = c_i/A_ii: ΣΔdΔ = Σ G_ab dK_ab with G = −(A u) cᵀ + A diag(t) A, u_i = Δ_i/A_ii, t_i = Δ_i
    /// c_i/A_ii².
    fn leave_one_out_error(&self, prior: &Prior) -> Evaluation {
        let kernel = Kernel::new(prior, self.tables, &self.equations, self.degree);
        let regularized = Regularized::new(&kernel.matrix, &self.equations, 1.0)?;
        let inverse = &regularized.inverse;
        let weighted = inverse * &self.targets;
        let diagonal = inverse.diagonal();
        let left_out = weighted.component_div(&diagonal);
        let square = left_out.norm_squared() + self.floor();
        let direct = inverse * left_out.component_div(&diagonal);
        let mut scaled = inverse.clone();
        for (k, mut column) in scaled.column_iter_mut().enumerate() {
            column.scale_mut(left_out[k] * weighted[k] / (diagonal[k] * diagonal[k]));
        }
        let mut by_matrix = scaled * inverse;
        by_matrix.ger(-0.5, &direct, &weighted, 1.0);
        by_matrix.ger(-0.5, &weighted, &direct, 1.0);
        let gradient = kernel.gradient(&regularized.by_kernel(by_matrix, &self.equations));
        let value = 0.5 * (square / left_out.len() as f64).ln();
        Some((value, gradient.into_iter().map(|slope| slope / square).collect()))
    }

    /// The sum of squares that is rounding.
    fn floor(&self) -> f64 {
        self.equations.samples() as f64 * self.resolution.max(f64::EPSILON).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::design::NestedLatinHypercube;
    use pcc_evaluate::polynomials::Family;

    const DEGREE: u16 = 8;

    fn smooth(x: &[f64]) -> f64 {
        (0.6 * x[0]).exp() / (1.5 + 0.4 * x[1]) + 0.1 * x.iter().sum::<f64>()
    }

    struct Problem {
        tables: BasisTables,
        equations: Equations,
        targets: DVector<f64>,
    }

    /// Values at all points, derivatives by differences at all but the third.
    fn problem(samples: usize, with_derivatives: bool) -> Problem {
        let mut design = NestedLatinHypercube::new(3, 3);
        design.grow_to(samples);
        let samples = design.samples(|_, u| 2.0 * u - 1.0);
        let recurrences = vec![Family::Legendre.recurrence(DEGREE.into()); 3];
        let points: Vec<usize> =
            if with_derivatives { (0..samples.len()).filter(|&i| i != 2).collect() } else { vec![] };
        let mut targets: Vec<f64> = samples.points().map(smooth).collect();
        for j in 0..3 {
            targets.extend(points.iter().map(|&i| {
                let moved = |step: f64| {
                    let mut point = samples.point(i).to_vec();
                    point[j] += step;
                    smooth(&point)
                };
                (moved(1e-4) - moved(-1e-4)) / 2e-4
            }));
        }
        Problem {
            tables: BasisTables::with_slopes(&samples, &recurrences, DEGREE.into()),
            equations: Equations::with_derivatives(samples.len(), 3, points),
            targets: DVector::from_vec(targets),
        }
    }

    impl Problem {
        fn search(&self) -> Search<'_> {
            let Self { tables, equations, targets } = self;
            Search { tables, equations, targets, resolution: 1e-12, degree: DEGREE }
        }
    }

    #[test]
    fn gradients_are_those_of_differences() {
        for (samples, with_derivatives, weight) in [(25, false, 1.0), (8, true, 1.0), (8, true, 1e-2), (8, true, 0.0)] {
            let problem = problem(samples, with_derivatives);
            let search = problem.search();
            let at = [0.9, 1.1, 1.6, -0.7];
            let objective = |at: &[f64]| search.part(weight).objective(&Prior::with(at), weight).unwrap();
            for (k, slope) in objective(&at).1.into_iter().enumerate() {
                let shifted = |step: f64| {
                    let mut moved = at;
                    moved[k] += step;
                    objective(&moved).0
                };
                let difference = (shifted(1e-4) - shifted(-1e-4)) / 2e-4;
                assert!((slope - difference).abs() < 1e-4 * (1.0 + slope.abs()), "{k}: {slope} against {difference}");
            }
        }
    }

    /// Predictions without a run, by explicit solutions.
    #[test]
    fn left_out_runs_equal_explicit_refits() {
        for with_derivatives in [false, true] {
            let Problem { tables, equations, targets } = problem(7, with_derivatives);
            let kernel = Kernel::new(&Prior::start(3), &tables, &equations, DEGREE).matrix;
            let regularized = Regularized::new(&kernel, &equations, 1.0).unwrap();
            let closed = regularized.left_out(&equations, &(&regularized.inverse * &targets)).unwrap();
            for i in 0..7 {
                let run = equations.block(i);
                let others: Vec<usize> = (0..equations.rows()).filter(|row| !run.contains(row)).collect();
                let mut matrix = kernel.select_rows(&others).select_columns(&others);
                (0..others.len()).for_each(|k| matrix[(k, k)] += regularized.nuggets[others[k]]);
                let weights = matrix.lu().solve(&targets.select_rows(&others)).unwrap();
                let predicted = kernel.row(i).transpose().select_rows(&others).dot(&weights);
                // The condition number of K, some 10¹⁰, times rounding.
                assert!((targets[i] - predicted - closed[i]).abs() < 1e-5, "run {i}");
            }
        }
    }
}
