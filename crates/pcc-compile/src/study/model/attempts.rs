//! How many runs of programs and servers go on at once, how long they may take, and how often they are tried.

use crate::study::defaults;
use crate::study::error::StudyError;
use crate::study::print::{Printer, float};
use crate::study::raw;
use crate::study::validate::Lines;
use std::ops::RangeInclusive;
use std::time::Duration;
use toml::Spanned;

/// The keys of what follows.
pub(super) const KEYS: [&str; 3] = ["jobs", "timeout", "retries"];

/// More runs at once are a mistake.
const MOST_JOBS: i64 = 10_000;

/// More attempts, too.
const MOST_RETRIES: i64 = 1000;

/// How runs are tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attempts {
    /// Runs that go on at once, at least 1.
    pub jobs: usize,
    /// Seconds after which a run is given up.
    pub timeout: Option<f64>,
    /// Further attempts at a run that failed.
    pub retries: u32,
}

impl Attempts {
    /// The time that a run may take.
    pub(super) fn limit(self) -> Option<Duration> {
        self.timeout.map(Duration::from_secs_f64)
    }
}

impl Lines<'_> {
    pub(super) fn attempts(&self, raw: &mut raw::Model) -> Result<Attempts, StudyError> {
        let whole = |key, value: Option<Spanned<i64>>, range: RangeInclusive<i64>, default| {
            value.map_or(Ok(default), |value| self.integer(key, value, range))
        };
        let timeout = match raw.timeout.take() {
            None => None,
            timeout => {
                let expected = "a number of seconds above 0 and at most 1e9";
                let holds = |value| value > 0.0 && value <= 1e9;
                Some(self.number("model.timeout", timeout, 0.0, expected, holds)?)
            }
        };
        Ok(Attempts {
            jobs: whole("model.jobs", raw.jobs.take(), 1..=MOST_JOBS, defaults::JOBS)? as usize,
            timeout,
            retries: whole("model.retries", raw.retries.take(), 0..=MOST_RETRIES, 0)? as u32,
        })
    }
}

/// With the name of what goes on, and what ends it.
pub(super) fn print(file: &mut Printer, attempts: &Attempts, what: &str, end: &str) {
    file.line("jobs", attempts.jobs, &format!("{what} at once"));
    match attempts.timeout {
        Some(seconds) => file.line("timeout", float(seconds), &format!("seconds after which {end}")),
        None => file.line("# timeout", "600.0", &format!("seconds after which {end}; no limit unless written")),
    }
    file.line("retries", attempts.retries, "further attempts at a run that failed");
}
