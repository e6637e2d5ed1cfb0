//! Levels whose eigenvalues are followed, grouped by prediction, and numbered in the middle of the inputs.

use super::BuildError;
use super::components::{ComponentFit, ComponentResult};
use super::evaluations::{Evaluations, Level};
use super::group_fits::{Followed, GroupFit, GroupFits};
use super::grouping::{Grouping, choose};
use super::infinite::infinite_near;
use super::numbering::numbers;
use super::unseen::with_unseen_groups;
use crate::campaign::RunError;
use crate::mechanics::spectrum::{
    ClusterError, Group, Modes, Numbers, Spectrum, SpectrumError, clusters, output, with_ids,
};
use crate::study::Study;
use nalgebra::Complex;
use pcc_evaluate::components::Output;
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::surrogate::{Band, VerdictBasis};
use std::f64::consts::TAU;

/// Fits groups of eigenvalues, whatever their number of oscillating modes.
pub(super) struct GroupedEigenvalues<'a> {
    study: &'a Study,
    fits: GroupFits<'a>,
    /// What was decided on the level before.
    former: Option<Former>,
    /// Why the groups of the last level are not those that the study lists. They may be others on the next; if they are
    /// the same, they stay.
    refusal: Option<BuildError>,
}

/// What was decided on one level.
struct Former {
    grouping: Grouping,
    score: f64,
    kind: LabelKind,
}

/// Labels of another number, or found in another way, are others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct LabelKind {
    count: usize,
    follow_vectors: bool,
}

impl<'a> GroupedEigenvalues<'a> {
    pub fn new(study: &'a Study, fit: ComponentFit<'a>) -> Self {
        Self { study, fits: GroupFits::new(study, fit), former: None, refusal: None }
    }

    /// Why the last level cannot be the last word.
    pub fn refusal(&self) -> Option<&BuildError> {
        self.refusal.as_ref()
    }

    /// What all fits have cost ([`ComponentFit::work`]).
    pub fn work(&self) -> u64 {
        self.fits.work()
    }

    /// Groups, fits and numbers everything on the current design. `None` if the method asks for a larger one.
    pub fn fit(
        &mut self,
        evaluations: &mut Evaluations<'_>,
        can_grow: bool,
        observer: &dyn Observer,
    ) -> Result<Option<(Level, Vec<ComponentResult>)>, BuildError> {
        let (labels, groups) = evaluations.follow()?;
        let kind = LabelKind { count: labels.count(), follow_vectors: labels.follow_vectors() };
        if self.former.as_ref().is_some_and(|former| former.kind != kind) {
            self.former = None;
            self.fits.forget();
        }
        let samples = evaluations.samples();
        let (runs, has_derivatives) = (evaluations.runs(), evaluations.has_derivatives());
        let verdict = VerdictBasis { is_self_adjoint: evaluations.is_self_adjoint(), ..VerdictBasis::default() };
        let followed = Followed { samples: &samples, runs, labels, groups, has_derivatives, verdict };
        self.fits.begin(&followed);

        let ranked = labels_by_rank(&followed, &self.study.spectrum.modes);
        let of_interest = match (&self.study.spectrum.modes, &ranked) {
            (Modes::Ranks(modes), Some(ranked)) => self.listed(modes, ranked, &followed)?,
            _ => followed.groups.finest().to_vec(),
        };
        let former = self.former.as_ref().map(|former| (&former.grouping, former.score));
        let (chosen, score) = choose(&followed, &of_interest, former, &mut self.fits, can_grow, observer)?;
        // A first level predicts little, whatever there is.
        if self.former.is_some()
            && let Some(point) = infinite_near(self.study, &followed, &chosen, &self.fits, observer)?
        {
            return Err(BuildError::Infinite { point: self.study.inputs.describe(&point) });
        }
        let chosen = with_unseen_groups(self.study, &followed, chosen, &mut self.fits, can_grow, observer)?;
        self.former = Some(Former { grouping: chosen.clone(), score, kind });
        let fits: Option<Vec<GroupFit>> = chosen.iter().map(|group| self.fits.take(group)).collect();
        let Some(fits) = fits.filter(|fits| fits.iter().all(|fit| fit.fits.len() == fit.values.len())) else {
            return Ok(None);
        };
        let mut numbered: Vec<(Numbers, GroupFit)> = match &ranked {
            Some(ranked) => chosen.iter().map(|group| by_rank(group, ranked)).zip(fits).collect(),
            None => {
                let at_center: Vec<(&Output, Vec<Complex<f64>>)> =
                    fits.iter().map(|fit| (&fit.output, self.fits.eigenvalues_at_center(fit))).collect();
                let numbers = numbers(&at_center);
                numbers.into_iter().zip(fits).collect()
            }
        };
        let before = self.refusal.take();
        if let (Modes::Ranks(modes), None) = (&self.study.spectrum.modes, &ranked) {
            self.refusal = self.refuse(modes, &numbered, &followed)?;
            if let (true, Some(refusal)) = (self.refusal == before, self.refusal.clone()) {
                return Err(refusal);
            }
            // All groups go on together until it is known which of them stay.
            let has_listed = |numbers: &Numbers| numbers.modes.iter().any(|mode| modes.contains(mode));
            numbered.retain(|(numbers, _)| self.refusal.is_some() || has_listed(numbers));
        }
        let band = match self.study.spectrum.modes {
            Modes::Band([lower, upper]) => {
                let (modes, reals) = numbered.iter().fold((0, 0), |(modes, reals), (numbers, _)| {
                    (modes + numbers.modes.len(), reals + numbers.reals.len())
                });
                self.keep_band(&mut numbered)?;
                Some(Band { lower, upper, modes, reals })
            }
            Modes::All | Modes::Ranks(_) => None,
        };
        // Modes in the order of their numbers, then real eigenvalues in that of theirs.
        numbered.sort_by_key(|(numbers, _)| {
            (numbers.modes.first().copied().unwrap_or(usize::MAX), numbers.reals.first().copied())
        });
        drop(followed);
        let is_by_modulus = has_derivatives && !kind.follow_vectors && ranked.is_none();
        Ok(Some(level(samples, numbered, is_by_modulus, band)))
    }

    /// Keeps the groups that have an eigenvalue in the band of frequencies in the middle of the inputs.
    fn keep_band(&self, numbered: &mut Vec<(Numbers, GroupFit)>) -> Result<(), BuildError> {
        let modes = &self.study.spectrum.modes;
        let frequencies = |fit: &GroupFit| self.fits.eigenvalues_at_center(fit);
        let is_inside =
            |(_, fit): &(Numbers, GroupFit)| frequencies(fit).iter().any(|lambda| modes.has_frequency(*lambda));
        if !numbered.iter().any(is_inside) {
            let mut all: Vec<f64> =
                numbered.iter().flat_map(|(_, fit)| frequencies(fit)).map(|lambda| lambda.im.abs() / TAU).collect();
            all.sort_by(f64::total_cmp);
            all.dedup_by(|a, b| (*a - *b).abs() <= f64::EPSILON * *b);
            return Err(BuildError::EmptyBand { frequencies: all });
        }
        numbered.retain(is_inside);
        Ok(())
    }

    /// The finest groups of listed modes, where frequency ranks are numbers of modes.
    fn listed(&self, modes: &[usize], ranked: &[usize], followed: &Followed<'_>) -> Result<Vec<Group>, BuildError> {
        if let Some(&mode) = modes.iter().find(|&&mode| mode > ranked.len()) {
            return Err(self.no_such_mode(mode, ranked.len(), followed));
        }
        let spectra: Vec<Spectrum> = followed.runs.iter().map(|run| run.spectrum.clone()).collect();
        match clusters(&spectra, modes) {
            Err(cause @ ClusterError::Split { at, .. }) => {
                let inputs = &self.study.inputs;
                let point = inputs.describe(&inputs.physical(followed.samples.point(at)));
                return Err(BuildError::Clusters { point, cause });
            }
            // What else it finds is no obstacle where groups are decided by prediction.
            Ok(_) | Err(ClusterError::TooMany { .. } | ClusterError::NearRealAxis { .. }) => {}
        }
        let group = |&mode: &usize| followed.groups.finest()[followed.groups.of_label(ranked[mode - 1])].clone();
        Ok(modes.iter().map(group).collect())
    }

    /// Why a list of modes has no groups of its own, where numbers of modes are known after all groups are fitted.
    fn refuse(
        &self,
        modes: &[usize],
        numbered: &[(Numbers, GroupFit)],
        followed: &Followed<'_>,
    ) -> Result<Option<BuildError>, BuildError> {
        let count = numbered.iter().map(|(numbers, _)| numbers.modes.len()).sum();
        if let Some(&mode) = modes.iter().find(|&&mode| mode > count) {
            return Err(self.no_such_mode(mode, count, followed));
        }
        let groups = || numbered.iter().map(|(numbers, _)| &numbers.modes);
        let has_listed = |group: &&Vec<usize>| group.iter().any(|mode| modes.contains(mode));
        let mut smallest: Vec<usize> = groups().filter(has_listed).flatten().copied().collect();
        smallest.sort_unstable();
        let split = groups().filter(has_listed).find(|group| group.iter().any(|mode| !modes.contains(mode)));
        Ok(split.map(|group| BuildError::SplitGroup { listed: modes.to_vec(), group: group.clone(), smallest }))
    }

    fn no_such_mode(&self, mode: usize, count: usize, followed: &Followed<'_>) -> BuildError {
        let inputs = &self.study.inputs;
        let point = inputs.describe(&inputs.physical(followed.samples.point(0)));
        RunError::Spectrum { point, cause: SpectrumError::NoSuchMode { mode, count } }.into()
    }
}

/// The label of every frequency rank, if all eigenvalues oscillate everywhere and keep their ranks, by Im λ and by |λ|:
/// then ranks are the numbers of modes. For listed modes it is enough if those up to the next above the list do.
fn labels_by_rank(followed: &Followed<'_>, modes: &Modes) -> Option<Vec<usize>> {
    let oscillating: Vec<usize> =
        followed.groups.finest().iter().filter(|group| !group.is_closed()).map(|group| group.labels()[0]).collect();
    let count = match modes {
        Modes::All | Modes::Band(_) if oscillating.len() < followed.groups.finest().len() => return None,
        Modes::All | Modes::Band(_) => oscillating.len(),
        Modes::Ranks(modes) => modes.iter().max().map_or(0, |last| last + 1),
    };
    let order = |run: usize, key: fn(Complex<f64>) -> f64| {
        let spectrum = &followed.runs[run].spectrum;
        let mut order: Vec<(usize, Complex<f64>)> = (0..followed.labels.count())
            .map(|label| (label, followed.eigenvalue(run, label)))
            .filter(|(_, lambda)| lambda.im > 0.0)
            .collect();
        order.sort_by(|(_, a), (_, b)| key(*a).total_cmp(&key(*b)).then(a.re.total_cmp(&b.re)));
        order.truncate(count.min(spectrum.count()));
        order.into_iter().map(|(label, _)| label).collect::<Vec<_>>()
    };
    let ranked = order(0, |lambda| lambda.im);
    let are_complex = ranked.iter().all(|label| oscillating.contains(label));
    let is_same = |run: usize| order(run, |lambda| lambda.im) == ranked && order(run, |lambda| lambda.norm()) == ranked;
    (are_complex && (0..followed.runs.len()).all(is_same)).then_some(ranked)
}

fn by_rank(group: &Group, ranked: &[usize]) -> Numbers {
    let rank = |label: &usize| ranked.iter().position(|other| other == label).map_or(0, |at| at + 1);
    let mut modes: Vec<usize> = group.labels().iter().map(rank).filter(|&rank| rank > 0).collect();
    modes.sort_unstable();
    Numbers { modes, reals: Vec::new() }
}

/// Everything fitted, with names and ids.
fn level(
    samples: crate::fitting::design::Samples,
    numbered: Vec<(Numbers, GroupFit)>,
    is_by_modulus: bool,
    band: Option<Band>,
) -> (Level, Vec<ComponentResult>) {
    let mut outputs = Vec::with_capacity(numbered.len());
    let (mut values, mut resolutions, mut results) = (Vec::new(), Vec::new(), Vec::new());
    let mut gradients = Some(Vec::new());
    for (numbers, fit) in numbered {
        outputs.push(output(fit.output.kind, &numbers, &fit.eigenvalues));
        values.extend(fit.values);
        resolutions.extend(fit.resolutions);
        results.extend(fit.fits);
        gradients = gradients.zip(fit.gradients).map(|(all, own)| [all, own].concat());
    }
    (Level { samples, outputs: with_ids(outputs), values, gradients, resolutions, is_by_modulus, band }, results)
}
