//! Random points of the input space, addressed by their number.

use super::space::InputSpace;
use crate::probability::random::{Purpose, Stream};
use std::ops::Range;

/// The standardized coordinates of random point number `index`, written to `point`: the same for every thread, shard
/// and command with this seed.
#[inline]
pub fn random_point(space: &InputSpace, seed: u64, purpose: Purpose, index: u64, point: &mut [f64]) {
    let mut stream = Stream::new(seed, purpose, index);
    point.iter_mut().for_each(|coordinate| *coordinate = stream.next_unit());
    space.place(point);
}

/// The standardized coordinates of the random points with these numbers, one list per point: [`random_point`] for each.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::inputs::{random_points, Input, InputSpace, Marginal, Uniform};
/// use pcc_evaluate::probability::random::Purpose;
/// let marginal = Marginal::Uniform(Uniform::new(0.0, 0.5)?);
/// let space = InputSpace::new(vec![Input::new("mu", marginal)])?;
/// let points = random_points(&space, 1, Purpose::Evaluation, 0..100);
/// assert_eq!(points[40..], random_points(&space, 1, Purpose::Evaluation, 40..100));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn random_points(space: &InputSpace, seed: u64, purpose: Purpose, indices: Range<u64>) -> Vec<Vec<f64>> {
    let point = |index| {
        let mut point = vec![0.0; space.dimension()];
        random_point(space, seed, purpose, index, &mut point);
        point
    };
    indices.map(point).collect()
}
