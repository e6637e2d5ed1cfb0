//! The list of operations that computes all outputs and their derivatives.
//!
//! A workspace has a slot for every number: the variables, the constants, then the result of every operation in order.
//! Running the program is a loop without branches but for the kind of operation, whose pattern is the same every time.

use super::operation::Operation;
use std::ops::Range;

/// An operation on slots. Its result goes to the next slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Instruction {
    pub operation: Operation,
    pub operands: [u32; 3],
}

/// A derivative that is not always zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Derivative {
    /// Position of the output that is differentiated.
    pub output: usize,
    /// Position of the variable by which.
    pub variable: usize,
}

/// A compiled set of expressions, made by [`Compiler::finish`](super::Compiler::finish).
///
/// It is only read: threads share one program, each with a [`Workspace`] of its own.
///
/// # Examples
///
/// ```
/// use pcc_expressions::{Compiler, Derivative};
/// let mut compiler = Compiler::new(&["x", "y"])?;
/// compiler.expression("x^2*y")?;
/// compiler.expression("3 - y")?;
/// let program = compiler.finish()?;
/// let mut workspace = program.workspace();
///
/// let at = program.differentiate(&[2.0, 5.0], &mut workspace);
/// assert_eq!(at.values, [20.0, -2.0]);
/// let by = |output, variable| Derivative { output, variable };
/// assert_eq!(program.derivatives(), [by(0, 0), by(0, 1), by(1, 1)]);
/// assert_eq!(at.derivatives, [20.0, 4.0, -1.0]);
/// # Ok::<(), pcc_expressions::ExpressionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    pub(super) variables: usize,
    pub(super) constants: Vec<f64>,
    pub(super) instructions: Vec<Instruction>,
    /// How many of the instructions the outputs need; the rest is for derivatives.
    pub(super) values_end: usize,
    /// Slots of the outputs.
    pub(super) outputs: Vec<u32>,
    pub(super) derivatives: Vec<Derivative>,
    /// Slots of the derivatives.
    pub(super) slopes: Vec<u32>,
}

/// Memory for the evaluation of a program, one per thread.
///
/// What it holds between two calls does not matter. A workspace of another program works as well, but the first call
/// may allocate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Workspace {
    slots: Vec<f64>,
    values: Vec<f64>,
    derivatives: Vec<f64>,
}

/// Values and derivatives at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evaluated<'w> {
    /// Values of all outputs, by position.
    pub values: &'w [f64],
    /// Derivatives in the order of [`Program::derivatives`].
    pub derivatives: &'w [f64],
}

impl Program {
    /// Number of variables.
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// The derivatives that are not always zero, by variable and then by output.
    pub fn derivatives(&self) -> &[Derivative] {
        &self.derivatives
    }

    /// Where the derivatives by one variable are among all [`derivatives`](Self::derivatives).
    pub fn derivatives_by(&self, variable: usize) -> Range<usize> {
        let first_from = |variable| self.derivatives.partition_point(|derivative| derivative.variable < variable);
        first_from(variable)..first_from(variable.saturating_add(1))
    }

    /// Number of operations for the values, and for values and derivatives.
    pub fn operations(&self) -> (usize, usize) {
        (self.values_end, self.instructions.len())
    }

    /// Memory for the evaluation of this program.
    pub fn workspace(&self) -> Workspace {
        let mut workspace = Workspace::default();
        self.fit(&mut workspace);
        workspace
    }

    /// Values of all outputs, by position. Does not allocate.
    ///
    /// Where an expression is not defined, its value is infinite or NaN.
    ///
    /// # Panics
    ///
    /// If there are more or fewer values than variables.
    pub fn evaluate<'w>(&self, variables: &[f64], workspace: &'w mut Workspace) -> &'w [f64] {
        self.prepare(variables, workspace);
        self.run(self.values_end, workspace);
        gather(&self.outputs, &workspace.slots, &mut workspace.values);
        &workspace.values
    }

    /// Values of all outputs, the same bits as those of [`evaluate`](Self::evaluate), and their derivatives. Does not
    /// allocate.
    ///
    /// # Panics
    ///
    /// If there are more or fewer values than variables.
    pub fn differentiate<'w>(&self, variables: &[f64], workspace: &'w mut Workspace) -> Evaluated<'w> {
        self.prepare(variables, workspace);
        self.run(self.instructions.len(), workspace);
        gather(&self.outputs, &workspace.slots, &mut workspace.values);
        gather(&self.slopes, &workspace.slots, &mut workspace.derivatives);
        Evaluated { values: &workspace.values, derivatives: &workspace.derivatives }
    }

    /// Gives the workspace the size it needs, which it has unless it is another program's.
    fn fit(&self, workspace: &mut Workspace) {
        workspace.slots.resize(self.variables + self.constants.len() + self.instructions.len(), 0.0);
        workspace.values.resize(self.outputs.len(), 0.0);
        workspace.derivatives.resize(self.slopes.len(), 0.0);
    }

    fn prepare(&self, variables: &[f64], workspace: &mut Workspace) {
        assert_eq!(variables.len(), self.variables, "a program takes one value for every variable");
        self.fit(workspace);
        let (inputs, others) = workspace.slots.split_at_mut(self.variables);
        inputs.copy_from_slice(variables);
        others[..self.constants.len()].copy_from_slice(&self.constants);
    }

    /// The first `count` operations.
    fn run(&self, count: usize, workspace: &mut Workspace) {
        let slots = &mut workspace.slots[..];
        let first_target = self.variables + self.constants.len();
        for (target, instruction) in (first_target..).zip(&self.instructions[..count]) {
            slots[target] = instruction.operation.apply(|k| slots[instruction.operands[k] as usize]);
        }
    }
}

fn gather(from: &[u32], slots: &[f64], to: &mut [f64]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to = slots[from as usize];
    }
}
