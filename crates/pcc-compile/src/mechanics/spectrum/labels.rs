//! Which eigenvalue is which at every point of a design.
//!
//! Frequency order says nothing of identity: while a mode becomes overdamped, its frequency falls through those of all
//! slower ones. So every eigenvalue, conjugates and real ones too, has a *label*, which is followed from run to run
//! along the shortest tree through the points, by left and right eigenvectors: with those of the neighbour
//! biorthonormal, wᵢᴴvᵢ = 1, the overlap |w_iᴴ v′_j| |w′_jᴴ v_i| is one for the same eigenvalue and zero for another,
//! whatever the scales of the state.
//!
//! Without vectors labels are ranks by |λ|, conjugates side by side: valid as far as the groups made of them are.

use super::derivatives::{ReducedSystem, is_seen_as, nearest};
use super::modes::Spectrum;
use crate::numerics::assignment::assignment;
use nalgebra::{Complex, DMatrix};

/// Neighbours of every point between which eigenvalues are compared, beside those of the tree.
const NEIGHBOURS: usize = 3;

/// Right and left eigenvectors of all eigenvalues of a spectrum, in its order.
#[derive(Debug, Clone, PartialEq)]
pub struct Vectors {
    /// One per column.
    right: DMatrix<Complex<f64>>,
    /// One per row.
    left: DMatrix<Complex<f64>>,
}

impl Vectors {
    /// The vectors of `spectrum` from a system that has all of its eigenvalues, or one of each conjugate pair.
    pub(super) fn new(system: &ReducedSystem, spectrum: &Spectrum) -> Option<Self> {
        let (own, states) = (system.eigenvalues(), system.right().nrows());
        // Derivatives alone have none.
        if states == 0 {
            return None;
        }
        let mut used = vec![false; own.len()];
        let mut take = |lambda: Complex<f64>| {
            let at = nearest((0..own.len()).filter(|&at| is_seen_as(own[at], lambda) && !used[at]), own, lambda)?;
            used[at] = true;
            Some(at)
        };
        let count = spectrum.eigenvalues().len();
        let (mut right, mut left) = (DMatrix::zeros(states, count), DMatrix::zeros(count, states));
        for (position, &lambda) in spectrum.eigenvalues().iter().enumerate() {
            let (at, is_conjugate) = match take(lambda) {
                Some(at) => (at, false),
                // The half of a pair that is not there has the conjugate vectors of the other.
                None if lambda.im < 0.0 => (own.iter().position(|other| is_seen_as(*other, lambda.conj()))?, true),
                None => return None,
            };
            let of = |entry: Complex<f64>| if is_conjugate { entry.conj() } else { entry };
            (0..states).for_each(|i| right[(i, position)] = of(system.right()[(i, at)]));
            (0..states).for_each(|i| left[(position, i)] = of(system.left()[(at, i)]));
        }
        Some(Self { right, left })
    }

    /// Those of every other eigenvalue: the upper halves, where all are conjugate pairs.
    fn upper_half(&self) -> Self {
        let halves: Vec<usize> = (0..self.right.ncols()).step_by(2).collect();
        Self { right: self.right.select_columns(&halves), left: self.left.select_rows(&halves) }
    }
}

/// |w_iᴴ v′_j| |w′_jᴴ v_i| for eigenvalue i of one run and j of another.
fn overlaps(one: &Vectors, other: &Vectors) -> DMatrix<f64> {
    let (there, back) = (moduli(&one.left, &other.right), moduli(&other.left, &one.right));
    DMatrix::from_fn(there.nrows(), there.ncols(), |i, j| {
        let overlap = there[(i, j)] * back[(j, i)];
        // A vector that is not finite matches nothing.
        if overlap.is_finite() { overlap } else { 0.0 }
    })
}

/// The moduli of a product of complex matrices, by four products of real ones, which are much faster.
fn moduli(left: &DMatrix<Complex<f64>>, right: &DMatrix<Complex<f64>>) -> DMatrix<f64> {
    let parts = |matrix: &DMatrix<Complex<f64>>| (matrix.map(|z| z.re), matrix.map(|z| z.im));
    let ((a, b), (c, d)) = (parts(left), parts(right));
    let (re, im) = (&a * &c - &b * &d, &a * &d + &b * &c);
    re.zip_map(&im, f64::hypot)
}

/// The labels of all eigenvalues on a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Labels {
    /// For each run, the position of every label in [`Spectrum::eigenvalues`].
    positions: Vec<Vec<usize>>,
    /// For pairs of labels, how nearly they change places between neighbouring runs: the largest
    /// O_ij O_ji/(O_ii O_jj).
    swaps: DMatrix<f64>,
    follow_vectors: bool,
}

impl Labels {
    /// Follows the eigenvalues of `spectra`, as many in each, at these points, by `vectors`. Labels are the positions
    /// in the run number `root`, which stays the same while a design grows.
    pub fn following(points: &[&[f64]], root: usize, vectors: &[Vectors], spectra: &[&Spectrum]) -> Self {
        let oscillates = |spectrum: &&Spectrum| spectrum.eigenvalues().iter().all(|lambda| lambda.im != 0.0);
        match spectra.iter().all(oscillates) {
            true => {
                let halves: Vec<Vectors> = vectors.iter().map(Vectors::upper_half).collect();
                Self::along_tree(points, root, &halves).with_conjugates()
            }
            false => Self::along_tree(points, root, vectors),
        }
    }

    /// The labels of conjugates beside those of the upper halves of pairs.
    fn with_conjugates(self) -> Self {
        let both = |half: &usize| [2 * half, 2 * half + 1];
        let count = 2 * self.swaps.nrows();
        let is_upper = |i: usize| i.is_multiple_of(2);
        Self {
            positions: self.positions.iter().map(|of_run| of_run.iter().flat_map(both).collect()).collect(),
            swaps: DMatrix::from_fn(count, count, |i, j| {
                if is_upper(i) == is_upper(j) { self.swaps[(i / 2, j / 2)] } else { 0.0 }
            }),
            ..self
        }
    }

    fn along_tree(points: &[&[f64]], root: usize, vectors: &[Vectors]) -> Self {
        let runs = vectors.len();
        let count = vectors[root].right.ncols();
        let distance =
            |a: usize, b: usize| -> f64 { points[a].iter().zip(points[b]).map(|(x, y)| (x - y).powi(2)).sum() };
        let mut positions: Vec<Vec<usize>> = vec![Vec::new(); runs];
        positions[root] = (0..count).collect();
        // The tree of Prim: the nearest run that is not reached yet, from the one that it is nearest to.
        let mut reach: Vec<(f64, usize)> = (0..runs).map(|run| (distance(root, run), root)).collect();
        let mut swaps = DMatrix::zeros(count, count);
        let mut open: Vec<usize> = (0..runs).filter(|&run| run != root).collect();
        while let Some(at) = (0..open.len()).reduce(|a, b| if reach[open[b]].0 < reach[open[a]].0 { b } else { a }) {
            let run = open.remove(at);
            let from = reach[run].1;
            let overlaps = overlaps(&vectors[from], &vectors[run]);
            // Row per label: its eigenvalue at the known end.
            let of_labels = overlaps.select_rows(&positions[from]);
            positions[run] = assignment(&(-&of_labels));
            note_swaps(&mut swaps, &of_labels.select_columns(&positions[run]));
            for &other in &open {
                let through = distance(run, other);
                if through < reach[other].0 {
                    reach[other] = (through, run);
                }
            }
        }
        let mut compared = vec![false; runs * runs];
        for run in 0..runs {
            let mut others: Vec<usize> = (0..runs).filter(|&other| other != run).collect();
            others.sort_by(|&a, &b| distance(run, a).total_cmp(&distance(run, b)).then(a.cmp(&b)));
            for &other in others.iter().take(NEIGHBOURS) {
                if std::mem::replace(&mut compared[run.min(other) * runs + run.max(other)], true) {
                    continue;
                }
                let overlaps = overlaps(&vectors[run], &vectors[other]);
                note_swaps(&mut swaps, &overlaps.select_rows(&positions[run]).select_columns(&positions[other]));
            }
        }
        Self { positions, swaps, follow_vectors: true }
    }

    /// Ranks by |λ|.
    pub fn by_modulus(spectra: &[&Spectrum]) -> Self {
        let count = spectra.first().map_or(0, |spectrum| spectrum.eigenvalues().len());
        Self {
            positions: vec![(0..count).collect(); spectra.len()],
            swaps: DMatrix::zeros(count, count),
            follow_vectors: false,
        }
    }

    /// Number of labels.
    pub fn count(&self) -> usize {
        self.swaps.nrows()
    }

    /// The position of a label in the spectrum of a run.
    pub fn position(&self, run: usize, label: usize) -> usize {
        self.positions[run][label]
    }

    /// How nearly two labels change places between some neighbouring runs: 0 not at all, 1 as likely as not.
    pub fn swap(&self, one: usize, other: usize) -> f64 {
        self.swaps[(one, other)]
    }

    /// Whether vectors were followed; else labels are ranks.
    pub fn follow_vectors(&self) -> bool {
        self.follow_vectors
    }
}

/// Takes note of O_ij O_ji/(O_ii O_jj), for overlaps whose rows and columns are both in the order of labels.
fn note_swaps(swaps: &mut DMatrix<f64>, overlaps: &DMatrix<f64>) {
    for i in 0..overlaps.nrows() {
        for j in 0..i {
            let (crossed, straight) = (overlaps[(i, j)] * overlaps[(j, i)], overlaps[(i, i)] * overlaps[(j, j)]);
            let ratio = if crossed == 0.0 { 0.0 } else { crossed / straight };
            let ratio = if ratio.is_nan() { f64::INFINITY } else { ratio };
            let larger = ratio.max(swaps[(i, j)]);
            (swaps[(i, j)], swaps[(j, i)]) = (larger, larger);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::spectrum::{Reductions, Slopes, Solution};
    use nalgebra::dmatrix;

    /// Two oscillators of frequencies 10 + x and 10 − x, nearly uncoupled: they cross at x = 0.
    fn run(x: f64, coupling: f64) -> (Spectrum, Vectors) {
        let stiffness = dmatrix![(10.0 + x).powi(2), coupling; coupling, (10.0 - x).powi(2)];
        let mut state = DMatrix::zeros(4, 4);
        state.view_mut((0, 2), (2, 2)).fill_with_identity();
        state.view_mut((2, 0), (2, 2)).copy_from(&-stiffness);
        state.view_mut((2, 2), (2, 2)).copy_from(&dmatrix![-0.1, 0.0; 0.0, -0.3]);
        let solution = Solution::new(state, None).unwrap();
        let spectrum = Spectrum::new(solution.eigenvalues()).unwrap();
        let vectors = Reductions::new(&solution, Slopes::default(), &spectrum, vec![1, 2]).vectors(&spectrum).unwrap();
        (spectrum, vectors)
    }

    fn labels(coupling: f64) -> (Labels, Vec<Spectrum>) {
        let xs = [-0.9, -0.3, 0.3, 0.9];
        let (spectra, vectors): (Vec<_>, Vec<_>) = xs.iter().map(|&x| run(x, coupling)).unzip();
        let points: Vec<&[f64]> = xs.iter().map(std::slice::from_ref).collect();
        let labels = Labels::following(&points, 1, &vectors, &spectra.iter().collect::<Vec<_>>());
        (labels, spectra)
    }

    #[test]
    fn modes_that_cross_keep_their_labels() {
        let (labels, spectra) = labels(0.01);
        for (run, spectrum) in spectra.iter().enumerate() {
            let damping = |label: usize| spectrum.eigenvalues()[labels.position(run, label)].re;
            // At the root, x = −0.3, the lower frequency is that of the first oscillator.
            assert!((damping(0) + 0.05).abs() < 1e-3 && (damping(2) + 0.15).abs() < 1e-3, "{run}");
            assert_eq!(spectrum.conjugate(labels.position(run, 0)), labels.position(run, 1), "{run}");
        }
        assert!(labels.follow_vectors() && labels.swap(0, 2) < 1e-3 && labels.swap(0, 1) < 1e-3);
    }

    #[test]
    fn modes_that_exchange_their_shapes_are_told() {
        assert!(labels(5.0).0.swap(0, 2) > 0.05);
    }
}
