//! Simplifications that change no result but the sign of zero, and what is multiplied by a constant zero.
//!
//! Products are not reordered and constants in different places not combined, because that would round differently.
//! Signs are moved outwards, which is exact and lets −r(a + b) share the product with r(a + b).

use super::graph::{Graph, Id, Node};
use super::operation::{LARGEST_PRODUCT, Operation};

/// A simpler node for an operation whose operands are not all constant, if there is one.
pub(super) fn simplified(graph: &mut Graph, operation: Operation, [a, b, c]: [Id; 3]) -> Option<Id> {
    match operation {
        Operation::Add => sum(graph, a, b),
        Operation::Subtract => difference(graph, a, b),
        Operation::Multiply => product(graph, a, b),
        Operation::Divide => quotient(graph, a, b),
        Operation::Negate => negated(graph, a),
        Operation::Power => power(graph, a, b),
        Operation::TimesLogarithm if graph.is_zero(a) => Some(a),
        Operation::Choose => match graph.value(a)? {
            1.0 => Some(b),
            0.0 => Some(c),
            _ => None,
        },
        _ => None,
    }
}

/// What a node is the negative of.
fn negated(graph: &Graph, id: Id) -> Option<Id> {
    match graph.node(id) {
        Node::Operation(Operation::Negate, [inner, ..]) => Some(inner),
        _ => None,
    }
}

fn sum(graph: &mut Graph, a: Id, b: Id) -> Option<Id> {
    if graph.is_zero(a) {
        Some(b)
    } else if graph.is_zero(b) {
        Some(a)
    } else if let Some(b) = negated(graph, b) {
        Some(graph.subtract(a, b))
    } else if let Some(a) = negated(graph, a) {
        Some(graph.subtract(b, a))
    } else if a == b {
        let two = graph.constant(2.0);
        Some(graph.multiply(two, a))
    } else {
        // One of a + b and b + a, so that both are the same node.
        (a > b).then(|| graph.add(b, a))
    }
}

fn difference(graph: &mut Graph, a: Id, b: Id) -> Option<Id> {
    if graph.is_zero(a) {
        Some(graph.negate(b))
    } else if graph.is_zero(b) {
        Some(a)
    } else {
        negated(graph, b).map(|b| graph.add(a, b))
    }
}

fn product(graph: &mut Graph, a: Id, b: Id) -> Option<Id> {
    match (graph.value(a), graph.value(b)) {
        (Some(0.0), _) | (_, Some(0.0)) => return Some(graph.constant(0.0)),
        (Some(1.0), _) => return Some(b),
        (_, Some(1.0)) => return Some(a),
        (Some(-1.0), _) => return Some(graph.negate(b)),
        (_, Some(-1.0)) => return Some(graph.negate(a)),
        _ => {}
    }
    if let Some(a) = negated(graph, a) {
        let positive = graph.multiply(a, b);
        Some(graph.negate(positive))
    } else if let Some(b) = negated(graph, b) {
        let positive = graph.multiply(a, b);
        Some(graph.negate(positive))
    } else {
        (a > b).then(|| graph.multiply(b, a))
    }
}

fn quotient(graph: &mut Graph, a: Id, b: Id) -> Option<Id> {
    match (graph.value(a), graph.value(b)) {
        (Some(0.0), _) => return Some(graph.constant(0.0)),
        (_, Some(1.0)) => return Some(a),
        (_, Some(-1.0)) => return Some(graph.negate(a)),
        _ => {}
    }
    let (numerator, denominator) = (negated(graph, a), negated(graph, b));
    if numerator.is_none() && denominator.is_none() {
        return None;
    }
    let quotient = graph.divide(numerator.unwrap_or(a), denominator.unwrap_or(b));
    Some(if numerator.is_some() && denominator.is_some() { quotient } else { graph.negate(quotient) })
}

/// Constant integer exponents become products, as does a constant base that is one.
fn power(graph: &mut Graph, base: Id, exponent: Id) -> Option<Id> {
    if graph.value(base) == Some(1.0) {
        return Some(base);
    }
    match graph.value(exponent)? {
        0.0 => Some(graph.constant(1.0)),
        1.0 => Some(base),
        2.0 => Some(graph.multiply(base, base)),
        -1.0 => {
            let one = graph.constant(1.0);
            Some(graph.divide(one, base))
        }
        n if n.fract() == 0.0 && n.abs() <= LARGEST_PRODUCT => {
            Some(graph.of_two(Operation::IntegerPower, base, exponent))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x, y, 0, 1 and −x in a graph.
    fn graph() -> (Graph, [Id; 5]) {
        let mut graph = Graph::default();
        let (x, y) = (graph.intern(Node::Variable(0)), graph.intern(Node::Variable(1)));
        let (zero, one, minus_x) = (graph.constant(0.0), graph.constant(1.0), graph.negate(x));
        (graph, [x, y, zero, one, minus_x])
    }

    #[test]
    fn neutral_elements_leave_no_trace() {
        let (mut graph, [x, _, zero, one, minus_x]) = graph();
        assert_eq!([graph.add(x, zero), graph.add(zero, x), graph.subtract(x, zero)], [x; 3]);
        assert_eq!([graph.multiply(x, one), graph.multiply(one, x), graph.divide(x, one)], [x; 3]);
        assert_eq!([graph.multiply(x, zero), graph.multiply(zero, x), graph.divide(zero, x)], [zero; 3]);
        assert_eq!([graph.subtract(zero, x), graph.negate(x)], [minus_x; 2]);
        assert_eq!(graph.negate(minus_x), x);
    }

    #[test]
    fn signs_move_outwards() {
        let (mut graph, [x, y, .., minus_x]) = graph();
        let product = graph.multiply(x, y);
        let negative = graph.negate(product);
        assert_eq!([graph.multiply(minus_x, y), graph.multiply(y, minus_x)], [negative; 2]);
        assert_eq!(graph.multiply(minus_x, minus_x), graph.multiply(x, x));
        assert_eq!(graph.add(y, minus_x), graph.subtract(y, x));
        assert_eq!(graph.subtract(y, minus_x), graph.add(x, y));
        assert_eq!(graph.divide(minus_x, minus_x), graph.divide(x, x));
    }

    #[test]
    fn powers_with_integer_exponents_are_products() {
        let (mut graph, [x, y, zero, one, _]) = graph();
        let exponents = [2.0, 3.0, 17.0, 0.5].map(|n| graph.constant(n));
        let [square, cube, large, root] = exponents.map(|n| graph.of_two(Operation::Power, x, n));
        assert_eq!(square, graph.multiply(x, x));
        assert!(matches!(graph.node(cube), Node::Operation(Operation::IntegerPower, _)));
        assert!(matches!(graph.node(large), Node::Operation(Operation::Power, _)));
        assert!(matches!(graph.node(root), Node::Operation(Operation::Power, _)));
        assert_eq!(graph.of_two(Operation::Power, x, zero), one);
        assert_eq!(graph.of_two(Operation::Power, one, y), one);
    }
}
