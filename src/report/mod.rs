//! What users read: each report is data that serialises to JSON, and a text rendered from it.

mod build;
mod campaign;
mod certify;
mod charts;
mod compare;
mod confidence;
mod coverage;
mod eval;
mod eval_text;
mod inspect;
mod judgement;
mod page;
mod paper_charts;
mod part;
mod reproduction;
mod sensitivity;
mod surrogate_page;
mod survey;
mod sweep;
mod table;

pub use build::{BuildReport, FailedRun, FitReport, RecordedRuns};
pub use campaign::{DesignReport, IngestReport, JournalModel, JournalReport};
pub use certify::CertifyReport;
pub use compare::CompareReport;
pub use eval::EvalReport;
pub use inspect::InspectReport;
pub use part::{MergeReport, PartReport};
pub use reproduction::{figure_sheets, short_table_2, table_2};
pub use surrogate_page::{SurrogatePage, Validation};
pub use sweep::{SweepPoint, SweepReport, sweep_chart};
pub use table::{Align, Table, plain, significant};
