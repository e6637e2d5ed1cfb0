//! Quantiles against forty digits, polynomials against closed forms and an independent quadrature.

use super::super::marginal::{Marginal, Polynomials};
use super::super::normal_quantile::quantile;
use super::super::parameters::Parameters;
use crate::polynomials::Recurrence;

type Given = &'static [(&'static str, f64)];

fn law(name: &str, given: &[(&'static str, f64)]) -> Marginal {
    Marginal::named(name, &Parameters::of(given.iter().copied())).unwrap()
}

const PROBABILITIES: [f64; 6] = [1e-15, 1e-10, 1e-5, 0.01, 0.2, 0.5];

/// Quantiles at these probabilities, and values that are exceeded with them; from mpmath with 40 digits.
#[allow(clippy::excessive_precision, reason = "as computed")]
const QUANTILES: [(&str, Given, [f64; 6], [f64; 6]); 7] = [
    (
        "gamma",
        &[("shape", 0.5), ("scale", 1.0)],
        [
            7.8539816339744843e-31,
            7.8539816339744837e-21,
            7.8539816343857179e-11,
            7.8543928954850992e-5,
            0.032092377333650794,
            0.22746821155978638,
        ],
        [
            32.215231760061829,
            20.910728182380647,
            9.7557104823287862,
            3.3174483005106076,
            0.82118720757490815,
            0.22746821155978638,
        ],
    ),
    (
        "gamma",
        &[("shape", 3.0), ("scale", 1.0)],
        [
            1.8171288477027623e-5,
            0.00084361056248472744,
            0.039537164919025249,
            0.43604516507829315,
            1.5350442026446435,
            2.6740603137235603,
        ],
        [
            41.337535040746262,
            29.145901478829518,
            16.5535284084145,
            8.4059469148854655,
            4.2790298601253335,
            2.6740603137235603,
        ],
    ),
    (
        "gamma",
        &[("shape", 400.0), ("scale", 1.0)],
        [
            261.20366288931825,
            285.61657299927835,
            320.36216298870039,
            354.94845712688527,
            383.07773533823935,
            399.66671609446439,
        ],
        [
            580.09682761189546,
            540.66258028668224,
            491.0905505404817,
            447.99212782875818,
            416.72787443935392,
            399.66671609446439,
        ],
    ),
    (
        "beta",
        &[("alpha", 0.5), ("beta", 0.7)],
        [
            1.569752867602129e-30,
            1.5697528676021289e-20,
            1.5697528675528466e-10,
            0.00015697035848113614,
            0.061999574599043634,
            0.36108391313204374,
        ],
        [1.0, 0.99999999999998844, 0.99999983938849093, 0.99690190461877006, 0.79058436212639613, 0.36108391313204374],
    ),
    (
        "beta",
        &[("alpha", 2.0), ("beta", 3.0)],
        [
            1.290994459846917e-8,
            4.0824940158083329e-6,
            0.0012921074164783165,
            0.041998635621700715,
            0.21231712827795125,
            0.38572756813238955,
        ],
        [
            0.99999370038482922,
            0.99970757684679055,
            0.98638138649424683,
            0.85913245730545402,
            0.58245357452433327,
            0.38572756813238955,
        ],
    ),
    (
        "beta",
        &[("alpha", 200.0), ("beta", 500.0)],
        [
            0.16513605996157681,
            0.18640327117991373,
            0.21679324158841883,
            0.24695703488756329,
            0.27128619155343256,
            0.28551010314714305,
        ],
        [
            0.43096236225408255,
            0.40087024329582145,
            0.36160501151871909,
            0.32627083739743954,
            0.30002356433766809,
            0.28551010314714305,
        ],
    ),
    (
        "normal",
        &[("mean", 0.0), ("std", 1.0), ("lower", -0.5)],
        [
            -0.49999999999999804,
            -0.49999999980359825,
            -0.49998035992147864,
            -0.48045439105161217,
            -0.13367438398075871,
            0.39687117508954454,
        ],
        [
            7.9869728862948394,
            6.4177617089656412,
            4.3465548320529926,
            2.4616683149100879,
            1.0880229309678272,
            0.39687117508954454,
        ],
    ),
];

/// The value with a normal score.
fn at_score(law: &Marginal, z: f64) -> f64 {
    law.physical(match law.germ() {
        super::Germ::Own(own) => own.at_score(z),
        _ => z,
    })
}

/// Standard deviation of a law, by its polynomials: √b_1.
fn std(law: &Marginal) -> f64 {
    law.family().recurrence(1).off_diagonal[0] * law.slope(0.0)
}

#[test]
fn quantiles_are_those_of_forty_digits() {
    for (name, given, below, above) in QUANTILES {
        for polynomials in [Polynomials::Own, Polynomials::Hermite] {
            let parameters = Parameters::of(given.iter().copied()).with_polynomials(Some(polynomials));
            let law = Marginal::named(name, &parameters).unwrap();
            let own = Marginal::named(name, &Parameters::of(given.iter().copied())).unwrap();
            let [lower, _] = law.support();
            for (k, p) in PROBABILITIES.into_iter().enumerate() {
                for (found, expected) in
                    [(at_score(&law, quantile(p)), below[k]), (at_score(&law, -quantile(p)), above[k])]
                {
                    let error = (found - expected).abs();
                    let in_core = error <= 1e-12 * std(&own);
                    // In the tails relative to the distance from the end, but for the rounding of the value itself.
                    let in_tail = error <= 1e-9 * (expected - lower).abs() + 2.0 * f64::EPSILON * lower.abs().min(1.0);
                    assert!(in_tail && (in_core || p < 1e-3), "{name} {given:?} at {p:e}: {found:e}, {expected:e}");
                }
            }
        }
    }
}

#[test]
fn laws_with_quantiles_in_closed_form_have_them() {
    let triangle = law("triangular", &[("lower", 1.0), ("mode", 1.5), ("upper", 3.0)]);
    let weibull = law("weibull", &[("shape", 1.5), ("scale", 2.0)]);
    let wide = law("weibull", &[("shape", 0.5), ("scale", 2.0)]);
    let gumbel = law("gumbel", &[("location", 1.0), ("scale", 0.2)]);
    let exponential = law("exponential", &[("mean", 0.5)]);
    let lognormal = law("lognormal", &[("mean", 1.0), ("std", 0.5)]);
    let (variance, waiting) = (1.25f64.ln(), |p: f64| -(-p).ln_1p());
    for k in 1..200 {
        let p = f64::from(k) / 200.0;
        let z = quantile(p);
        let expected = [
            (&triangle, if p < 0.25 { 1.0 + p.sqrt() } else { 3.0 - (3.0 * (1.0 - p)).sqrt() }),
            (&weibull, 2.0 * waiting(p).powf(1.0 / 1.5)),
            (&wide, 2.0 * waiting(p).powi(2)),
            (&gumbel, 1.0 - 0.2 * (-p.ln()).ln()),
            (&exponential, 0.5 * waiting(p)),
            (&lognormal, (variance.sqrt() * z - 0.5 * variance).exp()),
        ];
        for (law, expected) in expected {
            let found = at_score(law, z);
            assert!((found - expected).abs() < 3e-13 * expected.abs(), "{} at {p}: {found} {expected}", law.name());
        }
    }
}

/// Coefficients of x become those of ξ = x/std.
#[track_caller]
fn assert_is(law: &Marginal, diagonal: impl Fn(f64) -> f64, square: impl Fn(f64) -> f64) {
    const DEGREE: usize = 20;
    let Recurrence { diagonal: found, off_diagonal } = law.family().recurrence(DEGREE);
    let scale = law.slope(0.0);
    for k in 0..DEGREE {
        let expected = [diagonal(k as f64), square(k as f64 + 1.0).sqrt()];
        for (found, expected) in [found[k] * scale, off_diagonal[k] * scale].into_iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-10 * expected.abs(), "degree {k}: {found} {expected}");
        }
    }
}

#[test]
fn polynomials_of_gamma_laws_are_those_of_laguerre() {
    for shape in [0.5, 1.0, 3.0, 400.0] {
        let gamma = law("gamma", &[("shape", shape), ("scale", 1.0)]);
        assert_is(&gamma, |n| 2.0 * n + shape, |n| n * (n + shape - 1.0));
        assert_eq!(gamma.family().name(), "laguerre");
    }
    assert_is(&law("exponential", &[("mean", 1.0)]), |n| 2.0 * n + 1.0, |n| n * n);
}

#[test]
fn polynomials_of_beta_laws_are_those_of_jacobi() {
    for (alpha, beta) in [(0.5, 0.7), (1.0, 1.0), (2.0, 3.0), (20.0, 50.0)] {
        let jacobi = law("beta", &[("alpha", alpha), ("beta", beta)]);
        // Of t = 2x − 1 under (1 − t)^a (1 + t)^b.
        let (a, b) = (beta - 1.0, alpha - 1.0);
        let diagonal = |n: f64| {
            let middle = match n == 0.0 {
                true => (b - a) / (a + b + 2.0),
                false => (b * b - a * a) / ((2.0 * n + a + b) * (2.0 * n + a + b + 2.0)),
            };
            0.5 * (1.0 + middle)
        };
        let square = |n: f64| {
            let s = 2.0 * n + a + b;
            let rest = if n == 1.0 { 1.0 } else { (n + a + b) / (s - 1.0) };
            n * (n + a) * (n + b) * rest / (s * s * (s + 1.0))
        };
        assert_is(&jacobi, diagonal, square);
    }
}

/// Under the trapezoidal rule in the normal score, which meets the pieces and not the rule that made the polynomials;
/// as far as they end beyond nothing that counts.
#[test]
fn polynomials_are_orthonormal_under_another_quadrature() {
    const DEGREE: usize = 15;
    let laws: [(&str, Given); 6] = [
        ("beta", &[("alpha", 2.0), ("beta", 3.0)]),
        ("beta", &[("alpha", 0.5), ("beta", 0.7)]),
        ("normal", &[("mean", 0.0), ("std", 1.0), ("lower", -0.5), ("upper", 2.0)]),
        ("normal", &[("mean", 0.0), ("std", 1.0), ("lower", 5.0), ("upper", 7.0)]),
        ("triangular", &[("lower", 1.0), ("mode", 1.0), ("upper", 3.0)]),
        ("triangular", &[("lower", 1.0), ("mode", 3.0), ("upper", 3.0)]),
    ];
    for (name, given) in laws {
        let law = law(name, given);
        let recurrence = law.family().recurrence(DEGREE);
        let mut gram = [[0.0; DEGREE + 1]; DEGREE + 1];
        let mut values = [0.0; DEGREE + 1];
        let step = 1.0 / 64.0;
        for k in -544..=544 {
            let z = f64::from(k) * step;
            let weight = step * (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
            recurrence.evaluate(law.standardized(at_score(&law, z)), &mut values);
            for (i, row) in gram.iter_mut().enumerate() {
                row.iter_mut().enumerate().for_each(|(j, entry)| *entry += weight * values[i] * values[j]);
            }
        }
        for (i, row) in gram.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                assert!((entry - f64::from(i == j)).abs() < 1e-10, "{name} {given:?}: E[φ_{i} φ_{j}] = {entry}");
            }
        }
    }
}

#[test]
fn parameters_at_extremes_are_resolved_or_refused() {
    let made = |name, given: &[(&'static str, f64)]| Marginal::named(name, &Parameters::of(given.iter().copied()));
    for (name, given) in [
        ("gamma", [("shape", 1e6), ("scale", 1e-3)]),
        ("gamma", [("shape", 0.1), ("scale", 1e3)]),
        ("gamma", [("shape", 0.05), ("scale", 1e-9)]),
        ("beta", [("alpha", 1e6), ("beta", 1e6)]),
        ("beta", [("alpha", 0.05), ("beta", 100.0)]),
        ("beta", [("alpha", 0.08), ("beta", 0.05)]),
        ("weibull", [("shape", 1e4), ("scale", 1e-9)]),
        ("weibull", [("shape", 0.1), ("scale", 1e9)]),
        ("gumbel", [("location", 1e6), ("scale", 1.0)]),
    ] {
        let law = made(name, &given).unwrap_or_else(|error| panic!("{name} {given:?}: {error}"));
        let values: Vec<f64> = (-80..=80).map(|k| at_score(&law, f64::from(k) / 10.0)).collect();
        // They rise but for rounding.
        let is_rising = values.is_sorted_by(|a, b| *b >= a - 1e-13 * a.abs());
        assert!(is_rising && values.iter().all(|x| x.is_finite()), "{name} {given:?}");
        if let super::Germ::Own(own) = law.germ() {
            println!("{name} {given:?}: {} pieces", own.quantile.coefficients().count());
        }
    }
    for (name, given) in [
        ("gamma", [("shape", 1e9), ("scale", 1.0)]),
        ("gamma", [("shape", 1e-9), ("scale", 1.0)]),
        ("gamma", [("shape", 1e5), ("scale", 1e305)]),
        ("beta", [("alpha", 1e9), ("beta", 1.0)]),
        ("weibull", [("shape", 0.01), ("scale", 1.0)]),
    ] {
        assert!(made(name, &given).is_err(), "{name} {given:?}");
    }
}

#[test]
fn values_that_differ_in_few_digits_are_refused_at_once_and_for_that() {
    use super::super::measured::Smoothing;
    let made = |name, given: &[(&'static str, f64)]| Marginal::named(name, &Parameters::of(given.iter().copied()));
    let data = |offset: f64| {
        let values: Vec<f64> = (0..40).map(|k| offset + (f64::from(k) * 0.754_877_666).fract()).collect();
        Marginal::measured(&values, [None, None], Smoothing::Kernel, None)
    };
    let start = std::time::Instant::now();
    for (refused, expected) in [
        (data(1e9), "of these values is 2.9e-10 of the mean, less than double precision resolves (1.1e-6); subtract"),
        (data(-1e15), "subtract a constant from them, which the model adds"),
        (made("gumbel", &[("location", 1_000_001.0), ("scale", 0.3)]), "of this gumbel law is 3.9e-7 of the mean"),
        (
            made("normal", &[("mean", 1e9), ("std", 1.0), ("lower", 0.0)]),
            "of this normal law is 1.0e-9 of its distance from the nearer bound, less than double precision resolves \
             (1.1e-6); leave out the bounds, or subtract",
        ),
        (made("gumbel", &[("mean", -1e9), ("std", 1.0)]), "take a normal law, or subtract a constant from its values"),
    ] {
        let message = refused.unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
    assert!(start.elapsed().as_secs_f64() < 0.5, "without a single piece");
    for (name, given) in [
        ("gumbel", &[("location", 1e5), ("scale", 0.3)][..]),
        ("gumbel", &[("location", -1e6), ("scale", 1.0)]),
        // Distances from an end keep their digits.
        ("normal", &[("mean", 2e5), ("std", 0.3), ("lower", 0.0)]),
        ("normal", &[("mean", 1e9), ("std", 1.0), ("lower", 1e9 + 1.0)]),
        ("triangular", &[("lower", 1e9), ("mode", 1e9 + 1.0), ("upper", 1e9 + 2.0)]),
    ] {
        let law = made(name, given).unwrap_or_else(|error| panic!("{name} {given:?}: {error}"));
        assert!(law.at_centred_probability(0.5) > law.at_centred_probability(-0.5));
    }
}
