//! The binary layout of format 1, read by hand: the layout is ours, not that of a serialisation crate.

use serde_json::{Map, Value, json};

/// Reads little-endian fields in the order in which format 1 lays them out.
struct Bytes {
    bytes: Vec<u8>,
    at: usize,
}

impl Bytes {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        self.at += N;
        self.bytes[self.at - N..self.at].try_into().unwrap()
    }
    fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }
    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }
    fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }
    fn float(&mut self) -> Value {
        json!(f64::from_le_bytes(self.take()))
    }
    fn text(&mut self) -> Value {
        let length = self.u64() as usize;
        self.at += length;
        json!(std::str::from_utf8(&self.bytes[self.at - length..self.at]).unwrap())
    }
    fn list(&mut self, item: impl Fn(&mut Self) -> Value) -> Value {
        (0..self.u64()).map(|_| item(self)).collect()
    }
    fn floats(&mut self) -> Value {
        self.list(Self::float)
    }
    fn option(&mut self, item: impl Fn(&mut Self) -> Value) -> Value {
        match self.take::<1>() {
            [0] => Value::Null,
            [1] => item(self),
            other => panic!("option tag {other:?}"),
        }
    }
    /// A kind: its number stands for one of `names`.
    fn kind(&mut self, names: &[&str]) -> Value {
        json!(names[self.u32() as usize])
    }
    fn fields(&mut self, fields: &[Field]) -> Value {
        let entries: Map<String, Value> = fields.iter().map(|(name, read)| ((*name).to_owned(), read(self))).collect();
        Value::Object(entries)
    }
    fn bounds(&mut self) -> Value {
        self.fields(&[("lower", &Self::float), ("upper", &Self::float)])
    }
    /// A kind with fields of its own, or with none.
    fn tagged(&mut self, kinds: &[(&str, &[Field])]) -> Value {
        match kinds[self.u32() as usize] {
            (name, []) => json!(name),
            (name, fields) => json!({ name: self.fields(fields) }),
        }
    }
}

type B = Bytes;

/// A field: its name and how to read it.
type Field<'a> = (&'a str, &'a dyn Fn(&mut B) -> Value);

fn u16_number(b: &mut B) -> Value {
    json!(b.u16())
}
fn u32_number(b: &mut B) -> Value {
    json!(b.u32())
}
fn u64_number(b: &mut B) -> Value {
    json!(b.u64())
}

fn meta(b: &mut B) -> Value {
    let names = ["tool_version", "study_name", "problem_hash", "study_hash", "content_id"];
    Value::Object(names.into_iter().map(|name| (name.to_owned(), b.text())).collect())
}

fn inputs(b: &mut B) -> Value {
    let interval: [Field; 2] = [("lower", &B::float), ("upper", &B::float)];
    let affine: [Field; 2] = [("center", &B::float), ("half_width", &B::float)];
    let pieces: [Field; 4] =
        [("origin", &B::float), ("scale", &B::float), ("breaks", &B::floats), ("coefficients", &|b| b.list(B::floats))];
    let parameter = |b: &mut B| b.fields(&[("name", &B::text), ("value", &B::float)]);
    let law: [Field; 2] = [("name", &B::text), ("parameters", &|b| b.list(parameter))];
    let correlation = |b: &mut B| b.fields(&[("first", &u32_number), ("second", &u32_number), ("value", &B::float)]);
    let copula: [Field; 1] = [("correlations", &|b| b.list(correlation))];
    let input = |b: &mut B| {
        b.fields(&[
            ("name", &B::text),
            ("distribution", &|b| b.tagged(&[("uniform", &interval), ("law", &law)])),
            ("transform", &|b| b.tagged(&[("affine", &affine), ("exponential", &affine), ("pieces", &pieces)])),
            ("family", &|b| b.kind(&["legendre", "hermite", "laguerre", "jacobi", "own"])),
            ("recurrence", &|b| b.fields(&[("diagonal", &B::floats), ("off_diagonal", &B::floats)])),
            ("bounds", &|b| b.option(B::bounds)),
        ])
    };
    let dependence: Field = ("dependence", &|b| b.tagged(&[("independent", &[]), ("gaussian_copula", &copula)]));
    b.fields(&[("inputs", &|b| b.list(input)), dependence])
}

/// Section 3 in version 2.
fn outputs_2(b: &mut B) -> Value {
    let output = |b: &mut B| {
        b.fields(&[
            ("kind", &|b| b.kind(&["eigenvalue", "cluster", "scalar", "closed"])),
            ("modes", &|b| b.list(u32_number)),
            ("reals", &|b| b.list(u32_number)),
            ("name", &B::text),
            ("unit", &B::text),
            ("components", &|b| b.list(component)),
        ])
    };
    b.fields(&[("outputs", &|b| b.list(output))])
}

fn component(b: &mut B) -> Value {
    b.fields(&[("id", &u32_number), ("name", &B::text), ("center", &B::float), ("scale", &B::float)])
}

fn outputs(b: &mut B) -> Value {
    let output = |b: &mut B| {
        b.fields(&[
            ("kind", &|b| b.kind(&["eigenvalue", "cluster", "scalar"])),
            ("modes", &|b| b.list(u32_number)),
            ("name", &B::text),
            ("unit", &B::text),
            ("components", &|b| b.list(component)),
        ])
    };
    b.fields(&[("outputs", &|b| b.list(output))])
}

fn elements(b: &mut B) -> Value {
    let side =
        |b: &mut B| b.fields(&[("bounds", &|b| b.option(B::bounds)), ("center", &B::float), ("half_width", &B::float)]);
    let element = |b: &mut B| b.fields(&[("weight", &B::float), ("sides", &|b| b.list(side))]);
    b.fields(&[("elements", &|b| b.list(element)), ("splits", &|b| b.list(|_| panic!("no splits in this file")))])
}

fn expansions(b: &mut B) -> Value {
    let expansion = |b: &mut B| {
        b.fields(&[
            ("element", &u32_number),
            ("component", &u32_number),
            ("index_set", &u32_number),
            ("coefficients", &B::floats),
            ("r2", &|b| b.option(B::float)),
            ("s2", &|b| b.option(B::float)),
            ("corrected_s2", &|b| b.option(B::float)),
            ("leave_out", &|b| b.kind(&["row", "run"])),
            ("degree", &u16_number),
            ("stop", &|b| b.kind(&["accurate", "highest_degree", "design_exhausted", "constant"])),
        ])
    };
    b.fields(&[("index_sets", &|b| b.list(|b| b.list(|b| b.list(u16_number)))), ("expansions", &|b| b.list(expansion))])
}

fn training(b: &mut B) -> Value {
    let value = |b: &mut B| match b.u32() {
        0 => json!({ "integer": b.u64() }),
        1 => json!({ "number": b.float() }),
        2 => json!({ "text": b.text() }),
        3 => json!({ "flag": b.take::<1>() == [1] }),
        other => panic!("setting of kind {other}"),
    };
    let counts = |b: &mut B| {
        let names = ["values", "gradients", "failed", "final_mesh", "direct_computations"];
        Value::Object(names.into_iter().map(|name| (name.to_owned(), json!(b.u64()))).collect())
    };
    b.fields(&[
        ("method", &B::text),
        ("settings", &|b| b.list(|b| b.fields(&[("key", &B::text), ("value", &value)]))),
        ("design", &B::text),
        ("seed", &u64_number),
        ("levels", &|b| b.list(u64_number)),
        ("counts", &counts),
    ])
}

fn decision(b: &mut B) -> Value {
    let quantile = |b: &mut B| b.fields(&[("level", &B::float), ("value", &B::float)]);
    b.fields(&[("max_re_residuals", &|b| b.list(quantile)), ("proportion_error", &|b| b.option(B::float))])
}

fn self_test(b: &mut B) -> Value {
    b.fields(&[
        ("points", &|b| b.list(B::floats)),
        ("components", &|b| b.list(B::floats)),
        ("max_re", &B::floats),
        ("tolerance", &B::float),
    ])
}

/// CRC-32 (IEEE 802.3), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
    })
}

fn verdict(b: &mut B) -> Value {
    let margin =
        |b: &mut B| b.fields(&[("kind", &|b| b.kind(&["growth_rate", "damping_ratio"])), ("value", &B::float)]);
    let band = |b: &mut B| {
        b.fields(&[("lower", &B::float), ("upper", &B::float), ("modes", &u32_number), ("reals", &u32_number)])
    };
    b.fields(&[
        ("rigid_body_modes", &u32_number),
        ("tolerance", &B::float),
        ("margin", &margin),
        ("band", &|b| b.option(band)),
        ("is_self_adjoint", &|b| json!(b.take::<1>() == [1])),
    ])
}

fn coverage(b: &mut B) -> Value {
    let runs = |b: &mut B| b.list(|b| b.list(B::float));
    b.fields(&[("answered", &runs), ("unanswered", &runs)])
}

fn descriptions(b: &mut B) -> Value {
    let input = |b: &mut B| b.fields(&[("unit", &|b| b.option(B::text)), ("label", &|b| b.option(B::text))]);
    b.fields(&[("inputs", &|b| b.list(input))])
}

fn domain(b: &mut B) -> Value {
    let interval = |b: &mut B| b.fields(&[("lower", &B::float), ("upper", &B::float)]);
    b.fields(&[("inputs", &|b| b.list(|b| b.option(interval)))])
}

fn left_out(b: &mut B) -> Value {
    b.fields(&[("runs", &|b| b.list(|b| b.list(B::float)))])
}

/// Fields of a certificate in section 9, version 1.
const CERTIFICATE: [Field; 9] = [
    ("seed", &u64_number),
    ("samples", &u64_number),
    ("scheme", &B::text),
    ("falsely_stable", &u64_number),
    ("falsely_unstable", &u64_number),
    ("level", &B::float),
    ("lower", &B::float),
    ("upper", &B::float),
    ("problem_hash", &B::text),
];

fn certificates(b: &mut B) -> Value {
    b.fields(&[("certificates", &|b| b.list(|b| b.fields(&CERTIFICATE)))])
}

/// Section 9 in version 2.
fn certificates_2(b: &mut B) -> Value {
    let bounds: [Field; 5] = [
        ("falsely_marginal", &u64_number),
        ("marginal_lower", &B::float),
        ("marginal_upper", &B::float),
        ("unstable_lower", &B::float),
        ("unstable_upper", &B::float),
    ];
    let more: [Field; 3] = [
        ("marginal", &|b| b.option(|b| b.fields(&bounds))),
        ("failed", &u64_number),
        ("strata", &|b| b.option(strata)),
    ];
    let certificate = |b: &mut B| {
        let mut all = b.fields(&CERTIFICATE);
        let Value::Object(added) = b.fields(&more) else { panic!("an object") };
        all.as_object_mut().unwrap().extend(added);
        all
    };
    b.fields(&[("certificates", &|b| b.list(certificate))])
}

fn strata(b: &mut B) -> Value {
    let runs = |b: &mut B| b.fields(&[("runs", &u64_number), ("rare", &u64_number), ("failed", &u64_number)]);
    let tail = |b: &mut B| b.fields(&[("error", &B::float), ("runs", &u64_number), ("twice", &u64_number)]);
    let reasons = ["failed_runs", "marginal", "no_runs", "rare_far_away", "no_thinning"];
    let assumed = |b: &mut B| match b.u32() {
        0 => json!({ "upper": b.float() }),
        1 => json!({ "withheld": b.kind(&reasons) }),
        other => panic!("kind {other}"),
    };
    b.fields(&[
        ("side_level", &B::float),
        ("rare_side", &|b| b.kind(&["stable", "not_stable"])),
        ("rare_lower", &B::float),
        ("rare_upper", &B::float),
        ("surrogate_samples", &u64_number),
        ("surrogate_rare", &u64_number),
        ("surrogate_layer", &u64_number),
        ("layer_depth", &B::float),
        ("outside", &runs),
        ("layer", &runs),
        ("inside", &runs),
        ("far_runs", &u64_number),
        ("largest_error", &B::float),
        ("thinning", &|b| b.list(tail)),
        ("assumed", &assumed),
    ])
}

/// The document that a file holds, read by hand.
fn document(file: &[u8]) -> Value {
    let mut b = Bytes { bytes: file.to_vec(), at: 0 };
    assert_eq!(b.take::<8>(), [0x89, b'P', b'C', b'C', 0x0D, 0x0A, 0x1A, 0x0A]);
    let mut document = json!({ "format": { "major": b.u16(), "minor": b.u16() } });
    assert_eq!(b.u32(), 1, "codec");
    assert_eq!(b.u64() as usize, file.len() - b.at - 4, "length of what follows, without the CRC");
    let sections: [Field; 14] = [
        ("meta", &meta),
        ("inputs", &inputs),
        ("outputs", &outputs),
        ("elements", &elements),
        ("expansions", &expansions),
        ("training", &training),
        ("decision", &decision),
        ("self_test", &self_test),
        ("certificates", &certificates),
        ("verdict", &verdict),
        ("coverage", &coverage),
        ("descriptions", &descriptions),
        ("domain", &domain),
        ("left_out", &left_out),
    ];
    for (kind, (name, read)) in (1..=14).zip(sections) {
        let is_next = b.at < file.len() - 4 && u16::from_le_bytes([file[b.at], file[b.at + 1]]) == kind;
        if kind > 8 && !is_next {
            continue;
        }
        let header = [b.u16(), b.u16(), b.u16(), b.u16()];
        let version = header[1];
        assert_eq!(header, [kind, version, u16::from(kind < 11 && kind != 9), 0], "header of {name}");
        let length = b.u64() as usize;
        let before = b.at;
        document[name] = match (name, version) {
            ("outputs", 2) => outputs_2(&mut b),
            ("certificates", 2) => certificates_2(&mut b),
            (_, 1) => read(&mut b),
            _ => panic!("{name} has version {version}"),
        };
        assert_eq!(b.at - before, length, "length of {name}");
    }
    assert_eq!(b.u32(), crc32(&file[..file.len() - 4]));
    assert_eq!(b.at, file.len(), "no trailing bytes");
    document
}

#[test]
fn a_reader_written_from_the_layout_alone_finds_what_json_says() {
    let file = std::fs::read(crate::support::repository("tests/data/golden.v1.pcc")).unwrap();
    let expected: Value = serde_json::from_str(&crate::support::text("tests/data/golden.v1.json")).unwrap();
    assert_eq!(document(&file), expected);
}

#[test]
fn it_reads_groups_that_are_closed_under_conjugation() {
    use pcc_evaluate::artifact::{Format, encode};
    let surrogate = crate::field::built("bike");
    let json: Value = serde_json::from_slice(&encode(&surrogate, Format::Json).unwrap()).unwrap();
    let found = document(&encode(&surrogate, Format::Binary).unwrap());
    assert_eq!(found, json);
    assert_eq!(found["format"]["minor"], 3);
    assert!(found["outputs"]["outputs"].as_array().unwrap().iter().any(|output| output["kind"] == "closed"));
}

#[test]
fn it_reads_what_the_verdict_rests_on() {
    use pcc_evaluate::artifact::{Format, encode};
    let surrogate = crate::field::built("driveline");
    let json: Value = serde_json::from_slice(&encode(&surrogate, Format::Json).unwrap()).unwrap();
    let found = document(&encode(&surrogate, Format::Binary).unwrap());
    assert_eq!(found, json);
    assert_eq!(found["verdict"]["rigid_body_modes"], 1);
}

#[test]
fn it_reads_where_the_model_did_not_answer() {
    use pcc_evaluate::artifact::{Format, encode};
    let surrogate = crate::coverage::built(1);
    let json: Value = serde_json::from_slice(&encode(&surrogate, Format::Json).unwrap()).unwrap();
    let found = document(&encode(&surrogate, Format::Binary).unwrap());
    assert_eq!(found, json);
    assert_eq!(found["coverage"]["unanswered"][0].as_array().unwrap().len(), 2);
}

#[test]
fn it_reads_what_was_missed_at_runs_left_out() {
    use pcc_evaluate::artifact::{Format, encode};
    let surrogate = crate::support::built("clutch-r2");
    let json: Value = serde_json::from_slice(&encode(surrogate, Format::Json).unwrap()).unwrap();
    let found = document(&encode(surrogate, Format::Binary).unwrap());
    assert_eq!(found, json);
    let runs = found["left_out"]["runs"].as_array().unwrap();
    assert_eq!(runs.len() as u64, surrogate.training.counts.values);
    assert_eq!(runs[0].as_array().unwrap().len(), surrogate.component_count());
}

#[test]
fn it_reads_units_and_labels() {
    use pcc_evaluate::artifact::{Format, encode};
    let surrogate = crate::described::surrogate();
    let json: Value = serde_json::from_slice(&encode(&surrogate, Format::Json).unwrap()).unwrap();
    let found = document(&encode(&surrogate, Format::Binary).unwrap());
    assert_eq!(found, json);
    let expected = json!([
        { "unit": null, "label": "friction coefficient" },
        { "unit": "N/m", "label": "contact stiffness" },
    ]);
    assert_eq!(found["descriptions"]["inputs"], expected);
}

/// Of independent points, in version 1, and with strata and marginal points, in version 2.
#[test]
fn it_reads_certificates_of_both_versions() {
    use pcc_compile::reference::certify_with_model;
    use pcc_evaluate::artifact::{Format, decode, encode};
    use pcc_evaluate::foundation::Silent;
    let study = crate::support::invariants_study(2);
    let mut surrogate = crate::support::built("clutch-r2").clone();
    surrogate.left_out = None;
    let made = certify_with_model(&surrogate, &study, 30, 1, 0.95, &Silent).unwrap();
    let independent = pcc_evaluate::surrogate::Certificate { strata: None, ..made.clone() };
    let bounds =
        pcc_evaluate::surrogate::MarginalBounds { falsely_marginal: 1, marginal: [0.0, 0.125], unstable: [0.5, 0.875] };
    let mut withheld = pcc_evaluate::surrogate::Certificate { marginal: Some(bounds), ..made.clone() };
    withheld.strata.as_mut().unwrap().if_errors_fall_off.bound =
        pcc_evaluate::surrogate::AssumedBound::Withheld(pcc_evaluate::surrogate::Withheld::Marginal);
    for (certificates, minor) in [(vec![independent.clone()], 1), (vec![independent, made, withheld], 3)] {
        surrogate.certificates = certificates;
        let bytes = encode(&surrogate, Format::Binary).unwrap();
        let found = document(&bytes);
        let json: Value = serde_json::from_slice(&encode(&surrogate, Format::Json).unwrap()).unwrap();
        assert_eq!(found, json);
        assert_eq!(found["format"]["minor"], minor);
        assert_eq!(decode(&bytes).unwrap().surrogate, surrogate);
    }
}

#[test]
fn it_reads_laws_and_dependence() {
    use pcc_evaluate::artifact::{Format, encode};
    let surrogate = crate::dependence::surrogate();
    let json: Value = serde_json::from_slice(&encode(&surrogate, Format::Json).unwrap()).unwrap();
    let found = document(&encode(&surrogate, Format::Binary).unwrap());
    assert_eq!(found, json);
    assert_eq!(found["inputs"]["inputs"][0]["distribution"]["law"]["name"], "normal");
    let expected = json!({ "gaussian_copula": { "correlations": [{ "first": 0, "second": 1, "value": 0.6 }] } });
    assert_eq!(found["inputs"]["dependence"], expected);
}

#[test]
fn it_reads_laws_and_where_the_model_was_run() {
    use pcc_evaluate::artifact::{Format, encode};
    let surrogate = crate::laws::built();
    let json: Value = serde_json::from_slice(&encode(&surrogate, Format::Json).unwrap()).unwrap();
    let found = document(&encode(&surrogate, Format::Binary).unwrap());
    assert_eq!(found, json);
    let sides = found["domain"]["inputs"].as_array().unwrap();
    assert!(sides[0].is_null() && sides[1]["lower"].as_f64().unwrap() < -1.0, "{sides:?}");
}

#[test]
fn golden_files_are_still_read_and_written_byte_for_byte() {
    use pcc_evaluate::artifact::{Format, decode, encode};
    for (name, format) in [("golden.v1.pcc", Format::Binary), ("golden.v1.json", Format::Json)] {
        let bytes = std::fs::read(crate::support::repository(&format!("tests/data/{name}"))).unwrap();
        let artifact = decode(&bytes).unwrap();
        assert_eq!(artifact.version, (1, 0));
        assert_eq!(encode(&artifact.surrogate, format).unwrap(), bytes);
    }
}
