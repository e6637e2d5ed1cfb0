//! What users read.

use super::*;
use crate::mechanics::model::program::results_table::TableError;
use crate::mechanics::model::program::{ProgramError, ProgramFailure};
use std::time::Duration;

#[test]
fn every_failure_says_what_happened_and_what_to_do() {
    let text = || "…".to_owned();
    let failures = [
        ProgramFailure::NoCommand,
        ProgramFailure::ShellCommand { found: 2 },
        ProgramFailure::PointLength { found: 1, expected: 2 },
        ProgramFailure::ValueNotFinite { name: "k_p".to_owned(), value: "NaN".to_owned() },
        ProgramFailure::Folder { path: "/work/run-1".to_owned(), cause: "No space left on device".to_owned() },
        ProgramFailure::Interrupted,
        ProgramFailure::NotFound { program: "pyhton".to_owned() },
        ProgramFailure::NotStarted { program: "/study/model.py".to_owned(), cause: "Permission denied".to_owned() },
        ProgramFailure::Lost { cause: "No child processes".to_owned() },
        ProgramFailure::ExitStatus { code: 3 },
        ProgramFailure::Signal { signal: 9 },
        ProgramFailure::Signal { signal: 11 },
        ProgramFailure::Signal { signal: 12 },
        ProgramFailure::TimedOut { limit: Duration::from_millis(1500) },
        ProgramFailure::NoResults { file: "results.json" },
        ProgramFailure::TooLarge { file: "results.json", length: 70_000_000, limit: 64 << 20 },
        ProgramFailure::HoldsNan { word: "NaN".to_owned() },
        ProgramFailure::NotJson { cause: "expected value at line 1 column 1".to_owned() },
        ProgramFailure::NoEigenvalues,
        ProgramFailure::NotAPair { number: 2, found: "[null,1]".to_owned() },
        ProgramFailure::Count { found: 3, expected: 4 },
        ProgramFailure::NotFinite { cause: "number out of range at line 1 column 22".to_owned() },
        ProgramFailure::Table(TableError::NotANumber { line: 7, column: "re_2".to_owned(), found: "1,5".to_owned() }),
        ProgramFailure::Table(TableError::ReservedName { name: "run".to_owned() }),
        ProgramFailure::Table(TableError::CellTooLarge { line: 7, column: "re_2".to_owned(), length: 100_000 }),
        ProgramFailure::Table(TableError::RowTooLarge { line: 7 }),
        ProgramFailure::Table(TableError::Unreadable { cause: text() }),
        ProgramFailure::UnknownRun { line: 2, run: 0, count: 12 },
        ProgramFailure::NoRow { run: 4 },
        ProgramFailure::Reported { text: "no convergence after 50 iterations".to_owned() },
    ];
    insta::assert_snapshot!(failures.map(|failure| failure.to_string()).join("\n"));
}

#[test]
fn an_error_has_attempts_folder_and_output() {
    let error = ProgramError {
        failure: ProgramFailure::ExitStatus { code: 1 },
        attempts: 3,
        output: "Traceback (most recent call last):\n  File \"model.py\", line 3\nValueError: no mesh".to_owned(),
        folder: Some("/study/.pcc-work/run-0123456789abcdef-3".into()),
    };
    insta::assert_snapshot!(error);
    assert_eq!(
        ProgramError { attempts: 1, output: String::new(), folder: None, ..error }.to_string(),
        "the program ended with status 1; 0 would mean success"
    );
}

#[test]
fn real_errors_read_well() {
    let folder = folder();
    let errors = ["echo reading mesh; echo 'mesh.txt: no such file' >&2; exit 2", "echo stopped; true", "kill -11 $$"]
        .map(|script| {
            program(&folder, script)
                .run(&[1.0, 2.0])
                .unwrap_err()
                .to_string()
                .replace(folder.path().to_str().unwrap(), "/tmp")
        });
    insta::assert_snapshot!(errors.join("\n"));
}
