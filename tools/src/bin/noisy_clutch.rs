//! The clutch as a program whose answers carry noise: model runs and stable shares with and without it.
//!
//! `cargo run --release -p pcc-tools --bin noisy_clutch -- [NOISE]`

use nalgebra::Complex;
use pcc::{Model, ModelError, Silent, Study, build_with, monte_carlo};
use pcc_evaluate::probability::random::{Purpose, Stream};
use std::error::Error;

const SAMPLES: u64 = 1_000_000;

/// Slower modes are rigid-body motion, in rad/s.
const SLOWEST: f64 = 1.0;

/// One of each conjugate pair, off by this share of |λ|; the same at the same point.
struct Noisy(Box<dyn Model>, f64);

impl Model for Noisy {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        let key = point.iter().fold(0u64, |key, value| key.rotate_left(17) ^ value.to_bits().wrapping_mul(0x9E37_79B9));
        let mut stream = Stream::new(key >> 1, Purpose::Evaluation, 0);
        // Twelve uniform variables have about a normal sum of unit variance.
        let mut normal = || (0..12).map(|_| stream.next_unit()).sum::<f64>() - 6.0;
        let mut found = self.0.eigenvalues(point)?;
        found.retain(|lambda| lambda.im > SLOWEST);
        found.sort_by(|a, b| a.im.total_cmp(&b.im));
        found.iter_mut().for_each(|lambda| *lambda += Complex::new(normal(), normal()) * (self.1 * lambda.norm()));
        Ok(found)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let noise: f64 = std::env::args().nth(1).map_or(Ok(1e-8), |word| word.parse())?;
    println!("r  seed  noise    runs  stable");
    for (inputs, seeds) in [(3, 1..=3), (8, 1..=1)] {
        let text =
            std::fs::read_to_string(format!("{}/../surrogates/clutch-r{inputs}.toml", env!("CARGO_MANIFEST_DIR")))?;
        let mut study = Study::from_toml(&format!("{text}\n[fit]\nderivatives = false\n"))?;
        for seed in seeds {
            study.seed = seed;
            for noise in [0.0, noise] {
                let surrogate = build_with(&study, Box::new(Noisy(study.model()?, noise)), &Silent)?;
                let stable = monte_carlo(&surrogate, SAMPLES, 1, &Silent)?.stable_proportion().value();
                let runs = surrogate.training.counts.direct_computations;
                println!("{inputs}  {seed:<4}  {noise:<7e}  {runs:<4}  {stable:.6}");
            }
        }
    }
    Ok(())
}
