//! Numbers of modes and real eigenvalues, given once: by what the surrogate says in the middle of the inputs, where
//! all have their medians.
//!
//! From 1, the modes that oscillate there by natural frequency |λ| (of equal ones by Im λ, then Re λ), then the modes
//! that are overdamped there, by √|λλ′| of their two eigenvalues. Eigenvalues that are real and belong to no mode have
//! numbers of their own, the largest first. Inside a group numbers follow order, not identity.

use crate::mechanics::spectrum::Numbers;
use nalgebra::Complex;
use pcc_evaluate::components::{Label, Output};
use std::cmp::Ordering;

/// What a mode is ranked by.
#[derive(Debug, Clone, Copy)]
struct Key {
    is_overdamped: bool,
    frequency: f64,
    lambda: Complex<f64>,
}

impl Key {
    fn compare(&self, other: &Self) -> Ordering {
        self.is_overdamped
            .cmp(&other.is_overdamped)
            .then(self.frequency.total_cmp(&other.frequency))
            .then(self.lambda.im.total_cmp(&other.lambda.im))
            .then(self.lambda.re.total_cmp(&other.lambda.re))
    }
}

/// The numbers of every output, given its eigenvalues in the middle of the inputs in the order of its labels.
pub(super) fn numbers(outputs: &[(&Output, Vec<Complex<f64>>)]) -> Vec<Numbers> {
    let mut modes: Vec<(usize, Key)> = Vec::new();
    let mut reals: Vec<(usize, f64)> = Vec::new();
    for (at, (output, lambdas)) in outputs.iter().enumerate() {
        let labelled: Vec<(Label, Complex<f64>)> = output.labels().zip(lambdas.iter().copied()).collect();
        for &(label, lambda) in &labelled {
            match label {
                Label::Mode(mode) => {
                    let second = labelled.iter().find(|(other, _)| *other == Label::Second(mode));
                    let second = second.map_or(lambda.conj(), |&(_, second)| second);
                    let frequency = (lambda.norm() * second.norm()).sqrt();
                    modes.push((at, Key { is_overdamped: lambda.im == 0.0, frequency, lambda }));
                }
                Label::Real(_) => reals.push((at, lambda.re)),
                Label::Second(_) => {}
            }
        }
    }
    modes.sort_by(|a, b| a.1.compare(&b.1).then(a.0.cmp(&b.0)));
    reals.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut numbers = vec![Numbers::default(); outputs.len()];
    modes.iter().enumerate().for_each(|(k, (at, _))| numbers[*at].modes.push(k + 1));
    reals.iter().enumerate().for_each(|(k, (at, _))| numbers[*at].reals.push(k + 1));
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::spectrum::output;
    use pcc_evaluate::components::OutputKind;

    fn group(kind: OutputKind, modes: usize, reals: usize, lambdas: &[(f64, f64)]) -> (Output, Vec<Complex<f64>>) {
        let lambdas: Vec<_> = lambdas.iter().map(|&(re, im)| Complex::new(re, im)).collect();
        let numbers = Numbers { modes: (1..=modes).collect(), reals: (1..=reals).collect() };
        (output(kind, &numbers, std::slice::from_ref(&lambdas)), lambdas)
    }

    #[test]
    fn oscillating_modes_come_first_then_overdamped_ones_then_real_eigenvalues() {
        let groups = [
            group(OutputKind::Closed, 1, 0, &[(-1.0, 0.0), (-4.0, 0.0)]),
            group(OutputKind::Eigenvalue, 1, 0, &[(-5.0, 30.0)]),
            group(OutputKind::Closed, 1, 2, &[(-0.1, 20.0), (-0.1, -20.0), (-0.5, 0.0), (-9.0, 0.0)]),
            group(OutputKind::Closed, 0, 1, &[(-2.0, 0.0)]),
        ];
        let borrowed: Vec<_> = groups.iter().map(|(output, lambdas)| (output, lambdas.clone())).collect();
        let found = numbers(&borrowed);
        let modes: Vec<_> = found.iter().map(|numbers| numbers.modes.clone()).collect();
        let reals: Vec<_> = found.iter().map(|numbers| numbers.reals.clone()).collect();
        assert_eq!(modes, [vec![3], vec![2], vec![1], vec![]]);
        assert_eq!(reals, [vec![], vec![], vec![1, 3], vec![2]]);
    }
}
