//! How often intervals at points hold what the model answers.
//!
//! `cargo run --release -p pcc-tools --bin interval_coverage -- [NAME …] [--seeds N] [--points N] [--level LEVEL]`:
//! builds each shipped study under seeds 1 to N (3) and asks it for intervals at POINTS fresh points (2 000). A row has
//! the study, the seed, runs left out, the share of points whose max Re λ lies in its interval, the same of the tenth
//! with the smallest |max Re λ|, the smallest such share of a part of an eigenvalue, and the median half-width of max
//! Re λ over its median error.

use nalgebra::Complex;
use pcc_compile::compilation::build;
use pcc_compile::reference::PointReference;
use pcc_compile::study::Study;
use pcc_evaluate::evaluation::{IntervalLevel, Plan, evaluate_points, point_intervals};
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use std::error::Error;
use std::path::Path;

const NAMES: [&str; 4] = ["clutch-r3", "clutch-r8", "flutter", "rotor"];

fn main() -> Result<(), Box<dyn Error>> {
    let (mut names, mut seeds, mut points) = (Vec::new(), 3, 2000);
    let mut level: IntervalLevel = "0.9".parse()?;
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--seeds" => seeds = arguments.next().unwrap_or_default().parse()?,
            "--points" => points = arguments.next().unwrap_or_default().parse()?,
            "--level" => level = arguments.next().unwrap_or_default().parse()?,
            name => names.push(name.to_owned()),
        }
    }
    if names.is_empty() {
        names = NAMES.map(str::to_owned).to_vec();
    }
    println!("study seed left-out max_re near-boundary eigenvalues half-width/error");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../surrogates");
    for name in names {
        let study = Study::from_toml_in(&std::fs::read_to_string(folder.join(format!("{name}.toml")))?, &folder)?;
        for seed in 1..=seeds {
            row(&name, &Study { seed, ..study.clone() }, points, level)?;
        }
    }
    Ok(())
}

fn row(name: &str, study: &Study, points: u64, level: IntervalLevel) -> Result<(), Box<dyn Error>> {
    let surrogate = build(study, &Silent)?;
    let left_out = surrogate.left_out.as_ref().ok_or("no residuals of runs left out")?;
    let standardized = random_points(&surrogate.inputs, 77, Purpose::Evaluation, 0..points);
    let physical: Vec<Vec<f64>> = standardized.iter().map(|point| study.inputs.physical(point)).collect();
    let mut reference = PointReference::new(study)?;
    let answers = reference.run(&physical, &Silent)?;
    let references: Vec<&[f64]> = standardized.iter().map(Vec::as_slice).collect();
    let block = evaluate_points(&surrogate, &Plan::new(&surrogate), &references);
    let intervals = point_intervals(&surrogate, left_out, &block, level, &Silent)?;
    let holds = |[lower, upper]: [f64; 2], value: f64| lower <= value && value <= upper;
    let max_re: Vec<bool> = answers.iter().zip(&intervals).map(|(a, own)| holds(own.max_re, a.top.max_re)).collect();
    let share = |list: &[bool]| list.iter().filter(|held| **held).count() as f64 / list.len() as f64;
    let mut nearest: Vec<usize> = (0..answers.len()).collect();
    nearest.sort_by(|&a, &b| answers[a].top.max_re.abs().total_cmp(&answers[b].top.max_re.abs()));
    let near: Vec<bool> = nearest[..answers.len() / 10].iter().map(|&i| max_re[i]).collect();
    let mut least: f64 = 1.0;
    for (at, list) in block.eigenvalues.iter().enumerate() {
        for part in 0..2 {
            let held = answers.iter().enumerate().map(|(i, answer)| {
                // Numbers follow the order inside a group, and identity in the reference.
                let distance = |lambda: &&Complex<f64>| (**lambda - list[i]).norm();
                let nearest = answer.eigenvalues.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                let there = nearest.map_or(f64::NAN, |lambda| if part == 0 { lambda.re } else { lambda.im });
                holds(intervals[i].eigenvalues[at][part], there)
            });
            let covered = share(&held.collect::<Vec<_>>());
            least = least.min(covered);
        }
    }
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let width = median(intervals.iter().map(|own| (own.max_re[1] - own.max_re[0]) / 2.0).collect());
    let error = median(answers.iter().zip(&block.max_re).map(|(a, found)| (a.top.max_re - found).abs()).collect());
    println!(
        "{name} {} {} {:.3} {:.3} {least:.3} {:.1}",
        study.seed,
        left_out.runs().len(),
        share(&max_re),
        share(&near),
        width / error
    );
    Ok(())
}
