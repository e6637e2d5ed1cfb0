//! Surrogates by invariants against the model on the same points, over the seeds 1 to 5, sizes chosen by the tool.
//!
//! `cargo run --release --example invariants_table -- [POINTS] [INPUTS…]` prints one row per number of inputs and seed,
//! then the row with 8 inputs and `proportion_tolerance = 1e-4` on ten times as many points, and the paper's method with
//! ten times the runs.

use pcc::progress::Silent;
use pcc::reference::compare;
use pcc::study::Study;
use std::error::Error;
use std::time::Instant;

/// Inputs, most model runs, largest error of the proportion and share of misclassified points in percent.
const BARS: [(usize, u64, f64, f64); 5] =
    [(1, 40, 0.0, 0.0), (2, 40, 0.0, 0.0), (3, 60, 0.01, 0.002), (5, 120, 0.05, 0.05), (8, 240, 0.12, 0.1)];

fn main() -> Result<(), Box<dyn Error>> {
    let numbers: Vec<u64> = std::env::args().skip(1).map(|argument| argument.parse()).collect::<Result<_, _>>()?;
    let points = numbers.first().copied().unwrap_or(100_000);
    let asked = |inputs: usize| numbers.len() < 2 || numbers[1..].contains(&(inputs as u64));
    println!(
        " r  seed   runs  error %  estimated %  misclassified %  build s   at most: runs, error %, misclassified %"
    );
    let mut all_hold = true;
    for (inputs, runs, error, misclassified) in BARS.into_iter().filter(|bar| asked(bar.0)) {
        let study = study(&format!("clutch-r{inputs}"))?;
        all_hold &= rows(&study, points, (runs, error, misclassified))?;
    }
    if asked(8) {
        let mut study = study("clutch-r8")?;
        println!("proportion_tolerance = 1e-4, {} points", 10 * points);
        study.fit.proportion_tolerance = Some(1e-4);
        all_hold &= rows(&study, 10 * points, (500, 0.03, 0.01))?;
        println!("eigenvalue components, ten times the runs");
        study = self::study("clutch-r8-eigenvalues")?;
        study.design.initial = 2400;
        rows(&study, points, (u64::MAX, f64::INFINITY, f64::INFINITY))?;
    }
    println!("{}", if all_hold { "every row holds" } else { "NOT every row holds" });
    Ok(())
}

fn study(name: &str) -> Result<Study, Box<dyn Error>> {
    let path = format!("{}/surrogates/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Ok(Study::from_toml(&std::fs::read_to_string(path)?)?)
}

fn rows(study: &Study, points: u64, bar: (u64, f64, f64)) -> Result<bool, Box<dyn Error>> {
    let mut study = study.clone();
    let mut all_hold = true;
    for seed in 1..=5 {
        study.seed = seed;
        let start = Instant::now();
        let surrogate = pcc::build::build(&study, &Silent)?;
        let seconds = start.elapsed().as_secs_f64();
        let comparison = compare(&surrogate, &study, points, 1, &Silent)?;
        let runs = surrogate.training.counts.direct_computations;
        let error = comparison.relative_error_percent().ok_or("the model is never stable")?;
        let misclassified = comparison.misclassified_percent();
        let holds = runs <= bar.0 && error <= bar.1 && misclassified <= bar.2;
        all_hold &= holds;
        let estimated = surrogate.decision.proportion_error.map_or("–".to_owned(), |e| format!("{:.4}", 100.0 * e));
        println!(
            "{:2}  {seed:4}  {runs:5}  {error:7.4}  {estimated:>11}  {misclassified:15.4}  {seconds:7.2}   {}, {}, {}{}",
            study.inputs.dimension(),
            if bar.0 == u64::MAX { "–".to_owned() } else { bar.0.to_string() },
            bar.1,
            bar.2,
            if holds { "" } else { "  exceeded" },
        );
    }
    Ok(all_hold)
}
