//! From names and texts to a graph, and from the graph to a program.

use super::derivative::derivatives;
use super::error::{ExpressionError, Fault, TextError};
use super::excerpt::excerpt;
use super::graph::{Graph, Id, Node};
use super::listing::layout;
use super::name;
use super::parser::{Item, parse};
use super::program::{Derivative, Program};
use std::collections::HashMap;
use std::f64::consts::PI;

/// One result of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Output(usize);

impl Output {
    /// Its position among all outputs, in the order in which they were given.
    pub fn position(self) -> usize {
        self.0
    }
}

/// Collects names and expressions, and makes a [`Program`] of them.
///
/// # Examples
///
/// ```
/// use pcc_expressions::Compiler;
/// let mut compiler = Compiler::new(&["mu", "r"])?;
/// compiler.constant("c_f", 0.0)?;
/// let (damping, lever) = (compiler.expression("2*c_f*r")?, compiler.expression("r^2")?);
/// assert_eq!(compiler.value_if_constant(damping), Some(0.0));
/// assert_eq!(compiler.value_if_constant(lever), None);
/// assert_eq!(compiler.uses(lever), [false, true]);
/// assert_eq!(compiler.unused_variables(), ["mu"]);
/// let error = compiler.expression("2*c_g").unwrap_err();
/// assert_eq!(error.to_string(), "\"2*c_g\": unknown name c_g, perhaps c_f; known are mu, r, c_f, pi (column 3)");
/// # Ok::<(), pcc_expressions::ExpressionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Compiler {
    graph: Graph,
    /// In the order in which they were given, variables first.
    names: Vec<String>,
    meanings: HashMap<String, Id>,
    /// Nodes of the variables.
    variables: Vec<Id>,
    outputs: Vec<Id>,
}

impl Compiler {
    /// Knows the names of the inputs, `variables`, in the order in which the program will take their values.
    ///
    /// # Errors
    ///
    /// [`ExpressionError::InvalidName`], [`ExpressionError::ReservedName`] and [`ExpressionError::RepeatedName`].
    pub fn new(variables: &[&str]) -> Result<Self, ExpressionError> {
        let mut compiler = Self {
            graph: Graph::default(),
            names: Vec::new(),
            meanings: HashMap::new(),
            variables: Vec::new(),
            outputs: Vec::new(),
        };
        for (number, name) in (0..).zip(variables) {
            let id = compiler.graph.intern(Node::Variable(number));
            compiler.variables.push(id);
            compiler.name(name, id)?;
        }
        Ok(compiler)
    }

    /// Gives a finite number a name.
    ///
    /// # Errors
    ///
    /// [`ExpressionError::NotFinite`] and those of [`Compiler::new`].
    pub fn constant(&mut self, name: &str, value: f64) -> Result<(), ExpressionError> {
        self.check_new(name)?;
        if !value.is_finite() {
            return Err(ExpressionError::NotFinite { name: excerpt(name, 1), value });
        }
        let id = self.graph.constant(value);
        self.name(name, id)
    }

    /// Gives the expression `text` a name, for later expressions. It may use all earlier names.
    ///
    /// # Errors
    ///
    /// Those of [`Compiler::new`] and [`Compiler::expression`].
    pub fn define(&mut self, name: &str, text: &str) -> Result<(), ExpressionError> {
        self.check_new(name)?;
        let id = self.compile(text)?;
        self.name(name, id)
    }

    /// Adds the output that is given by the expression `text`.
    ///
    /// # Errors
    ///
    /// [`ExpressionError::Text`] with place and kind of what is wrong, [`ExpressionError::TooManyOperations`].
    pub fn expression(&mut self, text: &str) -> Result<Output, ExpressionError> {
        let id = self.compile(text)?;
        Ok(self.output(id))
    }

    /// Adds an output that is always `value`.
    pub fn number(&mut self, value: f64) -> Output {
        let id = self.graph.constant(value);
        self.output(id)
    }

    /// The value of an output that depends on no variable, such as a structural zero.
    pub fn value_if_constant(&self, output: Output) -> Option<f64> {
        self.outputs.get(output.0).and_then(|&id| self.graph.value(id))
    }

    /// For every variable, whether the output depends on it. What is multiplied by zero is not depended on.
    pub fn uses(&self, output: Output) -> Vec<bool> {
        self.used(self.outputs.get(output.0).copied())
    }

    /// Names of the variables on which no output depends.
    pub fn unused_variables(&self) -> Vec<&str> {
        let used = self.used(self.outputs.iter().copied());
        self.names.iter().zip(used).filter(|(_, used)| !used).map(|(name, _)| name.as_str()).collect()
    }

    /// Differentiates all outputs by all variables and lists the operations.
    ///
    /// # Errors
    ///
    /// [`ExpressionError::TooManyOperations`].
    pub fn finish(mut self) -> Result<Program, ExpressionError> {
        let needed = self.graph.needed(self.outputs.iter().copied());
        let (mut pairs, mut slopes) = (Vec::new(), Vec::new());
        for variable in 0..self.variables.len() {
            let derivatives = derivatives(&mut self.graph, variable as u32, &needed)?;
            for (output, &id) in self.outputs.iter().enumerate() {
                let slope = derivatives[id as usize];
                if !self.graph.is_zero(slope) {
                    pairs.push(Derivative { output, variable });
                    slopes.push(slope);
                }
            }
        }
        Ok(layout(&self.graph, self.variables.len(), &self.outputs, pairs, &slopes))
    }

    fn used(&self, outputs: impl IntoIterator<Item = Id>) -> Vec<bool> {
        let needed = self.graph.needed(outputs);
        self.variables.iter().map(|&id| needed[id as usize]).collect()
    }

    fn output(&mut self, id: Id) -> Output {
        self.outputs.push(id);
        Output(self.outputs.len() - 1)
    }

    fn check_new(&self, name: &str) -> Result<(), ExpressionError> {
        name::check(name)?;
        match self.meanings.contains_key(name) {
            true => Err(ExpressionError::RepeatedName { name: excerpt(name, 1) }),
            false => Ok(()),
        }
    }

    fn name(&mut self, name: &str, id: Id) -> Result<(), ExpressionError> {
        self.check_new(name)?;
        self.meanings.insert(name.to_owned(), id);
        self.names.push(name.to_owned());
        Ok(())
    }

    /// The node of an expression.
    fn compile(&mut self, text: &str) -> Result<Id, ExpressionError> {
        let postfix = parse(text).map_err(|fault| fault.in_text(text))?;
        let mut results: Vec<Id> = Vec::new();
        for item in postfix {
            let id = match item {
                Item::Number(value) => self.graph.constant(value),
                Item::Name { name, column } => self.meaning(name, column).map_err(|fault| fault.in_text(text))?,
                Item::Apply(operation) => {
                    let mut operands = [0; 3];
                    let first = results.len() - operation.arity();
                    operands[..operation.arity()].copy_from_slice(&results[first..]);
                    results.truncate(first);
                    self.graph.operation(operation, operands)
                }
            };
            results.push(id);
        }
        match self.graph.is_overfull() {
            true => Err(ExpressionError::TooManyOperations),
            false => Ok(results[0]),
        }
    }

    fn meaning(&mut self, name: &str, column: usize) -> Result<Id, Fault> {
        match self.meanings.get(name) {
            Some(&id) => Ok(id),
            None if name == name::PI => Ok(self.graph.constant(PI)),
            None => {
                let closest = name::closest(name, &self.names).map(str::to_owned);
                let known = name::list(&self.names);
                Err(Fault { column, problem: TextError::UnknownName { name: excerpt(name, 1), closest, known } })
            }
        }
    }
}
