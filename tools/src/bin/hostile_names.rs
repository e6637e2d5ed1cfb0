//! Writes a surrogate whose names try to be markup, to check that pages show them as text.
//!
//! `cargo run --release -p pcc-tools --bin hostile_names -- OUT.json`

use pcc_evaluate::artifact::{Format, encode, read};
use pcc_evaluate::foundation::save;
use pcc_evaluate::probability::inputs::{Description, InputSpace};
use std::error::Error;
use std::path::Path;

const HOSTILE: &str = "</script><img src=x onerror=alert(1)>";

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).ok_or("name the file to write")?;
    let shipped = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("surrogates/clutch-r2.pcc");
    let mut surrogate = read(&shipped)?.surrogate;
    surrogate.provenance.study_name = HOSTILE.to_owned();
    let mut inputs = surrogate.inputs.inputs().to_vec();
    let shown = Description::default().with_unit(HOSTILE)?.with_label(HOSTILE)?;
    for input in &mut inputs {
        input.name.push_str(HOSTILE);
        input.description = shown.clone();
    }
    surrogate.inputs = InputSpace::new(inputs)?;
    for output in &mut surrogate.outputs {
        output.name.push_str(HOSTILE);
        output.components.iter_mut().for_each(|component| component.name.push_str(HOSTILE));
    }
    save(Path::new(&out), &encode(&surrogate, Format::Json)?)?;
    println!("{out}");
    Ok(())
}
