//! The paper's figures 3 and 4, and the errors of all methods over what they cost.

use super::charts::points;
use crate::reproduce::{Cloud, PAIR, Row, TABLE_2};
use num_complex::Complex;
use pcc_charts::{Axis, Chart, Color, Guide, Marks, Series, Symbol};
use std::f64::consts::TAU;

type Pair = [Vec<Complex<f64>>; 2];

/// Figure 3: growth rates and frequencies of the pair that coalesces, over friction.
pub(super) fn figure_3(cloud: &Cloud) -> [Chart; 2] {
    let uncertain = uncertain(cloud.inputs);
    let chart = |title: &str, label: &str, part: fn(&Complex<f64>) -> f64, guides: Vec<Guide>| {
        let mode = |(position, color): (usize, Color)| {
            let marks = Marks::Points(points(&cloud.friction, cloud.model[position].iter().map(part)));
            Series::new(format!("mode {}", PAIR[position]), color, marks)
        };
        Chart {
            title: format!("{title}, {uncertain}"),
            description: format!(
                "{title} of modes {} and {} (the paper's 1 and 2) over the friction coefficient, {} model runs, {uncertain}.",
                PAIR[0],
                PAIR[1],
                cloud.friction.len()
            ),
            x: Axis::linear("friction coefficient μ"),
            y: Axis::linear(label),
            series: [(0, Color::Blue), (1, Color::Red)].map(mode).into(),
            guides,
        }
    };
    let limit = vec![Guide::Horizontal(0.0, "stability limit".to_owned())];
    [
        chart("Growth rates", "Re λ in 1/s", |lambda| lambda.re, limit),
        chart("Frequencies", "Im λ/2π in Hz", |lambda| lambda.im / TAU, Vec::new()),
    ]
}

/// Figure 4: growth rates of the pair over friction, by the model and by a surrogate.
pub(super) fn figure_4(cloud: &Cloud, method: &str, surrogate: &Pair) -> Chart {
    let both = |pair: &Pair| {
        let of_mode = |lambdas: &Vec<Complex<f64>>| points(&cloud.friction, lambdas.iter().map(|lambda| lambda.re));
        Marks::Points(pair.iter().flat_map(of_mode).collect())
    };
    Chart {
        title: format!("{}, {method}", uncertain(cloud.inputs)),
        description: format!(
            "Growth rates of modes {} and {} over the friction coefficient at {} points, {}: by the model, and over it by {method}.",
            PAIR[0],
            PAIR[1],
            cloud.friction.len(),
            uncertain(cloud.inputs)
        ),
        x: Axis::linear("friction coefficient μ"),
        y: Axis::linear("Re λ in 1/s"),
        series: vec![
            Series::new("model", Color::Blue, both(&cloud.model)),
            Series::new(method, Color::Red, both(surrogate)),
        ],
        guides: vec![Guide::Horizontal(0.0, "stability limit".to_owned())],
    }
}

fn uncertain(inputs: usize) -> String {
    format!("r = {inputs}")
}

/// A method of the table: its name and mark in pictures, and which rows are its own.
type Method = (&'static str, Color, Symbol, fn(&Row) -> bool);

fn is_of(row: &Row, method: &str, target: &str) -> bool {
    (row.method, row.target, row.derivatives) == (method, target, false)
}

/// The methods that are drawn, in the order of the table: a colour per method, a symbol per target.
const METHODS: [Method; 9] = [
    ("gPC", Color::Blue, Symbol::Circle, |row| is_of(row, "gpc", "eigenvalues")),
    ("ME-gPC", Color::Purple, Symbol::Circle, |row| is_of(row, "me-gpc", "eigenvalues")),
    ("sparse PC", Color::Red, Symbol::Circle, |row| is_of(row, "sparse", "eigenvalues")),
    ("gPC of invariants", Color::Blue, Symbol::Diamond, |row| is_of(row, "gpc", "invariants") && !row.is_least_squares),
    ("least squares of invariants", Color::Teal, Symbol::Diamond, |row| {
        is_of(row, "gpc", "invariants") && row.is_least_squares
    }),
    ("ME-gPC of invariants", Color::Purple, Symbol::Diamond, |row| is_of(row, "me-gpc", "invariants")),
    ("sparse PC of invariants", Color::Red, Symbol::Diamond, |row| is_of(row, "sparse", "invariants")),
    ("least squares with derivatives", Color::Teal, Symbol::Triangle, |row| row.derivatives && row.method == "gpc"),
    ("sparse PC with derivatives", Color::Red, Symbol::Triangle, |row| row.derivatives && row.method == "sparse"),
];

/// Error of the proportion over model runs for all methods with so many inputs, compared on `runs` points; `None`
/// without rows.
pub(super) fn cost_chart(rows: &[Row], inputs: usize, runs: u64) -> Option<Chart> {
    let own: Vec<&Row> = rows.iter().filter(|row| row.r == inputs).collect();
    // About half a point in a fifth of all points: what is below is drawn there.
    let smallest = 100.0 * 2.5 / runs as f64;
    let at = |x: f64, y: f64| [x, y.max(smallest)];
    let of_method = |(name, color, symbol, holds): &Method| {
        let found = own.iter().filter(|row| holds(row));
        let symbols =
            found.filter_map(|row| Some(at(row.direct_computations as f64, row.stability_error_percent?))).collect();
        Series::new(*name, *color, Marks::Symbols(symbols, *symbol))
    };
    let series = papers_series(inputs).into_iter().chain(METHODS.iter().map(of_method));
    (!own.is_empty()).then(|| Chart {
        title: uncertain(inputs),
        description: format!(
            "Error of the stability proportion over model runs, {}, by all methods and as the paper prints it.",
            uncertain(inputs)
        ),
        x: Axis::logarithmic("model runs"),
        y: Axis::logarithmic("error of the proportion in %"),
        series: series.collect(),
        guides: Vec::new(),
    })
}

/// The paper's rows: points, and for its sparse rows the box of the ranges it prints.
fn papers_series(inputs: usize) -> Vec<Series> {
    let rows = || TABLE_2.iter().filter(|row| row.inputs == inputs);
    let mut series = Vec::new();
    let printed = rows().filter(|row| row.method != "sparse");
    let printed = printed.map(|row| [row.direct_computations[0], row.stability_error[0]]).collect();
    series.push(Series::new("the paper's table", Color::Gray, Marks::Symbols(printed, Symbol::Square)));
    for row in rows().filter(|row| row.method == "sparse") {
        let ([left, right], [low, high]) = (row.direct_computations, row.stability_error);
        let corners = vec![[left, low], [right, low], [right, high], [left, high], [left, low]];
        series.push(Series::new("the paper's table", Color::Gray, Marks::Line(corners)));
    }
    series
}
