//! A rising function of a standard normal variable in pieces, each a polynomial: how the quantiles of a law are kept in
//! files, so that nobody who reads them needs the law's special functions.

use super::normal_quantile::distribution;
use super::root;
use crate::polynomials::{Family, gauss};

/// Degree of every piece.
pub(crate) const DEGREE: usize = 12;

/// Pieces cover normal scores from −8.5 to 8.5; random numbers reach 8.3. Beyond, the ends count.
pub(crate) const REACH: f64 = 8.5;

/// Equal cells, of which each knows its first piece. Ends of pieces are ends of cells, but for kinks.
const CELLS: usize = 1 << 10;

/// Cells of the widest pieces.
const WIDEST: usize = 64;

/// Pieces of a function that is made, at most: a few dozen where it is smooth, and as many for every jump.
const MOST: usize = 1 << 11;

/// Errors that are accepted, relative to the largest value of a piece; values below [`NOTHING`] are as good as zero.
pub(super) const TOLERANCE: f64 = 2e-14;
const NOTHING: f64 = 1e-280;

/// One piece: Σ c_k t^k with t = (z − centre) · `inverse_half_width` ∈ \[−1, 1\].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    end: f64,
    center: f64,
    inverse_half_width: f64,
    coefficients: [f64; DEGREE + 1],
}

impl Piece {
    fn new([from, to]: [f64; 2], coefficients: [f64; DEGREE + 1]) -> Self {
        Self { end: to, center: 0.5 * (from + to), inverse_half_width: 2.0 / (to - from), coefficients }
    }

    /// The straight line between two values.
    fn line(ends: [f64; 2], [from, to]: [f64; 2]) -> Self {
        let mut coefficients = [0.0; DEGREE + 1];
        (coefficients[0], coefficients[1]) = (0.5 * (from + to), 0.5 * (to - from));
        Self::new(ends, coefficients)
    }

    /// The same plus a straight line, so that its ends have these values.
    fn through(mut self, values: [f64; 2]) -> Self {
        let half = 1.0 / self.inverse_half_width;
        let [left, right] = [values[0] - self.value(self.center - half), values[1] - self.value(self.center + half)];
        self.coefficients[0] += 0.5 * (left + right);
        self.coefficients[1] += 0.5 * (right - left);
        self
    }

    #[inline(always)]
    fn value(&self, z: f64) -> f64 {
        let t = (z - self.center) * self.inverse_half_width;
        let c = &self.coefficients;
        let mut value = c[DEGREE];
        for k in (0..DEGREE).rev() {
            value = value.mul_add(t, c[k]);
        }
        value
    }

    fn slope(&self, z: f64) -> f64 {
        let t = (z - self.center) * self.inverse_half_width;
        let terms = self.coefficients.iter().enumerate().skip(1).rev();
        self.inverse_half_width * terms.fold(0.0, |sum: f64, (k, c)| sum.mul_add(t, k as f64 * c))
    }
}

/// The function.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pieces {
    pieces: Vec<Piece>,
    /// The first piece of each cell.
    first: Vec<u16>,
}

impl Pieces {
    /// Pieces of a rising function that is analytic between `kinks`, as many as it takes; `None`
    /// where more than [`MOST`] would not do, as of a function that is not known well enough.
    pub fn of(function: impl Fn(f64) -> f64, kinks: &[f64]) -> Option<Self> {
        /// A kink this near to an end is there but for rounding, as the middle of a symmetric law.
        const ROUNDING: f64 = 1e-14;
        let mut pieces = Vec::new();
        for first in (0..CELLS).step_by(WIDEST) {
            let ends = [edge(first), edge(first + WIDEST)];
            let inner = kinks.iter().copied().filter(|kink| ends[0] + ROUNDING < *kink && *kink < ends[1] - ROUNDING);
            let breaks: Vec<f64> = std::iter::once(ends[0]).chain(inner).chain([ends[1]]).collect();
            // Between kinks halves are no ends of cells, which costs steps, not correctness.
            breaks.windows(2).for_each(|ends| divide(&function, [ends[0], ends[1]], &mut pieces));
        }
        (pieces.len() <= MOST).then(|| Self::with_cells(pieces))
    }

    /// Pieces between `breaks` with these coefficients; a sentence if they are no rising function on all scores.
    pub fn stored(breaks: &[f64], coefficients: &[Vec<f64>]) -> Result<Self, &'static str> {
        let is_cover = breaks.len() == coefficients.len() + 1
            && (breaks.first(), breaks.last()) == (Some(&-REACH), Some(&REACH))
            && breaks.is_sorted_by(|a, b| a < b)
            && coefficients.len() <= usize::from(u16::MAX);
        if !is_cover {
            return Err("its pieces do not cover all normal scores");
        }
        let mut pieces = Vec::with_capacity(coefficients.len());
        for (ends, coefficients) in breaks.windows(2).zip(coefficients) {
            let coefficients = match coefficients[..] {
                [constant] => std::array::from_fn(|k| if k == 0 { constant } else { 0.0 }),
                ref all => all.try_into().map_err(|_| "a piece has not 1 or 13 coefficients")?,
            };
            pieces.push(Piece::new([ends[0], ends[1]], coefficients));
        }
        let pieces = Self::with_cells(pieces);
        if pieces.is_rising() { Ok(pieces) } else { Err("its pieces are not finite and rising") }
    }

    /// Steps: `values` in ascending order, one giving way to the next at these normal scores.
    pub fn steps(values: &[f64], scores: &[f64]) -> Self {
        let (mut pieces, mut start) = (Vec::with_capacity(values.len()), -REACH);
        for (value, end) in values.iter().zip(scores.iter().copied().chain([REACH])) {
            // What is rarer than any random number has no piece.
            if end > start {
                let mut coefficients = [0.0; DEGREE + 1];
                coefficients[0] = *value;
                pieces.push(Piece::new([start, end], coefficients));
                start = end;
            }
        }
        Self::with_cells(pieces)
    }

    /// Whether all pieces are constant.
    pub fn are_steps(&self) -> bool {
        self.pieces.iter().all(|piece| piece.coefficients[1..] == [0.0; DEGREE])
    }

    /// Values with their weights: of steps exactly, else by a Gauss rule on each piece.
    pub fn rule(&self) -> (Vec<f64>, Vec<f64>) {
        if self.are_steps() {
            let ends = self.breaks();
            let weights = ends.windows(2).map(|ends| distribution(ends[1]) - distribution(ends[0]));
            return (self.pieces.iter().map(|piece| piece.coefficients[0]).collect(), weights.collect());
        }
        let legendre = Family::Legendre.recurrence(DEGREE);
        let (places, shares) = gauss(&legendre.diagonal, &legendre.off_diagonal[..DEGREE - 1]);
        let of_piece = |piece: &Piece| -> Vec<(f64, f64)> {
            let half = 1.0 / piece.inverse_half_width;
            let scores = places.iter().map(|place| half.mul_add(*place, piece.center));
            scores.zip(&shares).map(|(z, share)| (piece.value(z), share * half * (-0.5 * z * z).exp())).collect()
        };
        self.pieces.iter().flat_map(of_piece).unzip()
    }

    /// The normal scores at which the first of the steps in an interval of values begins, and the last one ends.
    pub fn scores_of_levels(&self, [lower, upper]: [f64; 2]) -> [f64; 2] {
        /// Of a standard deviation: levels that are typed are not always the same to the last digit.
        const ROUNDING: f64 = 1e-9;
        let before = |value: f64| self.pieces.partition_point(|piece| piece.coefficients[0] < value);
        let end = |at: usize| at.checked_sub(1).map_or(-REACH, |last| self.pieces[last].end);
        [end(before(lower - ROUNDING)), end(before(upper + ROUNDING))]
    }

    /// The steps next to a value, below and above.
    pub fn levels_around(&self, value: f64) -> [f64; 2] {
        let above = self.pieces.partition_point(|piece| piece.coefficients[0] < value).min(self.pieces.len() - 1);
        [above.saturating_sub(1), above].map(|at| self.pieces[at].coefficients[0])
    }

    fn with_cells(pieces: Vec<Piece>) -> Self {
        let first_of = |cell: usize| pieces.partition_point(|piece| piece.end <= edge(cell)).min(pieces.len() - 1);
        let first = (0..CELLS).map(|cell| first_of(cell) as u16).collect();
        Self { pieces, first }
    }

    /// Where pieces begin and end.
    pub fn breaks(&self) -> Vec<f64> {
        std::iter::once(-REACH).chain(self.pieces.iter().map(|piece| piece.end)).collect()
    }

    /// Coefficients of each piece, of t ∈ \[−1, 1\], constant first; of a step that alone.
    pub fn coefficients(&self) -> impl Iterator<Item = &[f64]> {
        self.pieces.iter().map(|piece| match piece.coefficients.split_first() {
            Some((_, [0.0, rest @ ..])) if rest.iter().all(|c| *c == 0.0) => &piece.coefficients[..1],
            _ => piece.coefficients.as_slice(),
        })
    }

    /// The value at a normal score.
    #[inline(always)]
    pub fn at(&self, z: f64) -> f64 {
        let z = z.clamp(-REACH, REACH);
        self.piece(z).value(z)
    }

    /// Its derivative there.
    pub fn slope(&self, z: f64) -> f64 {
        let z = z.clamp(-REACH, REACH);
        self.piece(z).slope(z)
    }

    /// The normal score of a value: the end nearest to it, if it has none.
    pub fn score(&self, value: f64) -> f64 {
        let at = self.pieces.partition_point(|piece| piece.value(piece.end) < value).min(self.pieces.len() - 1);
        let piece = &self.pieces[at];
        if piece.coefficients[1..] == [0.0; DEGREE] {
            return piece.center;
        }
        let start = 2.0f64.mul_add(piece.center, -piece.end);
        root::rising(|z| piece.value(z) - value, |z| piece.slope(z), [start, piece.end])
    }

    #[inline(always)]
    fn piece(&self, z: f64) -> &Piece {
        const PER_UNIT: f64 = CELLS as f64 / (2.0 * REACH);
        let cell = ((z + REACH) * PER_UNIT) as usize;
        let mut at = usize::from(self.first[cell.min(CELLS - 1)]);
        while self.pieces[at].end < z && at + 1 < self.pieces.len() {
            at += 1;
        }
        &self.pieces[at]
    }

    /// Whether values at places inside all pieces are finite and never fall.
    pub fn is_rising(&self) -> bool {
        const PLACES: u32 = 8;
        /// Of a standard deviation, or of a value that is many: rounding of neighbouring pieces.
        const ROUNDING: f64 = 1e-9;
        let mut last = f64::NEG_INFINITY;
        self.pieces.iter().all(|piece| {
            (0..=PLACES).all(|k| {
                let t = f64::from(2 * k) / f64::from(PLACES) - 1.0;
                let value = piece.value(piece.center + t / piece.inverse_half_width);
                let is_rising = value.is_finite() && value >= last - ROUNDING * value.abs().max(last.abs()).max(1.0);
                last = value;
                is_rising
            })
        })
    }
}

/// Where cell number `cell` begins.
fn edge(cell: usize) -> f64 {
    (cell as f64).mul_add(2.0 * REACH / CELLS as f64, -REACH)
}

/// One piece between `ends`, or halves of it as long as that is not exact enough, in its value or in the score that has
/// it. Where a density nearly vanishes its quantiles jump: a straight line is left of that, over next to no
/// probability. More than [`MOST`] pieces are given up.
fn divide(function: &impl Fn(f64) -> f64, ends: [f64; 2], pieces: &mut Vec<Piece>) {
    /// Below the width of a cell errors are accepted of a function that is not known better.
    const CELL: f64 = 2.0 * REACH / CELLS as f64;
    const LOOSE: f64 = 1e-10;
    const LOOSE_SCORE: f64 = 1e-13;
    const NARROWEST: f64 = CELL / (1_u64 << 34) as f64;
    const TESTS: usize = 9;
    if pieces.len() > MOST {
        return;
    }
    let width = ends[1] - ends[0];
    let values = ends.map(function);
    let largest = values.into_iter().map(f64::abs).fold(0.0, f64::max);
    let error = if width > CELL { TOLERANCE * largest } else { LOOSE * largest.max(1.0) };
    let tests: [f64; TESTS] = std::array::from_fn(|k| ends[0] + width * (k as f64 + 0.5) / TESTS as f64);
    let piece = fitted(function, ends);
    if tests.iter().all(|&z| (piece.value(z) - function(z)).abs() <= error.max(NOTHING)) {
        return pieces.push(piece);
    }
    let continuous = piece.through(values);
    let has_score = |z: f64| (function(z - LOOSE_SCORE)..=function(z + LOOSE_SCORE)).contains(&continuous.value(z));
    if width <= NARROWEST {
        pieces.push(Piece::line(ends, values));
    } else if width <= CELL && tests.into_iter().all(has_score) {
        pieces.push(continuous);
    } else {
        let middle = 0.5 * (ends[0] + ends[1]);
        divide(function, [ends[0], middle], pieces);
        divide(function, [middle, ends[1]], pieces);
    }
}

/// The polynomial through the values at Chebyshev's nodes.
fn fitted(function: &impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> Piece {
    const COUNT: usize = DEGREE + 1;
    let (center, half) = (0.5 * (from + to), 0.5 * (to - from));
    let angle = |j: usize| std::f64::consts::PI * (j as f64 + 0.5) / COUNT as f64;
    let values: [f64; COUNT] = std::array::from_fn(|j| function(half.mul_add(angle(j).cos(), center)));
    // T_0, T_1, … by powers of t, and the sum of all with their coefficients.
    let (mut before, mut current) = ([0.0; COUNT], [0.0; COUNT]);
    current[0] = 1.0;
    let mut coefficients = [0.0; COUNT];
    for k in 0..COUNT {
        let sum: f64 = values.iter().enumerate().map(|(j, value)| value * (k as f64 * angle(j)).cos()).sum();
        let factor = if k == 0 { 1.0 } else { 2.0 } / COUNT as f64 * sum;
        coefficients.iter_mut().zip(&current).for_each(|(sum, power)| *sum += factor * power);
        let twice = if k == 0 { 1.0 } else { 2.0 };
        let next = std::array::from_fn(|p| if p == 0 { 0.0 } else { twice * current[p - 1] } - before[p]);
        (before, current) = (current, next);
    }
    Piece::new([from, to], coefficients)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_functions_are_kept_to_rounding_and_undone() {
        let function = |z: f64| (0.7 * z).exp();
        let pieces = Pieces::of(function, &[]).unwrap();
        for k in -840..=840 {
            let z = f64::from(k) / 100.0 + 1e-3;
            assert!((pieces.at(z) - function(z)).abs() < 1e-13 * function(z), "{z}");
            assert!((pieces.slope(z) - 0.7 * function(z)).abs() < 1e-10 * function(z), "{z}");
            assert!((pieces.score(function(z)) - z).abs() < 1e-12, "{z}");
        }
        assert_eq!((pieces.at(-20.0), pieces.at(20.0)), (pieces.at(-REACH), pieces.at(REACH)));
        assert!(pieces.pieces.len() < 40, "{}", pieces.pieces.len());
    }

    #[test]
    fn noise_is_given_up() {
        assert_eq!(Pieces::of(|z| z + 1e-8 * (1e9 * z).sin(), &[]), None);
    }

    #[test]
    fn kinks_are_ends_of_pieces() {
        let function = |z: f64| if z < 0.3 { z } else { 0.3 + 2.0 * (z - 0.3) };
        let pieces = Pieces::of(function, &[0.3]).unwrap();
        assert!(pieces.pieces.len() <= 17);
        for z in [-8.5, -1.0, 0.2999, 0.3, 0.3001, 0.5, 8.5] {
            assert!((pieces.at(z) - function(z)).abs() < 1e-13, "{z}");
        }
    }

    #[test]
    fn what_is_stored_is_the_same_and_what_falls_is_refused() {
        let pieces = Pieces::of(|z| (0.2 * z).sinh(), &[]).unwrap();
        let mut coefficients: Vec<Vec<f64>> = pieces.coefficients().map(<[f64]>::to_vec).collect();
        assert_eq!(Pieces::stored(&pieces.breaks(), &coefficients), Ok(pieces.clone()));
        coefficients[3][1] = -1.0;
        assert!(Pieces::stored(&pieces.breaks(), &coefficients).is_err());
        coefficients[3][1] = f64::NAN;
        assert!(Pieces::stored(&pieces.breaks(), &coefficients).is_err());
        coefficients[3].pop();
        assert!(Pieces::stored(&pieces.breaks(), &coefficients).is_err());
        assert!(Pieces::stored(&[-REACH, 0.0, 0.0, REACH], &vec![vec![0.0; 13]; 3]).is_err());
        assert!(Pieces::stored(&[], &[]).is_err());
    }
}
