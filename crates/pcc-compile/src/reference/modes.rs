//! All eigenvalues of a model at one point, or along a line, where modes are followed from point to point.
//!
//! Numbers are those of the first point: modes by Im λ from 1, the largest real eigenvalue first. From each point to
//! the next eigenvalues are followed by their eigenvectors, so that modes keep their numbers where frequencies cross;
//! or, if the model has none, by their order in |λ|.

use super::direct_computations::ReferenceError;
use super::points::is_first;
use crate::campaign::{Campaign, Run, Runner, agree_on_rigid_body_motion};
use crate::mechanics::spectrum::{Labels, Spectrum};
use nalgebra::Complex;
use pcc_evaluate::components::{Label, Top, Verdict};
use pcc_evaluate::foundation::Observer;

/// An eigenvalue at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeAtPoint {
    /// λ, in 1/s.
    pub eigenvalue: Complex<f64>,
    /// How far it may be from the true one, in 1/s, because the solver rounds.
    pub error: f64,
    /// What it says of stability, with the margin of the study.
    pub verdict: Verdict,
}

/// All eigenvalues along a line.
#[derive(Debug, Clone, PartialEq)]
pub struct ModesAlong {
    /// What the eigenvalues are called.
    pub labels: Vec<Label>,
    /// For each point one per label; none where the model has fewer eigenvalues.
    pub points: Vec<Vec<Option<ModeAtPoint>>>,
    /// What decides on stability at each point.
    pub tops: Vec<Top>,
    /// Number of eigenvalues that are rigid-body motion, and left out.
    pub rigid_body_modes: usize,
}

/// Runs the model at physical points, which follow each other on a line.
///
/// # Errors
///
/// [`ReferenceError::Model`], and [`ReferenceError::Run`] of the first point that failed.
///
/// # Examples
///
/// ```
/// use pcc_compile::reference::modes_along;
/// use pcc_compile::study::Study;
/// use pcc_evaluate::components::{Label, Verdict};
/// use pcc_evaluate::foundation::Silent;
/// // Two masses of 1 kg; the frequency of the first passes that of the second.
/// let study = Study::from_toml(
///     "format = 1\nname = \"two\"\n[model]\nkind = \"matrices\"\nM = [[1, 0], [0, 1]]\nC = [[0.2, 0], [0, -0.4]]\n\
///      K = [[\"k\", 0], [0, 400]]\n[inputs]\nk = { distribution = \"uniform\", lower = 100.0, upper = 900.0 }\n",
/// )?;
/// let points: Vec<Vec<f64>> = [100.0, 300.0, 500.0, 900.0].map(|k| vec![k]).to_vec();
/// let found = modes_along(&study, &points, &Silent)?;
/// assert_eq!(found.labels, [Label::Mode(1), Label::Mode(2)]);
/// let last = found.points[3][0].expect("an eigenvalue");
/// assert!((last.eigenvalue.re + 0.1).abs() < 1e-12 && (last.eigenvalue.im - 29.99983).abs() < 1e-5);
/// assert_eq!(found.points[3][1].map(|mode| mode.verdict), Some(Verdict::Flutter));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn modes_along<'a>(
    campaign: impl Into<Campaign<'a>>,
    points: &[Vec<f64>],
    observer: &dyn Observer,
) -> Result<ModesAlong, ReferenceError> {
    let mut runner = Runner::new(campaign)?.without_ranks().with_derivatives(true);
    let mut runs = runner.run(points, observer)?;
    let rigid_body_modes = agree_on_rigid_body_motion(&mut runs, usize::MAX);
    let followed = followed(points, &runs);
    let (labels, positions) = numbered(&runs);
    let at = |(number, run): (usize, &Run)| {
        let position = |of_first: usize| match of_first < followed.count() {
            true => followed.position(number, of_first),
            false => of_first,
        };
        let found = positions.iter().map(|&of_first| mode(&run.spectrum, position(of_first))).collect();
        in_order(&labels, found)
    };
    let points = runs.iter().enumerate().map(at).collect();
    let tops = runs.iter().map(|run| run.spectrum.top()).collect();
    Ok(ModesAlong { labels, points, tops, rigid_body_modes })
}

/// Which eigenvalue of each run is which of the first one's.
fn followed(points: &[Vec<f64>], runs: &[Run]) -> Labels {
    let spectra: Vec<&Spectrum> = runs.iter().map(|run| &run.spectrum).collect();
    let vectors: Option<Vec<_>> = runs.iter().map(|run| run.reductions.as_ref()?.vectors(&run.spectrum)).collect();
    let has_as_many = spectra.windows(2).all(|pair| pair[0].eigenvalues().len() == pair[1].eigenvalues().len());
    match vectors.filter(|vectors| has_as_many && !vectors.is_empty()) {
        Some(vectors) => {
            // Neighbours on the line are neighbours of the tree, whatever the units.
            let numbers: Vec<[f64; 1]> = (0..points.len()).map(|number| [number as f64]).collect();
            let numbers: Vec<&[f64]> = numbers.iter().map(<[f64; 1]>::as_slice).collect();
            Labels::following(&numbers, 0, &vectors, &spectra)
        }
        None => Labels::by_modulus(&spectra),
    }
}

/// Labels, and the positions in the first spectrum that they are of. Conjugates have labels of their own if some
/// eigenvalues are real somewhere: a mode may be two of them there.
fn numbered(runs: &[Run]) -> (Vec<Label>, Vec<usize>) {
    let Some(first) = runs.first() else { return (Vec::new(), Vec::new()) };
    let lambdas = first.spectrum.eigenvalues();
    let mut oscillating: Vec<usize> = (0..lambdas.len()).filter(|&at| lambdas[at].im > 0.0).collect();
    oscillating.sort_by(|&a, &b| lambdas[a].im.total_cmp(&lambdas[b].im));
    let mut reals: Vec<usize> = (0..lambdas.len()).filter(|&at| lambdas[at].im == 0.0).collect();
    reals.sort_by(|&a, &b| lambdas[b].re.total_cmp(&lambdas[a].re));
    let has_reals = runs.iter().any(|run| run.spectrum.eigenvalues().iter().any(|lambda| lambda.im == 0.0));
    let (mut labels, mut positions) = (Vec::new(), Vec::new());
    for (mode, at) in (1..).zip(oscillating) {
        labels.push(Label::Mode(mode));
        positions.push(at);
        if has_reals {
            labels.push(Label::Second(mode));
            positions.push(first.spectrum.conjugate(at));
        }
    }
    labels.extend((1..=reals.len()).map(Label::Real));
    positions.extend(reals);
    (labels, positions)
}

/// Of the two eigenvalues of a mode that with Im λ > 0 first, of two real ones the larger.
fn in_order(labels: &[Label], mut found: Vec<Option<ModeAtPoint>>) -> Vec<Option<ModeAtPoint>> {
    for at in 1..labels.len() {
        if let (Label::Second(_), [Some(one), Some(other)]) = (labels[at], &found[at - 1..=at])
            && !is_first(one.eigenvalue, other.eigenvalue)
        {
            found.swap(at - 1, at);
        }
    }
    found
}

fn mode(spectrum: &Spectrum, position: usize) -> Option<ModeAtPoint> {
    let eigenvalue = *spectrum.eigenvalues().get(position)?;
    Some(ModeAtPoint {
        eigenvalue,
        error: spectrum.accuracies()[position].whole,
        verdict: spectrum.verdict_at(position),
    })
}
