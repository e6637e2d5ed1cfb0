//! Derivatives of a graph by one variable, as more nodes of the graph.
//!
//! Nodes are differentiated in the order of the graph, each by the chain rule from its operands. What does not depend
//! on the variable has the constant zero as derivative, and simplification removes every product with it, so that the
//! nodes that are left are the ones that count.

use super::error::ExpressionError;
use super::graph::{Graph, Id, Node};
use super::operation::Operation;
use std::f64::consts::LOG10_E;

/// The derivative by `variable` of every node that is marked in `needed`; zero for the others.
pub(super) fn derivatives(graph: &mut Graph, variable: u32, needed: &[bool]) -> Result<Vec<Id>, ExpressionError> {
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    let mut slopes = vec![zero; needed.len()];
    for position in (0..needed.len()).filter(|&position| needed[position]) {
        let id = position as Id;
        let node = graph.node(id);
        let is_constant = node.operands().iter().all(|&operand| slopes[operand as usize] == zero);
        slopes[position] = match node {
            Node::Variable(number) if number == variable => one,
            Node::Operation(operation, operands) if !is_constant => {
                let slopes = operands.map(|operand| slopes[operand as usize]);
                Rule { graph, id, operands, slopes }.derivative(operation)
            }
            _ => zero,
        };
        if graph.is_overfull() {
            return Err(ExpressionError::TooManyOperations);
        }
    }
    Ok(slopes)
}

/// The chain rule at one node.
struct Rule<'g> {
    graph: &'g mut Graph,
    /// The node.
    id: Id,
    operands: [Id; 3],
    /// Derivatives of the operands. Those of unused operands have no meaning.
    slopes: [Id; 3],
}

impl Rule<'_> {
    fn derivative(&mut self, operation: Operation) -> Id {
        let [a, b, _] = self.operands;
        let [da, db, dc] = self.slopes;
        match operation {
            Operation::Add => self.graph.add(da, db),
            Operation::Subtract => self.graph.subtract(da, db),
            Operation::Multiply => {
                let (left, right) = (self.graph.multiply(da, b), self.graph.multiply(a, db));
                self.graph.add(left, right)
            }
            Operation::Divide => self.quotient(),
            Operation::Power | Operation::IntegerPower => self.power(),
            Operation::Negate => self.graph.negate(da),
            Operation::Angle => self.angle(),
            Operation::Minimum => self.branch(b, a),
            Operation::Maximum => self.branch(a, b),
            Operation::Choose => self.graph.operation(Operation::Choose, [a, db, dc]),
            Operation::TimesLogarithm => self.times_logarithm(),
            _ => {
                let factor = self.factor(operation, a);
                self.graph.multiply(factor, da)
            }
        }
    }

    /// f′(a) of a function of one operand.
    fn factor(&mut self, operation: Operation, a: Id) -> Id {
        match operation {
            Operation::Sine => self.graph.of_one(Operation::Cosine, a),
            Operation::Cosine => {
                let sine = self.graph.of_one(Operation::Sine, a);
                self.graph.negate(sine)
            }
            Operation::Tangent => self.one_plus_square(self.id),
            Operation::ArcSine => self.inverse_sine(),
            Operation::ArcCosine => {
                let slope = self.inverse_sine();
                self.graph.negate(slope)
            }
            Operation::ArcTangent => {
                let square = self.one_plus_square(a);
                self.over(1.0, square)
            }
            Operation::HyperbolicSine => self.graph.of_one(Operation::HyperbolicCosine, a),
            Operation::HyperbolicCosine => self.graph.of_one(Operation::HyperbolicSine, a),
            // Not 1 − tanh², which cancels far from zero.
            Operation::HyperbolicTangent => {
                let cosine = self.graph.of_one(Operation::HyperbolicCosine, a);
                let inverse = self.over(1.0, cosine);
                self.graph.multiply(inverse, inverse)
            }
            Operation::Exponential => self.id,
            Operation::Logarithm => self.over(1.0, a),
            Operation::DecimalLogarithm => self.over(LOG10_E, a),
            Operation::SquareRoot => self.over(0.5, self.id),
            Operation::Absolute => self.graph.of_one(Operation::Sign, a),
            // Sign and comparison are constant between their jumps.
            _ => self.graph.constant(0.0),
        }
    }

    /// `numerator`/`denominator`.
    fn over(&mut self, numerator: f64, denominator: Id) -> Id {
        let numerator = self.graph.constant(numerator);
        self.graph.divide(numerator, denominator)
    }

    fn one_plus_square(&mut self, of: Id) -> Id {
        let (one, square) = (self.graph.constant(1.0), self.graph.multiply(of, of));
        self.graph.add(one, square)
    }

    /// 1/√(1 − a²), as a product that does not cancel near ±1.
    fn inverse_sine(&mut self) -> Id {
        let one = self.graph.constant(1.0);
        let below = self.graph.subtract(one, self.operands[0]);
        let above = self.graph.add(one, self.operands[0]);
        let product = self.graph.multiply(below, above);
        let root = self.graph.of_one(Operation::SquareRoot, product);
        self.over(1.0, root)
    }

    /// (a/b)′ = (a′ − (a/b) b′)/b.
    fn quotient(&mut self) -> Id {
        let ([_, b, _], [da, db, _]) = (self.operands, self.slopes);
        let correction = self.graph.multiply(self.id, db);
        let numerator = self.graph.subtract(da, correction);
        self.graph.divide(numerator, b)
    }

    /// (aᵇ)′ = b aᵇ⁻¹ a′ + aᵇ ln(a) b′, each only if it is needed.
    fn power(&mut self) -> Id {
        let ([a, b, _], [da, db, _]) = (self.operands, self.slopes);
        let one = self.graph.constant(1.0);
        let lower = self.graph.subtract(b, one);
        let below = self.graph.of_two(Operation::Power, a, lower);
        let factor = self.graph.multiply(b, below);
        let by_base = self.graph.multiply(factor, da);
        // The factors before the logarithm, so that it does not matter where one of them is zero.
        let factor = self.graph.multiply(self.id, db);
        let by_exponent = self.graph.of_two(Operation::TimesLogarithm, factor, a);
        self.graph.add(by_base, by_exponent)
    }

    /// atan2(a, b)′ = (b a′ − a b′)/(a² + b²).
    fn angle(&mut self) -> Id {
        let ([a, b, _], [da, db, _]) = (self.operands, self.slopes);
        let (left, right) = (self.graph.multiply(b, da), self.graph.multiply(a, db));
        let (a_squared, b_squared) = (self.graph.multiply(a, a), self.graph.multiply(b, b));
        let (numerator, denominator) = (self.graph.subtract(left, right), self.graph.add(a_squared, b_squared));
        self.graph.divide(numerator, denominator)
    }

    /// The derivative of the first operand if `larger` ≥ `smaller`, otherwise of the second.
    fn branch(&mut self, larger: Id, smaller: Id) -> Id {
        let [da, db, _] = self.slopes;
        let is_first = self.graph.of_two(Operation::IsAtLeast, larger, smaller);
        self.graph.operation(Operation::Choose, [is_first, da, db])
    }

    /// (a ln b)′ = a′ ln b + a b′/b.
    fn times_logarithm(&mut self) -> Id {
        let ([a, b, _], [da, db, _]) = (self.operands, self.slopes);
        let logarithm = self.graph.of_one(Operation::Logarithm, b);
        let (left, relative) = (self.graph.multiply(da, logarithm), self.graph.divide(db, b));
        let right = self.graph.multiply(a, relative);
        self.graph.add(left, right)
    }
}
