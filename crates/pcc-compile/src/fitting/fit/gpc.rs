//! Full polynomial chaos expansions of total degree p (section 3.1 of the paper, there called gPC).
//!
//! All multi-indices with |α| ≤ p, (r + p)!/(r! p!) of them (equation 6), none chosen. The coefficients come from
//!
//! * **projection** ([`project`]): c_α = E\[y ψ_α\], the integral by a tensor Gauss rule with p + 1 nodes per input:
//!   (p + 1)ʳ model runs. On the nodes the ψ_α are orthonormal under the weights w_i of the rule, so projection is
//!   weighted least squares there. Its leave-one-out error would follow as for any regression, but says nothing: for
//!   every node there are others with the same coordinate, so what the degree misses between them is never seen (the
//!   clutch with p = 6, r = 3: S² = 1 − 5·10⁻⁷ where the proportion is 7 % off);
//! * **least squares** ([`least_squares`]) on the points of a design, equations 7 and 8, with derivatives if there are
//!   any. The weight of the equations of derivatives is the one with the best leave-one-out S².

use super::method::{
    Design, Domain, Entry, FitMethod, FitSize, Given, Key, MAX_DEGREE, Meaningless, MethodFit, MethodSetting, Previous,
    Profile, Solver as ReadySolver, Value, number_setting,
};
use super::{Fitted, WEIGHTS};
use crate::fitting::design::TensorGauss;
use crate::fitting::regression::{ActiveBasis, BasisTables, ErrorMeasures, Response};
use nalgebra::DMatrix;
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::polynomials::{Hyperbolic, IndexSet, IndexSetError, Recurrence};
use pcc_evaluate::surrogate::StopReason;
use std::ops::Range;

/// Nodes whose polynomials are held in memory together: at most so many, and so many values of polynomials.
const BLOCK: usize = 2048;
const BLOCK_VALUES: usize = 1 << 21;

/// Blocks whose sums are held in memory together.
const BLOCKS_IN_FLIGHT: usize = 16;

const SOLVER: Key = Key { name: "solver", domain: Domain::Word(&["quadrature", "least-squares"]) };
const OVERSAMPLING: Key = Key {
    name: "oversampling",
    domain: Domain::Number { expected: "a number from 1 to 100", holds: |value| (1.0..=100.0).contains(&value) },
};

/// Points per term of a full expansion by least squares, as the paper asks of a design: N ≥ 2 card(A).
const DEFAULT_OVERSAMPLING: f64 = 2.0;

/// Degree by least squares.
const LEAST_SQUARES_DEGREE: u16 = 3;

/// The number of model runs at which the paper's table stops.
pub const PAPERS_LIMIT: f64 = 10_000.0;

/// The paper's highest order of a full expansion.
const PAPERS_DEGREE: u16 = 6;

/// The method in the list.
pub(super) const METHOD: Entry =
    Entry { name: "gpc", keys: &[&MAX_DEGREE, &SOLVER, &OVERSAMPLING], grows: false, read };

/// How the coefficients of a full expansion are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solver {
    /// Projection by a tensor Gauss rule with p + 1 nodes per input.
    Quadrature,
    /// Least squares on a Latin hypercube.
    LeastSquares {
        /// Equations per term, at least 1: values, and derivatives if there are any.
        oversampling: f64,
    },
}

/// Settings of a full expansion of total degree (section 3.1 of the paper).
#[derive(Debug, Clone, PartialEq)]
pub struct FullExpansion {
    /// p, at least 1.
    pub max_degree: u16,
    /// How its coefficients are found.
    pub solver: Solver,
}

fn read(given: &Given, inputs: usize) -> Result<FitMethod, Meaningless> {
    let oversampling = given.number(&OVERSAMPLING);
    let (solver, default_degree) = match given.word(&SOLVER) {
        Some("least-squares") => {
            let oversampling = oversampling.unwrap_or(DEFAULT_OVERSAMPLING);
            (Solver::LeastSquares { oversampling }, LEAST_SQUARES_DEGREE)
        }
        _ if oversampling.is_some() => {
            return Err(Meaningless { key: OVERSAMPLING.name, belongs_to: "solver = \"least-squares\"" });
        }
        _ => (Solver::Quadrature, quadrature_degree(inputs)),
    };
    Ok(FitMethod::Gpc(FullExpansion { max_degree: given.degree(default_degree), solver }))
}

/// The highest degree up to 6 that takes no more than 10 000 runs, which gives the orders of the paper's table.
fn quadrature_degree(inputs: usize) -> u16 {
    let fits = |degree: &u16| f64::from(degree + 1).powi(inputs as i32) <= PAPERS_LIMIT;
    (1..=PAPERS_DEGREE).rev().find(fits).unwrap_or(1)
}

impl FullExpansion {
    pub(super) fn profile(&self) -> Profile {
        let solver = |name: &str, explanation| MethodSetting {
            key: SOLVER.name,
            value: Value::Word(name.to_owned()),
            explanation,
        };
        let (design, settings) = match self.solver {
            Solver::Quadrature => {
                (Design::Quadrature, vec![solver("quadrature", "(p + 1)^r model runs; or \"least-squares\"")])
            }
            Solver::LeastSquares { oversampling } => {
                let oversampled = number_setting(&OVERSAMPLING, oversampling, "equations per term");
                (Design::Oversampled(oversampling), vec![solver("least-squares", "or \"quadrature\""), oversampled])
            }
        };
        Profile {
            name: METHOD.name,
            explanation: "full expansion",
            degree: "total degree p",
            max_degree: self.max_degree,
            settings,
            design,
            is_least_squares: true,
            chooses: false,
        }
    }
}

/// Least squares on all terms.
struct Ready(IndexSet);

pub(super) fn ready(degree: u16, size: FitSize) -> Result<impl ReadySolver, IndexSetError> {
    Ok(Ready(total_degree(size.inputs, degree)?))
}

impl ReadySolver for Ready {
    fn fit(
        &self,
        tables: &BasisTables,
        response: Response<'_>,
        previous: &Previous,
        _: bool,
        observer: &dyn Observer,
    ) -> Result<Option<MethodFit>, Interrupted> {
        Ok(Some((least_squares(tables, response, &self.0, observer)?, METHOD.name, previous.clone())))
    }
}

/// {α : |α| ≤ p} for `inputs` variables.
///
/// # Errors
///
/// [`IndexSetError`] if there are more than ten million.
pub fn total_degree(inputs: usize, degree: u16) -> Result<IndexSet, IndexSetError> {
    let shells = Hyperbolic { inputs, q_norm: 1.0 }.shells(degree)?;
    Ok(IndexSet::from_unsorted(shells.concat()))
}

/// The projection of one component.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    /// Coefficients c_α, one per index; of a component that does not vary, all but the first are zero.
    pub coefficients: Vec<f64>,
    /// Σ w_i (y_i − ȳ)²; zero if that is rounding.
    pub variance: f64,
    /// Σ w_i e_i² for the residuals e_i at the nodes.
    pub mean_square_residual: f64,
}

/// Projects components with `values[id][i]` at node i of `grid` on the polynomials with these `indices`. Differences up
/// to `resolutions[id]` are rounding of the model.
///
/// # Errors
///
/// [`Interrupted`] soon after the observer asks to stop.
///
/// # Examples
///
/// ```
/// use pcc_compile::fitting::design::TensorGauss;
/// use pcc_compile::fitting::fit::gpc::{project, total_degree};
/// use pcc_evaluate::polynomials::Family;
/// use pcc_evaluate::foundation::Silent;
///
/// let recurrences = vec![Family::Legendre.recurrence(3); 2];
/// let grid = TensorGauss::new(&recurrences, 3);
/// let values = grid.nodes(0..9).points().map(|x| 2.0 + x[0] * x[1]).collect();
/// let indices = total_degree(2, 2)?;
/// let found = project(&grid, &recurrences, &indices, &[values], &[0.0], &Silent)?;
/// // φ_1 = √3 x: the coefficient of φ_1(x) φ_1(y) is 1/3.
/// assert!((found[0].coefficients[0] - 2.0).abs() < 1e-14 && (found[0].coefficients[4] - 1.0 / 3.0).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn project(
    grid: &TensorGauss,
    recurrences: &[Recurrence],
    indices: &IndexSet,
    values: &[Vec<f64>],
    resolutions: &[f64],
    observer: &dyn Observer,
) -> Result<Vec<Projection>, Interrupted> {
    let blocks = Blocks { grid, recurrences, indices, values, observer };
    let coefficients = blocks.coefficients()?;
    let projection = |id: usize| {
        let coefficients: Vec<f64> = coefficients.column(id).iter().copied().collect();
        let mean = coefficients[0];
        let weighted = grid.weights(0..grid.len()).zip(&values[id]);
        let variance = weighted.fold(0.0, |sum, (weight, value)| sum + weight * (value - mean).powi(2));
        if variance <= resolutions[id] * resolutions[id] {
            let mut constant = vec![0.0; indices.len()];
            constant[0] = mean;
            return Projection { coefficients: constant, variance: 0.0, mean_square_residual: variance };
        }
        // The polynomials are orthonormal on the nodes: what they explain adds up.
        let explained: f64 = coefficients[1..].iter().map(|c| c * c).sum();
        Projection { coefficients, variance, mean_square_residual: (variance - explained).max(0.0) }
    };
    Ok((0..values.len()).map(projection).collect())
}

/// The polynomials at the nodes, block by block.
struct Blocks<'a> {
    grid: &'a TensorGauss,
    recurrences: &'a [Recurrence],
    indices: &'a IndexSet,
    values: &'a [Vec<f64>],
    observer: &'a dyn Observer,
}

impl Blocks<'_> {
    /// Σ_i w_i ψ_α(ξ_i) y_i: a row per index, a column per component. Sums are made block by block in order, so they do
    /// not depend on the number of threads.
    fn coefficients(&self) -> Result<DMatrix<f64>, Interrupted> {
        let nodes = (BLOCK_VALUES / self.indices.len()).clamp(1, BLOCK);
        let blocks = self.grid.len().div_ceil(nodes);
        let mut sum = DMatrix::zeros(self.indices.len(), self.values.len());
        for first in (0..blocks).step_by(BLOCKS_IN_FLIGHT) {
            let parts = try_map(BLOCKS_IN_FLIGHT.min(blocks - first), |number| {
                self.observer.check()?;
                let start = (first + number) * nodes;
                Ok(self.part(start..self.grid.len().min(start + nodes)))
            })?;
            parts.into_iter().for_each(|part| sum += part);
        }
        Ok(sum)
    }

    /// The sum over some nodes.
    fn part(&self, range: Range<usize>) -> DMatrix<f64> {
        let degree = self.indices.last().map_or(0, |alpha| alpha.iter().sum::<u16>());
        let nodes = self.grid.nodes(range.clone());
        let basis = BasisTables::new(&nodes, self.recurrences, degree.into()).columns(self.indices);
        let weights: Vec<f64> = self.grid.weights(range.clone()).collect();
        let weighted =
            DMatrix::from_fn(range.len(), self.values.len(), |i, id| weights[i] * self.values[id][range.start + i]);
        basis.tr_mul(&weighted)
    }
}

/// Fits one component by least squares with all `indices`: `response.values[i]` belongs to point i of `tables`.
///
/// # Errors
///
/// [`Interrupted`] soon after the observer asks to stop.
pub fn least_squares(
    tables: &BasisTables,
    response: Response<'_>,
    indices: &IndexSet,
    observer: &dyn Observer,
) -> Result<Fitted, Interrupted> {
    let Some(variance) = response.variance() else {
        return Ok(Fitted::constant(tables.inputs(), response.values));
    };
    let degree = indices.last().map_or(0, |alpha| alpha.iter().sum());
    let s2 = |fitted: &Fitted| fitted.errors.and_then(|errors: ErrorMeasures| errors.s2).unwrap_or(f64::NEG_INFINITY);
    let fit = |weight: f64| -> Result<Fitted, Interrupted> {
        let mut basis = ActiveBasis::constant(tables, response.with_weight(weight), variance, weight, observer)?;
        basis.extend(indices[1..].to_vec())?;
        // Terms that the points cannot tell apart are left out, and where a point alone determines one, nothing is
        // known there.
        let fitted = Fitted::new(&basis, degree, StopReason::GivenDegree)?;
        let is_determined = basis.indices().len() == indices.len() && s2(&fitted).is_finite();
        Ok(if is_determined { fitted } else { Fitted { stop: StopReason::DesignExhausted, ..fitted } })
    };
    if response.gradients.is_none() {
        return fit(0.0);
    }
    let [full_weight, others @ ..] = WEIGHTS;
    let mut best = (fit(full_weight)?, full_weight);
    for weight in others {
        let found = fit(weight)?;
        // A fit that is not determined, or leaves terms out because there are fewer values, is no full expansion.
        let is_full = |fitted: &Fitted| fitted.stop == StopReason::GivenDegree;
        if is_full(&found) && (!is_full(&best.0) || s2(&found) > s2(&best.0)) {
            best = (found, weight);
        }
    }
    let (fitted, weight) = best;
    Ok(Fitted { derivative_weight: Some(weight), ..fitted })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;
    use pcc_evaluate::foundation::Silent;
    use pcc_evaluate::polynomials::Family;

    /// Sums over some tens of nodes in another order.
    const TOLERANCE: f64 = 1e-12;

    fn recurrences() -> Vec<Recurrence> {
        vec![Family::Legendre.recurrence(5); 2]
    }

    #[test]
    fn projection_is_weighted_least_squares_on_the_nodes() {
        let (grid, indices) = (TensorGauss::new(&recurrences(), 5), total_degree(2, 4).unwrap());
        let nodes = grid.nodes(0..25);
        let weights: Vec<f64> = grid.weights(0..25).collect();
        let values: Vec<f64> = nodes.points().map(|x| (2.0 * x[0]).sin() * (x[1] + 1.5).ln() + x[0].abs()).collect();
        let found =
            &project(&grid, &recurrences(), &indices, std::slice::from_ref(&values), &[0.0], &Silent).unwrap()[0];
        let basis = BasisTables::new(&nodes, &recurrences(), 4).columns(&indices);
        let rows = DMatrix::from_fn(25, indices.len(), |i, at| weights[i].sqrt() * basis[(i, at)]);
        let target = DVector::from_fn(25, |i, _| weights[i].sqrt() * values[i]);
        let beta = rows.clone().svd(true, true).solve(&target, 1e-13).unwrap();
        assert!(beta.iter().zip(&found.coefficients).all(|(a, b)| (a - b).abs() < TOLERANCE));
        let mean_square = (target - rows * beta).norm_squared();
        assert!((mean_square - found.mean_square_residual).abs() < TOLERANCE);
    }

    #[test]
    fn blocks_of_nodes_add_up() {
        let recurrences = vec![Family::Legendre.recurrence(14); 3];
        let (grid, indices) = (TensorGauss::new(&recurrences, 14), total_degree(3, 2).unwrap());
        assert!(grid.len() > BLOCK);
        let values = grid.nodes(0..grid.len()).points().map(|x| 1.0 + x[0] * x[2] - x[1].powi(3)).collect();
        let found = &project(&grid, &recurrences, &indices, &[values], &[0.0], &Silent).unwrap()[0];
        // E[y x z] = 1/9 with φ_1 = √3 x; E[x³ φ_1] = √3/5.
        let at = |alpha: [u16; 3]| indices.iter().position(|known| known[..] == alpha).unwrap();
        assert!((found.coefficients[at([1, 0, 1])] - 1.0 / 3.0).abs() < TOLERANCE);
        assert!((found.coefficients[at([0, 1, 0])] + 3f64.sqrt() / 5.0).abs() < TOLERANCE);
        assert!((found.variance - 1.0 / 9.0 - 1.0 / 7.0).abs() < TOLERANCE);
    }

    #[test]
    fn least_squares_finds_polynomials_of_its_degree_and_says_if_points_are_too_few() {
        let samples = TensorGauss::new(&recurrences(), 5).nodes(0..25);
        let values: Vec<f64> = samples.points().map(|x| 1.0 - x[0] + x[0] * x[1].powi(2)).collect();
        let fit = |count: usize, degree: u16| {
            let few =
                crate::fitting::design::Samples::new(2, (0..count).flat_map(|i| samples.point(i).to_vec()).collect());
            let tables = BasisTables::new(&few, &recurrences(), degree.into());
            let indices = total_degree(2, degree).unwrap();
            least_squares(&tables, Response::of(&values[..count], 0.0), &indices, &Silent).unwrap()
        };
        let exact = fit(25, 3);
        assert_eq!((exact.stop, exact.indices.len()), (StopReason::GivenDegree, 10));
        assert!(exact.errors.unwrap().s2.unwrap() > 1.0 - TOLERANCE);
        assert_eq!(fit(8, 3).stop, StopReason::DesignExhausted);
    }
}
