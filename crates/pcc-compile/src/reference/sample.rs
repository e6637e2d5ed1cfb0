//! Direct computations that are kept, so that many surrogates can be judged on the same points for the price of one.

use super::compare::{Comparison, eigenvalue_errors};
use super::direct_computations::{Ranks, ReferenceError, for_each_chunk, surrogate_block};
use super::matching::Matching;
use super::verdicts::Judged;
use crate::campaign::Campaign;
use crate::mechanics::spectrum::{Modes, Spectrum, Target};
use crate::study::Study;
use nalgebra::Complex;
use pcc_evaluate::components::Block;
use pcc_evaluate::evaluation::Plan;
use pcc_evaluate::foundation::{Observer, try_map};
use pcc_evaluate::probability::inputs::random_point;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::surrogate::Surrogate;

/// Points of a surrogate that are evaluated together, and how many such parts are held in memory.
const CHUNK: usize = 4096;
const CHUNKS_IN_FLIGHT: usize = 64;

/// What the model answers at samples 0 … n − 1 of a study's input space: the points of
/// [`pcc_evaluate::evaluation::monte_carlo`].
#[derive(Debug, Clone)]
pub struct ModelSample<'a> {
    study: &'a Study,
    seed: u64,
    modes: Vec<usize>,
    /// Per mode of the study, one eigenvalue per point.
    eigenvalues: Vec<Vec<Complex<f64>>>,
    /// All eigenvalues at every point, one of each conjugate pair, point after point.
    halves: Vec<Complex<f64>>,
    /// Where those of each point end.
    ends: Vec<usize>,
    /// max Re λ at every point, over all eigenvalues but rigid-body motion.
    max_re: Vec<f64>,
    /// What the model says of stability at every point.
    judged: Vec<Judged>,
    rigid_body_modes: usize,
}

impl<'a> ModelSample<'a> {
    /// Runs the model of `study` at `samples` points under `seed`, on the current rayon thread pool.
    ///
    /// # Errors
    ///
    /// As [`super::monte_carlo`].
    pub fn new(
        campaign: impl Into<Campaign<'a>>,
        samples: u64,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Self, ReferenceError> {
        let campaign = campaign.into();
        let study = campaign.study;
        let mut ranks: Option<Ranks> = None;
        let mut sample = Self {
            study,
            seed,
            modes: Vec::new(),
            eigenvalues: Vec::new(),
            halves: Vec::new(),
            ends: Vec::new(),
            max_re: Vec::new(),
            judged: Vec::new(),
            rigid_body_modes: 0,
        };
        for_each_chunk(campaign, samples, seed, Purpose::Evaluation, observer, |_, runs, _| {
            let ranks = ranks.get_or_insert_with(|| {
                let ranks = Ranks::of(study, runs.first());
                sample.eigenvalues = vec![Vec::new(); ranks.modes().len()];
                ranks
            });
            if !ranks.hold_for(runs) {
                ranks.give_up();
                sample.eigenvalues.clear();
            }
            for run in runs {
                sample.halves.extend(run.spectrum.halves());
                sample.ends.push(sample.halves.len());
                sample.max_re.push(run.spectrum.max_re());
                sample.judged.push(Judged::of(&run.spectrum));
                sample.rigid_body_modes = run.spectrum.rigid_body_modes();
                let lambdas = ranks.eigenvalues(&run.spectrum);
                sample.eigenvalues.iter_mut().zip(lambdas).for_each(|(list, lambda)| list.push(lambda));
            }
            Ok(())
        })?;
        sample.modes = ranks.map_or(Vec::new(), |ranks| ranks.modes().to_vec());
        Ok(sample)
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.max_re.len()
    }

    /// Never: there is a point at least.
    pub fn is_empty(&self) -> bool {
        self.max_re.is_empty()
    }

    /// Frequency ranks of the study's modes, ascending; none if their number changes from point to point.
    pub fn modes(&self) -> &[usize] {
        &self.modes
    }

    /// Eigenvalues of the mode at this position of [`ModelSample::modes`], point by point, in 1/s.
    pub fn eigenvalues(&self, position: usize) -> &[Complex<f64>] {
        &self.eigenvalues[position]
    }

    /// The eigenvalues of the model at a point.
    fn spectrum(&self, index: usize) -> Option<Spectrum> {
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        Spectrum::from_halves(&self.halves[start..self.ends[index]]).ok()
    }

    /// max Re λ of the model, point by point, in 1/s.
    pub fn max_re(&self) -> &[f64] {
        &self.max_re
    }

    /// Standardized coordinates of point `index`.
    pub fn point(&self, index: usize) -> Vec<f64> {
        let mut point = vec![0.0; self.study.inputs.dimension()];
        random_point(&self.study.inputs, self.seed, Purpose::Evaluation, index as u64, &mut point);
        point
    }

    /// A surrogate at the first `count` points.
    ///
    /// # Errors
    ///
    /// [`ReferenceError::OtherProblem`] if it has other inputs, [`ReferenceError::NotFinite`].
    pub fn surrogate_at(&self, surrogate: &Surrogate, count: usize) -> Result<Block, ReferenceError> {
        let mut all = Block::with_capacity(surrogate.component_count(), surrogate.labels().len(), count);
        let plan = Plan::new(surrogate);
        self.for_each_block(surrogate, &plan, count, |_, block| all.append(block))?;
        Ok(all)
    }

    /// Compares a surrogate of the same model and inputs with the model on all points: stability, and the eigenvalues
    /// that the study asks for.
    ///
    /// # Errors
    ///
    /// [`ReferenceError::OtherProblem`] if the surrogate has other inputs; what else it was built for is not asked, so
    /// that surrogates of other targets and modes can be judged. [`ReferenceError::NotFinite`].
    pub fn compare(&self, surrogate: &Surrogate) -> Result<Comparison, ReferenceError> {
        let plan = Plan::new(surrogate);
        let mut comparison = Comparison::new(self.len() as u64);
        comparison.rigid_body_modes = self.rigid_body_modes;
        let matching = Matching::new(surrogate, self.study.spectrum.target);
        let listed: Option<Vec<String>> = match &self.study.spectrum.modes {
            Modes::All | Modes::Band(_) => None,
            Modes::Ranks(modes) => {
                Some(modes.iter().flat_map(|mode| ["re", "im"].map(|p| format!("{p}_{mode}"))).collect())
            }
        };
        // Where the number of modes changes from point to point, frequency ranks say nothing of who is who.
        let has_names = self.study.spectrum.target == Target::Invariants || !self.modes.is_empty();
        self.for_each_block(surrogate, &plan, self.len(), |start, block| {
            let range = start..start + block.max_re.len();
            comparison.classify(self.judged[range.clone()].iter().copied(), &block);
            if !has_names {
                return;
            }
            let spectra: Option<Vec<Spectrum>> = range.map(|index| self.spectrum(index)).collect();
            // They were spectra when they were kept.
            let Some(spectra) = spectra else { return };
            let mut errors = eigenvalue_errors(surrogate, &matching, &spectra.iter().collect::<Vec<_>>(), &block);
            errors.retain(|error| listed.as_ref().is_none_or(|names| names.contains(&error.name)));
            comparison.merge(errors);
        })?;
        Ok(comparison)
    }

    fn for_each_block(
        &self,
        surrogate: &Surrogate,
        plan: &Plan,
        count: usize,
        mut consume: impl FnMut(usize, Block),
    ) -> Result<(), ReferenceError> {
        if !surrogate.inputs.is_same_as(&self.study.inputs) {
            return Err(ReferenceError::other_problem(surrogate, self.study));
        }
        for first in (0..count).step_by(CHUNK * CHUNKS_IN_FLIGHT) {
            let end = count.min(first + CHUNK * CHUNKS_IN_FLIGHT);
            let blocks = try_map((end - first).div_ceil(CHUNK), |chunk| {
                let start = first + chunk * CHUNK;
                let points: Vec<Vec<f64>> = (start..end.min(start + CHUNK)).map(|index| self.point(index)).collect();
                surrogate_block(surrogate, plan, &points)
            })?;
            blocks.into_iter().enumerate().for_each(|(chunk, block)| consume(first + chunk * CHUNK, block));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::compare_with_model;
    use pcc_evaluate::artifact::decode;
    use pcc_evaluate::foundation::Silent;

    #[test]
    fn kept_points_compare_as_fresh_ones_do() {
        let study = Study::from_toml(include_str!("../../../../surrogates/clutch-r2-eigenvalues.toml")).unwrap();
        let surrogate = decode(include_bytes!("../../../../surrogates/clutch-r2-eigenvalues.pcc")).unwrap().surrogate;
        let sample = ModelSample::new(&study, 10_001, 3, &Silent).unwrap();
        let (kept, fresh) =
            (sample.compare(&surrogate).unwrap(), compare_with_model(&surrogate, &study, 10_001, 3, &Silent).unwrap());
        assert_eq!(kept, fresh);
        let block = sample.surrogate_at(&surrogate, 5000).unwrap();
        let expected = surrogate.evaluate(&sample.point(4999));
        assert!((block.components[0][4999] - expected[0]).abs() < 1e-9);

        let other = decode(include_bytes!("../../../../surrogates/clutch-r3.pcc")).unwrap().surrogate;
        assert!(matches!(sample.compare(&other), Err(ReferenceError::OtherProblem { .. })));
        let invariants = decode(include_bytes!("../../../../surrogates/clutch-r2.pcc")).unwrap().surrogate;
        let names: Vec<_> = sample.compare(&invariants).unwrap().components.into_iter().map(|c| c.name).collect();
        assert_eq!(names, ["re_3", "im_3", "re_4", "im_4"]);
    }
}
