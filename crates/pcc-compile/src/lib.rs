//! The compiler of `pcc`: from a study to a surrogate.
//!
//! A *study* names a model, its uncertain inputs and a method. The model runs at the points of a nested design; what it
//! answers becomes components; each component is fitted; the result is a surrogate, which `pcc-evaluate` writes and
//! samples.
//!
//! | room | holds |
//! |---|---|
//! | [`numerics`] | eigenvalues, invariant subspaces, factorisations, minimisation |
//! | [`mechanics`] | models and their spectra |
//! | [`fitting`] | designs, regression, fits: mathematics that knows no study |
//! | [`tables`] | runs of a model that somebody has made already |
//! | [`study`] | a TOML file becomes a validated problem |
//! | [`campaign`] | model runs: which are asked for, known, recorded |
//! | [`compilation`] | the loop of the build, and its stopping rule |
//! | [`ask_and_tell`] | builds whose model somebody else runs |
//! | [`mod@reference`] | the model itself on many points; comparisons and certificates |

#![forbid(unsafe_code)]

pub mod ask_and_tell;
pub mod campaign;
pub mod compilation;
pub mod fitting;
pub mod mechanics;
pub mod numerics;
pub mod reference;
pub mod study;
pub mod tables;
