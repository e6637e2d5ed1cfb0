//! Stability over an input: `cargo run --release --example sweep [SURROGATE] [INPUT]`.

use pcc::{InstructionSet, Request, Session, Silent, Surrogate, Sweep};

/// Values of the input.
const POINTS: u32 = 21;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().unwrap_or_else(|| "surrogates/clutch-r8.pcc".to_owned());
    let name = arguments.next().unwrap_or_else(|| "mu".to_owned());
    let surrogate = Surrogate::read(&file)?;
    let inputs = surrogate.inputs.inputs();
    let input = inputs.iter().find(|input| input.name == name).ok_or(format!("{file} has no input {name}"))?;
    let (from, to) = (input.marginal.physical(-1.0), input.marginal.physical(1.0));

    let sweep = Sweep { input: name, from, to, points: POINTS };
    let request = Request { sweeps: vec![sweep], ..Request::plain(100_000, 1) };
    let question = request.question(&surrogate)?;
    let found = Session::new(&surrogate, &question, None, InstructionSet::best())?.run(&Silent)?;

    for (k, cell) in found.answer.cells.iter().enumerate() {
        let value = from + (to - from) * k as f64 / f64::from(POINTS - 1);
        let stable = cell.share(0.95, |tally| tally.summary.stable).value;
        println!("{value:12.4} {:7.2} % {}", 100.0 * stable, "█".repeat((40.0 * stable) as usize));
    }
    Ok(())
}
