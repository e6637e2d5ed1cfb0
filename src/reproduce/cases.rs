//! The builds that the paper's table 2 is made of, and those that go beyond it.

use super::paper::TABLE_2;
use pcc_compile::study::{Study, StudyError};

/// Designs per sparse method, as in the paper.
const DESIGNS: u64 = 5;

/// Studies by the paper's components and by invariants, for one to eight inputs.
const STUDIES: [[&str; 2]; 8] = [
    [include_str!("../../surrogates/clutch-r1-eigenvalues.toml"), include_str!("../../surrogates/clutch-r1.toml")],
    [include_str!("../../surrogates/clutch-r2-eigenvalues.toml"), include_str!("../../surrogates/clutch-r2.toml")],
    [include_str!("../../surrogates/clutch-r3-eigenvalues.toml"), include_str!("../../surrogates/clutch-r3.toml")],
    [include_str!("../../surrogates/clutch-r4-eigenvalues.toml"), include_str!("../../surrogates/clutch-r4.toml")],
    [include_str!("../../surrogates/clutch-r5-eigenvalues.toml"), include_str!("../../surrogates/clutch-r5.toml")],
    [include_str!("../../surrogates/clutch-r6-eigenvalues.toml"), include_str!("../../surrogates/clutch-r6.toml")],
    [include_str!("../../surrogates/clutch-r7-eigenvalues.toml"), include_str!("../../surrogates/clutch-r7.toml")],
    [include_str!("../../surrogates/clutch-r8-eigenvalues.toml"), include_str!("../../surrogates/clutch-r8.toml")],
];

/// Most inputs.
pub const MOST_INPUTS: usize = STUDIES.len();

/// Elements with eight inputs, where the paper has no multi-element row: as many as with seven.
const ELEMENTS_BEYOND: usize = 4;

/// A build of the table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Case {
    /// `gpc`, `me-gpc` or `sparse`.
    pub method: &'static str,
    /// What is built; its seed is that of the design.
    pub study: Study,
}

/// What a study expands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Expanded {
    /// Re and Im of each mode of the pair.
    Eigenvalues,
    /// Invariants of all modes.
    Invariants,
}

/// The study with so many inputs, with these further lines.
pub(super) fn study(inputs: usize, expanded: Expanded, lines: &str) -> Result<Study, StudyError> {
    let text = STUDIES[inputs - 1][usize::from(expanded == Expanded::Invariants)];
    Study::from_toml(&format!("{text}\n{lines}"))
}

/// All builds with so many inputs; designs have the seeds from `seed` on.
pub(super) fn cases(inputs: usize, seed: u64) -> Result<Vec<Case>, StudyError> {
    let mut cases = Vec::new();
    for expanded in [Expanded::Eigenvalues, Expanded::Invariants] {
        cases.push(Case { method: "gpc", study: study(inputs, expanded, &quadrature(inputs))? });
        for elements in element_counts(inputs) {
            cases.push(Case { method: "me-gpc", study: study(inputs, expanded, &multi_element(elements))? });
        }
    }
    for lines in ["derivatives = false", ""] {
        let lines = format!("[fit]\nmethod = \"gpc\"\nsolver = \"least-squares\"\nmax_degree = 3\n{lines}\n");
        cases.push(Case { method: "gpc", study: Study { seed, ..study(inputs, Expanded::Invariants, &lines)? } });
    }
    for (expanded, lines) in [
        (Expanded::Eigenvalues, ""),
        (Expanded::Invariants, "[fit]\nderivatives = false\n"),
        (Expanded::Invariants, ""),
    ] {
        for design in 0..DESIGNS {
            let study = Study { seed: seed.wrapping_add(design), ..study(inputs, expanded, lines)? };
            cases.push(Case { method: "sparse", study });
        }
    }
    Ok(cases)
}

/// The table's order of gPC.
fn quadrature(inputs: usize) -> String {
    let row = TABLE_2.iter().find(|row| row.inputs == inputs && row.method == "gpc");
    let order = row.map_or(2.0, |row| row.order[0]);
    format!("[fit]\nmethod = \"gpc\"\nmax_degree = {order}\n")
}

/// The limit on elements, not θ₁, ends the division: as many elements as in the table.
fn multi_element(elements: usize) -> String {
    format!("[fit]\nmethod = \"me-gpc\"\nmax_degree = 2\ntheta_1 = 0.0\nelements = {elements}\n")
}

/// Elements of the table's rows: direct computations over 3ʳ.
fn element_counts(inputs: usize) -> Vec<usize> {
    let rows = TABLE_2.iter().filter(|row| row.inputs == inputs && row.method == "me-gpc");
    let counts: Vec<usize> = rows.map(|row| (row.direct_computations[0] / 3f64.powi(inputs as i32)) as usize).collect();
    if counts.is_empty() && inputs == MOST_INPUTS { vec![ELEMENTS_BEYOND] } else { counts }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_the_paper_has_its_case() {
        for inputs in 1..=MOST_INPUTS {
            let cases = cases(inputs, 1).unwrap();
            for row in TABLE_2.iter().filter(|row| row.inputs == inputs) {
                assert!(cases.iter().any(|case| case.method == row.method), "{row:?}");
            }
        }
        assert_eq!(element_counts(5), [14, 24]);
        assert_eq!(element_counts(8), [4]);
        assert_eq!(element_counts(1), Vec::<usize>::new());
    }
}
