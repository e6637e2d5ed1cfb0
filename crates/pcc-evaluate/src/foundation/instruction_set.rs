//! Which vector instructions a calculation runs with: found at run time, or chosen.
//!
//! Code that is generic over [`Simd`] is compiled once for each set. As long as it handles one sample per lane, in
//! operations that IEEE 754 rounds exactly (fused multiply-add among them), all sets give the same bits.

use pulp::{Scalar, Simd, WithSimd};
use std::fmt;

#[cfg(target_arch = "aarch64")]
use pulp::aarch64::Neon;
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};

/// A set of vector instructions that this processor has: values exist for no other.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::foundation::InstructionSet;
/// let best = InstructionSet::best();
/// assert!(InstructionSet::available().contains(&best));
/// assert_eq!(InstructionSet::named("portable").unwrap().name(), "portable");
/// ```
#[derive(Clone, Copy)]
pub struct InstructionSet(Kind);

/// The values inside prove that the processor has the instructions.
#[derive(Clone, Copy)]
enum Kind {
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    #[cfg(target_arch = "aarch64")]
    Neon(Neon),
    Portable,
}

impl InstructionSet {
    /// Names of all sets, whether this processor has them or not: AVX-512 (F, BW, CD, DQ and VL), AVX2 with FMA, NEON,
    /// and what every processor has.
    pub const NAMES: [&str; 4] = ["avx512", "avx2", "neon", "portable"];

    /// The sets that this processor has, the fastest first.
    pub fn available() -> Vec<Self> {
        let mut sets = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            sets.extend(V4::try_new().map(Kind::Avx512));
            sets.extend(V3::try_new().map(Kind::Avx2));
        }
        #[cfg(target_arch = "aarch64")]
        sets.extend(Neon::try_new().map(Kind::Neon));
        sets.push(Kind::Portable);
        sets.into_iter().map(Self).collect()
    }

    /// The fastest set of this processor.
    pub fn best() -> Self {
        Self::available().first().copied().unwrap_or(Self(Kind::Portable))
    }

    /// The set with this name; `None` if this processor does not have it.
    pub fn named(name: &str) -> Option<Self> {
        Self::available().into_iter().find(|set| set.name() == name)
    }

    /// Name, one of [`Self::NAMES`].
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(_) => Self::NAMES[0],
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(_) => Self::NAMES[1],
            #[cfg(target_arch = "aarch64")]
            Kind::Neon(_) => Self::NAMES[2],
            Kind::Portable => Self::NAMES[3],
        }
    }

    /// Runs `work`, compiled for this set.
    #[inline]
    pub fn run<W: WithSimd>(self, work: W) -> W::Output {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(simd) => Simd::vectorize(simd, work),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(simd) => Simd::vectorize(simd, work),
            #[cfg(target_arch = "aarch64")]
            Kind::Neon(simd) => Simd::vectorize(simd, work),
            Kind::Portable => Simd::vectorize(Scalar, work),
        }
    }
}

impl PartialEq for InstructionSet {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for InstructionSet {}

impl fmt::Debug for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_processor_has_the_portable_set_last() {
        let sets = InstructionSet::available();
        assert_eq!(sets.last().map(|set| set.name()), Some("portable"));
        assert!(sets.iter().all(|&set| InstructionSet::named(set.name()) == Some(set)));
        assert_eq!(InstructionSet::named("abacus"), None);
    }

    /// a · b + c with one rounding: with two, it is zero.
    struct FusedResidue;

    impl WithSimd for FusedResidue {
        type Output = f64;

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> f64 {
            let third = simd.splat_f64s(1.0 / 3.0);
            let product = simd.mul_f64s(third, third);
            let residue = simd.mul_add_f64s(third, third, simd.neg_f64s(product));
            simd.reduce_max_f64s(residue)
        }
    }

    #[test]
    fn every_set_fuses_multiplication_and_addition() {
        let third = 1.0f64 / 3.0;
        let expected = third.mul_add(third, -(third * third));
        assert!(expected != 0.0);
        for set in InstructionSet::available() {
            assert_eq!(set.run(FusedResidue), expected, "{set:?}");
        }
    }
}
