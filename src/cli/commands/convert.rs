//! `pcc convert`

use super::super::arguments::Convert;
use super::super::{Context, Ending};
use super::{keep_inputs, keep_other_files, read_surrogate};
use anyhow::bail;
use pcc_evaluate::artifact::version::{Compatibility, compatibility};
use pcc_evaluate::artifact::{Artifact, Format, encode};
use pcc_evaluate::foundation::save;
use serde::Serialize;
use std::fmt;
use std::path::Path;

pub(in super::super) fn convert(context: &Context, options: &Convert) -> anyhow::Result<Ending> {
    let artifact = read_surrogate(&options.input)?;
    refuse_lossy(&artifact, &options.input)?;
    keep_inputs(&options.output, &[&options.input])?;
    keep_other_files(&options.output)?;
    let bytes = encode(&artifact.surrogate, Format::of_path(&options.output))?;
    save(&options.output, &bytes)?;
    context.print(&Converted { file: options.output.display().to_string(), bytes: bytes.len() as u64 })?;
    Ok(Ending::Done)
}

/// Refuses a file that this version could not write again without changing more than it should.
pub(super) fn refuse_lossy(artifact: &Artifact, path: &Path) -> anyhow::Result<()> {
    if let [kind, ..] = artifact.unknown_sections[..] {
        bail!(
            "{}: has a section of kind {kind} that this pcc does not know and would lose; use the pcc that wrote it",
            path.display()
        );
    }
    if compatibility(artifact.version.0, artifact.version.1) == Compatibility::NewerMinor {
        bail!(
            "{}: has format {}.{}, which this pcc would write as an older one; use the pcc that wrote it",
            path.display(),
            artifact.version.0,
            artifact.version.1
        );
    }
    if !artifact.is_canonical {
        bail!(
            "{}: is arranged in another way than pcc writes it, so writing it again would change its content_id; use the \
             program that wrote it",
            path.display()
        );
    }
    Ok(())
}

#[derive(Debug, Serialize)]
struct Converted {
    file: String,
    bytes: u64,
}

impl fmt::Display for Converted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "written to {} ({} bytes)", self.file, crate::report::count(self.bytes))
    }
}
