//! How often certificates hold.
//!
//! `cargo run --release -p pcc-tools --bin certificate_coverage -- [NAME …] [--runs N] [--repetitions N]`: for each
//! study of `tests/data/wide` whose shares are known, a surrogate is built and certified again and again with other
//! seeds; a row has the number of certificates of which all bounds hold the true shares, at level 0.95.

use pcc_compile::compilation::build;
use pcc_compile::reference::certify_with_model;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use std::path::Path;

/// Stable and unstable share; the rest is marginal. By closed forms, structure, or `tests/data/wide/shares.py`.
const SHARES: [(&str, f64, f64); 12] = [
    ("wide", 0.5, 0.5),
    ("beam-20", 0.5, 0.5),
    ("machine", 0.3, 0.7),
    ("pen", 0.0, 0.0),
    ("undamped2", 0.0, 0.7103),
    ("undiv", 0.0, 7.0 / 24.0),
    ("chain-2", 0.0, 0.0),
    ("chain-5", 0.0, 0.0),
    ("chain-16", 0.0, 0.0),
    ("spin-2", 0.0, 0.47647),
    ("friction-2", 0.0, 0.700349),
    ("friction-4", 0.0, 0.40387),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut names, mut runs, mut repetitions) = (Vec::new(), 300, 100);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--runs" => runs = arguments.next().unwrap_or_default().parse()?,
            "--repetitions" => repetitions = arguments.next().unwrap_or_default().parse()?,
            name => names.push(name.to_owned()),
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/wide");
    println!("study certificates held");
    for (name, stable, unstable) in SHARES {
        if !names.is_empty() && !names.iter().any(|wanted| wanted == name) {
            continue;
        }
        let text = std::fs::read_to_string(folder.join(format!("{name}.toml")))?;
        let study = Study::from_toml_in(&text, &folder)?;
        let surrogate = build(&study, &Silent)?;
        let mut held = 0;
        for seed in 1..=repetitions {
            let certificate = certify_with_model(&surrogate, &study, runs, seed, 0.95, &Silent)?;
            let holds = |[lower, upper]: [f64; 2], share: f64| lower <= share && share <= upper;
            let others = certificate.marginal.is_none_or(|bounds| {
                holds(bounds.marginal, 1.0 - stable - unstable) && holds(bounds.unstable, unstable)
            });
            held += u64::from(others && holds([certificate.lower, certificate.upper], stable));
        }
        println!("{name} {repetitions} {held}");
    }
    Ok(())
}
