//! Builds the studies of `tests/data/field`, or of another folder, with their defaults and compares each surrogate with
//! its model.
//!
//! `cargo run --release -p pcc-tools --bin field_cases -- [NAME …] [--folder FOLDER] [--points N] [--seeds N]`: a row
//! per study and seed with model runs, seconds of the build, share of misclassified points, stable, flutter and
//! divergence shares of both, the true over the estimated error, and the groups.

use pcc_compile::compilation::build;
use pcc_compile::reference::ModelSample;
use pcc_compile::study::Study;
use pcc_evaluate::components::Verdict;
use pcc_evaluate::foundation::Silent;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut names, mut points, mut seeds) = (Vec::new(), 100_000, 5);
    let mut folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/field");
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--folder" => folder = arguments.next().unwrap_or_default().into(),
            "--points" => points = arguments.next().unwrap_or_default().parse()?,
            "--seeds" => seeds = arguments.next().unwrap_or_default().parse()?,
            name => names.push(name.to_owned()),
        }
    }
    if names.is_empty() {
        let studies = std::fs::read_dir(&folder)?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        names = studies.filter_map(|name| name.strip_suffix(".toml").map(str::to_owned)).collect();
        names.sort();
    }
    println!(
        "study seed runs seconds derivatives misclassified% stable% marginal% unstable% flutter% divergence% model:"
    );
    for name in names {
        let text = std::fs::read_to_string(folder.join(format!("{name}.toml")))?;
        let study = Study::from_toml_in(&text, &folder)?;
        let sample = ModelSample::new(&study, points, 1000, &Silent)?;
        for seed in 1..=seeds {
            let seeded = Study { seed, ..study.clone() };
            let start = Instant::now();
            let surrogate = match build(&seeded, &Silent) {
                Ok(surrogate) => surrogate,
                Err(error) => {
                    println!("{name} {seed} {error}");
                    continue;
                }
            };
            let seconds = start.elapsed().as_secs_f64();
            let comparison = sample.compare(&surrogate)?;
            let block = sample.surrogate_at(&surrogate, points as usize)?;
            let share = |verdict: Verdict| {
                let found = (0..points as usize).filter(|&sample| block.top(sample).verdict() == verdict).count();
                100.0 * found as f64 / points as f64
            };
            let [marginal, unstable] = [comparison.marginal(), comparison.unstable()];
            let off = (unstable[0] - unstable[1]).abs() / (1.0 - unstable[1]);
            let ratio = surrogate.decision.proportion_error.map_or(f64::NAN, |error| off / error);
            let groups: Vec<&str> = surrogate.outputs.iter().map(|output| output.name.as_str()).collect();
            println!(
                "{name} {seed} {} {seconds:.2} {} {:.4} {:.3} {:.3} {:.3} {:.3} {:.3} model: {:.3} {:.3} {:.3} \
                 true/estimated {ratio:.2} undamped {} tolerance {:.1e} [{}]",
                surrogate.training.counts.direct_computations,
                surrogate.training.counts.gradients,
                comparison.misclassified_percent(),
                100.0 * comparison.proportion_surrogate(),
                100.0 * marginal[1],
                100.0 * unstable[1],
                share(Verdict::Flutter),
                share(Verdict::Divergence),
                100.0 * comparison.proportion_model(),
                100.0 * marginal[0],
                100.0 * unstable[0],
                surrogate.is_undamped(),
                surrogate.verdict.tolerance,
                groups.join(" | "),
            );
        }
    }
    Ok(())
}
