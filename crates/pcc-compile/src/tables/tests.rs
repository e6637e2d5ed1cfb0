use super::*;
use nalgebra::Complex;
use pcc_evaluate::probability::inputs::{Input, InputSpace, Marginal, Uniform};

fn inputs() -> InputSpace {
    let law = || Marginal::Uniform(Uniform::new(0.0, 1.0).unwrap());
    InputSpace::new(vec![Input::new("a", law()), Input::new("b", law())]).unwrap()
}

/// Reads tables of these contents, as `change` wants it.
fn read_with(contents: &[&[u8]], change: impl FnOnce(&mut RunsReader<'_>)) -> Result<GivenRuns, DataError> {
    let folder = tempfile::tempdir().unwrap();
    let file = |(number, content): (usize, &&[u8])| {
        let shown = format!("{}.csv", ["r", "s", "t"][number]);
        let path = folder.path().join(&shown);
        std::fs::write(&path, content).unwrap();
        DataFile { path, shown }
    };
    let files: Vec<DataFile> = contents.iter().enumerate().map(file).collect();
    let inputs = inputs();
    let dialect = Dialect::default();
    let mut reader = RunsReader { inputs: &inputs, dialect, eigenvalues: None, skips_failures: false, noise: 0.0 };
    change(&mut reader);
    reader.read(&files)
}

fn read(content: &str) -> Result<GivenRuns, DataError> {
    read_with(&[content.as_bytes()], |_| {})
}

fn message(content: impl AsRef<[u8]>) -> String {
    read_with(&[content.as_ref()], |_| {}).unwrap_err().to_string()
}

fn eigenvalues(runs: &GivenRuns, run: usize) -> Vec<(f64, f64)> {
    runs.runs[run].answer.as_ref().unwrap().eigenvalues.iter().map(|lambda| (lambda.re, lambda.im)).collect()
}

#[test]
fn columns_may_stand_in_any_order_among_others() {
    let runs = read("im_1,operator,b, re_1 ,run,a,max_re,\n5,me,0.2,-1,7,0.1,-1,\n,,,,,,,\n6,you,0.4,-2,8,0.3,-2,x\n")
        .unwrap();
    assert_eq!(runs.runs.len(), 2);
    assert_eq!((runs.runs[1].point.as_slice(), eigenvalues(&runs, 1)), (&[0.3, 0.4][..], vec![(-2.0, 6.0)]));
    assert_eq!((runs.ignored, runs.eigenvalues, runs.has_derivatives), (vec!["operator".to_owned()], 1, false));
}

#[test]
fn result_tables_of_our_own_are_read_as_they_are() {
    // A mode that oscillates in the first row and has two real eigenvalues in the second, and a real eigenvalue.
    let table = "a,b,re_3,im_3,re_3_b,real_1,max_re,stable,verdict\n\
                 0.1,0.1,-1.0,5.0,-1.0,-9.0,-1.0,1,stable\n0.2,0.1,-0.5,0.0,-2.5,-9.5,-0.5,1,stable\n";
    let runs = read(table).unwrap();
    assert_eq!((runs.eigenvalues, &runs.ignored), (3, &vec![]));
    assert_eq!(eigenvalues(&runs, 0), [(-1.0, 5.0), (-1.0, -5.0), (-9.0, 0.0)]);
    assert_eq!(eigenvalues(&runs, 1), [(-0.5, 0.0), (-2.5, 0.0), (-9.5, 0.0)]);
}

#[test]
fn either_half_of_a_pair_will_do() {
    let runs = read("a,b,re_1,im_1,d_re_1_d_a,d_im_1_d_a,d_re_1_d_b,d_im_1_d_b\n0.1,0.1,-1,-5,1,2,3,4\n").unwrap();
    assert_eq!(eigenvalues(&runs, 0), [(-1.0, 5.0)]);
    let slopes = &runs.runs[0].answer.as_ref().unwrap().slopes;
    assert_eq!(slopes, &[(0, vec![Complex::new(1.0, -2.0), Complex::new(3.0, -4.0)])]);
    let both = read("a,b,re_1,im_1,re_2,im_2\n0.1,0.1,-1,-5,-1,5\n").unwrap();
    assert_eq!(eigenvalues(&both, 0), [(-1.0, -5.0), (-1.0, 5.0)]);
}

#[test]
fn derivatives_may_be_those_of_some_rows_and_some_eigenvalues() {
    let head = "a,b,re_1,im_1,real_1,d_real_1_d_a,d_real_1_d_b\n";
    let runs = read(&format!("{head}0.1,0.1,-1,5,-3,0.5,0.25\n0.2,0.1,-1,5,-3,,\n")).unwrap();
    let slopes = |run: usize| runs.runs[run].answer.as_ref().unwrap().slopes.clone();
    assert_eq!(slopes(0), [(1, vec![Complex::new(0.5, 0.0), Complex::new(0.25, 0.0)])]);
    assert!(slopes(1).is_empty() && runs.has_derivatives);
    assert_eq!(
        message(format!("{head}0.1,0.1,-1,5,-3,0.5,\n")).lines().nth(1).unwrap(),
        "  r.csv, line 2: d_real_1_d_b is empty; fill it in, or remove the line"
    );
    let partial = message("a,b,re_1,im_1,d_re_1_d_a,d_im_1_d_a,d_re_1_d_b\n");
    assert_eq!(
        partial,
        "r.csv has a column d_re_1_d_a, but none d_im_1_d_b; give the derivatives of an eigenvalue by all inputs, or none of them"
    );
}

#[test]
fn spreadsheets_of_other_countries_are_read() {
    let decimal = |decimal: Decimal| move |reader: &mut RunsReader<'_>| reader.dialect.decimal = decimal;
    let german = "\u{feff}a;b;re_1;im_1\r\n0,25;0,5;-1,5;2e1\r\n".as_bytes();
    let runs = read_with(&[german], decimal(Decimal::Comma)).unwrap();
    assert_eq!((runs.runs[0].point.as_slice(), eigenvalues(&runs, 0)), (&[0.25, 0.5][..], vec![(-1.5, 20.0)]));
    assert_eq!(
        message(german).lines().nth(1).unwrap(),
        "  r.csv, line 2: a is \"0,25\", with a decimal comma; say --decimal comma, or in the study decimal = \"comma\""
    );
    let mixed = read_with(&[b"a;b;re_1;im_1\n0.25;0,5;-1;2\n"], decimal(Decimal::Comma)).unwrap_err().to_string();
    assert!(mixed.contains("a is \"0.25\", with a point, where decimal commas were announced"), "{mixed}");
    let bars = |reader: &mut RunsReader<'_>| reader.dialect.delimiter = Some('|');
    assert_eq!(read_with(&[b"a|b|re_1|im_1\n0.1|0.2|-1|2\n"], bars).unwrap().runs.len(), 1);
    let wide: Vec<u8> = "a,b\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert!(message(wide).starts_with("r.csv is not UTF-8 text; convert it, as with iconv -f UTF-16"));
    assert!(message(b"gr\xf6\xdfe,a,b\n").contains("iconv -f LATIN1"));
}

#[test]
fn headers_that_lack_something_say_what() {
    assert!(message("").starts_with("r.csv is empty"));
    assert!(
        message("a,re_1,im_1\n")
            .starts_with("r.csv has no column b; the header is \"a, re_1, im_1\"; name every input")
    );
    assert!(message("a,b,freq,damping\n").starts_with("r.csv has no eigenvalues; the header is"));
    assert!(
        message("a,b,re_1,im_1,re_2\n").starts_with("r.csv has a column re_2, but none im_2; add it, with 0 where")
    );
    assert!(message("a,b,re_1,im_1,im_2\n").starts_with("r.csv has a column im_2, but none re_2"));
    assert!(message("a,b,re_1,im_1,a\n").starts_with("r.csv has \"a\" as the name of several columns"));
    assert_eq!(message("a,b,re_1,im_1\n\n,,,\n"), "r.csv has no rows below the header; give the runs, a row each");
    let wants = |reader: &mut RunsReader<'_>| reader.eigenvalues = Some(2);
    let other = read_with(&[b"a,b,re_1,im_1\n0,0,1,1\n"], wants).unwrap_err().to_string();
    assert_eq!(other, "r.csv has columns of 1 eigenvalues; 2 in model.eigenvalues of the study");
}

#[test]
fn all_rows_that_cannot_be_taken_are_named_by_their_lines() {
    let table =
        "a,b,re_1,im_1\n0.1,0.2,-1,2\n\n0.1,,-1,2\n0.3,0.2,x,2\n0.3,0.2,nan,2\n1.5,0.2,-1,2\n0.3,0.2,-1\n0.9,0.2,0,0\n";
    let expected = "6 rows cannot be taken, so none was:\n  \
                    r.csv, line 4: b is empty; fill it in, or remove the line\n  \
                    r.csv, line 5: re_1 is \"x\", no finite number; correct it, or remove the line\n  \
                    r.csv, line 6: re_1 is \"nan\", no finite number; correct it, or remove the line\n  \
                    r.csv, line 7: a = 1.5 lies outside [0.0, 1.0]; remove the line, or widen the law\n  \
                    r.csv, line 8: there are 3 cells, but 4 columns; write one cell for each column; of numbers with \
                    decimal commas, separate columns by semicolons\n  \
                    r.csv, line 9: all eigenvalues are zero; correct them, or remove the line";
    assert_eq!(message(table), expected);
    let many: String = (0..40).map(|_| "2,0.2,-1,2\r").collect();
    let many = message(format!("a,b,re_1,im_1\r{many}"));
    assert!(
        many.starts_with("40 rows cannot") && many.contains("line 11:") && many.ends_with("and 30 other rows"),
        "{many}"
    );
}

#[test]
fn points_count_once_and_must_not_contradict_themselves() {
    let table = "a,b,re_1,im_1\n0.1,0.2,-1,2\n0.3,0.2,-1,2\n0.1,0.2,-1,2\n";
    let runs = read(table).unwrap();
    assert_eq!(
        (runs.runs.len(), runs.repetitions, runs.repeated.as_slice()),
        (2, 1, &["r.csv, line 4".to_owned()][..])
    );
    let other = message(table.to_owned() + "0.3,0.2,-1.25,2\n0.1,0.2,-1,-3\n");
    let lines: Vec<&str> = other.lines().collect();
    assert!(
        lines[1].starts_with("  r.csv, line 5: the same point as line 3, but eigenvalues differ by 2.5e-1 1/s"),
        "{other}"
    );
    assert!(lines[2].starts_with("  r.csv, line 6: the same point as line 2"), "{other}");
    // Noise that the study announces is no contradiction.
    let noisy = |reader: &mut RunsReader<'_>| reader.noise = 0.01;
    assert!(read_with(&[b"a,b,re_1,im_1\n0.3,0.2,-1,20\n0.3,0.2,-1.1,20\n"], noisy).is_ok());
}

#[test]
fn tables_are_put_together() {
    let (one, other) = ("a,b,re_1,im_1\n0.1,0.2,-1,2\n", "im_1;re_1;b;a\n4;-1;0.5;0.6\n2;-1;0.2;0.1\n");
    let runs = read_with(&[one.as_bytes(), other.as_bytes()], |_| {}).unwrap();
    assert_eq!((runs.runs.len(), runs.repetitions, runs.files.len()), (2, 1, 2));
    let wrong = other.replace("2;-1;0.2", "2;-2;0.2");
    let error = read_with(&[one.as_bytes(), wrong.as_bytes()], |_| {}).unwrap_err().to_string();
    assert!(error.contains("s.csv, line 3: the same point as r.csv, line 2, but"), "{error}");
    let more = read_with(&[one.as_bytes(), b"a,b,re_1,im_1,real_1\n0,0,1,1,1\n"], |_| {}).unwrap_err();
    assert_eq!(more.to_string(), "s.csv has columns of 2 eigenvalues; 1 in r.csv");
}

#[test]
fn eigenvalues_must_be_as_many_in_every_row() {
    // A pair by its upper half, then one of two real eigenvalues.
    let table = "a,b,re_1,im_1\n0.1,0.2,-1,2\n0.3,0.2,-1,0\n";
    let error = message(table);
    assert!(
        error.contains("r.csv, line 3: there are 1 eigenvalues, conjugates counted, but 2 in the first row"),
        "{error}"
    );
}

#[test]
fn failed_runs_are_left_out_if_the_study_says_so() {
    let table = "a,b,re_1,im_1,error\n0.1,0.2,-1,2,\n0.3,0.2,,,no convergence\n";
    assert!(message(table).contains("line 3: the run failed (no convergence); remove the line, or say on_failure"));
    let skips = |reader: &mut RunsReader<'_>| reader.skips_failures = true;
    let runs = read_with(&[table.as_bytes()], skips).unwrap();
    assert_eq!(runs.runs[1].answer, Err("no convergence".to_owned()));
    // An answer to the same point says more.
    let answered = table.to_owned() + "0.3,0.2,-1,3,\n";
    assert!(read_with(&[answered.as_bytes()], skips).unwrap().runs[1].answer.is_ok());
}

#[test]
fn hostile_tables_are_refused_without_a_panic() {
    for table in ["\"", "a,b,re_1,im_1\n\"0.1,0.2\n,-1,2", "\u{feff}", "\n\n\n", "a,b,re_1,im_1\n1e400,0,1,1\n", "\0"] {
        assert!(read(table).is_err(), "{table:?}");
    }
    let huge = format!("a,b,re_1,im_1\n{},0,1,1\n", "9".repeat(100_000));
    assert!(message(huge).len() < 400);
    let control = message("a,b,re_1,im_1\n\u{1b}[31m,0,1,1\n");
    assert!(!control.contains('\u{1b}'), "{control}");
    let failed = message("a,b,re_1,im_1,error,\u{1b}[2J\n0,0,1,1,\u{7}\u{1b}[31m,\n");
    assert!(failed.contains("the run failed (") && !failed.contains('\u{1b}'), "{failed:?}");
    let label = read("a,b,re_99999999999999999999,im_1\n");
    assert!(label.is_err());
}
