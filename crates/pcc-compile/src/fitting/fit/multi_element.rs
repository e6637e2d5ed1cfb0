//! Multi-element polynomial chaos: which element is divided next, and along which inputs.
//!
//! Section 3.2 of the paper, after Wan and Karniadakis (2005), *An adaptive multi-element generalized polynomial chaos
//! method for stochastic differential equations*, <https://doi.org/10.1016/j.jcp.2005.03.023>.
//!
//! The box is divided into elements, each with a full expansion of total degree p in its own local variables. Where a
//! function is smooth its coefficients fall fast with the order; the *decay rate* of an element is the share of its
//! variance that the highest order carries,
//!
//! η = Σ_{|α| = p} c_α² / Σ_{α ≠ 0} c_α².
//!
//! An element of probability w is divided if η^γ w ≥ θ₁, for the component where this is largest. The share that input
//! j has in the highest order,
//!
//! r_j = c²_{p e_j} / Σ_{|α| = p} c_α²,
//!
//! says along which inputs: all with r_j ≥ θ₂ max r_k are halved; if only products of inputs carry the highest order,
//! the share of an input is that of the products it is in. Wan and Karniadakis divide all elements that ask for it at
//! once; here they are taken one by one, the largest η^γ w first, so that a limit on their number is spent where it is
//! needed most. Near the limit an element is halved along fewer inputs, those with the largest r_j.

use super::gpc::Projection;
use super::method::{Design, Domain, Entry, FitMethod, Key, MAX_DEGREE, MethodSetting, Profile, Value, number_setting};
use pcc_evaluate::polynomials::IndexSet;

/// Squares of coefficients up to this share of those of the highest order are rounding of the quadrature.
const ROUNDING: f64 = 1e-24;

/// Shares and urgencies closer than this are equal but for rounding: the input or element that comes first is taken, on
/// every processor.
pub const EQUAL: f64 = 1e-9;

/// More elements are refused: each has expansions of its own, and finding room for the next looks at all splits.
const MOST_ELEMENTS: i64 = 10_000;

const THETA_1: Key = Key {
    name: "theta_1",
    domain: Domain::Number { expected: "0 or more", holds: |value| value >= 0.0 && value.is_finite() },
};
const THETA_2: Key = Key::share("theta_2");
const GAMMA: Key = Key::share("gamma");
const ELEMENTS: Key = Key { name: "elements", domain: Domain::Whole { least: 1, most: MOST_ELEMENTS } };

/// The paper's order, and a division of the whole box from a decay rate of η = θ₁² on.
const DEFAULT_DEGREE: u16 = 2;
const DEFAULT_THETA_1: f64 = 0.01;
const DEFAULT_THETA_2: f64 = 0.5;
const DEFAULT_GAMMA: f64 = 0.5;
const DEFAULT_ELEMENTS: usize = 100;

/// The method in the list.
pub(super) const METHOD: Entry = Entry {
    name: "me-gpc",
    keys: &[&MAX_DEGREE, &THETA_1, &THETA_2, &GAMMA, &ELEMENTS],
    grows: false,
    read: |given, _| {
        Ok(FitMethod::MultiElement(MultiElement {
            max_degree: given.degree(DEFAULT_DEGREE),
            theta_1: given.number(&THETA_1).unwrap_or(DEFAULT_THETA_1),
            theta_2: given.number(&THETA_2).unwrap_or(DEFAULT_THETA_2),
            gamma: given.number(&GAMMA).unwrap_or(DEFAULT_GAMMA),
            elements: given.whole(&ELEMENTS).map_or(DEFAULT_ELEMENTS, |elements| elements as usize),
        }))
    },
};

/// Settings of the multi-element expansion (section 3.2 of the paper).
#[derive(Debug, Clone, PartialEq)]
pub struct MultiElement {
    /// p of the expansion in each element, at least 1.
    pub max_degree: u16,
    /// θ₁: elements whose decay rate η, to the power γ and times their probability, is at least this are divided; not
    /// negative.
    pub theta_1: f64,
    /// θ₂: inputs whose share of the highest order is at least this part of the largest share are halved; in (0, 1\].
    pub theta_2: f64,
    /// γ, in (0, 1\].
    pub gamma: f64,
    /// Elements at most.
    pub elements: usize,
}

impl MultiElement {
    pub(super) fn profile(&self) -> Profile {
        let along = "θ₂: along inputs with this part of the largest share of the highest order";
        let elements = Value::Whole(self.elements as i64);
        Profile {
            name: METHOD.name,
            explanation: "full expansions on elements",
            degree: "total degree p in each element",
            max_degree: self.max_degree,
            settings: vec![
                number_setting(&THETA_1, self.theta_1, "θ₁: elements with η^γ × probability from here on are divided"),
                number_setting(&THETA_2, self.theta_2, along),
                number_setting(&GAMMA, self.gamma, "γ: exponent of the decay rate η"),
                MethodSetting { key: ELEMENTS.name, value: elements, explanation: "at most" },
            ],
            design: Design::QuadraturePerElement,
            is_least_squares: true,
            chooses: false,
        }
    }
}

/// Why and how an element would be divided.
#[derive(Debug, Clone, PartialEq)]
pub struct Division {
    /// η^γ w of the component where it is largest.
    pub urgency: f64,
    /// Inputs along which that component asks for halves, the largest share of the highest order first.
    pub inputs: Vec<usize>,
}

/// How urgently an element of probability `weight` with these expansions, one per component, should be divided.
pub fn division(projections: &[Projection], indices: &IndexSet, settings: &MultiElement, weight: f64) -> Division {
    let mut most = Division { urgency: 0.0, inputs: Vec::new() };
    for projection in projections {
        let urgency = decay_rate(projection, indices, settings.max_degree).powf(settings.gamma) * weight;
        if urgency > most.urgency {
            let inputs = sensitive_inputs(projection, indices, settings);
            most = Division { urgency, inputs };
        }
    }
    most
}

/// η, zero for components that do not vary.
fn decay_rate(projection: &Projection, indices: &IndexSet, degree: u16) -> f64 {
    let squares = |holds: &dyn Fn(u16) -> bool| squares(projection, indices, |alpha| holds(alpha.iter().sum()));
    let (highest, all) = (squares(&|order| order == degree), squares(&|order| order > 0));
    if all > 0.0 { highest / all } else { 0.0 }
}

/// The inputs with r_j ≥ θ₂ max r_k. If only products carry the highest order, an input's share is that of the terms it
/// is in.
fn sensitive_inputs(projection: &Projection, indices: &IndexSet, settings: &MultiElement) -> Vec<usize> {
    let (inputs, degree) = (indices[0].len(), settings.max_degree);
    let highest = |alpha: &[u16]| alpha.iter().sum::<u16>() == degree;
    let alone = |j: usize| squares(projection, indices, |alpha| alpha[j] == degree && highest(alpha));
    let together = |j: usize| squares(projection, indices, |alpha| alpha[j] > 0 && highest(alpha));
    let all = squares(projection, indices, highest);
    let mut shares: Vec<(usize, f64)> = (0..inputs).map(|j| (j, alone(j))).collect();
    if shares.iter().all(|(_, share)| *share <= ROUNDING * all) {
        shares = (0..inputs).map(|j| (j, together(j))).collect();
    }
    let largest = shares.iter().map(|(_, share)| *share).fold(0.0, f64::max);
    shares.retain(|(_, share)| *share >= settings.theta_2 * (1.0 - EQUAL) * largest);
    let mut inputs = Vec::with_capacity(shares.len());
    while !shares.is_empty() {
        let most = shares.iter().map(|(_, share)| *share).fold(0.0, f64::max);
        let at = shares.iter().position(|(_, share)| *share >= (1.0 - EQUAL) * most).unwrap_or(0);
        inputs.push(shares.remove(at).0);
    }
    inputs
}

fn squares(projection: &Projection, indices: &IndexSet, holds: impl Fn(&[u16]) -> bool) -> f64 {
    let terms = indices.iter().zip(&projection.coefficients);
    terms.filter(|(alpha, _)| holds(alpha)).fold(0.0, |sum, (_, c)| sum + c * c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::fit::gpc::total_degree;

    const SETTINGS: MultiElement = MultiElement { max_degree: 2, theta_1: 0.01, theta_2: 0.5, gamma: 0.5, elements: 9 };

    /// Coefficients of 1, x, y, x², xy, y².
    fn projection(coefficients: [f64; 6]) -> Projection {
        Projection { coefficients: coefficients.to_vec(), variance: 1.0, mean_square_residual: 0.0 }
    }

    fn of(coefficients: &[[f64; 6]]) -> Division {
        let projections: Vec<Projection> = coefficients.iter().map(|&c| projection(c)).collect();
        division(&projections, &total_degree(2, 2).unwrap(), &SETTINGS, 0.5)
    }

    #[test]
    fn urgency_is_the_share_of_the_highest_order_in_the_worst_component() {
        // η = 4/16 and 1/101.
        let found = of(&[[7.0, 3.0, 3f64.sqrt() * 1.0, 2.0, 0.0, 0.0], [0.0, 10.0, 0.0, 0.0, 0.0, 1.0]]);
        assert!((found.urgency - 0.25f64.sqrt() * 0.5).abs() < 1e-15);
        assert_eq!(found.inputs, [0]);
    }

    #[test]
    fn inputs_count_by_their_own_share_of_the_highest_order() {
        assert_eq!(of(&[[0.0, 1.0, 1.0, 1.0, 5.0, 2.0]]).inputs, [1], "1 is less than half of 4");
        assert_eq!(of(&[[0.0, 1.0, 1.0, 1.5, 5.0, 2.0]]).inputs, [1, 0]);
        assert_eq!(of(&[[0.0, 1.0, 1.0, 0.0, 5.0, 0.0]]).inputs, [0, 1], "only a product");
    }

    #[test]
    fn constant_components_ask_for_nothing() {
        assert_eq!(of(&[[3.0, 0.0, 0.0, 0.0, 0.0, 0.0]]), Division { urgency: 0.0, inputs: vec![] });
    }
}
