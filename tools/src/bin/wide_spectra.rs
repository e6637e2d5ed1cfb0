//! Digits of eigenvalues, and what cannot be told from zero.
//!
//! `cargo run --release -p pcc-tools --bin wide_spectra` prints three tables:
//!
//! 1. beams of 20, 80 and 200 elements on soft springs and free, and a machine on soft mounts: the largest relative
//!    error of λ and of Re λ against the 40-digit values of `tests/data/wide`, the number of rigid-body eigenvalues,
//!    and whether the run has derivatives;
//! 2. undamped chains and gyroscopic systems of 2 to 300 degrees of freedom, whose Re λ is zero: the largest |Re λ|
//!    over its tolerance, and the median tolerance over the largest |Re λ|, both as the solver leaves them;
//! 3. the clutch: the number of marginal points among a million direct computations.

use nalgebra::{Complex, DMatrix};
use pcc_compile::campaign::Runner;
use pcc_compile::mechanics::model::SecondOrder;
use pcc_compile::numerics::eigenvalues::SchurForm;
use pcc_compile::reference::monte_carlo;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::random::{Purpose, Stream};
use std::path::{Path, PathBuf};
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    println!("system error_of_lambda error_of_re rigid_body_modes derivatives seconds");
    for (name, file) in [
        ("beam-20", "eigenvalues_20"),
        ("beam-80", "eigenvalues_80"),
        ("beam-200", "eigenvalues_200"),
        ("machine", "eigenvalues_machine"),
        ("beam-20-free", "eigenvalues_free_20"),
        ("beam-80-free", "eigenvalues_free_80"),
        ("beam-200-free", "eigenvalues_free_200"),
    ] {
        against_forty_digits(name, file)?;
    }
    println!("\nsystem n largest_re/tolerance median_tolerance/largest_re");
    for size in [2, 4, 8, 16, 30, 60, 100, 200, 300] {
        tolerances("chain", size, &undamped(size, false))?;
        tolerances("gyroscopic", size, &undamped(size, true))?;
    }
    let study = Study::from_toml(include_str!("../../../surrogates/clutch-r8.toml"))?;
    let found = monte_carlo(&study, 1_000_000, 1, &Silent)?.summary;
    println!("\nclutch: {} of {} points are marginal", found.marginal(), found.samples());
    Ok(())
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/wide")
}

fn against_forty_digits(name: &str, file: &str) -> Result<(), Failure> {
    let read = |name: String| std::fs::read_to_string(folder().join(name));
    let study = Study::from_toml_in(&read(format!("{name}.toml"))?, &folder())?;
    let points = read("points.csv".to_owned())?;
    let value = |input: &str| -> Result<f64, Failure> {
        let start = format!("{name},{input},");
        let cell = points.lines().find_map(|line| line.strip_prefix(&start)).ok_or("no such value")?;
        Ok(cell.parse()?)
    };
    let point: Vec<f64> = study.inputs.names().map(value).collect::<Result<_, _>>()?;
    let start = Instant::now();
    let mut runner = Runner::new(&study)?.without_ranks().with_derivatives(true);
    let run = runner.run(&[point], &Silent)?.remove(0);
    let seconds = start.elapsed().as_secs_f64();
    let (mut whole, mut re, mut rank) = (0.0f64, 0.0f64, 0);
    for line in read(format!("{file}.csv"))?.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').skip(1).map(str::parse).collect::<Result<_, _>>()?;
        if cells[1] > 0.0 {
            let (found, expected) = (run.spectrum.oscillating()[rank], Complex::new(cells[0], cells[1]));
            whole = whole.max((found - expected).norm() / expected.norm());
            re = re.max((found.re - expected.re).abs() / expected.re.abs());
            rank += 1;
        }
    }
    let has_derivatives = run.reductions.is_some_and(|reductions| !reductions.systems.is_empty());
    let rigid = run.spectrum.rigid_body_modes();
    println!("{name} {whole:.1e} {re:.1e} {rigid} {has_derivatives} {seconds:.2}");
    Ok(())
}

/// A system that neither grows nor decays: a chain with springs and masses over two decades, or one whose masses are
/// coupled by gyroscopic forces besides.
fn undamped(size: usize, is_gyroscopic: bool) -> SecondOrder {
    let mut stream = Stream::new(size as u64, Purpose::Design, u64::from(is_gyroscopic));
    let mut decade = || 10f64.powf(2.0 * stream.next_unit());
    let mass = DMatrix::from_fn(size, size, |i, j| if i == j { decade() } else { 0.0 });
    let mut stiffness = DMatrix::zeros(size, size);
    for i in 0..size {
        let spring = 1e3 * decade();
        stiffness[(i, i)] += spring;
        if i > 0 {
            stiffness[(i - 1, i - 1)] += spring;
            stiffness[(i, i - 1)] -= spring;
            stiffness[(i - 1, i)] -= spring;
        }
    }
    let mut damping = DMatrix::zeros(size, size);
    if is_gyroscopic {
        for i in 0..size {
            for j in 0..i {
                damping[(i, j)] = decade() - 10.0;
                damping[(j, i)] = -damping[(i, j)];
            }
        }
    }
    SecondOrder { mass, damping, stiffness }
}

fn tolerances(name: &str, size: usize, system: &SecondOrder) -> Result<(), Failure> {
    let schur = SchurForm::new(system.state_matrix()?)?;
    let positions: Vec<usize> = (0..2 * size).collect();
    let (lambdas, accuracies) = (schur.eigenvalues(), schur.accuracies(&positions));
    let pairs = || lambdas.iter().zip(&accuracies);
    let worst = pairs().map(|(lambda, accuracy)| lambda.re.abs() / accuracy.re).fold(0.0, f64::max);
    let largest = lambdas.iter().map(|lambda| lambda.re.abs()).fold(0.0, f64::max);
    let mut sorted: Vec<f64> = accuracies.iter().map(|accuracy| accuracy.re).collect();
    sorted.sort_by(f64::total_cmp);
    println!("{name} {size} {worst:.3} {:.1}", sorted[size] / largest);
    Ok(())
}
