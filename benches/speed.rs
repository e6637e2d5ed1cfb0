//! Speed of what takes time: one direct computation, a fit, a build, a million samples.
//!
//! `cargo bench -p pcc-tools --bench speed` prints a line each; throughput is in model runs or samples per second, on
//! all processors for builds and samples and on one for the model and for fits of one component.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use pcc_compile::campaign::Runner;
use pcc_compile::fitting::design::NestedLatinHypercube;
use pcc_compile::fitting::fit::FitMethod;
use pcc_compile::fitting::fit::Smooth;
use pcc_compile::fitting::fit::minimum_norm::{self, Previous};
use pcc_compile::fitting::fit::stepwise;
use pcc_compile::fitting::regression::{BasisTables, Response};
use pcc_compile::study::Study;
use pcc_evaluate::artifact::decode;
use pcc_evaluate::evaluation::monte_carlo;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::polynomials::{Family, Hyperbolic};
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use std::hint::black_box;

const STUDY: &str = include_str!("../surrogates/clutch-r8-eigenvalues.toml");
const R5_STUDY: &str = include_str!("../surrogates/clutch-r5-eigenvalues.toml");
const INVARIANTS: &str = include_str!("../surrogates/clutch-r8.toml");
const SURROGATES: [(&str, &[u8]); 2] = [
    ("clutch-r8-eigenvalues", include_bytes!("../surrogates/clutch-r8-eigenvalues.pcc")),
    ("clutch-r8", include_bytes!("../surrogates/clutch-r8.pcc")),
];
const SAMPLES: u64 = 1_000_000;

fn study() -> Study {
    Study::from_toml(STUDY).expect("the shipped study is valid")
}

fn direct_computation(criterion: &mut Criterion) {
    let study = study();
    let points = random_points(&study.inputs, 1, Purpose::Evaluation, 0..1000);
    let points: Vec<Vec<f64>> = points.iter().map(|point| study.inputs.physical(point)).collect();
    let one_core = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut group = criterion.benchmark_group("model");
    group.throughput(Throughput::Elements(points.len() as u64));
    for (name, derivatives) in [("", false), (" with all eight derivatives", true)] {
        group.bench_function(format!("1000 direct computations{name}, one core"), |bencher| {
            bencher.iter(|| {
                one_core.install(|| {
                    let runner = Runner::new(&study).expect("the shipped study fits its model");
                    let runs = runner.with_derivatives(derivatives).run(black_box(&points), &Silent);
                    assert_eq!(black_box(runs.expect("the clutch converges"))[0].reductions.is_some(), derivatives);
                });
            });
        });
    }
    group.finish();
}

/// One component of eight inputs: smooth, with inputs of falling influence.
fn fit(criterion: &mut Criterion) {
    const INPUTS: usize = 8;
    const DEGREE: u16 = 15;
    let component = |x: &[f64]| (0..).zip(x).map(|(j, x)| 0.5f64.powi(j) * x).sum::<f64>().sin();
    let mut group = criterion.benchmark_group("fit");
    group.sample_size(10);
    for (method, runs) in [("stepwise", 960), ("minimum-norm", 240)] {
        let mut design = NestedLatinHypercube::new(INPUTS, 1);
        design.grow_to(runs);
        let samples = design.samples(|_, u| 2.0 * u - 1.0);
        let values: Vec<f64> = samples.points().map(component).collect();
        let recurrences = vec![Family::Legendre.recurrence(DEGREE.into()); INPUTS];
        let tables = BasisTables::new(&samples, &recurrences, DEGREE.into());
        let response = Response::of(&values, 1e-13);
        let stepwise = Study::from_toml(STUDY).expect("the shipped study is valid").fit.method;
        let smooth = Smooth { max_degree: DEGREE, s2_target: 0.999 };
        let one_core = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        group.bench_function(format!("one component by {method}, {runs} runs, one core"), |bencher| {
            bencher.iter(|| {
                one_core.install(|| match (method, &stepwise) {
                    ("stepwise", FitMethod::Stepwise(settings)) => {
                        let sets = Hyperbolic { inputs: INPUTS, q_norm: settings.q_norm };
                        let shells = sets.shells(settings.max_degree).expect("the sets are small");
                        drop(black_box(stepwise::fit(&tables, response, &shells, settings, &Silent)));
                    }
                    _ => drop(black_box(minimum_norm::fit(
                        &tables,
                        response,
                        &smooth,
                        &Previous::nothing(INPUTS),
                        &Silent,
                    ))),
                });
            });
        });
    }
    group.finish();
}

fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    group.sample_size(10);
    for text in [STUDY, INVARIANTS] {
        let study = Study::from_toml(text).expect("the shipped study is valid");
        group.bench_function(format!("{}, all cores", study.name), |bencher| {
            bencher.iter(|| {
                pcc_compile::compilation::build(black_box(&study), &Silent).expect("the shipped study builds")
            });
        });
    }
    group.finish();
}

fn evaluation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("eval");
    group.sample_size(10);
    group.throughput(Throughput::Elements(SAMPLES));
    let shipped = SURROGATES
        .map(|(name, bytes)| (name.to_owned(), decode(bytes).expect("the shipped surrogate is valid").surrogate));
    // The same studies by full expansions of degree 2, on one element and on many.
    let full = [1, 24, 200].map(|elements| {
        let lines =
            format!("[fit]\nmethod = \"me-gpc\"\ntheta_1 = 0.0\nelements = {elements}\n[design]\nmaximum = 1000000");
        let study = Study::from_toml(&format!("{R5_STUDY}\n{lines}\n")).expect("the study is valid");
        let surrogate = pcc_compile::compilation::build(&study, &Silent).expect("the clutch converges");
        (format!("clutch-r5-eigenvalues on {elements} elements"), surrogate)
    });
    for (name, surrogate) in shipped.into_iter().chain(full) {
        group.bench_function(format!("a million samples of {name}, all cores"), |bencher| {
            bencher.iter(|| monte_carlo(black_box(&surrogate), SAMPLES, 1, &Silent).expect("samples are asked for"));
        });
    }
    group.finish();
}

criterion_group!(benches, direct_computation, fit, build, evaluation);
criterion_main!(benches);
