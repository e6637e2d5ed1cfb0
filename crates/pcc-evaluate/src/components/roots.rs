//! All roots of a polynomial with complex coefficients, by the simultaneous iteration of Aberth and Ehrlich.
//!
//! Aberth (1973), <https://doi.org/10.1090/S0025-5718-1973-0329236-7>, corrects every approximation z_i by Newton's
//! step for the polynomial divided by the other approximations,
//!
//! z_i ← z_i − p(z_i)/(p′(z_i) − p(z_i) Σ_{j≠i} 1/(z_i − z_j)),
//!
//! which converges cubically to simple roots, linearly to multiple ones, and in practice from everywhere. Bini (1996),
//! <https://doi.org/10.1007/BF02207694>, adds what makes it dependable in floating point: starting points on circles
//! whose radii are read off the Newton polygon of the coefficients' moduli, so that roots of very different magnitude
//! need no long journeys, and a stop for each root when |p(z_i)| is below the rounding error of its own evaluation, so
//! that multiple roots, which are known only to ε^(1/m), stop as well.
//!
//! The polynomial is first stretched by a power of two, z = 2ˢw, until its largest root is a small number, so that no
//! power of a root overflows. Linear and quadratic polynomials are solved in closed form.

use num_complex::Complex;

/// Sweeps over all roots. Simple roots of low degree take five or six. The error of an m-fold root shrinks by (m −
/// 1)/(m + 1) per sweep until it is ε^(1/m), which takes 16 to 18 sweeps whatever m is. The rest is for polynomials
/// that start badly; what has not settled by then is taken as it is.
const MAX_SWEEPS: usize = 60;

/// Polynomials up to this degree are solved without allocation.
const DEGREE_ON_STACK: usize = 16;

/// Rounding error allowed to each step of Horner's scheme, relative to the moduli it adds: the unit roundoff ε/2. The
/// rigorous bound in complex arithmetic is some four times as large, but errors seldom all point the same way, and a
/// root that stops later is more accurate.
const ROUNDING_OF_A_STEP: f64 = 0.5 * f64::EPSILON;

/// Squared moduli from here on can be inverted without loss; smaller ones have lost digits to underflow.
const SAFE_SQUARE: f64 = 1e-280;

/// Direction of the first starting point, at Bini's 0.7 radians: roots of polynomials with real coefficients lie
/// symmetric to the axes, and starting points that did too would meet corrections that are zero or infinite.
const FIRST_DIRECTION: Complex<f64> = Complex { re: 0.764_842_187_284_488_4, im: 0.644_217_687_237_691_1 };

/// Turn by the golden angle π(3 − √5), from each starting point to the next. However many points a circle holds, they
/// are spread evenly, and those of neighbouring circles are not in line.
const GOLDEN_TURN: Complex<f64> = Complex { re: -0.737_368_878_078_319_9, im: 0.675_490_294_261_523_6 };

const ZERO: Complex<f64> = Complex { re: 0.0, im: 0.0 };

/// Finds all roots of zᵏ + c_{k−1} zᵏ⁻¹ + … + c_1 z + c_0.
///
/// `coefficients` holds c_{k−1}, …, c_1, c_0, in descending powers and without the leading one. `roots` receives the k
/// roots, an m-fold root m times. Equal coefficients give equal roots in equal order; the order has no other meaning,
/// except that exact zeros come last.
///
/// Each root is an exact root of a polynomial whose coefficients differ by a few roundings, about k ε relative to
/// each: well-separated roots are accurate, m-fold roots and clusters of m roots are as uncertain as ε^(1/m). Trailing
/// zero coefficients give exact zero roots. If a coefficient is NaN or infinite, all roots are NaN.
///
/// This holds for roots of all magnitudes as long as no two differ by more than a factor 10^(300/k); beyond, the small
/// ones are only small. The work grows as k² per sweep, and the number of sweeps is bounded. It is meant for degrees up
/// to a hundred or two; from about 600 on powers overflow.
///
/// # Panics
///
/// If `roots` and `coefficients` differ in length.
///
/// # Examples
///
/// ```
/// use num_complex::Complex;
/// // (z − 1)(z − 2)(z + 3) = z³ − 7z + 6
/// let coefficients = [0.0, -7.0, 6.0].map(|c| Complex::new(c, 0.0));
/// let mut roots = [Complex::new(0.0, 0.0); 3];
/// pcc_evaluate::components::roots(&coefficients, &mut roots);
/// roots.sort_by(|a, b| a.re.total_cmp(&b.re));
/// for (root, expected) in roots.iter().zip([-3.0, 1.0, 2.0]) {
///     assert!((root - expected).norm() < 1e-14);
/// }
/// ```
pub fn roots(coefficients: &[Complex<f64>], roots: &mut [Complex<f64>]) {
    assert_eq!(coefficients.len(), roots.len(), "a polynomial has as many roots as coefficients below the leading one");
    if coefficients.iter().any(|c| !c.re.is_finite() || !c.im.is_finite()) {
        roots.fill(Complex::new(f64::NAN, f64::NAN));
    } else if coefficients.len() <= DEGREE_ON_STACK {
        let mut stretched = [ZERO; DEGREE_ON_STACK];
        solve(coefficients, &mut stretched[..coefficients.len()], roots);
    } else {
        solve(coefficients, &mut vec![ZERO; coefficients.len()], roots);
    }
}

/// [`roots`] of finite coefficients; `stretched` is room for those of the polynomial in w.
fn solve(coefficients: &[Complex<f64>], stretched: &mut [Complex<f64>], roots: &mut [Complex<f64>]) {
    let exponent = stretch_exponent(coefficients);
    let shrink = power_of_two(-exponent);
    for (j, (stretched, &c)) in stretched.iter_mut().zip(coefficients).enumerate() {
        // One factor at a time, because 2^(−s(j + 1)) itself may overflow.
        *stretched = (0..=j).fold(c, |c, _| c * shrink);
    }
    let degree = stretched.iter().rposition(|&c| c != ZERO).map_or(0, |last| last + 1);
    let (stretched, (roots, zeros)) = (&stretched[..degree], roots.split_at_mut(degree));
    zeros.fill(ZERO);
    match *stretched {
        [] => {}
        [c_0] => roots[0] = -c_0,
        [c_1, c_0] => roots.copy_from_slice(&quadratic(c_1, c_0)),
        _ => {
            start(stretched, roots);
            iterate(stretched, roots);
        }
    }
    for root in roots {
        *root *= power_of_two(exponent);
    }
}

/// The smallest s at which all |c_{k−j}| are below 2^(js) in their larger part. By Fujiwara's bound, |z| ≤ 2 max_j
/// |c_{k−j}|^(1/j), all roots of the polynomial in w = z/2ˢ are then below 3.
/// (Where 2ˢ would overflow, s is one or two less and the bound 12.)
fn stretch_exponent(coefficients: &[Complex<f64>]) -> i32 {
    let of_power = |(j, c): (i32, &Complex<f64>)| {
        let larger = c.re.abs().max(c.im.abs());
        (larger > 0.0).then(|| binary_exponent(larger).div_euclid(j) + 1)
    };
    // The limit keeps 2⁻ˢ a normal number; on the other side s is −1022 or more, because exponents are −1023 or more.
    (1..).zip(coefficients).filter_map(of_power).max().unwrap_or(0).min(1022)
}

/// ⌊log₂ x⌋ of a positive normal number; −1023 of a subnormal one.
fn binary_exponent(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32 - 1023
}

/// 2ˢ for s in −1022..=1023.
fn power_of_two(s: i32) -> f64 {
    f64::from_bits(((s + 1023) as u64) << 52)
}

/// log₂ x with the mantissa's part interpolated linearly, which is exact at powers of two and wrong by less than 0.09
/// elsewhere: good enough for the radius of a circle, fast, and the same bits on all machines.
fn rough_log2(x: f64) -> f64 {
    x.to_bits() as f64 / (1u64 << 52) as f64 - 1023.0
}

/// The inverse of [`rough_log2`].
fn rough_exp2(log: f64) -> f64 {
    f64::from_bits(((log + 1023.0) * (1u64 << 52) as f64) as u64)
}

/// Roots of w² + c_1 w + c_0.
///
/// The one farther from zero is a sum without cancellation, the other follows from the product c_0 of both.
fn quadratic(c_1: Complex<f64>, c_0: Complex<f64>) -> [Complex<f64>; 2] {
    let middle = c_1 * -0.5;
    let offset = square_root(middle * middle - c_0);
    let points_outwards = middle.re * offset.re + middle.im * offset.im >= 0.0;
    let far = if points_outwards { middle + offset } else { middle - offset };
    [far, quotient(c_0, far)]
}

/// Whether a squared modulus has neither overflowed nor lost digits to underflow.
#[inline(always)]
pub fn is_safe_square(square: f64) -> bool {
    square > SAFE_SQUARE && square < f64::INFINITY
}

/// The square root with a real part that is not negative, without the polar form and its rounding.
#[inline]
pub fn square_root(z: Complex<f64>) -> Complex<f64> {
    let square = z.norm_sqr();
    let modulus = if is_safe_square(square) { square.sqrt() } else { z.norm() };
    let larger_part = (0.5 * (modulus + z.re.abs())).sqrt();
    if larger_part == 0.0 {
        return ZERO;
    }
    let smaller_part = 0.5 * z.im / larger_part;
    if z.re >= 0.0 {
        Complex::new(larger_part, smaller_part)
    } else {
        Complex::new(smaller_part.abs(), larger_part.copysign(z.im))
    }
}

/// Starting points from the Newton polygon, the upper convex hull of the points (power, log₂ of the coefficient's
/// modulus).
///
/// An edge that spans m powers and rises by h towards lower powers stands for m roots of modulus near 2^(h/m); the hull
/// is followed from the leading power down, so from the largest roots to the smallest.
fn start(coefficients: &[Complex<f64>], roots: &mut [Complex<f64>]) {
    // Position 0 is the leading coefficient, position j the coefficient at index j − 1.
    let (mut position, mut height) = (0, 0.0);
    let mut direction = FIRST_DIRECTION;
    while position < coefficients.len() {
        let (mut end, mut end_height, mut steepest) = (position, height, f64::NEG_INFINITY);
        for (j, c) in (position + 1..).zip(&coefficients[position..]) {
            let height_j = rough_log2(c.l1_norm());
            let slope = (height_j - height) / (j - position) as f64;
            if slope >= steepest {
                (end, end_height, steepest) = (j, height_j, slope);
            }
        }
        let radius = rough_exp2(steepest);
        for root in &mut roots[position..end] {
            *root = direction * radius;
            direction *= GOLDEN_TURN;
        }
        (position, height) = (end, end_height);
    }
}

/// Corrects all roots in turn, each with the newest approximations of the others, until all have settled.
fn iterate(coefficients: &[Complex<f64>], roots: &mut [Complex<f64>]) {
    // Settled roots are moved behind the active ones.
    let mut active = roots.len();
    for _ in 0..MAX_SWEEPS {
        for i in (0..active).rev() {
            let has_settled = correct(coefficients, roots, i);
            if has_settled {
                active -= 1;
                roots.swap(i, active);
            }
        }
        if active == 0 {
            break;
        }
    }
}

/// Corrects root `i` and says whether it is now as accurate as it can be.
fn correct(coefficients: &[Complex<f64>], roots: &mut [Complex<f64>], i: usize) -> bool {
    let z = roots[i];
    let Value { value, slope, rounding } = horner(coefficients, z);
    // Not the square of |p|, which may underflow.
    if value.l1_norm() <= rounding {
        return true;
    }
    let (before, after) = roots.split_at(i);
    let (mut repulsion, mut crowding) = (ZERO, 0.0);
    for &other in before.iter().chain(&after[1..]) {
        let push = inverse(z - other);
        repulsion += push;
        crowding += push.l1_norm();
    }
    let correction = quotient(value, slope - value * repulsion);
    // Where p′ = p Σ there is no correction; the next sweep finds the other roots elsewhere.
    if !(correction.re.is_finite() && correction.im.is_finite()) {
        return false;
    }
    roots[i] = z - correction;
    // As long as every other approximation is nearer to its root than to this one, the error that is left is below
    // |correction|² Σ 1/|z_i − z_j|.
    let step = correction.l1_norm();
    step * (step * crowding).min(1.0) <= f64::EPSILON * roots[i].l1_norm()
}

/// A polynomial at a point.
struct Value {
    /// p(z).
    value: Complex<f64>,
    /// p′(z).
    slope: Complex<f64>,
    /// About the rounding error of `value`.
    rounding: f64,
}

/// Horner's scheme for p and p′, and for the polynomial with the moduli of coefficients and argument, of which the
/// rounding error is a multiple.
fn horner(coefficients: &[Complex<f64>], z: Complex<f64>) -> Value {
    let modulus = z.norm_sqr().sqrt();
    let (mut value, mut slope, mut moduli) = (Complex::new(1.0, 0.0), ZERO, 1.0);
    for &c in coefficients {
        slope = slope * z + value;
        value = value * z + c;
        moduli = moduli * modulus + c.l1_norm();
    }
    Value { value, slope, rounding: ROUNDING_OF_A_STEP * coefficients.len() as f64 * moduli }
}

/// 1/d, or 0 for d = 0: two approximations that coincide do not repel each other.
fn inverse(d: Complex<f64>) -> Complex<f64> {
    let square = d.norm_sqr();
    if square >= SAFE_SQUARE {
        return d.conj() * (1.0 / square);
    }
    let larger = d.re.abs().max(d.im.abs());
    if larger == 0.0 {
        return ZERO;
    }
    let scaled = d / larger;
    scaled.conj() / scaled.norm_sqr() / larger
}

/// a/b.
fn quotient(a: Complex<f64>, b: Complex<f64>) -> Complex<f64> {
    let square = b.norm_sqr();
    if square >= SAFE_SQUARE {
        return a * (b.conj() * (1.0 / square));
    }
    let larger = b.re.abs().max(b.im.abs());
    let scaled = b / larger;
    a / larger * (scaled.conj() / scaled.norm_sqr())
}

#[cfg(test)]
mod tests;
