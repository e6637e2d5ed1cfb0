//! The sparse rows of the paper's table 2: never more model runs, never a larger error than its upper values.

use crate::support::reproduction::TABLE_2;

/// Inputs, most direct computations and largest error of the proportion in percent that the paper reports.
const PAPER: [(usize, u64, f64); 6] =
    [(3, 235, 2.65), (4, 482, 4.16), (5, 1187, 4.96), (6, 1399, 6.82), (7, 1708, 6.89), (8, 2117, 5.85)];

#[test]
fn every_row_stays_within_the_papers_upper_values_for_seeds_1_to_5() {
    for (inputs, most_runs, largest_error) in PAPER {
        for row in TABLE_2.sparse(inputs, "eigenvalues", false) {
            let (seed, runs, error) = (row.seed, row.direct_computations, row.error());
            assert!(runs <= most_runs, "r = {inputs}, seed {seed}: {runs} model runs");
            assert!(error <= largest_error, "r = {inputs}, seed {seed}: {error} %");
        }
    }
}
