//! Rebuilds what is shipped: `schemas/` and, beside every study in `surrogates/`, its `.pcc` and `.json`.
//!
//! `cargo run --release -p pcc-tools --bin shipped_surrogates` writes them; with `-- --check` it compares instead, and
//! fails if the schema differs, if a surrogate has other index sets or coefficients beyond the tolerance between
//! machines, or if the two forms of a surrogate differ.

use pcc_compile::study::Study;
use pcc_evaluate::artifact::{Format, decode, encode, read, schema};
use pcc_evaluate::foundation::{Silent, save};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let check = std::env::args().any(|argument| argument == "--check");
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let schema_path = root.join("schemas/surrogate.v1.schema.json");
    if !check {
        save(&schema_path, schema().as_bytes())?;
    } else if fs::read_to_string(&schema_path)? != schema() {
        return Err(format!("{} is not up to date", schema_path.display()).into());
    }
    println!("{}", schema_path.display());

    let mut studies: Vec<PathBuf> = fs::read_dir(root.join("surrogates"))?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<_, _>>()?;
    studies.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    studies.sort();
    for path in studies {
        let study = Study::from_toml_in(&fs::read_to_string(&path)?, &root.join("surrogates"))?;
        let surrogate = pcc_compile::compilation::build(&study, &Silent)?;
        let (binary, json) = (path.with_extension("pcc"), path.with_extension("json"));
        if check {
            let shipped = read(&binary)?.surrogate;
            surrogate.agrees_with(&shipped).map_err(|error| format!("{}: {error}", binary.display()))?;
            if decode(&fs::read(&json)?)?.surrogate != shipped {
                return Err(format!("{} differs from its binary form", json.display()).into());
            }
        } else {
            save(&binary, &encode(&surrogate, Format::Binary)?)?;
            save(&json, &encode(&surrogate, Format::Json)?)?;
        }
        println!("{}: {} model runs", path.display(), surrogate.training.counts.direct_computations);
    }
    println!("{}", if check { "everything shipped is up to date" } else { "written" });
    Ok(())
}
