//! The schemas that are shipped: of surrogate files in JSON, of study files, and of what commands print with `--json`.
//! Here, and not with the other tests, because a validator takes as long to compile as the evaluator: `cargo test -p
//! pcc-tools`, which `.ci/run` does.

use jsonschema::Validator;
use pcc_compile::study::Study;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn text(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap()
}

fn committed(name: &str) -> Value {
    serde_json::from_str(&text(&format!("schemas/{name}"))).unwrap()
}

fn validator(name: &str) -> Validator {
    jsonschema::draft202012::new(&committed(name)).unwrap()
}

#[track_caller]
fn assert_valid(validator: &Validator, instance: &Value, what: &str) {
    if let Err(error) = validator.validate(instance) {
        panic!("{what}: {}: {error}", error.instance_path());
    }
}

/// Files of these folders with this ending.
fn files(folders: &[&str], ending: &str) -> Vec<PathBuf> {
    let entries = folders.iter().flat_map(|folder| fs::read_dir(root().join(folder)).unwrap());
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == ending));
    files.sort();
    files
}

#[test]
fn schemas_are_up_to_date_and_no_others_are_there() {
    let expected = pcc_tools::schemas();
    for (name, text) in &expected {
        assert_eq!(fs::read_to_string(root().join("schemas").join(name)).unwrap(), *text, "{name}");
    }
    assert_eq!(files(&["schemas", "schemas/output"], "json").len(), expected.len());
}

#[test]
fn shipped_json_satisfies_the_schema() {
    let validator = validator("surrogate.v1.schema.json");
    let files = files(&["surrogates"], "json");
    for path in &files {
        let mut instance: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
        assert_valid(&validator, &instance, &path.display().to_string());
        instance["meta"]["surprise"] = 1.into();
        assert!(!validator.is_valid(&instance), "the schema admits no unknown keys");
    }
    assert!(files.len() >= 16, "the shipped surrogates are looked at: {}", files.len());
}

#[test]
fn studies_satisfy_the_schema_and_unknown_keys_do_not() {
    let validator = validator("study.v1.schema.json");
    let mut studies: Vec<(String, String)> = files(&["surrogates", "tests/data/field", "tests/data/wide"], "toml")
        .into_iter()
        .map(|path| (path.display().to_string(), fs::read_to_string(path).unwrap()))
        .collect();
    let models = text("docs/how-to/own-model.md");
    let blocks = models.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    studies
        .extend(blocks.filter(|block| block.starts_with("format")).map(|block| ("own-model.md".into(), block.into())));
    assert!(studies.len() >= 50, "the studies are looked at: {}", studies.len());
    for (name, text) in studies {
        let study: Value = toml::from_str(&text).unwrap();
        assert_valid(&validator, &study, &name);
        for table in ["", "/model", "/spectrum", "/design", "/fit"] {
            let mut wrong = study.clone();
            if let Some(found) = wrong.pointer_mut(table) {
                found["surprise"] = 1.into();
                assert!(!validator.is_valid(&wrong), "{name}: an unknown key in {table}");
            }
        }
        let mut wrong = study.clone();
        wrong["inputs"].as_object_mut().unwrap().values_mut().for_each(|input| input["surprise"] = 1.into());
        assert!(!validator.is_valid(&wrong), "{name}: an unknown key of an input");
    }
}

/// What the reader says it expects where it finds an unknown key.
fn known_keys(study: &str) -> BTreeSet<String> {
    let error = Study::from_toml(study).unwrap_err().to_string();
    let (_, expected) = error.split_once("expected one of").unwrap_or_else(|| panic!("{error}"));
    expected.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The types of the schema are not those of the reader; their keys are.
#[test]
fn the_schema_has_the_keys_of_the_reader_and_explains_each() {
    let schema = committed("study.v1.schema.json");
    let table = |name: &str| match name {
        "" => schema["properties"].as_object().unwrap().clone(),
        name => schema["$defs"][name]["properties"].as_object().unwrap_or_else(|| panic!("{name}")).clone(),
    };
    let keys = |name: &str| table(name).keys().cloned().collect::<BTreeSet<_>>();
    let rest = "[model]\nkind = \"clutch\"\n[inputs]\nmu = { distribution = \"uniform\", lower = 0.0, upper = 0.5 }\n";
    let head = "format = 1\nname = \"s\"\n";
    assert_eq!(known_keys(&format!("{head}surprise = 1\n{rest}")), keys(""));
    assert_eq!(known_keys(&format!("{head}[model]\nsurprise = 1\n")), keys("Model"));
    assert_eq!(known_keys(&format!("{head}{rest}k_p = {{ surprise = 1 }}\n")), keys("Input"));
    assert_eq!(known_keys(&format!("{head}{rest}[spectrum]\nsurprise = 1\n")), keys("Spectrum"));
    assert_eq!(known_keys(&format!("{head}{rest}[design]\nsurprise = 1\n")), keys("Design"));
    assert_eq!(known_keys(&format!("{head}{rest}[dependence]\nsurprise = 1\n")), keys("Dependence"));
    for name in ["", "Model", "Term", "Input", "Dependence", "Spectrum", "Design", "Fit"] {
        for (key, value) in table(name) {
            let meaning = value["description"].as_str().unwrap_or_default();
            assert!(!meaning.is_empty() && !meaning.starts_with("Of:"), "{name}: {key} is not explained");
        }
    }
}

/// The document of a server, which prints it once it listens, and would go on.
fn what_a_server_prints(folder: &Path) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_program"));
    command.current_dir(folder).args(["serve", "s.pcc", "--port", "0", "--json"]);
    let mut server = command.stdout(Stdio::piped()).spawn().unwrap();
    let document = serde_json::Deserializer::from_reader(server.stdout.take().unwrap()).into_iter().next();
    server.kill().unwrap();
    server.wait().unwrap();
    document.unwrap().unwrap()
}

/// Every document that a command prints has the form that its schema promises.
#[test]
fn what_commands_print_satisfies_their_schemas() {
    let folder = tempfile::tempdir().unwrap();
    let copy = |from: &str, to: &str| fs::copy(root().join(from), folder.path().join(to)).map(|_| ()).unwrap();
    copy("surrogates/clutch-r2.toml", "clutch-r2.toml");
    copy("surrogates/clutch-r2.pcc", "s.pcc");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("points.csv", "mu,k_p\n0.25,16e6\n0.0,15.2e6\n");
    write("answers.csv", "mu,k_p\n");
    let dependence = "[dependence]\nkind = \"gaussian-copula\"\nspearman = [[\"mu\", \"k_p\", 0.5]]\n";
    write("d.toml", &(fs::read_to_string(root().join("surrogates/clutch-r2.toml")).unwrap() + dependence));
    write(
        "t.toml",
        "format = 1\nname = \"t\"\n[model]\nkind = \"table\"\neigenvalues = 2\n[inputs]\nx = { distribution = \
         \"uniform\", lower = 0.0, upper = 1.0 }\n",
    );
    let mut seen = BTreeSet::new();
    let mut print = |line: &str| {
        let command = line.split(' ').next().unwrap();
        let found = Command::new(env!("CARGO_BIN_EXE_program"))
            .current_dir(folder.path())
            .args(line.split(' '))
            .arg("--json")
            .output()
            .unwrap();
        assert!(found.status.success(), "{line}: {}", String::from_utf8_lossy(&found.stderr));
        let document: Value = serde_json::from_slice(&found.stdout).unwrap();
        let validator = validator(&format!("output/{command}.schema.json"));
        assert_valid(&validator, &document, line);
        assert!(!validator.is_valid(&json!({})), "{command}: the schema demands something");
        seen.insert(command.to_owned());
    };
    for line in [
        "build clutch-r2.toml --journal c.journal",
        "build clutch-r2.toml --show-study",
        "journal c.journal --study clutch-r2.toml",
        "run clutch-r2.toml",
        "certify s.pcc -n 20",
        "eval s.pcc -n 1000",
        "eval s.pcc -n 1000 --events max_re<-1 --histogram --quantiles --critical mu --where k_p=15.5e6..16e6",
        "eval s.pcc -n 1024 --sampler sobol",
        "eval s.pcc -n 100 --sweep mu=0..0.2:3 --where k_p=16e6",
        "eval s.pcc --points points.csv --out out.csv",
        "eval s.pcc -n 20000 --shard 0/2 --part 0.part",
        "eval s.pcc -n 20000 --shard 1/2 --part 1.part",
        "merge 0.part --part first.part",
        "merge 0.part 1.part",
        "modes clutch-r2.toml --at mu=0.3",
        "modes clutch-r2.toml --over mu=0..0.5:11 --chart modes.svg --table modes.csv",
        "reference clutch-r2.toml -n 50",
        "reference clutch-r2.toml --points points.csv --out model.csv",
        "compare s.pcc -n 100",
        "inspect s.pcc",
        "report s.pcc -n 1000",
        "report s.pcc -n 1000 --runs 20",
        "reproduce --only figure3",
        "convert s.pcc s.json",
        "build d.toml -o d.pcc",
        "eval d.pcc -n 1000",
        "eval d.pcc -n 100 --sweep mu=0..0.2:3 --where k_p=16e6",
        "reference d.toml -n 50",
        "compare d.pcc --study d.toml -n 100",
        "inspect d.pcc",
        "convert d.pcc d.json",
        "design t.toml --emit rows.csv",
        "version",
        "version --verbose",
        "man pages",
    ] {
        print(line);
    }
    let rows = fs::read_to_string(folder.path().join("rows.csv")).unwrap();
    let answered = rows.lines().enumerate().map(|(at, line)| match at {
        0 => format!("{line},re_1,im_1,re_2,im_2\n"),
        _ => format!("{line},-1.0,{0},-1.0,-{0}\n", 5 + at),
    });
    write("answers.csv", &answered.collect::<String>());
    print("ingest t.toml answers.csv");
    assert_valid(&validator("output/serve.schema.json"), &what_a_server_prints(folder.path()), "serve");
    seen.insert("serve".to_owned());
    let all: BTreeSet<String> = pcc::cli::schemas().into_iter().map(|(command, _)| command.to_owned()).collect();
    assert_eq!(seen, all);
}
