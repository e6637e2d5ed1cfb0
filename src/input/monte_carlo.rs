//! Random points of the input space, addressed by their number.

use super::space::InputSpace;
use crate::random::{Purpose, Stream};

/// The standardized coordinates of random point number `index`, written to `point`: the same for every thread, shard
/// and command with this seed.
#[inline]
pub fn random_point(space: &InputSpace, seed: u64, purpose: Purpose, index: u64, point: &mut [f64]) {
    let mut stream = Stream::new(seed, purpose, index);
    for (coordinate, input) in point.iter_mut().zip(space.inputs()) {
        *coordinate = input.marginal.standardized_quantile(stream.next_unit());
    }
}
