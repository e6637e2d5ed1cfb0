//! The JSON schemas of what commands print with `--json`, generated from the reports themselves.

use super::commands::{build, convert, man, report, reproduce, run, version};
use super::points::PointsReport;
use crate::report::{
    BuildReport, CertifyPlanReport, CertifyReport, CompareReport, DesignReport, EvalReport, IngestReport,
    InspectReport, JournalReport, MergeReport, ModesReport, PartReport, ServeReport, SweepReport,
};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;

/// A document of a command that has several kinds of them.
macro_rules! documents {
    ($($(#[$meaning:meta])* $name:ident { $($(#[$when:meta])* $kind:ident($of:ty),)+ })+) => {
        $(
            $(#[$meaning])*
            #[derive(JsonSchema)]
            #[schemars(untagged)]
            #[allow(dead_code, clippy::large_enum_variant, reason = "a schema is made of it; no value is")]
            enum $name {
                $($(#[$when])* $kind($of),)+
            }
        )+
    };
}

documents! {
    /// What `pcc build --json` prints.
    Build {
        /// A build.
        Surrogate(BuildReport),
        /// With --show-study.
        Study(build::ShownStudy),
    }
    /// What `pcc certify --json` prints.
    Certify {
        /// A certificate.
        Made(CertifyReport),
        /// With --target-width.
        Plan(CertifyPlanReport),
    }
    /// What `pcc eval --json` prints.
    Eval {
        /// Samples.
        Samples(EvalReport),
        /// With --sweep.
        Sweep(SweepReport),
        /// With --points.
        Points(PointsReport),
        /// With --part.
        Part(PartReport),
    }
    /// What `pcc merge --json` prints.
    Merge {
        /// Samples.
        Samples(EvalReport),
        /// With --sweep.
        Sweep(SweepReport),
        /// With --part, if parts are missing.
        Part(MergeReport),
    }
    /// What `pcc reference --json` prints.
    Reference {
        /// Random points.
        Samples(EvalReport),
        /// With --points.
        Points(PointsReport),
    }
}

/// For every command that prints a document: its name, and the schema as text, the content of
/// `schemas/output/<name>.schema.json`. Fields that a later version adds are no error.
pub fn schemas() -> Vec<(&'static str, String)> {
    vec![
        ("build", schema::<Build>()),
        ("certify", schema::<Certify>()),
        ("compare", schema::<CompareReport>()),
        ("convert", schema::<convert::Converted>()),
        ("design", schema::<DesignReport>()),
        ("eval", schema::<Eval>()),
        ("ingest", schema::<IngestReport>()),
        ("inspect", schema::<InspectReport>()),
        ("journal", schema::<JournalReport>()),
        ("man", schema::<man::Written>()),
        ("merge", schema::<Merge>()),
        ("modes", schema::<ModesReport>()),
        ("reference", schema::<Reference>()),
        ("report", schema::<report::Written>()),
        ("reproduce", schema::<reproduce::Reproduced>()),
        ("run", schema::<run::RunReport>()),
        ("serve", schema::<ServeReport>()),
        ("version", schema::<version::Version>()),
    ]
}

fn schema<T: JsonSchema>() -> String {
    let generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    format!("{:#}\n", generator.into_root_schema_for::<T>().to_value())
}
