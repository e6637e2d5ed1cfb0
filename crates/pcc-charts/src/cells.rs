//! Grids of cells: which part of the axes they take, and the blocks of one level they are drawn as.

use super::extent::drawable;
use super::layout::Plane;
use super::path::Blocks;
use super::scale::{limited, position, value, widened};
use super::{Axis, Cells, Chart, Scale, levels};

/// Cells narrower or lower than this are drawn together, as their mean: nobody can see more, and a million cells would
/// be a large file.
const FINEST: f64 = 1.0;
/// Half the width of a single cell on a logarithmic axis, in powers of ten, and the most on one of categories.
const HALF_DECADE: f64 = 0.5;
const HALF_PLACE: f64 = 0.5;

/// The cells with the same centre on one axis: a column or a row.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strip {
    /// Index of the centre.
    index: usize,
    /// Ends as positions: logarithms where the axis has them.
    low: f64,
    high: f64,
}

/// The strips of an axis in ascending order, which reach half way to their neighbours.
fn strips(axis: &Axis, centres: &[f64]) -> Vec<Strip> {
    let known = centres.iter().enumerate().filter(|(_, centre)| drawable(axis, **centre));
    let mut placed: Vec<(f64, usize)> = known.map(|(index, centre)| (position(axis, *centre), index)).collect();
    placed.sort_by(|one, other| one.0.total_cmp(&other.0));
    placed.dedup_by(|one, other| one.0 == other.0);
    let strip = |number: usize| {
        let (centre, index) = placed[number];
        let half_way = |other: &(f64, usize)| other.0 / 2.0 + centre / 2.0;
        let before = number.checked_sub(1).and_then(|before| placed.get(before)).map(half_way);
        let after = placed.get(number + 1).map(half_way);
        let (low, high) = match (before, after) {
            (Some(low), Some(high)) => (low, high),
            (Some(low), None) => (low, centre + (centre - low)),
            (None, Some(high)) => (centre - (high - centre), high),
            (None, None) => alone(axis, centre),
        };
        let (low, high) = match axis.scale {
            Scale::Categories(_) => (low.max(centre - HALF_PLACE), high.min(centre + HALF_PLACE)),
            _ => (limited(axis, low), limited(axis, high)),
        };
        Strip { index, low, high }
    };
    (0..placed.len()).map(strip).collect()
}

/// The ends of a strip without neighbours: those which an axis gets that shows one value.
fn alone(axis: &Axis, centre: f64) -> (f64, f64) {
    match axis.scale {
        Scale::Linear => widened(centre, centre),
        Scale::Logarithmic => (centre - HALF_DECADE, centre + HALF_DECADE),
        Scale::Categories(_) => (centre - HALF_PLACE, centre + HALF_PLACE),
    }
}

/// The rows of values; the last one may be short, and there may be fewer or more than centres.
fn rows(cells: &Cells) -> Vec<&[f64]> {
    cells.values.chunks(cells.x.len().max(1)).collect()
}

/// What the cells that can be drawn reach from and to, on both axes; nothing if there are none.
pub(super) fn spans(chart: &Chart, cells: &Cells) -> Option<[[f64; 2]; 2]> {
    let (columns, mut lines, rows) = (strips(&chart.x, &cells.x), strips(&chart.y, &cells.y), rows(cells));
    let mut in_use = vec![false; columns.len()];
    lines.retain(|line| {
        let Some(values) = rows.get(line.index) else { return false };
        let mut any = false;
        for (column, in_use) in columns.iter().zip(&mut in_use) {
            let known = values.get(column.index).is_some_and(|value| value.is_finite());
            *in_use |= known;
            any |= known;
        }
        any
    });
    let columns = columns.into_iter().zip(in_use).filter_map(|(column, in_use)| in_use.then_some(column));
    Some([ends(&chart.x, columns)?, ends(&chart.y, lines)?])
}

/// The least and the greatest value in ascending strips.
fn ends(axis: &Axis, strips: impl IntoIterator<Item = Strip>) -> Option<[f64; 2]> {
    let mut strips = strips.into_iter();
    let first = strips.next()?;
    let last = strips.last().unwrap_or(first);
    Some([value(axis, first.low), value(axis, last.high)])
}

/// Neighbouring strips that are drawn together, and where in the picture they begin and end.
struct Band {
    strips: Vec<usize>,
    near: f64,
    far: f64,
}

/// The bands of strips in the part of the picture from `first` to `last`.
fn bands(strips: &[Strip], place: impl Fn(f64) -> f64, [first, last]: [f64; 2]) -> Vec<Band> {
    let mut bands: Vec<Band> = Vec::new();
    for strip in strips {
        let [one, other] = [strip.low, strip.high].map(|end| place(end).clamp(first, last));
        let (near, far) = (one.min(other), one.max(other));
        // What is outside has been moved to the edge, where it has no width.
        if near >= far {
            continue;
        }
        // A wide strip keeps its own value beside a narrow one.
        let fine = |band: &&mut Band| band.far - band.near < FINEST && far - near < FINEST;
        match bands.last_mut().filter(fine) {
            Some(band) => {
                band.strips.push(strip.index);
                (band.near, band.far) = (band.near.min(near), band.far.max(far));
            }
            None => bands.push(Band { strips: vec![strip.index], near, far }),
        }
    }
    bands
}

/// The level of the mean of the known cells where a row of bands and a column of bands meet.
fn level(rows: &[&[f64]], band_of_rows: &Band, band_of_columns: &Band) -> Option<usize> {
    let values = band_of_rows.strips.iter().filter_map(|&row| rows.get(row));
    let cells = values.flat_map(|values| band_of_columns.strips.iter().filter_map(|&column| values.get(column)));
    let (mut sum, mut count) = (0.0, 0u32);
    for value in cells.filter(|value| value.is_finite()) {
        sum += value.clamp(0.0, 1.0);
        count += 1;
    }
    (count > 0).then(|| levels::of(sum / f64::from(count)))
}

/// A rectangle of one level.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    level: usize,
    from: [f64; 2],
    to: [f64; 2],
}

/// The visible cells, with neighbours of equal level in a row as one block.
fn blocks(chart: &Chart, cells: &Cells, plane: &Plane) -> Vec<Block> {
    let (area, rows) = (plane.area, rows(cells));
    let across = |position| plane.x_at(plane.x.fraction_of_position(position));
    let along = |position| plane.y_at(plane.y.fraction_of_position(position));
    let columns = bands(&strips(&chart.x, &cells.x), across, [area.left, area.right()]);
    let mut blocks: Vec<Block> = Vec::new();
    for row in bands(&strips(&chart.y, &cells.y), along, [area.top, area.bottom()]) {
        // Rows without values have nothing to merge with, either.
        let columns = columns.iter().filter(|_| row.strips.iter().any(|&strip| strip < rows.len()));
        for column in columns {
            let Some(level) = level(&rows, &row, column) else { continue };
            let next = Block { level, from: [column.near, row.near], to: [column.far, row.far] };
            let joins = |block: &&mut Block| {
                block.level == level && block.from[1] == next.from[1] && block.to[0] == next.from[0]
            };
            match blocks.last_mut().filter(joins) {
                Some(block) => block.to = next.to,
                None => blocks.push(next),
            }
        }
    }
    blocks
}

/// Draws the cells, one path for each level.
pub(super) fn draw(chart: &Chart, cells: &Cells, plane: &Plane) -> String {
    let mut paths: [Blocks; levels::CLASSES.len()] = Default::default();
    for block in blocks(chart, cells, plane) {
        paths[block.level].push(block.from, block.to);
    }
    let drawn: String = paths.iter().zip(levels::CLASSES).map(|(path, class)| path.draw(class)).collect();
    Blocks::group(&drawn)
}

#[cfg(test)]
mod tests {
    use super::super::layout::{Insets, Layout};
    use super::super::{Color, Marks, Series};
    use super::*;
    use proptest::prelude::*;

    fn chart(x: Axis, y: Axis, cells: &Cells) -> Chart {
        let series = vec![Series::new("Share", Color::Blue, Marks::Cells(cells.clone()))];
        Chart { title: String::new(), description: String::new(), x, y, series, guides: Vec::new() }
    }

    fn linear(cells: &Cells) -> (Chart, Vec<Block>) {
        let chart = chart(Axis::linear(""), Axis::linear(""), cells);
        let blocks = blocks(&chart, cells, &Layout::new(&chart, false, Insets::default()).plane);
        (chart, blocks)
    }

    fn ends_of(axis: &Axis, centres: &[f64]) -> Vec<[f64; 2]> {
        let ends = |strip: Strip| [value(axis, strip.low), value(axis, strip.high)];
        strips(axis, centres).into_iter().map(ends).collect()
    }

    #[test]
    fn cells_reach_half_way_to_their_neighbours() {
        assert_eq!(ends_of(&Axis::linear(""), &[0.0, 1.0, 4.0]), [[-0.5, 0.5], [0.5, 2.5], [2.5, 5.5]]);
        assert_eq!(ends_of(&Axis::linear(""), &[5.0]), [[4.5, 5.5]]);
        assert_eq!(ends_of(&Axis::linear(""), &[0.0]), [[-1.0, 1.0]]);
        let categories = Axis::categories("", vec![String::new(); 4]);
        assert_eq!(ends_of(&categories, &[0.0, 1.0, 3.0]), [[-0.5, 0.5], [0.5, 1.5], [2.5, 3.5]]);
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-12;
        let decades = ends_of(&Axis::logarithmic(""), &[1.0, 100.0]);
        assert!(near(decades[0][0], 0.1) && near(decades[0][1], 10.0) && near(decades[1][1], 1000.0), "{decades:?}");
    }

    #[test]
    fn centres_without_a_place_and_second_ones_are_skipped() {
        let found = strips(&Axis::linear(""), &[2.0, f64::NAN, 0.0, 2.0, f64::INFINITY, 1.0]);
        assert_eq!(found.iter().map(|strip| strip.index).collect::<Vec<_>>(), [2, 5, 0]);
        assert_eq!(strips(&Axis::logarithmic(""), &[-1.0, 0.0, 1.0]).len(), 1);
    }

    #[test]
    fn equal_neighbours_are_one_block_and_missing_cells_none() {
        let values = vec![0.1, 0.15, f64::NAN, 0.9, 0.2, 0.2, 0.2];
        let (_, blocks) = linear(&Cells { x: vec![0.0, 1.0, 2.0, 3.0], y: vec![0.0, 1.0], values });
        assert_eq!(blocks.iter().map(|block| block.level).collect::<Vec<_>>(), [1, 9, 2]);
        // The first row of values is the lowest.
        assert!(blocks[0].from[1] > blocks[2].from[1]);
    }

    #[test]
    fn cells_too_fine_to_see_become_their_mean() {
        let centres: Vec<f64> = (0..2000).map(f64::from).collect();
        let values = (0..2000).map(|column| f64::from(column % 2)).collect();
        let (_, blocks) = linear(&Cells { x: centres, y: vec![0.0], values });
        assert!(blocks.len() < 600 && blocks.iter().all(|block| (2..8).contains(&block.level)), "{}", blocks.len());
    }

    #[test]
    fn wide_cells_keep_their_value_beside_fine_ones() {
        let (_, blocks) =
            linear(&Cells { x: vec![0.0, 1e-4, 2.0, 4.0], y: vec![0.0], values: vec![1.0, 1.0, 0.0, 0.3] });
        // The second cell reaches half way to the third and is wide, too.
        assert_eq!(blocks.iter().map(|block| block.level).collect::<Vec<_>>(), [9, 0, 3]);
        let (_, blocks) = linear(&Cells { x: vec![0.0, 1e-4, 2.0], y: vec![0.0], values: vec![1.0, 0.0, 0.3] });
        assert_eq!(blocks.iter().map(|block| block.level).collect::<Vec<_>>(), [9, 0, 3]);
    }

    proptest! {
        #[test]
        fn complete_grids_fill_the_plot_area_exactly_once(
            x in prop::collection::btree_set(-1000..1000i32, 1..40),
            y in prop::collection::btree_set(-1000..1000i32, 1..40), seed in 0..1000usize,
        ) {
            let values = (0..x.len() * y.len()).map(|index| ((index * 7919 + seed) % 97) as f64 / 96.0);
            let [x, y] = [x, y].map(|set| set.into_iter().map(f64::from).collect());
            let (chart, blocks) = linear(&Cells { x, y, values: values.collect() });
            let area = Layout::new(&chart, false, Insets::default()).plane.area;
            let sizes = blocks.iter().map(|block| (block.to[0] - block.from[0]) * (block.to[1] - block.from[1]));
            let sum: f64 = sizes.sum();
            prop_assert!((sum / (area.width * area.height) - 1.0).abs() < 1e-9);
            let rows = blocks.chunk_by(|one, other| one.from[1] == other.from[1]);
            for row in rows {
                prop_assert!(row.windows(2).all(|pair| (pair[0].to[0] - pair[1].from[0]).abs() < 1e-9));
            }
        }
    }
}
