//! Time and peak memory of whole evaluations, from a million samples to a billion (Linux).
//!
//! `cargo build --release && cargo run --release -p pcc-tools --bin evaluation_scaling -- [LARGEST]` runs `pcc eval` on
//! the shipped surrogate with eight inputs as a user would, start to end, by default up to 10⁹ samples: about two
//! minutes on two cores.

use pcc::report::{Align, Table};
use pcc_evaluate::foundation::count;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const SURROGATE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../surrogates/clutch-r8.pcc");

/// Samples of the run that start-up is measured by: from here on nothing but the number of samples grows (Sobol'
/// indices take as many).
const FEW: u64 = 16_384;

/// Repetitions of short runs: other work on the machine can only slow one down.
const REPETITIONS: usize = 15;

/// Seconds and peak memory in KiB of one evaluation, start to end.
fn evaluate(pcc: &Path, samples: u64) -> Result<(f64, u64), Box<dyn std::error::Error>> {
    let start = Instant::now();
    let mut child = Command::new(pcc)
        .args(["eval", SURROGATE, "--json", "--quiet", "-n", &samples.to_string()])
        .stdout(Stdio::null())
        .spawn()?;
    let status = PathBuf::from(format!("/proc/{}/status", child.id()));
    let mut peak = 0;
    // The system keeps the peak; the last reading before the end is that of all the run but some milliseconds.
    loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let found = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
        peak = peak.max(found.unwrap_or(0));
        if let Some(status) = child.try_wait()? {
            let seconds = start.elapsed().as_secs_f64();
            return if status.success() { Ok((seconds, peak)) } else { Err("pcc eval failed".into()) };
        }
        std::thread::sleep(Duration::from_micros(500));
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let largest: f64 = std::env::args().nth(1).map_or(Ok(1e9), |argument| argument.parse())?;
    let pcc = std::env::current_exe()?.with_file_name("pcc").canonicalize()?;
    let best = |samples: u64, repetitions: usize| -> Result<(f64, u64), Box<dyn std::error::Error>> {
        let mut best = (f64::INFINITY, 0);
        for _ in 0..repetitions {
            let (seconds, peak) = evaluate(&pcc, samples)?;
            best = (best.0.min(seconds), best.1.max(peak));
        }
        Ok(best)
    };
    let (start_up, _) = best(FEW, REPETITIONS)?;
    let mut runs = Vec::new();
    let mut samples = 1e6;
    while samples <= largest {
        let repetitions = (REPETITIONS as f64 * 1e7 / samples).clamp(1.0, REPETITIONS as f64) as usize;
        runs.push((samples, best(samples as u64, repetitions)?));
        samples *= 10.0;
    }
    let last = runs.last().map_or(1.0, |(samples, (seconds, _))| (seconds - start_up) / (samples - FEW as f64));
    let right = Align::Right;
    let mut table = Table::new(&[
        ("samples", right),
        ("seconds", right),
        ("ns per sample, without start-up", right),
        ("relative to the last", right),
        ("peak memory, MB", right),
    ]);
    for (samples, (seconds, peak)) in &runs {
        let each = (seconds - start_up) / (samples - FEW as f64);
        table.row([
            count(*samples as u64),
            format!("{seconds:.3}"),
            format!("{:.2}", 1e9 * each),
            format!("{:.3}", each / last),
            format!("{:.1}", *peak as f64 * 1024.0 / 1e6),
        ]);
    }
    println!("start-up, with {} samples: {:.1} ms\n{table}", count(FEW), 1e3 * start_up);
    Ok(())
}
