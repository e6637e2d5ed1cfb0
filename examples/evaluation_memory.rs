//! Samples per second and peak memory of a long evaluation (Linux).
//!
//! `cargo run --release --example evaluation_memory -- [SAMPLES]` samples the shipped r = 8 surrogate, by default 10⁸ times.

use pcc::artifact::decode;
use pcc::eval::monte_carlo;
use pcc::progress::Silent;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let samples: u64 = std::env::args().nth(1).map_or(Ok(100_000_000), |argument| argument.parse())?;
    let surrogate = decode(include_bytes!("../surrogates/clutch-r8-eigenvalues.pcc"))?.surrogate;
    let start = Instant::now();
    let summary = monte_carlo(&surrogate, samples, 1, &Silent)?;
    let seconds = start.elapsed().as_secs_f64();
    println!("{samples} samples, {} stable, {:.2e} samples/s", summary.stable, samples as f64 / seconds);
    let status = std::fs::read_to_string("/proc/self/status")?;
    let peak = status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("VmHWM: not reported here");
    println!("peak memory {}", peak.trim_start_matches("VmHWM:").trim());
    Ok(())
}
