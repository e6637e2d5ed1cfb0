//! What laws of inputs cost in an evaluation.
//!
//! `cargo bench -p pcc-tools --bench laws` builds the clutch with eight inputs of every kind of law, all of the mean
//! and the variance of the uniform ones, and evaluates all surrogates on one thread, in turn and several times. Best
//! times are printed: other work on the machine can only slow one down. Surrogates differ in the number of their terms,
//! so the kernel alone is beside the whole; what is left is random numbers, quantiles and statistics.

use pcc::report::{Align, Table};
use pcc_compile::compilation::build;
use pcc_compile::study::Study;
use pcc_evaluate::evaluation::{BLOCK_POINTS, Plan, monte_carlo};
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::Surrogate;
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 7;
const SAMPLES: u64 = 2_000_000;
const BLOCKS: usize = 2_000;

/// Runs of every build, so that none is finer than others.
const RUNS: usize = 64;

/// Inputs beside the friction coefficient, with their nominal values.
const NOMINAL: [(&str, f64); 7] =
    [("k_p", 16e6), ("k_f", 7e6), ("gamma_1", 0.9), ("gamma_2", 0.8), ("r_1", 0.075), ("r_2", 0.12), ("l", 0.0125)];

/// A law with the mean and the variance of a uniform one between these bounds.
fn law(kind: &str, [lower, upper]: [f64; 2]) -> String {
    let (mean, std) = (0.5 * (lower + upper), (upper - lower) / 12f64.sqrt());
    let parameters = match kind {
        "uniform" => format!("lower = {lower:?}, upper = {upper:?}"),
        // Friction is not negative.
        "normal" if lower == 0.0 => format!("mean = {mean:?}, std = {std:?}, lower = 0.0"),
        "beta" => {
            let half = (5f64.sqrt() * std).min(mean);
            format!("alpha = 2.0, beta = 2.0, lower = {:?}, upper = {:?}", mean - half, mean + half)
        }
        _ => format!("mean = {mean:?}, std = {std:?}"),
    };
    format!("{{ distribution = \"{kind}\", {parameters} }}")
}

fn surrogate(kind: &str) -> Surrogate {
    let others: String =
        NOMINAL.iter().map(|(name, value)| format!("{name} = {}\n", law(kind, [0.95 * value, 1.05 * value]))).collect();
    let study = format!(
        "format = 1\nname = \"clutch\"\n[model]\nkind = \"clutch\"\n[inputs]\nmu = {}\n{others}[spectrum]\ntarget = \
         \"invariants\"\n[design]\nmaximum = {RUNS}\n",
        law(kind, [0.0, 0.5])
    );
    let study = Study::from_toml(&study).expect("the study is valid");
    build(&study, &Silent).expect("the clutch converges")
}

/// Seconds that `work` takes.
fn seconds<R>(work: impl FnOnce() -> R) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64()
}

fn main() {
    let kinds = ["uniform", "normal", "gamma", "beta", "lognormal"];
    let surrogates = kinds.map(surrogate);
    let thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut best = [[f64::INFINITY; 2]; 5];
    for _ in 0..ROUNDS {
        for (surrogate, [whole, kernel]) in surrogates.iter().zip(&mut best) {
            let plan = Plan::new(surrogate);
            let mut workspace = plan.workspace();
            let evaluated = || (0..BLOCKS).for_each(|_| plan.evaluate(0, black_box(&mut workspace)));
            *kernel = kernel.min(seconds(evaluated) / (BLOCKS * BLOCK_POINTS) as f64);
            let sampled = || thread.install(|| monte_carlo(surrogate, SAMPLES, 1, &Silent));
            *whole = whole.min(seconds(sampled) / SAMPLES as f64);
        }
    }
    let right = Align::Right;
    let mut table = Table::new(&[
        ("eight inputs", Align::Left),
        ("operations", right),
        ("kernel, ns per sample", right),
        ("whole", right),
        ("samples/s", right),
        ("of uniform ones", right),
    ]);
    for ((kind, surrogate), [whole, kernel]) in kinds.into_iter().zip(&surrogates).zip(best) {
        table.row([
            kind.to_owned(),
            Plan::new(surrogate).flops().to_string(),
            format!("{:.1}", 1e9 * kernel),
            format!("{:.1}", 1e9 * whole),
            format!("{:.3e}", 1.0 / whole),
            format!("{:.2}", best[0][0] / whole),
        ]);
    }
    println!("{table}");
}
