//! Random numbers addressed by what they are for, not by how many were drawn before.

mod direction_numbers;
mod feistel_permutation;
mod latin_hypercube_sampler;
mod philox;
mod sobol_sequence;
mod stream;
mod uniform;
mod unit_pairs;

pub use latin_hypercube_sampler::LatinHypercubeSampler;
pub use philox::philox_4x32_10;
pub use sobol_sequence::SobolSequence;
pub use stream::{Purpose, Stream, key as seed_key};
pub use uniform::{UNIT_BITS, unit_interval};
pub use unit_pairs::unit_pairs;
