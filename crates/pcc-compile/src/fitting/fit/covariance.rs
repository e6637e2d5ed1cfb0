//! The covariance of values and derivatives under a prior, and how it changes with the prior's parameters.

use super::covariance_of_many::{self, Layout};
use super::prior::Prior;
use crate::fitting::regression::{BasisTables, Equations};
use nalgebra::DMatrix;

/// From so many inputs on sums and products are made for many blocks together.
const MANY_INPUTS: usize = 12;

/// The matrix K of a prior for some equations, with what its derivatives need.
///
/// The block of K for derivatives by input A in its rows and by input B in its columns (0: values) is the product over
/// inputs j of sums Σ_n v w_jⁿ f_n g_n, where f is φ′_n if j = A, else φ_n, and g accordingly with B; where neither is
/// φ′, the degree 0 adds one.
pub(super) struct Kernel {
    /// K.
    pub matrix: DMatrix<f64>,
    equations: Equations,
    inputs: Vec<InputKernel>,
}

/// What stands in the rows or columns of a block, seen by one input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// φ at all points.
    Values,
    /// φ at the points with derivatives.
    ValuesAtDerivatives,
    /// φ′ at the points with derivatives.
    Slopes,
}

/// Pairs of sides that occur in the upper triangle of blocks.
const PAIRS: [(Side, Side); 7] = [
    (Side::Values, Side::Values),
    (Side::Values, Side::ValuesAtDerivatives),
    (Side::Values, Side::Slopes),
    (Side::ValuesAtDerivatives, Side::ValuesAtDerivatives),
    (Side::ValuesAtDerivatives, Side::Slopes),
    (Side::Slopes, Side::ValuesAtDerivatives),
    (Side::Slopes, Side::Slopes),
];

/// One input's factor of every block.
pub(super) struct InputKernel {
    /// One per pair of sides, as many as occur.
    pub factors: Vec<Factor>,
}

pub(super) struct Factor {
    pub value: DMatrix<f64>,
    /// By ln(−ln w_j).
    pub by_decay: DMatrix<f64>,
    /// What degree 0 adds to every entry.
    pub constant: f64,
}

impl Kernel {
    pub fn new(prior: &Prior, tables: &BasisTables, equations: &Equations, degree: u16) -> Self {
        let size = equations.rows();
        let inputs =
            (0..prior.inputs()).map(|input| InputKernel::new(prior, input, tables, equations, degree)).collect();
        let mut kernel = Self { matrix: DMatrix::zeros(size, size), equations: equations.clone(), inputs };
        if let Some(layout) = kernel.many() {
            kernel.matrix = covariance_of_many::matrix(&kernel.inputs, layout);
            return kernel;
        }
        for (rows, columns) in kernel.blocks() {
            let mut product = kernel.factor(0, rows, columns).value.clone();
            for input in 1..kernel.inputs.len() {
                product.component_mul_assign(&kernel.factor(input, rows, columns).value);
            }
            let at = (kernel.first_row(rows), kernel.first_row(columns));
            if rows != columns {
                kernel
                    .matrix
                    .view_mut((at.1, at.0), (product.ncols(), product.nrows()))
                    .copy_from(&product.transpose());
            }
            kernel.matrix.view_mut(at, product.shape()).copy_from(&product);
        }
        kernel
    }

    /// For a function f of K with df = Σ G_ab dK_ab and a symmetric G, its derivatives by the parameters of the prior.
    pub fn gradient(&self, by_matrix: &DMatrix<f64>) -> Vec<f64> {
        if let Some(layout) = self.many() {
            return covariance_of_many::gradient(&self.inputs, layout, &self.matrix, by_matrix);
        }
        let (mut gradient, mut by_weight) = (vec![0.0; self.inputs.len()], 0.0);
        for (rows, columns) in self.blocks() {
            let at = (self.first_row(rows), self.first_row(columns));
            let shape = self.factor(0, rows, columns).value.shape();
            let mut weighted = by_matrix.view(at, shape).component_mul(&self.matrix.view(at, shape));
            if rows != columns {
                weighted *= 2.0;
            }
            for (input, slope) in gradient.iter_mut().enumerate() {
                let Factor { value, by_decay, constant } = self.factor(input, rows, columns);
                let [decay, weight] = sums(weighted.as_slice(), value.as_slice(), by_decay.as_slice(), *constant);
                *slope += decay;
                by_weight += weight;
            }
        }
        gradient.push(by_weight);
        gradient
    }

    /// Where blocks are, if there are so many that they are better not made one by one.
    fn many(&self) -> Option<Layout> {
        let derivatives = self.equations.points_with_derivatives().len();
        let layout = Layout { samples: self.equations.samples(), derivatives };
        (derivatives > 0 && self.inputs.len() >= MANY_INPUTS).then_some(layout)
    }

    /// The blocks on and above the diagonal: values are 0, derivatives by input j are j + 1.
    fn blocks(&self) -> Vec<(usize, usize)> {
        let last = if self.equations.points_with_derivatives().is_empty() { 0 } else { self.inputs.len() };
        (0..=last).flat_map(|rows| (rows..=last).map(move |columns| (rows, columns))).collect()
    }

    fn first_row(&self, block: usize) -> usize {
        match block {
            0 => 0,
            _ => self.equations.samples() + (block - 1) * self.equations.points_with_derivatives().len(),
        }
    }

    /// The factor of an input in a block.
    fn factor(&self, input: usize, rows: usize, columns: usize) -> &Factor {
        let side = |block: usize| match block {
            0 => Side::Values,
            by if by == input + 1 => Side::Slopes,
            _ => Side::ValuesAtDerivatives,
        };
        let pair = (side(rows), side(columns));
        let at = PAIRS.iter().position(|known| *known == pair).expect("a pair of the upper triangle");
        &self.inputs[input].factors[at]
    }
}

impl InputKernel {
    fn new(prior: &Prior, input: usize, tables: &BasisTables, equations: &Equations, degree: u16) -> Self {
        let (variances, slopes) = prior.variances(input, degree);
        let used = variances.len() as u16;
        let points = equations.points_with_derivatives();
        let side = |side: Side| {
            let powers = tables.powers(input, used);
            match side {
                Side::Values => powers.rows(0, equations.samples()).into_owned(),
                Side::ValuesAtDerivatives => powers.select_rows(points),
                Side::Slopes => tables.power_slopes(input, used).expect("tables with derivatives").select_rows(points),
            }
        };
        let pairs = if points.is_empty() { &PAIRS[..1] } else { &PAIRS[..] };
        let factor = |&(rows, columns): &(Side, Side)| {
            let (left, transposed) = (side(rows), side(columns).transpose());
            let (mut by_value, mut by_slope) = (left.clone(), left);
            for (n, (variance, slope)) in variances.iter().zip(&slopes).enumerate() {
                by_value.column_mut(n).scale_mut(*variance);
                by_slope.column_mut(n).scale_mut(*slope);
            }
            let constant = if rows == Side::Slopes || columns == Side::Slopes { 0.0 } else { 1.0 };
            let mut value = by_value * &transposed;
            value.add_scalar_mut(constant);
            Factor { value, by_decay: by_slope * transposed, constant }
        };
        Self { factors: pairs.iter().map(factor).collect() }
    }
}

/// Entries summed side by side.
const LANES: usize = 8;

/// Σ h b/k and Σ h (k − constant)/k over the entries h, k, b of three matrices, in eight interleaved parts.
pub(super) fn sums(weighted: &[f64], factor: &[f64], slope: &[f64], constant: f64) -> [f64; 2] {
    let (mut decay, mut weight) = ([0.0; LANES], [0.0; LANES]);
    let mut add = |h: &[f64; LANES], k: &[f64; LANES], b: &[f64; LANES]| {
        for lane in 0..LANES {
            // No entry of a kernel is exactly zero but by chance, and then h is, too.
            let others = h[lane] / if k[lane] == 0.0 { 1.0 } else { k[lane] };
            decay[lane] += others * b[lane];
            weight[lane] += others * (k[lane] - constant);
        }
    };
    let ((h, h_rest), (k, k_rest), (b, b_rest)) = (weighted.as_chunks(), factor.as_chunks(), slope.as_chunks());
    for ((h, k), b) in h.iter().zip(k).zip(b) {
        add(h, k, b);
    }
    let padded = |rest: &[f64], filling: f64| {
        let mut lanes = [filling; LANES];
        lanes[..rest.len()].copy_from_slice(rest);
        lanes
    };
    add(&padded(h_rest, 0.0), &padded(k_rest, 1.0), &padded(b_rest, 0.0));
    [decay.iter().sum(), weight.iter().sum()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::design::{NestedLatinHypercube, Samples};
    use pcc_evaluate::polynomials::{Family, MultiIndex};

    const DEGREE: u16 = 4;

    fn tables() -> BasisTables {
        let mut design = NestedLatinHypercube::new(2, 3);
        design.grow_to(6);
        let samples: Samples = design.samples(|_, u| 2.0 * u - 1.0);
        BasisTables::with_slopes(&samples, &vec![Family::Legendre.recurrence(DEGREE.into()); 2], DEGREE.into())
    }

    /// All terms up to the degree, one by one.
    #[test]
    fn product_form_equals_the_sum_over_all_terms() {
        let (tables, prior) = (tables(), Prior::with(&[0.1, 0.4, -0.5]));
        let terms: Vec<MultiIndex> =
            (0..=DEGREE).flat_map(|a| (0..=DEGREE).map(move |b| MultiIndex::new(vec![a, b]))).collect();
        for points in [vec![], vec![1, 2, 5], (0..6).collect()] {
            let equations = Equations::with_derivatives(6, 2, points);
            let mut columns = tables.stacked(&terms, &equations);
            for (mut column, alpha) in columns.column_iter_mut().zip(&terms) {
                column.scale_mut(prior.variance(alpha).sqrt());
            }
            let expected = &columns * columns.transpose();
            let found = Kernel::new(&prior, &tables, &equations, DEGREE).matrix;
            assert!((&found - &expected).amax() < 1e-13 * expected.amax());
        }
    }

    /// With these inputs the matrix and its derivatives are made in another way, which must be as good.
    #[test]
    fn many_inputs_have_the_covariances_of_their_terms() {
        const INPUTS: usize = MANY_INPUTS;
        let mut design = NestedLatinHypercube::new(INPUTS, 3);
        design.grow_to(5);
        let samples: Samples = design.samples(|_, u| 2.0 * u - 1.0);
        let tables = BasisTables::with_slopes(&samples, &vec![Family::Legendre.recurrence(2); INPUTS], 2);
        let at: Vec<f64> = (0..INPUTS).map(|j| 0.1 + 0.03 * j as f64).chain([-1.5]).collect();
        let equations = Equations::with_derivatives(5, INPUTS, vec![0, 2, 3]);
        let kernel = |parameters: &[f64]| Kernel::new(&Prior::with(parameters), &tables, &equations, 2);
        let prior = Prior::with(&at);
        let terms = prior.likeliest(3usize.pow(INPUTS as u32), 2);
        let mut columns = tables.stacked(&terms, &equations);
        for (mut column, alpha) in columns.column_iter_mut().zip(&terms) {
            column.scale_mut(prior.variance(alpha).sqrt());
        }
        let expected = &columns * columns.transpose();
        let found = kernel(&at).matrix;
        assert!((&found - &expected).amax() < 1e-12 * expected.amax());
        let size = equations.rows();
        let by_matrix = DMatrix::from_fn(size, size, |a, b| ((a + b) as f64).sin() + (a * b) as f64 * 0.01);
        let gradient = kernel(&at).gradient(&by_matrix);
        for k in [0, 1, INPUTS - 1, INPUTS] {
            let moved = |step: f64| {
                let mut parameters = at.clone();
                parameters[k] += step;
                kernel(&parameters).matrix.dot(&by_matrix)
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((gradient[k] - difference).abs() < 1e-6 * (1.0 + difference.abs()), "{k}");
        }
    }

    #[test]
    fn gradient_is_that_of_differences() {
        let (tables, at) = (tables(), [0.1, 0.4, -0.5]);
        let equations = Equations::with_derivatives(6, 2, vec![0, 2, 3, 4]);
        let kernel = |parameters: &[f64]| Kernel::new(&Prior::with(parameters), &tables, &equations, DEGREE);
        let size = equations.rows();
        let by_matrix = DMatrix::from_fn(size, size, |a, b| ((a + b) as f64).sin() + (a * b) as f64 * 0.01);
        let function = |parameters: &[f64]| kernel(parameters).matrix.dot(&by_matrix);
        for (k, slope) in kernel(&at).gradient(&by_matrix).into_iter().enumerate() {
            let moved = |step: f64| {
                let mut parameters = at;
                parameters[k] += step;
                function(&parameters)
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((slope - difference).abs() < 1e-7 * (1.0 + slope.abs()), "{k}: {slope} against {difference}");
        }
    }
}
