//! The paper, reproduced: its table 2 and figures 3 and 4, every method on the same points of the same model, and what
//! lies beyond the paper beside it.
//!
//! For each number r of uncertain parameters the model is run once at random points, as in the paper's section 5.1, and
//! every surrogate is compared with these answers. The builds (`cases`) start from the shipped studies: gPC by
//! quadrature with the table's orders; multi-element gPC of order 2 with the table's numbers of elements (its direct
//! computations over 3ʳ), θ₁ = 0 so that their number alone ends the division; sparse PC from five designs; then the
//! same and least squares of degree 3 on invariants. Modes 3 and 4 here are the paper's 1 and 2, the pair that
//! coalesces ([`PAIR`]); errors of mean and variance are the larger ones of Re λ of the two. [`TABLE_2`] has the
//! paper's figures.

mod cases;
mod paper;

pub use cases::MOST_INPUTS;
pub use paper::{PaperRow, Range, TABLE_2};

use cases::{Case, Expanded};
use num_complex::Complex;
use pcc_compile::compilation::{BuildError, build};
use pcc_compile::mechanics::spectrum::Target;
use pcc_compile::reference::{Comparison, ModelSample, ReferenceError};
use pcc_compile::study::{Study, StudyError};
use pcc_evaluate::evaluation::{EvalError, Sensitivities, sensitivities};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::surrogate::Surrogate;
use serde::Serialize;
use std::time::Instant;
use thiserror::Error;

/// Points of a cloud: more would only hide each other.
const CLOUD: usize = 1000;

/// Points from which densities are made, at most.
const DENSITY: usize = 200_000;

/// Samples for Sobol' indices.
const SENSITIVITY_SAMPLES: u64 = 100_000;

/// Modes 1 and 2 of the paper, the pair that coalesces.
pub const PAIR: [usize; 2] = [3, 4];

/// Why the paper could not be reproduced.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReproduceError {
    /// A study that comes with the program is wrong.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A build failed.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The model could not be sampled.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// A surrogate could not be sampled.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// The user asked to stop.
    #[error("{0}")]
    Interrupted(#[from] Interrupted),
}

/// What is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Table 2.
    pub table_2: bool,
    /// Figure 3.
    pub figure_3: bool,
    /// Figure 4.
    pub figure_4: bool,
    /// Direct computations that surrogates are compared with, for each number of inputs.
    pub runs: u64,
    /// Seed of the points, and of the first design.
    pub seed: u64,
}

/// One build, compared with the model: a row of `table2.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Row {
    /// Number of uncertain parameters.
    pub r: usize,
    /// `gpc`, `me-gpc` or `sparse`.
    pub method: &'static str,
    /// Highest order of the search.
    pub order: u16,
    /// All model runs spent.
    pub direct_computations: u64,
    /// Largest error of the mean of Re λ of the pair.
    pub mean_error_percent: Option<f64>,
    /// Largest error of the variance of Re λ of the pair.
    pub variance_error_percent: Option<f64>,
    /// Error of the stability proportion.
    pub stability_error_percent: Option<f64>,
    /// What is expanded.
    pub target: &'static str,
    /// Whether derivatives entered the fit.
    pub derivatives: bool,
    /// Seed of the design.
    pub seed: u64,
    /// Runs of the final mesh: what the paper counts.
    pub final_mesh_computations: u64,
    /// Points on whose stability surrogate and model disagree.
    pub misclassified_percent: f64,
    /// Time of the build.
    pub seconds: f64,
    /// Whether a full expansion is by least squares; its order alone does not say so. Not a column.
    #[serde(skip)]
    pub is_least_squares: bool,
}

/// Eigenvalues of the pair at some points, by the model and by two surrogates.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    /// Number of uncertain parameters.
    pub inputs: usize,
    /// Friction coefficients.
    pub friction: Vec<f64>,
    /// Both eigenvalues at each point, by the model.
    pub model: [Vec<Complex<f64>>; 2],
    /// By the paper's sparse method.
    pub sparse: [Vec<Complex<f64>>; 2],
    /// By invariants.
    pub invariants: [Vec<Complex<f64>>; 2],
}

/// What is found with all parameters uncertain beside the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Closer {
    /// max Re λ of the pair by the model.
    pub model: Vec<f64>,
    /// By the paper's sparse method.
    pub sparse: Vec<f64>,
    /// By invariants.
    pub invariants: Vec<f64>,
    /// Names of the inputs.
    pub names: Vec<String>,
    /// Which of them decide stability, by invariants.
    pub sensitivities: Sensitivities,
}

/// The work, one number of inputs after the other, with what has been found so far.
#[derive(Debug)]
pub struct Reproduction {
    options: Options,
    next: usize,
    /// Rows in the order of their builds.
    pub rows: Vec<Row>,
    /// One per number of inputs that a figure shows.
    pub clouds: Vec<Cloud>,
    /// With all parameters uncertain, if the table is wanted.
    pub closer: Option<Closer>,
}

impl Reproduction {
    /// Nothing done yet.
    pub fn new(options: Options) -> Self {
        Self { options, next: 1, rows: Vec::new(), clouds: Vec::new(), closer: None }
    }

    /// What is wanted.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Does what is wanted for the next number of inputs; false if all is done. What was found before an error stays.
    ///
    /// # Errors
    ///
    /// [`ReproduceError`].
    pub fn step(&mut self, observer: &dyn Observer) -> Result<bool, ReproduceError> {
        if self.next > MOST_INPUTS {
            return Ok(false);
        }
        let inputs = self.next;
        let Options { table_2, runs, seed, .. } = self.options;
        let has_cloud = self.has_cloud(inputs);
        if table_2 || has_cloud {
            let study = cases::study(inputs, Expanded::Eigenvalues, "")?;
            let points = if table_2 { runs } else { CLOUD as u64 };
            let sample = ModelSample::new(&study, points, seed, observer)?;
            let cases = if table_2 { cases::cases(inputs, seed)? } else { cloud_cases(inputs, seed)? };
            self.build_all(inputs, cases, &sample, observer)?;
        }
        self.next += 1;
        Ok(self.next <= MOST_INPUTS)
    }

    fn has_cloud(&self, inputs: usize) -> bool {
        let in_figure_3 = self.options.figure_3 && (inputs == 1 || inputs == MOST_INPUTS);
        in_figure_3 || (self.options.figure_4 && inputs >= 3)
    }

    fn build_all(
        &mut self,
        inputs: usize,
        cases: Vec<Case>,
        sample: &ModelSample<'_>,
        observer: &dyn Observer,
    ) -> Result<(), ReproduceError> {
        // Surrogates of the first designs: by the paper's sparse method, and by invariants with derivatives.
        let (mut sparse, mut invariants) = (None, None);
        observer.begin(&format!("builds for r = {inputs}"), cases.len() as u64);
        for Case { method, study } in cases {
            observer.check()?;
            let start = Instant::now();
            let surrogate = build(&study, &Quiet(observer))?;
            let seconds = start.elapsed().as_secs_f64();
            if self.options.table_2 {
                let comparison = sample.compare(&surrogate)?;
                self.rows.push(row(inputs, method, &study, &surrogate, &comparison, seconds));
            }
            match (method, study.spectrum.target) {
                ("sparse", Target::Eigenvalues) => sparse = sparse.or(Some(surrogate)),
                ("sparse", _) if study.uses_derivatives() => invariants = invariants.or(Some(surrogate)),
                _ => {}
            }
            observer.advance(1);
        }
        observer.finish();
        let (Some(sparse), Some(invariants)) = (sparse, invariants) else { return Ok(()) };
        if self.has_cloud(inputs) {
            self.clouds.push(cloud(inputs, sample, &sparse, &invariants)?);
        }
        if self.options.table_2 && inputs == MOST_INPUTS {
            self.closer = Some(closer(sample, &sparse, &invariants, self.options.seed, observer)?);
        }
        Ok(())
    }
}

/// The builds that a figure needs.
fn cloud_cases(inputs: usize, seed: u64) -> Result<Vec<Case>, StudyError> {
    let case = |expanded| {
        let study = cases::study(inputs, expanded, "")?;
        Ok(Case { method: "sparse", study: Study { seed, ..study } })
    };
    [Expanded::Eigenvalues, Expanded::Invariants].into_iter().map(case).collect()
}

fn row(
    inputs: usize,
    method: &'static str,
    study: &Study,
    surrogate: &Surrogate,
    comparison: &Comparison,
    seconds: f64,
) -> Row {
    let counts = surrogate.training.counts;
    let largest = |error: fn(&pcc_compile::reference::ComponentError) -> Option<f64>| {
        let of_pair = comparison.components.iter().filter(|component| component.name.starts_with("re_"));
        of_pair.map(error).try_fold(0.0, |largest: f64, error| error.map(|error| largest.max(error)))
    };
    Row {
        r: inputs,
        method,
        order: surrogate.expansions.iter().map(|expansion| expansion.degree).max().unwrap_or(0),
        direct_computations: counts.direct_computations,
        mean_error_percent: largest(|component| component.mean_error_percent()),
        variance_error_percent: largest(|component| component.variance_error_percent()),
        stability_error_percent: comparison.relative_error_percent(),
        target: study.spectrum.target.name(),
        derivatives: counts.gradients > 0,
        seed: study.seed,
        final_mesh_computations: counts.final_mesh,
        misclassified_percent: comparison.misclassified_percent(),
        seconds,
        is_least_squares: study.fit.method.has_fixed_design() && !study.fit.method.is_quadrature(),
    }
}

fn cloud(
    inputs: usize,
    sample: &ModelSample<'_>,
    sparse: &Surrogate,
    invariants: &Surrogate,
) -> Result<Cloud, ReproduceError> {
    let count = sample.len().min(CLOUD);
    let friction = (0..count).map(|i| sparse.inputs.physical(&sample.point(i))[0]).collect();
    Ok(Cloud {
        inputs,
        friction,
        model: pair_of_model(sample, count),
        sparse: pair_of(sample, sparse, count)?,
        invariants: pair_of(sample, invariants, count)?,
    })
}

/// The pair at the first points, by the model.
fn pair_of_model(sample: &ModelSample<'_>, count: usize) -> [Vec<Complex<f64>>; 2] {
    PAIR.map(|mode| {
        let position = sample.modes().iter().position(|&other| other == mode);
        position.map_or_else(Vec::new, |position| sample.eigenvalues(position)[..count].to_vec())
    })
}

/// The pair at the first points, by a surrogate.
fn pair_of(
    sample: &ModelSample<'_>,
    surrogate: &Surrogate,
    count: usize,
) -> Result<[Vec<Complex<f64>>; 2], ReferenceError> {
    let block = sample.surrogate_at(surrogate, count)?;
    let modes = surrogate.modes();
    Ok(PAIR.map(|mode| {
        let position = modes.iter().position(|&other| other == mode);
        position.map_or_else(Vec::new, |position| block.eigenvalues[position].clone())
    }))
}

fn closer(
    sample: &ModelSample<'_>,
    sparse: &Surrogate,
    invariants: &Surrogate,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Closer, ReproduceError> {
    let count = sample.len().min(DENSITY);
    Ok(Closer {
        model: max_re(&pair_of_model(sample, count)),
        sparse: max_re(&pair_of(sample, sparse, count)?),
        invariants: max_re(&pair_of(sample, invariants, count)?),
        names: invariants.inputs.names().map(str::to_owned).collect(),
        sensitivities: sensitivities(invariants, SENSITIVITY_SAMPLES, seed, observer)?,
    })
}

/// The larger growth rate of the pair at every point, in 1/s.
fn max_re([first, second]: &[Vec<Complex<f64>>; 2]) -> Vec<f64> {
    first.iter().zip(second).map(|(a, b)| a.re.max(b.re)).collect()
}

/// Lets a build stop, but not show its own progress inside that of the table.
struct Quiet<'a>(&'a dyn Observer);

impl Observer for Quiet<'_> {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn finish(&self) {}
    fn interrupted(&self) -> bool {
        self.0.interrupted()
    }
}
