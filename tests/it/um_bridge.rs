//! UM-Bridge in both directions: a surrogate that is served is the model of another study, and models on other servers
//! are run like programs.

use crate::support::command::{output, pcc, refusal};
use crate::support::{build, in_one_line, text};
use num_complex::Complex;
use pcc_compile::mechanics::model::{Model, ModelError};
use pcc_compile::study::Study;
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// `pcc serve`, ended with the test.
struct Served {
    process: Child,
    said: Value,
}

impl Served {
    fn start(surrogate: &Path) -> Self {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("pcc"));
        command.arg("serve").arg(surrogate).args(["--port", "0", "--json"]);
        let mut process = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let stdout = BufReader::new(process.stdout.take().unwrap());
        let mut document = serde_json::Deserializer::from_reader(stdout).into_iter();
        let said = document.next().unwrap().unwrap();
        Self { process, said }
    }

    fn url(&self) -> &str {
        self.said["url"].as_str().unwrap()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The two modes of the belt, by their matrices.
const BELT: &str = r#"
    format = 1
    name = "belt"
    [model]
    kind = "matrices"
    M = [[2, 0], [0, 2]]
    C = [[2, 0], [0, 2]]
    K = [[3000, "500 - mu*k_n"], [500, "1000 + k_n"]]
    [inputs]
    mu  = { distribution = "uniform", lower = 0.0, upper = 0.5 }
    k_n = { distribution = "uniform", lower = 1800.0, upper = 2400.0 }
"#;

/// The same on a server; more keys of the model.
fn on_server(url: &str, keys: &str) -> String {
    let (_, inputs) = BELT.split_once("[inputs]").unwrap();
    format!(
        "format = 1\nname = \"belt\"\n[model]\nkind = \"um-bridge\"\nurl = \"{url}\"\nname = \"forward\"\n\
         eigenvalues = 4\n{keys}\n[inputs]{inputs}"
    )
}

/// A server of the model "forward" that takes two lists of one number each, and answers what `evaluate` says.
fn serve(evaluate: impl Fn(f64, f64, &Value) -> (u16, String) + Send + Sync + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    let evaluate = Arc::new(evaluate);
    thread::spawn(move || {
        for stream in listener.incoming() {
            let evaluate = evaluate.clone();
            thread::spawn(move || reply(stream.unwrap(), &*evaluate));
        }
    });
    url
}

fn reply(mut stream: TcpStream, evaluate: &(dyn Fn(f64, f64, &Value) -> (u16, String) + Send + Sync)) {
    let mut reader = BufReader::new(stream.try_clone().unwrap());
    let head: Vec<String> =
        reader.by_ref().lines().map(|line| line.unwrap()).take_while(|line| !line.is_empty()).collect();
    let lower = head.iter().map(|line| line.to_ascii_lowercase());
    let length =
        lower.filter_map(|line| line.strip_prefix("content-length: ").and_then(|text| text.parse().ok())).next();
    let mut body = vec![0; length.unwrap_or(0)];
    reader.read_exact(&mut body).unwrap();
    let request: Value = serde_json::from_slice(&body).unwrap_or_default();
    let number = |list: usize| request["input"][list][0].as_f64().unwrap();
    let (status, answer) = match head[0].split(' ').nth(1).unwrap() {
        "/Info" => (200, json!({ "protocolVersion": 1.0, "models": ["forward"] }).to_string()),
        "/ModelInfo" => (200, json!({ "support": { "Evaluate": true, "Gradient": false } }).to_string()),
        "/InputSizes" => (200, json!({ "inputSizes": [1, 1] }).to_string()),
        "/OutputSizes" => (200, json!({ "outputSizes": [8] }).to_string()),
        "/Evaluate" => evaluate(number(0), number(1), &request["config"]),
        other => panic!("{other}"),
    };
    let _ = write!(stream, "HTTP/1.1 {status} X\r\nContent-Length: {}\r\n\r\n{answer}", answer.len());
}

/// The eigenvalues of the belt as a server answers them.
fn belt(mu: f64, k_n: f64) -> Result<Vec<Complex<f64>>, ModelError> {
    Study::from_toml(BELT).unwrap().model()?.eigenvalues(&[mu, k_n])
}

fn answered(eigenvalues: &[Complex<f64>]) -> (u16, String) {
    let numbers: Vec<f64> = eigenvalues.iter().flat_map(|lambda| [lambda.re, lambda.im]).collect();
    (200, json!({ "output": [numbers] }).to_string())
}

/// The belt, known by its eigenvalues alone.
struct Values;

impl Model for Values {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        belt(point[0], point[1])
    }
}

#[test]
fn a_model_on_a_server_gives_the_surrogate_of_the_same_model_here() {
    let url = serve(|mu, k_n, config| {
        assert_eq!(*config, json!({ "mesh": { "levels": [1, 2] }, "tolerance": 1e-9 }));
        answered(&belt(mu, k_n).unwrap())
    });
    let keys = "config = { tolerance = 1e-9, mesh = { levels = [1, 2] } }\njobs = 4\ntimeout = 60.0";
    let study = Study::from_toml(&on_server(&url, keys)).unwrap();
    let (there, here) = (build(&study), pcc_compile::compilation::build_with(&study, Box::new(Values), &pcc::Silent));
    assert_eq!(there.expansions, here.unwrap().expansions);
    // The order of what the model takes is its own.
    let swapped = serve(|k_n, mu, _| answered(&belt(mu, k_n).unwrap()));
    let study = Study::from_toml(&on_server(&swapped, "parameters = [\"k_n\", \"mu\"]")).unwrap();
    assert_eq!(build(&study).expansions, there.expansions);
}

#[test]
fn constants_are_handed_on_where_the_model_takes_them() {
    let url = serve(|k_n, mu, _| {
        assert_eq!(k_n, 2000.5);
        answered(&belt(mu, k_n).unwrap())
    });
    let toml = on_server(&url, "parameters = [\"k_n\", \"mu\"]\nconstants = { k_n = 2000.5 }");
    let toml: String =
        toml.lines().filter(|line| !line.trim().starts_with("k_n =")).map(|line| format!("{line}\n")).collect();
    let found = Study::from_toml(&toml).unwrap().model().unwrap().eigenvalues(&[0.2]).unwrap();
    assert_eq!(found, belt(0.2, 2000.5).unwrap());
}

#[test]
fn a_served_surrogate_is_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let study = Study::from_toml(BELT).unwrap();
    build(&study).save(folder.path().join("belt.pcc")).unwrap();
    let served = Served::start(&folder.path().join("belt.pcc"));
    assert_eq!(served.said["inputs"], json!([{ "name": "mu", "unit": null }, { "name": "k_n", "unit": null }]));
    let outputs: Vec<_> = served.said["models"].as_array().unwrap().iter().map(|model| &model["outputs"]).collect();
    assert_eq!(outputs, [8, 1, 1]);
    let toml = on_server(served.url(), "").replace("\"forward\"", "\"eigenvalues\"");
    let again = build(&Study::from_toml(&toml).unwrap());
    let share = |surrogate| pcc::monte_carlo(surrogate, 100_000, 1, &pcc::Silent).unwrap().stable_proportion().value();
    assert!((share(&again) - share(&build(&study))).abs() < 5e-4);
    // Every key has its word in the study that is printed.
    let printed = Study::from_toml(&toml).unwrap().to_toml();
    assert_eq!(Study::from_toml(&printed).unwrap(), Study::from_toml(&toml).unwrap(), "{printed}");
}

#[test]
fn runs_that_fail_are_recorded_skipped_and_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let runs = Arc::new(AtomicUsize::new(0));
    let seen = runs.clone();
    // One corner has no answer.
    let url = serve(move |mu, k_n, _| {
        seen.fetch_add(1, Ordering::SeqCst);
        if mu > 0.4 && k_n > 2300.0 {
            return (
                500,
                json!({ "error": { "type": "InvalidOutput", "message": "no static equilibrium" } }).to_string(),
            );
        }
        answered(&belt(mu, k_n).unwrap())
    });
    let write = |keys: &str| fs::write(folder.path().join("belt.toml"), on_server(&url, keys)).unwrap();
    write("");
    let stopped = pcc(folder.path(), &["build", "belt.toml", "--quiet"]);
    let message = in_one_line(&String::from_utf8(stopped.stderr).unwrap());
    assert_eq!(stopped.status.code(), Some(2));
    assert!(message.contains("the server reports InvalidOutput: no static equilibrium"), "{message}");
    write("on_failure = \"skip\"\njobs = 3");
    let before = runs.load(Ordering::SeqCst);
    let found = output(folder.path(), &["build", "belt.toml", "--resume", "--json", "--quiet"]);
    let report: Value = serde_json::from_str(&found).unwrap();
    assert!(report["reused_runs"].as_u64().unwrap() > 0, "{report}");
    assert!(!report["failed_runs"].as_array().unwrap().is_empty(), "{}", report["failed_runs"]);
    let made = runs.load(Ordering::SeqCst) - before;
    assert!(made < report["direct_computations"].as_u64().unwrap() as usize, "{made} runs are new");
    assert!(made > 0);
}

#[test]
fn a_build_ends_when_the_server_is_gone_whatever_is_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let toml = on_server(&format!("http://127.0.0.1:{port}"), "on_failure = \"skip\"");
    fs::write(folder.path().join("belt.toml"), toml).unwrap();
    let found = pcc(folder.path(), &["build", "belt.toml", "--no-journal"]);
    let message = in_one_line(&String::from_utf8(found.stderr).unwrap());
    assert_eq!(found.status.code(), Some(2), "{message}");
    assert!(message.contains("the server cannot be reached") && message.contains("is it running"), "{message}");
}

#[test]
fn studies_of_servers_are_checked_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let of = |keys: &str| on_server("http://localhost:4242", keys);
    let cases = [
        of("").replace("url = \"http://localhost:4242\"\n", ""),
        of("").replace("name = \"forward\"\n", ""),
        of("").replace("eigenvalues = 4\n", ""),
        of("").replace("http://localhost:4242", "https://example.org"),
        of("").replace("\"forward\"", "\"\""),
        of("config = { since = 2026-01-01 }"),
        of("config = { steps = [1.0, inf] }"),
        of("config = 3"),
        of("parameters = [\"mu\"]"),
        of("parameters = [\"mu\", \"mu\"]"),
        of("parameters = [\"mu\", \"k_n\", \"c\"]"),
        of("constants = { c = 1.0 }"),
        of("command = [\"solve\"]"),
        of("jobs = 0"),
        of("timeout = -1.0"),
        format!("{}[fit]\nderivatives = true\n", of("")),
        of("").replace("k_n =", "re_1 ="),
        text("surrogates/clutch-r1.toml").replace("kind = \"clutch\"", "kind = \"clutch\"\nurl = \"http://a\""),
    ];
    let mut messages = String::new();
    for case in cases {
        fs::write(folder.path().join("belt.toml"), case).unwrap();
        messages += &refusal(folder.path(), &["build", "belt.toml"]);
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn servers_are_told_apart_by_model_and_not_by_address() {
    let hash = |keys: &str, port: u16| {
        Study::from_toml(&on_server(&format!("http://localhost:{port}"), keys)).unwrap().problem_hash()
    };
    let plain = hash("", 4242);
    let same = [
        "jobs = 4",
        "retries = 2\ntimeout = 1.5",
        "on_failure = \"skip\"",
        "config = {}",
        "parameters = [\"mu\", \"k_n\"]",
    ];
    for keys in same {
        assert_eq!(hash(keys, 4243), plain, "{keys}");
    }
    for keys in ["version = \"2\"", "config = { mesh = 1 }", "parameters = [\"k_n\", \"mu\"]"] {
        assert_ne!(hash(keys, 4242), plain, "{keys}");
    }
    assert_eq!(hash("config = { a = 1, b = 2 }", 1), hash("config = { b = 2, a = 1 }", 1));
}

#[cfg(unix)]
#[test]
fn a_server_ends_at_ctrl_c_with_what_it_did() {
    let folder = tempfile::tempdir().unwrap();
    let surrogate = crate::support::repository("surrogates/clutch-r1.pcc");
    let mut served = Served::start(&surrogate);
    let address = served.url().strip_prefix("http://").unwrap().to_owned();
    let mut idle = TcpStream::connect(&address).unwrap();
    idle.write_all(b"GET /Info HTTP/1.1\r\n\r\n").unwrap();
    idle.read_exact(&mut [0; 15]).unwrap();
    // Another server has no room at the same port.
    let port = address.rsplit(':').next().unwrap();
    let message = refusal(folder.path(), &["serve", surrogate.to_str().unwrap(), "--port", port]);
    assert!(in_one_line(&message).contains("choose another --port"), "{message}");
    let process = served.process.id().to_string();
    assert!(Command::new("kill").args(["-INT", &process]).status().unwrap().success());
    let mut waited = Duration::ZERO;
    let status = loop {
        match served.process.try_wait().unwrap() {
            Some(status) => break status,
            None => thread::sleep(Duration::from_millis(20)),
        }
        waited += Duration::from_millis(20);
        assert!(waited < Duration::from_secs(10), "it does not end");
    };
    let mut said = String::new();
    served.process.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!((status.code(), said.as_str()), (Some(130), "pcc: 1 request answered\n"));
}
