//! A verified bound, freshly made.

use super::layout::{Facts, width, wrapped, write_verdict, write_warnings};
use super::numbers::{level, share_range};
use pcc_evaluate::foundation::{count, plural};
use pcc_evaluate::probability::statistics::DiscordantCounts;
use pcc_evaluate::surrogate::{Certificate, MarginalBounds, Surrogate};
use serde::Serialize;
use std::fmt;

/// A certificate of a surrogate.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CertificateReport {
    /// What it says.
    #[serde(flatten)]
    pub certificate: Certificate,
    /// Whether the model that was run is the one the surrogate was built for.
    pub same_problem: bool,
}

impl CertificateReport {
    /// All certificates of a surrogate, oldest first.
    pub fn of(surrogate: &Surrogate) -> Vec<Self> {
        let report = |certificate: &Certificate| Self {
            certificate: certificate.clone(),
            same_problem: certificate.problem_hash == surrogate.provenance.problem_hash,
        };
        surrogate.certificates.iter().map(report).collect()
    }
}

impl fmt::Display for CertificateReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let other = if self.same_problem { "" } else { "; of another problem than the surrogate's" };
        let Certificate { seed, samples, falsely_stable, falsely_unstable, level, lower, upper, .. } = self.certificate;
        let failed = match self.certificate.failed {
            0 => String::new(),
            failed => format!(", {failed} failed"),
        };
        write!(
            f,
            "{} stable at level {level}, {} model runs, seed {seed}, {falsely_stable} falsely stable, \
             {falsely_unstable} falsely unstable{failed}{other}",
            share_range(lower, upper),
            count(samples),
        )
    }
}

/// What `certify` found.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CertifyReport {
    /// The answer in a sentence.
    pub verdict: String,
    /// Name of the study.
    pub study: String,
    /// Where the surrogate with its certificates is.
    pub file: String,
    /// Whether the new certificate excludes the surrogate's own share.
    pub contradicts_surrogate: bool,
    /// All its certificates, the new one last.
    pub certificates: Vec<CertificateReport>,
    /// Wall-clock time.
    pub elapsed_seconds: f64,
}

impl CertifyReport {
    /// The report of a surrogate that was given a certificate and written to `file`.
    pub fn new(surrogate: &Surrogate, file: String, elapsed_seconds: f64) -> Self {
        let study = surrogate.provenance.study_name.clone();
        let contradicts_surrogate = surrogate.certificates.last().is_some_and(|new| {
            let Certificate { samples, falsely_stable, falsely_unstable, failed, level, .. } = *new;
            let counts = DiscordantCounts {
                samples,
                falsely_claimed: falsely_stable,
                falsely_denied: falsely_unstable,
                // Which of the two is not recorded.
                claimed_unknown: failed,
                denied_unknown: failed,
            };
            let [lower, upper] = counts.difference(level);
            lower > 0.0 || upper < 0.0
        });
        let certificates = CertificateReport::of(surrogate);
        let mut report =
            Self { verdict: String::new(), study, file, contradicts_surrogate, certificates, elapsed_seconds };
        report.verdict = report.verdict();
        report
    }
}

impl CertifyReport {
    fn verdict(&self) -> String {
        let Some(CertificateReport { certificate: new, .. }) = self.certificates.last() else { return String::new() };
        let shares = match new.marginal {
            None => format!("{} are stable", share_range(new.lower, new.upper)),
            Some(MarginalBounds { marginal, unstable, .. }) => {
                let [marginal, unstable] = [marginal, unstable].map(|[lower, upper]| share_range(lower, upper));
                format!("{} are stable, {marginal} marginal, {unstable} unstable", share_range(new.lower, new.upper))
            }
        };
        format!(
            "{}: {shares}, whatever the surrogate is worth ({}, from {}).",
            self.study,
            level(new.level),
            plural(new.samples as usize, "fresh model run")
        )
    }

    fn facts(&self, new: &Certificate, same_problem: bool) -> Facts {
        let mut facts = Facts::default();
        if !same_problem {
            facts.add("of another problem", "than the surrogate was built for: eval does not show this bound", "");
        }
        let [stable, unstable] = [new.falsely_stable, new.falsely_unstable].map(count);
        facts.add("disagreement", format!("{stable} falsely stable, {unstable} falsely unstable"), "");
        if new.failed > 0 {
            let failed = plural(new.failed as usize, "run");
            facts.add("failed", format!("{failed}, counted as disagreement both ways"), "");
        }
        facts.add("written to", format!("{}, after {:.2} s", self.file, self.elapsed_seconds), "");
        facts
    }
}

impl fmt::Display for CertifyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((CertificateReport { certificate: new, same_problem }, earlier)) = self.certificates.split_last()
        else {
            return Ok(());
        };
        let columns = width(f);
        if self.contradicts_surrogate {
            let warning =
                "these runs contradict the surrogate: its own share lies outside the bound; build with more runs";
            write_warnings(f, &[warning.to_owned()])?;
        }
        write_verdict(f, &self.verdict)?;
        write!(f, "{:columns$}", self.facts(new, *same_problem))?;
        if !earlier.is_empty() {
            let note = "earlier certificates; choosing among them by their result would void the level:";
            writeln!(f, "\n{}", wrapped(note, columns, 0))?;
            earlier.iter().try_for_each(|one| writeln!(f, "{}", wrapped(&format!("  {one}"), columns, 4)))?;
        }
        Ok(())
    }
}
