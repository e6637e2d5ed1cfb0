//! A box divided into elements: axis-parallel boxes of the standardized variables, found by a tree of splits.
//!
//! Multi-element expansions have one set of polynomials per element, in the local variables (ξ − center)/half width
//! (equation 10 of the paper). A global expansion has one element, the whole box \[−1, 1\]ʳ. All inputs are uniform, so
//! the probability of an element is its volume over 2ʳ.

use thiserror::Error;

/// Sides narrower than this are not split: differences of local variables would lose more than half of their digits.
const NARROWEST_SIDE: f64 = 1.0 / (1u64 << 26) as f64;

/// A stored weight and the product of its sides differ by roundings at most.
const ROUNDING: f64 = 1e-12;

/// Why elements and splits form no mesh.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeshError {
    /// A number of an element or a split that does not exist, or an input that does not.
    #[error("split {split} leads to an element, split or input that does not exist")]
    Missing {
        /// Position of the split.
        split: usize,
    },
    /// The splits are no tree that reaches every element once.
    #[error("the splits do not lead to every element, or to one of them twice")]
    NoTree,
    /// A split outside the box that it divides.
    #[error("split {split} does not lie inside the box it divides")]
    Outside {
        /// Position of the split.
        split: usize,
    },
    /// An element is not the box that the splits leave for it, or its weight is not its probability.
    #[error("element {element} is not the box that the splits give it, or its weight is wrong")]
    OtherBox {
        /// Position of the element.
        element: usize,
    },
}

/// A box in standardized coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Its probability.
    pub weight: f64,
    /// Lower bounds, per input.
    pub lower: Vec<f64>,
    /// Upper bounds, per input.
    pub upper: Vec<f64>,
}

impl Element {
    /// The box between these bounds inside \[−1, 1\]ʳ, all inputs uniform.
    pub fn new(lower: Vec<f64>, upper: Vec<f64>) -> Self {
        let weight = lower.iter().zip(&upper).map(|(lower, upper)| 0.5 * (upper - lower)).product();
        Self { weight, lower, upper }
    }

    /// Middle of side `input`.
    pub fn center(&self, input: usize) -> f64 {
        0.5 * (self.lower[input] + self.upper[input])
    }

    /// Half the length of side `input`.
    pub fn half_width(&self, input: usize) -> f64 {
        0.5 * (self.upper[input] - self.lower[input])
    }

    /// Local variables, in \[−1, 1\]ʳ inside the element, of the standardized point ξ.
    pub fn local(&self, standardized: &[f64]) -> Vec<f64> {
        let map = |(j, xi): (usize, &f64)| (xi - self.center(j)) / self.half_width(j);
        standardized.iter().enumerate().map(map).collect()
    }

    /// The standardized point with these local variables.
    pub fn standardized(&self, local: &[f64]) -> Vec<f64> {
        local.iter().enumerate().map(|(j, zeta)| self.center(j) + self.half_width(j) * zeta).collect()
    }
}

/// What lies on one side of a split.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Branch {
    /// An element, by its position.
    Element(usize),
    /// A further split, by its position.
    Split(usize),
}

/// A node of the split tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// Position of the input.
    pub input: usize,
    /// Points with ξ_input below this go below, others above.
    pub at: f64,
    /// What lies below.
    pub below: Branch,
    /// What lies above.
    pub above: Branch,
}

/// The box \[−1, 1\]ʳ, divided into elements.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::polynomials::Mesh;
/// let mut mesh = Mesh::whole(2);
/// mesh.halve(0, &[1]);
/// assert_eq!(mesh.elements().len(), 2);
/// assert_eq!((mesh.locate(&[0.9, -0.1]), mesh.locate(&[0.9, 0.0])), (0, 1));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    elements: Vec<Element>,
    /// The first is the root; empty for one element.
    splits: Vec<Split>,
}

impl Mesh {
    /// The whole box \[−1, 1\]ʳ as one element.
    pub fn whole(dimension: usize) -> Self {
        Self { elements: vec![Element::new(vec![-1.0; dimension], vec![1.0; dimension])], splits: Vec::new() }
    }

    /// A mesh as stored.
    ///
    /// # Errors
    ///
    /// [`MeshError`] unless the splits divide the whole box into exactly these elements.
    pub fn from_parts(dimension: usize, elements: Vec<Element>, splits: Vec<Split>) -> Result<Self, MeshError> {
        if elements.len() != splits.len() + 1 {
            return Err(MeshError::NoTree);
        }
        let whole = Element::new(vec![-1.0; dimension], vec![1.0; dimension]);
        let root = if splits.is_empty() { Branch::Element(0) } else { Branch::Split(0) };
        let mut seen = vec![false; splits.len()];
        let mut reached = vec![false; elements.len()];
        let mut open = vec![(root, whole, 0)];
        while let Some((branch, space, from)) = open.pop() {
            match branch {
                Branch::Element(at) => {
                    let element = elements.get(at).ok_or(MeshError::Missing { split: from })?;
                    if std::mem::replace(&mut reached[at], true) {
                        return Err(MeshError::NoTree);
                    }
                    let is_same = (&element.lower, &element.upper) == (&space.lower, &space.upper);
                    if !is_same || (element.weight - space.weight).abs() > ROUNDING * space.weight {
                        return Err(MeshError::OtherBox { element: at });
                    }
                }
                Branch::Split(at) => {
                    let split = splits.get(at).ok_or(MeshError::Missing { split: from })?;
                    if std::mem::replace(&mut seen[at], true) {
                        return Err(MeshError::NoTree);
                    }
                    let (below, above) = divide(&space, at, split)?;
                    open.extend([(split.below, below, at), (split.above, above, at)]);
                }
            }
        }
        let is_tree = seen.iter().chain(&reached).all(|&found| found);
        if is_tree { Ok(Self { elements, splits }) } else { Err(MeshError::NoTree) }
    }

    /// The elements.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// The split tree, its root first.
    pub fn splits(&self) -> &[Split] {
        &self.splits
    }

    /// Position of the element that holds the standardized point ξ, by one comparison per level of the tree. Points
    /// outside the box belong to an element at its boundary.
    #[inline]
    pub fn locate(&self, standardized: &[f64]) -> usize {
        let Some(mut split) = self.splits.first() else { return 0 };
        loop {
            let branch = if standardized[split.input] < split.at { split.below } else { split.above };
            match branch {
                Branch::Element(at) => return at,
                Branch::Split(at) => split = &self.splits[at],
            }
        }
    }

    /// Whether side `input` of an element is wide enough to be halved.
    pub fn can_halve(&self, element: usize, input: usize) -> bool {
        self.elements[element].half_width(input) >= NARROWEST_SIDE
    }

    /// Halves an element along each of `inputs`, and returns the positions of its 2ᵏ parts: the first takes the
    /// element's own, the others follow the last.
    pub fn halve(&mut self, element: usize, inputs: &[usize]) -> Vec<usize> {
        let mut parts = vec![element];
        for &input in inputs {
            let others: Vec<usize> = parts.iter().map(|&part| self.halve_once(part, input)).collect();
            parts.extend(others);
        }
        parts
    }

    fn halve_once(&mut self, element: usize, input: usize) -> usize {
        let (above, split) = (self.elements.len(), self.splits.len());
        let at = self.elements[element].center(input);
        for known in &mut self.splits {
            for branch in [&mut known.below, &mut known.above] {
                if *branch == Branch::Element(element) {
                    *branch = Branch::Split(split);
                }
            }
        }
        self.splits.push(Split { input, at, below: Branch::Element(element), above: Branch::Element(above) });
        let Element { lower, upper, .. } = self.elements[element].clone();
        let (mut middle_up, mut middle_down) = (lower.clone(), upper.clone());
        (middle_up[input], middle_down[input]) = (at, at);
        self.elements[element] = Element::new(lower, middle_down);
        self.elements.push(Element::new(middle_up, upper));
        above
    }
}

/// Both sides of a split of `space`.
fn divide(space: &Element, number: usize, split: &Split) -> Result<(Element, Element), MeshError> {
    let (Some(&lower), Some(&upper)) = (space.lower.get(split.input), space.upper.get(split.input)) else {
        return Err(MeshError::Missing { split: number });
    };
    if !(lower < split.at && split.at < upper) {
        return Err(MeshError::Outside { split: number });
    }
    let (mut above, mut below) = (space.lower.clone(), space.upper.clone());
    (above[split.input], below[split.input]) = (split.at, split.at);
    Ok((Element::new(space.lower.clone(), below), Element::new(above, space.upper.clone())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn divided(steps: &[(usize, usize)]) -> Mesh {
        let mut mesh = Mesh::whole(3);
        for &(element, input) in steps {
            let element = element % mesh.elements().len();
            mesh.halve(element, &[input]);
        }
        mesh
    }

    proptest! {
        #[test]
        fn every_point_lies_in_the_element_that_is_found(
            steps in proptest::collection::vec((0usize..100, 0usize..3), 0..40),
            point in proptest::array::uniform3(-1.0..1.0f64),
        ) {
            let mesh = divided(&steps);
            let inside = |element: &Element| (0..3).all(|j| element.lower[j] <= point[j] && point[j] < element.upper[j]);
            let holding: Vec<usize> = (0..mesh.elements().len()).filter(|&e| inside(&mesh.elements()[e])).collect();
            prop_assert_eq!(holding, [mesh.locate(&point)]);
            let weight: f64 = mesh.elements().iter().map(|element| element.weight).sum();
            prop_assert!((weight - 1.0).abs() < 1e-12);
            let element = &mesh.elements()[mesh.locate(&point)];
            let back = element.standardized(&element.local(&point));
            prop_assert!(back.iter().zip(&point).all(|(a, b)| (a - b).abs() < 1e-14));
            let again = Mesh::from_parts(3, mesh.elements().to_vec(), mesh.splits().to_vec());
            prop_assert_eq!(again.as_ref(), Ok(&mesh));
        }
    }

    #[test]
    fn halving_along_several_inputs_gives_all_corners() {
        let mut mesh = Mesh::whole(2);
        assert_eq!(mesh.halve(0, &[0, 1]), [0, 1, 2, 3]);
        let corners: Vec<_> = mesh.elements().iter().map(|element| element.lower.clone()).collect();
        assert_eq!(corners, [[-1.0, -1.0], [0.0, -1.0], [-1.0, 0.0], [0.0, 0.0]]);
        assert!(mesh.elements().iter().all(|element| element.weight == 0.25));
    }

    #[test]
    fn forged_trees_are_refused_by_what_is_wrong() {
        let mesh = divided(&[(0, 0), (1, 2), (0, 1)]);
        let forge = |change: &dyn Fn(&mut Vec<Element>, &mut Vec<Split>)| {
            let (mut elements, mut splits) = (mesh.elements().to_vec(), mesh.splits().to_vec());
            change(&mut elements, &mut splits);
            Mesh::from_parts(3, elements, splits).unwrap_err()
        };
        assert_eq!(forge(&|_, splits| splits[1].above = Branch::Element(9)), MeshError::Missing { split: 1 });
        assert_eq!(forge(&|_, splits| splits[1].above = Branch::Split(0)), MeshError::NoTree);
        assert_eq!(forge(&|_, splits| splits[2].input = 7), MeshError::Missing { split: 2 });
        assert_eq!(forge(&|_, splits| splits[1].at = 1.0), MeshError::Outside { split: 1 });
        assert_eq!(forge(&|_, splits| splits[2].at = 0.25), MeshError::OtherBox { element: 3 });
        assert_eq!(forge(&|elements, _| elements[1].weight = 0.3), MeshError::OtherBox { element: 1 });
        assert_eq!(forge(&|elements, _| elements.truncate(3)), MeshError::NoTree);
        let twice = forge(&|_, splits| splits[2].above = Branch::Element(1));
        assert!(matches!(twice, MeshError::NoTree | MeshError::OtherBox { .. }));
    }
}
