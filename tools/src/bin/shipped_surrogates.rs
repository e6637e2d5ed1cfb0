//! Rebuilds what is shipped: `schemas/` and, beside every study in `surrogates/`, its `.pcc` and `.json`.
//!
//! `cargo run --release -p pcc-tools --bin shipped_surrogates` writes them, with `-- --schemas` the schemas alone; with
//! `-- --check` it compares instead, and fails if a schema differs, if a surrogate has other index sets or coefficients
//! beyond the tolerance between machines, or if the two forms of a surrogate differ.

use pcc_compile::study::Study;
use pcc_evaluate::artifact::{Format, decode, encode, read};
use pcc_evaluate::foundation::{Silent, save};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let check = std::env::args().any(|argument| argument == "--check");
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    for (name, text) in pcc_tools::schemas() {
        let path = root.join("schemas").join(name);
        if !check {
            save(&path, text.as_bytes())?;
        } else if fs::read_to_string(&path)? != text {
            return Err(format!("{} is not up to date", path.display()).into());
        }
        println!("{}", path.display());
    }
    if std::env::args().any(|argument| argument == "--schemas") {
        return Ok(());
    }

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
