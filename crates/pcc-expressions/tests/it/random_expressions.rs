//! Properties of all expressions: random trees against a straightforward evaluator and central differences, and
//! arbitrary text against panics.

use pcc_expressions::{Compiler, ExpressionError, Program};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Names that collide with functions as far as they may.
const NAMES: [&str; 3] = ["x", "sin_x", "γ_1"];

const UNARY: [&str; 15] =
    ["-", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "ln", "log10", "sqrt", "abs"];

const BINARY: [&str; 8] = ["+", "-", "*", "/", "^", "atan2", "min", "max"];

#[derive(Debug, Clone)]
enum Tree {
    Number(f64),
    Variable(usize),
    Unary(&'static str, Box<Tree>),
    Binary(&'static str, Box<Tree>, Box<Tree>),
}

/// A value, and whether it is the same for all variables and the compiler knows.
#[derive(Debug, Clone, Copy)]
struct Known {
    value: f64,
    is_constant: bool,
}

impl Tree {
    /// The value; none where an intermediate result is not finite, is zero, whose sign is not kept, or is at the edge
    /// of a function's domain, where slopes are infinite.
    fn value(&self, variables: &[f64]) -> Option<Known> {
        let known = match self {
            Self::Number(value) => Known { value: *value, is_constant: true },
            Self::Variable(j) => Known { value: variables[*j], is_constant: false },
            Self::Unary(name, a) => {
                let a = a.value(variables)?;
                if ["asin", "acos"].contains(name) && a.value.abs() >= 1.0 {
                    return None;
                }
                Known { value: unary(name, a.value), ..a }
            }
            Self::Binary(name, a, b) => {
                let (a, b) = (a.value(variables)?, b.value(variables)?);
                let is_one = *name == "^" && a.is_constant && a.value == 1.0;
                Known { value: binary(name, a, b), is_constant: a.is_constant && b.is_constant || is_one }
            }
        };
        (known.value.is_finite() && known.value != 0.0).then_some(known)
    }

    /// Text with as few parentheses as possible. `strength` is that of the operator around it.
    fn text(&self, strength: u8) -> String {
        let (own, text) = match self {
            Self::Number(value) if *value < 0.0 => (2, format!("{value:?}")),
            Self::Number(value) => (9, format!("{value:?}")),
            Self::Variable(j) => (9, NAMES[*j].to_owned()),
            Self::Unary("-", a) => (2, format!("-{}", a.text(2))),
            Self::Unary(name, a) => (9, format!("{name}({})", a.text(0))),
            Self::Binary(name @ ("+" | "-"), a, b) => (0, format!("{} {name} {}", a.text(0), b.text(1))),
            Self::Binary(name @ ("*" | "/"), a, b) => (1, format!("{}{name}{}", a.text(1), b.text(2))),
            // A sign may stand in an exponent.
            Self::Binary("^", a, b) => (3, format!("{}^{}", a.text(4), b.text(2))),
            Self::Binary(name, a, b) => (9, format!("{name}({}, {})", a.text(0), b.text(0))),
        };
        if own < strength { format!("({text})") } else { text }
    }
}

fn unary(name: &str, a: f64) -> f64 {
    match name {
        "-" => -a,
        "sin" => a.sin(),
        "cos" => a.cos(),
        "tan" => a.tan(),
        "asin" => a.asin(),
        "acos" => a.acos(),
        "atan" => a.atan(),
        "sinh" => a.sinh(),
        "cosh" => a.cosh(),
        "tanh" => a.tanh(),
        "exp" => a.exp(),
        "ln" => a.ln(),
        "log10" => a.log10(),
        "sqrt" => a.sqrt(),
        "abs" => a.abs(),
        _ => unreachable!("{name}"),
    }
}

fn binary(name: &str, a: Known, b: Known) -> f64 {
    let is_product = b.is_constant && !a.is_constant && b.value.fract() == 0.0 && b.value.abs() <= 16.0;
    match (name, a.value, b.value) {
        ("+", a, b) => a + b,
        ("-", a, b) => a - b,
        ("*", a, b) => a * b,
        ("/", a, b) => a / b,
        ("^", a, n) if is_product && n < 0.0 => 1.0 / product(a, -n),
        ("^", a, n) if is_product => product(a, n),
        ("^", a, b) => a.powf(b),
        ("atan2", a, b) => a.atan2(b),
        ("min", a, b) => a.min(b),
        ("max", a, b) => a.max(b),
        _ => unreachable!("{name}"),
    }
}

/// aⁿ by the binary digits of n, from the last.
fn product(a: f64, n: f64) -> f64 {
    let n = n as u32;
    let squares = std::iter::successors(Some(a), |square| Some(square * square));
    squares
        .take(5)
        .enumerate()
        .filter(|(digit, _)| n >> digit & 1 == 1)
        .fold(1.0, |product, (_, square)| product * square)
}

fn trees() -> impl Strategy<Value = Tree> {
    let numbers = prop_oneof![
        prop::sample::select(vec![1.0, 2.0, 3.0, 4.0, 0.5, 0.25, 7.0, -1.0, -2.0, 1e-3]).prop_map(Tree::Number),
        (0.01..10.0).prop_map(Tree::Number),
    ];
    let leaves = prop_oneof![1 => numbers, 2 => (0..NAMES.len()).prop_map(Tree::Variable)];
    leaves.prop_recursive(6, 24, 2, |inner| {
        let unary = (prop::sample::select(UNARY.to_vec()), inner.clone());
        let binary = (prop::sample::select(BINARY.to_vec()), inner.clone(), inner);
        prop_oneof![
            1 => unary.prop_map(|(name, a)| Tree::Unary(name, a.into())),
            3 => binary.prop_map(|(name, a, b)| Tree::Binary(name, a.into(), b.into())),
        ]
    })
}

fn points() -> impl Strategy<Value = [f64; 3]> {
    [0.05..2.0, 0.05..2.0, 0.05..2.0_f64]
}

fn compile(text: &str) -> Result<Program, ExpressionError> {
    let mut compiler = Compiler::new(&NAMES)?;
    compiler.expression(text)?;
    compiler.finish()
}

/// (f(x + h e_j) − f(x − h e_j))/2h.
fn central_difference(tree: &Tree, point: &[f64; 3], j: usize, h: f64) -> Option<f64> {
    let (mut above, mut below) = (*point, *point);
    above[j] += h;
    below[j] -= h;
    Some((tree.value(&above)?.value - tree.value(&below)?.value) / (above[j] - below[j]))
}

proptest! {
    // The same cases every time: a random one may lie on a kink, where differences are not derivatives.
    #![proptest_config(ProptestConfig { cases: 4000, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn values_are_those_of_a_tree(tree in trees(), point in points()) {
        let text = tree.text(0);
        let program = compile(&text).unwrap();
        let mut workspace = program.workspace();
        if let Some(known) = tree.value(&point) {
            let value = program.evaluate(&point, &mut workspace)[0];
            prop_assert_eq!(value.to_bits(), known.value.to_bits(), "{}: {} and {}", text, value, known.value);
        }
        let value = program.evaluate(&point, &mut workspace)[0];
        let again = program.differentiate(&point, &mut workspace).values[0];
        prop_assert_eq!(value.to_bits(), again.to_bits());
    }

    #[test]
    fn derivatives_agree_with_central_differences(tree in trees(), point in points()) {
        let program = compile(&tree.text(0)).unwrap();
        let mut workspace = program.workspace();
        let evaluated = program.differentiate(&point, &mut workspace);
        for j in 0..NAMES.len() {
            let h = 1e-5;
            let [wide, narrow] = [h, h / 2.0].map(|h| central_difference(&tree, &point, j, h));
            let (Some(wide), Some(narrow)) = (wide, narrow) else { continue };
            let derivative = program.derivatives_by(j).next().map_or(0.0, |position| evaluated.derivatives[position]);
            // Rounding and curvature show as a difference of the differences.
            let doubt = 10.0 * (wide - narrow).abs() + 1e-9 * evaluated.values[0].abs();
            let tolerance = doubt + 1e-6 * narrow.abs();
            prop_assert!((derivative - narrow).abs() <= tolerance, "{}: {} and {}", tree.text(0), derivative, narrow);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_compiled_or_refused(text in any::<String>()) {
        if let Err(error) = compile(&text) {
            let message = error.to_string();
            prop_assert!(!message.contains(char::is_control), "{message}");
        }
    }

    #[test]
    fn any_words_are_compiled_or_refused(words in prop::collection::vec(prop::sample::select(vec![
        "(", ")", ",", "+", "-", "*", "/", "^", "x", "sin_x", "γ_1", "q", "sin", "max(", "atan2", "sqrt(", "log", "pi",
        "1", "2.5", "1e", ".", "1e400", "**", "=", " ", "\n", "\u{0}", "{", "}", "é", "²", "𝔞",
    ]), 0..60)) {
        let text = words.concat();
        match compile(&text) {
            Ok(program) => {
                program.differentiate(&[0.5; 3], &mut program.workspace());
            }
            Err(ExpressionError::Text { column, .. }) => prop_assert!((1..=text.chars().count() + 1).contains(&column)),
            Err(error) => prop_assert!(false, "{error}"),
        }
    }

    #[test]
    fn any_name_is_taken_or_refused(name in any::<String>()) {
        let _ = Compiler::new(&[&name]).map_err(|error| error.to_string());
    }
}
