//! The points at which shares are judged: random ones, the same for all surrogates of a dimension and seed.

use pcc_evaluate::components::Block;
use pcc_evaluate::evaluation::{Plan, evaluate_points};
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::probability::inputs::{InputSpace, random_point};
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::surrogate::Surrogate;

/// Points at which every level is judged.
pub(super) const POINTS: usize = 50_000;

/// Points on the rarer side that tell its share to 3 %.
const ENOUGH_RARE: usize = 1_000;

/// Points at most: of a million, numbers that fill 160 megabytes, and operations of a few seconds.
const MOST_POINTS: usize = 1_000_000;
const MOST_NUMBERS: usize = 20_000_000;
const MOST_OPERATIONS: usize = 20_000_000_000;

/// Numbers of a design's stream that no level has.
const FIRST_INDEX: u64 = 1 << 40;

/// A surrogate at the first `points` of them.
pub(super) fn at_judged_points(
    surrogate: &Surrogate,
    points: usize,
    observer: &dyn Observer,
) -> Result<Block, Interrupted> {
    let plan = Plan::new(surrogate);
    const PART: usize = 4096;
    let parts = try_map(points.div_ceil(PART), |part| {
        observer.check()?;
        let range = part * PART..points.min((part + 1) * PART);
        let points: Vec<Vec<f64>> =
            range.map(|i| judged_point((&surrogate.inputs, surrogate.training.seed), i)).collect();
        Ok(evaluate_points(surrogate, &plan, &points.iter().map(Vec::as_slice).collect::<Vec<_>>()))
    })?;
    let mut block = Block::with_capacity(surrogate.component_count(), surrogate.labels().len(), points);
    for part in parts {
        block.append(part);
    }
    Ok(block)
}

/// The standardized point number `i` of those of inputs and a seed.
pub(super) fn judged_point((inputs, seed): (&InputSpace, u64), i: usize) -> Vec<f64> {
    let mut point = vec![0.0; inputs.dimension()];
    random_point(inputs, seed, Purpose::Design, FIRST_INDEX + i as u64, &mut point);
    point
}

/// How many points tell a share of which so many of [`POINTS`] are on the rarer side.
pub(super) fn points_for(surrogate: &Surrogate, rare: usize) -> usize {
    if rare >= ENOUGH_RARE {
        return POINTS;
    }
    let numbers = surrogate.component_count() + 2 * surrogate.labels().len() + 3;
    let operations = Plan::new(surrogate).flops().max(1);
    let most = MOST_POINTS.min(MOST_NUMBERS / numbers).min(MOST_OPERATIONS / operations);
    (POINTS * ENOUGH_RARE.div_ceil(rare.max(1))).min(most).max(POINTS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::artifact::decode;

    #[test]
    fn rarer_shares_take_more_points() {
        let file = include_bytes!("../../../../surrogates/clutch-r2.pcc");
        let surrogate = decode(file).unwrap().surrogate;
        let points = [25_000, 1_000, 999, 100, 1, 0].map(|rare| points_for(&surrogate, rare));
        assert_eq!(points, [POINTS, POINTS, 2 * POINTS, 10 * POINTS, MOST_POINTS, MOST_POINTS]);
    }
}
