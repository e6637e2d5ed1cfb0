//! The strata of a certificate: the set that a surrogate puts on its rarer side, the layer nearest to that, and the
//! rest.
//!
//! Which side is the rarer, how many samples of the surrogate are taken and how deep the layer is, a pilot decides, on
//! points of the purpose of evaluation. Everything else is counted and drawn on points of the purpose of certification,
//! from number 0: by the surrogate's word alone, so that points in a stratum are random points of it, whatever the
//! model says there. Numbers are looked at in order and in fixed groups, so that the points are the same on any number
//! of threads.

use super::direct_computations::{ReferenceError, surrogate_block};
use pcc_evaluate::evaluation::Plan;
use pcc_evaluate::foundation::{Observer, try_map};
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::probability::statistics::Proportion;
use pcc_evaluate::surrogate::{RareSide, SampledStrata, Surrogate};

/// Points evaluated together, and how many such parts before anything is decided.
const CHUNK: u64 = 4096;
const CHUNKS: u64 = 64;
const GROUP: u64 = CHUNK * CHUNKS;

/// Samples of the surrogate, at least and at most: so many that [`RARE_SAMPLES`] are on its rarer side, of which the
/// share is then known to three percent.
const LEAST_SAMPLES: u64 = 4 * GROUP;
const MOST_SAMPLES: u64 = 40 * GROUP;
const RARE_SAMPLES: f64 = 10_000.0;

/// With m runs outside and none that disagrees the bound lies 3/m above the surrogate's share, which is known to
/// 3.3 √(p (1 − p)/n) by n samples: a fifth of that with n = 30 p (1 − p) m².
const SAMPLES_PER_SQUARED_RUN: f64 = 30.0;

/// The layer has the weight of the rare set, but of at most half of the rest, and never less than this.
const LEAST_LAYER: f64 = 0.002;

/// Further points are looked at for so many times the runs that are wanted.
const PATIENCE: u64 = 4;

/// Where a point of a certificate is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// A random point outside the rare set, beyond the layer.
    Far,
    /// A random point outside the rare set that happens to be in the layer.
    Near,
    /// A random point of the layer.
    Layer,
    /// A random point inside the rare set.
    Inside,
}

/// A point at which the model is to be run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drawn {
    /// Its number among the points of certification.
    pub index: u64,
    pub origin: Origin,
    /// The excess by the surrogate, in 1/s.
    pub excess: f64,
}

/// How many points are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Wanted {
    pub outside: u64,
    pub layer: u64,
    pub inside: u64,
    /// Runs outside that the surrogate's share is to be known well enough for.
    pub resolved: u64,
}

/// Strata with points of them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Strata {
    pub rare_side: RareSide,
    pub sampled: SampledStrata,
    /// Samples that the surrogate calls stable, marginal and unstable.
    pub classes: [u64; 3],
    /// First those outside the rare set, then those of the layer, then those inside.
    pub drawn: Vec<Drawn>,
}

impl Strata {
    /// Samples `surrogate`, and draws as many points as are `wanted` of each stratum, or as there are among those that
    /// are looked at.
    pub fn new(
        surrogate: &Surrogate,
        plan: &Plan,
        seed: u64,
        wanted: Wanted,
        observer: &dyn Observer,
    ) -> Result<Self, ReferenceError> {
        let scan = Scan { surrogate, plan, seed, observer };
        observer.begin("samples", GROUP);
        let pilot = Pilot::new(&scan.excesses(Purpose::Evaluation, 0)?);
        observer.finish();
        let samples = pilot.samples(wanted.resolved);
        observer.begin("samples", samples);
        let most = MOST_SAMPLES.max(wanted.outside.saturating_mul(PATIENCE));
        let mut found = Found { pilot, wanted, samples, rare: 0, layer: 0, classes: [0; 3], drawn: Default::default() };
        let mut first = 0;
        while first < samples || first < most && !found.is_complete() {
            let excesses = scan.excesses(Purpose::Certification, first)?;
            excesses.iter().zip(first..).for_each(|(&excess, index)| found.add(index, excess));
            first += GROUP;
        }
        observer.finish();
        Ok(found.into_strata())
    }

    /// The rare set among samples of the surrogate.
    pub fn rare(&self) -> Proportion {
        Proportion { hits: self.sampled.rare, samples: self.sampled.samples }
    }

    /// The rest.
    pub fn rest(&self) -> Proportion {
        Proportion { hits: self.sampled.samples - self.sampled.rare, samples: self.sampled.samples }
    }

    /// The layer.
    pub fn layer(&self) -> Proportion {
        Proportion { hits: self.sampled.layer, samples: self.sampled.samples }
    }
}

/// What is evaluated.
struct Scan<'a> {
    surrogate: &'a Surrogate,
    plan: &'a Plan,
    seed: u64,
    observer: &'a dyn Observer,
}

impl Scan<'_> {
    /// The surrogate's excess at a group of points.
    fn excesses(&self, purpose: Purpose, first: u64) -> Result<Vec<f64>, ReferenceError> {
        let chunks = try_map(CHUNKS as usize, |chunk| {
            self.observer.check().map_err(|interrupted| ReferenceError::Run(interrupted.into()))?;
            let start = first + CHUNK * chunk as u64;
            let points = random_points(&self.surrogate.inputs, self.seed, purpose, start..start + CHUNK);
            let block = surrogate_block(self.surrogate, self.plan, &points)?;
            self.observer.advance(CHUNK);
            Ok::<_, ReferenceError>(block.excess)
        })?;
        Ok(chunks.concat())
    }
}

/// What is decided before anything is counted.
struct Pilot {
    side: RareSide,
    /// The share of the rare side.
    share: f64,
    /// Outside the rare set, the layer is where excesses towards it are this at least, in 1/s.
    threshold: f64,
}

impl Pilot {
    fn new(excesses: &[f64]) -> Self {
        let stable = excesses.iter().filter(|&&excess| RareSide::Stable.holds(excess)).count();
        let (side, rare) = match stable <= excesses.len() / 2 {
            true => (RareSide::Stable, stable),
            false => (RareSide::NotStable, excesses.len() - stable),
        };
        let all = excesses.len() as f64;
        let share = rare as f64 / all;
        let mut outside: Vec<f64> =
            excesses.iter().filter(|&&excess| !side.holds(excess)).map(|&excess| side.towards(excess)).collect();
        let weight = share.min(0.5 * (1.0 - share)).max(LEAST_LAYER);
        let last = ((weight * all).ceil() as usize).clamp(1, outside.len().max(1)) - 1;
        let threshold = match outside.is_empty() {
            true => 0.0,
            false => *outside.select_nth_unstable_by(last, |a, b| b.total_cmp(a)).1,
        };
        Self { side, share, threshold }
    }

    /// So many samples that enough are rare and the share is known well enough, in whole groups.
    fn samples(&self, runs: u64) -> u64 {
        if self.share == 0.0 {
            return LEAST_SAMPLES;
        }
        let of_share = SAMPLES_PER_SQUARED_RUN * self.share * (1.0 - self.share) * (runs as f64).powi(2);
        let wanted = (RARE_SAMPLES / self.share).max(of_share).min(MOST_SAMPLES as f64) as u64;
        wanted.clamp(LEAST_SAMPLES, MOST_SAMPLES).next_multiple_of(GROUP)
    }
}

/// Samples and points found so far.
struct Found {
    pilot: Pilot,
    wanted: Wanted,
    samples: u64,
    rare: u64,
    layer: u64,
    classes: [u64; 3],
    drawn: [Vec<Drawn>; 3],
}

impl Found {
    fn is_complete(&self) -> bool {
        let Wanted { outside, layer, inside, .. } = self.wanted;
        // A set that the pilot does not hit is not looked for.
        let inside = if self.pilot.share > 0.0 { inside } else { 0 };
        self.drawn.iter().zip([outside, layer, inside]).all(|(drawn, wanted)| drawn.len() as u64 >= wanted)
    }

    fn add(&mut self, index: u64, excess: f64) {
        let is_rare = self.pilot.side.holds(excess);
        let is_near = !is_rare && self.pilot.side.towards(excess) >= self.pilot.threshold;
        if index < self.samples {
            self.rare += u64::from(is_rare);
            self.layer += u64::from(is_near);
            self.classes[if excess < 0.0 { 0 } else { 1 + usize::from(excess > 0.0) }] += 1;
        }
        let Wanted { outside, layer, inside, .. } = self.wanted;
        let has_room = |list: &Vec<Drawn>, wanted: u64| (list.len() as u64) < wanted;
        // A point of the layer serves once: random points outside come first.
        let (list, origin) = match (is_rare, is_near) {
            (true, _) if has_room(&self.drawn[2], inside) => (2, Origin::Inside),
            (true, _) => return,
            (false, true) if has_room(&self.drawn[0], outside) => (0, Origin::Near),
            (false, true) if has_room(&self.drawn[1], layer) => (1, Origin::Layer),
            (false, false) if has_room(&self.drawn[0], outside) => (0, Origin::Far),
            (false, _) => return,
        };
        self.drawn[list].push(Drawn { index, origin, excess });
    }

    fn into_strata(self) -> Strata {
        let Self { pilot, samples, rare, layer, classes, drawn, .. } = self;
        // Zero has no sign.
        let layer_depth = (-pilot.threshold).max(0.0) + 0.0;
        Strata {
            rare_side: pilot.side,
            sampled: SampledStrata { samples, rare, layer, layer_depth },
            classes,
            drawn: drawn.concat(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::artifact::decode;
    use pcc_evaluate::foundation::Silent;

    const WANTED: Wanted = Wanted { outside: 300, layer: 100, inside: 50, resolved: 300 };

    fn strata(seed: u64) -> (Surrogate, Strata) {
        let surrogate = decode(include_bytes!("../../../../surrogates/clutch-r3.pcc")).unwrap().surrogate;
        let found = Strata::new(&surrogate, &Plan::new(&surrogate), seed, WANTED, &Silent).unwrap();
        (surrogate, found)
    }

    #[test]
    fn points_lie_in_their_strata_and_serve_once() {
        let (surrogate, found) = strata(3);
        assert_eq!(found.rare_side, RareSide::Stable);
        assert!((found.rare().value() - 0.1976).abs() < 0.002, "{}", found.rare().value());
        assert!((found.layer().value() - found.rare().value()).abs() < 0.005, "the layer weighs as much");
        let origins = |origin| found.drawn.iter().filter(|drawn| drawn.origin == origin).count() as u64;
        assert_eq!(origins(Origin::Far) + origins(Origin::Near), WANTED.outside);
        assert_eq!((origins(Origin::Layer), origins(Origin::Inside)), (WANTED.layer, WANTED.inside));
        // 0.2 of 0.8 outside are in the layer.
        assert!((50..100).contains(&origins(Origin::Near)), "{}", origins(Origin::Near));
        for drawn in &found.drawn {
            let point = random_points(&surrogate.inputs, 3, Purpose::Certification, drawn.index..drawn.index + 1);
            let block = surrogate_block(&surrogate, &Plan::new(&surrogate), &point).unwrap();
            assert_eq!(block.excess[0], drawn.excess);
            let depth = found.sampled.layer_depth;
            let fits = match drawn.origin {
                Origin::Inside => drawn.excess < 0.0,
                Origin::Far => drawn.excess > depth,
                Origin::Near | Origin::Layer => (0.0..=depth).contains(&drawn.excess),
            };
            assert!(fits, "{drawn:?}, {depth}");
        }
        let mut indices: Vec<u64> = found.drawn.iter().map(|drawn| drawn.index).collect();
        indices.sort_unstable();
        indices.dedup();
        assert_eq!(indices.len() as u64, WANTED.outside + WANTED.layer + WANTED.inside);
    }
}
