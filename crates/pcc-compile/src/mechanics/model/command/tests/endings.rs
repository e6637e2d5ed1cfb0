//! How programs start and end, and what they say.

use super::*;
use crate::mechanics::model::command::{CommandError, CommandFailure};
use std::thread;
use std::time::{Duration, Instant};

const POINT: [f64; 2] = [1.0, 2.0];

fn with_limit(folder: &TempDir, milliseconds: u64, script: &str) -> CommandError {
    let timeout = Some(Duration::from_millis(milliseconds));
    CommandModel::new(CommandSettings { timeout, ..settings(folder.path(), script) }).run(&POINT).unwrap_err()
}

#[test]
fn a_program_that_hangs_is_ended() {
    let folder = folder();
    let start = Instant::now();
    let error = with_limit(&folder, 500, "echo waiting; sleep 60");
    assert_eq!(error.failure, CommandFailure::TimedOut { limit: Duration::from_millis(500) });
    assert_eq!(error.output, "waiting");
    assert!(start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
}

#[test]
fn what_a_program_has_started_is_ended_with_it() {
    let folder = folder();
    with_limit(
        &folder,
        700,
        "(sleep 2; touch '{study}/alive') & trap '' TERM INT HUP; touch '{study}/started'; sleep 60",
    );
    thread::sleep(Duration::from_millis(2000));
    assert!(folder.path().join("study/started").exists());
    assert!(!folder.path().join("study/alive").exists());
}

#[test]
fn a_grandchild_with_open_streams_is_not_waited_for() {
    let folder = folder();
    let start = Instant::now();
    program(&folder, &format!("sleep 3 &\n{ECHO}")).run(&POINT).unwrap();
    assert!(start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
}

#[test]
fn a_signal_is_named() {
    let folder = folder();
    let error = program(&folder, "kill -9 $$").run(&POINT).unwrap_err();
    assert_eq!(error.failure, CommandFailure::Signal { signal: 9 });
}

#[test]
fn interruption_ends_a_run_and_all_later_ones() {
    let folder = folder();
    let script = "echo >> '{study}/tries'; sleep 60";
    let program = CommandModel::new(CommandSettings { retries: 5, ..settings(folder.path(), script) });
    thread::scope(|scope| {
        let run = scope.spawn(|| (program.run(&POINT), Instant::now()));
        while !folder.path().join("study/tries").exists() {
            thread::sleep(Duration::from_millis(5));
        }
        thread::sleep(Duration::from_millis(300));
        let interruption = Instant::now();
        program.interrupt();
        let (result, end) = run.join().unwrap();
        assert_eq!(result.unwrap_err().failure, CommandFailure::Interrupted);
        assert!(end - interruption < Duration::from_millis(500), "{:?}", end - interruption);
    });
    let answers = program.run_batch(&[POINT.to_vec(), POINT.to_vec()]);
    assert!(answers.iter().all(|answer| answer.as_ref().unwrap_err().failure == CommandFailure::Interrupted));
    assert_eq!(fs::read_to_string(folder.path().join("study/tries")).unwrap(), "\n");
}

#[test]
fn the_end_of_megabytes_is_shown_and_made_harmless() {
    let folder = folder();
    let script = r"yes 'a line of text' | head -c 5000000; yes é | head -c 3000000 >&2
        printf 'last \033[31mred\007 \377\r\n' >&2; exit 3";
    let error = program(&folder, script).run(&POINT).unwrap_err();
    assert_eq!(error.failure, CommandFailure::ExitStatus { code: 3 });
    assert_eq!(error.output, "é\n".repeat(19) + "last \\u{1b}[31mred\\u{7} \u{fffd}");
    let long = program(&folder, "head -c 1000000 /dev/zero | tr '\\0' x; exit 3").run(&POINT).unwrap_err();
    assert_eq!(long.output, "…".to_owned() + &"x".repeat(2000));
    assert_eq!(program(&folder, "exit 3").run(&POINT).unwrap_err().output, "");
}

#[test]
fn programs_that_cannot_start_say_why() {
    let folder = folder();
    let failure = |command: &[&str], shell| {
        let command = command.iter().map(|&word| word.to_owned()).collect();
        let settings = CommandSettings { command, shell, retries: 3, ..settings(folder.path(), "") };
        let error = CommandModel::new(settings).run(&POINT).unwrap_err();
        let expected = if matches!(error.failure, CommandFailure::NotStarted { .. }) { 4 } else { 1 };
        assert_eq!(error.attempts, expected);
        error.failure
    };
    let missing = failure(&["{study}/missing"], false);
    assert_eq!(missing, CommandFailure::NotFound { program: format!("{}/study/missing", folder.path().display()) });
    assert!(matches!(failure(&["pcc-no-such-program"], false), CommandFailure::NotFound { .. }));
    assert_eq!(failure(&[], false), CommandFailure::NoCommand);
    assert_eq!(failure(&["echo", "a"], true), CommandFailure::ShellCommand { found: 2 });
    fs::write(folder.path().join("study/model"), "#!/no/such/interpreter\n").unwrap();
    let refused = |found| matches!(found, CommandFailure::NotStarted { cause, .. } if cause.contains("denied"));
    assert!(refused(failure(&["{study}/model"], false)));
    assert!(matches!(failure(&["echo", "a\0b"], false), CommandFailure::NotStarted { .. }));
}

#[test]
fn a_missing_interpreter_is_not_a_missing_program() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let path = folder.path().join("study/model");
    fs::write(&path, "#!/no/such/interpreter\n").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    let command = vec!["{study}/model".to_owned()];
    let error = CommandModel::new(CommandSettings { command, ..settings(folder.path(), "") }).run(&POINT).unwrap_err();
    // While other tests start processes, the file may count as open for writing, which is said as well.
    assert!(matches!(error.failure, CommandFailure::NotStarted { .. }), "{error}");
}

#[test]
fn short_runs_lose_little() {
    let folder = folder();
    let script = r#"printf '{"eigenvalues": [[1, 2], [3, 4]]}' > results.json"#;
    let program = program(&folder, script);
    let start = Instant::now();
    for k in 0..20 {
        program.run(&[1.0, f64::from(k)]).unwrap();
    }
    // A few milliseconds each; the bound allows for a machine that is busy.
    assert!(start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
}
