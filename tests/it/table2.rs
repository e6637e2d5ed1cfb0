//! The paper's table 2: the sparse rows never take more model runs or have a larger error than its upper values, and
//! the documents print the table that is computed.

use crate::support::reproduction::{Row, TABLE_2};
use crate::support::text;
use std::collections::BTreeMap;

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

/// Model runs of a row, smallest and largest; those of the final mesh.
type Runs = [(u64, u64); 2];

/// Inputs and method of each row with its runs, in order.
type Rows = Vec<((usize, String), Runs)>;

/// A cell like `1 706–2 117`.
fn range(cell: &str) -> (u64, u64) {
    let number = |text: &str| text.chars().filter(char::is_ascii_digit).collect::<String>().parse().unwrap();
    let (lower, upper) = cell.split_once('–').unwrap_or((cell, cell));
    (number(lower), number(upper))
}

/// The rows of a documented table whose head has these columns.
fn documented(table: &str, head: &str, runs: usize, mesh: usize) -> Rows {
    let rows =
        table.lines().skip_while(|line| !line.starts_with(head)).skip(2).take_while(|line| line.starts_with('|'));
    let read = |row: &str| {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let method = cells[2].replace(", least squares", "");
        ((cells[1].parse().unwrap(), method), [range(cells[runs]), range(cells[mesh])])
    };
    let mut rows: Rows = rows.map(read).collect();
    rows.sort();
    rows
}

/// The rows that are computed, sparse ones of five designs as one.
fn computed(target: &str) -> Rows {
    let runs = |row: &Row| [row.direct_computations, row.final_mesh_computations];
    let (mut rows, mut sparse) = (Rows::new(), BTreeMap::new());
    for row in TABLE_2.rows.iter().filter(|row| row.target == target) {
        let name = match row.method.as_str() {
            "gpc" => "gPC",
            "me-gpc" => "ME-gPC",
            _ => "sparse PC",
        };
        let key = (row.r, format!("{name}{}", if row.derivatives { " with derivatives" } else { "" }));
        let range = runs(row).map(|runs| (runs, runs));
        if name == "sparse PC" {
            let known: &mut Runs = sparse.entry(key).or_insert(range);
            for (known, new) in known.iter_mut().zip(runs(row)) {
                *known = (known.0.min(new), known.1.max(new));
            }
        } else {
            rows.push((key, range));
        }
    }
    rows.extend(sparse);
    rows.sort();
    rows
}

/// The page about the paper repeats four rows: with the same runs, errors and misclassified shares.
#[test]
fn rows_that_are_repeated_are_those_of_the_table() {
    let (table, page) = (text("docs/background/table2.md"), text("docs/background/paper.md"));
    let repeated: Vec<&str> = page.lines().filter(|line| line.starts_with("| sparse PC")).collect();
    assert_eq!(repeated.len(), 4);
    for row in repeated {
        let cells: Vec<&str> = row.split('|').map(str::trim).skip(4).filter(|cell| !cell.is_empty()).collect();
        let has_all = |line: &str| cells.iter().all(|cell| line.split('|').any(|known| known.trim() == *cell));
        assert!(table.lines().any(|line| line.starts_with("| 8 | sparse PC") && has_all(line)), "{row}");
    }
}

/// Its model runs, that is: errors are counted on more points there.
#[test]
fn the_documented_table_is_the_computed_one() {
    let table = text("docs/background/table2.md");
    let by_the_paper = documented(&table, "| r | method | order | paper | runs |", 5, 6);
    assert_eq!(by_the_paper.len(), 28);
    assert_eq!(by_the_paper, computed("eigenvalues"));
    let on_invariants = documented(&table, "| r | method | order | runs |", 4, 5);
    assert_eq!(on_invariants, computed("invariants"));
}
