//! A surrogate file, sampled: `cargo run --release --example evaluate_file [SURROGATE]`.

use pcc::{InstructionSet, Request, Sampler, Session, Silent, Surrogate};

fn main() -> Result<(), pcc::Error> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "surrogates/clutch-r8.pcc".to_owned());
    let surrogate = Surrogate::read(&file)?;
    println!("{file}: modes {:?} over {} inputs", surrogate.modes(), surrogate.inputs.dimension());

    // What `pcc eval -n 262144 --sampler sobol` asks.
    let request = Request { sampler: Sampler::Sobol, ..Request::plain(262_144, 1) };
    let question = request.question(&surrogate)?;
    let found = Session::new(&surrogate, &question, None, InstructionSet::best())?.run(&Silent)?;

    let share = found.answer.cells[0].share(0.95, |tally| tally.summary.stable);
    println!("stable in {:.3} % of cases, by sampling ± {:.3}", 100.0 * share.value, 100.0 * share.standard_error);
    let of_stability = found.sensitivities.as_ref().and_then(|all| all.stability.as_ref());
    for (name, index) in surrogate.inputs.names().zip(of_stability.into_iter().flatten()) {
        println!("{name:8} decides {:3.0} % of that, alone or with others", 100.0 * index.total.value);
    }
    Ok(())
}
