//! Estimated against true errors of the stability proportion, over inputs, seeds and sizes.
//!
//! `cargo run --release -p pcc-tools --bin decision_estimate -- [POINTS]` builds every level of every design
//! separately, with derivatives and with values alone, and compares it with the model on POINTS points, 100 000 by
//! default. One point is 0.005 % of the clutch's proportion; ratios of errors below a few of them are noise and left
//! out of the summary.

use pcc_compile::reference::compare_with_model;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use std::error::Error;

const SEEDS: std::ops::RangeInclusive<u64> = 1..=8;
const LEVELS: usize = 4;

fn main() -> Result<(), Box<dyn Error>> {
    let points = std::env::args().nth(1).map_or(Ok(100_000), |argument| argument.parse())?;
    println!("r  seed   runs  estimated %    true %  misclassified %");
    for (name, more, levels) in
        [("with derivatives", "", LEVELS), ("values alone", "[fit]\nderivatives = false\n", LEVELS - 1)]
    {
        println!("{name}");
        summarize(ratios(more, levels, points)?);
    }
    Ok(())
}

/// True by estimated errors.
fn ratios(more: &str, levels: usize, points: u64) -> Result<Vec<f64>, Box<dyn Error>> {
    let mut ratios = Vec::new();
    for inputs in [3, 5, 8] {
        let path = format!("{}/../surrogates/clutch-r{inputs}.toml", env!("CARGO_MANIFEST_DIR"));
        let mut study = Study::from_toml(&(std::fs::read_to_string(path)? + more))?;
        study.fit.proportion_tolerance = Some(1e-5);
        for (seed, level) in SEEDS.flat_map(|seed| (2..=levels).map(move |level| (seed, level))) {
            study.seed = seed;
            study.design.maximum = level * study.design.initial;
            let surrogate = pcc_compile::compilation::build(&study, &Silent)?;
            // Small designs have too few points that nothing was tuned on.
            let Some(estimate) = surrogate.decision.proportion_error.map(|share| 100.0 * share) else { continue };
            let comparison = compare_with_model(&surrogate, &study, points, seed, &Silent)?;
            let truth = comparison.relative_error_percent().ok_or("never stable")?;
            let runs = surrogate.training.counts.direct_computations;
            let misclassified = comparison.misclassified_percent();
            println!("{inputs}  {seed:4}  {runs:5}  {estimate:11.4}  {truth:8.4}  {misclassified:15.4}");
            let resolution = 300.0 / (comparison.proportion_model() * comparison.samples as f64);
            if estimate.max(truth) > resolution {
                ratios.push(truth / estimate);
            }
        }
    }
    Ok(ratios)
}

fn summarize(mut ratios: Vec<f64>) {
    ratios.sort_by(f64::total_cmp);
    let at = |share: f64| ratios[((ratios.len() - 1) as f64 * share).round() as usize];
    println!(
        "true/estimated of {} builds: median {:.2}, 10 to 90 %: {:.2} to {:.2}, largest {:.2}",
        ratios.len(),
        at(0.5),
        at(0.1),
        at(0.9),
        at(1.0)
    );
}
