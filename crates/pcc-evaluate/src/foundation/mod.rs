//! What knows no domain: files that appear whole or not at all, parallel work, progress, instruction sets, hashes.

mod files;
mod instruction_set;
mod observer;
mod parallel;
mod sha256;
mod wording;

pub use files::{FileError, check_writable, save, save_with};
pub use instruction_set::InstructionSet;
pub use observer::{Interrupted, Observer, Silent, is_interruption};
pub use parallel::{try_map, try_map_waiting};
pub use sha256::{hexadecimal, sha256, sha256_bytes};
pub use wording::{count, plural};
