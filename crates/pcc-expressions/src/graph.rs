//! All expressions as one graph in which nothing is computed twice.
//!
//! Nodes are kept in the order in which they were made, operands before results, and found again by their content. So
//! every pass over the graph is a loop, no recursion, and its order is always the same.

use super::operation::Operation;
use super::simplify::simplified;
use std::collections::HashMap;

/// Most nodes, derivatives included: they take some 50 MB and milliseconds to evaluate, far from any matrix that is
/// written by hand.
pub(super) const MOST_NODES: usize = 1_000_000;

/// Position of a node.
pub(super) type Id = u32;

/// A number in a graph. Unused operands are 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Node {
    Variable(u32),
    /// The bits of a double.
    Constant(u64),
    Operation(Operation, [Id; 3]),
}

impl Node {
    /// Nodes that are needed to compute this one.
    pub fn operands(&self) -> &[Id] {
        match self {
            Self::Variable(_) | Self::Constant(_) => &[],
            Self::Operation(operation, operands) => &operands[..operation.arity()],
        }
    }
}

/// Nodes without duplicates.
#[derive(Debug, Clone, Default)]
pub(super) struct Graph {
    nodes: Vec<Node>,
    positions: HashMap<Node, Id>,
}

impl Graph {
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are more nodes than is sensible.
    pub fn is_overfull(&self) -> bool {
        self.len() > MOST_NODES
    }

    pub fn node(&self, id: Id) -> Node {
        self.nodes[id as usize]
    }

    /// All nodes in order.
    pub fn iter(&self) -> impl Iterator<Item = Node> {
        self.nodes.iter().copied()
    }

    /// The node, new or old.
    pub fn intern(&mut self, node: Node) -> Id {
        *self.positions.entry(node).or_insert_with(|| {
            self.nodes.push(node);
            (self.nodes.len() - 1) as Id
        })
    }

    pub fn constant(&mut self, value: f64) -> Id {
        self.intern(Node::Constant(value.to_bits()))
    }

    /// The value of a node that depends on no variable.
    pub fn value(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Whether a node is the constant zero, of either sign.
    pub fn is_zero(&self, id: Id) -> bool {
        self.value(id) == Some(0.0)
    }

    /// An operation on nodes: its value if they are constant, otherwise the simplest node for it.
    pub fn operation(&mut self, operation: Operation, operands: [Id; 3]) -> Id {
        let values = operands.map(|id| self.value(id));
        if values[..operation.arity()].iter().all(Option::is_some) {
            return self.constant(operation.apply(|k| values[k].unwrap_or(f64::NAN)));
        }
        match simplified(self, operation, operands) {
            Some(id) => id,
            None => self.intern(Node::Operation(operation, operands)),
        }
    }

    /// An operation on one node.
    pub fn of_one(&mut self, operation: Operation, a: Id) -> Id {
        self.operation(operation, [a, 0, 0])
    }

    /// An operation on two nodes.
    pub fn of_two(&mut self, operation: Operation, a: Id, b: Id) -> Id {
        self.operation(operation, [a, b, 0])
    }

    pub fn add(&mut self, a: Id, b: Id) -> Id {
        self.of_two(Operation::Add, a, b)
    }

    pub fn subtract(&mut self, a: Id, b: Id) -> Id {
        self.of_two(Operation::Subtract, a, b)
    }

    pub fn multiply(&mut self, a: Id, b: Id) -> Id {
        self.of_two(Operation::Multiply, a, b)
    }

    pub fn divide(&mut self, a: Id, b: Id) -> Id {
        self.of_two(Operation::Divide, a, b)
    }

    pub fn negate(&mut self, a: Id) -> Id {
        self.of_one(Operation::Negate, a)
    }

    /// For every node, whether one of `roots` needs it.
    pub fn needed(&self, roots: impl IntoIterator<Item = Id>) -> Vec<bool> {
        let mut needed = vec![false; self.len()];
        for root in roots {
            needed[root as usize] = true;
        }
        for position in (0..self.len()).rev() {
            if needed[position] {
                for &operand in self.nodes[position].operands() {
                    needed[operand as usize] = true;
                }
            }
        }
        needed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_equal_is_made_once() {
        let mut graph = Graph::default();
        let (x, y) = (graph.intern(Node::Variable(0)), graph.intern(Node::Variable(1)));
        let product = graph.multiply(x, y);
        assert_eq!(graph.multiply(y, x), product);
        assert_eq!(graph.len(), 3);
    }

    #[test]
    fn only_operands_are_needed() {
        let mut graph = Graph::default();
        let (x, y) = (graph.intern(Node::Variable(0)), graph.intern(Node::Variable(1)));
        let square = graph.multiply(x, x);
        graph.add(square, y);
        assert_eq!(graph.needed([square]), [true, false, true, false]);
    }
}
