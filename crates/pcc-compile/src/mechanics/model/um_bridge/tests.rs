use super::*;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::thread;
use std::time::Instant;

/// What the server of the tests does with a request.
enum Reply {
    /// Answers.
    Json(u16, String),
    /// Writes this, and ends the connection.
    Raw(&'static str),
    /// Says nothing until the client goes.
    Silence,
    /// Sends blanks until the client goes.
    Endless,
}

/// A server that speaks just enough HTTP. It ends with the tests.
fn serve(answer: impl Fn(&str, Value) -> Reply + Send + Sync + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    let answer = Arc::new(answer);
    thread::spawn(move || {
        for stream in listener.incoming() {
            let (answer, stream) = (answer.clone(), stream.unwrap());
            thread::spawn(move || reply(stream, &*answer));
        }
    });
    url
}

fn reply(mut stream: TcpStream, answer: &(dyn Fn(&str, Value) -> Reply + Send + Sync)) {
    let mut reader = BufReader::new(stream.try_clone().unwrap());
    let (mut first, mut length) = (String::new(), 0);
    reader.read_line(&mut first).unwrap();
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).unwrap();
        if line.trim().is_empty() {
            break;
        }
        if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
            length = value.trim().parse().unwrap();
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).unwrap();
    let request = if body.is_empty() { Value::Null } else { serde_json::from_slice(&body).unwrap() };
    match answer(first.split(' ').nth(1).unwrap(), request) {
        Reply::Json(status, text) => {
            let head = format!("HTTP/1.1 {status} X\r\nContent-Length: {}\r\n\r\n", text.len());
            let _ = stream.write_all((head + &text).as_bytes());
        }
        Reply::Raw(text) => {
            let _ = stream.write_all(text.as_bytes());
        }
        Reply::Silence => {
            let _ = stream.read(&mut [0]);
        }
        Reply::Endless => {
            let piece = format!("100000\r\n{}\r\n", " ".repeat(0x100000));
            let _ = stream.write_all(b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n");
            while stream.write_all(piece.as_bytes()).is_ok() {}
        }
    }
}

fn ok(value: Value) -> Reply {
    Reply::Json(200, value.to_string())
}

/// What a server with the model "belt" of three numbers and two eigenvalues says of itself.
fn greet(path: &str) -> Reply {
    match path {
        "/Info" => ok(json!({ "protocolVersion": 1.0, "models": ["other", "belt"] })),
        "/ModelInfo" => ok(json!({ "support": { "Evaluate": true } })),
        "/InputSizes" => ok(json!({ "inputSizes": [2, 1] })),
        "/OutputSizes" => ok(json!({ "outputSizes": [2, 2] })),
        other => Reply::Json(404, format!("nothing at {other}")),
    }
}

fn settings(url: &str) -> UmBridgeSettings {
    let argument = |name: &str, value| Argument { name: name.to_owned(), value };
    UmBridgeSettings {
        url: url.to_owned(),
        name: "belt".to_owned(),
        config: json!({ "fidelity": 2, "solver": { "name": "QZ" } }),
        arguments: vec![
            argument("k", ArgumentValue::Input(1)),
            argument("c", ArgumentValue::Constant(0.5)),
            argument("mu", ArgumentValue::Input(0)),
        ],
        inputs: 2,
        eigenvalues: 2,
        jobs: 1,
        timeout: None,
        retries: 0,
    }
}

/// A model whose server greets well and answers runs like this.
fn model(evaluate: impl Fn(Value) -> Reply + Send + Sync + 'static) -> UmBridgeModel {
    let url = serve(move |path, request| if path == "/Evaluate" { evaluate(request) } else { greet(path) });
    UmBridgeModel::new(settings(&url))
}

const POINT: [f64; 2] = [0.1, 1.0 / 3.0];

#[test]
fn values_go_in_by_name_and_pairs_come_out() {
    let asked = Arc::new(Mutex::new(Value::Null));
    let seen = asked.clone();
    let model = model(move |request| {
        *seen.lock().unwrap() = request;
        ok(json!({ "output": [[-1, 2.5e-300], [0.1, -0.0]], "more": 1 }))
    });
    let found = model.run(&POINT).unwrap();
    assert_eq!(found, [Complex::new(-1.0, 2.5e-300), Complex::new(0.1, -0.0)]);
    let expected = json!({
        "name": "belt",
        "input": [[1.0 / 3.0, 0.5], [0.1]],
        "config": { "fidelity": 2, "solver": { "name": "QZ" } },
    });
    assert_eq!(*asked.lock().unwrap(), expected);
}

#[test]
fn a_server_is_asked_about_itself_once() {
    let greetings = Arc::new(AtomicUsize::new(0));
    let seen = greetings.clone();
    let url = serve(move |path, _| {
        if path == "/Evaluate" {
            return ok(json!({ "output": [[1, 2, 3, 4]] }));
        }
        seen.fetch_add(1, Ordering::SeqCst);
        greet(path)
    });
    // A slash too many is none.
    let model = UmBridgeModel::new(settings(&format!("{url}/")));
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| assert_eq!(model.run(&POINT).unwrap().len(), 2));
        }
    });
    assert_eq!(greetings.load(Ordering::SeqCst), 4);
    assert_eq!(Model::concurrency(&model), Concurrency::Jobs(1));
}

/// The message of a run, without the number of the port; `run` before those that are the model's fault.
fn message(model: &UmBridgeModel) -> String {
    let error = model.run(&POINT).unwrap_err();
    let text = error.to_string().replace(&error.url, "http://HOST");
    format!("{}{text}", if error.is_of_run { "run: " } else { "" })
}

#[test]
fn wrong_answers_are_told_apart() {
    let replies = [
        (200, r#"{"output": [[1, 2, 3]]}"#),
        (200, r#"{"output": [[1, 2], [3, 4, 5]]}"#),
        (200, r#"{"output": []}"#),
        (200, r#"{"output": [1, 2, 3, 4]}"#),
        (200, r#"{"output": "none"}"#),
        (200, r#"{"outputs": [[1, 2, 3, 4]]}"#),
        (200, r#"[[1, 2, 3, 4]]"#),
        (200, r#"{"output": [[1, 2], [null, 4]]}"#),
        (200, r#"{"output": [["1", 2], [3, 4]]}"#),
        (200, r#"{"output": [[[1], 2], [3, 4]]}"#),
        (200, r#"{"output": [[nan, 2.0], [3.0, 4.0]] }"#),
        (200, r#"{"output": [[1.0, 2.0], [-Infinity, 4.0]] }"#),
        (200, r#"{"output": [[1e999, 2], [3, 4]]}"#),
        (200, r#"{"output": [[1, 2], [3, 4]]"#),
        (200, ""),
        (200, "<html>\u{1b}[31m inf </html>"),
        (400, r#"{"error": {"type": "InvalidInput", "message": "mu is too\nlarge"}}"#),
        (500, r#"{"error": {"type": "InvalidOutput", "message": 3}}"#),
        (200, r#"{"error": {"type": "ModelNotFound", "message": "gone"}}"#),
        (500, r#"{"error": {}}"#),
        (500, r#"{"error": "a text"}"#),
        (500, "500 Internal Server Error\n\nServer got itself in trouble"),
        (302, "elsewhere"),
    ];
    let mut messages = String::new();
    for (status, text) in replies {
        let answer = text.to_owned();
        let model = model(move |_| Reply::Json(status, answer.clone()));
        let shown: String = text.chars().take(60).collect();
        let _ = writeln!(messages, "{status} {shown:?}\n    {}", message(&model));
    }
    insta::assert_snapshot!(messages);
    let long = json!({ "error": { "type": "T".repeat(10_000), "message": "long ".repeat(10_000) } });
    let length = message(&model(move |_| Reply::Json(400, long.to_string()))).chars().count();
    assert!((2_000..2_200).contains(&length), "{length}");
}

#[test]
fn a_model_that_does_not_fit_is_refused_before_the_first_run() {
    let greetings = [
        ("/Info", r#"{"protocolVersion": 0.9, "models": ["belt"]}"#),
        ("/Info", r#"{"protocolVersion": "1.0", "models": ["belt"]}"#),
        ("/Info", r#"{"models": ["belt"]}"#),
        ("/Info", r#"{"protocolVersion": 1, "models": "belt"}"#),
        ("/Info", r#"{"protocolVersion": 1, "models": []}"#),
        ("/Info", r#"{"protocolVersion": 1, "models": ["a","b","c","d","e","f","g\u001b","h","i","j"]}"#),
        ("/Info", "<!DOCTYPE html>"),
        ("/ModelInfo", r#"{"support": {"Evaluate": false}}"#),
        ("/ModelInfo", r#"{"support": {"Gradient": true}}"#),
        ("/ModelInfo", "{}"),
        ("/InputSizes", r#"{"inputSizes": [2, 2, 1, 1, 1, 1, 1, 1, 1]}"#),
        ("/InputSizes", r#"{"inputSizes": []}"#),
        ("/InputSizes", r#"{"inputSizes": 3}"#),
        ("/OutputSizes", r#"{"outputSizes": [3]}"#),
        ("/OutputSizes", r#"{"outputSizes": [18446744073709551615, 18446744073709551615]}"#),
        ("/OutputSizes", r#"{"outputSizes": [-4]}"#),
    ];
    let mut messages = String::new();
    for (wrong, text) in greetings {
        let url = serve(move |path, _| if path == wrong { Reply::Json(200, text.to_owned()) } else { greet(path) });
        let _ = writeln!(messages, "{wrong} {text:?}\n    {}", message(&UmBridgeModel::new(settings(&url))));
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn connections_that_fail_are_told_apart() {
    let failure = |text| model(move |_| Reply::Raw(text)).run(&POINT).unwrap_err();
    let closed = failure("");
    assert!(matches!(closed.failure, UmBridgeFailure::Closed { .. }), "{closed}");
    // Somebody ended the server: another attempt may go well.
    assert!(closed.is_of_run && ModelError::from(closed).is_by_circumstances());
    let short = failure("HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\n{\"output\": [[1, 2");
    assert!(matches!(short.failure, UmBridgeFailure::Closed { .. }), "{short}");
    let foreign = failure("SSH-2.0-OpenSSH_9.6\r\n");
    assert!(matches!(foreign.failure, UmBridgeFailure::NotHttp { .. }), "{foreign}");
    // Pieces without end.
    let endless = model(|_| Reply::Endless).run(&POINT).unwrap_err();
    assert!(matches!(endless.failure, UmBridgeFailure::TooLarge { path: "Evaluate", .. }), "{endless}");
    // Nobody listens on a port that was just given back.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let refused = UmBridgeModel::new(settings(&format!("http://127.0.0.1:{port}"))).run(&POINT).unwrap_err();
    assert!(matches!(refused.failure, UmBridgeFailure::NotReached { .. }) && !refused.is_of_run, "{refused}");
}

#[test]
fn runs_that_fail_are_tried_again() {
    let attempts = Arc::new(AtomicUsize::new(0));
    let seen = attempts.clone();
    let evaluate = move |_| match seen.fetch_add(1, Ordering::SeqCst) {
        0 | 1 => Reply::Json(500, "no licence".to_owned()),
        _ => ok(json!({ "output": [[1, 2, 3, 4]] })),
    };
    let mut model = model(evaluate);
    model.settings.retries = 1;
    let error = model.run(&POINT).unwrap_err();
    assert_eq!(error.attempts, 2);
    assert!(error.to_string().ends_with("HTTP status 500: no licence; 2 attempts were made"), "{error}");
    assert_eq!(model.run(&POINT).unwrap().len(), 2);
    // What cannot go better is not tried again.
    let error = model.run(&[0.1]).unwrap_err();
    assert_eq!(error.failure, UmBridgeFailure::PointLength { found: 1, expected: 2 });
    let error = model.run(&[0.1, f64::NAN]).unwrap_err();
    assert!(matches!(&error.failure, UmBridgeFailure::ValueNotFinite { name, .. } if name == "k"), "{error}");
    assert_eq!((error.attempts, attempts.load(Ordering::SeqCst)), (1, 3));
}

#[test]
fn waiting_ends_at_the_limit_and_when_it_is_asked_to() {
    let mut settings = model(|_| Reply::Silence).settings;
    settings.timeout = Some(Duration::from_millis(100));
    let error = UmBridgeModel::new(settings.clone()).run(&POINT).unwrap_err();
    assert!(matches!(error.failure, UmBridgeFailure::TimedOut { .. }) && error.is_of_run, "{error}");
    settings.timeout = None;
    let model = UmBridgeModel::new(settings);
    let start = Instant::now();
    thread::scope(|scope| {
        let run = scope.spawn(|| model.run(&POINT));
        thread::sleep(Duration::from_millis(100));
        model.interrupt();
        assert_eq!(run.join().unwrap().unwrap_err().failure, UmBridgeFailure::Interrupted);
    });
    assert_eq!(model.run(&POINT).unwrap_err().failure, UmBridgeFailure::Interrupted);
    assert!(start.elapsed() < Duration::from_secs(5));
}

#[test]
fn addresses_of_servers_are_plain() {
    for url in ["http://localhost:4242", "http://10.0.0.1", "http://[::1]:4242/", "http://node7:80/models/"] {
        assert_eq!(check_url(url), Ok(()), "{url}");
    }
    for url in
        ["", "localhost:4242", "https://a", "ftp://a", "http://", "/Info", "http://a b", "http://u:p@a", "http://a?q"]
    {
        assert!(check_url(url).is_err(), "{url}");
    }
}
