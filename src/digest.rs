//! Content hashes.

use sha2::{Digest, Sha256};

/// Hexadecimal SHA-256 of `bytes`.
///
/// # Examples
///
/// ```
/// assert!(pcc::digest::sha256(b"").starts_with("e3b0c44298fc1c14"));
/// ```
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
