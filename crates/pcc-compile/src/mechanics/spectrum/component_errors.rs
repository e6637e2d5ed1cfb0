//! How far components can be from the truth, because eigenvalues are computed.
//!
//! A component is a function of eigenvalues λ_i that are known to ±τ_i in Re λ and to ±ρ_i as a whole. To first order a
//! complex one moves by Σ g_i δλ_i with g_i = ∂f/∂λ_i, so
//!
//! |Re δf| ≤ Σ |Re g_i| τ_i + |Im g_i| ρ_i,   |Im δf| ≤ Σ |Im g_i| τ_i + |Re g_i| ρ_i.
//!
//! Of an undamped system this tells what is zero: the damping of a group and all that follows from it.

use crate::numerics::accuracy::Accuracy;
use nalgebra::Complex;
use pcc_evaluate::components::OutputKind;

/// The errors of the components of a group with these eigenvalues, in the order of its kind. Closed groups come with
/// their conjugates.
pub fn component_errors(kind: OutputKind, lambdas: &[Complex<f64>], accuracies: &[Accuracy]) -> Vec<f64> {
    let add = |sums: &mut [f64; 2], slope: Complex<f64>, accuracy: &Accuracy| {
        // Not 0 · ∞, which is no number.
        let times = |factor: f64, error: f64| if factor == 0.0 { 0.0 } else { factor.abs() * error };
        sums[0] += times(slope.re, accuracy.re) + times(slope.im, accuracy.whole);
        sums[1] += times(slope.im, accuracy.re) + times(slope.re, accuracy.whole);
    };
    let of_slopes = |slopes: &[Complex<f64>]| {
        let mut sums = [0.0; 2];
        slopes.iter().zip(accuracies).for_each(|(&slope, accuracy)| add(&mut sums, slope, accuracy));
        sums
    };
    let count = lambdas.len();
    match kind {
        OutputKind::Eigenvalue => of_slopes(&[Complex::new(1.0, 0.0)]).to_vec(),
        OutputKind::Cluster => {
            let mean = lambdas.iter().sum::<Complex<f64>>() / count as f64;
            let centered: Vec<Complex<f64>> = lambdas.iter().map(|lambda| lambda - mean).collect();
            // Π_{l≠j}(z − z_l), highest power first.
            let without: Vec<Vec<Complex<f64>>> = (0..count).map(|j| product_without(&centered, j)).collect();
            let total = |k: usize| without.iter().map(|one| one[k]).sum::<Complex<f64>>() / count as f64;
            let mut errors = of_slopes(&vec![Complex::new(1.0 / count as f64, 0.0); count]).to_vec();
            for k in 1..count {
                // Each root takes the mean with it.
                let slopes: Vec<Complex<f64>> = without.iter().map(|one| total(k) - one[k]).collect();
                errors.extend(of_slopes(&slopes));
            }
            errors
        }
        OutputKind::Closed => {
            let without: Vec<Vec<Complex<f64>>> = (0..count).map(|j| product_without(lambdas, j)).collect();
            // ∂e_m/∂λ_j = e_{m−1} without λ_j, and the whole is real.
            (0..count).map(|k| of_slopes(&without.iter().map(|one| one[k]).collect::<Vec<_>>())[0]).collect()
        }
    }
}

/// The coefficients of Π_{l≠j}(z − z_l), highest power first.
fn product_without(roots: &[Complex<f64>], j: usize) -> Vec<Complex<f64>> {
    let mut product = vec![Complex::new(1.0, 0.0)];
    for (_, root) in roots.iter().enumerate().filter(|(l, _)| *l != j) {
        product.push(Complex::default());
        for k in (1..product.len()).rev() {
            let lower = product[k - 1] * root;
            product[k] -= lower;
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::spectrum::components_of;

    /// Errors are those of moving every eigenvalue by as much as it may.
    #[test]
    fn errors_hold_what_eigenvalues_that_move_do_to_components() {
        let lambda = |re, im| Complex::new(re, im);
        let groups = [
            (OutputKind::Eigenvalue, vec![lambda(-0.1, 10.0)]),
            (OutputKind::Cluster, vec![lambda(0.0, 10.0), lambda(0.0, 12.0)]),
            (OutputKind::Cluster, vec![lambda(0.5, 11.0), lambda(-0.5, 11.0), lambda(-0.1, 14.0)]),
            (OutputKind::Closed, vec![lambda(0.0, 3.0), lambda(0.0, -3.0), lambda(0.0, 7.0), lambda(0.0, -7.0)]),
            (OutputKind::Closed, vec![lambda(-0.3, 0.0), lambda(-9.0, 0.0)]),
        ];
        let accuracy = Accuracy { re: 1e-7, whole: 1e-5 };
        for (kind, lambdas) in groups {
            let accuracies = vec![accuracy; lambdas.len()];
            let errors = component_errors(kind, &lambdas, &accuracies);
            let exact = components_of(kind, &lambdas);
            assert_eq!(errors.len(), exact.len());
            let mut largest = vec![0.0f64; exact.len()];
            for signs in 0..1u32 << (2 * lambdas.len()) {
                let sign = |bit: usize| if signs >> bit & 1 == 1 { 1.0 } else { -1.0 };
                let mut moved: Vec<Complex<f64>> = lambdas
                    .iter()
                    .enumerate()
                    .map(|(i, l)| {
                        let im = if l.im == 0.0 { 0.0 } else { sign(2 * i + 1) * accuracy.whole };
                        l + lambda(sign(2 * i) * accuracy.re, im)
                    })
                    .collect();
                if kind == OutputKind::Closed {
                    (1..moved.len()).filter(|k| lambdas[*k].im < 0.0).for_each(|k| moved[k] = moved[k - 1].conj());
                }
                for ((largest, exact), moved) in largest.iter_mut().zip(&exact).zip(components_of(kind, &moved)) {
                    *largest = largest.max((moved - exact).abs());
                }
            }
            for (error, largest) in errors.iter().zip(&largest) {
                // What is second order in the errors comes on top.
                assert!(*largest <= error * 1.001 + 1e-9, "{kind:?}: {errors:?} {largest:?}");
            }
        }
    }

    #[test]
    fn damping_of_undamped_groups_is_known_far_better_than_frequencies() {
        let lambdas = [Complex::new(0.0, 10.0), Complex::new(0.0, 12.0)];
        let errors = component_errors(OutputKind::Cluster, &lambdas, &[Accuracy { re: 1e-14, whole: 1e-6 }; 2]);
        // Re s and Im c₀ are the damping, Im s and Re c₀ the frequencies.
        assert!(errors[0] < 1e-13 && errors[3] < 1e-13, "{errors:?}");
        assert!(errors[1] > 1e-7 && errors[2] > 1e-7, "{errors:?}");
    }
}
