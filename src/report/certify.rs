//! A verified bound, freshly made.

use pcc_evaluate::foundation::count;
use pcc_evaluate::surrogate::{Certificate, Surrogate};
use serde::Serialize;
use std::fmt;

/// A certificate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CertificateReport {
    /// Seed of its points.
    pub seed: u64,
    /// Number of fresh model runs.
    pub samples: u64,
    /// How the points were drawn.
    pub scheme: String,
    /// Points that the surrogate calls stable and the model unstable.
    pub falsely_stable: u64,
    /// Points that the surrogate calls unstable and the model stable.
    pub falsely_unstable: u64,
    /// Confidence level.
    pub level: f64,
    /// Lower end of the bound on the stability proportion.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
    /// Whether the model that was run is the one the surrogate was built for.
    pub same_problem: bool,
}

impl CertificateReport {
    /// All certificates of a surrogate, oldest first.
    pub fn of(surrogate: &Surrogate) -> Vec<Self> {
        let report = |certificate: &Certificate| Self {
            seed: certificate.seed,
            samples: certificate.samples,
            scheme: certificate.scheme.clone(),
            falsely_stable: certificate.falsely_stable,
            falsely_unstable: certificate.falsely_unstable,
            level: certificate.level,
            lower: certificate.lower,
            upper: certificate.upper,
            same_problem: certificate.problem_hash == surrogate.provenance.problem_hash,
        };
        surrogate.certificates.iter().map(report).collect()
    }
}

impl fmt::Display for CertificateReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let other = if self.same_problem { "" } else { "; of another problem than the surrogate's" };
        write!(
            f,
            "{:.3} to {:.3} % stable at level {}, {} model runs, seed {}, {} falsely stable, {} falsely unstable{other}",
            100.0 * self.lower,
            100.0 * self.upper,
            self.level,
            count(self.samples),
            self.seed,
            self.falsely_stable,
            self.falsely_unstable
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
    /// All its certificates, the new one last.
    pub certificates: Vec<CertificateReport>,
    /// Wall-clock time.
    pub elapsed_seconds: f64,
}

impl CertifyReport {
    /// The report of a surrogate that was given a certificate and written to `file`.
    pub fn new(surrogate: &Surrogate, file: String, elapsed_seconds: f64) -> Self {
        let study = surrogate.provenance.study_name.clone();
        Self { study, file, certificates: CertificateReport::of(surrogate), elapsed_seconds }
    }
}

impl fmt::Display for CertifyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((new, earlier)) = self.certificates.split_last() else { return Ok(()) };
        writeln!(f, "{}: {} fresh model runs, {:.2} s\n", self.study, count(new.samples), self.elapsed_seconds)?;
        writeln!(f, "  verified bound         {:.3} % to {:.3} % stable", 100.0 * new.lower, 100.0 * new.upper)?;
        writeln!(f, "  level                  {}, whatever the surrogate", new.level)?;
        if !new.same_problem {
            writeln!(f, "  of another problem     than the surrogate was built for: eval does not show this bound")?;
        }
        writeln!(
            f,
            "  disagreement           {} falsely stable, {} falsely unstable",
            count(new.falsely_stable),
            count(new.falsely_unstable)
        )?;
        if !earlier.is_empty() {
            writeln!(f, "\nearlier certificates; choosing among them by their result would void the level:")?;
            earlier.iter().try_for_each(|certificate| writeln!(f, "  {certificate}"))?;
        }
        writeln!(f, "\nwritten to {}", self.file)
    }
}
