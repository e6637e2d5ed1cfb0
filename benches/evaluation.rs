//! What an evaluation costs, part by part, beside what the processor can do.
//!
//! `cargo bench -p pcc-tools --bench evaluation` measures the processor's fused multiply-add peak and every part of an
//! evaluation of the shipped surrogate with eight inputs, in turn and several times, and prints the best of each: other
//! work on the machine can only slow a part down. Floating-point operations are those that the plan counts.

use pcc::report::{Align, Table};
use pcc_compile::campaign::Runner;
use pcc_compile::study::Study;
use pcc_evaluate::artifact::decode;
use pcc_evaluate::evaluation::{BLOCK_POINTS, Lanes, Plan, Question, Sampler, Survey, monte_carlo};
use pcc_evaluate::foundation::{InstructionSet, Silent};
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::{Purpose, unit_pairs};
use pcc_evaluate::surrogate::Surrogate;
use pulp::{Simd, WithSimd};
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 7;
const BLOCKS: usize = 6_000;
const SAMPLES: u64 = 4_000_000;
const RUNS: usize = 20_000;

/// Fused multiply-adds that do not wait for each other.
struct Peak(u64);

/// Chains of them: more than any processor can have under way, as many as fit its registers with room for two factors.
const CHAINS: usize = 12;

impl WithSimd for Peak {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let [factor, term] = black_box([0.999_999, 1e-9]).map(|number| simd.splat_f64s(number));
        let mut chains: [S::f64s; CHAINS] = std::array::from_fn(|k| simd.splat_f64s(k as f64));
        for _ in 0..self.0 {
            for chain in &mut chains {
                *chain = simd.mul_add_f64s(*chain, factor, term);
            }
        }
        chains.into_iter().map(|chain| simd.reduce_sum_f64s(chain)).sum()
    }
}

/// Numbers per vector.
struct Width;

impl WithSimd for Width {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F64_LANES
    }
}

/// Seconds that `work` takes.
fn seconds<R>(work: impl FnOnce() -> R) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64()
}

fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
}

/// Best times of all parts on one core, in ns per sample; the peak in operations per ns.
#[derive(Clone, Copy)]
struct Parts {
    peak: f64,
    kernel: f64,
    with_roots: f64,
    random_numbers: f64,
    whole: f64,
}

fn measure(surrogate: &Surrogate, instructions: InstructionSet) -> Parts {
    let plan = Plan::with_instructions(surrogate, instructions);
    let mut workspace = plan.workspace();
    for (j, points) in workspace.points_mut().iter_mut().enumerate() {
        for lane in 0..BLOCK_POINTS {
            points.0[lane] = ((j * 37 + lane * 11) % 64) as f64 / 32.0 - 1.0;
        }
    }
    let is_slow = instructions.name() == "portable";
    let (blocks, samples) = if is_slow { (BLOCKS / 20, SAMPLES / 20) } else { (BLOCKS, SAMPLES) };
    let steps = 10_000_000;
    let mut best = Parts {
        peak: 0.0,
        kernel: f64::INFINITY,
        with_roots: f64::INFINITY,
        random_numbers: f64::INFINITY,
        whole: f64::INFINITY,
    };
    let question = Question::plain(samples, 1);
    let survey = Survey::new(surrogate, &question, instructions).expect("the plain question fits");
    let per_sample = |seconds: f64, count: f64| 1e9 * seconds / count;
    for _ in 0..if is_slow { 2 } else { ROUNDS } {
        let operations = (steps as usize * CHAINS * 2 * instructions.run(Width)) as f64;
        best.peak = best.peak.max(1e-9 * operations / seconds(|| instructions.run(Peak(steps))));
        let count = (blocks * BLOCK_POINTS) as f64;
        let kernel = seconds(|| (0..blocks).for_each(|_| plan.evaluate_components(0, black_box(&mut workspace))));
        best.kernel = best.kernel.min(per_sample(kernel, count));
        let roots = seconds(|| (0..blocks).for_each(|_| plan.evaluate(0, black_box(&mut workspace))));
        best.with_roots = best.with_roots.min(per_sample(roots, count));
        let random = seconds(|| instructions.run(Drawing { points: workspace.points_mut(), blocks }));
        best.random_numbers = best.random_numbers.min(per_sample(random, count));
        let whole = on_threads(1, || seconds(|| survey.run(0..survey.division().chunks(), &Silent).expect("finite")));
        best.whole = best.whole.min(per_sample(whole, samples as f64));
    }
    best
}

/// The random coordinates of all inputs, block by block.
struct Drawing<'a> {
    points: &'a mut [Lanes],
    blocks: usize,
}

impl WithSimd for Drawing<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for block in 0..self.blocks {
            for (pair, inputs) in (0u32..).zip(self.points.chunks_exact_mut(2)) {
                let [even, odd] = inputs else { continue };
                unit_pairs(1, Purpose::Evaluation, (block * BLOCK_POINTS) as u64, pair, &mut even.0, &mut odd.0);
            }
            black_box(&mut *self.points);
        }
    }
}

fn print_parts(surrogate: &Surrogate) {
    let flops = Plan::new(surrogate).flops() as f64;
    let right = Align::Right;
    let mut table = Table::new(&[
        ("one core, ns per sample", Align::Left),
        ("FMA peak, flop/ns", right),
        ("kernel", right),
        ("flop/ns", right),
        ("of the peak", right),
        ("roots", right),
        ("random numbers", right),
        ("their share", right),
        ("whole", right),
        ("samples/s", right),
    ]);
    for instructions in InstructionSet::available() {
        let Parts { peak, kernel, with_roots, random_numbers, whole } = measure(surrogate, instructions);
        table.row([
            instructions.name().to_owned(),
            format!("{peak:.1}"),
            format!("{kernel:.1}"),
            format!("{:.1}", flops / kernel),
            format!("{:.1} %", 100.0 * flops / kernel / peak),
            format!("{:.1}", with_roots - kernel),
            format!("{random_numbers:.1}"),
            format!("{:.1} %", 100.0 * random_numbers / whole),
            format!("{whole:.1}"),
            format!("{:.2e}", 1e9 / whole),
        ]);
    }
    println!("{}: {} operations per sample\n{table}", surrogate.provenance.study_name, flops);
}

/// One thread and all, the samplers, and the model itself.
fn print_whole(surrogate: &Surrogate, study: &Study) {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    let points = random_points(&study.inputs, 1, Purpose::Evaluation, 0..RUNS as u64);
    let points: Vec<Vec<f64>> = points.iter().map(|point| study.inputs.physical(point)).collect();
    let sampled = |sampler: Sampler| Question {
        sampler,
        replicates: sampler.default_replicates(),
        ..Question::plain(1 << 22, 1)
    };
    let questions = [Sampler::Sobol, Sampler::LatinHypercube].map(sampled);
    let mut best = [f64::INFINITY; 5];
    for _ in 0..ROUNDS {
        let evaluate = |threads| on_threads(threads, || seconds(|| monte_carlo(surrogate, 2 * SAMPLES, 1, &Silent)));
        let model = on_threads(all, || {
            seconds(|| {
                let runner = Runner::new(study).expect("the shipped study fits its model");
                runner.with_derivatives(false).run(black_box(&points), &Silent).expect("the clutch converges")
            })
        });
        let others = questions.each_ref().map(|question| {
            let survey = Survey::new(surrogate, question, InstructionSet::best()).expect("the question fits");
            on_threads(all, || seconds(|| survey.run(0..survey.division().chunks(), &Silent)))
        });
        let count = (2 * SAMPLES) as f64;
        let times = [
            evaluate(1) / count,
            evaluate(all) / count,
            others[0] / (1 << 22) as f64,
            others[1] / (1 << 22) as f64,
            model / RUNS as f64,
        ];
        best.iter_mut().zip(times).for_each(|(best, time)| *best = best.min(time));
    }
    let mut table = Table::new(&[
        ("", Align::Left),
        ("threads", Align::Right),
        ("ns per sample", Align::Right),
        ("samples/s", Align::Right),
        ("against", Align::Left),
        ("ratio", Align::Right),
    ]);
    let names = ["Monte Carlo", "Monte Carlo", "scrambled Sobol'", "Latin hypercube", "the model itself"];
    let threads = [1, all, all, all, all];
    let against = ["", "one thread", "Monte Carlo", "Monte Carlo", "Monte Carlo"];
    let ratio =
        [None, Some(best[0] / best[1]), Some(best[2] / best[1]), Some(best[3] / best[1]), Some(best[4] / best[1])];
    for k in 0..names.len() {
        table.row([
            names[k].to_owned(),
            threads[k].to_string(),
            format!("{:.1}", 1e9 * best[k]),
            format!("{:.3e}", 1.0 / best[k]),
            against[k].to_owned(),
            ratio[k].map_or(String::new(), |ratio| format!("{ratio:.2}")),
        ]);
    }
    println!("{table}");
}

fn main() {
    // `cargo test --benches` passes --test: nothing is measured then.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let surrogate =
        decode(include_bytes!("../surrogates/clutch-r8.pcc")).expect("the shipped surrogate is valid").surrogate;
    let study = Study::from_toml(include_str!("../surrogates/clutch-r8.toml")).expect("the shipped study is valid");
    print_parts(&surrogate);
    print_whole(&surrogate, &study);
}
