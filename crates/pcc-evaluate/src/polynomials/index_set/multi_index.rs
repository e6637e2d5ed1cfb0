//! One multi-index, and a sorted set of them.

use std::cmp::Ordering;
use std::ops::Deref;
use std::sync::Arc;

/// A multi-index α: the polynomial degree in each of r variables.
///
/// The canonical order is by total degree |α|, then the larger degree in the first variable first: (0,0), (1,0), (0,1),
/// (2,0), (1,1), (0,2), …
///
/// # Examples
///
/// ```
/// use pcc_evaluate::polynomials::MultiIndex;
/// let alpha = MultiIndex::new(vec![2, 0, 1]);
/// assert_eq!(alpha.total_degree(), 3);
/// assert!(MultiIndex::constant(3) < alpha);
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct MultiIndex(Box<[u16]>);

impl MultiIndex {
    /// The multi-index with the given degrees.
    pub fn new(degrees: Vec<u16>) -> Self {
        Self(degrees.into_boxed_slice())
    }

    /// {0}, the index of the constant.
    pub fn constant(inputs: usize) -> Self {
        Self::new(vec![0; inputs])
    }

    /// |α| = Σ α_j.
    pub fn total_degree(&self) -> u32 {
        self.iter().map(|&degree| u32::from(degree)).sum()
    }

    /// Whether this is {0}.
    pub fn is_constant(&self) -> bool {
        self.iter().all(|&degree| degree == 0)
    }
}

impl Deref for MultiIndex {
    type Target = [u16];

    fn deref(&self) -> &[u16] {
        &self.0
    }
}

impl Ord for MultiIndex {
    fn cmp(&self, other: &Self) -> Ordering {
        self.total_degree().cmp(&other.total_degree()).then_with(|| other.0.cmp(&self.0))
    }
}

impl PartialOrd for MultiIndex {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A set of distinct multi-indices in canonical order. Copies share their memory: elements and components often have
/// the same.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::polynomials::{IndexSet, MultiIndex};
/// let set = IndexSet::from_unsorted(vec![MultiIndex::new(vec![0, 1]), MultiIndex::constant(2)]);
/// assert!(set[0].is_constant());
/// assert_eq!(set.highest_degrees(2), [0, 1]);
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct IndexSet(Arc<[MultiIndex]>);

impl IndexSet {
    /// Sorts `indices` and drops repetitions.
    pub fn from_unsorted(mut indices: Vec<MultiIndex>) -> Self {
        indices.sort_unstable();
        indices.dedup();
        Self(indices.into())
    }

    /// Takes `indices` as they are if they are sorted and distinct.
    pub fn from_sorted(indices: Vec<MultiIndex>) -> Option<Self> {
        indices.is_sorted_by(|a, b| a < b).then(|| Self(indices.into()))
    }

    /// The highest degree in each of `inputs` variables.
    pub fn highest_degrees(&self, inputs: usize) -> Vec<u16> {
        let mut highest = vec![0; inputs];
        for alpha in self.0.iter() {
            for (maximum, &degree) in highest.iter_mut().zip(alpha.iter()) {
                *maximum = degree.max(*maximum);
            }
        }
        highest
    }
}

impl Deref for IndexSet {
    type Target = [MultiIndex];

    fn deref(&self) -> &[MultiIndex] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_is_by_total_degree_then_first_variable() {
        let set = IndexSet::from_unsorted(
            [[0, 2], [1, 1], [0, 0], [0, 1], [2, 0], [1, 0], [1, 1]].map(|a| MultiIndex::new(a.to_vec())).to_vec(),
        );
        let found: Vec<&[u16]> = set.iter().map(|alpha| &**alpha).collect();
        assert_eq!(found, [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]]);
    }

    #[test]
    fn unsorted_or_repeated_indices_are_not_taken_as_sorted() {
        let (zero, one) = (MultiIndex::constant(1), MultiIndex::new(vec![1]));
        assert!(IndexSet::from_sorted(vec![zero.clone(), one.clone()]).is_some());
        assert!(IndexSet::from_sorted(vec![one.clone(), zero]).is_none());
        assert!(IndexSet::from_sorted(vec![one.clone(), one]).is_none());
    }
}
