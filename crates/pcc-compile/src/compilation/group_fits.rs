//! Fits of groups of eigenvalues, and how well each group predicts its eigenvalues at runs left out.
//!
//! Many groupings share groups: each group is fitted once per design, and starts from what the smaller designs have
//! taught of it.

use super::components::{Care, ComponentFit, ComponentResult, Learnt, Start};
use super::evaluations::responses;
use crate::campaign::Run;
use crate::fitting::design::Samples;
use crate::fitting::regression::{BasisTables, Gradients, Response};
use crate::mechanics::spectrum::{Group, Groups, Labels, Numbers, component_errors, components_of, nearest, output};
use crate::numerics::accuracy::Accuracy;
use crate::study::Study;
use nalgebra::Complex;
use pcc_evaluate::components::{Output, OutputKind};
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::surrogate::VerdictBasis;
use std::collections::HashMap;

/// Error of an eigenvalue relative to the largest one: components that vary by less do not vary.
const SOLVER_ACCURACY: f64 = 1e-13;

/// Growth rates that differ by less than this share of the largest eigenvalue are equal: that rounding of one is as
/// large as its distance from the others says nothing of a fit.
const EQUAL: f64 = 1e-10;

/// What was found on a design, and how its eigenvalues are followed.
pub(super) struct Followed<'d> {
    pub samples: &'d Samples,
    pub runs: &'d [Run],
    pub labels: Labels,
    pub groups: Groups,
    pub has_derivatives: bool,
    /// What of the verdict says what eigenvalues can be.
    pub verdict: VerdictBasis,
}

impl Followed<'_> {
    /// The eigenvalues of a group at every run, in the order in which components are made of them.
    pub fn eigenvalues(&self, group: &Group) -> Vec<Vec<Complex<f64>>> {
        let at_run = |(run, found): (usize, &Run)| self.groups.eigenvalues(group, &self.labels, run, &found.spectrum);
        self.runs.iter().enumerate().map(at_run).collect()
    }

    /// The accuracy of the eigenvalues of a group at a run, in the same order.
    fn accuracies(&self, group: &Group, run: usize) -> Vec<Accuracy> {
        self.groups.accuracies(group, &self.labels, run, &self.runs[run].spectrum)
    }

    /// The eigenvalue of a label at a run.
    pub fn eigenvalue(&self, run: usize, label: usize) -> Complex<f64> {
        self.runs[run].spectrum.eigenvalues()[self.labels.position(run, label)]
    }
}

/// A group with everything fitted that it is made of.
pub(super) struct GroupFit {
    /// Its components, numbered from 0 and named for nobody.
    pub output: Output,
    /// Its eigenvalues at every run.
    pub eigenvalues: Vec<Vec<Complex<f64>>>,
    /// Per component, one value per run.
    pub values: Vec<Vec<f64>>,
    /// Per component its derivatives, if the runs come with any.
    pub gradients: Option<Vec<Gradients>>,
    /// Per component, differences up to this size are rounding of the eigenvalue solver.
    pub resolutions: Vec<f64>,
    /// Per component, its fit.
    pub fits: Vec<ComponentResult>,
    /// How carefully it was fitted.
    pub care: Care,
    /// The largest error of its eigenvalues at runs left out, relative to what matters; infinite if it is not known.
    pub score: f64,
}

/// The fits of all groups that were tried on the current design.
pub(super) struct GroupFits<'a> {
    study: &'a Study,
    fit: ComponentFit<'a>,
    current: HashMap<Group, GroupFit>,
    /// What smaller designs have taught of the components of each group.
    previous: HashMap<Group, Vec<Learnt>>,
    /// What the current design teaches.
    learnt: HashMap<Group, Vec<Learnt>>,
    tables: Option<BasisTables>,
}

impl<'a> GroupFits<'a> {
    pub fn new(study: &'a Study, fit: ComponentFit<'a>) -> Self {
        Self { study, fit, current: HashMap::new(), previous: HashMap::new(), learnt: HashMap::new(), tables: None }
    }

    /// Begins a design: nothing is fitted on it yet.
    pub fn begin(&mut self, followed: &Followed<'_>) {
        self.current.clear();
        self.previous.extend(self.learnt.drain());
        self.tables = Some(self.fit.tables(followed.samples, followed.has_derivatives));
    }

    /// Forgets what smaller designs have taught, because labels are no longer the same.
    pub fn forget(&mut self) {
        self.previous.clear();
        self.learnt.clear();
    }

    /// Fits those of `groups` that are not fitted yet on this design, with that care at least.
    pub fn add<'g>(
        &mut self,
        groups: impl IntoIterator<Item = &'g Group>,
        followed: &Followed<'_>,
        (care, can_grow): (Care, bool),
        observer: &dyn Observer,
    ) -> Result<(), Interrupted> {
        let is_missing = |group: &&Group| self.current.get(group).is_none_or(|fit| fit.care < care);
        let mut missing: Vec<&Group> = groups.into_iter().filter(is_missing).collect();
        missing.sort_unstable();
        missing.dedup();
        let mut new: Vec<(&Group, GroupFit)> = Vec::with_capacity(missing.len());
        for group in missing {
            let known = self.current.remove(group);
            new.push((group, known.map_or_else(|| self.unfitted(group, followed, observer), Ok)?));
        }
        let Some(tables) = self.tables.as_ref().filter(|_| !new.is_empty()) else { return Ok(()) };
        let responses: Vec<Response<'_>> = new.iter().flat_map(|(_, fit)| fit.responses()).collect();
        let starts: Vec<Start> = new.iter().flat_map(|(group, fit)| self.starts(group, fit)).collect();
        let found = self.fit.fit(tables, &responses, starts, (care, can_grow), observer)?;
        let mut found = found.unwrap_or_default().into_iter();
        for (group, fit) in &mut new {
            let (fits, learnt) = found.by_ref().take(fit.values.len()).unzip();
            (fit.fits, fit.care) = (fits, if self.fit.trials_are_full() { Care::Full } else { care });
            self.learnt.insert((*group).clone(), learnt);
            fit.score = score(fit, group, followed);
        }
        self.current.extend(new.into_iter().map(|(group, fit)| (group.clone(), fit)));
        Ok(())
    }

    /// Where the fits of the components of a group begin.
    fn starts(&self, group: &Group, fit: &GroupFit) -> Vec<Start> {
        let previous = self.previous.get(group);
        let trials = fit.fits.iter().zip(self.learnt.get(group).into_iter().flatten());
        let mut trials = trials.map(|(fit, learnt)| (fit.clone(), learnt.clone()));
        let start = |k: usize| Start {
            previous: previous.map_or_else(|| self.fit.nothing(), |known| known[k].clone()),
            trial: trials.next(),
        };
        (0..fit.values.len()).map(start).collect()
    }

    /// Fits one more component with these values on the current design, by way of trial.
    pub fn trial_of_values(
        &self,
        values: &[f64],
        observer: &dyn Observer,
    ) -> Result<Option<ComponentResult>, Interrupted> {
        let Some(tables) = &self.tables else { return Ok(None) };
        let response = Response::of(values, 0.0);
        let start = Start::from(&self.fit.nothing());
        let found = self.fit.fit(tables, &[response], vec![start], (Care::Trial, false), observer)?;
        Ok(found.and_then(|mut found| found.pop()).map(|(fit, _)| fit))
    }

    /// What all fits have cost ([`ComponentFit::work`]).
    pub fn work(&self) -> u64 {
        self.fit.work()
    }

    /// A group that was added.
    pub fn get(&self, group: &Group) -> Option<&GroupFit> {
        self.current.get(group)
    }

    /// Takes a group away, to keep it.
    pub fn take(&mut self, group: &Group) -> Option<GroupFit> {
        self.current.remove(group)
    }

    /// Its eigenvalues in the middle of the inputs, in the order of recombination.
    pub fn eigenvalues_at_center(&self, fit: &GroupFit) -> Vec<Complex<f64>> {
        let values: Vec<f64> = fit.fits.iter().map(|one| self.fit.value_at_center(&one.result)).collect();
        let mut found = Vec::new();
        fit.output.recombine(&values, &mut found);
        found
    }

    fn unfitted(
        &self,
        group: &Group,
        followed: &Followed<'_>,
        observer: &dyn Observer,
    ) -> Result<GroupFit, Interrupted> {
        let eigenvalues = followed.eigenvalues(group);
        let (modes, reals) = followed.groups.modes_and_reals(group);
        let numbers = Numbers { modes: (1..=modes).collect(), reals: (1..=reals).collect() };
        let output = output(group.kind(), &numbers, &eigenvalues);
        let mut values = vec![Vec::with_capacity(eigenvalues.len()); output.components.len()];
        for lambdas in &eigenvalues {
            let at_run = components_of(group.kind(), lambdas);
            values.iter_mut().zip(at_run).for_each(|(list, value)| list.push(value));
        }
        let mut gradients = match followed.has_derivatives {
            true => Some(self.gradients(&output, &eigenvalues, followed, observer)?),
            false => None,
        };
        for component in vanishing(group, &values, &eigenvalues, followed) {
            values[component].fill(0.0);
            if let Some(gradients) = &mut gradients {
                gradients[component].slopes.fill(0.0);
            }
        }
        Ok(GroupFit {
            gradients,
            resolutions: self.resolutions(&output, group, &eigenvalues, followed),
            output,
            eigenvalues,
            values,
            fits: Vec::new(),
            care: Care::Trial,
            score: f64::INFINITY,
        })
    }

    /// Differences of each component up to this size are rounding, or the noise that the study or the digits of the
    /// answers say.
    fn resolutions(
        &self,
        output: &Output,
        group: &Group,
        eigenvalues: &[Vec<Complex<f64>>],
        followed: &Followed<'_>,
    ) -> Vec<f64> {
        let rule = resolutions(output, followed.runs);
        let are_noisy = self.study.spectrum.noise > 0.0 || followed.runs.iter().all(|run| run.spectrum.is_rounded());
        match are_noisy {
            true => {
                let known = largest_errors(group, eigenvalues, followed);
                rule.into_iter().zip(known).map(|(rule, known)| rule.max(known)).collect()
            }
            false => finer(rule, group, eigenvalues, followed),
        }
    }

    /// The derivatives of each component in standardized variables. Runs in which the group cannot be separated from
    /// the rest of the spectrum have none.
    fn gradients(
        &self,
        output: &Output,
        eigenvalues: &[Vec<Complex<f64>>],
        followed: &Followed<'_>,
        observer: &dyn Observer,
    ) -> Result<Vec<Gradients>, Interrupted> {
        let slopes = |i: usize| {
            observer.check()?;
            let reductions = followed.runs[i].reductions.as_ref();
            Ok(reductions.and_then(|found| Some((i, found.differentiate(output.kind, &eigenvalues[i])?))))
        };
        let found: Vec<(usize, Vec<Vec<f64>>)> = try_map(followed.runs.len(), slopes)?.into_iter().flatten().collect();
        Ok(gradients(&found, output.components.len(), followed.samples, self.study))
    }
}

/// Finer resolutions of the components of a group, where the accuracy of all its eigenvalues is known at every run:
/// slow modes that were refined are known far better than the largest eigenvalue says.
fn finer(resolutions: Vec<f64>, group: &Group, eigenvalues: &[Vec<Complex<f64>>], followed: &Followed<'_>) -> Vec<f64> {
    let is_known = |run: usize| {
        let spectrum = &followed.runs[run].spectrum;
        group.labels().iter().all(|&label| spectrum.is_accuracy_known(followed.labels.position(run, label)))
    };
    if !(0..followed.runs.len()).all(is_known) {
        return resolutions;
    }
    let largest = largest_errors(group, eigenvalues, followed);
    resolutions.into_iter().zip(largest).map(|(rule, known)| rule.min(known)).collect()
}

/// The largest error of each component of a group at any run.
fn largest_errors(group: &Group, eigenvalues: &[Vec<Complex<f64>>], followed: &Followed<'_>) -> Vec<f64> {
    let of_run = |(run, lambdas): (usize, &Vec<Complex<f64>>)| {
        component_errors(group.kind(), lambdas, &followed.accuracies(group, run))
    };
    let larger = |a: Vec<f64>, b: Vec<f64>| a.into_iter().zip(b).map(|(a, b)| a.max(b)).collect();
    eigenvalues.iter().enumerate().map(of_run).reduce(larger).unwrap_or_default()
}

/// The components of a group that cannot be told from zero at any run: they are zero.
fn vanishing(
    group: &Group,
    values: &[Vec<f64>],
    eigenvalues: &[Vec<Complex<f64>>],
    followed: &Followed<'_>,
) -> Vec<usize> {
    let mut left: Vec<usize> = (0..values.len()).collect();
    for (run, lambdas) in eigenvalues.iter().enumerate() {
        // Most components are ruled out by the first run.
        if left.is_empty() {
            break;
        }
        let errors = component_errors(group.kind(), lambdas, &followed.accuracies(group, run));
        left.retain(|&component| values[component][run].abs() <= errors[component]);
    }
    left
}

/// The derivatives of `count` components by ξ, from those by the inputs at some runs: one list per input each.
pub(super) fn gradients(
    found: &[(usize, Vec<Vec<f64>>)],
    count: usize,
    samples: &Samples,
    study: &Study,
) -> Vec<Gradients> {
    let inputs = study.inputs.inputs();
    let of_component = |position: usize| {
        // ∂y/∂ξ_j = ∂y/∂x_j · dx_j/dξ_j
        let standardized = inputs.iter().enumerate().flat_map(|(j, input)| {
            let chained = |(i, by_input): &(usize, Vec<Vec<f64>>)| {
                by_input[j][position] * input.marginal.slope(samples.point(*i)[j])
            };
            found.iter().map(chained).collect::<Vec<f64>>()
        });
        Gradients { slopes: standardized.collect(), points: found.iter().map(|(i, _)| *i).collect() }
    };
    (0..count).map(of_component).collect()
}

impl GroupFit {
    /// What each component is fitted to.
    fn responses(&self) -> Vec<Response<'_>> {
        responses(&self.values, self.gradients.as_deref(), &self.resolutions)
    }

    /// The eigenvalues that the fit without run i predicts there, in the order of recombination; `None` if it is not
    /// known.
    fn predicted_without(&self, run: usize) -> Option<Vec<Complex<f64>>> {
        let predicted = |(values, fit): (&Vec<f64>, &ComponentResult)| {
            Some(values[run] - fit.result.leave_one_out_residuals.as_ref()?[run])
        };
        let components: Vec<f64> = self.values.iter().zip(&self.fits).map(predicted).collect::<Option<_>>()?;
        let mut found = Vec::new();
        self.output.recombine(&components, &mut found);
        Some(found)
    }
}

/// The rms distance of the eigenvalues of a group from those predicted at runs left out, in 1/s; infinite if it is not
/// known.
pub(super) fn left_out_distance(fit: &GroupFit, group: &Group, followed: &Followed<'_>) -> f64 {
    let (runs, labels) = (followed.runs.len(), group.labels());
    let mut square = 0.0;
    for run in 0..runs {
        let Some(predicted) = fit.predicted_without(run).filter(|found| found.len() == labels.len()) else {
            return f64::INFINITY;
        };
        let lambdas: Vec<Complex<f64>> = labels.iter().map(|&label| followed.eigenvalue(run, label)).collect();
        let matched = nearest(&lambdas, &predicted).into_iter().enumerate();
        square += matched.map(|(k, j)| (predicted[j] - lambdas[k]).norm_sqr()).sum::<f64>();
    }
    if square.is_finite() { (square / (runs * labels.len()) as f64).sqrt() } else { f64::INFINITY }
}

/// The largest over the eigenvalues of a group of: the rms error of its Re λ at runs left out, over the rms distance of
/// its Re λ from the largest of all plus the spread of its Re λ. What never comes near the top may be known less well.
fn score(fit: &GroupFit, group: &Group, followed: &Followed<'_>) -> f64 {
    let runs = followed.runs.len();
    let labels = group.labels();
    let largest = followed.runs.iter().map(|run| run.spectrum.largest()).fold(0.0, f64::max);
    let mut squares = vec![0.0; labels.len()];
    for run in 0..runs {
        let Some(predicted) = fit.predicted_without(run).filter(|found| found.len() == labels.len()) else {
            return f64::INFINITY;
        };
        let lambdas: Vec<Complex<f64>> = labels.iter().map(|&label| followed.eigenvalue(run, label)).collect();
        let predicted: Vec<Complex<f64>> =
            predicted.into_iter().map(|lambda| followed.verdict.settled(lambda)).collect();
        for (k, j) in nearest(&lambdas, &predicted).into_iter().enumerate() {
            let error = predicted[j].re - lambdas[k].re;
            squares[k] += if error.is_finite() { error * error } else { f64::INFINITY };
        }
    }
    let relative = |(k, &label): (usize, &usize)| {
        let growth_rates: Vec<f64> = (0..runs).map(|run| followed.eigenvalue(run, label).re).collect();
        let distance = |run: usize| (followed.runs[run].spectrum.max_re() - growth_rates[run]).powi(2);
        let distance = ((0..runs).map(distance).sum::<f64>() / runs as f64).sqrt();
        let mean = growth_rates.iter().sum::<f64>() / runs as f64;
        let spread = (growth_rates.iter().map(|re| (re - mean).powi(2)).sum::<f64>() / runs as f64).sqrt();
        let error = (squares[k] / runs as f64).sqrt();
        if error == 0.0 { 0.0 } else { error / (distance + spread).max(EQUAL * largest) }
    };
    labels.iter().enumerate().map(relative).fold(0.0, f64::max)
}

/// Differences of each component of `output` up to this size are rounding of the eigenvalue solver in these runs.
pub(super) fn resolutions<'r>(output: &Output, runs: impl IntoIterator<Item = &'r Run>) -> Vec<f64> {
    let largest = runs.into_iter().map(|run| run.spectrum.largest()).fold(0.0, f64::max);
    let of_component = |(position, scale): (usize, f64)| {
        // A coefficient of degree m in eigenvalues, or in their distances from the mean, has the scale Rᵐ: it moves by
        // m Rᵐ⁻¹ per unit of λ.
        let others = match output.kind {
            OutputKind::Closed => position as f64,
            OutputKind::Eigenvalue | OutputKind::Cluster => (position / 2) as f64,
        };
        let radius = scale.powf(1.0 / (others + 1.0));
        SOLVER_ACCURACY * largest * (others + 1.0) * radius.powf(others)
    };
    output.components.iter().map(|component| component.scale).enumerate().map(of_component).collect()
}
