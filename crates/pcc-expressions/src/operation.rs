//! Elementary operations: what users may call, and a few more that derivatives need.

/// An operation on one, two or three numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Operation {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Negate,
    Sine,
    Cosine,
    Tangent,
    ArcSine,
    ArcCosine,
    ArcTangent,
    HyperbolicSine,
    HyperbolicCosine,
    HyperbolicTangent,
    Exponential,
    Logarithm,
    DecimalLogarithm,
    SquareRoot,
    Absolute,
    /// The angle of the point (second, first).
    Angle,
    Minimum,
    Maximum,
    /// A power whose exponent is an integer of at most [`LARGEST_PRODUCT`]: repeated multiplication.
    IntegerPower,
    /// −1, 0 or 1.
    Sign,
    /// 1 if the first is at least as large as the second, otherwise 0.
    IsAtLeast,
    /// The second if the first is 1, the third if it is 0.
    Choose,
    /// First times the logarithm of the second, where 0 times anything is 0: xʸ ln x → 0 for xʸ → 0, and an exponent
    /// that does not change needs no logarithm.
    TimesLogarithm,
}

/// Largest exponent, positive or negative, for which a power is computed by multiplications: at most seven, which are
/// faster than the general power and lose less than its callers' other roundings.
pub(super) const LARGEST_PRODUCT: f64 = 16.0;

/// Functions by the names that users write.
pub(super) const FUNCTIONS: [(&str, Operation); 17] = [
    ("sin", Operation::Sine),
    ("cos", Operation::Cosine),
    ("tan", Operation::Tangent),
    ("asin", Operation::ArcSine),
    ("acos", Operation::ArcCosine),
    ("atan", Operation::ArcTangent),
    ("sinh", Operation::HyperbolicSine),
    ("cosh", Operation::HyperbolicCosine),
    ("tanh", Operation::HyperbolicTangent),
    ("exp", Operation::Exponential),
    ("ln", Operation::Logarithm),
    ("log10", Operation::DecimalLogarithm),
    ("sqrt", Operation::SquareRoot),
    ("abs", Operation::Absolute),
    ("atan2", Operation::Angle),
    ("min", Operation::Minimum),
    ("max", Operation::Maximum),
];

/// The function that users call `name`.
pub(super) fn function(name: &str) -> Option<Operation> {
    FUNCTIONS.iter().find(|(known, _)| *known == name).map(|&(_, operation)| operation)
}

impl Operation {
    /// Number of operands.
    pub fn arity(self) -> usize {
        match self {
            Self::Choose => 3,
            Self::Add | Self::Subtract | Self::Multiply | Self::Divide | Self::Power | Self::IntegerPower => 2,
            Self::Angle | Self::Minimum | Self::Maximum | Self::IsAtLeast | Self::TimesLogarithm => 2,
            _ => 1,
        }
    }

    /// The result, with `operand(k)` for operand number k.
    #[inline(always)]
    pub fn apply(self, operand: impl Fn(usize) -> f64) -> f64 {
        let first = operand(0);
        match self {
            Self::Add => first + operand(1),
            Self::Subtract => first - operand(1),
            Self::Multiply => first * operand(1),
            Self::Divide => first / operand(1),
            Self::Power => first.powf(operand(1)),
            Self::IntegerPower => integer_power(first, operand(1)),
            Self::Negate => -first,
            Self::Sine => first.sin(),
            Self::Cosine => first.cos(),
            Self::Tangent => first.tan(),
            Self::ArcSine => first.asin(),
            Self::ArcCosine => first.acos(),
            Self::ArcTangent => first.atan(),
            Self::HyperbolicSine => first.sinh(),
            Self::HyperbolicCosine => first.cosh(),
            Self::HyperbolicTangent => first.tanh(),
            Self::Exponential => first.exp(),
            Self::Logarithm => first.ln(),
            Self::DecimalLogarithm => first.log10(),
            Self::SquareRoot => first.sqrt(),
            Self::Absolute => first.abs(),
            Self::Angle => first.atan2(operand(1)),
            Self::Minimum => choose(is_at_least(operand(1), first), first, operand(1)),
            Self::Maximum => choose(is_at_least(first, operand(1)), first, operand(1)),
            Self::Sign => sign(first),
            Self::IsAtLeast => is_at_least(first, operand(1)),
            Self::Choose => choose(first, operand(1), operand(2)),
            Self::TimesLogarithm => times_logarithm(first, operand(1)),
        }
    }
}

/// xⁿ for an integer n of at most [`LARGEST_PRODUCT`], by squaring; 1/x⁻ⁿ if n is negative.
fn integer_power(x: f64, n: f64) -> f64 {
    let mut remaining = n.abs() as u32;
    let (mut square, mut product) = (x, 1.0);
    while remaining > 0 {
        if remaining % 2 == 1 {
            product *= square;
        }
        square *= square;
        remaining /= 2;
    }
    if n < 0.0 { 1.0 / product } else { product }
}

/// −1, 0 or 1; NaN for NaN.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// 1 or 0; NaN if the numbers have no order.
fn is_at_least(x: f64, y: f64) -> f64 {
    if x >= y {
        1.0
    } else if x < y {
        0.0
    } else {
        f64::NAN
    }
}

fn choose(condition: f64, if_one: f64, if_zero: f64) -> f64 {
    if condition == 1.0 {
        if_one
    } else if condition == 0.0 {
        if_zero
    } else {
        f64::NAN
    }
}

fn times_logarithm(factor: f64, x: f64) -> f64 {
    if factor == 0.0 { 0.0 } else { factor * x.ln() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integer_powers_are_products() {
        for n in -16..=16 {
            let x: f64 = 1.3;
            let relative = integer_power(x, f64::from(n)) / x.powi(n) - 1.0;
            assert!(relative.abs() < 16.0 * f64::EPSILON, "exponent {n}: {relative:e}");
        }
        assert_eq!(integer_power(-2.0, 3.0), -8.0);
        assert_eq!(integer_power(0.0, -3.0), f64::INFINITY);
    }

    #[test]
    fn not_a_number_is_passed_on() {
        for operation in [Operation::Minimum, Operation::Maximum, Operation::IsAtLeast, Operation::Angle] {
            assert!(operation.apply(|k| [f64::NAN, 1.0][k]).is_nan());
            assert!(operation.apply(|k| [1.0, f64::NAN][k]).is_nan());
        }
        assert!(Operation::Sign.apply(|_| f64::NAN).is_nan());
        assert!(Operation::Choose.apply(|k| [f64::NAN, 1.0, 1.0][k]).is_nan());
    }
}
