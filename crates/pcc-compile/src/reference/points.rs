//! The model at given points, with modes that keep their numbers.
//!
//! Where a study's modes have frequency ranks, those are the numbers. Else one run in the middle of the inputs gives
//! them: modes by |λ| from 1, real eigenvalues from the largest. At every other point eigenvalues are followed from
//! there by eigenvectors, or, if the model has none, by their order in |λ|.

use super::direct_computations::ReferenceError;
use crate::campaign::{Campaign, Run, RunError, Runner, agree_on_rigid_body_motion};
use crate::mechanics::spectrum::{Labels, Modes, Spectrum, SpectrumError, Target};
use crate::study::Study;
use nalgebra::Complex;
use pcc_evaluate::components::{Label, Top};
use pcc_evaluate::foundation::Observer;

/// What the model answers at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointAnswer {
    /// The eigenvalue of every label, in 1/s.
    pub eigenvalues: Vec<Complex<f64>>,
    /// What decides on stability.
    pub top: Top,
}

/// Runs the model of a study at points that somebody gives.
pub struct PointReference<'a> {
    study: &'a Study,
    runner: Runner<'a>,
    center: Option<Center>,
    labels: Vec<Label>,
}

/// The run in the middle of the inputs.
struct Center {
    run: Run,
    /// The position in its spectrum of every label, and of its conjugate.
    positions: Vec<(usize, usize)>,
}

impl<'a> PointReference<'a> {
    /// Sets up the model.
    ///
    /// # Errors
    ///
    /// [`ReferenceError::Model`].
    pub fn new(campaign: impl Into<Campaign<'a>>) -> Result<Self, ReferenceError> {
        let campaign = campaign.into();
        let runner = Runner::new(campaign)?;
        let runner = match campaign.study.spectrum.target {
            Target::Eigenvalues => runner,
            Target::Invariants => runner.without_ranks().with_derivatives(true),
        };
        Ok(Self { study: campaign.study, runner, center: None, labels: Vec::new() })
    }

    /// Names of the eigenvalues; none before the first points.
    pub fn labels(&self) -> &[Label] {
        &self.labels
    }

    /// Runs the model at physical points.
    ///
    /// # Errors
    ///
    /// [`ReferenceError::Run`] names the first point that failed, or lacks a mode that the study lists.
    pub fn run(&mut self, points: &[Vec<f64>], observer: &dyn Observer) -> Result<Vec<PointAnswer>, ReferenceError> {
        if self.study.spectrum.target == Target::Eigenvalues {
            let runs = self.runner.run(points, observer)?;
            self.labels = self.runner.modes().iter().map(|&mode| Label::Mode(mode)).collect();
            let answer = |run: Run| PointAnswer { top: run.spectrum.top(), eigenvalues: run.eigenvalues };
            return Ok(runs.into_iter().map(answer).collect());
        }
        let mut runs = self.runner.run(points, observer)?;
        if self.center.is_none() {
            self.begin(&mut runs, observer)?;
        }
        let Some(center) = &self.center else { return Ok(Vec::new()) };
        agree_on_rigid_body_motion(&mut runs, center.run.spectrum.rigid_body_modes());
        let answers = runs
            .iter()
            .map(|run| PointAnswer { eigenvalues: center.follow(&self.labels, run), top: run.spectrum.top() });
        Ok(answers.collect())
    }

    /// Runs the middle of the inputs and gives numbers. Rigid-body motion is what it has in common with the first runs:
    /// a slow eigenvalue may pass zero just there.
    fn begin(&mut self, first: &mut [Run], observer: &dyn Observer) -> Result<(), ReferenceError> {
        let inputs = &self.study.inputs;
        let middle = inputs.physical(&inputs.middle());
        let mut center = self.runner.run(std::slice::from_ref(&middle), observer)?;
        let common = agree_on_rigid_body_motion(first, usize::MAX);
        agree_on_rigid_body_motion(&mut center, common);
        let Some(run) = center.into_iter().next() else { return Ok(()) };
        let spectrum = &run.spectrum;
        let lambdas = spectrum.eigenvalues();
        let oscillating: Vec<usize> = (0..lambdas.len()).filter(|&at| lambdas[at].im > 0.0).collect();
        let mut reals: Vec<usize> = (0..lambdas.len()).filter(|&at| lambdas[at].im == 0.0).collect();
        reals.sort_by(|&a, &b| lambdas[b].re.total_cmp(&lambdas[a].re));
        let (mut labels, mut positions) = (Vec::new(), Vec::new());
        let listed = |mode: usize| match &self.study.spectrum.modes {
            Modes::All => true,
            Modes::Ranks(modes) => modes.contains(&mode),
            band @ Modes::Band(_) => band.has_frequency(lambdas[oscillating[mode - 1]]),
        };
        if let Modes::Ranks(modes) = &self.study.spectrum.modes
            && let Some(&mode) = modes.iter().find(|&&mode| mode > oscillating.len())
        {
            let cause = SpectrumError::NoSuchMode { mode, count: oscillating.len() };
            let point = self.study.inputs.describe(&middle);
            return Err(RunError::Spectrum { point, cause }.into());
        }
        let is_real = |run: &Run| run.spectrum.eigenvalues().iter().any(|lambda| lambda.im == 0.0);
        let has_reals = !reals.is_empty() || first.iter().any(is_real);
        for (mode, at) in (1..).zip(oscillating.iter().copied()).filter(|(mode, _)| listed(*mode)) {
            let both = (at, spectrum.conjugate(at));
            labels.push(Label::Mode(mode));
            positions.push(both);
            if has_reals {
                labels.push(Label::Second(mode));
                positions.push((both.1, both.0));
            }
        }
        let has_reals = match &self.study.spectrum.modes {
            Modes::Ranks(_) => false,
            modes => modes.has_frequency(Complex::default()),
        };
        if has_reals {
            labels.extend((1..=reals.len()).map(Label::Real));
            positions.extend(reals.into_iter().map(|at| (at, at)));
        }
        self.labels = labels;
        self.center = Some(Center { run, positions });
        Ok(())
    }
}

impl Center {
    /// The eigenvalues of all labels in a run. Where both of a mode are real, the larger is its first.
    fn follow(&self, labels: &[Label], run: &Run) -> Vec<Complex<f64>> {
        let vectors = |run: &Run| run.reductions.as_ref()?.vectors(&run.spectrum);
        let spectra = [&self.run.spectrum, &run.spectrum];
        let followed = match (vectors(&self.run), vectors(run)) {
            (Some(here), Some(there)) if is_as_large(spectra) => {
                Labels::following(&[&[0.0], &[1.0]], 0, &[here, there], &spectra)
            }
            _ => Labels::by_modulus(&spectra),
        };
        let lambdas = run.spectrum.eigenvalues();
        let at = |position: usize| {
            let position = if position < followed.count() { followed.position(1, position) } else { position };
            lambdas.get(position).copied().unwrap_or(Complex::new(f64::NAN, f64::NAN))
        };
        let eigenvalue = |(label, &(own, conjugate)): (&Label, &(usize, usize))| {
            let [first, second] = first_and_second(at(own), at(conjugate));
            match label {
                Label::Real(_) => at(own),
                Label::Mode(_) => first,
                Label::Second(_) => second,
            }
        };
        labels.iter().zip(&self.positions).map(eigenvalue).collect()
    }
}

/// Of a conjugate pair that with Im λ > 0 first, of two real eigenvalues the larger.
fn first_and_second(one: Complex<f64>, other: Complex<f64>) -> [Complex<f64>; 2] {
    if is_first(one, other) { [one, other] } else { [other, one] }
}

/// Whether the first of two eigenvalues of a mode is its first.
pub(super) fn is_first(one: Complex<f64>, other: Complex<f64>) -> bool {
    if one == other.conj() && one.im != 0.0 { one.im > 0.0 } else { one.re >= other.re }
}

fn is_as_large(spectra: [&Spectrum; 2]) -> bool {
    spectra[0].eigenvalues().len() == spectra[1].eigenvalues().len()
}
