//! Laws by their densities: integrals of a density that is known up to a factor, and its quantiles.
//!
//! A support is mapped to the whole line s, smoothly and so that both of its ends go to infinity. There every density
//! that is analytic inside its support falls at least exponentially, and Gauss rules on short panels integrate it to
//! rounding. Masses are summed up from both ends, so that small probabilities keep their digits.

use super::normal_quantile::{distribution, quantile, upper_quantile};
use super::root;
use crate::polynomials::{Family, gauss};

/// A value, with its distances from the ends of the support, which keep their digits near these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// The value.
    pub x: f64,
    /// From the lower end; infinite if there is none.
    pub from_lower: f64,
    /// To the upper end; infinite if there is none.
    pub to_upper: f64,
}

/// A density.
pub(super) trait Density: std::fmt::Debug + Send + Sync {
    /// Between what values it is positive; infinite where it has no bound.
    fn support(&self) -> [f64; 2];

    /// Its logarithm, but for a constant.
    fn log_density(&self, place: Place) -> f64;

    /// A typical value inside the support, and how far others are from it: mean and standard deviation, roughly.
    fn typical(&self) -> [f64; 2];

    /// Over what distance it can change, if that is less than how far typical values are from each other.
    fn finest(&self) -> f64 {
        f64::INFINITY
    }

    /// Between which values no gap ends it, however wide.
    fn reach(&self) -> [f64; 2] {
        [self.typical()[0]; 2]
    }

    /// Where it is not smooth inside its support, in ascending order.
    fn kinks(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// Width of panels in s, in which typical densities have a standard deviation of about 1.
const PANEL: f64 = 0.25;

/// Nodes per panel.
const NODES: usize = 20;

/// Panels in either direction, at most.
const MOST_PANELS: i32 = 1 << 17;

/// A density e^−110 of the largest counts for nothing, even under polynomials of high degree; gaps between two heaps
/// are no wider in s.
const NEGLIGIBLE: f64 = 110.0;
const GAP: f64 = 10.0;

/// Shortest distance from an end: below, logarithms of distances lose their digits.
const SHORTEST: f64 = 1e-290;

/// The map between s and the support.
#[derive(Debug, Clone, Copy)]
struct Line {
    support: [f64; 2],
    center: f64,
    /// dx/ds at the centre, relative to what the map is exponential in.
    rate: f64,
}

impl Line {
    /// s = 0 at `center`, s = 1 about one `spread` from it.
    fn new(support: [f64; 2], [center, spread]: [f64; 2]) -> Self {
        /// Laws over many orders of magnitude are walked through faster than by one e-fold per unit, but not much.
        const FASTEST: f64 = 2.0;
        let [lower, upper] = support;
        let rate = match (lower.is_finite(), upper.is_finite()) {
            (false, false) => spread,
            (true, false) => (spread / (center - lower)).min(FASTEST),
            (false, true) => (spread / (upper - center)).min(FASTEST),
            (true, true) => (spread / (center - lower) * ((upper - lower) / (upper - center))).min(FASTEST),
        };
        Self { support, center, rate }
    }

    /// The value at s, and dx/ds.
    fn at(&self, s: f64) -> (Place, f64) {
        let ([lower, upper], growth) = (self.support, self.rate * s);
        match (lower.is_finite(), upper.is_finite()) {
            (false, false) => {
                let x = self.center + growth;
                (Place { x, from_lower: f64::INFINITY, to_upper: f64::INFINITY }, self.rate)
            }
            (true, false) => {
                let distance = (self.center - lower) * growth.exp();
                let place = Place { x: lower + distance, from_lower: distance, to_upper: f64::INFINITY };
                (place, self.rate * distance)
            }
            (false, true) => {
                let distance = (upper - self.center) * (-growth).exp();
                let place = Place { x: upper - distance, from_lower: f64::INFINITY, to_upper: distance };
                (place, self.rate * distance)
            }
            (true, true) => {
                let width = upper - lower;
                let odds = (self.center - lower) / (upper - self.center) * growth.exp();
                let (from_lower, to_upper) = (width / (1.0 + 1.0 / odds), width / (1.0 + odds));
                let x = if from_lower < to_upper { lower + from_lower } else { upper - to_upper };
                (Place { x, from_lower, to_upper }, self.rate * from_lower / width * to_upper)
            }
        }
    }

    /// s at a value inside the support.
    fn of(&self, x: f64) -> f64 {
        let [lower, upper] = self.support;
        let growth = match (lower.is_finite(), upper.is_finite()) {
            (false, false) => x - self.center,
            (true, false) => ((x - lower) / (self.center - lower)).ln(),
            (false, true) => -((upper - x) / (upper - self.center)).ln(),
            (true, true) => ((x - lower) / (upper - x)).ln() - ((self.center - lower) / (upper - self.center)).ln(),
        };
        growth / self.rate
    }
}

/// A density with its integrals.
pub(super) struct Integrated<'a> {
    density: &'a dyn Density,
    line: Line,
    /// Width of panels in s.
    panel: f64,
    /// The Gauss rule on \[−1, 1\].
    rule: (Vec<f64>, Vec<f64>),
    /// The largest logarithm of a density in s.
    peak: f64,
    /// Ends of panels in s, in ascending order.
    edges: Vec<f64>,
    /// Probabilities below and above each of them.
    below: Vec<f64>,
    above: Vec<f64>,
}

impl<'a> Integrated<'a> {
    /// Integrates a density; `None` if it has no finite moments or is no density.
    pub fn new(density: &'a dyn Density) -> Option<Self> {
        let rough = Self::along(density, density.typical())?;
        let [mean, std] = rough.moments();
        let inside = density.support()[0] < mean && mean < density.support()[1];
        (inside && std.is_normal()).then(|| Self::along(density, [mean, std]))?
    }

    fn along(density: &'a dyn Density, typical: [f64; 2]) -> Option<Self> {
        let line = Line::new(density.support(), typical);
        let panel = PANEL.min(density.finest() / typical[1]);
        let legendre = Family::Legendre.recurrence(NODES);
        let rule = gauss(&legendre.diagonal, &legendre.off_diagonal[..NODES - 1]);
        let mut integrated = Self {
            density,
            line,
            panel,
            rule,
            peak: f64::NEG_INFINITY,
            edges: Vec::new(),
            below: Vec::new(),
            above: Vec::new(),
        };
        integrated.find_edges();
        let [from, to] = density.reach().map(|x| line.of(x));
        if !(integrated.edges.first() <= Some(&from) && Some(&to) <= integrated.edges.last()) {
            return None;
        }
        let masses: Vec<f64> = integrated.edges.windows(2).map(|ends| integrated.mass(ends[0], ends[1])).collect();
        let sum: f64 = masses.iter().sum();
        let summed = |masses: &mut dyn Iterator<Item = &f64>| -> Vec<f64> {
            let mut total = 0.0;
            let first = std::iter::once(0.0);
            first
                .chain(masses.map(|mass| {
                    total += mass / sum;
                    total
                }))
                .collect()
        };
        integrated.below = summed(&mut masses.iter());
        integrated.above = summed(&mut masses.iter().rev());
        integrated.above.reverse();
        // Masses are normalised from here on.
        integrated.peak += sum.ln();
        (sum.is_normal() && integrated.peak.is_finite()).then_some(integrated)
    }

    /// Panels as far as the density counts in either direction, with kinks at their ends.
    fn find_edges(&mut self) {
        let (mut edges, panel) = (vec![0.0], self.panel);
        let reach = self.density.reach().map(|x| self.line.of(x));
        for (direction, end) in [-1.0, 1.0].into_iter().zip(reach) {
            let mut without = 0.0;
            for k in 1..=MOST_PANELS {
                let s = direction * panel * f64::from(k);
                let (place, slope) = self.line.at(s);
                if !(place.from_lower > SHORTEST && place.to_upper > SHORTEST && slope < 1.0 / SHORTEST) {
                    break;
                }
                let value = self.log_density(s);
                self.peak = self.peak.max(value);
                without = if value < self.peak - NEGLIGIBLE { without + panel } else { 0.0 };
                edges.push(s);
                if without > GAP && direction * s > direction * end {
                    break;
                }
            }
        }
        edges.extend(self.density.kinks().into_iter().map(|x| self.line.of(x)));
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        self.edges = edges;
    }

    /// The logarithm of the density of s.
    fn log_density(&self, s: f64) -> f64 {
        let (place, slope) = self.line.at(s);
        self.density.log_density(place) + slope.ln()
    }

    /// Nodes and weights of the rule between two values of s.
    fn nodes(&self, from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (center, half) = (0.5 * (from + to), 0.5 * (to - from));
        let (places, shares) = &self.rule;
        places.iter().zip(shares).map(move |(place, share)| {
            let s = half.mul_add(*place, center);
            (s, 2.0 * half * share * (self.log_density(s) - self.peak).exp())
        })
    }

    fn mass(&self, from: f64, to: f64) -> f64 {
        self.nodes(from, to).map(|(_, weight)| weight).sum()
    }

    /// All values of the rule with their weights, as far as these are of any use.
    pub fn rule(&self) -> (Vec<Place>, Vec<f64>) {
        /// Squares of polynomials there must stay finite.
        const SMALLEST: f64 = 1e-250;
        let all = self.edges.windows(2).flat_map(|ends| self.nodes(ends[0], ends[1]));
        all.filter(|(_, weight)| *weight > SMALLEST).map(|(s, weight)| (self.line.at(s).0, weight)).unzip()
    }

    /// Mean and standard deviation.
    pub fn moments(&self) -> [f64; 2] {
        let (places, weights) = self.rule();
        // From the centre, so that a narrow law keeps its digits.
        let from_center = |power: i32| -> f64 {
            places.iter().zip(&weights).map(|(place, weight)| weight * (place.x - self.line.center).powi(power)).sum()
        };
        let (first, second) = (from_center(1), from_center(2));
        [self.line.center + first, (second - first * first).max(0.0).sqrt()]
    }

    /// The probabilities below and above a value inside the support.
    pub fn probabilities(&self, x: f64) -> [f64; 2] {
        let [lower, upper] = self.line.support;
        let s = self.line.of(x.max(lower).min(upper)).clamp(self.edges[0], self.edges[self.edges.len() - 1]);
        let panel = self.edges.partition_point(|edge| *edge <= s).clamp(1, self.edges.len() - 1) - 1;
        let [from, to] = [self.edges[panel], self.edges[panel + 1]];
        [self.below[panel] + self.mass(from, s), self.above[panel + 1] + self.mass(s, to)]
    }

    /// The normal scores Φ⁻¹(F(x)) of the kinks.
    pub fn scores_of_kinks(&self) -> Vec<f64> {
        let score = |x: f64| {
            let [below, above] = self.probabilities(x);
            // Nobody comes to a kink farther out.
            let is_resolved = below > f64::EPSILON && above > f64::EPSILON;
            is_resolved.then(|| if below < above { quantile(below) } else { upper_quantile(above) })
        };
        self.density.kinks().into_iter().filter_map(score).collect()
    }

    /// The value with the normal score z: F(x) = Φ(z).
    pub fn at_score(&self, z: f64) -> Place {
        let is_below = z <= 0.0;
        let target = distribution(-z.abs());
        // Mass between the panel's outer end and s, counted from the nearer end of the support.
        let panel = match is_below {
            true => self.below.partition_point(|&mass| mass <= target).saturating_sub(1),
            false => self.above.partition_point(|&mass| mass > target).saturating_sub(1),
        };
        let panel = panel.min(self.edges.len() - 2);
        let [from, to] = [self.edges[panel], self.edges[panel + 1]];
        let (known, sign) = if is_below { (self.below[panel], 1.0) } else { (self.above[panel + 1], -1.0) };
        let excess = |s: f64| {
            let part = if is_below { self.mass(from, s) } else { self.mass(s, to) };
            sign * (known - target + part)
        };
        let density = |s: f64| (self.log_density(s) - self.peak).exp();
        self.line.at(root::rising(excess, density, [from, to])).0
    }
}
