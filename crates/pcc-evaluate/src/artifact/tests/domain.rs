//! Section 13, the box that the model runs spanned: kept in both forms, outside the content id, and refused where it
//! makes no sense.

use super::*;
use crate::probability::inputs::{Input, InputSpace, Marginal, Parameters};
use crate::surrogate::TrainedDomain;

/// The surrogate with a normal second input, whose box is not known.
static NORMAL: LazyLock<Surrogate> = LazyLock::new(|| {
    let mut inputs = SURROGATE.inputs.inputs().to_vec();
    let law = Marginal::named("normal", &Parameters::of([("mean", 16e6), ("std", 4e5)])).unwrap();
    inputs[1] = Input { marginal: law, ..inputs[1].clone() };
    let mut surrogate = Surrogate { inputs: InputSpace::new(inputs).unwrap(), ..SURROGATE.clone() };
    surrogate.self_test = surrogate.make_self_test(surrogate.self_test.points.clone());
    surrogate
});

/// The same with its box.
static TRAINED: LazyLock<Surrogate> = LazyLock::new(|| {
    let domain = TrainedDomain::new(&NORMAL.inputs, vec![None, Some([-2.25, 1.875])]);
    assert!(domain.is_some());
    Surrogate { trained_domain: domain, ..NORMAL.clone() }
});

/// Section 13 in binary: nothing of the first of two inputs, this interval of the second.
fn body(lower: f64, upper: f64) -> Vec<u8> {
    [&2u64.to_le_bytes()[..], &[0, 1], &lower.to_le_bytes(), &upper.to_le_bytes()].concat()
}

#[test]
fn it_comes_back_in_both_forms_and_stays_outside_the_content_id() {
    let without = decode(&encode(&NORMAL, Format::Binary).unwrap()).unwrap();
    assert_eq!(without.surrogate.trained_domain, None);
    for format in [Format::Binary, Format::Json] {
        let bytes = encode(&TRAINED, format).unwrap();
        let artifact = decode(&bytes).unwrap();
        assert!(artifact.surrogate == *TRAINED && artifact.is_canonical && artifact.version == (1, 3));
        assert_eq!(artifact.content_id, without.content_id);
        assert_eq!(artifact.surrogate.trained_interval(0), None);
        assert_eq!(artifact.surrogate.trained_interval(1), Some([15.1e6, 16.75e6]));
        assert_eq!(encode(&artifact.surrogate, format).unwrap(), bytes);
        assert!(artifact.check_lossless().is_ok());
    }
    let through_json = decode(&encode(&TRAINED, Format::Json).unwrap()).unwrap().surrogate;
    assert_eq!(encode(&through_json, Format::Binary).unwrap(), encode(&TRAINED, Format::Binary).unwrap());
}

#[test]
fn it_has_the_layout_that_is_documented() {
    let (with, without) = (encode(&TRAINED, Format::Binary).unwrap(), encode(&NORMAL, Format::Binary).unwrap());
    let section = section(13, 0, &body(-2.25, 1.875));
    assert_eq!(with.len(), without.len() + section.len());
    assert!(with[..with.len() - 4].ends_with(&section));
}

#[test]
fn boxes_that_make_no_sense() {
    let interval = |lower, upper| Some(v2::TrainedInterval { lower, upper });
    for wrong in [
        vec![],
        vec![None],
        vec![None, None],
        vec![None, interval(1.0, -1.0)],
        vec![interval(-1.5, 0.5), interval(-1.0, 1.0)],
        vec![None, interval(-1.0, 1.0), None],
        vec![None, interval(-1.0, f64::INFINITY)],
        // Physical values overflow.
        vec![None, interval(-1.0, 1e305)],
    ] {
        let change = |d: &mut v1::Document| d.domain = Some(v2::Domain { inputs: wrong.clone() });
        assert_eq!(section_of(meaning_of(&TRAINED, change)), "domain", "{wrong:?}");
    }
    // Runs that were given have an interval of every input.
    let all = TrainedDomain::new(&NORMAL.inputs, vec![Some([-0.5, 0.5]), Some([-1.0, 1.0])]);
    let given = Surrogate { trained_domain: all.clone(), ..NORMAL.clone() };
    for format in [Format::Binary, Format::Json] {
        assert_eq!(decode(&encode(&given, format).unwrap()).unwrap().surrogate.trained_domain, all);
    }
    // Runs of a design fill uniform laws.
    let needless = |d: &mut v1::Document| d.domain = Some(v2::Domain { inputs: vec![None, None] });
    assert_eq!(section_of(meaning(needless)), "domain");
}

#[test]
fn sections_that_are_forged() {
    let of_normal = |section: Vec<u8>| {
        let mut bytes = encode(&NORMAL, Format::Binary).unwrap();
        bytes.truncate(bytes.len() - 4);
        bytes.extend(section);
        let length = (bytes.len() - HEADER) as u64;
        bytes[16..24].copy_from_slice(&length.to_le_bytes());
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    };
    let good = body(-2.25, 1.875);
    assert!(decode(&of_normal(section(13, 0, &good))).unwrap().surrogate == *TRAINED);
    // Readers may skip it: it cannot be required.
    assert!(matches!(decode(&of_normal(section(13, 1, &good))), Err(ReadError::SectionTable(_))));
    let mut later = section(13, 0, &good);
    later[2] = 2;
    let later = decode(&of_normal(later)).unwrap();
    assert_eq!((later.unknown_sections.as_slice(), &later.surrogate), (&[13][..], &*NORMAL));
    let long = decode(&of_normal(section(13, 0, &[good.clone(), vec![0]].concat())));
    assert_eq!(long, Err(ReadError::TrailingBytes { section: "domain", bytes: 1 }));
    let huge = [&[0xFF; 8], &good[8..]].concat();
    let tag = [&good[..8], &[2], &good[9..]].concat();
    for wrong in [&good[..good.len() - 1], &huge, &tag] {
        let error = decode(&of_normal(section(13, 0, wrong))).unwrap_err();
        assert!(matches!(error, ReadError::Decode { section: "domain", .. }), "{error}");
    }
    let not_finite = decode(&of_normal(section(13, 0, &body(f64::NAN, 1.0)))).unwrap_err();
    assert_eq!(section_of(not_finite), "domain");
}
