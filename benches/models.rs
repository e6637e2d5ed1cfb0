//! What models of the user's cost: matrices beside the built-in clutch, finite elements, programs.
//!
//! `cargo bench -p pcc-tools --bench models` prints one line per figure; ratios are of times taken in turn, in the same
//! process.

use pcc_compile::campaign::journal::Journal;
use pcc_compile::campaign::{Campaign, Ledger, Runner};
use pcc_compile::mechanics::model::Model;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// Rounds of which the median is taken.
const ROUNDS: usize = 21;

/// Runs of the program, and how many go on at once.
const PROGRAM_RUNS: u64 = 160;
const JOBS: usize = 8;

fn main() -> Result<(), Box<dyn Error>> {
    clutch_as_matrices()?;
    finite_elements()?;
    program()
}

fn shipped(name: &str) -> Result<Study, Box<dyn Error>> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("surrogates");
    Ok(Study::from_toml_in(&fs::read_to_string(folder.join(format!("{name}.toml")))?, &folder)?)
}

fn points(study: &Study, count: u64) -> Vec<Vec<f64>> {
    let standardized = random_points(&study.inputs, 1, Purpose::Evaluation, 0..count);
    standardized.iter().map(|point| study.inputs.physical(point)).collect()
}

fn time(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Runs of the clutch written as matrices, in multiples of the built-in one.
fn clutch_as_matrices() -> Result<(), Box<dyn Error>> {
    let (written, built_in) = (shipped("clutch-matrices")?, shipped("clutch-r8")?);
    let points = points(&written, 2000);
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for (what, derivatives) in [("values", false), ("values and 8 derivatives", true)] {
        let run = |study: &Study| {
            time(|| {
                one_thread.install(|| {
                    let runner = Runner::new(study).expect("the shipped study fits its model");
                    let runs = runner.with_derivatives(derivatives).run(&points, &Silent);
                    assert_eq!(runs.expect("the clutch converges").len(), points.len());
                });
            })
        };
        let pairs: Vec<(f64, f64)> = (0..ROUNDS).map(|_| (run(&written), run(&built_in))).collect();
        let [matrices, clutch] = [0, 1].map(|which| {
            median(pairs.iter().map(|pair| if which == 0 { pair.0 } else { pair.1 }).collect()) / points.len() as f64
        });
        let ratio = median(pairs.iter().map(|(a, b)| a / b).collect());
        println!(
            "clutch, {what}: {:.1} µs as matrices, {:.1} µs built in, {ratio:.2} times",
            1e6 * matrices,
            1e6 * clutch
        );
    }
    // Without the eigenvalues: what entries and state matrix cost.
    let (written, built_in) = (written.model()?, built_in.model()?);
    let linearize = |model: &dyn Model| {
        time(|| points.iter().for_each(|point| drop(model.linearization(point).expect("the clutch has masses"))))
    };
    let ratios = (0..ROUNDS).map(|_| linearize(&*written) / linearize(&*built_in)).collect();
    println!("clutch, state matrix and its derivatives alone: {:.2} times", median(ratios));
    Ok(())
}

/// A build on 200 degrees of freedom.
fn finite_elements() -> Result<(), Box<dyn Error>> {
    let study = shipped("block")?;
    let start = Instant::now();
    let surrogate = pcc_compile::compilation::build(&study, &Silent)?;
    let runs = surrogate.training.counts.direct_computations;
    println!(
        "block, 200 degrees of freedom, 4 inputs: built from {runs} runs in {:.1} s on {} threads",
        start.elapsed().as_secs_f64(),
        rayon::current_num_threads()
    );
    Ok(())
}

/// Throughput of a Python program that takes 0.2 s, against as many of its runs, taken alone, as go on at once. The
/// interpreter starts without the site's packages (-I -S), so that eight at once find processors enough; what is left
/// over is for pcc.
fn program() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let script = "import json, time\ntime.sleep(0.18)\np = json.load(open('params.json'))\n\
                  json.dump({'eigenvalues': [[p['mu'] - 0.3, 1.0]]}, open('results.json', 'w'))\n";
    fs::write(folder.path().join("model.py"), script)?;
    // The interpreter itself: a wrapper that looks for it can cost more than it.
    let asked = Command::new("python3").args(["-c", "import sys; print(sys.executable, end='')"]).output()?;
    let python = String::from_utf8(asked.stdout)?;
    let alone = run_program(&python, folder.path(), 1, 5)?.as_secs_f64() / 5.0;
    let together = run_program(&python, folder.path(), JOBS, PROGRAM_RUNS)?.as_secs_f64();
    let ideal = alone * PROGRAM_RUNS as f64 / JOBS as f64;
    println!(
        "Python program: {:.0} ms alone; {PROGRAM_RUNS} runs, {JOBS} at once, recorded one by one: {together:.2} s, {:.1} % of ideal \
         throughput",
        1e3 * alone,
        100.0 * ideal / together
    );
    Ok(())
}

fn run_program(python: &str, folder: &Path, jobs: usize, runs: u64) -> Result<Duration, Box<dyn Error>> {
    let work = folder.join(format!("runs-{jobs}"));
    let study = format!(
        "format = 1\nname = \"python\"\n[model]\nkind = \"command\"\ncommand = [{python:?}, \"-I\", \"-S\", \"{{study}}/model.py\"]\n\
         eigenvalues = 1\njobs = {jobs}\nwork = {work:?}\n[inputs]\n\
         mu = {{ distribution = \"uniform\", lower = 0.0, upper = 0.5 }}\n"
    );
    let study = Study::from_toml_in(&study, folder)?;
    let (journal, _) = Journal::open(&folder.join(format!("{jobs}.journal")))?;
    let ledger = Ledger::recording(&study, journal);
    let mut runner = Runner::new(Campaign { study: &study, ledger: Some(&ledger), counts_failures: false })?;
    let points = points(&study, runs);
    let start = Instant::now();
    runner.run(&points, &Silent)?;
    Ok(start.elapsed())
}
