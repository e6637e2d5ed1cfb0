//! Stepwise construction of a sparse polynomial chaos basis.
//!
//! Kieu, Bergeot and Berger (2017), section 3.3.3, after Blatman and Sudret (2010),
//! <https://doi.org/10.1016/j.probengmech.2009.10.003>.
//!
//! Degree by degree, every candidate multi-index with p − 1 < ‖α‖_q ≤ p is tried alone on the set accepted at degree
//! p − 1 and kept if it raises R² by at least ε₁ (forward step). Then every term with ‖α‖_q ≤ p − 1 but {0} is tried
//! alone for removal and dropped if that lowers R² by less than ε₂ (backward step). If then N < 2 card(A), the design
//! must grow and the search starts again from {0} (step 4). The search ends when the leave-one-out S² reaches its target
//! or at the highest degree (step 5).
//!
//! One case the paper leaves open: if the forward step accepts as many terms as there are points, least squares has no
//! unique solution and no backward step can be taken; this counts as a failed size test.

use std::collections::HashSet;

use super::{Fitted, Stop};
use crate::index_set::MultiIndex;
use crate::regression::{ActiveBasis, BasisTables, variance};
use crate::study::Stepwise;

/// Points required per term (step 4 of the paper).
const SAMPLES_PER_TERM: usize = 2;

/// What came of a fit on one design.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The search ended.
    Fitted(Fitted),
    /// The design is too small for the terms that matter; `best` is the expansion of the last degree that passed.
    TooFewSamples {
        /// The last expansion with N ≥ 2 card(A).
        best: Fitted,
    },
}

/// Fits one component.
///
/// `values[i]` is the component at point i of `tables`, in its own unit. `shells[p]` holds the candidates with
/// p − 1 < ‖α‖_q ≤ p, as [`crate::index_set::Hyperbolic::shells`] gives them for `settings.q_norm` and
/// `settings.max_degree`.
///
/// # Examples
///
/// ```
/// use pcc::design::NestedLatinHypercube;
/// use pcc::fit::stepwise::{Outcome, fit};
/// use pcc::index_set::Hyperbolic;
/// use pcc::polynomial::Family;
/// use pcc::regression::BasisTables;
/// use pcc::study::Stepwise;
///
/// let settings = Stepwise {
///     max_degree: 8, q_norm: 1.0, s2_target: 0.9999, epsilon_forward: 1e-6, epsilon_backward: 1e-6,
/// };
/// let mut design = NestedLatinHypercube::new(2, 1);
/// design.grow_to(60);
/// let samples = design.samples(|_, u| 2.0 * u - 1.0);
/// let values: Vec<f64> = samples.points().map(|x| 1.0 + x[0] * x[1]).collect();
/// let tables = BasisTables::new(&samples, &vec![Family::Legendre.recurrence(8); 2], 8);
/// let shells = Hyperbolic { inputs: 2, q_norm: 1.0 }.shells(8)?;
/// let Outcome::Fitted(fitted) = fit(&tables, &values, &shells, &settings) else { panic!("60 points suffice") };
/// assert!(fitted.errors.is_some_and(|errors| errors.r2 > 0.9999));
/// # Ok::<(), pcc::index_set::IndexSetError>(())
/// ```
pub fn fit(tables: &BasisTables, values: &[f64], shells: &[Vec<MultiIndex>], settings: &Stepwise) -> Outcome {
    let inputs = shells[0][0].len();
    let Some(variance) = variance(values) else {
        return Outcome::Fitted(Fitted::constant(inputs, values));
    };
    let mut basis = ActiveBasis::constant(tables, inputs, values, variance); // step 2: A = {0}
    for degree in 1..=settings.max_degree {
        let before = basis.clone();
        let candidates = &shells[usize::from(degree)];
        forward_step(&mut basis, candidates, settings.epsilon_forward);
        if basis.indices().len() < values.len() {
            backward_step(&mut basis, candidates, settings.epsilon_backward);
        }
        if values.len() < SAMPLES_PER_TERM * basis.indices().len() {
            let best = Fitted::new(&before, degree - 1, Stop::DesignExhausted);
            return Outcome::TooFewSamples { best }; // step 4
        }
        if basis.errors().s2.is_some_and(|s2| s2 >= settings.s2_target) {
            return Outcome::Fitted(Fitted::new(&basis, degree, Stop::Accurate)); // step 5
        }
    }
    Outcome::Fitted(Fitted::new(&basis, settings.max_degree, Stop::HighestDegree))
}

/// Adds the candidates that, each alone, raise R² by at least `epsilon`.
fn forward_step(basis: &mut ActiveBasis<'_>, candidates: &[MultiIndex], epsilon: f64) {
    let gains = basis.gains(candidates);
    let significant = candidates.iter().zip(gains).filter(|&(_, gain)| gain >= epsilon);
    basis.extend(significant.map(|(alpha, _)| alpha.clone()).collect());
}

/// Drops the terms of lower degree, never {0}, that each alone lower R² by less than `epsilon`.
fn backward_step(basis: &mut ActiveBasis<'_>, of_this_degree: &[MultiIndex], epsilon: f64) {
    let losses = basis.losses();
    let protected: HashSet<&MultiIndex> = of_this_degree.iter().collect();
    basis.retain(|k, alpha| alpha.is_constant() || protected.contains(alpha) || losses[k] >= epsilon);
}
