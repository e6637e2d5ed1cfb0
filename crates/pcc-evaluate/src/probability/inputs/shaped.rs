//! Laws made from their densities: quantiles in pieces, polynomials by sums.

use super::density::{Density, Integrated, Place};
use super::germ::Germ;
use super::law::{Law, Source, Transform};
use super::marginal::{Marginal, Polynomials};
use super::marginal_error::MarginalError;
use super::normal_quantile::distribution;
use super::own_variable::OwnVariable;
use super::pieces::{Pieces, TOLERANCE};
use crate::polynomials::{OwnPolynomials, Recurrence};
use std::sync::Arc;

/// What a law has to say to become one: its parameters and its density.
pub(super) struct Draft {
    /// Name in study files.
    pub name: &'static str,
    /// Parameters in the order of study files.
    pub parameters: Vec<(&'static str, f64)>,
    /// Its density.
    pub density: Box<dyn Density>,
    /// What its polynomials are called.
    pub family: &'static str,
    /// Which ones it has unless a study chooses.
    pub default: Polynomials,
}

/// A law as files keep it that were made from its density.
pub(crate) struct Stored {
    /// x = origin + scale q(z).
    pub map: [f64; 2],
    /// q, z being the normal score.
    pub quantile: Pieces,
    /// Of which variable the polynomials are.
    pub polynomials: Polynomials,
    /// Their recurrence.
    pub recurrence: Recurrence,
}

/// x = origin + scale q(z), q being its quantile as a function of the normal score: in steps, where x takes single
/// values.
#[derive(Debug)]
pub(super) struct Shaped {
    name: &'static str,
    parameters: Vec<(&'static str, f64)>,
    support: [f64; 2],
    origin: f64,
    scale: f64,
    quantile: Arc<Pieces>,
    /// ξ = q, or ξ = z.
    germ: Germ,
    chosen: Option<Polynomials>,
    source: Option<Source>,
    is_discrete: bool,
}

/// The least standard deviation, relative to the size of values: below, these differ in so few digits that pieces
/// follow their rounding, thousands of them in vain.
const LEAST_SCATTER: f64 = f64::EPSILON / 2e-10;

/// The largest |F(q(z)) − Φ(z)| of what is stored, but for the rounding of q.
const RESOLUTION: f64 = 1e-12;

impl Draft {
    /// The law, with polynomials that a study has chosen or the usual ones.
    ///
    /// # Errors
    ///
    /// [`MarginalError::Narrow`] and [`MarginalError::Shape`] if its quantiles cannot be resolved in double precision.
    pub fn law(self, chosen: Option<Polynomials>) -> Result<Marginal, MarginalError> {
        self.shaped(chosen).map(Marginal::of)
    }

    /// The law of values that were read there.
    ///
    /// # Errors
    ///
    /// As [`Draft::law`].
    pub fn measured(self, chosen: Option<Polynomials>, source: Option<Source>) -> Result<Marginal, MarginalError> {
        Ok(Marginal::of(self.shaped(chosen)?.measured_in(source)))
    }

    fn shaped(self, chosen: Option<Polynomials>) -> Result<Shaped, MarginalError> {
        if let Some(narrow) = self.narrow() {
            return Err(narrow);
        }
        let unresolved = || MarginalError::Shape { law: self.name };
        let integrated = Integrated::new(&*self.density).ok_or_else(unresolved)?;
        let [mean, scale] = integrated.moments();
        let support = self.density.support();
        // Seen from an end, values near it keep their digits.
        let standard = |place: Place| match support {
            [lower, _] if lower.is_finite() => place.from_lower / scale,
            [_, upper] if upper.is_finite() => -place.to_upper / scale,
            _ => (place.x - mean) / scale,
        };
        let origin = support.into_iter().find(|end| end.is_finite()).unwrap_or(mean);
        let kinks = integrated.scores_of_kinks();
        let quantile = Pieces::of(|z| standard(integrated.at_score(z)), &kinks).ok_or_else(unresolved)?;
        let (places, weights) = integrated.rule();
        let nodes = places.into_iter().map(standard).collect();
        let polynomials = OwnPolynomials::of_density(self.family, nodes, weights);
        let basis = chosen.unwrap_or(self.default);
        // What readers of files will look at, too.
        let is_readable = quantile.is_rising()
            // Of measured values files have no density.
            && (self.name == "data" || is_quantile_of(&*self.density, [origin, scale], &quantile))
            && (basis == Polynomials::Hermite || are_polynomials_of(&polynomials, &quantile));
        if !(is_readable && is_resolved(&integrated, [origin, scale], &quantile)) {
            return Err(unresolved());
        }
        Ok(Shaped {
            chosen,
            ..Shaped::new(self.name, self.parameters, support, [origin, scale], quantile, basis, polynomials)
        })
    }

    /// Why its values differ in too few digits, if they do: seen from zero, or from the nearer end of its support.
    fn narrow(&self) -> Option<MarginalError> {
        let [mean, std] = self.density.typical();
        let from_ends = self.density.support().map(|end| (mean - end).abs());
        let nearest = from_ends[0].min(from_ends[1]);
        // Measured values are what they are, and no distances from an end.
        let (size, of) = match nearest.is_finite() && self.name != "data" {
            true => (nearest, "its distance from the nearer bound"),
            false => (mean.abs(), "the mean"),
        };
        let is_narrow = std < LEAST_SCATTER * size;
        is_narrow.then(|| MarginalError::Narrow { law: self.name, share: std / size, of, least: LEAST_SCATTER })
    }

    /// The law as a file has it.
    ///
    /// # Errors
    ///
    /// A sentence, if the map is not that of the density.
    pub fn stored(self, stored: Stored) -> Result<Marginal, &'static str> {
        if !is_quantile_of(&*self.density, stored.map, &stored.quantile) {
            return Err("its pieces are not the quantiles of its law");
        }
        of_file(self.name, self.parameters, self.density.support(), self.family, stored)
    }
}

/// A law of which a file has all that is known; a sentence if there is none.
pub(super) fn of_file(
    name: &'static str,
    parameters: Vec<(&'static str, f64)>,
    support: [f64; 2],
    family: &'static str,
    stored: Stored,
) -> Result<Marginal, &'static str> {
    let chosen = Some(stored.polynomials);
    let law = Shaped::of_file(name, parameters, support, family, stored)?;
    Ok(Marginal::of(Shaped { chosen, ..law }))
}

impl Shaped {
    /// The law of this map, with the polynomials of this basis.
    pub fn new(
        name: &'static str,
        parameters: Vec<(&'static str, f64)>,
        support: [f64; 2],
        [origin, scale]: [f64; 2],
        quantile: Pieces,
        basis: Polynomials,
        polynomials: OwnPolynomials,
    ) -> Self {
        let quantile = Arc::new(quantile);
        let germ = match basis {
            Polynomials::Hermite => Germ::Normal,
            Polynomials::Own => Germ::Own(Arc::new(OwnVariable {
                quantile: quantile.clone(),
                polynomials: Arc::new(polynomials),
                is_bounded: support.map(f64::is_finite),
            })),
        };
        let is_discrete = quantile.are_steps();
        Self { name, parameters, support, origin, scale, quantile, germ, chosen: None, source: None, is_discrete }
    }

    /// The law of a map that a file has; a sentence if there is none.
    pub fn of_file(
        name: &'static str,
        parameters: Vec<(&'static str, f64)>,
        support: [f64; 2],
        family: &'static str,
        Stored { map, quantile, polynomials, recurrence }: Stored,
    ) -> Result<Self, &'static str> {
        if !(map[0].is_finite() && map[1].is_normal() && map[1] > 0.0) {
            return Err("its map has no finite origin and positive scale");
        }
        let own = OwnPolynomials::stored(family, recurrence);
        if polynomials == Polynomials::Own && !are_polynomials_of(&own, &quantile) {
            return Err("its recurrence is not that of its law");
        }
        Ok(Self::new(name, parameters, support, map, quantile, polynomials, own))
    }

    /// The law as a file has it, of which all steps are known; a sentence if that is not its map.
    pub fn with_stored(self, stored: Stored) -> Result<Self, &'static str> {
        if stored.map != [self.origin, self.scale] || stored.quantile != *self.quantile {
            return Err("its steps are not those of its law");
        }
        Self::of_file(self.name, self.parameters, self.support, "own", stored)
    }

    /// The same, whose values were read there.
    pub fn measured_in(self, source: Option<Source>) -> Self {
        Self { source, ..self }
    }

    /// Whether ξ is the normal score.
    fn is_of_score(&self) -> bool {
        matches!(self.germ, Germ::Normal)
    }
}

/// Whether F(x(z)) is Φ(z).
fn is_resolved(integrated: &Integrated<'_>, [origin, scale]: [f64; 2], quantile: &Pieces) -> bool {
    (-32..=32).all(|k| {
        let z = f64::from(k) / 4.0;
        let x = scale.mul_add(quantile.at(z), origin);
        // Where a density is infinite, the rounding of a value alone can be more.
        let rounding = TOLERANCE * (x - origin).abs() + 4.0 * f64::EPSILON * (x.abs() + origin.abs());
        let [less, more] = [x - rounding, x + rounding].map(|x| integrated.probabilities(x));
        let [below, above] = [distribution(z), distribution(-z)];
        (less[0] - RESOLUTION <= below && below <= more[0] + RESOLUTION)
            || (more[1] - RESOLUTION <= above && above <= less[1] + RESOLUTION)
    })
}

/// Whether ln f(x(z)) + ln x′(z) + z²/2 is constant, as it is where x(z) gives normal variables the density f.
fn is_quantile_of(density: &dyn Density, [origin, scale]: [f64; 2], quantile: &Pieces) -> bool {
    const TOLERANCE: f64 = 1e-6;
    /// Of a standard deviation: nearer to an end, distances from it have lost their digits.
    const NEAR: f64 = 1e-6;
    let [lower, upper] = density.support();
    let level = |z: f64| {
        let distance = scale * quantile.at(z);
        let x = origin + distance;
        let from_lower = if origin == lower { distance } else { x - lower };
        let place = Place { x, from_lower, to_upper: upper - x };
        let is_near = place.from_lower < NEAR * scale || place.to_upper < NEAR * scale;
        (!is_near).then(|| density.log_density(place) + quantile.slope(z).ln() + 0.5 * z * z)
    };
    let levels: Vec<f64> = (-12..=12).filter_map(|k| level(f64::from(k) / 4.0)).collect();
    levels.iter().all(|value| (value - levels[0]).abs() <= TOLERANCE)
}

/// Whether the first coefficients are those of the variable q(z), and the others can be.
fn are_polynomials_of(own: &OwnPolynomials, quantile: &Pieces) -> bool {
    /// Of values in narrow heaps far apart coefficients follow from small differences.
    const TOLERANCE: f64 = 1e-4;
    const CHECKED: usize = 3;
    let (nodes, weights) = quantile.rule();
    // Of so many values there are no more polynomials.
    let checked = CHECKED.min(nodes.len() - 1);
    let expected = OwnPolynomials::of_density("own", nodes, weights).recurrence(checked);
    let Recurrence { diagonal, off_diagonal } = own.recurrence(own.stored_degree().unwrap_or(checked));
    let close = |found: &[f64], expected: &[f64]| {
        found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= TOLERANCE * b.abs().max(1.0))
    };
    close(&diagonal, &expected.diagonal)
        && close(&off_diagonal, &expected.off_diagonal)
        && diagonal.iter().all(|a| a.is_finite())
        && off_diagonal.iter().all(|b| b.is_normal() && *b > 0.0)
}

impl Law for Shaped {
    fn name(&self) -> &'static str {
        self.name
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        self.parameters.clone()
    }

    fn germ(&self) -> &Germ {
        &self.germ
    }

    fn physical(&self, xi: f64) -> f64 {
        let q = if self.is_of_score() { self.quantile.at(xi) } else { xi };
        self.scale.mul_add(q, self.origin).max(self.support[0]).min(self.support[1])
    }

    fn slope(&self, xi: f64) -> f64 {
        self.scale * if self.is_of_score() { self.quantile.slope(xi) } else { 1.0 }
    }

    fn standardized(&self, x: f64) -> f64 {
        let q = (x - self.origin) / self.scale;
        if self.is_of_score() { self.quantile.score(q) } else { q }
    }

    fn support(&self) -> [f64; 2] {
        self.support
    }

    fn transform(&self) -> Transform<'_> {
        Transform::Pieces { origin: self.origin, scale: self.scale, quantile: &self.quantile }
    }

    fn is_discrete(&self) -> bool {
        self.is_discrete
    }

    fn source(&self) -> Option<&Source> {
        self.source.as_ref()
    }

    fn chosen(&self) -> Option<Polynomials> {
        self.chosen
    }
}

#[cfg(test)]
mod tests;
