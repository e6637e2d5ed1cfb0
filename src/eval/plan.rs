//! A surrogate compiled for speed.
//!
//! All components are expanded in products of the same univariate polynomials, and their multi-indices overlap. The plan
//! merges them into one prefix tree: a term is its parent times one univariate value, computed once for all components
//! that use it. Points are evaluated in blocks of [`LANES`], one point per lane, so every inner loop is a plain loop over
//! lanes that compiles to vector instructions. Each element has a program of its own.

use crate::input::Mesh;
use crate::polynomial::Recurrence;
use crate::surrogate::Surrogate;
use std::collections::BTreeMap;

/// Points evaluated together.
pub const LANES: usize = 32;

type Lanes = [f64; LANES];

/// One term of the merged expansion: `parent × univariate`.
#[derive(Debug, Clone, PartialEq)]
struct Node {
    /// How many factors the term has; its parent is the last node before it with one less.
    depth: usize,
    /// Row of the univariate table.
    row: usize,
    /// End of this node's part of `Plan::uses`; it starts where the part of the node before ends.
    uses_end: usize,
}

/// A coefficient of one component.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Use {
    component: usize,
    coefficient: f64,
}

/// The univariate polynomials of one input: rows `first_row`… of the table hold φ_1, φ_2, ….
#[derive(Debug, Clone, PartialEq)]
struct Univariate {
    first_row: usize,
    recurrence: Recurrence,
}

/// A compiled surrogate.
///
/// # Examples
///
/// ```
/// # let study = pcc::study::Study::from_toml(include_str!("../../surrogates/clutch-r1-eigenvalues.toml"))?;
/// # let surrogate = pcc::build::build(&study, &pcc::progress::Silent)?;
/// use pcc::eval::{LANES, Plan};
/// let plan = Plan::new(&surrogate);
/// let mut workspace = plan.workspace();
/// // One input, the same point in every lane.
/// workspace.points_mut()[0] = [0.25; LANES];
/// plan.evaluate(0, &mut workspace);
/// let expected = surrogate.evaluate(&[0.25])[0];
/// assert!((workspace.components()[0][0] - expected).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    mesh: Mesh,
    /// One per element.
    programs: Vec<Program>,
}

/// The merged expansions of one element.
#[derive(Debug, Clone, PartialEq)]
struct Program {
    univariates: Vec<Univariate>,
    rows: usize,
    nodes: Vec<Node>,
    uses: Vec<Use>,
    /// Value of each component without its non-constant terms.
    constants: Vec<f64>,
    depth: usize,
}

/// Memory that an evaluation works in.
#[derive(Debug, Clone)]
pub struct Workspace {
    points: Vec<Lanes>,
    table: Vec<Lanes>,
    /// The terms on the way from the root to the current node, by depth; the root is 1.
    path: Vec<Lanes>,
    components: Vec<Lanes>,
}

impl Workspace {
    /// Local variables of the element, for one element the standardized coordinates: one entry per input, one lane per point.
    pub fn points_mut(&mut self) -> &mut [Lanes] {
        &mut self.points
    }

    /// Values of all components by id, one lane per point.
    pub fn components(&self) -> &[Lanes] {
        &self.components
    }
}

impl Plan {
    /// Compiles `surrogate`. Centre and scale of the components are folded into the coefficients.
    pub fn new(surrogate: &Surrogate) -> Self {
        let elements = 0..surrogate.mesh.elements().len();
        Self {
            mesh: surrogate.mesh.clone(),
            programs: elements.map(|element| Program::new(surrogate, element)).collect(),
        }
    }

    /// The elements and how to find them.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Number of terms of the merged expansion of an element, the constant not counted; the most of any element.
    pub fn terms(&self) -> usize {
        self.programs.iter().map(|program| program.nodes.len()).max().unwrap_or(0)
    }

    /// Floating-point operations per point: three per univariate value, one product per term, two per coefficient; with several
    /// elements two per input for the local variables, and those of the most expensive element.
    pub fn flops(&self) -> usize {
        let maps = if self.programs.len() > 1 { 2 * self.programs[0].univariates.len() } else { 0 };
        maps + self.programs.iter().map(Program::flops).max().unwrap_or(0)
    }

    /// Memory for [`Plan::evaluate`].
    pub fn workspace(&self) -> Workspace {
        let most = |part: fn(&Program) -> usize| self.programs.iter().map(part).max().unwrap_or(0);
        Workspace {
            points: vec![[0.0; LANES]; most(|program| program.univariates.len())],
            table: vec![[0.0; LANES]; most(|program| program.rows)],
            path: vec![[1.0; LANES]; most(|program| program.depth) + 1],
            components: vec![[0.0; LANES]; most(|program| program.constants.len())],
        }
    }

    /// Evaluates all components at the points of the workspace, which lie in this element.
    ///
    /// # Panics
    ///
    /// If there are not that many elements.
    pub fn evaluate(&self, element: usize, workspace: &mut Workspace) {
        self.programs[element].evaluate(workspace);
    }
}

impl Program {
    fn new(surrogate: &Surrogate, element: usize) -> Self {
        let components = surrogate.components();
        let mut constants: Vec<f64> = components.iter().map(|component| component.center).collect();
        let mut terms: BTreeMap<Vec<(usize, u16)>, Vec<Use>> = BTreeMap::new();
        for component in &components {
            let expansion = surrogate.expansion(element, component.id);
            for (alpha, coefficient) in expansion.indices.iter().zip(&expansion.coefficients) {
                let coefficient = component.scale * coefficient;
                let factors: Vec<(usize, u16)> = alpha.iter().copied().enumerate().filter(|&(_, k)| k > 0).collect();
                if factors.is_empty() {
                    constants[component.id] += coefficient;
                    continue;
                }
                for length in 1..factors.len() {
                    terms.entry(factors[..length].to_vec()).or_default();
                }
                terms.entry(factors).or_default().push(Use { component: component.id, coefficient });
            }
        }
        Self::from_terms(surrogate, constants, terms)
    }

    /// Lexicographic order of the factors is depth-first order of the tree.
    fn from_terms(surrogate: &Surrogate, constants: Vec<f64>, terms: BTreeMap<Vec<(usize, u16)>, Vec<Use>>) -> Self {
        let inputs = surrogate.inputs.inputs();
        let mut degrees = vec![0; inputs.len()];
        for &(input, degree) in terms.keys().flatten() {
            degrees[input] = degrees[input].max(usize::from(degree));
        }
        let mut rows = 0;
        let univariates: Vec<Univariate> = inputs
            .iter()
            .zip(&degrees)
            .map(|(input, &degree)| {
                rows += degree;
                Univariate { first_row: rows - degree, recurrence: input.marginal.family().recurrence(degree) }
            })
            .collect();
        let (mut nodes, mut uses) = (Vec::with_capacity(terms.len()), Vec::new());
        for (factors, mut used_by) in terms {
            let Some(&(input, degree)) = factors.last() else { continue };
            uses.append(&mut used_by);
            let row = univariates[input].first_row + usize::from(degree) - 1;
            nodes.push(Node { depth: factors.len(), row, uses_end: uses.len() });
        }
        let depth = nodes.iter().map(|node| node.depth).max().unwrap_or(0);
        Self { univariates, rows, nodes, uses, constants, depth }
    }

    fn flops(&self) -> usize {
        3 * self.rows + self.nodes.len() + 2 * self.uses.len()
    }

    fn evaluate(&self, workspace: &mut Workspace) {
        let Workspace { points, table, path, components } = workspace;
        for (univariate, point) in self.univariates.iter().zip(points.iter()) {
            fill_table(&univariate.recurrence, point, &mut table[univariate.first_row..]);
        }
        for (component, &constant) in components.iter_mut().zip(&self.constants) {
            *component = [constant; LANES];
        }
        let mut uses = self.uses.iter();
        let mut uses_start = 0;
        for node in &self.nodes {
            let (parents, terms) = path.split_at_mut(node.depth);
            let (parent, term, factor) = (&parents[node.depth - 1], &mut terms[0], &table[node.row]);
            for lane in 0..LANES {
                term[lane] = parent[lane] * factor[lane];
            }
            for used in uses.by_ref().take(node.uses_end - uses_start) {
                let component = &mut components[used.component];
                for lane in 0..LANES {
                    component[lane] += used.coefficient * term[lane];
                }
            }
            uses_start = node.uses_end;
        }
    }
}

/// Rows φ_1(x), φ_2(x), … of the univariate table of one input.
fn fill_table(recurrence: &Recurrence, point: &Lanes, table: &mut [Lanes]) {
    let (mut before, mut current, mut coupling) = ([0.0; LANES], [1.0; LANES], 0.0);
    for ((row, center), next_coupling) in table.iter_mut().zip(&recurrence.diagonal).zip(&recurrence.off_diagonal) {
        let inverse = 1.0 / next_coupling;
        for lane in 0..LANES {
            row[lane] = ((point[lane] - center) * current[lane] - coupling * before[lane]) * inverse;
        }
        coupling = *next_coupling;
        (before, current) = (current, *row);
    }
}
