//! How exact small shares are, and how well builds know it.
//!
//! `cargo run --release -p pcc-tools --bin rare_shares -- [NAME …] [--seeds N] [--points N]`: builds each problem with
//! its defaults under seeds 1 to N (5) and compares it with the model on the same POINTS (200 000). A row has the
//! problem, the seed, model runs (of these near the boundary), the smaller share by the model, how far the surrogate is
//! off and how far it is estimated to be, in percent of that share, the true over the estimated error, and whether the
//! band of the surrogate and twice its estimated error hold the share. A last row per problem sums up.
//!
//! Errors below three points of the comparison are noise: they are in no ratio of the sums.

use pcc_compile::compilation::build;
use pcc_compile::reference::ModelSample;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::{SettingValue, Surrogate};
use std::error::Error;
use std::path::Path;

/// Points of a comparison that are noise.
const NOISE: f64 = 3.0;

/// One mode over the unit square that is unstable where this is positive; x² + y² exceeds 1.777… in 0.672 % of it,
/// 0.5 % have x + y > 1.9, and 0.05 % x + y < 0.0316….
const FORMULAS: [(&str, &str); 3] = [
    ("corner", "exp(x^2 + y^2) - exp(1.7771465257001167)"),
    ("corner-mirrored", "exp(1.7771465257001167) - exp(x^2 + y^2)"),
    ("two-corners", "exp(3 * (x + y - 1.9)) - 1 + exp(3 * (0.0316227766016838 - x - y)) - exp(-5.6051316701949486)"),
];

/// A name, a study of the repository, and what of its text is replaced by what, for a smaller share.
const RANGES: [(&str, &str, &str, &str); 14] = [
    ("clutch-r4-20%", "surrogates/clutch-r4", "upper = 0.5 ", "upper = 0.5 "),
    ("clutch-r4-1e-2", "surrogates/clutch-r4", "upper = 0.5 ", "upper = 0.0795 "),
    ("clutch-r4-1e-3", "surrogates/clutch-r4", "upper = 0.5 ", "upper = 0.0723 "),
    ("clutch-r4-1e-4", "surrogates/clutch-r4", "upper = 0.5 ", "upper = 0.0701 "),
    ("clutch-r8-20%", "surrogates/clutch-r8", "upper = 0.5 ", "upper = 0.5 "),
    ("clutch-r8-1e-2", "surrogates/clutch-r8", "upper = 0.5 ", "upper = 0.056 "),
    ("clutch-r8-1e-3", "surrogates/clutch-r8", "upper = 0.5 ", "upper = 0.0435 "),
    ("clutch-r8-1e-4", "surrogates/clutch-r8", "upper = 0.5 ", "upper = 0.0387 "),
    ("flutter", "surrogates/flutter", "upper = 13.0 ", "upper = 13.0 "),
    ("flutter-1e-3", "surrogates/flutter", "upper = 13.0 ", "upper = 9.55 "),
    ("rotor", "surrogates/rotor", "upper = 700.0 ", "upper = 700.0 "),
    ("rotor-1e-3", "surrogates/rotor", "upper = 700.0 ", "upper = 443.0 "),
    ("bike", "tests/data/field/bike", "lower = 3.0, upper = 8.0", "lower = 3.0, upper = 8.0"),
    ("bike-1e-3", "tests/data/field/bike", "lower = 3.0, upper = 8.0", "lower = 4.5, upper = 6.02579"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let (mut names, mut seeds, mut points) = (Vec::new(), 5, 200_000);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--seeds" => seeds = arguments.next().unwrap_or_default().parse()?,
            "--points" => points = arguments.next().unwrap_or_default().parse()?,
            name => names.push(name.to_owned()),
        }
    }
    println!("problem seed runs near share% off% estimated% ratio band twice");
    for (name, study) in problems()? {
        if names.is_empty() || names.contains(&name) {
            let sample = ModelSample::new(&study, points, 1000, &Silent)?;
            let rows: Result<Vec<Row>, _> = (1..=seeds).map(|seed| row(&name, &study, seed, &sample)).collect();
            sum_up(&name, &rows?);
        }
    }
    Ok(())
}

fn problems() -> Result<Vec<(String, Study)>, Box<dyn Error>> {
    let mut problems = Vec::new();
    for (name, growth) in FORMULAS {
        let text = format!(
            "format = 1\nname = \"{name}\"\n[model]\nkind = \"matrices\"\nM = [[1]]\nC = [[\"-2 * ({growth})\"]]\nK = \
             [[100]]\n[inputs]\nx = {{ distribution = \"uniform\", lower = 0.0, upper = 1.0 }}\ny = {{ distribution = \
             \"uniform\", lower = 0.0, upper = 1.0 }}\n"
        );
        problems.push((name.to_owned(), Study::from_toml(&text)?));
    }
    for (name, study, from, to) in RANGES {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(format!("{study}.toml"));
        let text = std::fs::read_to_string(&path)?;
        if !text.contains(from) {
            return Err(format!("{}: {from:?} is not there", path.display()).into());
        }
        problems.push((name.to_owned(), Study::from_toml(&text.replacen(from, to, 1))?));
    }
    Ok(problems)
}

/// What one build has shown.
struct Row {
    runs: u64,
    /// True error relative to the share.
    off: f64,
    /// True over estimated error, if that is known and either is more than noise.
    ratio: Option<f64>,
    is_in_band: bool,
    is_within_twice: bool,
}

fn row(name: &str, study: &Study, seed: u64, sample: &ModelSample<'_>) -> Result<Row, Box<dyn Error>> {
    let surrogate = build(&Study { seed, ..study.clone() }, &Silent)?;
    let points = sample.len() as f64;
    let [model, found] = sample.compare(&surrogate)?.unstable();
    let smaller = |unstable: f64| if model <= 0.5 { unstable } else { 1.0 - unstable };
    let (truth, off) = (smaller(model), (found - model).abs());
    // The file has it relative to the share that is not unstable.
    let estimated =
        surrogate.decision.proportion_error.map(|error| error * if found < 1.0 { 1.0 - found } else { 1.0 });
    let ratio = estimated.map(|estimated| off / estimated);
    let [lower, upper] = band(&surrogate, sample)?;
    let resolution = NOISE / points;
    let row = Row {
        runs: surrogate.training.counts.direct_computations,
        off: off / truth,
        ratio: ratio.filter(|_| off.max(estimated.unwrap_or(0.0)) > resolution),
        is_in_band: lower - resolution <= model && model <= upper + resolution,
        is_within_twice: estimated.is_some_and(|estimated| off <= 2.0 * estimated + resolution),
    };
    let near = surrogate.training.settings.iter().find(|setting| setting.key == "runs_near_boundary");
    let near = near.map_or(0, |setting| if let SettingValue::Integer(count) = setting.value { count } else { 0 });
    let percent = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{:.4}", 100.0 * value));
    println!(
        "{name} {seed} {} {near} {:.5} {} {} {} {} {}",
        row.runs,
        100.0 * truth,
        percent(Some(row.off)),
        percent(estimated.map(|estimated| estimated / truth)),
        ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.3}")),
        row.is_in_band,
        row.is_within_twice
    );
    Ok(row)
}

/// The unstable share if max Re λ were larger by the lower, and by the upper quantile of its residuals.
fn band(surrogate: &Surrogate, sample: &ModelSample<'_>) -> Result<[f64; 2], Box<dyn Error>> {
    let excess = sample.surrogate_at(surrogate, sample.len())?.excess;
    let unstable = |shift: f64| excess.iter().filter(|&&excess| excess + shift > 0.0).count() as f64;
    Ok(surrogate.decision.band_shifts().map(|shift| unstable(shift) / sample.len() as f64))
}

fn sum_up(name: &str, rows: &[Row]) {
    let sorted = |values: Vec<f64>| {
        let mut values = values;
        values.sort_by(f64::total_cmp);
        values
    };
    let at = |values: &[f64], share: f64| match values.len() {
        0 => f64::NAN,
        count => values[((count - 1) as f64 * share).round() as usize],
    };
    let runs = sorted(rows.iter().map(|row| row.runs as f64).collect());
    let off = sorted(rows.iter().map(|row| 100.0 * row.off).collect());
    let ratios = sorted(rows.iter().filter_map(|row| row.ratio).collect());
    let counts = |holds: &dyn Fn(&Row) -> bool| rows.iter().filter(|row| holds(row)).count();
    println!(
        "# {name}: {} builds; runs {:.0} (at most {:.0}); off {:.3} % (at most {:.3} %); true/estimated of {}: median {:.2}, \
         nine in ten {:.2}, at most {:.2}, {} up to 3; in the band {}; within twice the estimate {}",
        rows.len(),
        at(&runs, 0.5),
        at(&runs, 1.0),
        at(&off, 0.5),
        at(&off, 1.0),
        ratios.len(),
        at(&ratios, 0.5),
        at(&ratios, 0.9),
        at(&ratios, 1.0),
        ratios.iter().filter(|ratio| **ratio <= 3.0).count(),
        counts(&|row| row.is_in_band),
        counts(&|row| row.is_within_twice),
    );
}
