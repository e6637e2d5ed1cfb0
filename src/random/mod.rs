//! Random numbers addressed by what they are for, not by how many were drawn before.

mod philox;
mod stream;
mod uniform;

pub use philox::philox_4x32_10;
pub use stream::{Purpose, Stream};
pub use uniform::{UNIT_BITS, unit_interval};
