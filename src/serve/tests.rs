//! Over real connections: what is asked, answered and refused, and what clients can cost.

use super::{Limits, Models, Offered, Server, answer};
use pcc_evaluate::artifact::decode;
use pcc_evaluate::components::Verdict;
use pcc_evaluate::evaluation::GivenPoints;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::Surrogate;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::{Read, Write};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Nobody waits long in these tests.
const LIMITS: Limits = Limits { connections: 8, head: 4096, body: 10_000, patience: Duration::from_millis(400) };

fn surrogate() -> Surrogate {
    decode(include_bytes!("../../surrogates/clutch-r2.pcc")).unwrap().surrogate
}

/// Serves the clutch with two inputs while `ask` asks; returns how many requests were answered.
fn serving(ask: impl FnOnce(SocketAddr)) -> u64 {
    let surrogate = surrogate();
    let models = Models::new(&surrogate);
    let server = Server::bind((Ipv4Addr::LOCALHOST, 0).into(), LIMITS).unwrap();
    let (address, is_over) = (server.address(), AtomicBool::new(false));
    thread::scope(|scope| {
        let run = scope.spawn(|| server.run(|request| answer(&models, request), || is_over.load(Ordering::SeqCst)));
        let asked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| ask(address)));
        is_over.store(true, Ordering::SeqCst);
        let answered = run.join().unwrap();
        asked.map_or_else(|panic| std::panic::resume_unwind(panic), |()| answered)
    })
}

fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    stream
}

/// All that comes until the connection ends.
fn rest(mut stream: TcpStream) -> String {
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// Sends this, and nothing more.
fn send(address: SocketAddr, bytes: &[u8]) -> String {
    let mut stream = connect(address);
    stream.write_all(bytes).unwrap();
    stream.shutdown(Shutdown::Write).unwrap();
    rest(stream)
}

fn request(method: &str, path: &str, body: &str) -> String {
    format!("{method} {path} HTTP/1.1\r\nHost: h\r\nContent-Length: {}\r\n\r\n{body}", body.len())
}

/// Status and JSON of an answer.
fn read(answer: &str) -> (u16, Value) {
    let (head, body) = answer.split_once("\r\n\r\n").unwrap_or_else(|| panic!("{answer:?}"));
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    (status, serde_json::from_str(body).unwrap_or(Value::Null))
}

fn post(address: SocketAddr, path: &str, body: &Value) -> (u16, Value) {
    read(&send(address, request("POST", path, &body.to_string()).as_bytes()))
}

/// What a request that must be answered is answered.
fn asked(address: SocketAddr, path: &str, body: &Value) -> Value {
    let (status, found) = post(address, path, body);
    assert_eq!(status, 200, "{path} {body}: {found}");
    found
}

#[test]
fn answers_are_those_of_the_surrogate_to_the_bit() {
    let surrogate = surrogate();
    let given = GivenPoints { surrogate: &surrogate, extrapolates: true };
    serving(|address| {
        let info = read(&send(address, request("GET", "/Info", "").as_bytes())).1;
        assert_eq!(info, json!({ "protocolVersion": 1.0, "models": ["eigenvalues", "max_re", "verdict"] }));
        assert_eq!(asked(address, "/Info/?x=1", &Value::Null), info);
        for (name, size) in [("eigenvalues", 16), ("max_re", 1), ("verdict", 1)] {
            let model = json!({ "name": name });
            let support = json!({ "Evaluate": true, "Gradient": false, "ApplyJacobian": false, "ApplyHessian": false });
            assert_eq!(asked(address, "/ModelInfo", &model), json!({ "support": support }));
            assert_eq!(asked(address, "/InputSizes", &model), json!({ "inputSizes": [2] }));
            assert_eq!(asked(address, "/OutputSizes", &model), json!({ "outputSizes": [size] }));
        }
        for (point, config) in
            [([0.1, 16e6], json!({})), ([0.45, 15.5e6], Value::Null), ([0.7, 16e6], json!({ "extrapolate": true }))]
        {
            let value = |name: &str| {
                asked(address, "/Evaluate", &json!({ "name": name, "input": [point], "config": config }))["output"]
                    .clone()
            };
            let (mut max_re, mut verdict) = ([0.0], [Verdict::Stable]);
            given.max_re(&point, &mut max_re, &Silent).unwrap();
            given.verdicts(&point, &mut verdict, &Silent).unwrap();
            assert_eq!(value("max_re"), json!([max_re]));
            assert_eq!(value("verdict"), json!([[f64::from(verdict[0] as u8)]]));
            let mut labels = vec![num_complex::Complex::default(); surrogate.labels().len()];
            given.eigenvalues(&point, &mut labels, &Silent).unwrap();
            let pairs: Vec<f64> = labels.iter().flat_map(|l| [l.re, l.im, l.re, -l.im]).collect();
            assert_eq!(value("eigenvalues"), json!([pairs]));
        }
    });
}

/// A mode that becomes overdamped, and an eigenvalue that is real everywhere: 6 numbers, not 8.
const OVERDAMPED: &str = r#"
    format = 1
    name = "overdamped"
    [model]
    kind = "matrices"
    A = [[0, 1, 0], ["-k", "-c", 0], [0, 0, "-c"]]
    [inputs]
    c = { distribution = "uniform", lower = 1.0, upper = 3.0 }
    k = { distribution = "uniform", lower = 0.9, upper = 1.1 }
"#;

#[test]
fn every_eigenvalue_is_there_once_whatever_becomes_of_a_mode() {
    let surrogate = crate::build(&crate::Study::from_toml(OVERDAMPED).unwrap(), &Silent).unwrap();
    let models = Models::new(&surrogate);
    assert_eq!(models.output_size(Offered::Eigenvalues), 6);
    for (c, k) in [(1.2, 1.0), (1.9, 0.95), (2.5, 1.05), (2.9, 1.0)] {
        let found = models.evaluate(Offered::Eigenvalues, &[c, k], false).unwrap();
        let root = num_complex::Complex::new(c * c / 4.0 - k, 0.0).sqrt();
        let expected = [(root - c / 2.0).re, root.im, (-root - c / 2.0).re, -root.im, -c, 0.0];
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-6, "{found} and {expected} at {c}, {k}");
        }
    }
}

#[test]
fn wrong_questions_are_answered_by_sentences() {
    let deep = format!("{{\"name\": \"max_re\", \"input\": {}", "[".repeat(9_000));
    let long = format!("{{\"name\": \"{}\"}}", "µ".repeat(4_000));
    let bodies = [
        ("/Evaluate", r#"{"name": "max_re", "input": [[0.1]]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[0.1, 16e6, 1]]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[0.1], [16e6]]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [0.1, 16e6]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": []}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": {"mu": 0.1}}"#),
        ("/Evaluate", r#"{"name": "max_re"}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [["0.1", 16e6]]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[[0.1], 16e6]]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[null, 16e6]]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[NaN, 16e6]]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[1e999, 16e6]]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[0.7, 16e6]]}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[1e300, 16e6]], "config": {"extrapolate": true}}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[0.1, 16e6]], "config": {"extrapolate": 1}}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[0.1, 16e6]], "config": {"Extrapolate": true}}"#),
        ("/Evaluate", r#"{"name": "max_re", "input": [[0.1, 16e6]], "config": []}"#),
        ("/OutputSizes", r#"{"name": "max_re", "config": {"level": 2}}"#),
        ("/Evaluate", r#"{"name": "forward", "input": [[0.1, 16e6]]}"#),
        ("/Evaluate", r#"{"name": ["max_re"]}"#),
        ("/ModelInfo", r#"{}"#),
        ("/ModelInfo", r#"[]"#),
        ("/ModelInfo", ""),
        ("/ModelInfo", "name=max_re"),
        ("/ModelInfo", &deep),
        ("/ModelInfo", &long),
        ("/Gradient", r#"{"name": "max_re"}"#),
        ("/ApplyJacobian", r#"{"name": "nobody"}"#),
        ("/TestShMem", r#"{"name": "max_re", "tid": "1"}"#),
        ("/evaluate", r#"{"name": "max_re"}"#),
        ("/", ""),
    ];
    let mut said = String::new();
    serving(|address| {
        for (path, body) in bodies {
            let (status, answer) = read(&send(address, request("POST", path, body).as_bytes()));
            let shown: String = body.chars().take(80).collect();
            let (kind, message) = (&answer["error"]["type"], &answer["error"]["message"]);
            assert!(kind.is_string() && message.is_string() && answer.as_object().unwrap().len() == 1, "{answer}");
            let _ = writeln!(
                said,
                "{path} {shown}\n    {status} {}: {}",
                kind.as_str().unwrap(),
                message.as_str().unwrap()
            );
        }
        for (method, path) in [("GET", "/Evaluate"), ("DELETE", "/Info"), ("GET", "/favicon.ico")] {
            let (status, answer) = read(&send(address, request(method, path, "").as_bytes()));
            let _ = writeln!(said, "{method} {path}\n    {status} {}", answer["error"]["message"].as_str().unwrap());
        }
    });
    insta::assert_snapshot!(said);
}

#[test]
fn what_is_no_request_is_refused_and_the_server_stays() {
    let headers: String = (0..100).map(|k| format!("X-{k}: 1\r\n")).collect();
    let broken = [
        (431, format!("GET /Info HTTP/1.1\r\nCookie: {}", "x".repeat(100_000))),
        (431, format!("GET /{} HTTP/1.1\r\n\r\n", "x".repeat(100_000))),
        (431, format!("GET /Info HTTP/1.1\r\n{headers}\r\n")),
        (413, "POST /Evaluate HTTP/1.1\r\nContent-Length: 10001\r\n\r\n".to_owned()),
        (413, format!("POST /Evaluate HTTP/1.1\r\nContent-Length: {}\r\n\r\n", "9".repeat(100))),
        (413, request("POST", "/Evaluate", &"x".repeat(1 << 20))),
        (400, "POST /Evaluate HTTP/1.1\r\nContent-Length: -5\r\n\r\n".to_owned()),
        (400, "POST /Evaluate HTTP/1.1\r\nContent-Length: 2, 2\r\n\r\n{}".to_owned()),
        (400, "POST /Evaluate HTTP/1.1\r\nContent-Length: 2\r\nContent-Length: 2\r\n\r\n{}".to_owned()),
        (411, "POST /Evaluate HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n".to_owned()),
        (400, "\u{16}\u{3}\u{1}\u{2}\0\u{1}\0\u{1}\r\n\r\n".to_owned()),
        (505, "GET / Info HTTP/1.1\r\n\r\n".to_owned()),
        (400, "GET /Info HTTP/1.1\r\nno colon\r\n\r\n".to_owned()),
        (505, "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n".to_owned()),
    ];
    serving(|address| {
        for (status, bytes) in &broken {
            let shown: String = bytes.chars().take(60).collect();
            let found = send(address, bytes.as_bytes());
            let (code, answer) = read(&found);
            assert_eq!((code, answer["error"]["type"].as_str()), (*status, Some("InvalidInput")), "{shown}: {found}");
            assert!(found.contains("Connection: close"), "{found}");
        }
        // Clients that go while they are asking.
        for bytes in ["", "POST /Eva", "POST /Evaluate HTTP/1.1\r\nContent-Length: 100\r\n\r\n{"] {
            assert_eq!(send(address, bytes.as_bytes()), "");
        }
        let bytes = [b"POST /Evaluate HTTP/1.1\r\nContent-Length: 2\r\n\r\n".as_slice(), &[0xff, 0xfe]].concat();
        assert_eq!(read(&send(address, &bytes)).0, 400);
        assert_eq!(asked(address, "/InputSizes", &json!({ "name": "max_re" })), json!({ "inputSizes": [2] }));
    });
}

/// Sends `start`, and then `piece` again and again, drop by drop: it is the whole that may take so long.
fn drip(address: SocketAddr, start: &str, piece: &str) {
    let mut stream = connect(address);
    stream.write_all(start.as_bytes()).unwrap();
    let begin = Instant::now();
    while begin.elapsed() < 2 * LIMITS.patience && stream.write_all(piece.as_bytes()).is_ok() {
        thread::sleep(LIMITS.patience / 8);
    }
    let mut found = [0; 12];
    stream.read_exact(&mut found).unwrap();
    assert_eq!(&found, b"HTTP/1.1 408");
}

/// Asks, and does not read: the answers fill what the system keeps for the client, and then nothing is taken any more.
fn ask_and_not_read(address: SocketAddr) {
    let mut deaf = connect(address);
    deaf.set_write_timeout(Some(4 * LIMITS.patience)).unwrap();
    let question = request("POST", "/ModelInfo", "{}").repeat(100);
    let begin = Instant::now();
    while deaf.write_all(question.as_bytes()).is_ok() {
        assert!(begin.elapsed() < Duration::from_secs(30), "it is served for ever");
    }
}

#[test]
fn slow_clients_are_ended() {
    serving(|address| {
        thread::scope(|scope| {
            scope.spawn(|| assert_eq!(rest(connect(address)), "", "who says nothing is told nothing"));
            scope.spawn(|| drip(address, "GET /In", "f"));
            scope.spawn(|| drip(address, "POST /Evaluate HTTP/1.1\r\nContent-Length: 99\r\n\r\n", " "));
            scope.spawn(|| ask_and_not_read(address));
        });
        assert_eq!(asked(address, "/InputSizes", &json!({ "name": "max_re" })), json!({ "inputSizes": [2] }));
    });
}

#[test]
fn a_connection_takes_many_requests() {
    let info = request("GET", "/Info", "");
    let close = info.replace("Host: h", "Connection: Close");
    let answered = serving(|address| {
        let found = send(address, format!("{info}{info}{close}{info}").as_bytes());
        assert_eq!(found.matches("HTTP/1.1 200 OK").count(), 3, "nothing is answered after the last: {found}");
        let found = send(address, info.replace("1.1", "1.0").repeat(2).as_bytes());
        assert_eq!(found.matches("HTTP/1.1 200 OK").count(), 1, "{found}");
        let found = send(address, info.replace("GET", "HEAD").as_bytes());
        assert!(found.ends_with("\r\n\r\n") && found.contains("Content-Length: 6"), "a head alone: {found}");
        let mut stream = connect(address);
        let asks =
            "POST /ModelInfo HTTP/1.1\r\nExpect: 100-continue\r\nContent-Length: 18\r\nConnection: close\r\n\r\n";
        stream.write_all(asks.as_bytes()).unwrap();
        let mut go_on = [0; 25];
        stream.read_exact(&mut go_on).unwrap();
        assert_eq!(&go_on, b"HTTP/1.1 100 Continue\r\n\r\n");
        stream.write_all(br#"{"name": "max_re"}"#).unwrap();
        assert_eq!(read(&rest(stream)).0, 200);
    });
    assert_eq!(answered, 6);
}

#[test]
fn more_clients_than_there_are_places_are_told_so() {
    let begin = Instant::now();
    serving(|address| {
        let info = request("GET", "/Info", "");
        let mut clients: Vec<TcpStream> = (0..LIMITS.connections).map(|_| connect(address)).collect();
        // All have their place once the last of them is answered.
        let last = clients.last_mut().unwrap();
        last.write_all(info.as_bytes()).unwrap();
        last.read_exact(&mut [0]).unwrap();
        for _ in 0..100 {
            let found = read(&rest(connect(address)));
            assert_eq!((found.0, found.1["error"]["type"].as_str()), (503, Some("ServerBusy")));
        }
        drop(clients);
        // Places are free again a moment later.
        while read(&send(address, info.as_bytes())).0 != 200 {
            assert!(begin.elapsed() < Duration::from_secs(10), "no place is free again");
        }
        // The server does not wait for clients that stay.
        let stay: Vec<TcpStream> = (0..4).map(|_| connect(address)).collect();
        std::mem::forget(stay);
    });
    assert!(begin.elapsed() < Duration::from_secs(10));
}
