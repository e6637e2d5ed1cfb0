//! What users see when a name or a text is wrong, and the parser's use of the stack.

use super::graph::MOST_NODES;
use super::nesting::DEEPEST_NESTING;
use super::parser::{Item, parse};
use super::{Compiler, ExpressionError};

/// Stack on which the deepest expressions must be read: an eighth of what threads have.
const SMALL_STACK: usize = 256 * 1024;

fn compiler() -> Compiler {
    let mut compiler = Compiler::new(&["mu", "k_p", "k_f", "gamma_1", "r"]).unwrap();
    compiler.constant("c_A", 4.0).unwrap();
    compiler.define("k_A", "gamma_1*k_p/4").unwrap();
    compiler
}

/// Postfix notation, words and numbers.
fn postfix(text: &str) -> String {
    let word = |item| match item {
        Item::Number(value) => format!("{value}"),
        Item::Name { name, .. } => name.to_owned(),
        Item::Apply(operation) => format!("{operation:?}"),
    };
    parse(text).unwrap().into_iter().map(word).collect::<Vec<_>>().join(" ")
}

#[test]
fn operations_follow_their_operands() {
    assert_eq!(postfix("-(a + 2)"), "a 2 Add Negate");
    assert_eq!(postfix("-x^2"), "x 2 Power Negate");
    assert_eq!(postfix("2^-x^2*y"), "2 x 2 Power Negate Power y Multiply");
    assert_eq!(postfix("a - b - max(c, -d*e)"), "a b Subtract c d Negate e Multiply Maximum Subtract");
    assert_eq!(postfix("a*b + c/d^e^f"), "a b Multiply c d e f Power Power Divide Add");
    assert_eq!(postfix("+-+a"), "a Negate");
}

#[test]
fn texts_that_are_no_expressions() {
    let unclosed = format!("{}x", "(".repeat(40));
    let long = format!("{} + k_q", ["k_A*k_p"; 12].join(" + "));
    let (too_long, too_deep) = ("x+".repeat(6000), "(".repeat(10_000));
    let texts = [
        "",
        " \t\n",
        "2*k_q + 1",
        "gama_1",
        "K_F",
        "π",
        "2*(a",
        "2*(mu",
        "(mu",
        "mu)",
        "(mu))*(r",
        "()",
        "sin()",
        "mu +",
        "*mu",
        "mu*/r",
        "2 mu",
        "2mu",
        "mu r",
        "(mu)(r)",
        "2(mu)",
        "(mu)2",
        "mu(2)",
        "k_A (r)",
        "sine(mu)",
        "(mu) sin(r)",
        "mu**2",
        "k = 2",
        "sin mu",
        "sin",
        "sin^2(mu)",
        "log(mu)",
        "log",
        "sin(mu, r)",
        "max(mu)",
        "max(mu, r, 2)",
        "atan2()",
        "max(mu r)",
        "max(mu, r",
        "mu, r",
        "(mu, r)",
        "0,5",
        "1.2.3",
        ".",
        "1e999",
        "mu² + r",
        "2·mu",
        "µ",
        "mu − r",
        "é",
        "mu[1]",
        "{mu}",
        "mu\u{0}",
        "mu\u{1b}[31m",
        "mu\u{a0}",
        "mu = \"r\"",
        "𝔞",
        "30°",
        &unclosed,
        &long,
        &too_long,
        &too_deep,
    ];
    let mut messages = String::new();
    for text in texts {
        messages += &format!("{}\n", compiler().expression(text).unwrap_err());
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn names_that_cannot_be_given() {
    let mut compiler = compiler();
    let errors = [
        compiler.constant("2k", 1.0),
        compiler.constant("", 1.0),
        compiler.constant("k\nA", 1.0),
        compiler.constant("sin", 1.0),
        compiler.constant("mu", 1.0),
        compiler.constant("k_B", f64::NAN),
        compiler.define("k_B", "k_B + 1"),
        compiler.define("k_A", "1"),
        compiler.define("pi", "1"),
        compiler.define("log", "1"),
        Compiler::new(&["mu", "r", "mu"]).map(|_| ()),
        Err(ExpressionError::TooManyOperations),
    ];
    let messages: Vec<String> = errors.into_iter().map(|error| error.unwrap_err().to_string()).collect();
    insta::assert_snapshot!(messages.join("\n"));
}

#[test]
fn a_refused_text_leaves_the_compiler_as_it_was() {
    let mut compiler = compiler();
    compiler.define("k_B", "2*k_q").unwrap_err();
    compiler.define("k_B", "2*k_p").unwrap();
    compiler.expression("k_B + ").unwrap_err();
    assert_eq!(compiler.expression("k_B").unwrap().position(), 0);
    assert_eq!(compiler.finish().unwrap().outputs(), 1);
}

#[test]
fn the_deepest_expressions_fit_a_small_stack() {
    let reads_all = || {
        for (open, close) in
            [("(", ")"), ("-", ""), ("x^", ""), ("sin(", ")"), ("max(1, ", ")"), ("1+1*(", ")"), ("max(1, 1+1*", ")")]
        {
            let text = |levels| format!("{}x{}", open.repeat(levels), close.repeat(levels));
            let mut compiler = Compiler::new(&["x"]).unwrap();
            assert!(compiler.expression(&text(DEEPEST_NESTING)).is_ok(), "{open}");
            assert!(compiler.expression(&text(DEEPEST_NESTING + 1)).is_err(), "{open}");
        }
    };
    std::thread::Builder::new().stack_size(SMALL_STACK).spawn(reads_all).unwrap().join().unwrap();
}

#[test]
fn long_chains_of_definitions_are_no_depth() {
    let mut compiler = Compiler::new(&["x"]).unwrap();
    let mut last = "x".to_owned();
    for step in 0..20_000 {
        let name = format!("x{step}");
        compiler.define(&name, &format!("sin({last}) + {last}*x")).unwrap();
        last = name;
    }
    compiler.expression(&last).unwrap();
    let program = compiler.finish().unwrap();
    let mut workspace = program.workspace();
    assert!(program.differentiate(&[0.1], &mut workspace).derivatives[0].is_finite());
}

#[test]
fn too_many_operations_are_refused_in_time() {
    // Products of many variables have as many derivatives as factors, each with new operations.
    let names: Vec<String> = (0..400).map(|j| format!("x{j}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut compiler = Compiler::new(&names).unwrap();
    for degree in 1..30 {
        let factors: Vec<String> = names.iter().map(|name| format!("sin({degree}*{name})")).collect();
        compiler.expression(&factors.join("*")).unwrap();
    }
    assert_eq!(compiler.finish().unwrap_err(), ExpressionError::TooManyOperations);
}

#[test]
fn too_many_definitions_are_refused() {
    let mut compiler = Compiler::new(&["x"]).unwrap();
    let refused = (0..=MOST_NODES / 2_000).find_map(|step| {
        let terms: Vec<String> = (0..900).map(|term| format!("x*{term}.{step}1")).collect();
        compiler.expression(&terms.join("+")).err()
    });
    assert_eq!(refused, Some(ExpressionError::TooManyOperations));
}
