//! Points for runs near the stability boundary.
//!
//! The *zone* are the points of smallest |excess| among those at which shares are judged, with twice the probability of
//! the rarer side, and at least twenty candidates per wanted run, also on the rarer side if there are so many: |excess|
//! of marginal points is no distance. Of these the one farthest from all runs and all that are chosen already is taken,
//! again and again: the boundary is covered where no run is. The distance is that of standardized coordinates. A level
//! that has not seen enough of the rarer side takes every second point there: left to themselves, the farthest points
//! of the zone lie around it. So does one that has not seen enough of a share that the study names.

use super::judged_points::{POINTS, judged_point};
use super::trials::is_not_unstable;
use crate::fitting::design::Samples;
use pcc_evaluate::surrogate::Surrogate;

/// Candidates per wanted run.
const CANDIDATES: usize = 20;

/// The standardized points of so many runs; `excess` is the surrogate's at the judged points, which may be `rarer`,
/// `tried` are the points of all runs. Every second one is rarer, if the level `is_blind` and there are any.
pub(super) fn near_boundary(
    surrogate: &Surrogate,
    (excess, rarer): (&[f64], &[bool]),
    tried: &Samples,
    (wanted, is_blind): (usize, bool),
) -> Vec<Vec<f64>> {
    let zone = zone(excess, rarer, wanted);
    let is_rare = |k: &usize| rarer[zone[*k]];
    let candidates: Vec<Vec<f64>> =
        zone.iter().map(|&i| judged_point((&surrogate.inputs, surrogate.training.seed), i)).collect();
    let mut distances: Vec<f64> = candidates
        .iter()
        .map(|point| tried.points().map(|other| square_distance(point, other)).fold(f64::INFINITY, f64::min))
        .collect();
    let mut chosen = Vec::with_capacity(wanted);
    for turn in 0..wanted {
        let farther = |best: usize, at: usize| if distances[at] > distances[best] { at } else { best };
        let of_all = || (0..candidates.len()).reduce(farther);
        let of_rare = || (0..candidates.len()).filter(is_rare).reduce(farther);
        let is_new = |at: &usize| distances[*at] > 0.0;
        let rare = if is_blind && turn % 2 == 0 { of_rare().filter(is_new) } else { None };
        let Some(farthest) = rare.or_else(of_all).filter(is_new) else { break };
        let point = candidates[farthest].clone();
        for (distance, candidate) in distances.iter_mut().zip(&candidates) {
            *distance = distance.min(square_distance(candidate, &point));
        }
        chosen.push(point);
    }
    chosen
}

/// The probability of the zone of one batch, about, where so many of the judged points are on the rarer side: runs
/// there are so much more likely to lie within an error of the boundary than random ones.
pub(super) fn zone_share(surrogate: &Surrogate, rare: usize) -> f64 {
    (2 * rare).max(CANDIDATES * surrogate.inputs.dimension()).min(POINTS) as f64 / POINTS as f64
}

/// Numbers of the points of the zone.
fn zone(excess: &[f64], rarer: &[bool], wanted: usize) -> Vec<usize> {
    let candidates = CANDIDATES * wanted;
    let not_unstable = excess.iter().filter(|&&excess| is_not_unstable(excess)).count();
    let rare = not_unstable.min(excess.len() - not_unstable);
    let mut nearest: Vec<usize> = (0..excess.len()).collect();
    nearest.sort_by(|&a, &b| excess[a].abs().total_cmp(&excess[b].abs()).then(a.cmp(&b)));
    let rest = nearest.split_off((2 * rare).max(candidates).min(nearest.len()));
    // Marginal points are as near as can be, however many there are.
    let missing = candidates.saturating_sub(nearest.iter().filter(|&&i| rarer[i]).count());
    nearest.extend(rest.into_iter().filter(|&i| rarer[i]).take(missing));
    nearest
}

fn square_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compilation::judged_points::at_judged_points;
    use pcc_evaluate::artifact::decode;
    use pcc_evaluate::foundation::Silent;

    /// The rarer side of the clutch.
    fn stable(excess: &[f64]) -> Vec<bool> {
        excess.iter().map(|&excess| is_not_unstable(excess)).collect()
    }

    #[test]
    fn the_zone_has_twice_the_probability_of_the_rarer_side() {
        // e = x − 0.97 on an even grid: 3 % are unstable.
        let excess: Vec<f64> = (0..10_000).map(|i| (f64::from(i) + 0.5) / 10_000.0 - 0.97).collect();
        let unstable = |excess: &[f64]| excess.iter().map(|&excess| excess > 0.0).collect::<Vec<_>>();
        let zone = zone(&excess, &unstable(&excess), 3);
        assert_eq!(zone.len(), 600);
        assert!(zone.iter().all(|&i| (9_400..10_000).contains(&i)), "on both sides of the boundary");
        let stable: Vec<f64> = excess.iter().map(|excess| excess - 1.0).collect();
        let undamped: Vec<f64> = excess.iter().map(|excess| excess.max(0.0)).collect();
        let zone = super::zone(&undamped, &unstable(&undamped), 3);
        assert_eq!(zone.iter().filter(|&&i| i >= 9_700).count(), 60, "beside marginal points, unstable ones");
        let mut nearest = super::zone(&stable, &unstable(&stable), 3);
        nearest.sort_unstable();
        assert_eq!(nearest, (9_940..10_000).collect::<Vec<_>>(), "without a boundary, those nearest to one");
    }

    #[test]
    fn points_near_the_boundary_are_spread_along_it() {
        let surrogate = decode(include_bytes!("../../../../surrogates/clutch-r2.pcc")).unwrap().surrogate;
        let block = at_judged_points(&surrogate, POINTS, &Silent).unwrap();
        let tried = Samples::new(2, vec![0.0, 0.0]);
        let chosen = near_boundary(&surrogate, (&block.excess, &stable(&block.excess)), &tried, (6, false));
        assert_eq!(chosen.len(), 6);
        let mut nearest: Vec<f64> = block.excess.iter().map(|excess| excess.abs()).collect();
        nearest.sort_by(f64::total_cmp);
        let rare = block.excess.iter().filter(|&&excess| excess <= 0.0).count();
        for (i, point) in chosen.iter().enumerate() {
            let excess = surrogate.top(&surrogate.evaluate(point)).excess;
            assert!(excess.abs() <= nearest[2 * rare], "{excess} at {point:?}");
            assert!(chosen[..i].iter().all(|other| square_distance(point, other) > 0.04), "{chosen:?}");
        }
    }

    #[test]
    fn a_blind_level_takes_every_second_point_on_the_rarer_side() {
        let surrogate = decode(include_bytes!("../../../../surrogates/clutch-r2.pcc")).unwrap().surrogate;
        let block = at_judged_points(&surrogate, POINTS, &Silent).unwrap();
        let tried = Samples::new(2, vec![0.0, 0.0]);
        let chosen = near_boundary(&surrogate, (&block.excess, &stable(&block.excess)), &tried, (6, true));
        let is_stable = |point: &Vec<f64>| surrogate.top(&surrogate.evaluate(point)).excess <= 0.0;
        assert!(chosen.iter().step_by(2).all(is_stable) && chosen.len() == 6, "a fifth is stable: {chosen:?}");
        // Where all points of that side were tried, those around it are left.
        let mut rarer = vec![false; POINTS];
        let first = block.excess.iter().position(|&excess| excess <= 0.0).unwrap();
        rarer[first] = true;
        let tried = Samples::new(2, judged_point((&surrogate.inputs, surrogate.training.seed), first));
        assert_eq!(near_boundary(&surrogate, (&block.excess, &rarer), &tried, (6, true)).len(), 6);
    }
}
