//! What of a spectrum is expanded: from a spectrum to the components that polynomials approximate.

use super::clusters::{ClusterError, clusters};
use super::modes::{Spectrum, SpectrumError};
use nalgebra::Complex;
use pcc_evaluate::components::{Component, Output, OutputKind};

/// What the components of a surrogate are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Target {
    /// Re λ and Im λ of each mode, as in the paper.
    Eigenvalues,
    /// The symmetric functions of each group of modes that come close: smooth where eigenvalues coalesce.
    Invariants,
}

impl Target {
    /// Name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Eigenvalues => "eigenvalues",
            Self::Invariants => "invariants",
        }
    }

    /// The outputs for the modes with the given ranks, ascending, on a design with these spectra. Component ids count
    /// from 0 in the order of the outputs.
    ///
    /// # Errors
    ///
    /// [`ClusterError`], for invariants only.
    pub fn outputs(self, modes: &[usize], spectra: &[Spectrum]) -> Result<Vec<Output>, ClusterError> {
        let groups = match self {
            Self::Eigenvalues => modes.iter().map(|&mode| vec![mode]).collect(),
            Self::Invariants => clusters(spectra, modes)?,
        };
        let mut first_id = 0;
        let outputs = groups.into_iter().map(|group| {
            let output = match group[..] {
                [mode] => eigenvalue(mode, first_id),
                _ => cluster(&group, radius(&group, spectra), first_id),
            };
            first_id += output.components.len();
            output
        });
        Ok(outputs.collect())
    }
}

/// Writes the values of the components of `output` at one spectrum into `values`, by id: the inverse of
/// [`Output::recombine`].
///
/// # Errors
///
/// [`SpectrumError::NoSuchMode`].
pub fn decompose(output: &Output, spectrum: &Spectrum, values: &mut [f64]) -> Result<(), SpectrumError> {
    let lambdas: Vec<Complex<f64>> = output.modes.iter().map(|&mode| spectrum.mode(mode)).collect::<Result<_, _>>()?;
    let parts = match output.kind {
        OutputKind::Eigenvalue => lambdas,
        OutputKind::Cluster => invariants(&lambdas),
    };
    let numbers = parts.iter().flat_map(|part| [part.re, part.im]);
    output.components.iter().zip(numbers).for_each(|(component, number)| values[component.id] = number);
    Ok(())
}

/// The values of all components of `outputs` at one spectrum, by id.
///
/// # Errors
///
/// [`SpectrumError::NoSuchMode`].
pub fn components(outputs: &[Output], spectrum: &Spectrum) -> Result<Vec<f64>, SpectrumError> {
    let mut values = vec![0.0; outputs.iter().map(|output| output.components.len()).sum()];
    outputs.iter().try_for_each(|output| decompose(output, spectrum, &mut values))?;
    Ok(values)
}

/// The mean s of k eigenvalues, then the coefficients c_{k−2}, …, c_0 of Π(z − (λ_i − s)).
///
/// Eigenvalues of a coalescing pair are accurate to √ε each, but their symmetric functions to ε.
fn invariants(lambdas: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let mean = lambdas.iter().sum::<Complex<f64>>() / lambdas.len() as f64;
    if let [first, second] = lambdas[..] {
        let half = (first - second) * 0.5;
        return vec![mean, -half * half];
    }
    // Coefficients of the product so far, highest power first.
    let mut product = vec![Complex::new(1.0, 0.0)];
    for lambda in lambdas {
        let root = lambda - mean;
        product.push(Complex::new(0.0, 0.0));
        for k in (1..product.len()).rev() {
            let lower = product[k - 1] * root;
            product[k] -= lower;
        }
    }
    // z^k has coefficient 1 and z^{k−1} has 0, because the mean was taken off.
    std::iter::once(mean).chain(product.into_iter().skip(2)).collect()
}

/// The largest |λ − s| of a group over a design, as a power of two: what scales its coefficients.
fn radius(group: &[usize], spectra: &[Spectrum]) -> f64 {
    let largest = spectra.iter().fold(0f64, |largest, spectrum| {
        let lambdas = || group.iter().filter_map(|&mode| spectrum.oscillating().get(mode - 1));
        let mean = lambdas().sum::<Complex<f64>>() / group.len() as f64;
        lambdas().map(|lambda| (lambda - mean).norm()).fold(largest, f64::max)
    });
    if largest > 0.0 { largest.log2().ceil().exp2() } else { 1.0 }
}

fn eigenvalue(mode: usize, first_id: usize) -> Output {
    let component =
        |offset, part| Component { id: first_id + offset, name: format!("{part}_{mode}"), center: 0.0, scale: 1.0 };
    Output {
        kind: OutputKind::Eigenvalue,
        modes: vec![mode],
        name: format!("mode {mode}"),
        unit: "1/s".to_owned(),
        components: vec![component(0, "re"), component(1, "im")],
    }
}

/// The coefficient of z^m is scaled by the power of the radius that has its unit.
fn cluster(group: &[usize], radius: f64, first_id: usize) -> Output {
    let modes: Vec<String> = group.iter().map(usize::to_string).collect();
    let size = group.len();
    let symbols = std::iter::once(("s".to_owned(), 1.0))
        .chain((0..size - 1).rev().map(|m| (format!("c{m}"), radius.powi((size - m) as i32))));
    let parts = symbols.flat_map(|(symbol, scale)| ["re", "im"].map(|part| (format!("{part}_{symbol}"), scale)));
    let component = |(offset, (name, scale)): (usize, (String, f64))| Component {
        id: first_id + offset,
        name: format!("{name}_{}", modes.join("_")),
        center: 0.0,
        scale,
    };
    Output {
        kind: OutputKind::Cluster,
        modes: group.to_vec(),
        name: format!("modes {}", modes.join(", ")),
        unit: "1/s".to_owned(),
        components: parts.enumerate().map(component).collect(),
    }
}

/// Which modes a surrogate carries.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Modes {
    /// All that oscillate.
    All,
    /// Those with these frequency ranks, ascending, from 1.
    Ranks(Vec<usize>),
}

impl Modes {
    /// The ranks, given how many modes oscillate.
    ///
    /// # Errors
    ///
    /// [`SpectrumError::NoSuchMode`] if a rank is beyond `count`.
    pub fn ranks(&self, count: usize) -> Result<Vec<usize>, SpectrumError> {
        match self {
            Self::All if count == 0 => Err(SpectrumError::NoSuchMode { mode: 1, count }),
            Self::All => Ok((1..=count).collect()),
            Self::Ranks(ranks) => match ranks.iter().find(|&&mode| mode > count) {
                Some(&mode) => Err(SpectrumError::NoSuchMode { mode, count }),
                None => Ok(ranks.clone()),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::components::spectral_abscissa;
    use proptest::prelude::*;

    /// Away from coalescence, rounding of the coefficients moves roots by no more than this share of |λ|.
    const SEPARATED: f64 = 1e-10;

    fn round_trip(lambdas: &[Complex<f64>]) -> (Vec<Complex<f64>>, Vec<Complex<f64>>) {
        let spectrum = Spectrum::new(lambdas).unwrap();
        let modes: Vec<usize> = (1..=lambdas.len()).collect();
        let output = cluster(&modes, 1.0, 0);
        let mut values = vec![0.0; output.components.len()];
        decompose(&output, &spectrum, &mut values).unwrap();
        let mut found = Vec::new();
        output.recombine(&values, &mut found);
        (spectrum.oscillating().to_vec(), found)
    }

    fn frequencies(size: usize) -> impl Strategy<Value = Vec<(f64, f64)>> {
        prop::collection::vec((-20.0..20.0f64, 0.0..1.0f64), size..=size)
    }

    proptest! {
        #[test]
        fn exact_invariants_give_the_eigenvalues_back(
            parts in (2..=6usize).prop_flat_map(frequencies),
            base in 50.0..5000.0f64,
        ) {
            // Frequencies at least 5 rad/s apart.
            let lambdas: Vec<Complex<f64>> = parts
                .iter()
                .enumerate()
                .map(|(k, &(re, offset))| Complex::new(re, base + 10.0 * k as f64 + 5.0 * offset))
                .collect();
            let (expected, found) = round_trip(&lambdas);
            for (a, b) in expected.iter().zip(&found) {
                prop_assert!((a - b).norm() <= SEPARATED * a.norm(), "{a} against {b}");
            }
        }

        #[test]
        fn coalescing_eigenvalues_come_back_to_the_root_of_rounding(
            size in 2..=4usize,
            re in -20.0..20.0f64,
            im in 50.0..5000.0f64,
            distance in 0.0..1e-7f64,
        ) {
            let lambda = |k: usize| Complex::new(re, im) + Complex::new(0.3, 1.0) * distance * k as f64;
            let lambdas: Vec<Complex<f64>> = (0..size).map(lambda).collect();
            let (expected, found) = round_trip(&lambdas);
            // ε of the coefficients is ε^{1/k} of their roots.
            let tolerance = 4.0 * (f64::EPSILON * im).powf(1.0 / size as f64) .max(1e-15 * im) + 4.0 * distance;
            prop_assert!((spectral_abscissa(&expected) - spectral_abscissa(&found)).abs() <= tolerance);
        }

        #[test]
        fn the_order_of_eigenvalues_never_matters(parts in frequencies(4), rotation in 0..4usize) {
            let mut lambdas: Vec<Complex<f64>> =
                parts.iter().enumerate().map(|(k, &(re, im))| Complex::new(re, 100.0 + 3.0 * k as f64 + im)).collect();
            let (straight, first) = round_trip(&lambdas);
            lambdas.rotate_left(rotation);
            prop_assert_eq!(round_trip(&lambdas), (straight, first));
        }
    }

    #[test]
    fn a_pair_is_its_mean_and_minus_the_square_of_half_the_difference() {
        let lambdas = [Complex::new(1.0, 10.0), Complex::new(3.0, 14.0)];
        assert_eq!(invariants(&lambdas), [Complex::new(2.0, 12.0), -Complex::new(1.0, 2.0) * Complex::new(1.0, 2.0)]);
    }

    #[test]
    fn flutter_pairs_of_equal_frequency_rank_by_growth_rate() {
        let (expected, found) = round_trip(&[Complex::new(5.0, 100.0), Complex::new(-5.0, 100.0)]);
        assert_eq!(expected, found);
        assert!(found[0].re < found[1].re);
    }

    #[test]
    fn groups_of_one_are_eigenvalues() {
        let spectra = [[10.0, 50.0, 60.0], [11.0, 54.9, 55.0]]
            .map(|im| Spectrum::new(&im.map(|im| Complex::new(-1.0, im))).unwrap());
        let outputs = Target::Invariants.outputs(&[1, 2, 3], &spectra).unwrap();
        let kinds: Vec<_> = outputs.iter().map(|output| (output.kind, output.modes.clone())).collect();
        assert_eq!(kinds, [(OutputKind::Eigenvalue, vec![1]), (OutputKind::Cluster, vec![2, 3])]);
        let names: Vec<_> = outputs.iter().flat_map(|o| &o.components).map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["re_1", "im_1", "re_s_2_3", "im_s_2_3", "re_c0_2_3", "im_c0_2_3"]);
        assert_eq!(outputs[1].components[2].scale, 64.0, "half of 10 rad/s, as a power of two, squared");
    }
}
