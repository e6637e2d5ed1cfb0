//! What users read.

use super::*;
use crate::mechanics::model::command::results_table::TableError;
use crate::mechanics::model::command::{CommandError, CommandFailure};
use std::time::Duration;

#[test]
fn every_failure_says_what_happened_and_what_to_do() {
    let text = || "…".to_owned();
    let failures = [
        CommandFailure::NoCommand,
        CommandFailure::ShellCommand { found: 2 },
        CommandFailure::PointLength { found: 1, expected: 2 },
        CommandFailure::ValueNotFinite { name: "k_p".to_owned(), value: "NaN".to_owned() },
        CommandFailure::Folder { path: "/work/run-1".to_owned(), cause: "No space left on device".to_owned() },
        CommandFailure::Interrupted,
        CommandFailure::NotFound { program: "pyhton".to_owned() },
        CommandFailure::NotStarted { program: "/study/model.py".to_owned(), cause: "Permission denied".to_owned() },
        CommandFailure::Lost { cause: "No child processes".to_owned() },
        CommandFailure::ExitStatus { code: 3 },
        CommandFailure::Signal { signal: 9 },
        CommandFailure::Signal { signal: 11 },
        CommandFailure::Signal { signal: 12 },
        CommandFailure::TimedOut { limit: Duration::from_millis(1500) },
        CommandFailure::NoResults { file: "results.json" },
        CommandFailure::TooLarge { file: "results.json", length: 70_000_000, limit: 64 << 20 },
        CommandFailure::HoldsNan { word: "NaN".to_owned() },
        CommandFailure::NotJson { cause: "expected value at line 1 column 1".to_owned() },
        CommandFailure::NoEigenvalues,
        CommandFailure::NotAPair { number: 2, found: "[null,1]".to_owned() },
        CommandFailure::Count { found: 3, expected: 4 },
        CommandFailure::NotFinite { cause: "number out of range at line 1 column 22".to_owned() },
        CommandFailure::Table(TableError::NotANumber { line: 7, column: "re_2".to_owned(), found: "1,5".to_owned() }),
        CommandFailure::Table(TableError::ReservedName { name: "run".to_owned() }),
        CommandFailure::Table(TableError::CellTooLarge { line: 7, column: "re_2".to_owned(), length: 100_000 }),
        CommandFailure::Table(TableError::RowTooLarge { line: 7 }),
        CommandFailure::Table(TableError::Unreadable { cause: text() }),
        CommandFailure::UnknownRun { line: 2, run: 0, count: 12 },
        CommandFailure::NoRow { run: 4 },
        CommandFailure::Reported { text: "no convergence after 50 iterations".to_owned() },
    ];
    insta::assert_snapshot!(failures.map(|failure| failure.to_string()).join("\n"));
}

#[test]
fn an_error_has_attempts_folder_and_output() {
    let error = CommandError {
        failure: CommandFailure::ExitStatus { code: 1 },
        attempts: 3,
        output: "Traceback (most recent call last):\n  File \"model.py\", line 3\nValueError: no mesh".to_owned(),
        folder: Some("/study/.pcc-work/run-0123456789abcdef-3".into()),
    };
    insta::assert_snapshot!(error);
    assert_eq!(
        CommandError { attempts: 1, output: String::new(), folder: None, ..error }.to_string(),
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
