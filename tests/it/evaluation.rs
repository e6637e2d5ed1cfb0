//! Evaluation: the same bits on every instruction set, on any number of threads and shards; the same values as the
//! plain sums.

use crate::support::{repository, text};
use pcc_compile::compilation::build;
use pcc_compile::study::Study;
use pcc_evaluate::artifact::read;
use pcc_evaluate::evaluation::{
    Bins, Condition, Event, Findings, Lanes, Plan, Question, Sampler, Survey, Surveyed, Sweep, evaluate_points,
    monte_carlo,
};
use pcc_evaluate::foundation::{InstructionSet, Silent};
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::{Purpose, Stream};
use pcc_evaluate::probability::statistics::Proportion;
use pcc_evaluate::surrogate::Surrogate;

fn shipped(name: &str) -> Surrogate {
    read(&repository(&format!("surrogates/{name}.pcc"))).unwrap().surrogate
}

/// The r = 3 study on 24 elements.
fn on_elements() -> Surrogate {
    let lines = "[fit]\nmethod = \"me-gpc\"\ntheta_1 = 0.0\nelements = 24\n[design]\nmaximum = 100000\n";
    let study = Study::from_toml(&format!("{}\n{lines}", text("surrogates/clutch-r3-eigenvalues.toml"))).unwrap();
    build(&study, &Silent).unwrap()
}

fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

fn findings(surrogate: &Surrogate, question: &Question, instructions: InstructionSet, shards: u64) -> Findings {
    let survey = Survey::new(surrogate, question, instructions).unwrap();
    let mut all: Option<Findings> = None;
    for shard in 0..shards {
        let found = match survey.run(survey.division().shard(shard, shards), &Silent).unwrap() {
            Surveyed::Complete(found) => found,
            Surveyed::Interrupted(_) => panic!("nobody interrupts"),
        };
        match &mut all {
            None => all = Some(found),
            Some(all) => assert!(all.append(found, survey.division())),
        }
    }
    all.unwrap()
}

/// Everything that can be asked at once.
fn rich(samples: u64) -> Question {
    let bins = |quantity: &str, lower, upper| Bins { quantity: quantity.to_owned(), lower, upper, bins: 500 };
    Question {
        conditions: vec![Condition { input: "k_p".to_owned(), lower: 15.5e6, upper: 16.5e6 }],
        events: vec![
            Event { quantity: "max_re".to_owned(), below: true, threshold: -1.0 },
            Event { quantity: "damping_4".to_owned(), below: false, threshold: 1e-4 },
        ],
        histograms: vec![bins("max_re", -5.0, 25.0), bins("im_3", 3000.0, 4000.0)],
        ..Question::plain(samples, 5)
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let (best, sets) = (InstructionSet::best(), InstructionSet::available());
    println!("instruction sets of this processor: {sets:?}");
    for surrogate in [shipped("clutch-r8"), shipped("clutch-r5"), shipped("clutch-r8-eigenvalues"), on_elements()] {
        for sampler in [Sampler::MonteCarlo, Sampler::Sobol, Sampler::LatinHypercube] {
            let question = Question { sampler, replicates: sampler.default_replicates(), ..rich(16 * 700) };
            let expected = findings(&surrogate, &question, best, 1);
            for &set in &sets {
                let name = &surrogate.provenance.study_name;
                assert_eq!(findings(&surrogate, &question, set, 1), expected, "{name} with {set:?}, {sampler:?}");
            }
        }
    }
}

#[test]
fn counts_and_moments_do_not_depend_on_threads_and_shards() {
    let sweep = |points| Sweep { input: "mu".to_owned(), from: 0.05, to: 0.2, points };
    let questions = [
        rich(100_003),
        Question { sampler: Sampler::Sobol, replicates: 8, ..Question::plain(8 * 5000, 2) },
        Question { sampler: Sampler::LatinHypercube, replicates: 2, ..Question::plain(30_002, 2) },
        Question { sweeps: vec![sweep(4)], ..Question::plain(9_999, 1) },
    ];
    for surrogate in [shipped("clutch-r8"), on_elements()] {
        for question in &questions {
            let expected = on_threads(1, || findings(&surrogate, question, InstructionSet::best(), 1));
            for (threads, shards) in [(2, 1), (3, 1), (8, 1), (2, 3), (3, 17), (1, 1000)] {
                let found = on_threads(threads, || findings(&surrogate, question, InstructionSet::best(), shards));
                assert_eq!(found, expected, "{threads} threads, {shards} shards");
            }
        }
    }
}

/// Terms in another order, with one rounding less per product.
const ROUNDING: f64 = 1e-12;

#[test]
fn lanes_equal_the_plain_sums_and_their_recombination() {
    let names = (1..=8).flat_map(|r| [format!("clutch-r{r}"), format!("clutch-r{r}-eigenvalues")]);
    for surrogate in names.map(|name| shipped(&name)).chain([on_elements()]) {
        let points = random_points(&surrogate.inputs, 3, Purpose::Evaluation, 0..333);
        let references: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
        let block = evaluate_points(&surrogate, &Plan::new(&surrogate), &references);
        let moments = surrogate.moments();
        for (i, point) in points.iter().enumerate() {
            let expected = surrogate.evaluate(point);
            for (id, (value, (mean, variance))) in expected.iter().zip(&moments).enumerate() {
                let size = mean.abs() + 10.0 * variance.sqrt();
                assert!((block.components[id][i] - value).abs() <= ROUNDING * size, "component {id}");
            }
            // From the same components the same bits follow.
            let components: Vec<f64> = block.components.iter().map(|list| list[i]).collect();
            let mut eigenvalues = Vec::new();
            surrogate.outputs.iter().for_each(|output| output.recombine(&components, &mut eigenvalues));
            let found: Vec<_> = block.eigenvalues.iter().map(|list| list[i]).collect();
            assert_eq!(found, eigenvalues);
            assert_eq!(block.max_re[i], surrogate.max_re(&components));
        }
    }
}

#[test]
fn streams_are_those_of_an_independent_generator() {
    let rows = text("tests/data/philox.csv");
    let mut compared = 0;
    for row in rows.lines().skip(1) {
        let numbers: Vec<u64> = row.split(',').map(|number| number.parse().unwrap()).collect();
        let mut stream = Stream::new(numbers[0], Purpose::Evaluation, numbers[1]);
        for &cell in &numbers[2..] {
            assert_eq!(stream.next_cell(), cell, "seed {}, index {}", numbers[0], numbers[1]);
            compared += 1;
        }
    }
    assert!(compared > 600);
    // The evaluator's lanes hold the same numbers: see `random::lanes`, and here through what is evaluated.
    let surrogate = shipped("clutch-r1");
    let (plan, count) = (Plan::new(&surrogate), 100);
    let mut extremes = (f64::INFINITY, f64::NEG_INFINITY);
    let mut workspace = plan.workspace();
    for index in 0..count {
        workspace.points_mut()[0] = Lanes::splat(2.0 * Stream::new(9, Purpose::Evaluation, index).next_unit() - 1.0);
        plan.evaluate(0, &mut workspace);
        let max_re = workspace.results().max_re.0[0];
        extremes = (extremes.0.min(max_re), extremes.1.max(max_re));
    }
    let summary = monte_carlo(&surrogate, count, 9, &Silent).unwrap();
    assert_eq!((summary.max_re.minimum(), summary.max_re.maximum()), extremes);
}

/// Root-mean-square error of the stable proportion over 20 randomisations of so many points.
fn root_mean_square_error(surrogate: &Surrogate, sampler: Sampler, points: u64, truth: f64) -> f64 {
    let question = Question { sampler, replicates: 20, ..Question::plain(20 * points, 1) };
    let survey = Survey::new(surrogate, &question, InstructionSet::best()).unwrap();
    let found = findings(surrogate, &question, InstructionSet::best(), 1);
    let cell = &found.answer(survey.division()).cells[0];
    let squares = cell.replicates.iter().map(|tally| {
        let proportion = Proportion { hits: tally.summary.stable, samples: tally.summary.samples() };
        assert_eq!(proportion.samples, points);
        (proportion.value() - truth).powi(2)
    });
    (squares.sum::<f64>() / 20.0).sqrt()
}

#[test]
fn sobol_points_have_a_fifth_of_the_error_of_monte_carlo() {
    const POINTS: u64 = 1 << 16;
    let surrogate = shipped("clutch-r8");
    // Another seed, and 128 times as many points: an error of a fiftieth of what is compared.
    let question = Question { sampler: Sampler::Sobol, replicates: 8, ..Question::plain(8 << 20, 99) };
    let found = findings(&surrogate, &question, InstructionSet::best(), 1);
    let survey = Survey::new(&surrogate, &question, InstructionSet::best()).unwrap();
    let truth = found.answer(survey.division()).cells[0].share(0.95, |tally| tally.summary.stable);
    let monte_carlo = (truth.value * (1.0 - truth.value) / POINTS as f64).sqrt();
    assert!(truth.standard_error < 0.02 * monte_carlo, "{truth:?}");
    let sobol = root_mean_square_error(&surrogate, Sampler::Sobol, POINTS, truth.value);
    let latin = root_mean_square_error(&surrogate, Sampler::LatinHypercube, POINTS, truth.value);
    println!("at 2^16 points: Monte Carlo {monte_carlo:.3e}, Latin hypercube {latin:.3e}, Sobol' {sobol:.3e}");
    assert!(5.0 * sobol <= monte_carlo, "{sobol:e} against {monte_carlo:e}");
    assert!(latin < monte_carlo, "{latin:e} against {monte_carlo:e}");
}

/// Coordinates in physical units and max Re λ of the first samples of a seed.
fn samples(surrogate: &Surrogate, seed: u64, count: u64) -> Vec<(Vec<f64>, f64)> {
    let points = random_points(&surrogate.inputs, seed, Purpose::Evaluation, 0..count);
    let references: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
    let block = evaluate_points(surrogate, &Plan::new(surrogate), &references);
    points.iter().map(|point| surrogate.inputs.physical(point)).zip(block.max_re).collect()
}

#[test]
fn conditions_are_those_of_samples_that_happen_to_fulfil_them() {
    for surrogate in [shipped("clutch-r3"), on_elements()] {
        let condition = Condition { input: "mu".to_owned(), lower: 0.05, upper: 0.15 };
        let inside = |mu: f64| (condition.lower..=condition.upper).contains(&mu);
        let rejected: Vec<f64> = samples(&surrogate, 3, 400_000)
            .into_iter()
            .filter(|(point, _)| inside(point[0]))
            .map(|(_, max_re)| max_re)
            .collect();
        let hits = rejected.iter().filter(|&&max_re| max_re < 0.0).count() as u64;
        let expected = Proportion { hits, samples: rejected.len() as u64 };
        let question = Question { conditions: vec![condition.clone()], ..Question::plain(100_000, 4) };
        let found = findings(&surrogate, &question, InstructionSet::best(), 1).total().unwrap().summary;
        let (a, b) = (expected.value(), found.stable_proportion().value());
        // Four standard errors of the difference.
        let deviation = (a * (1.0 - a) * (1.0 / expected.samples as f64 + 1e-5)).sqrt();
        assert!((a - b).abs() < 4.0 * deviation && a > 0.01 && a < 0.99, "{a} against {b}");
    }
}

#[test]
fn points_of_a_sweep_are_fixed_inputs() {
    let surrogate = shipped("clutch-r8");
    let sweeps = vec![
        Sweep { input: "mu".to_owned(), from: 0.0, to: 0.25, points: 6 },
        Sweep { input: "gamma_2".to_owned(), from: 0.84, to: 0.76, points: 3 },
    ];
    let question = Question { sweeps: sweeps.clone(), ..Question::plain(5000, 1) };
    let survey = Survey::new(&surrogate, &question, InstructionSet::best()).unwrap();
    let answer = findings(&surrogate, &question, InstructionSet::best(), 1).answer(survey.division());
    assert_eq!(answer.cells.len(), 18);
    for (number, cell) in answer.cells.iter().enumerate() {
        let fixed = |sweep: &Sweep, number: usize| {
            let value = sweep.value(number as u32);
            Condition { input: sweep.input.clone(), lower: value, upper: value }
        };
        let conditions = vec![fixed(&sweeps[0], number / 3), fixed(&sweeps[1], number % 3)];
        let question = Question { conditions, ..Question::plain(5000, 1) };
        let alone = findings(&surrogate, &question, InstructionSet::best(), 1).total().unwrap();
        assert_eq!(cell.total.summary.stable, alone.summary.stable);
        assert_eq!(cell.total.summary.stable_if_shifted, alone.summary.stable_if_shifted);
    }
}

#[test]
fn events_and_histograms_count_what_is_there() {
    let surrogate = shipped("clutch-r8");
    let (count, seed) = (20_000, 6);
    let max_re: Vec<f64> = samples(&surrogate, seed, count).into_iter().map(|(_, max_re)| max_re).collect();
    let event = |below, threshold| Event { quantity: "max_re".to_owned(), below, threshold };
    let bins = Bins { quantity: "max_re".to_owned(), lower: 0.0, upper: 20.0, bins: 40 };
    let question = Question {
        events: vec![event(true, -0.2), event(false, 10.0)],
        histograms: vec![bins.clone()],
        ..Question::plain(count, seed)
    };
    let survey = Survey::new(&surrogate, &question, InstructionSet::best()).unwrap();
    let answer = findings(&surrogate, &question, InstructionSet::best(), 1).answer(survey.division());
    let how_many = |holds: &dyn Fn(f64) -> bool| max_re.iter().filter(|&&value| holds(value)).count() as u64;
    assert_eq!(answer.cells[0].total.events, [how_many(&|value| value < -0.2), how_many(&|value| value > 10.0)]);
    let histogram = &answer.histograms[0];
    assert_eq!((histogram.below, histogram.above), (how_many(&|value| value < 0.0), how_many(&|value| value > 20.0)));
    for (number, &counted) in histogram.counts.iter().enumerate() {
        let (lower, upper) = (bins.edge(number as u32), bins.edge(number as u32 + 1));
        assert_eq!(counted, how_many(&|value| value >= lower && value < upper), "bin {number}");
    }
}
