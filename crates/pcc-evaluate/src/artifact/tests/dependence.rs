//! Dependence in section 2: kept in both forms, part of the content id, and refused where it makes no sense.

use super::*;
use crate::probability::dependence::GaussianCopula;

/// The surrogate with its two inputs correlated.
static DEPENDENT: LazyLock<Surrogate> = LazyLock::new(|| {
    let copula = GaussianCopula::new(2, [(0, 1, -0.4)]).unwrap();
    let inputs = SURROGATE.inputs.clone().with_dependence(copula).unwrap();
    Surrogate { inputs, ..SURROGATE.clone() }
});

fn refusal(correlations: &[(u32, u32, f64)]) -> String {
    let correlation = |&(first, second, value): &(u32, u32, f64)| v1::Correlation { first, second, value };
    let correlations = correlations.iter().map(correlation).collect();
    let error = meaning_of(&DEPENDENT, |d| d.inputs.dependence = v1::Dependence::GaussianCopula { correlations });
    let text = error.to_string();
    assert_eq!(section_of(error), "inputs");
    text
}

#[test]
fn it_comes_back_in_both_forms_and_changes_the_content_id() {
    for format in [Format::Binary, Format::Json] {
        let bytes = encode(&DEPENDENT, format).unwrap();
        let artifact = decode(&bytes).unwrap();
        assert!(artifact.surrogate == *DEPENDENT && artifact.is_canonical && artifact.version == (1, 3));
        assert_ne!(artifact.content_id, decode(&BYTES).unwrap().content_id);
        assert_eq!(encode(&artifact.surrogate, format).unwrap(), bytes);
    }
    let text = String::from_utf8(encode(&DEPENDENT, Format::Json).unwrap()).unwrap();
    let expected =
        "\"dependence\":{\"gaussian_copula\":{\"correlations\":[{\"first\":0,\"second\":1,\"value\":-0.4}]}}";
    assert!(text.contains(expected), "{text}");
}

#[test]
fn independent_inputs_keep_their_bytes() {
    let copula = GaussianCopula::new(2, [(0, 1, 0.0)]).unwrap();
    let inputs = SURROGATE.inputs.clone().with_dependence(copula).unwrap();
    assert!(encode(&Surrogate { inputs, ..SURROGATE.clone() }, Format::Binary).unwrap() == *BYTES);
}

#[test]
fn dependence_that_makes_no_sense() {
    assert!(refusal(&[]).contains("none"));
    assert!(refusal(&[(0, 1, 0.0)]).contains("zero"));
    assert!(refusal(&[(1, 0, 0.5)]).contains("not in order"));
    assert!(refusal(&[(0, 2, 0.5)]).contains("no input number 2"));
    assert!(refusal(&[(0, u32::MAX, 0.5)]).contains("no input number"));
    assert!(refusal(&[(1, 1, 0.5)]).contains("with itself"));
    assert!(refusal(&[(0, 1, 0.5), (0, 1, 0.5)]).contains("twice"));
    assert!(refusal(&[(0, 1, 1.0)]).contains("between -1 and 1"));
    assert!(refusal(&[(0, 1, -1.5)]).contains("between -1 and 1"));
    assert!(refusal(&[(0, 1, 1.0 - 1e-15)]).contains("not positive definite"));
    for value in [f64::NAN, f64::INFINITY] {
        assert!(refusal(&[(0, 1, value)]).contains("not finite"));
    }
}

#[test]
fn a_kind_of_dependence_that_is_not_known_is_refused() {
    let mut bytes = container::encode(&to_v1::document(&DEPENDENT).unwrap()).unwrap();
    let value = (-0.4f64).to_le_bytes();
    let at = bytes.windows(8).position(|window| window == value).unwrap();
    // Before the value: two positions of 4 bytes, the length of the list, and the kind.
    bytes[at - 20..at - 16].copy_from_slice(&7u32.to_le_bytes());
    let end = bytes.len() - 4;
    let checksum = crc32fast::hash(&bytes[..end]);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
    assert!(matches!(decode(&bytes), Err(ReadError::Decode { section: "inputs", .. })));
}

#[test]
fn elements_have_no_dependent_inputs() {
    let error = meaning_of(&DEPENDENT, |d| {
        let whole = d.elements.elements[0].clone();
        let half = |lower, upper| {
            let mut element = whole.clone();
            element.weight = 0.5;
            let side = &mut element.sides[0];
            side.bounds = Some(v1::Bounds { lower, upper });
            (side.center, side.half_width) = (0.5 * (lower + upper), 0.5);
            element
        };
        d.elements.elements = vec![half(-1.0, 0.0), half(0.0, 1.0)];
        let (below, above) = (v1::Branch::Element(0), v1::Branch::Element(1));
        d.elements.splits = vec![v1::Split { input: 0, at: 0.0, below, above }];
        let copies: Vec<v1::Expansion> =
            d.expansions.expansions.iter().map(|part| v1::Expansion { element: 1, ..part.clone() }).collect();
        d.expansions.expansions.extend(copies);
    });
    assert!(error.to_string().contains("inputs that depend on each other have no elements"), "{error}");
}
