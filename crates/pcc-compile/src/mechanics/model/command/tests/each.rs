//! Answers, right and wrong, and the folders that are left.

use super::*;
use crate::mechanics::model::command::CommandFailure;

#[test]
fn values_go_out_and_come_back_with_the_same_bits() {
    let folder = folder();
    let program = program(&folder, ECHO);
    for point in [[0.1, -0.0], [f64::MIN_POSITIVE, 5e-324], [f64::MAX, 1.0 / 3.0], [1e16, -1e-7], [1.0, 123456789.0]] {
        assert_same_bits(&program.run(&point).unwrap(), &echoed(&point));
    }
    assert!(runs(&folder).is_empty());
    program.clean_up();
    assert!(!folder.path().join("work").exists());
}

#[test]
fn parameters_are_in_order_and_the_environment_names_the_folders() {
    let folder = folder();
    let script = r#"cp params.json "$PCC_STUDY_DIR/seen.json"; [ "$(pwd -P)" = "$(cd "$PCC_WORK_DIR"; pwd -P)" ] &&
        [ "{study} {work}" = "$PCC_STUDY_DIR $PCC_WORK_DIR" ] && [ ! -t 0 ] && "#;
    program(&folder, &(script.to_owned() + ECHO)).run(&[2.0, 1e-9]).unwrap();
    let seen = fs::read_to_string(folder.path().join("study/seen.json")).unwrap();
    assert_eq!(seen, "{\n  \"a\": 2.0,\n  \"b\": 1e-9,\n  \"c\": 0.25\n}\n");
}

#[test]
fn wrong_answers_are_refused() {
    let folder = folder();
    let failure = |results: &str| {
        let script = format!("cat > results.json <<'END'\n{results}\nEND\n");
        program(&folder, &script).run(&[1.0, 2.0]).unwrap_err().failure
    };
    let nan = |word: &str| CommandFailure::HoldsNan { word: word.to_owned() };
    assert_eq!(failure(r#"{"eigenvalues": [[NaN, 1], [0, 1]]}"#), nan("NaN"));
    assert_eq!(failure(r#"{"eigenvalues": [[0, 1], [-Infinity, 1]]}"#), nan("Infinity"));
    assert_eq!(failure(r#"{"eigenvalues": [[0, 1]]}"#), CommandFailure::Count { found: 1, expected: 2 });
    assert!(matches!(failure("all is well"), CommandFailure::NotJson { .. }));
    assert!(matches!(failure(r#"{"eigenvalues": [[0, 1"#), CommandFailure::NotJson { .. }));
    assert!(matches!(failure(r#"{"eigenvalues": [1, 2]}"#), CommandFailure::NotAPair { number: 1, .. }));
    assert_eq!(failure(r#"{"values": []}"#), CommandFailure::NoEigenvalues);
    assert_eq!(failure(r#"{"error": "no mesh"}"#), CommandFailure::Reported { text: "no mesh".to_owned() });
}

#[test]
fn what_is_no_file_or_too_large_is_not_read() {
    let folder = folder();
    let failure = |script: &str| program(&folder, script).run(&[1.0, 2.0]).unwrap_err().failure;
    assert_eq!(failure("true"), CommandFailure::NoResults { file: "results.json" });
    assert!(matches!(failure("mkfifo results.json"), CommandFailure::Folder { .. }));
    assert!(matches!(failure("mkdir results.json"), CommandFailure::Folder { .. }));
    assert!(matches!(failure("ln -s /dev/zero results.json"), CommandFailure::Folder { .. }));
    let large = failure("dd if=/dev/zero of=results.json bs=1 count=1 seek=67108864 2>/dev/null");
    assert_eq!(large, CommandFailure::TooLarge { file: "results.json", length: (64 << 20) + 1, limit: 64 << 20 });
}

#[test]
fn points_that_make_no_sense_start_nothing() {
    let folder = folder();
    let program = program(&folder, ECHO);
    assert_eq!(program.run(&[1.0]).unwrap_err().failure, CommandFailure::PointLength { found: 1, expected: 2 });
    assert!(matches!(program.run(&[1.0, f64::NAN]).unwrap_err().failure, CommandFailure::ValueNotFinite { .. }));
    assert!(!folder.path().join("work").exists());
}

#[test]
fn a_program_that_succeeds_at_last_leaves_nothing() {
    let folder = folder();
    let script = format!("echo >> '{{study}}/tries'; [ $(wc -l < '{{study}}/tries') -ge 3 ] || exit 7\n{ECHO}");
    let allowing = |retries| CommandModel::new(CommandSettings { retries, ..settings(folder.path(), &script) });
    let error = allowing(1).run(&[1.0, 2.0]).unwrap_err();
    assert_eq!((error.failure, error.attempts), (CommandFailure::ExitStatus { code: 7 }, 2));
    assert_eq!(runs(&folder).len(), 2);
    assert!(error.folder.unwrap().ends_with(&runs(&folder)[1]));
    fs::remove_file(folder.path().join("study/tries")).unwrap();
    assert_same_bits(&allowing(2).run(&[3.0, 4.0]).unwrap(), &echoed(&[3.0, 4.0]));
    assert_eq!(runs(&folder).len(), 2);
}

#[test]
fn folders_are_kept_as_asked() {
    for (keep, good, bad) in [(Keep::Always, 1, 1), (Keep::Failed, 0, 1), (Keep::Never, 0, 0)] {
        let folder = folder();
        let run = |script: &str| {
            CommandModel::new(CommandSettings { keep, ..settings(folder.path(), script) }).run(&[1.0, 2.0])
        };
        run(ECHO).unwrap();
        assert_eq!(runs(&folder).len(), good);
        let error = run("mkdir -p a/b; ln -s {study} a/study; exit 1").unwrap_err();
        assert_eq!(runs(&folder).len(), good + bad);
        assert_eq!(error.folder.is_some(), bad == 1);
        assert!(folder.path().join("study").exists());
    }
}

#[test]
fn a_folder_that_exists_is_never_used_again() {
    let folder = folder();
    let keep = Keep::Always;
    let program = CommandModel::new(CommandSettings { keep, ..settings(folder.path(), ECHO) });
    program.run(&[1.0, 2.0]).unwrap();
    let first = runs(&folder);
    assert!(first[0].ends_with("-1"));
    // Its answer, or that of a program that still writes there, is not taken for that of the next run.
    let silent = CommandModel::new(CommandSettings { keep, ..settings(folder.path(), "true") });
    let error = silent.run(&[1.0, 2.0]).unwrap_err();
    assert_eq!(error.failure, CommandFailure::NoResults { file: "results.json" });
    assert_eq!(runs(&folder)[1], first[0].replace("-1", "-2"));
}

#[test]
fn threads_share_a_program_and_a_point() {
    let folder = folder();
    let program = CommandModel::new(CommandSettings { keep: Keep::Always, ..settings(folder.path(), ECHO) });
    std::thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| assert_same_bits(&program.run(&[1.0, 2.0]).unwrap(), &echoed(&[1.0, 2.0])));
        }
    });
    assert_eq!(runs(&folder).len(), 8);
    program.clean_up();
    assert_eq!(runs(&folder).len(), 8);
}

#[test]
fn a_batch_of_single_runs_answers_each() {
    let folder = folder();
    let script = format!("grep -q '\"a\": 2.0' params.json && exit 5\n{ECHO}");
    let answers = program(&folder, &script).run_batch(&[vec![1.0, 0.0], vec![2.0, 0.0], vec![3.0, 0.0]]);
    assert_same_bits(answers[0].as_ref().unwrap(), &echoed(&[1.0, 0.0]));
    assert_eq!(answers[1].as_ref().unwrap_err().failure, CommandFailure::ExitStatus { code: 5 });
    assert_same_bits(answers[2].as_ref().unwrap(), &echoed(&[3.0, 0.0]));
}
