//! The pictures of a surrogate.

use super::eval::EvalReport;
use super::sensitivity::{Bounded, IndexPair, SensitivityReport};
use super::shapley::{InputEffects, ShapleyReport};
use num_complex::Complex;
use pcc_charts::{Axis, Bar, Chart, Color, Guide, Marks, Series, Symbol, sheet};
use pcc_evaluate::components::{Block, Label};
use pcc_evaluate::probability::inputs::Input;
use pcc_evaluate::probability::statistics::density;
use pcc_evaluate::surrogate::Surrogate;
use std::f64::consts::TAU;

/// Bins of a density.
const BINS: usize = 80;

/// Digits of the numbers behind a picture: more than can be seen.
const DIGITS: usize = 6;

/// A number with as many digits as a picture and its data need.
pub(super) fn short(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// Points of a picture.
pub(super) fn points(x: &[f64], y: impl IntoIterator<Item = f64>) -> Vec<[f64; 2]> {
    x.iter().zip(y).map(|(&x, y)| [short(x), short(y)]).collect()
}

pub(super) fn color(number: usize) -> Color {
    Color::ALL[number % Color::ALL.len()]
}

/// Densities of max Re λ on a logarithmic axis, because whole shares of the samples can sit at one value.
pub(super) fn density_chart(title: &str, samples: &[(&str, Color, &[f64])]) -> Chart {
    let all = || samples.iter().flat_map(|(_, _, values)| values.iter().copied()).filter(|value| value.is_finite());
    let (lower, upper) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    let series = samples.iter().map(|(name, color, values)| {
        let found = density(values, lower, upper, BINS);
        let (x, y): (Vec<f64>, Vec<f64>) = found.iter().map(|[x, y]| (*x, *y)).unzip();
        Series::new(*name, *color, Marks::Line(points(&x, y)))
    });
    Chart {
        title: title.to_owned(),
        description:
            "How often the spectral abscissa takes which value: without a margin, what lies right of zero is unstable."
                .to_owned(),
        x: Axis::linear("max Re λ in 1/s"),
        y: Axis::logarithmic("probability density in s"),
        series: series.collect(),
        guides: vec![Guide::Vertical(0.0, "stability limit".to_owned())],
    }
}

/// Which inputs decide on stability, as an SVG file; none where nothing is known of it.
pub fn sensitivity_charts(report: &EvalReport) -> Vec<String> {
    let of_sobol = report.sensitivity.as_ref().map(sobol_charts);
    let of_shapley = report.shapley.as_ref().map(shapley_charts);
    let charts: Vec<Chart> = of_sobol.into_iter().chain(of_shapley).flatten().collect();
    charts.into_iter().map(|chart| sheet("", &chart.description.clone(), &[chart], 1)).collect()
}

/// Surrogate against model at the same points.
pub(super) fn validation_chart(model: &[f64], surrogate: &[f64]) -> Chart {
    let marks = Marks::Points(points(model, surrogate.iter().copied()));
    Chart {
        title: "Surrogate against model".to_owned(),
        description: format!(
            "max Re λ by the surrogate over that by the model at the same {} points; on the diagonal they are equal, in the upper \
             left and lower right quarters they disagree on stability.",
            model.len()
        ),
        x: Axis::linear("max Re λ of the model in 1/s"),
        y: Axis::linear("max Re λ of the surrogate in 1/s"),
        series: vec![Series::new("", Color::Blue, marks)],
        guides: vec![
            Guide::Diagonal,
            Guide::Vertical(0.0, "limit of the model".to_owned()),
            Guide::Horizontal(0.0, "of the surrogate".to_owned()),
        ],
    }
}

/// What coefficients say where inputs depend on each other.
const INDEPENDENT: &str = " The standard deviation is that of independent inputs with the same laws.";

/// What each total degree contributes to each component.
pub(super) fn spectrum_chart(surrogate: &Surrogate) -> Chart {
    let moments = surrogate.moments();
    let highest = (0..moments.len()).map(|id| by_degree(surrogate, id).len()).max().unwrap_or(0);
    let degrees = (1..highest).map(|degree| degree.to_string()).collect();
    let components = surrogate.components().into_iter().enumerate();
    let series = components.filter(|(_, component)| moments[component.id].1 > 0.0).map(|(number, component)| {
        let deviation = moments[component.id].1.sqrt() / component.scale.abs();
        let shares = by_degree(surrogate, component.id).into_iter().enumerate().skip(1);
        let line = shares.map(|(degree, square)| [degree as f64 - 1.0, short(square.sqrt() / deviation)]).collect();
        let symbols = [Symbol::Circle, Symbol::Square, Symbol::Triangle, Symbol::Diamond];
        let symbol = symbols[number / Color::ALL.len() % symbols.len()];
        Series::new(component.name.clone(), color(number), Marks::Symbols(line, symbol))
    });
    Chart {
        title: "Coefficients by degree".to_owned(),
        description:
            "Root of the sum of squared coefficients of each total degree, relative to the standard deviation of the \
                      component, over all elements: the faster it falls, the smoother the component."
                .to_owned()
                + if surrogate.inputs.dependence().is_some() { INDEPENDENT } else { "" },
        x: Axis::categories("total degree |α|", degrees),
        y: Axis::logarithmic("share of the standard deviation"),
        series: series.collect(),
        guides: Vec::new(),
    }
}

/// Σ c_α² over the α of each total degree, averaged over elements.
fn by_degree(surrogate: &Surrogate, component: usize) -> Vec<f64> {
    let mut squares = Vec::new();
    for (element, expansion) in surrogate.mesh.elements().iter().zip(surrogate.expansions_of(component)) {
        for (alpha, c) in expansion.indices.iter().zip(&expansion.coefficients) {
            let degree = alpha.iter().map(|&degree| usize::from(degree)).sum::<usize>();
            if squares.len() <= degree {
                squares.resize(degree + 1, 0.0);
            }
            squares[degree] += element.weight * c * c;
        }
    }
    squares
}

/// Growth rate of every eigenvalue and frequency of every mode over one input, in the order of their columns.
pub(super) fn mode_charts(input: &Input, x: &[f64], labels: &[Label], block: &Block) -> [Chart; 2] {
    let mut labelled: Vec<(Label, &Vec<Complex<f64>>)> = labels.iter().copied().zip(&block.eigenvalues).collect();
    labelled.sort_by_key(|(label, _)| label.column());
    let name = |label: Label| match label {
        Label::Mode(mode) => format!("mode {mode}"),
        Label::Second(mode) => format!("mode {mode}, second"),
        Label::Real(_) => label.growth_rate(),
    };
    let series = |part: fn(&Complex<f64>) -> f64, holds: fn(&Label) -> bool| -> Vec<Series> {
        let shown = labelled.iter().enumerate().filter(|(_, (label, _))| holds(label));
        let one = |(number, (label, lambdas)): (usize, &(Label, &Vec<Complex<f64>>))| {
            // While a mode oscillates, its second eigenvalue is the conjugate of the first.
            let is_shown = |lambda: &Complex<f64>| !matches!(label, Label::Second(_)) || lambda.im == 0.0;
            let (x, y): (Vec<f64>, Vec<f64>) = x
                .iter()
                .zip(*lambdas)
                .filter(|(_, lambda)| is_shown(lambda))
                .map(|(x, lambda)| (*x, part(lambda)))
                .unzip();
            (!x.is_empty()).then(|| Series::new(name(*label), color(number), Marks::Points(points(&x, y))))
        };
        shown.filter_map(one).collect()
    };
    let chart = |title: String, label: &str, series: Vec<Series>, guides: Vec<Guide>| Chart {
        description: format!("{title}, at {} random points of all inputs, from the surrogate.", x.len()),
        title,
        x: Axis::linear(input.title()),
        y: Axis::linear(label),
        series,
        guides,
    };
    let limit = vec![Guide::Horizontal(0.0, "stability limit".to_owned())];
    [
        chart(format!("Growth rates over {}", input.name), "Re λ in 1/s", series(|lambda| lambda.re, |_| true), limit),
        chart(
            format!("Frequencies over {}", input.name),
            "Im λ/2π in Hz",
            series(|lambda| lambda.im / TAU, |label| matches!(label, Label::Mode(_))),
            Vec::new(),
        ),
    ]
}

/// Shapley effects as bars: on max Re λ, and on stability itself.
pub(super) fn shapley_charts(report: &ShapleyReport) -> Vec<Chart> {
    type Part = fn(&InputEffects) -> Option<Bounded>;
    let parts: [(&str, Part); 2] = [
        ("Shapley effects on max Re λ", |input| input.max_re),
        ("Shapley effects on stability", |input| input.stability),
    ];
    let names: Vec<String> = report.inputs.iter().map(|input| input.input.clone()).collect();
    let chart = |(title, part): (&str, Part)| {
        let effects: Option<Vec<Bounded>> = report.inputs.iter().map(part).collect();
        let bar = |(category, Bounded { value, lower, upper }): (usize, Bounded)| Bar {
            category,
            value: short(value),
            interval: Some((short(lower), short(upper))),
        };
        Some(Chart {
            title: title.to_owned(),
            description: format!(
                "{title}: the share of its variance that knowing an input takes away, on average over all orders in which \
                 inputs become known, with {:.0} % intervals. Inputs depend on each other.",
                100.0 * report.level
            ),
            x: Axis::linear("share of the variance"),
            y: Axis::categories("", names.clone()),
            series: vec![Series::new(
                "",
                Color::Blue,
                Marks::Bars(effects?.into_iter().enumerate().map(bar).collect()),
            )],
            guides: Vec::new(),
        })
    };
    parts.into_iter().filter_map(chart).collect()
}

/// Sobol' indices as bars: of max Re λ, and of stability itself.
pub(super) fn sobol_charts(report: &SensitivityReport) -> Vec<Chart> {
    type Part = fn(&super::sensitivity::InputSensitivity) -> Option<IndexPair>;
    let parts: [(&str, Part); 2] = [
        ("Sobol' indices of max Re λ", |input| input.max_re),
        ("Sobol' indices of stability", |input| input.stability),
    ];
    let names: Vec<String> = report.inputs.iter().map(|input| input.input.clone()).collect();
    let chart = |(title, part): (&str, Part)| {
        let pairs: Option<Vec<IndexPair>> = report.inputs.iter().map(part).collect();
        let pairs = pairs?;
        let bars = |index: fn(&IndexPair) -> Bounded| {
            let bar = |(category, pair): (usize, &IndexPair)| {
                let Bounded { value, lower, upper } = index(pair);
                Bar { category, value: short(value), interval: Some((short(lower), short(upper))) }
            };
            Marks::Bars(pairs.iter().enumerate().map(bar).collect())
        };
        Some(Chart {
            title: title.to_owned(),
            description: format!(
                "{title}: the share of its variance that each input causes alone (first order) and in all (total), with \
                 {:.0} % intervals.",
                100.0 * report.level
            ),
            x: Axis::linear("share of the variance"),
            y: Axis::categories("", names.clone()),
            series: vec![
                Series::new("first order", Color::Blue, bars(|pair| pair.first)),
                Series::new("total", Color::Orange, bars(|pair| pair.total)),
            ],
            guides: Vec::new(),
        })
    };
    parts.into_iter().filter_map(chart).collect()
}
