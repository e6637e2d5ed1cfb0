//! A build whose model something else runs: `cargo run --release --example ask_and_tell`.
//!
//! pcc asks for points, somebody answers, until nothing is missing. Here the somebody is a function; it could be a
//! cluster, or a laboratory. What is answered is in the journal at once, so the program can be stopped at any point and
//! started again.

use nalgebra::{Complex, dmatrix};
use pcc::{Books, Journal, Recording, ResultRow, Silent, Study, ask, build, monte_carlo, tell};

const STUDY: &str = r#"
format = 1
name = "oscillators"

[model]
kind = "table"
eigenvalues = 4

[inputs]
mu = { distribution = "uniform", lower = 0.0, upper = 0.5 }
k  = { distribution = "uniform", nominal = 100.0, spread = 0.1 }
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let study = Study::from_toml(STUDY)?;
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("oscillators.journal");
    loop {
        let (journal, contents) = Journal::open(&file)?;
        let step = ask(&study, &contents, &Silent)?;
        if step.is_complete {
            break;
        }
        let rows: Vec<ResultRow> =
            step.open().map(|(run, point)| ResultRow::answer(run, point, eigenvalues(point[0], point[1]))).collect();
        let told = tell(&study, &journal, contents, &rows, false, &Silent)?;
        println!("{} answers, {} points wait", told.answered, told.missing);
    }
    let recording = Recording { journal: Some(file), ..Recording::default() };
    let books = Books::of_build(&study, &recording, folder.path())?;
    let surrogate = build(books.campaign(&study), &Silent)?;
    let stable = monte_carlo(&surrogate, 1_000_000, 1, &Silent)?.stable_proportion();
    println!("stable in {:.2} % of cases", 100.0 * stable.value());
    Ok(())
}

/// The machine that answers: two masses on a belt.
fn eigenvalues(mu: f64, k: f64) -> Vec<Complex<f64>> {
    let state_matrix = dmatrix![
        0.0, 0.0, 1.0, 0.0;
        0.0, 0.0, 0.0, 1.0;
        -k - 20.0, 40.0 * mu, -0.1, 0.0;
        -40.0 * mu, -k, 0.0, -0.1
    ];
    state_matrix.complex_eigenvalues().iter().copied().collect()
}
