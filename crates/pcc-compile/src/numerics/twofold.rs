//! Sums of products in twice the working precision, by error-free transformations.
//!
//! A sum s and its rounding error are both floating-point numbers (Knuth 1969), and so are those of a product (Dekker
//! 1971, <https://doi.org/10.1007/BF01397083>): carried along, they make a dot product as accurate as if it were
//! computed with 106 bits (Ogita, Rump and Oishi 2005, <https://doi.org/10.1137/030601818>).

use nalgebra::Complex;

/// A number as an unevaluated sum of two, the second a rounding error of the first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twofold {
    high: f64,
    low: f64,
}

impl From<f64> for Twofold {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Twofold {
    /// The nearest floating-point number.
    pub fn rounded(self) -> f64 {
        self.high + self.low
    }

    /// Adds factor × number.
    #[inline(always)]
    pub fn add_product(&mut self, factor: f64, number: Self) {
        let (product, error) = product(factor, number.high);
        let (sum, rounding) = sum(self.high, product);
        self.high = sum;
        self.low += rounding + (error + factor * number.low);
    }

    /// The same with high and low part apart as far as they can be.
    fn normalized(self) -> Self {
        let (high, low) = sum(self.high, self.low);
        Self { high, low }
    }
}

/// A complex number whose parts are both twofold.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TwofoldComplex {
    /// Real part.
    pub re: Twofold,
    /// Imaginary part.
    pub im: Twofold,
}

impl From<Complex<f64>> for TwofoldComplex {
    fn from(number: Complex<f64>) -> Self {
        Self { re: number.re.into(), im: number.im.into() }
    }
}

impl TwofoldComplex {
    /// The product with a number.
    ///
    /// # Examples
    ///
    /// ```
    /// use nalgebra::Complex;
    /// use pcc_compile::numerics::twofold::TwofoldComplex;
    /// // (1 + ε)(1 − ε) − 1 = −ε², which is lost in plain arithmetic.
    /// let epsilon = f64::EPSILON;
    /// let mut found = TwofoldComplex::from(Complex::new(1.0 + epsilon, 0.0)).times(Complex::new(1.0 - epsilon, 0.0));
    /// found.re.add_product(1.0, (-1.0).into());
    /// assert_eq!(found.rounded(), Complex::new(-epsilon * epsilon, 0.0));
    /// ```
    pub fn times(self, factor: Complex<f64>) -> Self {
        let mut found = Self::default();
        found.re.add_product(factor.re, self.re);
        found.re.add_product(-factor.im, self.im);
        found.im.add_product(factor.re, self.im);
        found.im.add_product(factor.im, self.re);
        Self { re: found.re.normalized(), im: found.im.normalized() }
    }

    /// Adds factor × number.
    #[inline(always)]
    pub fn add_product(&mut self, factor: f64, number: Self) {
        self.re.add_product(factor, number.re);
        self.im.add_product(factor, number.im);
    }

    /// The nearest complex number.
    pub fn rounded(self) -> Complex<f64> {
        Complex::new(self.re.rounded(), self.im.rounded())
    }
}

/// a + b and its rounding error.
#[inline(always)]
fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// a b and its rounding error. Without fused operations, so that the bits are the same on all processors.
#[inline(always)]
fn product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    (product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low))
}

/// A number as a sum of two with 26 bits each.
#[inline(always)]
fn halves(number: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0;
    let shifted = SPLITTER * number;
    let high = shifted - (shifted - number);
    (high, number - high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cancels_keeps_its_digits() {
        // 10¹⁶ (1/3) − (10¹⁶/3 rounded) and the like: the sum of products is known exactly.
        let third = 1.0 / 3.0;
        let mut found = Twofold::default();
        found.add_product(3e16, third.into());
        found.add_product(-1e16, 1.0.into());
        // 3 · fl(1/3) = 1 − 2⁻⁵⁴.
        assert_eq!(found.rounded(), -1e16 * 2f64.powi(-54));
    }

    #[test]
    fn squares_of_imaginary_numbers_are_real() {
        let lambda = Complex::new(0.0, 1.1);
        let found = TwofoldComplex::from(lambda).times(lambda);
        assert_eq!(found.im.rounded(), 0.0);
        assert_eq!(found.re.rounded(), -(1.1 * 1.1));
    }
}
