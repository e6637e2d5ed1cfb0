//! The assignment of rows to columns with the least total cost.
//!
//! The Hungarian method by shortest augmenting paths (Jonker and Volgenant 1987,
//! <https://doi.org/10.1007/BF02278710>): rows are assigned one after the other, and prices of columns see to it that
//! every partial assignment is the cheapest. The work grows as rows² × columns.

use nalgebra::DMatrix;

/// For every row the column assigned to it, no column twice, so that the sum of the costs is least.
///
/// Of assignments that cost the same, the choice depends on the order of rows and columns alone.
///
/// # Panics
///
/// If there are more rows than columns, or a cost is NaN.
///
/// # Examples
///
/// ```
/// use nalgebra::dmatrix;
/// use pcc_compile::numerics::assignment::assignment;
/// assert_eq!(assignment(&dmatrix![4.0, 1.0, 3.0; 2.0, 0.0, 5.0; 3.0, 2.0, 2.0]), [1, 0, 2]);
/// ```
pub fn assignment(costs: &DMatrix<f64>) -> Vec<usize> {
    let (rows, columns) = costs.shape();
    assert!(rows <= columns, "every row needs a column of its own");
    assert!(costs.iter().all(|cost| !cost.is_nan()), "costs are numbers");
    let (mut row_prices, mut column_prices) = (vec![0.0; rows], vec![0.0; columns]);
    let mut row_of: Vec<Option<usize>> = vec![None; columns];
    for start in 0..rows {
        // The shortest path from the new row to a column that is free, over columns that are taken.
        let (mut distances, mut before) = (vec![f64::INFINITY; columns], vec![None; columns]);
        let mut is_done = vec![false; columns];
        let (mut row, mut last, mut length) = (start, None, 0.0);
        let end = loop {
            for column in (0..columns).filter(|&column| !is_done[column]) {
                let through = length + costs[(row, column)] - row_prices[row] - column_prices[column];
                if through < distances[column] {
                    (distances[column], before[column]) = (through, last);
                }
            }
            let open = (0..columns).filter(|&column| !is_done[column]);
            let nearest = open.reduce(|a, b| if distances[b] < distances[a] { b } else { a });
            let nearest = nearest.expect("there are as many columns as rows");
            length = distances[nearest];
            is_done[nearest] = true;
            match row_of[nearest] {
                None => break nearest,
                Some(taken_by) => (row, last) = (taken_by, Some(nearest)),
            }
        };
        for column in (0..columns).filter(|&column| is_done[column] && column != end) {
            let change = length - distances[column];
            column_prices[column] -= change;
            if let Some(row) = row_of[column] {
                row_prices[row] += change;
            }
        }
        row_prices[start] += length;
        // Every column on the path goes to the row before it.
        let mut column = end;
        while let Some(previous) = before[column] {
            row_of[column] = row_of[previous];
            column = previous;
        }
        row_of[column] = Some(start);
    }
    let mut column_of = vec![0; rows];
    for (column, row) in row_of.iter().enumerate() {
        if let Some(row) = row {
            column_of[*row] = column;
        }
    }
    column_of
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::probability::random::{Purpose, Stream};

    fn cost(costs: &DMatrix<f64>, columns: &[usize]) -> f64 {
        columns.iter().enumerate().map(|(row, &column)| costs[(row, column)]).sum()
    }

    fn cheapest(costs: &DMatrix<f64>, row: usize, used: &mut Vec<usize>) -> f64 {
        if row == costs.nrows() {
            return cost(costs, used);
        }
        let mut least = f64::INFINITY;
        for column in 0..costs.ncols() {
            if !used.contains(&column) {
                used.push(column);
                least = least.min(cheapest(costs, row + 1, used));
                used.pop();
            }
        }
        least
    }

    #[test]
    fn no_other_assignment_is_cheaper() {
        let mut stream = Stream::new(5, Purpose::Design, 0);
        for (rows, columns) in [(1, 1), (2, 2), (3, 3), (5, 5), (6, 6), (3, 5), (1, 4), (0, 2)] {
            for _ in 0..20 {
                // Whole numbers, so that many assignments cost the same.
                let costs = DMatrix::from_fn(rows, columns, |_, _| (10.0 * stream.next_unit()).floor() - 5.0);
                let found = assignment(&costs);
                let mut distinct = found.clone();
                distinct.sort_unstable();
                distinct.dedup();
                assert_eq!(distinct.len(), rows);
                assert_eq!(cost(&costs, &found), cheapest(&costs, 0, &mut Vec::new()), "{costs}");
            }
        }
    }
}
