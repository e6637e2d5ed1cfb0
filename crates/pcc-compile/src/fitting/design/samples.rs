//! Points in standardized coordinates.

/// N points of r standardized coordinates ξ, stored point by point.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    dimension: usize,
    coordinates: Vec<f64>,
}

impl Samples {
    /// Points given as `coordinates`, each `dimension` long.
    ///
    /// # Panics
    ///
    /// If `dimension` is zero or does not divide the number of coordinates.
    pub fn new(dimension: usize, coordinates: Vec<f64>) -> Self {
        assert!(dimension > 0 && coordinates.len().is_multiple_of(dimension), "coordinates do not form points");
        Self { dimension, coordinates }
    }

    /// Number of points N.
    pub fn len(&self) -> usize {
        self.coordinates.len() / self.dimension
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// Number of coordinates r.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Point `i`.
    pub fn point(&self, i: usize) -> &[f64] {
        &self.coordinates[i * self.dimension..(i + 1) * self.dimension]
    }

    /// The points in order.
    pub fn points(&self) -> impl Iterator<Item = &[f64]> {
        self.coordinates.chunks_exact(self.dimension)
    }
}
