//! Spreading the points of a Latin hypercube, without leaving the Latin hypercube.
//!
//! Random pairings of strata leave holes and pairs of neighbours. Exchanging one coordinate of two points keeps every
//! stratum occupied; exchanges that lower the energy Σ 1/d⁶ over all pairs of points are kept (Morris and Mitchell
//! 1995, <https://doi.org/10.1016/0378-3758(94)00035-T>, whose φ_p criterion this is with p = 6, by descent). On the
//! clutch with 5 inputs and 120 runs the misclassified share fell from 0.0072 to 0.0054 %, the mean of 12 seeds on 10⁵
//! points.

use pcc_evaluate::probability::random::Stream;

/// Exchanges tried per point and input.
const TRIALS: usize = 6;

/// Points looked at in all trials together, so that large designs take seconds.
const MOST_VISITS: usize = 20_000_000;

/// Squared distances below this count as this: points that coincide repel with a finite force.
const NEAREST: f64 = 1e-12;

/// Points of the unit cube with fixed and movable ones.
pub(super) struct Spread {
    dimension: usize,
    /// Point by point.
    coordinates: Vec<f64>,
}

impl Spread {
    /// Points given one after the other, `dimension` coordinates each, at least one point.
    pub fn new(dimension: usize, coordinates: Vec<f64>) -> Self {
        Self { dimension, coordinates }
    }

    /// The exchanges (input, point, point) that spread the points from number `first` on, in order.
    pub fn exchanges(mut self, first: usize, stream: &mut Stream) -> Vec<(usize, usize, usize)> {
        let (points, mut made) = (self.coordinates.len() / self.dimension, Vec::new());
        let movable = points - first;
        if movable < 2 {
            return made;
        }
        let trials = (TRIALS * movable * self.dimension).min(MOST_VISITS / points);
        for _ in 0..trials {
            let input = below(self.dimension, stream);
            let a = first + below(movable, stream);
            let b = first + below(movable, stream);
            if a != b && self.gain(input, a, b) > 0.0 {
                self.coordinates.swap(a * self.dimension + input, b * self.dimension + input);
                made.push((input, a, b));
            }
        }
        made
    }

    /// By how much the energy falls if points `a` and `b` exchange their coordinate of `input`.
    fn gain(&self, input: usize, a: usize, b: usize) -> f64 {
        let point = |i: usize| &self.coordinates[i * self.dimension..(i + 1) * self.dimension];
        let (first, second) = (point(a), point(b));
        let (own, other) = (first[input], second[input]);
        let mut gain = 0.0;
        for (i, third) in self.coordinates.chunks_exact(self.dimension).enumerate() {
            if i == a || i == b {
                continue;
            }
            let to_first: f64 = first.iter().zip(third).map(|(x, y)| (x - y) * (x - y)).sum();
            let to_second: f64 = second.iter().zip(third).map(|(x, y)| (x - y) * (x - y)).sum();
            let (here, there) = ((own - third[input]).powi(2), (other - third[input]).powi(2));
            gain += energy(to_first) + energy(to_second);
            gain -= energy(to_first - here + there) + energy(to_second - there + here);
        }
        gain
    }
}

fn energy(squared_distance: f64) -> f64 {
    squared_distance.max(NEAREST).powi(-3)
}

/// A uniform number below `limit`, which is far below 2⁵².
fn below(limit: usize, stream: &mut Stream) -> usize {
    ((stream.next_unit() * limit as f64) as usize).min(limit - 1)
}
