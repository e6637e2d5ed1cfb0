//! Nothing that a study says is code, unless it asks for a shell.

use super::*;

const HOSTILE: [&str; 12] = [
    "; touch pwned",
    "$(touch pwned)",
    "`touch pwned`",
    "a\nb\n",
    "-rf",
    "--",
    "../../pwned",
    "\"'\\",
    "|| touch pwned &",
    "{a} {{study} %PATH% $HOME *",
    "",
    "\u{202e}é\t",
];

fn assert_nothing_happened(folder: &TempDir) {
    let entries = |path: &Path| {
        fs::read_dir(path).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect::<Vec<_>>()
    };
    assert!(entries(folder.path()).iter().all(|name| ["study", "work"].contains(&name.as_str())));
    for run in runs(folder) {
        let digits = run.split('-').nth(1).unwrap();
        assert!(digits.len() == 16 && digits.bytes().all(|byte| byte.is_ascii_hexdigit()), "{run}");
        assert!(entries(&folder.path().join("work").join(&run)).iter().all(|name| !name.contains("pwned")));
    }
}

#[test]
fn arguments_arrive_unchanged() {
    let folder = folder();
    fs::write(folder.path().join("study/show.sh"), r#"for word; do printf '%s\0' "$word"; done > arguments; false"#)
        .unwrap();
    let mut command = vec!["sh".to_owned(), "{study}/show.sh".to_owned()];
    command.extend(HOSTILE.map(str::to_owned));
    let error =
        CommandModel::new(CommandSettings { command, ..settings(folder.path(), "") }).run(&[1.0, 2.0]).unwrap_err();
    let seen = fs::read_to_string(error.folder.unwrap().join("arguments")).unwrap();
    let expected = HOSTILE.map(|word| word.replace("{study}", folder.path().join("study").to_str().unwrap()) + "\0");
    assert_eq!(seen, expected.concat());
    assert_nothing_happened(&folder);
}

#[test]
fn names_are_data_in_both_kinds_of_files() {
    let folder = folder();
    let inputs: Vec<String> = HOSTILE.iter().map(|&name| name.to_owned()).collect();
    let point: Vec<f64> = (0..inputs.len()).map(|k| -(k as f64)).collect();
    let run = |mode| {
        let settings = CommandSettings { mode, inputs: inputs.clone(), ..settings(folder.path(), "exit 9") };
        CommandModel::new(settings).run(&point).unwrap_err().folder.unwrap()
    };
    let text = fs::read(run(Mode::Each).join("params.json")).unwrap();
    let parameters: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let mut table = csv::Reader::from_path(run(Mode::Batch).join("points.csv")).unwrap();
    let header = table.headers().unwrap().clone();
    let row = table.records().next().unwrap().unwrap();
    for (k, (name, value)) in inputs.iter().zip(&point).enumerate() {
        assert_eq!(parameters[name].as_f64(), Some(*value));
        assert_eq!((&header[k + 1], row[k + 1].parse()), (name.as_str(), Ok(*value)));
    }
    assert_nothing_happened(&folder);
}

#[test]
fn a_shell_gets_paths_as_variables() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("study");
    let study_folder = study.join("a $(touch pwned) 'b' \"c\" {work}");
    fs::create_dir_all(&study_folder).unwrap();
    fs::write(study_folder.join("model.sh"), ECHO).unwrap();
    let command = vec!["a=1; sh \"{study}/model.sh\" && [ -f \"{work}/params.json\" ] && echo ${a} {b}".to_owned()];
    let settings = CommandSettings { command, shell: true, study_folder, ..settings(folder.path(), "") };
    let program = CommandModel::new(CommandSettings { keep: Keep::Always, ..settings });
    assert_same_bits(&program.run(&[1.0, 2.0]).unwrap(), &echoed(&[1.0, 2.0]));
    let run = folder.path().join("work").join(&runs(&folder)[0]);
    assert_eq!(fs::read_to_string(run.join("stdout.txt")).unwrap(), "1 {b}\n");
    assert_nothing_happened(&folder);
}
