//! Nested Latin hypercube designs, after Wang (2003), <https://doi.org/10.1115/1.1561044>, and Blatman and Sudret
//! (2010).
//!
//! A Latin hypercube of N points has one point in each of N equal strata of every input. A design grows from N to N′
//! points by dividing every input into N′ strata, of which the old points occupy at most N; each new point falls into
//! an empty one, in every input. If the design was a Latin hypercube and N divides N′, no two old points share a finer
//! stratum and the result is a Latin hypercube again. No point is ever dropped, so no model run is lost.
//!
//! The strata of new points are paired at random; a design may then spread its new points by exchanging coordinates.

use super::samples::Samples;
use super::spread::Spread;
use pcc_evaluate::probability::random::{Purpose, Stream, UNIT_BITS, unit_interval};
use rand::seq::SliceRandom;

/// A design that grows level by level.
///
/// Coordinates are kept as cells of the unit interval, integers below 2⁵², so the stratum of a point is exact.
///
/// # Examples
///
/// ```
/// use pcc_compile::fitting::design::NestedLatinHypercube;
/// let mut design = NestedLatinHypercube::new(3, 1);
/// design.grow_to(10);
/// let ten = design.cells().to_vec();
/// design.grow_to(25);
/// assert_eq!(design.len(), 25);
/// assert_eq!(design.cells()[..30], ten);
/// ```
#[derive(Debug, Clone)]
pub struct NestedLatinHypercube {
    dimension: usize,
    seed: u64,
    /// Point by point, `dimension` cells each.
    cells: Vec<u64>,
    spreads: bool,
}

impl NestedLatinHypercube {
    /// A design without points for `dimension` inputs, at least one.
    ///
    /// # Panics
    ///
    /// If `dimension` is zero.
    pub fn new(dimension: usize, seed: u64) -> Self {
        assert!(dimension > 0, "a design needs at least one input");
        Self { dimension, seed, cells: Vec::new(), spreads: false }
    }

    /// The same, with the points of every level spread apart from each other and from those before them.
    ///
    /// # Panics
    ///
    /// If `dimension` is zero.
    pub fn spread_out(dimension: usize, seed: u64) -> Self {
        Self { spreads: true, ..Self::new(dimension, seed) }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.cells.len() / self.dimension
    }

    /// Whether there are no points yet.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The cells of all points, point by point.
    pub fn cells(&self) -> &[u64] {
        &self.cells
    }

    /// Adds points until there are `size`; does nothing if there are already as many.
    ///
    /// The new points depend on the seed, on the old points and on `size`, nothing else.
    pub fn grow_to(&mut self, size: usize) {
        let old = self.len();
        if size <= old {
            return;
        }
        let mut stream = Stream::new(self.seed, Purpose::Design, size as u64);
        self.cells.resize(size * self.dimension, 0);
        for j in 0..self.dimension {
            let mut strata = self.empty_strata(j, old, size);
            // More strata are empty than points are missing where old points share a stratum.
            strata.shuffle(&mut stream);
            for (i, stratum) in (old..size).zip(strata) {
                self.cells[i * self.dimension + j] = cell_in_stratum(stratum, size as u64, &mut stream);
            }
        }
        if self.spreads {
            let coordinates = self.cells.iter().map(|&cell| unit_interval(cell)).collect();
            for (j, a, b) in Spread::new(self.dimension, coordinates).exchanges(old, &mut stream) {
                self.cells.swap(a * self.dimension + j, b * self.dimension + j);
            }
        }
    }

    /// The strata of input `j` on the grid of `size` that none of the first `old` points occupies.
    fn empty_strata(&self, j: usize, old: usize, size: usize) -> Vec<u64> {
        let mut occupied = vec![false; size];
        for i in 0..old {
            occupied[stratum(self.cells[i * self.dimension + j], size as u64) as usize] = true;
        }
        (0..size as u64).filter(|&stratum| !occupied[stratum as usize]).collect()
    }

    /// The points in standardized coordinates: `place` replaces the unit numbers of a point by them.
    pub fn placed(&self, place: impl Fn(&mut [f64])) -> Samples {
        let mut coordinates: Vec<f64> = self.cells.iter().map(|&cell| unit_interval(cell)).collect();
        coordinates.chunks_exact_mut(self.dimension).for_each(place);
        Samples::new(self.dimension, coordinates)
    }

    /// The points in standardized coordinates of independent inputs, `standardized_quantile(j, u)` mapping a unit
    /// number of input j.
    pub fn samples(&self, standardized_quantile: impl Fn(usize, f64) -> f64) -> Samples {
        let coordinates = self
            .cells
            .iter()
            .enumerate()
            .map(|(at, &cell)| standardized_quantile(at % self.dimension, unit_interval(cell)))
            .collect();
        Samples::new(self.dimension, coordinates)
    }
}

/// The stratum ⌊u n⌋ of the midpoint u = (2 cell + 1)/2⁵³, in exact integer arithmetic.
fn stratum(cell: u64, strata: u64) -> u64 {
    (((2 * u128::from(cell) + 1) * u128::from(strata)) >> (UNIT_BITS + 1)) as u64
}

/// The first cell whose midpoint lies in `stratum` or beyond.
fn first_cell(stratum: u64, strata: u64) -> u64 {
    let numerator = u128::from(stratum) << (UNIT_BITS + 1);
    let odd = numerator.div_ceil(u128::from(strata));
    (odd / 2) as u64
}

/// A uniformly random cell of a stratum.
fn cell_in_stratum(stratum: u64, strata: u64, stream: &mut Stream) -> u64 {
    let first = first_cell(stratum, strata);
    let width = first_cell(stratum + 1, strata) - first;
    first + ((u128::from(stream.next_cell()) * u128::from(width)) >> UNIT_BITS) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn design(dimension: usize, seed: u64, sizes: &[usize]) -> NestedLatinHypercube {
        let mut design = NestedLatinHypercube::new(dimension, seed);
        sizes.iter().for_each(|&size| design.grow_to(size));
        design
    }

    /// How many points each stratum of input `j` holds, by floating-point arithmetic on the finished samples.
    fn occupation(samples: &Samples, j: usize, points: std::ops::Range<usize>, strata: usize) -> Vec<usize> {
        let mut count = vec![0; strata];
        for i in points {
            count[(samples.point(i)[j] * strata as f64) as usize] += 1;
        }
        count
    }

    proptest! {
        #[test]
        fn first_level_and_integer_multiples_hit_every_stratum_once(
            dimension in 1..6usize, size in 1..60usize, factors in prop::collection::vec(2..4usize, 0..3), seed: u64,
        ) {
            let mut sizes = vec![size];
            for factor in factors {
                sizes.push(sizes[sizes.len() - 1] * factor);
            }
            let samples = design(dimension, seed, &sizes).samples(|_, u| u);
            for &level in &sizes {
                for j in 0..dimension {
                    prop_assert!(occupation(&samples, j, 0..level, level).iter().all(|&count| count == 1));
                }
            }
        }

        #[test]
        fn spreading_keeps_every_stratum_occupied_and_old_points_in_place(
            dimension in 1..5usize, seed: u64, size in 2..20usize, factor in 2..4usize,
        ) {
            let mut spread = NestedLatinHypercube::spread_out(dimension, seed);
            spread.grow_to(size);
            let before = spread.cells().to_vec();
            spread.grow_to(factor * size);
            prop_assert_eq!(&spread.cells()[..before.len()], &before[..]);
            let samples = spread.samples(|_, unit| unit);
            for j in 0..dimension {
                prop_assert_eq!(occupation(&samples, j, 0..factor * size, factor * size), vec![1; factor * size]);
            }
        }

        #[test]
        fn other_sizes_put_new_points_into_empty_strata(
            dimension in 1..5usize, size in 2..50usize, steps in prop::collection::vec(1..40usize, 1..4), seed: u64,
        ) {
            let mut design = design(dimension, seed, &[size]);
            for step in steps {
                let (old, before) = (design.len(), design.cells().to_vec());
                design.grow_to(old + step);
                prop_assert_eq!(&design.cells()[..before.len()], &before[..]);
                let samples = design.samples(|_, u| u);
                for j in 0..dimension {
                    let old_points = occupation(&samples, j, 0..old, old + step);
                    let new_points = occupation(&samples, j, old..old + step, old + step);
                    for (old_count, new_count) in old_points.into_iter().zip(new_points) {
                        prop_assert!(new_count <= usize::from(old_count == 0));
                    }
                }
            }
        }

        #[test]
        fn cells_of_a_stratum_lie_in_it(stratum_share in 0.0..1.0f64, strata in 1..1_000_000u64) {
            let chosen = (stratum_share * strata as f64) as u64;
            let (first, end) = (first_cell(chosen, strata), first_cell(chosen + 1, strata));
            prop_assert_eq!(stratum(first, strata), chosen);
            prop_assert_eq!(stratum(end - 1, strata), chosen);
            prop_assert!(first == 0 || stratum(first - 1, strata) == chosen - 1);
        }
    }

    /// Pins the design itself: generator, shuffle and strata.
    /// The smallest distance between two points of the unit cube.
    fn closest(design: &NestedLatinHypercube) -> f64 {
        let samples = design.samples(|_, unit| unit);
        let mut closest = f64::INFINITY;
        for i in 0..samples.len() {
            for k in 0..i {
                let square = samples.point(i).iter().zip(samples.point(k)).map(|(x, y)| (x - y) * (x - y)).sum::<f64>();
                closest = closest.min(square.sqrt());
            }
        }
        closest
    }

    #[test]
    fn spreading_moves_the_closest_points_apart() {
        for seed in 0..10 {
            let (mut random, mut spread) =
                (NestedLatinHypercube::new(4, seed), NestedLatinHypercube::spread_out(4, seed));
            for size in [30, 60] {
                random.grow_to(size);
                spread.grow_to(size);
                assert!(closest(&spread) > 1.3 * closest(&random), "seed {seed}, {size} points");
            }
        }
    }

    #[test]
    fn known_design() {
        let design = design(2, 1, &[2, 3]);
        insta::assert_snapshot!(format!("{:#x?}", design.cells()).replace('\n', " "));
    }
}
