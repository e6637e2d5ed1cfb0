//! Section 14, residuals at runs left out: kept in both forms, outside the content id, and refused where it makes no
//! sense.

use super::*;
use crate::surrogate::LeftOut;

/// The surrogate with residuals of its four components at two runs.
static WITH: LazyLock<Surrogate> = LazyLock::new(|| {
    let left_out = LeftOut::new(vec![vec![0.5, -0.25, 0.0, 1.0], vec![0.125, 0.5, -1.0, 2.0]]);
    Surrogate { left_out, ..SURROGATE.clone() }
});

#[test]
fn it_comes_back_in_both_forms_and_stays_outside_the_content_id() {
    let without = decode(&BYTES).unwrap();
    assert_eq!((without.version, &without.surrogate.left_out), ((1, 0), &None));
    for format in [Format::Binary, Format::Json] {
        let bytes = encode(&WITH, format).unwrap();
        let artifact = decode(&bytes).unwrap();
        assert!(artifact.surrogate == *WITH && artifact.is_canonical && artifact.version == (1, 3));
        assert_eq!(artifact.content_id, without.content_id);
        assert_eq!(encode(&artifact.surrogate, format).unwrap(), bytes);
    }
}

#[test]
fn it_has_the_layout_that_is_documented() {
    let (with, without) = (encode(&WITH, Format::Binary).unwrap(), &BYTES);
    let mut body = 2u64.to_le_bytes().to_vec();
    for run in WITH.left_out.as_ref().unwrap().runs() {
        body.extend(4u64.to_le_bytes());
        body.extend(run.iter().flat_map(|residual| residual.to_le_bytes()));
    }
    let section = section(14, 0, &body);
    assert_eq!(with.len(), without.len() + section.len());
    assert!(with[..with.len() - 4].ends_with(&section));
}

#[test]
fn residuals_that_make_no_sense() {
    for wrong in [vec![], vec![vec![]], vec![vec![0.0; 3]], vec![vec![0.0; 4], vec![0.0; 5]], vec![vec![0.0; 4]; 201]] {
        let found = meaning_of(&WITH, |document| document.left_out = Some(v2::LeftOut { runs: wrong.clone() }));
        assert_eq!(section_of(found), "left_out", "{} runs", wrong.len());
    }
    let infinite = vec![vec![0.0, 0.0, f64::INFINITY, 0.0]];
    let found = meaning_of(&WITH, |document| document.left_out = Some(v2::LeftOut { runs: infinite }));
    assert_eq!(section_of(found), "left_out");
}
