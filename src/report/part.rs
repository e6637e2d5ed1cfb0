//! What is said of parts of an evaluation.

use pcc_evaluate::foundation::count;
use serde::Serialize;
use std::fmt;

/// A shard that was evaluated.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PartReport {
    /// Where what was found is kept.
    pub file: String,
    /// Number of the shard, from 0.
    pub shard: u64,
    /// Number of shards.
    pub shards: u64,
    /// Samples of the shard.
    pub samples: u64,
    /// Those that are stable.
    pub stable_samples: u64,
    /// Wall-clock time.
    pub elapsed_seconds: f64,
}

impl fmt::Display for PartReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "shard {}/{}: {} samples, {} of them stable, in {:.2} s; written to {}",
            self.shard,
            self.shards,
            count(self.samples),
            count(self.stable_samples),
            self.elapsed_seconds,
            self.file
        )
    }
}

/// Parts that were put together to a larger one.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MergeReport {
    /// Where it is kept.
    pub file: String,
    /// Number of parts.
    pub parts: usize,
    /// Samples of all parts.
    pub samples: u64,
    /// Samples that were asked for.
    pub of: u64,
    /// Those of all parts that are stable.
    pub stable_samples: u64,
}

impl fmt::Display for MergeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} parts with {} of {} samples, {} of them stable; written to {}",
            self.parts,
            count(self.samples),
            count(self.of),
            count(self.stable_samples),
            self.file
        )
    }
}
