//! Tables, right and wrong.

use crate::mechanics::model::command::results_table::{
    LARGEST_CELL, LARGEST_ROW, ResultRow, TableError, read_results, write_points,
};
use nalgebra::Complex;
use proptest::prelude::*;
use std::io::{self, Read};

fn inputs() -> Vec<String> {
    vec!["k".to_owned(), "mu".to_owned()]
}

fn read(table: &str) -> Result<Vec<ResultRow>, TableError> {
    read_results(table.as_bytes(), &inputs(), 1)
}

#[test]
fn marks_line_ends_spaces_and_quotes_are_accepted() {
    let expected =
        ResultRow { line: 2, run: Some(3), inputs: Some(vec![1.0, 2.0]), answer: Ok(vec![Complex::new(-0.5, 40.0)]) };
    for table in [
        "run,k,mu,re_1,im_1\n3,1,2,-0.5,40",
        "\u{feff}run,k,mu,re_1,im_1\r\n3,1,2,-0.5,40\r\n\r\n",
        "\u{feff}\"run\",\"k\",\"mu\",\"re_1\",\"im_1\"\r\n\"3\",\"1\",\"2\",\"-0.5\",\"40\"\r\n",
        " mu , run\t,k,im_1,other,re_1,other\n 2 , 3 ,\t1, 4e1,\"a, b\",-.5,\n   \n",
        "run,mu,error,k,re_1,im_1\n3.0,2.0,,1e0,-5.0e-01,+40\n,,,,,\n",
    ] {
        assert_eq!(read(table), Ok(vec![expected.clone()]), "{table:?}");
    }
}

#[test]
fn rows_are_answered_failed_or_open() {
    let rows = read("run,re_1,im_1,error\n1,,,\n2,,, did not converge \n3,nan,x,\"a\nb\"\n4,1,2,\n").unwrap();
    let seen: Vec<_> = rows.into_iter().map(|row| (row.line, row.run, row.inputs, row.answer)).collect();
    assert_eq!(
        seen,
        [
            (3, Some(2), None, Err("did not converge".to_owned())),
            (4, Some(3), None, Err("a\\nb".to_owned())),
            (6, Some(4), None, Ok(vec![Complex::new(1.0, 2.0)])),
        ]
    );
}

#[test]
fn lines_are_those_of_an_editor() {
    for end in ["\n", "\r\n"] {
        let table = "run,k,mu,re_1,im_1,error\n\n1,1,1,1,1,\n\n\n2,,,,,\"a\nb\nc\"\n3,1,1,1,1,".replace('\n', end);
        let lines =
            |table: &str| read_results(table.as_bytes(), &[], 1).unwrap().iter().map(|r| r.line).collect::<Vec<_>>();
        assert_eq!(lines(&table), [3, 6, 9], "{table:?}");
        assert_eq!(lines(&(table + end)), [3, 6, 9]);
    }
}

#[test]
fn everything_wrong_has_its_error() {
    let mut report = String::new();
    for table in [
        "",
        "\u{feff}\n\n",
        "run;re_1;im_1\n1;2;3",
        "run,re_1\n",
        "re_1,im_1,k\n",
        "run,re_1,im_1,re_1\n",
        "k,mu,mu,re_1,im_1\n",
        "run,re_1,im_1,im_2\n",
        "run,re_1,im_1\n1,2\n",
        "run,re_1,im_1\n1,0,25,3\n",
        "run,re_1,im_1\n1,2,\n",
        "run,re_1,im_1\n\n1,2,1.0D+03\n",
        "run,re_1,im_1\n1,2,\u{1b}[31m\n",
        "run,re_1,im_1\n1,NaN,2\n",
        "run,re_1,im_1\n1,-inf,2\n",
        "run,re_1,im_1\n1,1,1e999\n",
        "run,re_1,im_1\n,1,1\n",
        "run,re_1,im_1\n-1,1,1\n",
        "run,re_1,im_1\n1.5,1,1\n",
        "k,mu,re_1,im_1\n1,oops,1,1\n",
        "k,mu,re_1,im_1,error\n1,,,,bad\n",
    ] {
        report += &format!("{table:?}\n    {}\n", read(table).unwrap_err());
    }
    insta::assert_snapshot!(report);
    let named = |name: &str| read_results("".as_bytes(), &[name.to_owned()], 1);
    assert!(
        ["run", "error", "re_1", "im_20 "]
            .iter()
            .all(|name| matches!(named(name), Err(TableError::ReservedName { .. })))
    );
    assert!(["re_", "re_a", "Run", "im"].iter().all(|name| named(name) == Err(TableError::Empty)));
}

#[test]
fn what_is_too_large_is_refused() {
    let cell = format!("run,re_1,im_1\n1,{},2\n", "1".repeat(LARGEST_CELL + 1));
    let expected = TableError::CellTooLarge { line: 2, column: "re_1".to_owned(), length: LARGEST_CELL + 1 };
    assert_eq!(read(&cell), Err(expected));
    let endless = "run,re_1,im_1\n1,1,1\n\"2,1,1\n".as_bytes().chain(io::repeat(b'\n'));
    assert_eq!(read_results(endless, &[], 1), Err(TableError::RowTooLarge { line: 3 }));
    let long = io::repeat(b'x').take(LARGEST_ROW + 100_000);
    assert_eq!(read_results(long, &[], 1), Err(TableError::RowTooLarge { line: 1 }));
    // Only a row is limited, not the table.
    let open = ",,1\n".repeat(3 << 20);
    assert_eq!(read_results("re_1,im_1,run\n".as_bytes().chain(open.as_bytes()), &[], 1), Ok(vec![]));
    let missing = read_results("run\n".as_bytes(), &[], usize::MAX).unwrap_err();
    assert!(matches!(missing, TableError::MissingColumns { .. }));
}

#[test]
fn a_reader_that_fails_is_quoted() {
    struct Broken;
    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::other("disk on fire"))
        }
    }
    let unreadable = Err(TableError::Unreadable { cause: "disk on fire".to_owned() });
    assert_eq!(read_results(Broken, &[], 1), unreadable);
    assert_eq!(read_results("run,re_1,im_1\n1,1,1\n".as_bytes().chain(Broken), &[], 1), unreadable);
}

#[test]
fn points_that_make_no_table_are_refused() {
    let write =
        |points: &[Vec<f64>]| write_points(io::sink(), 1.., &inputs(), &[], points).map_err(|error| error.kind());
    assert_eq!(write(&[vec![1.0]]), Err(io::ErrorKind::InvalidInput));
    assert_eq!(write(&[vec![1.0, f64::INFINITY]]), Err(io::ErrorKind::InvalidInput));
    assert_eq!(write(&[]), Ok(()));
}

/// Any finite number, with all its bits.
fn finite() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |value| value.is_finite())
}

/// Hands out a few bytes at a time.
struct Slowly<'a>(&'a [u8]);

impl Read for Slowly<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = buffer.len().min(2);
        self.0.read(&mut buffer[..length])
    }
}

proptest! {
    #[test]
    fn points_and_results_keep_their_bits(
        points in prop::collection::vec(prop::collection::vec(finite(), 6), 1..8),
        first in 0..u64::MAX / 2,
        is_dos: bool,
    ) {
        // The last four inputs are the eigenvalues: what is written can be read.
        let mut written = Vec::new();
        let names = ["k", "mu", "re_2", "im_1", "im_2", "re_1"].map(str::to_owned);
        write_points(&mut written, first.., &names, &[("c".to_owned(), 0.1)], &points).unwrap();
        let mut table = String::from_utf8(written).unwrap();
        if is_dos {
            table = "\u{feff}".to_owned() + &table.replace('\n', "\r\n").replace(',', " ,\t");
        }
        let rows = read_results(Slowly(table.as_bytes()), &inputs(), 2).unwrap();
        prop_assert_eq!(rows.len(), points.len());
        for (i, (row, point)) in rows.iter().zip(&points).enumerate() {
            prop_assert_eq!((row.line, row.run), (i as u64 + 2, Some(first + i as u64)));
            let answer = row.answer.as_ref().unwrap();
            let parts = [answer[1].re, answer[0].im, answer[1].im, answer[0].re];
            let found = [row.inputs.as_ref().unwrap().as_slice(), &parts].concat();
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&found), bits(point));
        }
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..300), eigenvalues in 0_usize..3) {
        let _ = read_results(Slowly(&bytes), &inputs(), eigenvalues);
    }

    #[test]
    fn anything_like_a_table_is_read_or_refused(
        cells in prop::collection::vec(
            "(run|k|mu|re_1|im_1|error|nan|-?[0-9.e]{0,4}|\"|\"a\n\"|\u{feff}|[ ,\r\n]){0,3}",
            0..40,
        ),
    ) {
        let table = cells.join(",");
        let _ = read(&table);
        let _ = read(&format!("run,re_1,im_1\n{table}"));
        let _ = read(&format!("k,mu,error,re_1,im_1\n{}", table.replace(",,", "\n")));
    }
}
