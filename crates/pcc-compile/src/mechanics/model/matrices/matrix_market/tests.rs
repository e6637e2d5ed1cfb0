use super::*;
use proptest::prelude::*;

/// The files of `generate.py`, as array and as coordinates.
macro_rules! fixtures {
    ($name:literal) => {
        [
            include_str!(concat!("../../../../../../../tests/data/matrix_market/", $name, "_array.mtx")),
            include_str!(concat!("../../../../../../../tests/data/matrix_market/", $name, "_coordinate.mtx")),
        ]
    };
}

const GENERAL: &str = "%%MatrixMarket matrix coordinate real general\n";
const SYMMETRIC: &str = "%%MatrixMarket matrix coordinate real symmetric\n";
const SKEW: &str = "%%MatrixMarket matrix coordinate real skew-symmetric\n";
const ARRAY: &str = "%%MatrixMarket matrix array real general\n";
const INTEGER: &str = "%%MatrixMarket matrix coordinate integer general\n";

fn entries(text: &str) -> Vec<Entry> {
    read_matrix_market(text).unwrap().entries
}

fn message(text: &str) -> String {
    read_matrix_market(text).unwrap_err().to_string()
}

#[test]
fn files_of_scipy_are_read_exactly() {
    let third = 1.0 / 3.0;
    let general = [
        (0, 0, 0.1 + 0.2),
        (1, 0, third),
        (3, 0, std::f64::consts::PI),
        (1, 1, 2.5e17),
        (2, 1, -7.0),
        (0, 2, -1e-300),
        (2, 2, 1e22),
        (3, 2, 5e-324),
    ];
    let symmetric = [(0, 0, 4.0), (1, 0, -third), (0, 1, -third), (2, 1, 1e-9), (1, 2, 1e-9), (2, 2, 6.0)];
    let skew = [(1, 0, -0.7), (0, 1, 0.7), (2, 1, third), (1, 2, -third)];
    let integer = [(0, 0, 1.0), (1, 1, 9_007_199_254_740_992.0), (0, 2, -3.0)];
    let cases: [(_, usize, usize, &[Entry]); 4] = [
        (fixtures!("general"), 4, 3, &general),
        (fixtures!("symmetric"), 3, 3, &symmetric),
        (fixtures!("skew"), 3, 3, &skew),
        (fixtures!("integer"), 2, 3, &integer),
    ];
    for (files, rows, columns, expected) in cases {
        for file in files {
            let matrix = CoordinateMatrix { rows, columns, entries: expected.to_vec() };
            assert_eq!(read_matrix_market(file), Ok(matrix), "{file}");
        }
    }
}

#[test]
fn spelling_does_not_matter() {
    let expected = [(0, 0, 1500.0), (1, 1, -2.0)];
    for text in [
        "%%MATRIXMARKET MATRIX COORDINATE REAL GENERAL\n2 2 2\n1 1 1500\n2 2 -2",
        "%%MatrixMarket\tmatrix  coordinate double general  \n%\n\n  2 2\t2 \n\n1 1 1.5D+3\n% comment\n 2 2 -2.\n\n",
        "\u{feff}%%MatrixMarket matrix coordinate real general\r\n%\r\n2 2 2\r\n1 1 1.5e3\r\n2 2 -2e0\r\n",
        "%%MatrixMarket matrix coordinate integer general\n2 2 2\n2 2 -2\n1 1 1500\n",
        "%%MatrixMarket matrix array unsigned-integer general\n2 2\n1500\n0\n-0\n-2\n",
    ] {
        assert_eq!(entries(text), expected, "{text}");
    }
}

#[test]
fn repeated_entries_are_added_and_zeros_dropped() {
    assert_eq!(entries(&format!("{GENERAL}2 2 5\n2 1 1\n1 1 2\n2 1 0.5\n2 2 3\n2 2 -3\n")), [(0, 0, 2.0), (1, 0, 1.5)]);
    assert_eq!(entries(&format!("{SYMMETRIC}2 2 3\n2 1 1\n2 1 0.5\n1 1 0\n")), [(1, 0, 1.5), (0, 1, 1.5)]);
    let overflow = format!("{GENERAL}2 2 2\n2 1 1e308\n2 1 1e308\n");
    assert_eq!(read_matrix_market(&overflow), Err(MatrixMarketError::Overflow { row: 2, column: 1 }));
}

#[test]
fn empty_matrices_are_empty() {
    for text in [format!("{GENERAL}0 0 0\n"), format!("{SKEW}0 0 0\n"), format!("{ARRAY}0 3\n")] {
        assert_eq!(entries(&text), []);
    }
    let skew = "%%MatrixMarket matrix array real skew-symmetric\n";
    assert_eq!(entries(&format!("{skew}0 0\n")), []);
    assert_eq!(entries(&format!("{skew}1 1\n")), []);
}

#[test]
fn headers_that_are_not_read_are_named() {
    assert!(message("").starts_with("line 1, \"\", is not a Matrix Market header; the first line reads"));
    assert!(message("3 3 1\n1 1 1\n").starts_with("line 1, \"3 3 1\", is not a Matrix Market header"));
    assert!(message("%%MatrixMarket vector coordinate real general\n").contains("is not a Matrix Market header"));
    let unsupported = message("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 2\n");
    assert_eq!(
        unsupported,
        "line 1, \"%%MatrixMarket matrix coordinate complex general\": \"complex\" is not supported; supported are the \
         formats coordinate and array, the fields real and integer, and the symmetries general, symmetric and \
         skew-symmetric"
    );
    assert!(message("%%MatrixMarket matrix coordinate pattern symmetric\n").contains("\"pattern\" is not supported"));
    assert!(message("%%MatrixMarket matrix array real Hermitian\n").contains("\"hermitian\" is not supported"));
}

#[test]
fn sizes_beyond_the_limit_are_refused_before_anything_is_allocated() {
    for size in
        ["2001 1 1", "1 2001 1", "1000000000000000000 1000000000000000000 1", &format!("1 {} 1", "9".repeat(99))]
    {
        assert!(matches!(read_matrix_market(&format!("{GENERAL}{size}\n")), Err(MatrixMarketError::TooLarge(_))));
    }
    for count in ["1000000000000000000", &"9".repeat(99)] {
        let text = format!("{GENERAL}2 2 {count}\n1 1 1\n");
        assert!(matches!(read_matrix_market(&text), Err(MatrixMarketError::TooFew { found: 1, .. })));
    }
    assert_eq!(
        message(&format!("{ARRAY}% comment\n4294967296 4294967296\n")),
        "line 3, \"4294967296 4294967296\": a matrix may have at most 2000 rows and columns; reduce the model first"
    );
}

#[test]
fn sizes_that_make_no_sense_are_refused() {
    assert_eq!(read_matrix_market(GENERAL), Err(MatrixMarketError::NoSize));
    for size in ["2 2", "2 2 1 1", "2 -2 1", "2.0 2 1", "2 x 1", "+2 2 1"] {
        assert!(matches!(read_matrix_market(&format!("{GENERAL}{size}\n")), Err(MatrixMarketError::Size { .. })));
    }
    assert!(message(&format!("{ARRAY}2 2 4\n")).ends_with("expected rows and columns, as whole numbers"));
    assert!(matches!(read_matrix_market(&format!("{SKEW}2 3 0\n")), Err(MatrixMarketError::NotSquare(_))));
}

#[test]
fn entries_that_make_no_sense_are_refused() {
    let with = |header: &str, entry: &str| message(&format!("{header}2 2 1\n{entry}\n"));
    for entry in ["1 x 3", "1 1", "1 1 1 1", "-1 1 3", "1.0 1 3", "1 1 0x1", "1 1 1e", "1 1 1,5"] {
        assert_eq!(with(GENERAL, entry), format!("line 3, {entry:?}: expected a row, a column and a value"));
    }
    for entry in ["0 1 1", "1 0 1", "3 1 1", "1 3 1", "99999999999999999999999 1 1"] {
        assert!(with(GENERAL, entry).contains("the matrix is 2 × 2, with indices from 1"), "{entry}");
    }
    for entry in ["1 1 NaN", "1 1 -inf", "1 1 infinity", "1 1 1e999", "1 1 1D999"] {
        assert!(with(GENERAL, entry).contains("not a finite number"), "{entry}");
    }
    assert!(with(INTEGER, "1 1 1.5").contains("promises integers"));
    assert!(with(SYMMETRIC, "1 2 1").contains("drop the entry, or write \"general\""));
    assert!(with(SKEW, "1 2 1").contains("drop the entry, or write \"general\""));
    assert!(with(SKEW, "2 2 1").contains("the diagonal of a skew-symmetric matrix is zero"));
    assert_eq!(message(&format!("{ARRAY}1 2\n1\n\n2 3\n")), "line 5, \"2 3\": expected one value");
    let long = with(GENERAL, &"ä".repeat(1000));
    assert!(long.len() < 200 && long.contains("ä…"), "{long}");
}

#[test]
fn wrong_numbers_of_entries_are_refused() {
    let few = "the file ends after 1 entries of 2; is it complete?";
    assert_eq!(message(&format!("{GENERAL}2 2 2\n1 1 1\n")), few);
    assert_eq!(message(&format!("{ARRAY}1 2\n1\n")), few);
    let many = "line 4, \"2 2 1\": the file must end after 1 entries";
    assert!(message(&format!("{GENERAL}2 2 1\n1 1 1\n2 2 1\n")).starts_with(many));
    let many = "line 5, \"3\": the file must end after 2 entries";
    assert!(message(&format!("{ARRAY}1 2\n1\n2\n3\n")).starts_with(many));
}

proptest! {
    #[test]
    fn no_text_panics(text in "\\PC{0,80}(\n\\PC{0,20}){0,5}") {
        let _ = read_matrix_market(&text);
    }

    #[test]
    fn no_text_after_a_header_panics(
        header in prop::sample::select(vec![GENERAL, SYMMETRIC, SKEW, ARRAY, INTEGER]),
        lines in prop::collection::vec("([0-4]|[0-9]{19,25}|-1|1e9|nan|%| ){1,4}( [0-4]){0,3}", 0..8),
    ) {
        if let Ok(matrix) = read_matrix_market(&(header.to_owned() + &lines.join("\n"))) {
            prop_assert!(matrix.entries.iter().all(|entry| entry.0 < matrix.rows && entry.1 < matrix.columns));
            prop_assert!(matrix.entries.is_sorted_by_key(|&(row, column, _)| (column, row)));
        }
    }

    #[test]
    fn what_is_written_is_read(
        rows in 1..6usize,
        columns in 1..6usize,
        values in prop::collection::vec(any::<f64>().prop_filter("finite", |value| value.is_finite()), 25),
    ) {
        let places = (0..columns).flat_map(|column| (0..rows).map(move |row| (row, column)));
        let all: Vec<_> = places.zip(&values).map(|((row, column), &value)| (row, column, value)).collect();
        let expected: Vec<_> = all.iter().copied().filter(|entry| entry.2 != 0.0).collect();
        let mut array = format!("{ARRAY}{rows} {columns}\n");
        let mut coordinate = format!("{GENERAL}{rows} {columns} {}\n", all.len());
        for (row, column, value) in all {
            array += &format!("{value:?}\n");
            coordinate += &format!("{} {} {value:e}\n", row + 1, column + 1);
        }
        prop_assert_eq!(entries(&array), expected.clone());
        prop_assert_eq!(entries(&coordinate), expected);
    }
}
