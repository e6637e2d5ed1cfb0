//! What of a spectrum is expanded: from a spectrum to the components that polynomials approximate.

use super::clusters::{ClusterError, clusters};
use super::modes::{Spectrum, SpectrumError};
use nalgebra::Complex;
use pcc_evaluate::components::{Component, Output, OutputKind};
use std::f64::consts::TAU;

/// Frequencies change by less than this factor over the inputs, as a rule: modes that may be in a band at some point.
const AROUND_BAND: f64 = 2.0;

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
        let outputs = groups.into_iter().map(|group| {
            let of_group = |spectrum: &Spectrum| -> Vec<Complex<f64>> {
                group.iter().filter_map(|&mode| spectrum.oscillating().get(mode - 1).copied()).collect()
            };
            let kind = if group.len() == 1 { OutputKind::Eigenvalue } else { OutputKind::Cluster };
            let lambdas: Vec<Vec<Complex<f64>>> = spectra.iter().map(of_group).collect();
            output(kind, &Numbers { modes: group, reals: Vec::new() }, &lambdas)
        });
        Ok(with_ids(outputs.collect()))
    }
}

/// What the eigenvalues of a group are called.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Numbers {
    /// Numbers of its modes, from 1.
    pub modes: Vec<usize>,
    /// Numbers of its real eigenvalues that belong to no mode, from 1.
    pub reals: Vec<usize>,
}

/// The output of a group, given its eigenvalues at every point of a design. Ids of its components count from 0.
pub fn output(kind: OutputKind, numbers: &Numbers, lambdas: &[Vec<Complex<f64>>]) -> Output {
    let Numbers { modes, reals } = numbers;
    let (symbols, name): (Vec<(String, f64)>, _) = match kind {
        OutputKind::Eigenvalue => (vec![("re".to_owned(), 1.0), ("im".to_owned(), 1.0)], format!("mode {}", modes[0])),
        OutputKind::Cluster => {
            let (size, radius) = (modes.len(), radius(lambdas));
            let coefficients = (0..size - 1).rev().map(|m| (format!("c{m}"), radius.powi((size - m) as i32)));
            let parts = std::iter::once(("s".to_owned(), 1.0)).chain(coefficients);
            let both = |(symbol, scale): (String, f64)| ["re", "im"].map(|part| (format!("{part}_{symbol}"), scale));
            (parts.flat_map(both).collect(), format!("modes {}", list(modes, ", ")))
        }
        OutputKind::Closed => closed_symbols(numbers, lambdas),
    };
    let names = |symbol: String| match (kind, modes.len(), reals.len()) {
        // A real eigenvalue by itself is its own component.
        (OutputKind::Closed, 0, 1) => symbol,
        (OutputKind::Closed, ..) => format!("{symbol}_{}", closed_suffix(numbers)),
        _ => format!("{symbol}_{}", list(modes, "_")),
    };
    let component = |(id, (symbol, scale))| Component { id, name: names(symbol), center: 0.0, scale };
    Output {
        kind,
        modes: modes.clone(),
        reals: reals.clone(),
        name,
        unit: "1/s".to_owned(),
        components: symbols.into_iter().enumerate().map(component).collect(),
    }
}

/// The symmetric functions e₁ … eₙ, each scaled by the power of the largest |λ| that has its unit.
fn closed_symbols(numbers: &Numbers, lambdas: &[Vec<Complex<f64>>]) -> (Vec<(String, f64)>, String) {
    let Numbers { modes, reals } = numbers;
    if let ([], [real]) = (&modes[..], &reals[..]) {
        return (vec![(format!("real_{real}"), 1.0)], format!("real_{real}"));
    }
    let size = lambdas.iter().flatten().map(|lambda| lambda.norm()).fold(0.0, f64::max);
    let size = power_of_two(size);
    let symbols = (1..=2 * modes.len() + reals.len()).map(|m| (format!("e{m}"), size.powi(m as i32)));
    let modes_text = match modes.len() {
        0 => None,
        1 => Some(format!("mode {}", modes[0])),
        _ => Some(format!("modes {}", list(modes, ", "))),
    };
    let reals = reals.iter().map(|number| format!("real_{number}"));
    (symbols.collect(), modes_text.into_iter().chain(reals).collect::<Vec<_>>().join(", "))
}

fn closed_suffix(numbers: &Numbers) -> String {
    let reals = numbers.reals.iter().map(|number| format!("real_{number}"));
    numbers.modes.iter().map(usize::to_string).chain(reals).collect::<Vec<_>>().join("_")
}

fn list(numbers: &[usize], separator: &str) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(separator)
}

/// The outputs with ids that count through all of them.
pub fn with_ids(mut outputs: Vec<Output>) -> Vec<Output> {
    for (id, component) in outputs.iter_mut().flat_map(|output| &mut output.components).enumerate() {
        component.id = id;
    }
    outputs
}

/// The components of a group with these eigenvalues, in the order of its kind: the inverse of [`Output::recombine`].
/// Closed groups come with their conjugates.
pub fn components_of(kind: OutputKind, lambdas: &[Complex<f64>]) -> Vec<f64> {
    let parts = match kind {
        OutputKind::Eigenvalue => lambdas.to_vec(),
        OutputKind::Cluster => invariants(lambdas),
        OutputKind::Closed => return symmetric_functions(lambdas),
    };
    parts.iter().flat_map(|part| [part.re, part.im]).collect()
}

/// e₁, …, eₙ of eigenvalues that are closed under conjugation, by real factors: a pair is one quadratic.
fn symmetric_functions(lambdas: &[Complex<f64>]) -> Vec<f64> {
    // e_0, e_1, … of the factors so far.
    let mut e = vec![1.0];
    let mut times = |sum: f64, product: Option<f64>| {
        let before = e.clone();
        e.resize(before.len() + 1 + usize::from(product.is_some()), 0.0);
        for (m, value) in before.iter().enumerate() {
            e[m + 1] += sum * value;
            if let Some(product) = product {
                e[m + 2] += product * value;
            }
        }
    };
    for lambda in lambdas {
        if lambda.im > 0.0 {
            times(2.0 * lambda.re, Some(lambda.norm_sqr()));
        } else if lambda.im == 0.0 {
            times(lambda.re, None);
        }
    }
    e.split_off(1)
}

/// Writes the values of the components of `output` at one spectrum into `values`, by id. Its modes are frequency ranks,
/// so it is no closed group.
///
/// # Errors
///
/// [`SpectrumError::NoSuchMode`].
pub fn decompose(output: &Output, spectrum: &Spectrum, values: &mut [f64]) -> Result<(), SpectrumError> {
    let lambdas: Vec<Complex<f64>> = output.modes.iter().map(|&mode| spectrum.mode(mode)).collect::<Result<_, _>>()?;
    let numbers = components_of(output.kind, &lambdas);
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
pub(super) fn invariants(lambdas: &[Complex<f64>]) -> Vec<Complex<f64>> {
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
fn radius(lambdas: &[Vec<Complex<f64>>]) -> f64 {
    let at_point = |group: &Vec<Complex<f64>>| {
        let mean = group.iter().sum::<Complex<f64>>() / group.len() as f64;
        group.iter().map(|lambda| (lambda - mean).norm()).fold(0.0, f64::max)
    };
    power_of_two(lambdas.iter().map(at_point).fold(0.0, f64::max))
}

/// The smallest power of two that is not below; 1 for 0.
fn power_of_two(size: f64) -> f64 {
    if size > 0.0 { size.log2().ceil().exp2() } else { 1.0 }
}

/// Which modes a surrogate carries.
#[derive(Debug, Clone, PartialEq)]
pub enum Modes {
    /// All that oscillate.
    All,
    /// Those with these frequency ranks, ascending, from 1.
    Ranks(Vec<usize>),
    /// Those whose frequency in the middle of the inputs lies between these, in Hz.
    Band([f64; 2]),
}

impl Modes {
    /// The frequency ranks of those that may be meant in a spectrum somewhere among the inputs.
    pub fn of_interest(&self, spectrum: &Spectrum) -> Vec<usize> {
        let ranks = 1..=spectrum.count();
        match self {
            Self::All => ranks.collect(),
            Self::Ranks(ranks) => ranks.iter().copied().filter(|&mode| mode <= spectrum.count()).collect(),
            Self::Band([lower, upper]) => {
                let frequency = |rank: usize| spectrum.oscillating()[rank - 1].im / TAU;
                let near = |rank: &usize| {
                    let frequency = frequency(*rank);
                    frequency >= lower / AROUND_BAND && frequency <= upper * AROUND_BAND
                };
                ranks.filter(near).collect()
            }
        }
    }

    /// Whether an eigenvalue in the middle of the inputs is meant, if that is a matter of its frequency.
    pub fn has_frequency(&self, lambda: Complex<f64>) -> bool {
        match self {
            Self::Band([lower, upper]) => (*lower..=*upper).contains(&(lambda.im.abs() / TAU)),
            Self::All | Self::Ranks(_) => true,
        }
    }

    /// The ranks, given how many modes oscillate.
    ///
    /// # Errors
    ///
    /// [`SpectrumError::NoSuchMode`] if a rank is beyond `count`.
    pub fn ranks(&self, count: usize) -> Result<Vec<usize>, SpectrumError> {
        match self {
            Self::All | Self::Band(_) if count == 0 => Err(SpectrumError::NoSuchMode { mode: 1, count }),
            Self::All | Self::Band(_) => Ok((1..=count).collect()),
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
        let kind = if lambdas.len() == 1 { OutputKind::Eigenvalue } else { OutputKind::Cluster };
        let output = output(kind, &Numbers { modes, reals: Vec::new() }, &[lambdas.to_vec()]);
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
