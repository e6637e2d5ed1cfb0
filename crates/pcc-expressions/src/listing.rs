//! From the graph to the list of operations that are needed, with a slot for every number.

use super::graph::{Graph, Id, Node};
use super::program::{Derivative, Instruction, Program};

/// Slots of nodes that a program does not need.
const NONE: u32 = u32::MAX;

/// The program for `outputs` and their derivatives. Nodes are already in an order in which they can be computed; those
/// of the values come first, so that values alone take a part of the list.
pub(super) fn layout(
    graph: &Graph,
    variables: usize,
    outputs: &[Id],
    derivatives: Vec<Derivative>,
    slopes: &[Id],
) -> Program {
    let for_values = graph.needed(outputs.iter().copied());
    let for_slopes = graph.needed(slopes.iter().copied());
    let mut slots = Slots { of_node: vec![NONE; graph.len()], used: variables as u32 };

    let all = || (0..).zip(graph.iter());
    for (id, node) in all() {
        if let Node::Variable(number) = node {
            slots.of_node[id] = number;
        }
    }
    let mut constants = Vec::new();
    for (id, node) in all() {
        if let Node::Constant(bits) = node
            && (for_values[id] || for_slopes[id])
        {
            slots.take(id);
            constants.push(f64::from_bits(bits));
        }
    }
    let mut instructions = Vec::new();
    let mut list = |is_listed: &dyn Fn(usize) -> bool| {
        for (id, node) in all().filter(|&(id, _)| is_listed(id)) {
            if let Node::Operation(operation, operands) = node {
                let mut places = [0; 3];
                for (place, &operand) in places.iter_mut().zip(&operands[..operation.arity()]) {
                    *place = slots.of_node[operand as usize];
                }
                slots.take(id);
                instructions.push(Instruction { operation, operands: places });
            }
        }
        instructions.len()
    };
    let values_end = list(&|id| for_values[id]);
    list(&|id| for_slopes[id] && !for_values[id]);
    let slots_of = |ids: &[Id]| ids.iter().map(|&id| slots.of_node[id as usize]).collect();
    Program {
        variables,
        constants,
        values_end,
        outputs: slots_of(outputs),
        derivatives,
        slopes: slots_of(slopes),
        instructions,
    }
}

/// Places of the numbers in a workspace.
struct Slots {
    of_node: Vec<u32>,
    used: u32,
}

impl Slots {
    /// The next slot, for a node.
    fn take(&mut self, id: usize) {
        self.of_node[id] = self.used;
        self.used += 1;
    }
}
