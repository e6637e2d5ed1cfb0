//! `pcc certify`

use super::super::arguments::Certify;
use super::super::recording::open_here;
use super::super::{Context, Ending};
use super::convert::refuse_lossy;
use super::{interruptible, keep_other_files, read_study, read_surrogate};
use crate::report::CertifyReport;
use anyhow::bail;
use pcc_compile::campaign::Campaign;
use pcc_compile::reference::certify as certify_with_model;
use pcc_evaluate::artifact::{Format, encode};
use pcc_evaluate::foundation::{check_writable, save};
use std::time::Instant;

/// Confidence level of certificates.
const LEVEL: f64 = 0.95;

pub(in super::super) fn certify(context: &Context, options: &Certify) -> anyhow::Result<Ending> {
    let artifact = read_surrogate(&options.surrogate)?;
    refuse_lossy(&artifact, &options.surrogate)?;
    let mut surrogate = artifact.surrogate;
    let study = read_study(&options.study)?;
    let (file, source) = (options.surrogate.display(), options.study.display());
    if study.problem_hash() != surrogate.provenance.problem_hash && !options.force {
        bail!(
            "{source}: asks another question than {file} was built for: model, constants, inputs or spectrum differ; give \
             the study it was built from, or pass --force to certify it against this one all the same"
        );
    }
    let problem = study.problem_hash();
    if surrogate.certificates.iter().any(|known| known.seed == options.seed && known.problem_hash == problem) {
        bail!("{file}: has a certificate of seed {} already; choose another with --seed", options.seed);
    }
    if study.inputs != surrogate.inputs {
        bail!(
            "{source}: has other inputs than {file}; even with --force they must be the same, in order and distribution"
        );
    }
    let output = options.output.as_ref().unwrap_or(&options.surrogate);
    let format = options.output.as_ref().map_or(artifact.format, |path| Format::of_path(path));
    keep_other_files(output)?;
    check_writable(output)?;
    let books = open_here(context, &study, &options.recording)?;
    let campaign = Campaign { study: &study, ledger: Some(&books.ledger) };
    let start = Instant::now();
    let certificate = certify_with_model(&surrogate, campaign, options.runs, options.seed, LEVEL, &context.terminal)
        .inspect_err(|_| books.say_recorded(context))
        .map_err(|error| interruptible(error.clone(), error.is_interruption(), &source.to_string()))?;
    surrogate.certificates.push(certificate);
    save(output, &encode(&surrogate, format)?)?;
    let elapsed = start.elapsed().as_secs_f64();
    context.print(&CertifyReport::new(&surrogate, output.display().to_string(), elapsed))?;
    Ok(Ending::Done)
}
