//! The evaluator of `pcc`: reads surrogate files and answers questions about them, without any model.
//!
//! A surrogate is a set of polynomial chaos expansions of eigenvalues, or of symmetric functions of those that come
//! close, in uncertain inputs. What reads it here knows probability and files; it cannot run a model, since this crate
//! depends on none.
//!
//! | room | holds |
//! |---|---|
//! | [`foundation`] | what knows no domain: safe files, threads, progress, instruction sets, hashes |
//! | [`probability`] | random numbers, statistics, laws of the inputs |
//! | [`polynomials`] | orthonormal polynomials, quadrature, index sets, meshes of elements |
//! | [`components`] | how components become eigenvalues again |
//! | [`surrogate`] | the surrogate and what follows from its coefficients |
//! | [`artifact`] | its file |
//! | [`evaluation`] | a surrogate at millions of points, and what is asked about them |
//! | [`shard_file`] | parts of an evaluation, kept in files until all are there |
//! | [`session`] | from a request in words to one answer |
//!
//! ```no_run
//! use pcc_evaluate::{artifact, evaluation::monte_carlo, foundation::Silent};
//!
//! let surrogate = artifact::read("clutch.pcc".as_ref())?.surrogate;
//! let stable = monte_carlo(&surrogate, 100_000, 1, &Silent)?.stable_proportion();
//! println!("stable: {} of {}", stable.hits, stable.samples);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod artifact;
pub mod components;
pub mod evaluation;
pub mod foundation;
pub mod polynomials;
pub mod probability;
pub mod session;
pub mod shard_file;
pub mod surrogate;
