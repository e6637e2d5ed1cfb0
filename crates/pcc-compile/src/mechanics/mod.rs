//! Mechanics: models of vibrating systems, and the spectra that they answer.

pub mod model;
pub mod spectrum;
