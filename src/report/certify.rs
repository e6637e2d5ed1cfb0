//! A verified bound, freshly made.

use pcc_evaluate::foundation::{count, plural};
use pcc_evaluate::probability::statistics::DiscordantCounts;
use pcc_evaluate::surrogate::{Certificate, MarginalBounds, Surrogate};
use serde::Serialize;
use std::fmt;

/// A certificate of a surrogate.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
            "{:.3} to {:.3} % stable at level {level}, {} model runs, seed {seed}, {falsely_stable} falsely stable, \
             {falsely_unstable} falsely unstable{failed}{other}",
            100.0 * lower,
            100.0 * upper,
            count(samples),
        )
    }
}

/// What `certify` found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CertifyReport {
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
        Self { study, file, contradicts_surrogate, certificates: CertificateReport::of(surrogate), elapsed_seconds }
    }
}

impl fmt::Display for CertifyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((CertificateReport { certificate: new, same_problem }, earlier)) = self.certificates.split_last()
        else {
            return Ok(());
        };
        writeln!(f, "{}: {} fresh model runs, {:.2} s\n", self.study, count(new.samples), self.elapsed_seconds)?;
        if self.contradicts_surrogate {
            writeln!(f, "warning: these runs contradict the surrogate: its own share lies outside the bound\n")?;
        }
        writeln!(f, "  verified bound         {:.3} % to {:.3} % stable", 100.0 * new.lower, 100.0 * new.upper)?;
        if let Some(MarginalBounds { marginal, unstable, .. }) = new.marginal {
            let range = |[lower, upper]: [f64; 2]| format!("{:.3} % to {:.3} %", 100.0 * lower, 100.0 * upper);
            writeln!(f, "                         {} marginal, {} unstable", range(marginal), range(unstable))?;
        }
        writeln!(f, "  level                  {}, whatever the surrogate", new.level)?;
        if !same_problem {
            writeln!(f, "  of another problem     than the surrogate was built for: eval does not show this bound")?;
        }
        writeln!(
            f,
            "  disagreement           {} falsely stable, {} falsely unstable",
            count(new.falsely_stable),
            count(new.falsely_unstable)
        )?;
        if new.failed > 0 {
            writeln!(
                f,
                "  failed                 {}, counted as disagreement both ways",
                plural(new.failed as usize, "run")
            )?;
        }
        if !earlier.is_empty() {
            writeln!(f, "\nearlier certificates; choosing among them by their result would void the level:")?;
            earlier.iter().try_for_each(|certificate| writeln!(f, "  {certificate}"))?;
        }
        writeln!(f, "\nwritten to {}", self.file)
    }
}
