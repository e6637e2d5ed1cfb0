//! What is known of a level's decision, and whether that is enough.

use super::blindness::Sight;
use super::decision::Previous;
use super::named_shares::NamedShare;
use super::trials::Class;
use pcc_evaluate::surrogate::Decision;

/// A share that was judged: of points that are not unstable, or one that the study names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct JudgedShare {
    /// The share p.
    pub value: f64,
    /// Number of points T.
    pub points: usize,
}

impl JudgedShare {
    /// √(p (1 − p)), which errors are compared with: of the rarer side, whichever it is, they are √p of it or less. A
    /// share that is not seen is below 1/T.
    pub fn deviation(&self) -> f64 {
        let p = self.value;
        (p * (1.0 - p)).max((self.points as f64).recip()).sqrt()
    }

    /// What the file gives errors relative to: the share that is not unstable, or all points where it is zero.
    pub fn reference(&self) -> f64 {
        if self.value > 0.0 { self.value } else { 1.0 }
    }
}

/// What is known of a surrogate's decision.
#[derive(Default)]
pub(super) struct Judgement {
    /// What is stored.
    pub decision: Decision,
    /// Number of runs whose stability the carried modes do not decide as the model does.
    pub unlisted: u64,
    /// The share that is not unstable, if points were judged.
    pub share: Option<JudgedShare>,
    /// Its estimated error, in points of probability.
    pub error: Option<f64>,
    /// The same without the parts that more runs do not lower, or are not worth.
    pub reducible_error: Option<f64>,
    /// Whether more runs are undecided than so small an error explains.
    pub is_doubtful: bool,
    /// What the runs have seen, if they were left out one by one.
    pub sight: Option<Sight>,
    /// The shares that the study names.
    pub named: Vec<NamedShare>,
    /// The excess at the judged points, if the study asks for an error.
    pub excess: Vec<f64>,
    /// Which of them are what too few runs are: on the rarer side of the boundary, or of a share that the study names.
    pub rarer: Vec<bool>,
    /// For the next level.
    pub previous: Option<Previous>,
}

impl Judgement {
    /// The same with a share of runs that the fits without them misjudge, as an error.
    pub fn with_misjudged(self, misjudged: f64) -> Self {
        let [error, reducible_error] = [self.error, self.reducible_error].map(|error| Some(error?.hypot(misjudged)));
        Self { error, reducible_error, ..self }
    }

    /// Whether the share is known to this tolerance: error ≤ tol √(p (1 − p)). Of a blind level it is not.
    pub fn is_within(&self, tolerance: f64) -> bool {
        !self.is_blind()
            && self.would_be_within(Some(tolerance))
            && self.named.iter().all(|named| named.is_within(tolerance))
    }

    /// Whether it may be known to this tolerance by more points: what is missing is less than one of these.
    pub fn may_be_within(&self, tolerance: f64) -> bool {
        let may_be_small = |share: JudgedShare, error: Option<f64>| {
            let small = (tolerance * share.deviation()).hypot((share.points as f64).recip());
            error.is_some_and(|error| error <= small)
        };
        !self.is_blind()
            && !self.is_doubtful
            && self.share.is_some_and(|share| may_be_small(share, self.reducible_error))
            && self.named.iter().all(|own| own.is_within(tolerance) || may_be_small(own.share, own.reducible_error))
    }

    /// The same of any level.
    pub fn would_be_within(&self, tolerance: Option<f64>) -> bool {
        let Some((share, tolerance)) = self.share.zip(tolerance) else { return false };
        let small = tolerance * share.deviation();
        !self.is_doubtful && self.reducible_error.is_some_and(|error| error <= small)
    }

    /// The error that keeps falling while a build is of use: the largest beside what its share allows, in the unit of
    /// the first share.
    pub fn largest_error(&self) -> Option<f64> {
        let own = self.reducible_error.or(self.error)?;
        let deviation = self.share?.deviation();
        let others = self.named.iter().filter_map(|named| named.relative_error());
        Some(others.map(|relative| relative * deviation).fold(own, f64::max))
    }

    /// The points that too few runs are of, or too few are not.
    pub fn missed(&self) -> Class {
        let named = self.named.iter().find(|named| named.is_blind()).filter(|_| !self.is_blind());
        named.map_or(Class::NotUnstable, |named| Class::Of(named.verdict))
    }

    /// Whether too few runs are of a share that the study names, or too few are not.
    pub fn is_blind_to_named(&self) -> bool {
        self.named.iter().any(NamedShare::is_blind)
    }

    /// Whether too few runs lie on the rarer side for an estimate.
    pub fn is_blind(&self) -> bool {
        self.sight.is_some_and(|sight| sight.is_blind())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compilation::judged_points::POINTS;

    /// A share with this estimated error.
    fn judged(not_unstable: f64, error: f64) -> Judgement {
        let share = JudgedShare { value: not_unstable, points: POINTS };
        Judgement { share: Some(share), reducible_error: Some(error), ..Judgement::default() }
    }

    #[test]
    fn a_tolerance_asks_as_much_of_a_share_as_of_its_complement() {
        for rare in [0.5_f64, 0.2, 1e-3, 1e-4] {
            let small = 1e-4 * (rare * (1.0 - rare)).sqrt();
            for share in [rare, 1.0 - rare] {
                assert!(judged(share, 0.999 * small).is_within(1e-4) && !judged(share, 1.001 * small).is_within(1e-4));
            }
        }
    }

    #[test]
    fn what_is_missing_by_less_than_a_point_may_be_within_by_more_points() {
        let point = (POINTS as f64).recip();
        let missing = |points: f64| judged(1e-4, points * point);
        assert!(missing(0.9).may_be_within(1e-5) && !missing(0.9).is_within(1e-5));
        assert!(!missing(1.1).may_be_within(1e-5));
        assert!(!Judgement { is_doubtful: true, ..missing(0.9) }.may_be_within(1e-5));
    }

    #[test]
    fn what_is_doubtful_or_blind_is_not_known() {
        let doubtful = Judgement { is_doubtful: true, ..judged(0.5, 0.0) };
        assert!(judged(0.5, 0.0).is_within(1e-5) && !doubtful.is_within(1.0) && !Judgement::default().is_within(1.0));
        let sight = Sight { unstable: 2, runs: 20, is_marginal: false, clearance: None, points: 0 };
        let blind = Judgement { sight: Some(sight), ..judged(0.5, 0.0) };
        assert!(!blind.is_within(1.0) && blind.would_be_within(Some(1e-5)));
    }
}
