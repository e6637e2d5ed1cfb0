//! The covariances of many inputs, in a time that grows with the square of their number and not with its cube.
//!
//! A block of derivatives by A in its rows and by B in its columns has the factor of values from every other input, the
//! same one in all of these blocks. So products over inputs before, between and behind A and B are carried along, and
//! what a derivative by the parameters of an input sums over all blocks is summed over the blocks first.

use super::covariance::{Factor, InputKernel, sums};
use nalgebra::DMatrix;

/// Positions of [`super::covariance::PAIRS`].
const VALUES: usize = 0;
const VALUES_BESIDE: usize = 1;
const VALUES_SLOPES: usize = 2;
const BESIDE: usize = 3;
const BESIDE_SLOPES: usize = 4;
const SLOPES_BESIDE: usize = 5;
const SLOPES: usize = 6;

/// Where blocks are in the whole matrix: values at so many points, then derivatives at so many by every input.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub samples: usize,
    pub derivatives: usize,
}

impl Layout {
    /// The first row of the block of an input.
    fn first(self, input: usize) -> usize {
        self.samples + input * self.derivatives
    }
}

/// K of inputs of which all have derivatives.
pub(super) fn matrix(inputs: &[InputKernel], layout: Layout) -> DMatrix<f64> {
    let Layout { samples, derivatives } = layout;
    let factor = |input: usize, pair: usize| &inputs[input].factors[pair].value;
    let size = layout.first(inputs.len());
    let mut matrix = DMatrix::zeros(size, size);
    let ones = |rows: usize, columns: usize| DMatrix::from_element(rows, columns, 1.0);
    let values = inputs
        .iter()
        .fold(ones(samples, samples), |product, input| product.component_mul(&input.factors[VALUES].value));
    matrix.view_mut((0, 0), (samples, samples)).copy_from(&values);
    let behind_beside = products_behind(inputs, VALUES_BESIDE, ones(samples, derivatives));
    let mut before = ones(samples, derivatives);
    for b in 0..inputs.len() {
        let block = before.component_mul(factor(b, VALUES_SLOPES)).component_mul(&behind_beside[b + 1]);
        put(&mut matrix, &block, (0, layout.first(b)));
        before.component_mul_assign(factor(b, VALUES_BESIDE));
    }
    let behind = products_behind(inputs, BESIDE, ones(derivatives, derivatives));
    let mut before = ones(derivatives, derivatives);
    for a in 0..inputs.len() {
        let own = before.component_mul(factor(a, SLOPES)).component_mul(&behind[a + 1]);
        put(&mut matrix, &own, (layout.first(a), layout.first(a)));
        let mut up_to_b = before.component_mul(factor(a, SLOPES_BESIDE));
        for b in a + 1..inputs.len() {
            let block = up_to_b.component_mul(factor(b, BESIDE_SLOPES)).component_mul(&behind[b + 1]);
            put(&mut matrix, &block, (layout.first(a), layout.first(b)));
            up_to_b.component_mul_assign(factor(b, BESIDE));
        }
        before.component_mul_assign(factor(a, BESIDE));
    }
    matrix
}

/// Products of a factor over the inputs from each on.
fn products_behind(inputs: &[InputKernel], pair: usize, ones: DMatrix<f64>) -> Vec<DMatrix<f64>> {
    let mut products = vec![ones; inputs.len() + 1];
    for input in (0..inputs.len()).rev() {
        products[input] = products[input + 1].component_mul(&inputs[input].factors[pair].value);
    }
    products
}

/// Writes a block and its mirror image.
fn put(matrix: &mut DMatrix<f64>, block: &DMatrix<f64>, at: (usize, usize)) {
    matrix.view_mut(at, block.shape()).copy_from(block);
    if at.0 != at.1 {
        matrix.view_mut((at.1, at.0), (block.ncols(), block.nrows())).copy_from(&block.transpose());
    }
}

/// Sums over blocks of G_ab K_ab, by the factor that an input has in them.
struct BlockSums {
    /// Blocks of values and derivatives by this input, then of derivatives by it and by later, by earlier inputs, and
    /// by itself.
    own: Vec<[DMatrix<f64>; 4]>,
    /// All blocks of values and derivatives, and all of derivatives.
    all: [DMatrix<f64>; 2],
}

impl BlockSums {
    fn new(weighted: impl Fn((usize, usize), (usize, usize)) -> DMatrix<f64>, inputs: usize, layout: Layout) -> Self {
        let Layout { samples, derivatives } = layout;
        let square = DMatrix::zeros(derivatives, derivatives);
        let mut all = [DMatrix::zeros(samples, derivatives), square.clone()];
        let mut own: Vec<[DMatrix<f64>; 4]> = (0..inputs)
            .map(|b| {
                let beside_values = 2.0 * weighted((0, layout.first(b)), (samples, derivatives));
                all[0] += &beside_values;
                [beside_values, square.clone(), square.clone(), square.clone()]
            })
            .collect();
        for a in 0..inputs {
            for b in a..inputs {
                let block = weighted((layout.first(a), layout.first(b)), (derivatives, derivatives));
                if a == b {
                    all[1] += &block;
                    own[a][3] = block;
                } else {
                    let both = 2.0 * block;
                    all[1] += &both;
                    own[a][1] += &both;
                    own[b][2] += both;
                }
            }
        }
        Self { own, all }
    }
}

/// For a function f of K with df = Σ G_ab dK_ab and a symmetric G, its derivatives by the parameters of the prior.
pub(super) fn gradient(
    inputs: &[InputKernel],
    layout: Layout,
    matrix: &DMatrix<f64>,
    by_matrix: &DMatrix<f64>,
) -> Vec<f64> {
    let weighted =
        |at: (usize, usize), shape: (usize, usize)| by_matrix.view(at, shape).component_mul(&matrix.view(at, shape));
    let values = weighted((0, 0), (layout.samples, layout.samples));
    let blocks = BlockSums::new(weighted, inputs.len(), layout);
    let (mut gradient, mut by_weight) = (vec![0.0; inputs.len()], 0.0);
    for (slope, (input, own)) in gradient.iter_mut().zip(inputs.iter().zip(&blocks.own)) {
        let [beside_values, later, earlier, itself] = own;
        let other_values = &blocks.all[0] - beside_values;
        let others = &blocks.all[1] - later - earlier - itself;
        let parts = [
            (VALUES, &values),
            (VALUES_BESIDE, &other_values),
            (VALUES_SLOPES, beside_values),
            (BESIDE, &others),
            (BESIDE_SLOPES, earlier),
            (SLOPES_BESIDE, later),
            (SLOPES, itself),
        ];
        for (pair, sum) in parts {
            let Factor { value, by_decay, constant } = &input.factors[pair];
            let [decay, weight] = sums(sum.as_slice(), value.as_slice(), by_decay.as_slice(), *constant);
            *slope += decay;
            by_weight += weight;
        }
    }
    gradient.push(by_weight);
    gradient
}
