//! Surrogate models for the stability of vibrating systems with uncertain parameters.
//!
//! A *study* names a model, its uncertain inputs and a method ([`study`]). [`build`] runs the model at the points of a
//! nested Latin hypercube ([`design`]) and fits a sparse polynomial chaos expansion to each component: real and
//! imaginary parts of eigenvalues, or of symmetric functions of those that come close, by values and derivatives
//! ([`fit`]). The result is a [`surrogate`], kept in a small versioned file ([`artifact`]). [`eval`] samples it
//! millions of times without the model; [`mod@reference`] samples the model itself, for comparison. [`mod@reproduce`] compares
//! all methods as the paper does, [`report`] puts what is found into text, JSON and pages.
//!
//! ```
//! use pcc::{artifact, build::build, eval::monte_carlo, progress::Silent, study::Study};
//!
//! let study = Study::from_toml(include_str!("../surrogates/clutch-r3-eigenvalues.toml"))?;
//! let surrogate = build(&study, &Silent)?;
//! let bytes = artifact::encode(&surrogate, artifact::Format::Binary)?;
//!
//! let loaded = artifact::decode(&bytes)?.surrogate;
//! let stable = monte_carlo(&loaded, 100_000, 1, &Silent)?.stable_proportion();
//! let interval = stable.wilson(0.95);
//! assert!(interval.lower < stable.value() && stable.value() < interval.upper);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Method and model: Kieu, Bergeot and Berger, *Sparse polynomial chaos expansion for stability analysis of a clutch
//! system with uncertain parameters*, 23ème Congrès Français de Mécanique, Lille 2017, called the paper throughout.
//!
//! # Layers
//!
//! A module imports from layers above its own: numerics, random numbers and statistics; then polynomials, index sets and
//! inputs; then models, spectra and studies; designs; regression and fits; surrogates and their files; the drivers build,
//! eval and reference; reports and the command line. The evaluator knows no model code. A test holds these rules.

#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod artifact;
pub mod build;
pub mod cli;
pub mod design;
pub mod digest;
pub mod eval;
pub mod expression;
pub mod fit;
pub mod index_set;
pub mod input;
pub mod journal;
pub mod model;
pub mod numerics;
pub mod parallel;
pub mod part;
pub mod plot;
pub mod polynomial;
pub mod progress;
pub mod random;
pub mod reference;
pub mod regression;
pub mod report;
pub mod reproduce;
pub mod spectrum;
pub mod statistics;
pub mod study;
pub mod surrogate;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeExamples;
