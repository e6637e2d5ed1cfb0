//! A verified bound, freshly made, and one that rests on an assumption.

use super::layout::{Facts, width, wrapped, write_verdict, write_warnings};
use super::numbers::{above, below, level, share_range, significant};
use pcc_evaluate::foundation::{count, plural};
use pcc_evaluate::probability::statistics::{DiscordantCounts, Proportion};
use pcc_evaluate::surrogate::{
    AssumedBound, Certificate, FallingErrors, MarginalBounds, RareSide, Strata, StratumRuns, Surrogate,
};
use serde::Serialize;
use std::fmt;

/// Below this the share of unstable cases is the one that is named.
const RARE: f64 = 0.01;

/// What the bound that is not verified rests on.
const ASSUMPTION: &str =
    "an error that eats twice as much of the margin is at most half as frequent, beyond a layer at the boundary";

/// A certificate of a surrogate.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CertificateReport {
    /// What it says.
    #[serde(flatten)]
    pub certificate: Certificate,
    /// In which sense its ends hold; null for certificates of earlier versions.
    pub ends: Option<String>,
    /// What `if_errors_fall_off` assumes; null for certificates of earlier versions.
    pub assumption: Option<&'static str>,
    /// Whether the model that was run is the one the surrogate was built for.
    pub same_problem: bool,
}

impl CertificateReport {
    /// All certificates of a surrogate, oldest first.
    pub fn of(surrogate: &Surrogate) -> Vec<Self> {
        let report = |certificate: &Certificate| Self {
            certificate: certificate.clone(),
            ends: certificate.strata.as_ref().map(|strata| ends(strata.side_level, certificate.level)),
            assumption: certificate.strata.is_some().then_some(ASSUMPTION),
            same_problem: certificate.problem_hash == surrogate.provenance.problem_hash,
        };
        surrogate.certificates.iter().map(report).collect()
    }
}

/// How often the ends hold.
pub(super) fn ends(side_level: f64, both: f64) -> String {
    format!("each end at {}, both at {}", level(side_level), level(both))
}

/// The bound of a certificate if errors fall off, as a share of stable points or of unstable ones.
pub(super) fn assumed(strata: &Strata, of_unstable: bool) -> Option<String> {
    let upper = strata.if_errors_fall_off.bound.upper()?;
    let known = Proportion { hits: strata.surrogate.rare, samples: strata.surrogate.samples }.value();
    Some(match (strata.rare_side == RareSide::Stable) != of_unstable {
        true => below(known, upper),
        false => above(1.0 - upper, 1.0 - known),
    })
}

impl fmt::Display for CertificateReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let other = if self.same_problem { "" } else { "; of another problem than the surrogate's" };
        let Certificate { seed, samples, falsely_stable, falsely_unstable, lower, upper, .. } = self.certificate;
        let failed = match self.certificate.failed {
            0 => String::new(),
            failed => format!(", {failed} failed"),
        };
        let holds = self.ends.clone().unwrap_or_else(|| format!("at level {}", self.certificate.level));
        let assumed = self.certificate.strata.as_ref().and_then(|strata| assumed(strata, false));
        let assumed = assumed.map_or(String::new(), |bound| format!("; if errors fall off, {bound}, not verified"));
        write!(
            f,
            "{} stable, {holds}, {} model runs, seed {seed}, {falsely_stable} falsely stable, \
             {falsely_unstable} falsely unstable{failed}{assumed}{other}",
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
    /// The report of a surrogate that was given a certificate and written to `file`, or to none if that is empty.
    pub fn new(surrogate: &Surrogate, file: String, elapsed_seconds: f64) -> Self {
        let study = surrogate.provenance.study_name.clone();
        let contradicts_surrogate = surrogate.certificates.last().is_some_and(contradicts);
        let certificates = CertificateReport::of(surrogate);
        let mut report =
            Self { verdict: String::new(), study, file, contradicts_surrogate, certificates, elapsed_seconds };
        report.verdict = report.verdict();
        report
    }
}

/// Whether a certificate excludes the share of the surrogate that it was made for.
pub(super) fn contradicts(certificate: &Certificate) -> bool {
    if let Some(Strata { surrogate, rare_lower, rare_upper, .. }) = &certificate.strata {
        let own = Proportion { hits: surrogate.rare, samples: surrogate.samples }.value();
        return own < *rare_lower || own > *rare_upper;
    }
    let Certificate { samples, falsely_stable, falsely_unstable, failed, level, .. } = *certificate;
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
}

/// Whether the share of unstable cases is the one to name.
fn names_unstable(certificate: &Certificate) -> bool {
    let is_rare = |Strata { rare_side, surrogate, .. }: &Strata| {
        *rare_side == RareSide::NotStable && (surrogate.rare as f64) < RARE * surrogate.samples as f64
    };
    certificate.marginal.is_none() && certificate.strata.as_ref().is_some_and(is_rare)
}

impl CertifyReport {
    fn verdict(&self) -> String {
        let Some(report) = self.certificates.last() else { return String::new() };
        let new = &report.certificate;
        let stable = format!("{} are stable", share_range(new.lower, new.upper));
        let shares = match (&new.strata, new.marginal) {
            (Some(strata), None) if names_unstable(new) => {
                format!("{} are unstable", share_range(strata.rare_lower, strata.rare_upper))
            }
            (_, None) => stable,
            (_, Some(MarginalBounds { marginal, unstable, .. })) => {
                let [marginal, unstable] = [marginal, unstable].map(|[lower, upper]| share_range(lower, upper));
                format!("{stable}, {marginal} marginal, {unstable} unstable")
            }
        };
        let holds = report.ends.clone().unwrap_or_else(|| level(new.level));
        let runs = plural(new.samples as usize, "fresh model run");
        format!("{}: {shares}, whatever the surrogate is worth ({holds}, from {runs}).", self.study)
    }

    fn facts(&self, new: &Certificate, same_problem: bool) -> Facts {
        let mut facts = Facts::default();
        if !same_problem {
            facts.add("of another problem", "than the surrogate was built for: eval does not show this bound", "");
        }
        if let Some(strata) = &new.strata {
            facts.add("verified", verified(new, strata), "");
            add_assumed(&mut facts, strata, names_unstable(new));
            facts.add("runs", runs_in_words(strata), "");
        }
        let [stable, unstable] = [new.falsely_stable, new.falsely_unstable].map(count);
        facts.add("disagreement", format!("{stable} falsely stable, {unstable} falsely unstable"), "");
        if new.failed > 0 {
            let failed = plural(new.failed as usize, "run");
            facts.add("failed", format!("{failed}, counted as disagreement both ways"), "");
        }
        match self.file.as_str() {
            "" => facts.add("made in", format!("{:.2} s", self.elapsed_seconds), ""),
            file => facts.add("written to", format!("{file}, after {:.2} s", self.elapsed_seconds), ""),
        }
        facts
    }
}

/// The first line, which rests on nothing.
fn verified(new: &Certificate, strata: &Strata) -> String {
    let ([lower, upper], side) = match names_unstable(new) {
        true => ([strata.rare_lower, strata.rare_upper], "unstable"),
        false => ([new.lower, new.upper], "stable"),
    };
    format!("{} {side} ({} each end), assumption-free", share_range(lower, upper), level(strata.side_level))
}

/// The second line, with what it rests on and how that was checked.
fn add_assumed(facts: &mut Facts, strata: &Strata, of_unstable: bool) {
    let name = "if errors fall off";
    let FallingErrors { runs, largest_error, thinning, bound } = &strata.if_errors_fall_off;
    match bound {
        AssumedBound::Withheld(reason) => facts.add(name, format!("withheld: {}", reason.describe()), ""),
        AssumedBound::Upper(_) => {
            let side = if of_unstable { "unstable" } else { "stable" };
            let bound = assumed(strata, of_unstable).unwrap_or_default();
            facts.add(name, format!("{bound} {side} ({}); this is not verified", level(strata.side_level)), "");
            facts.add("assumed", ASSUMPTION, "");
        }
    }
    if *runs == 0 {
        return;
    }
    let eaten = significant(100.0 * largest_error, 2);
    let tail = thinning.first().map_or(String::new(), |tail| {
        let (twice, runs) = (count(tail.twice), plural(tail.runs as usize, "largest error"));
        format!("; of the {runs} {twice} are twice the smallest of them")
    });
    let runs = plural(*runs as usize, "run");
    facts.add("seen", format!("errors ate at most {eaten} % of the margin in {runs} beyond the layer{tail}"), "");
}

/// How the runs were divided.
fn runs_in_words(strata: &Strata) -> String {
    let side = match strata.rare_side {
        RareSide::Stable => "stable",
        RareSide::NotStable => "not stable",
    };
    let [outside, layer, inside] =
        [strata.outside, strata.layer, strata.inside].map(|StratumRuns { runs, .. }| count(runs));
    format!("{outside} outside what is predicted {side}, {layer} in the layer next to it, {inside} inside")
}

impl fmt::Display for CertifyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((CertificateReport { certificate: new, same_problem, .. }, earlier)) = self.certificates.split_last()
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
