//! A surrogate compiled for speed.
//!
//! All components are expanded in products of the same univariate polynomials, and their multi-indices overlap. The
//! plan merges them into [`Operations`], one list per element, which are evaluated at
//! [`crate::evaluation::BLOCK_POINTS`] points at a time, one per lane, with the vector instructions of the processor;
//! eigenvalues and max Re λ follow in the same lanes.

use super::inner_loops;
use super::lanes::Lanes;
use super::operations::Operations;
use super::recombination::recombine;
use super::results::Results;
use crate::components::Output;
use crate::foundation::InstructionSet;
use crate::polynomials::Mesh;
use crate::surrogate::{Surrogate, VerdictBasis};
use pulp::{Simd, WithSimd};

/// A compiled surrogate.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::artifact;
/// use pcc_evaluate::evaluation::{Lanes, Plan};
/// let surrogate = artifact::decode(include_bytes!("../../../../../surrogates/clutch-r1-eigenvalues.pcc"))?.surrogate;
/// let plan = Plan::new(&surrogate);
/// let mut workspace = plan.workspace();
/// // One input, the same point in every lane.
/// workspace.points_mut()[0] = Lanes::splat(0.25);
/// plan.evaluate(0, &mut workspace);
/// let expected = surrogate.evaluate(&[0.25])[0];
/// assert!((workspace.results().components[0].0[0] - expected).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Plan {
    instructions: InstructionSet,
    mesh: Mesh,
    outputs: Vec<Output>,
    verdict: VerdictBasis,
    dimension: usize,
    eigenvalues: usize,
    /// One per element.
    operations: Vec<Operations>,
}

/// Memory that an evaluation works in.
#[derive(Debug, Clone)]
pub struct Workspace {
    points: Vec<Lanes>,
    table: Vec<Lanes>,
    results: Results,
}

impl Workspace {
    /// Local variables of the element, for one element the standardized coordinates: one entry per input, one lane per
    /// point.
    pub fn points_mut(&mut self) -> &mut [Lanes] {
        &mut self.points
    }

    /// The same, to read.
    pub fn points(&self) -> &[Lanes] {
        &self.points
    }

    /// What [`Plan::evaluate`] found.
    pub fn results(&self) -> &Results {
        &self.results
    }
}

impl Plan {
    /// Compiles `surrogate` for the fastest instructions of this processor. Centre and scale of the components are
    /// folded into the coefficients.
    pub fn new(surrogate: &Surrogate) -> Self {
        Self::with_instructions(surrogate, InstructionSet::best())
    }

    /// Compiles `surrogate` for chosen instructions; results are the same bits for all.
    pub fn with_instructions(surrogate: &Surrogate, instructions: InstructionSet) -> Self {
        let elements = 0..surrogate.mesh.elements().len();
        Self {
            instructions,
            mesh: surrogate.mesh.clone(),
            outputs: surrogate.outputs.clone(),
            verdict: surrogate.verdict,
            dimension: surrogate.inputs.dimension(),
            eigenvalues: surrogate.labels().len(),
            operations: elements.map(|element| Operations::new(surrogate, element)).collect(),
        }
    }

    /// What it runs with.
    pub fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// The elements and how to find them.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Number of different terms of all expansions of an element, the constant not counted; the most of any element.
    pub fn terms(&self) -> usize {
        self.most(|program| program.terms)
    }

    /// Floating-point operations per point for the values of all components, a fused multiply-add counted as two: five
    /// per univariate value, one per product of a parent; in each component two per coefficient and two per parent, but
    /// that the coefficient of a parent, which starts its sum, costs nothing, and the first in a sum without such a
    /// start one. With several elements two per input for the local variables, and those of the most expensive element.
    /// Roots and statistics are not counted.
    pub fn flops(&self) -> usize {
        let maps = if self.operations.len() > 1 { 2 * self.dimension } else { 0 };
        maps + self.most(Operations::flops)
    }

    /// Memory for [`Plan::evaluate`].
    pub fn workspace(&self) -> Workspace {
        let lanes = |count| vec![Lanes::splat(0.0); count];
        Workspace {
            points: lanes(self.dimension),
            table: lanes(self.most(Operations::rows)),
            results: Results {
                components: lanes(self.most(|program| program.constants.len())),
                growth_rates: lanes(self.eigenvalues),
                angular_frequencies: lanes(self.eigenvalues),
                max_re: Lanes::splat(0.0),
                excess: Lanes::splat(0.0),
                top_frequency: Lanes::splat(1.0),
            },
        }
    }

    /// Evaluates components, eigenvalues and max Re λ at the points of the workspace, which lie in this element.
    ///
    /// # Panics
    ///
    /// If there are not that many elements.
    pub fn evaluate(&self, element: usize, workspace: &mut Workspace) {
        self.evaluate_components(element, workspace);
        self.instructions.run(Recombining {
            outputs: &self.outputs,
            verdict: self.verdict,
            results: &mut workspace.results,
        });
    }

    /// The components alone.
    ///
    /// # Panics
    ///
    /// If there are not that many elements.
    pub fn evaluate_components(&self, element: usize, workspace: &mut Workspace) {
        self.instructions.run(Evaluating { program: &self.operations[element], workspace });
    }

    fn most(&self, part: impl Fn(&Operations) -> usize) -> usize {
        self.operations.iter().map(part).max().unwrap_or(0)
    }
}

struct Evaluating<'a> {
    program: &'a Operations,
    workspace: &'a mut Workspace,
}

impl WithSimd for Evaluating<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Workspace { points, table, results } = self.workspace;
        inner_loops::evaluate(simd, self.program, points, table, &mut results.components);
    }
}

struct Recombining<'a> {
    outputs: &'a [Output],
    verdict: VerdictBasis,
    results: &'a mut Results,
}

impl WithSimd for Recombining<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        recombine(self.outputs, self.verdict, self.results);
    }
}
