//! Expressions by known values: precedence, functions, derivatives, and how programs are made.

use pcc_expressions::{Compiler, Derivative, Program};
use std::f64::consts::{E, LN_10, PI};

/// Allowed relative error of derivatives that are known in closed form.
const TOLERANCE: f64 = 1e-14;

fn program(variables: &[&str], texts: &[&str]) -> Program {
    let mut compiler = Compiler::new(variables).unwrap();
    for text in texts {
        compiler.expression(text).unwrap();
    }
    compiler.finish().unwrap()
}

fn value(text: &str) -> f64 {
    let program = program(&["a", "b", "c", "x"], &[text]);
    program.evaluate(&[2.0, 3.0, 5.0, -4.0], &mut program.workspace())[0]
}

/// Value and derivative of an expression in x.
fn at(text: &str, x: f64) -> (f64, f64) {
    let program = program(&["x"], &[text]);
    let mut workspace = program.workspace();
    let evaluated = program.differentiate(&[x], &mut workspace);
    (evaluated.values[0], evaluated.derivatives.first().copied().unwrap_or(0.0))
}

#[test]
fn precedence_is_that_of_mathematics() {
    let table = [
        ("-x^2", -16.0),
        ("-2^2", -4.0),
        ("(-x)^2", 16.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2^-x^2*3", 3.0 * 2.0_f64.powi(-16)),
        ("2^-1^2", 0.5),
        ("a^-b*c", 0.625),
        ("a/b/c", 2.0 / 3.0 / 5.0),
        ("a-b-c", -6.0),
        ("a-b+c", 4.0),
        ("a+b-c", 0.0),
        ("a/b*c", 2.0 / 3.0 * 5.0),
        ("a*b/c", 1.2),
        ("-a*b", -6.0),
        ("a*-b", -6.0),
        ("--a", 2.0),
        ("a--b", 5.0),
        ("a+-+-b", 5.0),
        ("2*-3", -6.0),
        ("a+b*c^2", 77.0),
        ("(a+b)*c", 25.0),
        ("a*b^2", 18.0),
        ("a^b*c", 40.0),
        ("-a^2/b", -4.0 / 3.0),
        ("a - -b^2", 11.0),
        ("max(a, b)", 3.0),
        ("min(a, -b)", -3.0),
        ("max(a, max(b, c))", 5.0),
        ("max(max(a, c), b)*2 + 1", 11.0),
        ("min(a, b)^max(a, b)", 8.0),
        ("atan2(a, -b)", 2.0_f64.atan2(-3.0)),
        ("-sin(a)^2", -(2.0_f64.sin() * 2.0_f64.sin())),
        ("pi", PI),
        ("2*pi*a", 2.0 * PI * 2.0),
        ("1e-3", 1e-3),
        ("16e6", 16e6),
        (".5+2.", 2.5),
        ("1E+3", 1e3),
        ("\n a +\r\n\tb ", 5.0),
    ];
    for (text, expected) in table {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn names_may_look_like_functions_and_numbers() {
    let names = ["sin_beta", "pi_2", "max_k", "exp1", "e", "E", "k_A", "γ_1", "Ω", "_", "e3", "Sin", "x1e5"];
    let program = program(&names, &names);
    let values: Vec<f64> = (0..names.len()).map(|j| j as f64).collect();
    assert_eq!(program.evaluate(&values, &mut program.workspace()), values);
}

#[test]
fn functions_and_their_derivatives() {
    let (x, y) = (0.6_f64, 1.7_f64);
    let table = [
        ("sin(x)", x, x.sin(), x.cos()),
        ("cos(x)", x, x.cos(), -x.sin()),
        ("tan(x)", x, x.tan(), 1.0 / x.cos().powi(2)),
        ("asin(x)", x, x.asin(), 1.0 / 0.8),
        ("acos(x)", x, x.acos(), -1.0 / 0.8),
        ("atan(x)", x, x.atan(), 1.0 / 1.36),
        ("sinh(x)", x, x.sinh(), x.cosh()),
        ("cosh(x)", x, x.cosh(), x.sinh()),
        ("tanh(x)", x, x.tanh(), 1.0 - x.tanh().powi(2)),
        ("tanh(x)", 20.0, 1.0, 4.0 * (-40.0_f64).exp()),
        ("exp(x)", x, x.exp(), x.exp()),
        ("ln(x)", y, y.ln(), 1.0 / y),
        ("log10(x)", y, y.log10(), 1.0 / (y * LN_10)),
        ("sqrt(x)", y, y.sqrt(), 0.5 / y.sqrt()),
        ("abs(x)", -y, y, -1.0),
        ("abs(x)", y, y, 1.0),
        ("abs(x)", 0.0, 0.0, 0.0),
        ("atan2(x, 2)", x, 0.3_f64.atan(), 2.0 / 4.36),
        ("atan2(2, x)", x, 2.0_f64.atan2(x), -2.0 / 4.36),
        ("atan2(-x, -2*x)", x, (-1.0_f64).atan2(-2.0), 0.0),
        ("min(x, x^2)", x, 0.36, 1.2),
        ("max(x, x^2)", x, 0.6, 1.0),
        ("min(x, x^2)", 1.0, 1.0, 1.0),
        ("max(x, x^2)", 1.0, 1.0, 1.0),
        ("max(x^2, x)", 1.0, 1.0, 2.0),
        ("max(x, 0)", -1.0, 0.0, 0.0),
        ("x^2", 0.0, 0.0, 0.0),
        ("x^2", -3.0, 9.0, -6.0),
        ("x^3", 0.0, 0.0, 0.0),
        ("x^3", -2.0, -8.0, 12.0),
        ("x^-1", 2.0, 0.5, -0.25),
        ("x^-3", 2.0, 0.125, -0.1875),
        ("x^16", 2.0, 65_536.0, 524_288.0),
        ("x^17", 2.0, 131_072.0, 1_114_112.0),
        ("x^20", 0.0, 0.0, 0.0),
        ("x^1.5", 4.0, 8.0, 3.0),
        ("x^1.5", 0.0, 0.0, 0.0),
        ("x^0", 0.0, 1.0, 0.0),
        ("x^1", 0.0, 0.0, 1.0),
        ("2^x", 3.0, 8.0, 8.0 * 2.0_f64.ln()),
        ("0^x", 2.0, 0.0, 0.0),
        ("x^x", 2.0, 4.0, 4.0 * (1.0 + 2.0_f64.ln())),
        ("(-2)^max(2, x)", 1.0, 4.0, 0.0),
        ("x^(x + 1)", 0.0, 0.0, 1.0),
        ("exp(ln(x))*x", E, E * E, 2.0 * E),
        ("(x + 1)/(x - 1)", 3.0, 2.0, -0.5),
        ("1/x", 4.0, 0.25, -0.0625),
        ("-x/-2", 4.0, 2.0, 0.5),
        ("x - x", 4.0, 0.0, 0.0),
        ("x + x", 4.0, 8.0, 2.0),
        ("sin(cos(x)^2)", x, (x.cos().powi(2)).sin(), -2.0 * x.cos() * x.sin() * x.cos().powi(2).cos()),
    ];
    for (text, x, expected_value, expected_slope) in table {
        let (value, slope) = at(text, x);
        let is_near = |found: f64, expected: f64| (found - expected).abs() <= TOLERANCE * expected.abs();
        assert!(is_near(value, expected_value), "{text} at {x}: {value}, expected {expected_value}");
        assert!(is_near(slope, expected_slope), "{text} at {x}: slope {slope}, expected {expected_slope}");
    }
}

#[test]
fn what_is_not_defined_is_left_to_the_caller() {
    for (text, x) in [("ln(x)", -1.0), ("sqrt(x)", -1.0), ("asin(x)", 2.0), ("x/x", 0.0), ("(-2)^x", 0.5)] {
        assert!(at(text, x).0.is_nan(), "{text}");
    }
    assert_eq!(at("1/x", 0.0).0, f64::INFINITY);
    assert_eq!(at("sqrt(x)", 0.0), (0.0, f64::INFINITY));
    for text in ["min(x, 1)", "max(1, x)", "abs(x)", "max(x, 2*x)"] {
        let (value, slope) = at(text, f64::NAN);
        assert!(value.is_nan() && slope.is_nan(), "{text}");
    }
}

#[test]
fn zero_constants_leave_structural_zeros() {
    let mut compiler = Compiler::new(&["r", "mu", "k"]).unwrap();
    compiler.constant("c", 0.0).unwrap();
    compiler.define("lever", "c*r + 0*mu").unwrap();
    let texts = ["lever", "lever*k", "r + lever", "-lever/r", "c^2*k + 3", "k - lever"];
    let outputs = texts.map(|text| compiler.expression(text).unwrap());
    let plain = compiler.number(-0.5);
    let constants = outputs.map(|output| compiler.value_if_constant(output));
    assert_eq!(constants, [Some(0.0), Some(0.0), None, Some(0.0), Some(3.0), None]);
    assert_eq!(compiler.value_if_constant(plain), Some(-0.5));
    assert_eq!(compiler.uses(outputs[2]), [true, false, false]);
    assert_eq!(compiler.uses(plain), [false; 3]);
    assert_eq!(compiler.unused_variables(), ["mu"]);
    let program = compiler.finish().unwrap();
    let by = |output, variable| Derivative { output, variable };
    assert_eq!(program.derivatives(), [by(2, 0), by(5, 2)]);
    assert_eq!([0, 1, 2, 3].map(|variable| program.derivatives_by(variable)), [0..1, 1..1, 1..2, 2..2]);
    assert_eq!(program.evaluate(&[1.5, 2.5, 3.5], &mut program.workspace()), [0.0, 0.0, 1.5, 0.0, 3.0, 3.5, -0.5]);
}

#[test]
fn what_entries_share_is_computed_once() {
    let separate = program(&["a", "b", "r"], &["r*(a + b)"]);
    let shared = program(&["a", "b", "r"], &["r*(a + b)", "(b + a)*r", "-(r*(b + a))", "-r*(a + b)", "a + b"]);
    assert_eq!((separate.operations().0, shared.operations().0), (2, 3));
}

#[test]
fn programs_without_variables_or_outputs() {
    let none = program(&[], &[]);
    assert!(none.evaluate(&[], &mut none.workspace()).is_empty());
    let constant = program(&[], &["2*pi", "3"]);
    let mut workspace = constant.workspace();
    let evaluated = constant.differentiate(&[], &mut workspace);
    assert_eq!((evaluated.values, evaluated.derivatives), (&[2.0 * PI, 3.0][..], &[][..]));
    assert_eq!(constant.operations(), (0, 0));
}

#[test]
fn a_foreign_workspace_works() {
    let (small, large) = (program(&["x"], &["x"]), program(&["x", "y"], &["x*y + 2", "sin(x)"]));
    let mut workspace = small.workspace();
    assert_eq!(large.evaluate(&[2.0, 3.0], &mut workspace)[0], 8.0);
    assert_eq!(small.differentiate(&[4.0], &mut workspace).values, [4.0]);
    assert_eq!(large.differentiate(&[2.0, 3.0], &mut workspace).derivatives, [3.0, 2.0_f64.cos(), 2.0]);
}

#[test]
fn threads_share_a_program() {
    fn is_shared<T: Send + Sync + Clone + std::fmt::Debug + PartialEq>(_: &T) {}
    let program = program(&["x"], &["x^2 + ln(2)"]);
    is_shared(&program);
    is_shared(&program.workspace());
    assert_eq!(program, program.clone());
}
