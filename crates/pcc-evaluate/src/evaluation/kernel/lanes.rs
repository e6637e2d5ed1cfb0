//! One number for each point of a block.

use crate::probability::inputs::Column;
use pulp::Simd;

/// Points evaluated together, one per lane: as many as eight vectors of the widest instruction set hold.
pub const BLOCK_POINTS: usize = 64;

/// Vectors that a calculation works on at once: enough for the processor to start one operation while others are under
/// way, few enough to stay in registers.
pub(crate) const VECTORS: usize = 8;

/// One number per lane, aligned like the widest vectors, so that none of them crosses a cache line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct Lanes(pub [f64; BLOCK_POINTS]);

/// [`VECTORS`] vectors of an instruction set.
pub(crate) type Vectors<S> = [<S as Simd>::f64s; VECTORS];

impl Column<BLOCK_POINTS> for Lanes {
    #[inline(always)]
    fn lanes(&self) -> &[f64; BLOCK_POINTS] {
        &self.0
    }

    #[inline(always)]
    fn lanes_mut(&mut self) -> &mut [f64; BLOCK_POINTS] {
        &mut self.0
    }
}

impl Lanes {
    /// The same number in every lane.
    pub const fn splat(value: f64) -> Self {
        Self([value; BLOCK_POINTS])
    }

    /// How many parts of [`VECTORS`] vectors make up all lanes.
    pub(crate) const fn parts<S: Simd>() -> usize {
        BLOCK_POINTS / (VECTORS * S::F64_LANES)
    }

    /// One part.
    #[inline(always)]
    pub(crate) fn read<S: Simd>(&self, part: usize) -> Vectors<S> {
        S::as_simd_f64s(&self.0).0.as_chunks::<VECTORS>().0[part]
    }

    /// Replaces one part.
    #[inline(always)]
    pub(crate) fn write<S: Simd>(&mut self, part: usize, vectors: Vectors<S>) {
        S::as_mut_simd_f64s(&mut self.0).0.as_chunks_mut::<VECTORS>().0[part] = vectors;
    }
}
