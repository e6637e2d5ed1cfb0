//! Isotropic hyperbolic index sets A^{r,p}_q = {α ∈ ℕʳ : ‖α‖_q ≤ p}, ‖α‖_q = (Σ α_j^q)^{1/q} (equations 12 and 13 of
//! the paper, which writes m for q). With q = 1 they are the total-degree sets of equation 5.

use super::multi_index::MultiIndex;
use thiserror::Error;

/// Norms are compared as Σ α_j^q ≤ p^q (1 + ROUNDING): (2, 2) has ‖α‖_½ = 8 exactly, and its sum of powers is off by an
/// ulp or two.
const ROUNDING: f64 = 1e-12;

/// More candidates than this are refused: at 32 inputs, the indices alone would fill a gigabyte.
const MOST_INDICES: usize = 10_000_000;

/// Why an index set was not generated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum IndexSetError {
    /// The set has more members than can be worked with.
    #[error(
        "the index set with {inputs} inputs, degree {degree} and q-norm {q_norm} has more than {MOST_INDICES} members; \
         lower the degree or the q-norm"
    )]
    TooLarge {
        /// Number of variables r.
        inputs: usize,
        /// Degree p.
        degree: u16,
        /// Norm exponent q.
        q_norm: f64,
    },
}

/// The nested sequence of hyperbolic sets for r variables and one norm q ∈ (0, 1].
///
/// # Examples
///
/// ```
/// use pcc_evaluate::polynomials::Hyperbolic;
/// let shells = Hyperbolic { inputs: 2, q_norm: 0.5 }.shells(4)?;
/// // With q = ½ the first mixed term, (1, 1), has norm (1 + 1)² = 4.
/// assert_eq!(shells[1].len(), 2);
/// assert_eq!(shells[4].len(), 3);
/// # Ok::<(), pcc_evaluate::polynomials::IndexSetError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hyperbolic {
    /// Number of variables r.
    pub inputs: usize,
    /// Norm exponent q, in (0, 1].
    pub q_norm: f64,
}

impl Hyperbolic {
    /// The sets {α : p − 1 < ‖α‖_q ≤ p} for p = 0, 1, …, `degree`, each in canonical order. Together they are
    /// A^{r,degree}_q.
    ///
    /// # Errors
    ///
    /// [`IndexSetError::TooLarge`] as soon as the set outgrows ten million members.
    pub fn shells(&self, degree: u16) -> Result<Vec<Vec<MultiIndex>>, IndexSetError> {
        let powers: Vec<f64> = (0..=degree).map(|k| f64::from(k).powf(self.q_norm)).collect();
        let mut generator = Generator {
            limits: powers.iter().map(|power| power * (1.0 + ROUNDING)).collect(),
            powers,
            shells: vec![Vec::new(); usize::from(degree) + 1],
            members: 0,
            alpha: vec![0; self.inputs],
        };
        if !generator.extend(0, 0.0) {
            return Err(IndexSetError::TooLarge { inputs: self.inputs, degree, q_norm: self.q_norm });
        }
        for shell in &mut generator.shells {
            shell.sort_unstable();
        }
        Ok(generator.shells)
    }
}

/// Depth-first walk over the variables: only members are visited, because the sum of powers never falls.
struct Generator {
    /// k^q for every degree k.
    powers: Vec<f64>,
    /// Largest sum of powers that belongs to A_p, for every p.
    limits: Vec<f64>,
    shells: Vec<Vec<MultiIndex>>,
    members: usize,
    alpha: Vec<u16>,
}

impl Generator {
    /// Chooses the degrees of the variables from `variable` on; `sum` is Σ α_j^q of those before. False if there are
    /// too many members.
    fn extend(&mut self, variable: usize, sum: f64) -> bool {
        if variable == self.alpha.len() {
            let shell = self.limits.partition_point(|&limit| limit < sum);
            self.shells[shell].push(MultiIndex::new(self.alpha.clone()));
            self.members += 1;
            return self.members <= MOST_INDICES;
        }
        let largest = self.limits[self.limits.len() - 1];
        for degree in 0..self.powers.len() {
            let extended = sum + self.powers[degree];
            if extended > largest {
                break;
            }
            self.alpha[variable] = degree as u16;
            if !self.extend(variable + 1, extended) {
                return false;
            }
        }
        self.alpha[variable] = 0;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomials::IndexSet;
    use proptest::prelude::*;

    fn set(inputs: usize, q_norm: f64, degree: u16) -> IndexSet {
        IndexSet::from_unsorted(Hyperbolic { inputs, q_norm }.shells(degree).unwrap().concat())
    }

    fn binomial(n: u64, k: u64) -> u64 {
        (1..=k).fold(1, |product, i| product * (n - k + i) / i)
    }

    proptest! {
        #[test]
        fn shells_equal_brute_force(inputs in 1..4usize, degree in 0..8u16, q_norm in 0.2..=1.0f64) {
            let side = usize::from(degree) + 1;
            let mut expected = vec![Vec::new(); side];
            for code in 0..side.pow(inputs as u32) {
                let alpha: Vec<u16> = (0..inputs).map(|j| (code / side.pow(j as u32) % side) as u16).collect();
                let norm = alpha.iter().map(|&a| f64::from(a).powf(q_norm)).sum::<f64>().powf(1.0 / q_norm);
                let shell = (norm * (1.0 - 1e-10)).ceil() as usize;
                if shell < side {
                    expected[shell].push(MultiIndex::new(alpha));
                }
            }
            expected.iter_mut().for_each(|shell| shell.sort());
            prop_assert_eq!(Hyperbolic { inputs, q_norm }.shells(degree).unwrap(), expected);
        }

        #[test]
        fn sets_are_downward_closed(inputs in 1..5usize, degree in 0..7u16, q_norm in 0.2..=1.0f64) {
            let set = set(inputs, q_norm, degree);
            for alpha in set.iter() {
                for j in (0..inputs).filter(|&j| alpha[j] > 0) {
                    let mut below = alpha.to_vec();
                    below[j] -= 1;
                    prop_assert!(set.binary_search(&MultiIndex::new(below)).is_ok());
                }
            }
        }
    }

    #[test]
    fn total_degree_sets_have_binomial_size() {
        for (inputs, degree) in [(1, 9), (2, 6), (3, 5), (8, 3), (8, 4)] {
            let expected = binomial(u64::from(degree) + inputs as u64, u64::from(degree));
            assert_eq!(set(inputs, 1.0, degree).len() as u64, expected);
        }
    }

    #[test]
    fn norms_that_are_whole_numbers_are_not_lost_to_rounding() {
        let shells = Hyperbolic { inputs: 2, q_norm: 0.5 }.shells(9).unwrap();
        let shell_of = |alpha: [u16; 2]| shells.iter().position(|s| s.contains(&MultiIndex::new(alpha.to_vec())));
        assert_eq!(shell_of([2, 2]), Some(8));
        assert_eq!(shell_of([1, 4]), Some(9));
        assert_eq!(shell_of([1, 1]), Some(4));
    }

    #[test]
    fn oversized_sets_are_refused_before_memory_runs_out() {
        let result = Hyperbolic { inputs: 40, q_norm: 1.0 }.shells(20);
        assert!(matches!(result, Err(IndexSetError::TooLarge { inputs: 40, degree: 20, .. })));
    }
}
