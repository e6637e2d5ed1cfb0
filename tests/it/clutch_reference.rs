//! The clutch against eigenvalues from 40-digit arithmetic, through the command line as users see it.

use crate::support::{csv_rows, repository, text};
use assert_cmd::Command;
use nalgebra::Complex;

/// Errors allowed in double precision; LAPACK reaches 8e-12 and 3e-15 for single modes.
const RE_ABSOLUTE: f64 = 1e-10;
const IM_RELATIVE: f64 = 1e-13;
/// Mean and squared half difference of the pair are better conditioned than its eigenvalues.
const MEAN_RELATIVE: f64 = 1e-13;
const DISCRIMINANT_ABSOLUTE: f64 = 1e-8;

const INPUTS: usize = 8;

#[test]
fn reference_at_given_points_equals_40_digit_eigenvalues() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("study.toml");
    let all_modes = text("surrogates/clutch-r8-eigenvalues.toml").replace("modes = [3, 4]", "modes = \"all\"");
    std::fs::write(&study, all_modes).unwrap();
    let out = folder.path().join("out.csv");
    Command::cargo_bin("pcc")
        .unwrap()
        .arg("reference")
        .arg(&study)
        .arg("--points")
        .arg(repository("tests/data/clutch_eigenvalues.csv"))
        .arg("--out")
        .arg(&out)
        .assert()
        .success();

    let found = csv_rows(out.to_str().unwrap());
    let expected = csv_rows("tests/data/clutch_eigenvalues.csv");
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!(found[..INPUTS], expected[..INPUTS], "the points themselves are echoed");
        let modes = |row: &[f64]| -> Vec<Complex<f64>> {
            row[INPUTS..INPUTS + 8].chunks(2).map(|parts| Complex::new(parts[0], parts[1])).collect()
        };
        let (found_modes, expected_modes) = (modes(found), modes(expected));
        for (a, b) in found_modes.iter().zip(&expected_modes) {
            assert!((a.re - b.re).abs() <= RE_ABSOLUTE, "{a} is not {b}");
            assert!((a.im - b.im).abs() <= IM_RELATIVE * b.im, "{a} is not {b}");
        }
        let mean = |modes: &[Complex<f64>]| (modes[2] + modes[3]) / 2.0;
        let discriminant = |modes: &[Complex<f64>]| ((modes[2] - modes[3]) / 2.0).powi(2);
        let mean_error = (mean(&found_modes) - mean(&expected_modes)).norm() / mean(&expected_modes).norm();
        assert!(mean_error <= MEAN_RELATIVE, "Δs {mean_error:e}");
        let discriminant_error = (discriminant(&found_modes) - discriminant(&expected_modes)).norm();
        assert!(discriminant_error <= DISCRIMINANT_ABSOLUTE, "Δd {discriminant_error:e}");
        let max_re = expected_modes.iter().map(|lambda| lambda.re).fold(f64::MIN, f64::max);
        assert!((found[INPUTS + 8] - max_re).abs() <= RE_ABSOLUTE);
        assert_eq!(found[INPUTS + 9], f64::from(max_re < 0.0));
    }
}

/// The same proportions and moments as 2·10⁶ independent direct computations by another implementation.
#[test]
fn monte_carlo_on_the_model_agrees_with_independent_direct_computations() {
    const SAMPLES: u64 = 20_000;
    for row in csv_rows("tests/data/stability_reference.csv") {
        let study = crate::support::shipped_study(row[0] as usize);
        let found = pcc_compile::reference::monte_carlo(&study, SAMPLES, 1, &pcc_evaluate::foundation::Silent).unwrap();
        let (samples, proportion) = (SAMPLES as f64, row[2]);
        let standard_error = (proportion * (1.0 - proportion) / samples).sqrt();
        let difference = found.summary.stable_proportion().value() - proportion;
        assert!(difference.abs() < 4.0 * standard_error, "r = {}: {difference}", row[0]);
        // Columns: mean and variance of re_3, im_3, re_4, im_4.
        for (moments, expected) in found.summary.components.iter().zip(row[4..].chunks(2)) {
            let standard_error = (expected[1] / samples).sqrt();
            assert!((moments.mean() - expected[0]).abs() < 4.0 * standard_error);
        }
    }
}
