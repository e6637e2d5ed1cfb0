//! How often certificates hold.
//!
//! `cargo run --release -p pcc-tools --bin certificate_coverage -- [NAME …] [--runs N] [--repetitions N]`: for each
//! study of `tests/data/wide` whose shares are known, a surrogate is built and certified again and again with other
//! seeds. A row has the number of certificates, of those of which all bounds hold the true shares, and of those of
//! which each end of the bound of the stable share does. Each end is to hold in 95 % of them.
//!
//! With `--rare SHARE` instead: surrogates of systems with a rare share in closed form, fitted to few runs and to
//! more, so that there are poor and good ones. A row has the problem, the model runs of the fit, the true share, the
//! share of points that surrogate and model disagree on, how many certificates there are, how many lower and upper
//! ends hold, the median of upper and lower end over the true share, in how many the bound if errors fall off is
//! given, and in how many of these it is wrong, and the median of that bound over the true share.

use pcc_compile::compilation::build;
use pcc_compile::reference::{ModelSample, certify_with_model};
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::{Certificate, RareSide};
use std::error::Error;
use std::path::Path;

/// Stable and unstable share; the rest is marginal. By closed forms, structure, or `tests/data/wide/shares.py`.
const SHARES: [(&str, f64, f64); 12] = [
    ("wide", 0.5, 0.5),
    ("beam-20", 0.5, 0.5),
    ("machine", 0.3, 0.7),
    ("pen", 0.0, 0.0),
    ("undamped2", 0.0, 0.7103),
    ("undiv", 0.0, 7.0 / 24.0),
    ("chain-2", 0.0, 0.0),
    ("chain-5", 0.0, 0.0),
    ("chain-16", 0.0, 0.0),
    ("spin-2", 0.0, 0.47647),
    ("friction-2", 0.0, 0.700349),
    ("friction-4", 0.0, 0.40387),
];

/// Problems with inputs uniform on 0…1: a name, an expression that has the sign of the growth rate, with `p` for the
/// share where it is positive, and the number of inputs. The growth rate itself is no polynomial.
const RARE: [(&str, &str, usize); 4] = [
    // A corner: 1 − x + 1 − y < √(2p).
    ("corner-2", "x + y - 2 + sqrt(2*p)", 2),
    // A corner of a cube: the sum of the three distances below (6p)^(1/3).
    ("corner-3", "x + y + z - 3 + (6*p)^(1/3)", 3),
    // A quarter of a disc: radius √(4p/π).
    ("disc", "sqrt(4*p/3.141592653589793) - sqrt((1 - x)^2 + (1 - y)^2)", 2),
    // A strip along a wave of mean zero.
    ("wave", "x - 1 + p + 0.5*p*sin(6.283185307179586*y)", 2),
];

/// Numbers of model runs of the fits.
const FITS: [u64; 4] = [6, 10, 20, 40];

/// Points on which surrogate and model are compared.
const COMPARED: u64 = 100_000;

struct Arguments {
    names: Vec<String>,
    runs: u64,
    repetitions: u64,
    rare: Option<f64>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut read = Arguments { names: Vec::new(), runs: 300, repetitions: 100, rare: None };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--runs" => read.runs = arguments.next().unwrap_or_default().parse()?,
            "--repetitions" => read.repetitions = arguments.next().unwrap_or_default().parse()?,
            "--rare" => read.rare = Some(arguments.next().unwrap_or_default().parse()?),
            name => read.names.push(name.to_owned()),
        }
    }
    match read.rare {
        Some(share) => rare_shares(&read, share),
        None => known_shares(&read),
    }
}

impl Arguments {
    fn wants(&self, name: &str) -> bool {
        self.names.is_empty() || self.names.iter().any(|wanted| wanted == name)
    }
}

fn known_shares(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/wide");
    println!("study certificates held lower upper");
    for (name, stable, unstable) in SHARES.into_iter().filter(|(name, ..)| arguments.wants(name)) {
        let text = std::fs::read_to_string(folder.join(format!("{name}.toml")))?;
        let study = Study::from_toml_in(&text, &folder)?;
        let surrogate = build(&study, &Silent)?;
        let [mut held, mut lower, mut upper] = [0; 3];
        for seed in 1..=arguments.repetitions {
            let certificate = certify_with_model(&surrogate, &study, arguments.runs, seed, 0.95, &Silent)?;
            let holds = |[lower, upper]: [f64; 2], share: f64| lower <= share && share <= upper;
            let others = certificate.marginal.as_ref().is_none_or(|bounds| {
                holds(bounds.marginal, 1.0 - stable - unstable) && holds(bounds.unstable, unstable)
            });
            held += u64::from(others && holds([certificate.lower, certificate.upper], stable));
            lower += u64::from(certificate.lower <= stable);
            upper += u64::from(stable <= certificate.upper);
        }
        println!("{name} {} {held} {lower} {upper}", arguments.repetitions);
    }
    Ok(())
}

/// The study of a problem with this rare share, and so many model runs.
fn rare_study(expression: &str, inputs: usize, share: f64, runs: u64, seed: u64) -> Result<Study, Box<dyn Error>> {
    let sign = expression.replace('p', &format!("{share:e}"));
    let rate = format!("exp(0.7*({sign})) - 1 + 0.2*sin(3*({sign}))");
    let names = ["x", "y", "z"];
    let inputs: String = names[..inputs]
        .iter()
        .map(|name| format!("{name} = {{ distribution = \"uniform\", lower = 0.0, upper = 1.0 }}\n"))
        .collect();
    let text = format!(
        "format = 1\nname = \"rare\"\nseed = {seed}\n[model]\nkind = \"matrices\"\nA = [[\"{rate}\", 5], [-5, \"{rate}\"]]\n\
         [inputs]\n{inputs}[design]\ninitial = {runs}\nmaximum = {runs}\n"
    );
    Ok(Study::from_toml(&text)?)
}

fn rare_shares(arguments: &Arguments, share: f64) -> Result<(), Box<dyn Error>> {
    println!("problem fit seed truth misclassified certificates lower upper lower/p upper/p given wrong assumed/p");
    for (name, expression, inputs) in RARE.into_iter().filter(|(name, ..)| arguments.wants(name)) {
        for (runs, design) in FITS.into_iter().flat_map(|runs| [1, 2, 3].map(|seed| (runs, seed))) {
            let study = rare_study(expression, inputs, share, runs, design)?;
            let surrogate = build(&study, &Silent)?;
            let compared = ModelSample::new(&study, COMPARED, 1, &Silent)?.compare(&surrogate)?;
            let misclassified = compared.misclassified_percent();
            let certificates = (1..=arguments.repetitions)
                .map(|seed| certify_with_model(&surrogate, &study, arguments.runs, seed, 0.95, &Silent))
                .collect::<Result<Vec<_>, _>>()?;
            let row = Row::of(&certificates, share);
            println!("{name} {runs} {design} {share} {misclassified:.3} {} {row}", certificates.len());
        }
    }
    Ok(())
}

/// What certificates of one surrogate say of a true unstable share.
struct Row {
    held: [usize; 2],
    medians: [f64; 2],
    given: usize,
    wrong: usize,
    assumed: f64,
}

impl Row {
    fn of(certificates: &[Certificate], truth: f64) -> Self {
        // Unstable is what is not stable.
        let ends: Vec<[f64; 2]> = certificates.iter().map(|one| [1.0 - one.upper, 1.0 - one.lower]).collect();
        let assumed: Vec<f64> = certificates
            .iter()
            .filter_map(|one| one.strata.as_ref())
            .filter(|strata| strata.rare_side == RareSide::NotStable)
            .filter_map(|strata| strata.if_errors_fall_off.bound.upper())
            .collect();
        Self {
            held: [
                ends.iter().filter(|ends| ends[0] <= truth).count(),
                ends.iter().filter(|ends| truth <= ends[1]).count(),
            ],
            medians: [0, 1].map(|end| median(ends.iter().map(|ends| ends[end] / truth).collect())),
            given: assumed.len(),
            wrong: assumed.iter().filter(|&&upper| upper < truth).count(),
            assumed: median(assumed.iter().map(|upper| upper / truth).collect()),
        }
    }
}

impl std::fmt::Display for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { held, medians, given, wrong, assumed } = self;
        let [lower, upper] = medians;
        write!(f, "{} {} {lower:.3} {upper:.2} {given} {wrong} {assumed:.2}", held[0], held[1])
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
