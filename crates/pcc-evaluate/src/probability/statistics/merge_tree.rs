//! Partial results combined in an order that does not depend on who computed them.

use serde::{Deserialize, Serialize};
use std::ops::Range;

/// What can be combined with what comes right after it.
pub trait Merge {
    /// Adds `next`.
    fn merge(&mut self, next: &Self);
}

/// Results of the items of a range, combined along a fixed binary tree over all items: neighbours 2i and 2i + 1 of one
/// level make item i of the next.
///
/// Floating-point sums depend on their order. Here the order is that of the tree, whatever parts a range was divided
/// into: a part holds only nodes whose items it has all of, at most two per level, and appending what follows
/// completes the nodes across the border. So any division gives the same bits.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::statistics::{MergeTree, Merge};
///
/// #[derive(Clone, PartialEq, Debug)]
/// struct Sum(f64);
/// impl Merge for Sum {
///     fn merge(&mut self, next: &Self) {
///         self.0 += next.0;
///     }
/// }
///
/// let sum_of = |items: std::ops::Range<u64>| {
///     let mut tree = MergeTree::new(items.start);
///     items.for_each(|i| tree.push(Sum(1.0 / (i + 1) as f64)));
///     tree
/// };
/// let whole = sum_of(0..1000);
/// let mut parts = sum_of(0..123);
/// assert!(parts.append(sum_of(123..700)) && parts.append(sum_of(700..1000)));
/// assert_eq!(parts.total(), whole.total());
/// assert!(!parts.append(sum_of(1200..1300)), "there is a gap");
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MergeTree<T> {
    first: u64,
    /// In the order of their items, without gaps.
    trees: Vec<Tree<T>>,
}

/// Items `index` · 2^`level` … (`index` + 1) · 2^`level` − 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Tree<T> {
    level: u32,
    index: u64,
    value: T,
}

impl<T> Tree<T> {
    /// The item after the last; `None` if that is beyond all numbers.
    fn end(&self) -> Option<u64> {
        self.index.checked_add(1)?.checked_mul(1u64.checked_shl(self.level)?)
    }

    fn start(&self) -> Option<u64> {
        self.index.checked_mul(1u64.checked_shl(self.level)?)
    }
}

impl<T: Merge> MergeTree<T> {
    /// No items yet; `first` will be the first.
    pub fn new(first: u64) -> Self {
        Self { first, trees: Vec::new() }
    }

    /// The first item.
    pub fn first(&self) -> u64 {
        self.first
    }

    /// The item after the last.
    pub fn end(&self) -> u64 {
        self.trees.last().and_then(Tree::end).unwrap_or(self.first)
    }

    /// Adds the next item.
    pub fn push(&mut self, value: T) {
        self.push_tree(Tree { level: 0, index: self.end(), value });
    }

    /// Adds the items of `next` if they begin where these end; otherwise nothing changes, and the answer is false.
    pub fn append(&mut self, next: Self) -> bool {
        let fits = next.first == self.end();
        if fits {
            next.trees.into_iter().for_each(|tree| self.push_tree(tree));
        }
        fits
    }

    /// All items combined: tree after tree, from the first; `None` without items.
    pub fn total(&self) -> Option<T>
    where
        T: Clone,
    {
        let (first, rest) = self.trees.split_first()?;
        let mut total = first.value.clone();
        rest.iter().for_each(|tree| total.merge(&tree.value));
        Some(total)
    }

    /// What is held of which items, for checks of what was read from a file.
    pub fn parts(&self) -> impl Iterator<Item = (Range<u64>, &T)> {
        let range = |tree: &Tree<T>| tree.start().unwrap_or(u64::MAX)..tree.end().unwrap_or(u64::MAX);
        self.trees.iter().map(move |tree| (range(tree), &tree.value))
    }

    /// Whether the trees follow one another without gaps from `first`, none is half of a tree that is complete, and no
    /// number overflows: what [`Self::push`] and [`Self::append`] keep true, and a file may not.
    pub fn is_consistent(&self) -> bool {
        let mut end = Some(self.first);
        let follows = self.trees.iter().all(|tree| {
            let fits = end.is_some() && tree.start() == end;
            end = tree.end();
            fits && end.is_some()
        });
        follows && self.trees.windows(2).all(|pair| !are_siblings(&pair[0], &pair[1]))
    }

    fn push_tree(&mut self, mut tree: Tree<T>) {
        while let Some(before) = self.trees.pop_if(|before| are_siblings(before, &tree)) {
            let mut value = before.value;
            value.merge(&tree.value);
            tree = Tree { level: tree.level + 1, index: tree.index / 2, value };
        }
        self.trees.push(tree);
    }
}

fn are_siblings<T>(left: &Tree<T>, right: &Tree<T>) -> bool {
    left.level == right.level && left.index.is_multiple_of(2) && right.index == left.index + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The items in brackets, as they were combined.
    #[derive(Debug, Clone, PartialEq)]
    struct Brackets(String);

    impl Merge for Brackets {
        fn merge(&mut self, next: &Self) {
            self.0 = format!("({} {})", self.0, next.0);
        }
    }

    fn tree(items: std::ops::Range<u64>) -> MergeTree<Brackets> {
        let mut tree = MergeTree::new(items.start);
        items.for_each(|i| tree.push(Brackets(i.to_string())));
        tree
    }

    proptest! {
        #[test]
        fn any_division_gives_the_same_trees(count in 1..200u64, mut cuts in prop::collection::vec(0..200u64, 0..6)) {
            cuts.iter_mut().for_each(|cut| *cut = (*cut).min(count));
            cuts.push(count);
            cuts.sort_unstable();
            let mut start = 0;
            let mut parts = MergeTree::new(0);
            for cut in cuts {
                let part = tree(start..cut);
                prop_assert!(part.is_consistent() && part.end() == cut);
                prop_assert!(parts.append(part));
                start = cut;
            }
            prop_assert_eq!(&parts, &tree(0..count));
            prop_assert!(parts.is_consistent());
        }

        #[test]
        fn a_part_holds_two_trees_per_level_at_most(start in 0..1000u64, count in 0..1000u64) {
            let part = tree(start..start + count);
            prop_assert!(part.trees.len() <= 20);
        }
    }

    #[test]
    fn the_order_is_that_of_the_tree() {
        assert_eq!(tree(0..6).total().unwrap().0, "(((0 1) (2 3)) (4 5))");
        assert_eq!(tree(3..6).total().unwrap().0, "(3 (4 5))");
        assert_eq!(tree(0..0).total(), None);
    }

    #[test]
    fn gaps_and_overlaps_are_not_appended() {
        let mut parts = tree(0..4);
        assert!(!parts.append(tree(5..6)) && !parts.append(tree(3..6)));
        assert_eq!(parts, tree(0..4));
        assert!(parts.append(tree(4..4)) && parts.append(tree(4..9)));
    }

    #[test]
    fn broken_trees_are_found() {
        let broken: [fn(&mut MergeTree<Brackets>); 5] = [
            |tree| tree.first = 1,
            |tree| tree.trees[1].index += 1,
            |tree| tree.trees[1].level = 70,
            |tree| tree.trees[1].index = u64::MAX,
            |tree| {
                let last = Tree { level: 0, index: 7, value: Brackets(String::new()) };
                tree.trees.push(last);
            },
        ];
        for damage in broken {
            let mut whole = tree(0..7);
            assert!(whole.is_consistent());
            damage(&mut whole);
            assert!(!whole.is_consistent(), "{whole:?}");
        }
    }
}
