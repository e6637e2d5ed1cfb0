//! One test per way a file can be wrong, in the order in which readers find them.

use super::certificates::AnyCertificates;
use super::error::{ReadError, WriteError};
use super::{Format, binary, container, decode, encode, from_v1, json, to_v1, v1, v2};
use crate::components::{Margin, OutputKind};
use crate::surrogate::{Band, Certificate, MarginalBounds, Surrogate, VerdictBasis};
use proptest::prelude::*;
use std::sync::LazyLock;

mod certificates;
mod dependence;
mod descriptions;
mod domain;
mod left_out;

/// Bytes before the first section, and those of a section's header.
const HEADER: usize = 24;
const SECTION_HEADER: usize = 16;

/// As format 1.0 has it, without what it missed at runs left out.
static SURROGATE: LazyLock<Surrogate> = LazyLock::new(|| {
    let file = decode(include_bytes!("../../../../surrogates/clutch-r2-eigenvalues.pcc")).unwrap();
    Surrogate { left_out: None, ..file.surrogate }
});
static BYTES: LazyLock<Vec<u8>> = LazyLock::new(|| encode(&SURROGATE, Format::Binary).unwrap());

/// The bytes with a change, length field and checksum made to match.
fn forged(change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = BYTES.clone();
    bytes.truncate(bytes.len() - 4);
    change(&mut bytes);
    let length = (bytes.len() - HEADER) as u64;
    bytes[16..24].copy_from_slice(&length.to_le_bytes());
    let checksum = crc32fast::hash(&bytes);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

/// The same surrogate with its two outputs as closed groups: of one mode, and of two real eigenvalues.
static CLOSED: LazyLock<Surrogate> = LazyLock::new(|| {
    let mut surrogate = SURROGATE.clone();
    surrogate.outputs.iter_mut().for_each(|output| output.kind = OutputKind::Closed);
    surrogate.outputs[1].modes.clear();
    surrogate.outputs[1].reals = vec![1, 2];
    surrogate.self_test = surrogate.make_self_test(surrogate.self_test.points.clone());
    surrogate
});

/// What reading finds in a document with a change and a content id that matches it.
fn meaning(change: impl FnOnce(&mut v1::Document)) -> ReadError {
    meaning_of(&SURROGATE, change)
}

fn meaning_of(surrogate: &Surrogate, change: impl FnOnce(&mut v1::Document)) -> ReadError {
    let mut document = to_v1::document(surrogate).unwrap();
    change(&mut document);
    document.meta.content_id = binary::content_id(&document).unwrap();
    let by_binary = decode(&container::encode(&document).unwrap()).unwrap_err();
    let by_json = decode(&json::encode(&document).unwrap()).unwrap_err();
    let has_infinity = matches!(&by_binary, ReadError::Meaning { message, .. } if message.contains("not finite"));
    assert!(by_binary == by_json || has_infinity, "{by_binary} but {by_json}");
    by_binary
}

fn section_of(error: ReadError) -> &'static str {
    match error {
        ReadError::Meaning { section, .. } => section,
        other => panic!("{other}"),
    }
}

fn section(kind: u16, flags: u16, body: &[u8]) -> Vec<u8> {
    let mut bytes: Vec<u8> = [kind, 1, flags, 0].iter().flat_map(|field| field.to_le_bytes()).collect();
    bytes.extend((body.len() as u64).to_le_bytes());
    bytes.extend(body);
    bytes
}

#[test]
fn too_short() {
    assert_eq!(decode(&BYTES[..20]), Err(ReadError::TooShort { length: 20, smallest: 28 }));
}

#[test]
fn not_a_surrogate() {
    for other in [&b""[..], b"study", b"\x89PNG\r\n\x1a\n and a picture of some size", &[0; 100]] {
        assert_eq!(decode(other), Err(ReadError::NotASurrogate));
    }
}

#[test]
fn every_truncation_is_noticed() {
    for length in 0..BYTES.len() {
        assert!(decode(&BYTES[..length]).is_err(), "cut to {length} bytes");
    }
    let cut = &BYTES[..BYTES.len() - 1];
    let (found, announced) = (cut.len() as u64, BYTES.len() as u64);
    assert_eq!(decode(cut), Err(ReadError::Length { found, announced }));
}

#[test]
fn trailing_bytes_are_noticed() {
    let mut longer = BYTES.clone();
    longer.push(0);
    assert!(matches!(decode(&longer), Err(ReadError::Length { .. })));
}

#[test]
fn future_major_version() {
    let bytes = forged(|bytes| bytes[8] = 2);
    assert_eq!(decode(&bytes), Err(ReadError::Version { major: 2, minor: 0 }));
    let text = String::from_utf8(encode(&SURROGATE, Format::Json).unwrap()).unwrap();
    let later = text.replacen("\"major\":1", "\"major\":2", 1);
    assert_eq!(decode(later.as_bytes()), Err(ReadError::Version { major: 2, minor: 0 }));
}

#[test]
fn future_minor_version_with_known_content_is_read() {
    let bytes = forged(|bytes| bytes[10] = 7);
    assert_eq!(decode(&bytes).unwrap().version, (1, 7));
}

#[test]
fn unknown_codec() {
    assert_eq!(decode(&forged(|bytes| bytes[12] = 9)), Err(ReadError::Codec { codec: 9 }));
}

#[test]
fn every_flipped_bit_is_noticed() {
    for position in 0..BYTES.len() {
        let mut flipped = BYTES.clone();
        flipped[position] ^= 1 << (position % 8);
        assert!(decode(&flipped).is_err(), "bit {} of byte {position}", position % 8);
    }
    let mut flipped = BYTES.clone();
    flipped[BYTES.len() / 2] ^= 1;
    assert_eq!(decode(&flipped), Err(ReadError::Checksum));
}

#[test]
fn damaged_section_table() {
    let out_of_order = forged(|bytes| bytes[HEADER] = 2);
    let reserved = forged(|bytes| bytes[HEADER + 6] = 1);
    let flags = forged(|bytes| bytes[HEADER + 4] = 2);
    let beyond_the_end = forged(|bytes| bytes[HEADER + 15] = 0xFF);
    let half_a_header = forged(|bytes| bytes.extend([10, 0, 1]));
    let twice = forged(|bytes| bytes.extend(section(8, 1, &[])));
    for bytes in [out_of_order, reserved, flags, beyond_the_end, half_a_header, twice] {
        let error = decode(&bytes).unwrap_err();
        assert!(matches!(error, ReadError::SectionTable(_)), "{error}");
    }
}

#[test]
fn unknown_required_sections_are_refused_and_optional_ones_skipped() {
    let required = forged(|bytes| bytes.extend(section(40, 1, b"?")));
    let error = ReadError::UnknownSection { kind: 40, version: 1, major: 1, minor: 0 };
    assert_eq!(decode(&required), Err(error));
    let optional = decode(&forged(|bytes| bytes.extend(section(40, 0, b"?")))).unwrap();
    assert_eq!(optional.unknown_sections, [40]);
    assert_eq!(optional.surrogate, *SURROGATE);
}

#[test]
fn newer_section_version_is_refused_by_name() {
    let error = decode(&forged(|bytes| bytes[HEADER + 2] = 2)).unwrap_err();
    assert_eq!(error, ReadError::UnknownSection { kind: 1, version: 2, major: 1, minor: 0 });
}

#[test]
fn missing_section() {
    let empty = forged(|bytes| bytes.truncate(HEADER));
    assert_eq!(decode(&empty), Err(ReadError::MissingSection { section: "meta" }));
}

#[test]
fn undecodable_and_overlong_sections() {
    let only_meta = |body: &[u8]| {
        forged(|bytes| {
            bytes.truncate(HEADER);
            bytes.extend(section(1, 1, body));
        })
    };
    let forged_length = only_meta(&[0xFF; SECTION_HEADER]);
    assert!(matches!(decode(&forged_length), Err(ReadError::Decode { section: "meta", .. })));
    let empty_texts_and_more = only_meta(&[0; 5 * 8 + 3]);
    assert_eq!(decode(&empty_texts_and_more), Err(ReadError::TrailingBytes { section: "meta", bytes: 3 }));
}

#[test]
fn json_of_something_else() {
    for other in ["{", "{}", "{\"format\": 1}", "{\"format\": {\"major\": 1, \"minor\": 0}}", " \n {\"a\": []}"] {
        let error = decode(other.as_bytes()).unwrap_err();
        assert!(matches!(error, ReadError::Json { .. }), "{error}");
    }
}

#[test]
fn json_with_unknown_keys_is_refused() {
    let text = String::from_utf8(encode(&SURROGATE, Format::Json).unwrap()).unwrap();
    let extended = text.replacen("\"meta\":{", "\"meta\":{\"surprise\":1,", 1);
    let error = decode(extended.as_bytes()).unwrap_err();
    assert!(error.to_string().contains("unknown field `surprise`"), "{error}");
}

#[test]
fn edited_content_does_not_match_its_id() {
    let text = String::from_utf8(encode(&SURROGATE, Format::Json).unwrap()).unwrap();
    let edited = text.replacen("\"lower\":0.0,\"upper\":0.5", "\"lower\":0.0,\"upper\":0.6", 1);
    assert_ne!(edited, text);
    assert_eq!(decode(edited.as_bytes()), Err(ReadError::ContentId));
}

#[test]
fn numbers_that_are_not_finite_are_neither_written_nor_read() {
    let mut surrogate = SURROGATE.clone();
    surrogate.expansions[0].coefficients[0] = f64::NAN;
    for format in [Format::Binary, Format::Json] {
        assert_eq!(encode(&surrogate, format), Err(WriteError::NotFinite { section: "expansions" }));
    }
    let infinite = |d: &mut v1::Document| d.expansions.expansions[0].coefficients[0] = f64::INFINITY;
    assert_eq!(section_of(meaning(infinite)), "expansions");
}

#[test]
fn inputs_that_make_no_sense() {
    assert_eq!(section_of(meaning(|d| d.inputs.inputs[1].name = "mu".into())), "inputs");
    assert_eq!(section_of(meaning(|d| d.inputs.inputs[0].name = String::new())), "inputs");
    assert_eq!(section_of(meaning(|d| d.inputs.inputs[0].recurrence.off_diagonal[0] = 1.0)), "inputs");
    let short = |d: &mut v1::Document| {
        d.inputs.inputs[0].recurrence.diagonal.clear();
        d.inputs.inputs[0].recurrence.off_diagonal.clear();
    };
    assert_eq!(section_of(meaning(short)), "inputs");
    let inverted =
        |d: &mut v1::Document| d.inputs.inputs[0].distribution = v1::Distribution::Uniform { lower: 1.0, upper: 0.0 };
    assert_eq!(section_of(meaning(inverted)), "inputs");
    let shifted =
        |d: &mut v1::Document| d.inputs.inputs[0].transform = v1::Transform::Affine { center: 0.3, half_width: 0.25 };
    assert_eq!(section_of(meaning(shifted)), "inputs");
}

#[test]
fn outputs_that_make_no_sense() {
    let of_v1 = |change: fn(&mut Vec<v1::Output>)| {
        let error = meaning(|d| match &mut d.outputs {
            v2::AnyOutputs::V1(section) => change(&mut section.outputs),
            v2::AnyOutputs::V2(_) => panic!("not needed"),
        });
        assert_eq!(section_of(error), "outputs");
    };
    of_v1(|outputs| outputs[0].components[0].id = 9);
    of_v1(|outputs| outputs[0].components[0].scale = 0.0);
    of_v1(|outputs| outputs[0].modes = vec![4]);
    of_v1(|outputs| outputs[0].modes.clear());
    of_v1(|outputs| outputs.clear());
    of_v1(|outputs| outputs[0].kind = v1::OutputKind::Cluster);
}

#[test]
fn closed_outputs_that_make_no_sense() {
    let of_v2 = |change: fn(&mut Vec<v2::Output>)| {
        let error = meaning_of(&CLOSED, |d| match &mut d.outputs {
            v2::AnyOutputs::V1(_) => panic!("they need version 2"),
            v2::AnyOutputs::V2(section) => change(&mut section.outputs),
        });
        assert_eq!(section_of(error), "outputs");
    };
    of_v2(|outputs| outputs[0].modes.push(7));
    of_v2(|outputs| outputs[0].modes = vec![0]);
    of_v2(|outputs| outputs[0].reals.push(3));
    of_v2(|outputs| outputs[1].reals = vec![1, 1]);
    of_v2(|outputs| outputs[1].reals = vec![0, 1]);
    of_v2(|outputs| outputs[1].reals = vec![1]);
    of_v2(|outputs| outputs[1].kind = v2::OutputKind::Cluster);
    of_v2(|outputs| outputs[0].components[1].scale = 0.0);
    of_v2(|outputs| outputs[1].components[0].id = 0);
    of_v2(|outputs| {
        // More eigenvalues than a closed group may have.
        let more = |id: u32| v1::Component { id, ..outputs[1].components[0].clone() };
        let extended: Vec<v1::Component> = (2..11).map(more).collect();
        (outputs[1].components, outputs[1].reals) = (extended, (1..=9).collect());
    });
    of_v2(|outputs| {
        // Nothing that needs version 2.
        outputs.iter_mut().for_each(|output| output.kind = v2::OutputKind::Eigenvalue);
        outputs[1].modes = vec![9];
        outputs[1].reals.clear();
    });
}

#[test]
fn closed_outputs_come_back_in_both_forms() {
    for format in [Format::Binary, Format::Json] {
        let bytes = encode(&CLOSED, format).unwrap();
        let artifact = decode(&bytes).unwrap();
        assert!(artifact.surrogate == *CLOSED && artifact.is_canonical && artifact.version == (1, 3));
        assert_eq!(encode(&artifact.surrogate, format).unwrap(), bytes);
    }
}

/// What a verdict can rest on.
static JUDGED: LazyLock<[Surrogate; 4]> = LazyLock::new(|| {
    let band = Band { lower: 0.0, upper: 500.0, modes: 6, reals: 1 };
    let bases = [
        VerdictBasis { rigid_body_modes: 2, ..VerdictBasis::default() },
        VerdictBasis { margin: Margin::GrowthRate(0.5), tolerance: 1e-9, ..VerdictBasis::default() },
        VerdictBasis { margin: Margin::DampingRatio(0.01), band: Some(band), ..VerdictBasis::default() },
        VerdictBasis { is_self_adjoint: true, ..VerdictBasis::default() },
    ];
    bases.map(|verdict| Surrogate { verdict, ..SURROGATE.clone() })
});

#[test]
fn the_basis_of_the_verdict_comes_back_in_both_forms_and_belongs_to_the_content() {
    for (surrogate, format) in JUDGED.iter().flat_map(|one| [Format::Binary, Format::Json].map(|format| (one, format)))
    {
        let bytes = encode(surrogate, format).unwrap();
        let artifact = decode(&bytes).unwrap();
        assert!(artifact.surrogate == *surrogate && artifact.is_canonical && artifact.version == (1, 3));
        assert_eq!(encode(&artifact.surrogate, format).unwrap(), bytes);
        assert_ne!(artifact.content_id, decode(&BYTES).unwrap().content_id);
    }
}

#[test]
fn verdicts_that_make_no_sense() {
    use v2::MarginKind::{DampingRatio, GrowthRate};
    let margin = |kind, value| v2::Margin { kind, value };
    let nothing = v2::Verdict {
        rigid_body_modes: 0,
        tolerance: 0.0,
        margin: margin(GrowthRate, 0.0),
        band: None,
        is_self_adjoint: false,
    };
    let band = |lower, upper| Some(v2::Band { lower, upper, modes: 4, reals: 0 });
    let senseless = [
        nothing,
        v2::Verdict { margin: margin(GrowthRate, -1.0), ..nothing },
        v2::Verdict { margin: margin(DampingRatio, 0.0), ..nothing },
        v2::Verdict { margin: margin(DampingRatio, 1.0), ..nothing },
        v2::Verdict { tolerance: -1e-9, ..nothing },
        v2::Verdict { band: band(2.0, 1.0), ..nothing },
        v2::Verdict { band: band(-2.0, 1.0), ..nothing },
    ];
    for verdict in senseless {
        assert_eq!(section_of(meaning(|d| d.verdict = Some(verdict))), "verdict", "{verdict:?}");
    }
    // Two rigid-body modes, no tolerance, no margin, no band, not symmetric.
    let body = [2u32.to_le_bytes().as_slice(), &[0; 8], &[0; 4], &[0; 8], &[0], &[0]].concat();
    // Readers must understand it: it cannot be optional, nor of a later version, nor of another length.
    let optional = forged(|bytes| bytes.extend(section(10, 0, &body)));
    assert!(matches!(decode(&optional), Err(ReadError::SectionTable(_))));
    let later = forged(|bytes| {
        let mut later = section(10, 1, &body);
        later[2] = 2;
        bytes.extend(later);
    });
    assert!(matches!(decode(&later), Err(ReadError::UnknownSection { kind: 10, version: 2, .. })));
    let long = forged(|bytes| bytes.extend(section(10, 1, &[0; 27])));
    assert_eq!(decode(&long), Err(ReadError::TrailingBytes { section: "verdict", bytes: 1 }));
    let short = forged(|bytes| bytes.extend(section(10, 1, &[0; 25])));
    assert!(matches!(decode(&short), Err(ReadError::Decode { section: "verdict", .. })));
    let added = forged(|bytes| bytes.extend(section(10, 1, &body)));
    assert_eq!(decode(&added), Err(ReadError::ContentId));
}

#[test]
fn real_eigenvalues_are_there_for_all_outputs_or_for_none() {
    let text = String::from_utf8(encode(&CLOSED, Format::Json).unwrap()).unwrap();
    for forged in [text.replacen(",\"reals\":[]", "", 1), text.replacen(",\"reals\":[1,2]", "", 1)] {
        assert_ne!(forged, text);
        let error = decode(forged.as_bytes()).unwrap_err();
        assert!(matches!(&error, ReadError::Json { message, .. } if message.contains("reals")), "{error}");
    }
    let plain = String::from_utf8(encode(&SURROGATE, Format::Json).unwrap()).unwrap();
    let forged = plain.replacen("\"kind\":\"eigenvalue\"", "\"kind\":\"closed\"", 1);
    assert!(matches!(decode(forged.as_bytes()), Err(ReadError::Json { .. })));
}

#[test]
fn kinds_of_later_versions_are_named() {
    let scalar = meaning(|d| match &mut d.outputs {
        v2::AnyOutputs::V1(section) => section.outputs[0].kind = v1::OutputKind::Scalar,
        v2::AnyOutputs::V2(_) => panic!("not needed"),
    });
    assert!(matches!(scalar, ReadError::Unsupported { .. }), "{scalar}");
}

#[test]
fn elements_that_make_no_sense() {
    let side = |change: fn(&mut v1::Side)| section_of(meaning(|d| change(&mut d.elements.elements[0].sides[1])));
    assert_eq!(side(|side| side.bounds = None), "elements");
    assert_eq!(side(|side| side.center = 0.5), "elements");
    assert_eq!(side(|side| side.half_width = 2.0), "elements");
    assert_eq!(side(|side| side.bounds = Some(v1::Bounds { lower: 1.0, upper: -1.0 })), "elements");
    assert_eq!(section_of(meaning(|d| d.elements.elements[0].weight = 0.5)), "elements");
    assert_eq!(section_of(meaning(|d| d.elements.elements[0].sides.truncate(1))), "elements");
    assert_eq!(section_of(meaning(|d| d.elements.elements.clear())), "elements");
    assert_eq!(section_of(meaning(|d| d.elements.elements.push(d.elements.elements[0].clone()))), "elements");
    let (below, above) = (v1::Branch::Element(0), v1::Branch::Split(0));
    let split = v1::Split { input: 0, at: 0.0, below, above };
    assert_eq!(section_of(meaning(|d| d.elements.splits.push(split))), "elements");
}

#[test]
fn expansions_that_make_no_sense() {
    assert_eq!(section_of(meaning(|d| d.expansions.index_sets[0].swap(0, 1))), "expansions");
    assert_eq!(section_of(meaning(|d| d.expansions.index_sets[0][1].push(0))), "expansions");
    assert_eq!(section_of(meaning(|d| d.expansions.index_sets[0][1][0] = 2000)), "expansions");
    assert_eq!(section_of(meaning(|d| d.expansions.expansions[0].index_set = 99)), "expansions");
    assert_eq!(section_of(meaning(|d| d.expansions.expansions[0].component = 1)), "expansions");
    assert_eq!(section_of(meaning(|d| d.expansions.expansions[0].element = 1)), "expansions");
    assert_eq!(section_of(meaning(|d| d.expansions.expansions[0].r2 = Some(1.5))), "expansions");
    let short = |d: &mut v1::Document| {
        d.expansions.expansions[0].coefficients.pop();
    };
    assert_eq!(section_of(meaning(short)), "expansions");
}

#[test]
fn histories_that_make_no_sense() {
    assert_eq!(section_of(meaning(|d| d.meta.problem_hash = "none".into())), "meta");
    assert_eq!(section_of(meaning(|d| d.training.levels = vec![60, 60])), "training");
    assert_eq!(section_of(meaning(|d| d.training.counts.failed = u64::MAX)), "training");
    assert_eq!(section_of(meaning(|d| d.decision.max_re_residuals[0].level = 2.0)), "decision");
    assert_eq!(section_of(meaning(|d| d.decision.proportion_error = Some(-1.0))), "decision");
    assert_eq!(section_of(meaning(|d| d.self_test.tolerance = 0.0)), "self_test");
    assert_eq!(section_of(meaning(|d| d.self_test.points[0].push(0.0))), "self_test");
    let empty = AnyCertificates::V1(v1::Certificates { certificates: Vec::new() });
    assert_eq!(section_of(meaning(|d| d.certificates = Some(empty))), "certificates");
}

#[test]
fn certificates_survive_and_stay_outside_the_content_id() {
    let mut certified = SURROGATE.clone();
    certified.certificates.push(Certificate {
        seed: 7,
        samples: 300,
        scheme: "simple".to_owned(),
        falsely_stable: 2,
        falsely_unstable: 1,
        failed: 0,
        level: 0.95,
        lower: 0.18,
        upper: 0.22,
        marginal: None,
        strata: None,
        problem_hash: SURROGATE.provenance.problem_hash.clone(),
    });
    let bounds = MarginalBounds { falsely_marginal: 1, marginal: [0.1, 0.2], unstable: [0.5, 0.75] };
    let of_all_shares = Certificate { marginal: Some(bounds), ..certified.certificates[0].clone() };
    let both = Surrogate { certificates: vec![certified.certificates[0].clone(), of_all_shares], ..certified.clone() };
    for format in [Format::Binary, Format::Json] {
        let artifact = decode(&encode(&certified, format).unwrap()).unwrap();
        assert_eq!(artifact.surrogate, certified);
        assert_eq!(artifact.content_id, decode(&BYTES).unwrap().content_id);
        let artifact = decode(&encode(&both, format).unwrap()).unwrap();
        assert!(artifact.surrogate == both && artifact.is_canonical && artifact.version == (1, 3));
        let mut wrong = both.clone();
        wrong.certificates[1].marginal = Some(MarginalBounds { unstable: [0.75, 0.5], ..bounds });
        assert_eq!(section_of(decode(&encode(&wrong, format).unwrap()).unwrap_err()), "certificates");
        certified.certificates[0].upper = 2.0;
        assert_eq!(section_of(decode(&encode(&certified, format).unwrap()).unwrap_err()), "certificates");
        certified.certificates[0].upper = 0.22;
    }
}

proptest! {
    /// Damage that a forged checksum hides ends in an error or a sensible surrogate, never in a panic.
    #[test]
    fn forged_bytes_never_panic(changes in prop::collection::vec((HEADER..BYTES.len() - 4, any::<u8>()), 1..8)) {
        let bytes = forged(|bytes| changes.iter().for_each(|&(position, value)| bytes[position] = value));
        if let Ok(artifact) = decode(&bytes) {
            prop_assert_eq!(artifact.surrogate.expansions.len(), 4);
        }
    }

    /// The same for sections whose content id matches: what reaches the checks of meaning.
    #[test]
    fn forged_documents_never_panic(kind in 2..9u16, position in any::<prop::sample::Index>(), value: u8) {
        let mut document = to_v1::document(&SURROGATE).unwrap();
        let mut body = binary::sections(&document).unwrap().swap_remove(usize::from(kind) - 1).body;
        let at = position.index(body.len());
        body[at] = value;
        macro_rules! replace {
            ($field:ident) => {
                match binary::decode_body(kind, &body, 0) {
                    Ok(content) => document.$field = content,
                    Err(_) => return Ok(()),
                }
            };
        }
        match kind {
            2 => replace!(inputs),
            3 => replace!(outputs),
            4 => replace!(elements),
            5 => replace!(expansions),
            6 => replace!(training),
            7 => replace!(decision),
            _ => replace!(self_test),
        }
        if let Ok(surrogate) = from_v1::surrogate(document) {
            let plan = crate::evaluation::Plan::new(&surrogate);
            let block = crate::evaluation::evaluate_points(&surrogate, &plan, &[&[0.5, -0.5]]);
            prop_assert_eq!(block.max_re.len(), 1);
        }
    }
}
