//! Section 12, units and labels: kept in both forms, outside the content id, and refused where it makes no sense.

use super::*;
use crate::probability::inputs::Description;

/// The surrogate with a unit of its second input, and labels of both.
static DESCRIBED: LazyLock<Surrogate> = LazyLock::new(|| {
    let friction = Description::default().with_label("friction coefficient").unwrap();
    let stiffness = Description::default().with_unit("N/m").unwrap().with_label("cushion stiffness").unwrap();
    let inputs = SURROGATE.inputs.clone().described([friction, stiffness]);
    Surrogate { inputs, ..SURROGATE.clone() }
});

/// Section 12 in binary: two inputs, the first with this unit, else nothing.
fn body(unit: &str) -> Vec<u8> {
    let length = |number: usize| (number as u64).to_le_bytes();
    [&length(2)[..], &[1], &length(unit.len()), unit.as_bytes(), &[0], &[0, 0]].concat()
}

#[test]
fn they_come_back_in_both_forms_and_stay_outside_the_content_id() {
    for format in [Format::Binary, Format::Json] {
        let bytes = encode(&DESCRIBED, format).unwrap();
        let artifact = decode(&bytes).unwrap();
        assert!(artifact.surrogate == *DESCRIBED && artifact.is_canonical && artifact.version == (1, 3));
        assert_eq!(artifact.content_id, decode(&BYTES).unwrap().content_id);
        assert_eq!(encode(&artifact.surrogate, format).unwrap(), bytes);
        assert!(artifact.check_lossless().is_ok());
    }
    let through_json = decode(&encode(&DESCRIBED, Format::Json).unwrap()).unwrap().surrogate;
    assert_eq!(encode(&through_json, Format::Binary).unwrap(), encode(&DESCRIBED, Format::Binary).unwrap());
}

#[test]
fn a_file_without_them_has_no_such_section() {
    let none = SURROGATE.inputs.clone().described([Description::default(), Description::default()]);
    let bytes = encode(&Surrogate { inputs: none, ..SURROGATE.clone() }, Format::Binary).unwrap();
    assert!(bytes == *BYTES && decode(&bytes).unwrap().version == (1, 0));
}

#[test]
fn texts_that_make_no_sense() {
    let long = "m".repeat(81);
    for wrong in ["", " ", " N/m", "N/m ", "N\n/m", "\u{1b}[2J", &long[..41]] {
        let of_unit = |d: &mut v1::Document| d.descriptions.as_mut().unwrap().inputs[1].unit = Some(wrong.to_owned());
        assert_eq!(section_of(meaning_of(&DESCRIBED, of_unit)), "descriptions", "{wrong:?}");
    }
    for wrong in ["", "\t", "\u{7f}", &long] {
        let of_label = |d: &mut v1::Document| d.descriptions.as_mut().unwrap().inputs[0].label = Some(wrong.to_owned());
        assert_eq!(section_of(meaning_of(&DESCRIBED, of_label)), "descriptions", "{wrong:?}");
    }
    let fewer = |d: &mut v1::Document| d.descriptions.as_mut().unwrap().inputs.truncate(1);
    assert_eq!(section_of(meaning_of(&DESCRIBED, fewer)), "descriptions");
    let more = |d: &mut v1::Document| d.descriptions.as_mut().unwrap().inputs.push(nothing());
    assert_eq!(section_of(meaning_of(&DESCRIBED, more)), "descriptions");
    let empty = |d: &mut v1::Document| d.descriptions = Some(v2::Descriptions { inputs: vec![nothing(), nothing()] });
    assert_eq!(section_of(meaning_of(&DESCRIBED, empty)), "descriptions");
}

fn nothing() -> v2::Description {
    v2::Description { unit: None, label: None }
}

#[test]
fn sections_that_are_forged() {
    let with = |section: Vec<u8>| forged(|bytes| bytes.extend(section));
    let good = decode(&with(section(12, 0, &body("1")))).unwrap();
    assert_eq!(good.surrogate.inputs.inputs()[0].description.unit(), Some("1"));
    // Readers may skip it: it cannot be required.
    assert!(matches!(decode(&with(section(12, 1, &body("1")))), Err(ReadError::SectionTable(_))));
    let mut later = section(12, 0, &body("1"));
    later[2] = 2;
    let later = decode(&with(later)).unwrap();
    assert_eq!((later.unknown_sections.as_slice(), &later.surrogate), (&[12][..], &*SURROGATE));
    let long = decode(&with(section(12, 0, &[body("1"), vec![0]].concat())));
    assert_eq!(long, Err(ReadError::TrailingBytes { section: "descriptions", bytes: 1 }));
    let body = body("1");
    let not_text = [&body[..17], &[0xFF], &body[18..]].concat();
    let huge = [&[0xFF; 8], &body[8..]].concat();
    let tag = [&body[..8], &[2], &body[9..]].concat();
    for wrong in [&body[..body.len() - 1], &not_text, &huge, &tag] {
        let error = decode(&with(section(12, 0, wrong))).unwrap_err();
        assert!(matches!(error, ReadError::Decode { section: "descriptions", .. }), "{error}");
    }
    let json = String::from_utf8(encode(&DESCRIBED, Format::Json).unwrap()).unwrap();
    let unknown = json.replacen("\"unit\":\"N/m\"", "\"unit\":\"N/m\",\"colour\":\"red\"", 1);
    assert!(unknown != json && matches!(decode(unknown.as_bytes()), Err(ReadError::Json { .. })));
}
