//! How long builds with many inputs take: chains of 30, 50 and 100 masses with as many uncertain springs, all modes,
//! 100 model runs.
//!
//! `cargo run --release -p pcc-tools --bin many_inputs -- [INPUTS…]`

use pcc_compile::compilation::build;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use std::error::Error;
use std::time::Instant;

const RUNS: usize = 100;

/// Masses of 1 kg on springs of about 1 kN/m ± 5 %, with a little damping, the first fixed; flutter of the first two.
fn chain(inputs: usize) -> String {
    let row = |i: usize| {
        let above = if i + 1 < inputs { format!(" + k_{}", i + 2) } else { String::new() };
        let mut entries = vec!["0".to_owned(); i];
        entries.push(format!("k_{}{above}", i + 1));
        if i > 0 {
            entries[i - 1] = format!("-k_{}", i + 1);
        }
        format!("[{}]", entries.iter().map(|entry| format!("{entry:?}")).collect::<Vec<_>>().join(", "))
    };
    let rows: Vec<String> = (0..inputs).map(row).collect();
    let spring =
        |i: usize| format!("k_{} = {{ distribution = \"uniform\", nominal = {}, spread = 0.05 }}", i + 1, 1000 + 3 * i);
    let springs: Vec<String> = (0..inputs).map(spring).collect();
    let diagonal = |entry: &str| vec![entry; inputs].join(", ");
    format!(
        "format = 1\nname = \"chain-{inputs}\"\n[model]\nkind = \"matrices\"\nM = {{ diagonal = [{}] }}\nC = {{ diagonal = [{}] }}\n\
         K = {{ form = \"symmetric\", rows = [{}] }}\nN = {{ size = {inputs}, entries = [[1, 2, \"60\"], [2, 1, \"-60\"]] }}\n\
         [design]\nmaximum = {RUNS}\n[inputs]\n{}\n",
        diagonal("1"),
        diagonal("0.02"),
        rows.join(", "),
        springs.join("\n"),
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut inputs: Vec<usize> = std::env::args().skip(1).map(|word| word.parse()).collect::<Result<_, _>>()?;
    if inputs.is_empty() {
        inputs = vec![30, 50, 100];
    }
    println!("inputs  levels     seconds  estimated error of the proportion");
    for inputs in inputs {
        let study = Study::from_toml(&chain(inputs))?;
        let start = Instant::now();
        let surrogate = build(&study, &Silent)?;
        let levels: Vec<String> = surrogate.training.levels.iter().map(u64::to_string).collect();
        let error = surrogate.decision.proportion_error.map_or("none".to_owned(), |error| format!("{error:.1e}"));
        println!("{inputs:<6}  {:<9}  {:>7.1}  {error}", levels.join(" → "), start.elapsed().as_secs_f64());
    }
    Ok(())
}
