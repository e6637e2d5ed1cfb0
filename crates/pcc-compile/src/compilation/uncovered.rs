//! Where no run is: parts of the inputs' laws of which given runs say nothing.
//!
//! A random point is *uncovered* if no run is near it in one input, or in a pair of independent inputs: if none lies
//! within a distance within which a random sample of as many runs leaves none, but for one case in ten thousand, even
//! in a corner. Distances are those of the distribution functions u = F(x).

use super::given::probabilities;
use super::judged_points::judged_point;
use crate::fitting::design::Samples;
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::probability::inputs::InputSpace;
use std::f64::consts::PI;

/// Random points of the laws: a share of a hundredth is known to a tenth of itself.
const POINTS: usize = 10_000;

/// −ln of the chance that a random sample leaves as large a neighbourhood empty.
const HARDLY_EMPTY: f64 = 9.2;

/// Inputs whose values at uncovered points span at most this share of their law are named.
const NARROW: f64 = 0.6;

/// Where no run is.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncovered {
    /// The share of the inputs' laws.
    pub share: f64,
    /// Inputs with the ends of the values that they have there, where these are few: physical values.
    pub place: Vec<(String, [f64; 2])>,
}

/// The part of the laws where none of the runs at these standardized points is.
pub(super) fn uncovered(
    inputs: &InputSpace,
    seed: u64,
    runs: &Samples,
    observer: &dyn Observer,
) -> Result<Uncovered, Interrupted> {
    let physical: Vec<Vec<f64>> = (0..POINTS).map(|i| inputs.physical(&judged_point((inputs, seed), i))).collect();
    let points = probabilities(inputs, physical.iter().cloned());
    let runs = probabilities(inputs, runs.points().map(|point| inputs.physical(point)));
    let views = views(inputs);
    let found = try_map(views.len(), |k| {
        observer.check()?;
        Ok(lonely(&views[k], &points, &runs))
    })?;
    let mut is_lonely = vec![false; POINTS];
    found.into_iter().flatten().for_each(|i| is_lonely[i] = true);
    let lonely: Vec<usize> = (0..POINTS).filter(|&i| is_lonely[i]).collect();
    if lonely.is_empty() {
        return Ok(Uncovered { share: 0.0, place: Vec::new() });
    }
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[lower, upper], x| [lower.min(x), upper.max(x)])
    };
    let mut place = Vec::new();
    for (j, input) in inputs.inputs().iter().enumerate() {
        let [lower, upper] = ends(&mut lonely.iter().map(|&i| points.point(i)[j]));
        if upper - lower <= NARROW {
            place.push((input.name.clone(), ends(&mut lonely.iter().map(|&i| physical[i][j]))));
        }
    }
    Ok(Uncovered { share: lonely.len() as f64 / POINTS as f64, place })
}

/// Single inputs and pairs of independent ones. Values of discrete inputs have no neighbourhoods.
fn views(inputs: &InputSpace) -> Vec<Vec<usize>> {
    let all: Vec<usize> = (0..inputs.dimension()).filter(|&j| !inputs.inputs()[j].marginal.is_discrete()).collect();
    let are_independent = |a: usize, b: usize| !inputs.correlated_with(a).contains(&b);
    let pairs = all.iter().flat_map(|&a| all.iter().filter(move |&&b| a < b).map(move |&b| vec![a, b]));
    all.iter().map(|&j| vec![j]).chain(pairs.filter(|pair| are_independent(pair[0], pair[1]))).collect()
}

/// The points that have no run nearby in these coordinates.
fn lonely(view: &[usize], points: &Samples, runs: &Samples) -> Vec<usize> {
    let count = runs.len() as f64;
    // Of a corner: an interval to one side, or a quarter of a disk.
    let square = match view.len() {
        1 => (HARDLY_EMPTY / count).powi(2),
        _ => 4.0 * HARDLY_EMPTY / (PI * count),
    };
    let project = |point: &[f64]| view.iter().map(|&j| point[j]).collect::<Vec<f64>>();
    let grid = Grid::new(view.len(), square.sqrt(), runs.points().map(project));
    (0..points.len()).filter(|&i| !grid.has_within(&project(points.point(i)), square)).collect()
}

/// Points of the unit interval or square, sorted into cells.
struct Grid {
    cells: Vec<Vec<Vec<f64>>>,
    per_side: usize,
    dimension: usize,
}

impl Grid {
    /// Cells are no smaller than `reach`, so that whatever lies within it is in a cell beside.
    fn new(dimension: usize, reach: f64, points: impl Iterator<Item = Vec<f64>>) -> Self {
        const MOST: f64 = 100.0;
        let per_side = (1.0 / reach).floor().clamp(1.0, MOST) as usize;
        let mut grid = Self { cells: vec![Vec::new(); per_side.pow(dimension as u32)], per_side, dimension };
        for point in points {
            let at = point.iter().fold(0, |at, &u| at * per_side + grid.cell(u));
            grid.cells[at].push(point);
        }
        grid
    }

    fn cell(&self, u: f64) -> usize {
        ((u * self.per_side as f64) as usize).min(self.per_side - 1)
    }

    fn has_within(&self, point: &[f64], square: f64) -> bool {
        let around = |u: f64| {
            let at = self.cell(u);
            at.saturating_sub(1)..=(at + 1).min(self.per_side - 1)
        };
        let near = |cell: usize| self.cells[cell].iter().any(|other| distance(point, other) <= square);
        match self.dimension {
            1 => around(point[0]).any(near),
            _ => around(point[0]).any(|a| around(point[1]).any(|b| near(a * self.per_side + b))),
        }
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;
    use pcc_evaluate::foundation::Silent;
    use pcc_evaluate::probability::inputs::random_points;
    use pcc_evaluate::probability::random::Purpose;

    fn inputs(laws: &str) -> InputSpace {
        let text = format!("format = 1\nname = \"x\"\n[model]\nkind = \"table\"\neigenvalues = 1\n[inputs]\n{laws}");
        Study::from_toml(&text).unwrap().inputs
    }

    fn three() -> InputSpace {
        inputs(
            "a = { distribution = \"uniform\", lower = 0.0, upper = 2.0 }\n\
             b = { distribution = \"normal\", mean = 5.0, std = 1.0 }\n\
             c = { distribution = \"uniform\", lower = -1.0, upper = 1.0 }",
        )
    }

    /// Random standardized points that `hold`.
    fn runs(inputs: &InputSpace, count: usize, hold: impl Fn(&[f64]) -> bool) -> Samples {
        let points = random_points(inputs, 7, Purpose::Evaluation, 0..20 * count as u64);
        let kept = points.into_iter().filter(|point| hold(&inputs.physical(point))).take(count);
        Samples::new(inputs.dimension(), kept.flatten().collect())
    }

    #[test]
    fn random_runs_leave_nothing_uncovered_and_missing_regions_are_named() {
        let inputs = three();
        for count in [30, 300, 3000] {
            let found = uncovered(&inputs, 1, &runs(&inputs, count, |_| true), &Silent).unwrap();
            assert!(found.share < 0.01, "{count}: {found:?}");
        }
        let side = uncovered(&inputs, 1, &runs(&inputs, 300, |x| x[0] < 1.4), &Silent).unwrap();
        assert!((side.share - 0.28).abs() < 0.03, "{side:?}");
        let [(name, [lower, upper])] = &side.place[..] else { panic!("{side:?}") };
        assert!(name == "a" && (1.4..1.5).contains(lower) && *upper > 1.99, "{side:?}");
        let corner = uncovered(&inputs, 1, &runs(&inputs, 1000, |x| x[0] < 1.2 || x[2] < 0.0), &Silent).unwrap();
        assert!((0.1..0.2).contains(&corner.share) && corner.place.len() == 2, "{corner:?}");
        let tail = uncovered(&inputs, 1, &runs(&inputs, 200, |x| x[1] < 6.0), &Silent).unwrap();
        assert!((0.09..0.16).contains(&tail.share) && tail.place[0].0 == "b", "{tail:?}");
    }
}
