//! Mathematics of fits: where to sample, least squares, and the methods. Nothing here knows a study or a file.

pub mod design;
pub mod fit;
pub mod regression;
