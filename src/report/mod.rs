//! What users read: each report is data that serialises to JSON, and a text rendered from it.

mod build;
mod certify;
mod compare;
mod eval;
mod inspect;
mod sensitivity;
mod sureness;
mod table;

pub use build::{BuildReport, FitReport};
pub use certify::CertifyReport;
pub use compare::CompareReport;
pub use eval::EvalReport;
pub use inspect::InspectReport;
pub use table::{Align, Table, count, significant};
