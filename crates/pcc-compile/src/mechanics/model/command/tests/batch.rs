//! Batches: tables in any order, with what is missing and what failed.

use super::*;
use crate::mechanics::model::command::CommandFailure;
use crate::mechanics::model::command::results_table::TableError;

/// Answers as [`ECHO`], from the last row to the first; `$skip` and `$fail` are values of a that are not answered.
const TABLE: &str = r#"echo "$(tail -n +2 points.csv | cut -d, -f2 | tr '\n' ' ')" >> '{study}/log'
{ echo 'note,im_2,error,re_1,run,re_2,im_1'
tail -n +2 points.csv | sort -t, -k1 -rn | while IFS=, read -r run a b c; do
    case " $skip " in *" $a "*) continue ;; esac
    case " $fail " in *" $a "*) echo ",,no convergence,,$run,,"; continue ;; esac
    echo "x,$a,,$a,$run,$c,$b"
done; } > results.csv
"#;

fn batch(folder: &TempDir, retries: u32, script: &str) -> CommandModel {
    CommandModel::new(CommandSettings { mode: Mode::Batch, retries, ..settings(folder.path(), script) })
}

fn points(values: &[f64]) -> Vec<Vec<f64>> {
    values.iter().map(|&a| vec![a, -a / 3.0]).collect()
}

#[test]
fn rows_in_any_order_answer_their_runs() {
    let folder = folder();
    let program = batch(&folder, 0, TABLE);
    let points = points(&[0.1, 5e-324, 1e300, -0.0]);
    for (point, answer) in points.iter().zip(program.run_batch(&points)) {
        assert_same_bits(&answer.unwrap(), &echoed(point));
    }
    assert_same_bits(&program.run(&points[0]).unwrap(), &echoed(&points[0]));
    assert!(program.run_batch::<Vec<f64>>(&[]).is_empty());
    assert_eq!(fs::read_to_string(folder.path().join("study/log")).unwrap().lines().count(), 2);
    assert!(runs(&folder).is_empty());
}

#[test]
fn runs_that_failed_or_are_missing_do_not_harm_the_others() {
    let folder = folder();
    let program = batch(&folder, 0, &format!("skip=2.0 fail='3.0 4.0'; echo hello\n{TABLE}"));
    let answers = program.run_batch(&points(&[1.0, 2.0, 3.0, 4.0, 5.0]));
    let failure = |i: usize| answers[i].as_ref().unwrap_err().failure.clone();
    assert!(answers[0].is_ok() && answers[4].is_ok());
    assert_eq!(failure(1), CommandFailure::NoRow { run: 2 });
    assert_eq!(failure(2), CommandFailure::Reported { text: "no convergence".to_owned() });
    assert_eq!(failure(3), failure(2));
    let outputs: Vec<_> = answers.iter().filter_map(|answer| Some(&answer.as_ref().err()?.output)).collect();
    assert_eq!(outputs, ["hello", "", ""]);
    assert_eq!(runs(&folder).len(), 1);
    assert!(runs(&folder)[0].starts_with("batch-"));
}

#[test]
fn only_what_failed_is_tried_again() {
    let folder = folder();
    let script = format!("[ -e '{{study}}/log' ] && fail=3.0 || skip=2.0 fail='3.0 4.0'\n{TABLE}");
    let answers = batch(&folder, 2, &script).run_batch(&points(&[1.0, 2.0, 3.0, 4.0]));
    let log = fs::read_to_string(folder.path().join("study/log")).unwrap();
    assert_eq!(log.lines().map(str::trim).collect::<Vec<_>>(), ["1.0 2.0 3.0 4.0", "2.0 3.0 4.0", "3.0"]);
    for i in [0, 1, 3] {
        assert_same_bits(answers[i].as_ref().unwrap(), &echoed(&points(&[1.0, 2.0, 3.0, 4.0])[i]));
    }
    assert_eq!(answers[2].as_ref().unwrap_err().attempts, 3);
    assert_eq!(runs(&folder).len(), 3);
}

#[test]
fn a_process_that_fails_answers_nothing() {
    let folder = folder();
    for (script, expected) in [
        (format!("{TABLE}\nexit 4"), CommandFailure::ExitStatus { code: 4 }),
        ("true".to_owned(), CommandFailure::NoResults { file: "results.csv" }),
        (": > results.csv".to_owned(), CommandFailure::Table(TableError::Empty)),
        (
            "printf 'run,re_1,im_1,re_2,im_2\n0,1,2,3,4\n' > results.csv".to_owned(),
            CommandFailure::UnknownRun { line: 2, run: 0, count: 2 },
        ),
        (
            "printf 'run,re_1,im_1,re_2,im_2\n1,1,2,3,nan\n' > results.csv".to_owned(),
            CommandFailure::Table(TableError::NotFinite {
                line: 2,
                column: "im_2".to_owned(),
                found: "nan".to_owned(),
            }),
        ),
    ] {
        let answers = batch(&folder, 0, &script).run_batch(&points(&[1.0, 2.0]));
        assert_eq!(answers.len(), 2);
        assert!(answers.iter().all(|answer| answer.as_ref().unwrap_err().failure == expected), "{answers:?}");
    }
}

#[test]
fn names_with_another_meaning_are_refused() {
    let folder = folder();
    for name in ["run", "error", " re_1", "im_12"] {
        let inputs = vec!["a".to_owned(), name.to_owned()];
        let program = CommandModel::new(CommandSettings { inputs, ..batch(&folder, 3, TABLE).settings().clone() });
        let error = program.run(&[1.0, 2.0]).unwrap_err();
        assert!(matches!(error.failure, CommandFailure::Table(TableError::ReservedName { .. })), "{error}");
    }
}
