//! The Gaussian copula: inputs are monotone functions of normal scores z ~ N(0, R).
//!
//! The normal score of an input x with the distribution function F is z = Φ⁻¹(F(x)). Under a Gaussian copula the scores
//! of all inputs together are normal, so that their correlations R say all of the dependence, whatever the laws are.

use super::factor::Factor;
use thiserror::Error;

/// Inputs that may depend on others: matrices of some megabytes.
const MOST_MEMBERS: usize = 1000;

/// What the others leave of the variance of each score, at least: less is lost in rounding. The smallest eigenvalue of
/// their matrix is not more than what is left.
pub const LEAST_LEFT: f64 = 1e-10;

/// The correlation of the normal scores of two inputs, by their positions from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correlation {
    /// The input that comes first in the order of the inputs.
    pub first: usize,
    /// The other one.
    pub second: usize,
    /// Correlation of their normal scores, between −1 and 1, not 0.
    pub value: f64,
}

/// Why correlations are no dependence.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CopulaError {
    /// A position that no input has.
    #[error("there is no input number {input}; they are numbered from 0 to {}", dimension.saturating_sub(1))]
    NoSuchInput {
        /// Its position.
        input: usize,
        /// Number of inputs.
        dimension: usize,
    },
    /// An input with itself.
    #[error("input number {input} is correlated with itself; name two inputs")]
    WithItself {
        /// Its position.
        input: usize,
    },
    /// A pair that stands twice.
    #[error("the correlation of inputs number {first} and {second} is given twice")]
    Twice {
        /// One input.
        first: usize,
        /// The other.
        second: usize,
    },
    /// No correlation.
    #[error("a correlation of {value:?} is not between -1 and 1")]
    Value {
        /// Its value.
        value: f64,
    },
    /// Correlations that contradict each other, or leave an input nothing of its own.
    #[error("the correlations cannot hold together: their matrix is not positive definite")]
    NotPositiveDefinite,
    /// Too many inputs.
    #[error("{found} inputs depend on each other; at most {MOST_MEMBERS} can")]
    TooMany {
        /// Number of dependent inputs.
        found: usize,
    },
}

/// A Gaussian copula of inputs, of which some may be independent of all others.
///
/// # Formula
///
/// C(u) = Φ_R(Φ⁻¹(u_1), …, Φ⁻¹(u_r)), with the distribution function Φ_R of the normal law with unit variances and
/// correlations R.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::dependence::GaussianCopula;
/// let copula = GaussianCopula::new(4, [(3, 1, 0.6)])?;
/// assert_eq!((copula.correlation(1, 3), copula.correlation(0, 1)), (0.6, 0.0));
/// assert_eq!(copula.blocks(), [vec![1, 3]]);
/// assert!(GaussianCopula::new(3, [(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)]).is_err());
/// # Ok::<(), pcc_evaluate::probability::dependence::CopulaError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GaussianCopula {
    dimension: usize,
    /// By first, then second input; none is 0.
    correlations: Vec<Correlation>,
    /// The inputs that depend on others, ascending.
    members: Vec<usize>,
    /// Their correlations, row by row.
    matrix: Vec<f64>,
    /// Those that depend on each other, directly or by others, ascending; by their first member.
    blocks: Vec<Vec<usize>>,
}

impl GaussianCopula {
    /// The copula of `dimension` inputs in which these pairs have these correlations of normal scores, and no others.
    ///
    /// # Errors
    ///
    /// [`CopulaError`]: positions that no input has, an input with itself, a pair twice, values that are not between −1
    /// and 1, or values that cannot hold together.
    pub fn new(dimension: usize, pairs: impl IntoIterator<Item = (usize, usize, f64)>) -> Result<Self, CopulaError> {
        let correlations = sorted(dimension, pairs)?;
        let mut members: Vec<usize> = correlations.iter().flat_map(|pair| [pair.first, pair.second]).collect();
        members.sort_unstable();
        members.dedup();
        if members.len() > MOST_MEMBERS {
            return Err(CopulaError::TooMany { found: members.len() });
        }
        let size = members.len();
        let mut matrix = vec![0.0; size * size];
        (0..size).for_each(|k| matrix[k * size + k] = 1.0);
        let position = |input: usize| members.partition_point(|&member| member < input);
        for Correlation { first, second, value } in &correlations {
            let (i, k) = (position(*first), position(*second));
            matrix[i * size + k] = *value;
            matrix[k * size + i] = *value;
        }
        let blocks = blocks(&members, &matrix);
        let copula = Self { dimension, correlations, members, matrix, blocks };
        let holds = |block: &Vec<usize>| copula.factor(block).least_variance_left() >= LEAST_LEFT;
        if copula.blocks.iter().all(holds) { Ok(copula) } else { Err(CopulaError::NotPositiveDefinite) }
    }

    /// Number of inputs, independent ones too.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The correlations that are not zero, by first, then second input.
    pub fn correlations(&self) -> &[Correlation] {
        &self.correlations
    }

    /// The correlation of the normal scores of two inputs.
    pub fn correlation(&self, one: usize, other: usize) -> f64 {
        match (self.members.binary_search(&one), self.members.binary_search(&other)) {
            (Ok(i), Ok(k)) => self.matrix[i * self.members.len() + k],
            _ => f64::from(one == other),
        }
    }

    /// The inputs that depend on others, ascending.
    pub fn members(&self) -> &[usize] {
        &self.members
    }

    /// Lists of inputs that depend on each other, directly or by others; each list is independent of all else.
    pub fn blocks(&self) -> &[Vec<usize>] {
        &self.blocks
    }

    /// The list that an input belongs to, if it depends on others.
    pub fn block_of(&self, input: usize) -> Option<&[usize]> {
        self.blocks.iter().find(|block| block.contains(&input)).map(Vec::as_slice)
    }

    /// The Cholesky factor of the correlations of these inputs in this order.
    pub fn factor(&self, order: &[usize]) -> Factor {
        Factor::of(order.len(), |k, i| self.correlation(order[k], order[i]))
    }
}

/// The pairs that are not zero, checked, in order.
fn sorted(
    dimension: usize,
    pairs: impl IntoIterator<Item = (usize, usize, f64)>,
) -> Result<Vec<Correlation>, CopulaError> {
    let mut correlations = Vec::new();
    for (one, other, value) in pairs {
        if let Some(input) = [one, other].into_iter().find(|&input| input >= dimension) {
            return Err(CopulaError::NoSuchInput { input, dimension });
        }
        if one == other {
            return Err(CopulaError::WithItself { input: one });
        }
        // False for what is no number.
        let is_correlation = value.abs() < 1.0;
        if !is_correlation {
            return Err(CopulaError::Value { value });
        }
        correlations.push(Correlation { first: one.min(other), second: one.max(other), value });
    }
    correlations.sort_by_key(|pair| (pair.first, pair.second));
    let same = |pair: &[Correlation]| (pair[0].first, pair[0].second) == (pair[1].first, pair[1].second);
    if let Some(pair) = correlations.windows(2).find(|pair| same(pair)) {
        return Err(CopulaError::Twice { first: pair[0].first, second: pair[0].second });
    }
    correlations.retain(|pair| pair.value != 0.0);
    Ok(correlations)
}

/// The connected parts of the graph of correlations.
fn blocks(members: &[usize], matrix: &[f64]) -> Vec<Vec<usize>> {
    let size = members.len();
    let (mut blocks, mut is_seen) = (Vec::new(), vec![false; size]);
    for start in 0..size {
        if is_seen[start] {
            continue;
        }
        is_seen[start] = true;
        let mut found = vec![start];
        let mut next = 0;
        while next < found.len() {
            let row = &matrix[found[next] * size..(found[next] + 1) * size];
            for (k, &value) in row.iter().enumerate() {
                if value != 0.0 && !is_seen[k] {
                    is_seen[k] = true;
                    found.push(k);
                }
            }
            next += 1;
        }
        found.sort_unstable();
        blocks.push(found.into_iter().map(|k| members[k]).collect());
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_depends_on_each_other_forms_blocks() {
        let copula = GaussianCopula::new(8, [(5, 2, 0.3), (1, 7, -0.4), (2, 6, 0.1), (0, 3, 0.0)]).unwrap();
        assert_eq!(copula.blocks(), [vec![1, 7], vec![2, 5, 6]]);
        assert_eq!(copula.members(), [1, 2, 5, 6, 7]);
        assert_eq!((copula.block_of(6), copula.block_of(0)), (Some(&[2, 5, 6][..]), None));
        let stated: Vec<_> = copula.correlations().iter().map(|pair| (pair.first, pair.second, pair.value)).collect();
        assert_eq!(stated, [(1, 7, -0.4), (2, 5, 0.3), (2, 6, 0.1)]);
        assert_eq!([(5, 6), (6, 2), (0, 0), (7, 7)].map(|(i, k)| copula.correlation(i, k)), [0.0, 0.1, 1.0, 1.0]);
        assert!(GaussianCopula::new(2, [(0, 1, 0.0)]).unwrap().members().is_empty());
    }

    #[test]
    fn what_is_no_dependence_is_refused() {
        let refusal = |pairs: &[(usize, usize, f64)]| GaussianCopula::new(4, pairs.iter().copied()).unwrap_err();
        assert_eq!(refusal(&[(0, 4, 0.5)]), CopulaError::NoSuchInput { input: 4, dimension: 4 });
        assert_eq!(refusal(&[(2, 2, 0.5)]), CopulaError::WithItself { input: 2 });
        assert_eq!(refusal(&[(2, 1, 0.5), (0, 1, 0.1), (1, 2, 0.5)]), CopulaError::Twice { first: 1, second: 2 });
        for value in [1.0, -1.0, 1.5, f64::INFINITY] {
            assert_eq!(refusal(&[(0, 1, value)]), CopulaError::Value { value });
        }
        assert!(matches!(refusal(&[(0, 1, f64::NAN)]), CopulaError::Value { .. }));
        // 0.9, 0.9 and c hold together from c = 0.62 on.
        let triangle = |value| GaussianCopula::new(4, [(0, 1, 0.9), (1, 2, 0.9), (0, 2, value)]);
        assert!(triangle(0.63).is_ok());
        assert_eq!(triangle(0.61), Err(CopulaError::NotPositiveDefinite));
        assert_eq!(refusal(&[(0, 1, 1.0 - 1e-12)]), CopulaError::NotPositiveDefinite);
        let chain = (0..1000).map(|k| (k, k + 1, 0.1));
        assert_eq!(GaussianCopula::new(2000, chain), Err(CopulaError::TooMany { found: 1001 }));
    }
}
