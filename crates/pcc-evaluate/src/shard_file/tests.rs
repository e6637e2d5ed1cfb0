//! Parts are put together to the same bytes, or refused.

use super::*;
use crate::evaluation::{Bins, Event, Sampler, Surveyed, Sweep};
use crate::foundation::Silent;
use proptest::prelude::*;

fn surrogate() -> Surrogate {
    artifact::decode(include_bytes!("../../../../surrogates/clutch-r2.pcc")).unwrap().surrogate
}

fn rich_question() -> Question {
    let bins = |quantity: &str, bins| Bins { quantity: quantity.to_owned(), lower: -20.0, upper: 20.0, bins };
    Question {
        events: vec![Event { quantity: "max_re".to_owned(), below: true, threshold: -1.0 }],
        histograms: vec![bins("max_re", 40)],
        quantile_levels: vec![0.5],
        quantile_bins: vec![bins("re_3", 1000)],
        ..Question::plain(100_003, 7)
    }
}

fn part(question: &Question, shard: u64, shards: u64) -> Part {
    let surrogate = surrogate();
    let survey = Survey::new(&surrogate, question, InstructionSet::best()).unwrap();
    match survey.run(survey.division().shard(shard, shards), &Silent).unwrap() {
        Surveyed::Complete(findings) => Part { surrogate: surrogate.clone(), question: question.clone(), findings },
        Surveyed::Interrupted(_) => panic!("nobody interrupts"),
    }
}

fn parts(question: &Question, shards: u64) -> Vec<(String, Part)> {
    (0..shards).map(|shard| (format!("part {shard}"), part(question, shard, shards))).collect()
}

#[test]
fn any_number_of_shards_gives_the_same_bytes() {
    let sobol = Question { sampler: Sampler::Sobol, replicates: 4, ..Question::plain(32_768, 3) };
    let sweep = Sweep { input: "mu".to_owned(), from: 0.0, to: 0.5, points: 5 };
    let swept = Question { sweeps: vec![sweep], ..Question::plain(9000, 1) };
    for question in [rich_question(), sobol, swept] {
        let whole = part(&question, 0, 1);
        assert!(whole.is_complete());
        for shards in [1, 3, 17, 60] {
            let mut parts = parts(&question, shards);
            parts.rotate_left(shards as usize / 2);
            let merged = merge(parts).unwrap();
            assert_eq!(merged.to_bytes().unwrap(), whole.to_bytes().unwrap(), "{shards} shards");
        }
    }
}

#[test]
fn parts_come_back_from_their_bytes() {
    let part = part(&rich_question(), 1, 3);
    assert_eq!(Part::from_bytes(&part.to_bytes().unwrap()).unwrap(), part);
    assert!(!part.is_complete());
}

#[test]
fn gaps_overlaps_and_other_evaluations_are_refused() {
    let question = rich_question();
    let all = parts(&question, 5);
    let some = |numbers: &[usize]| merge(numbers.iter().map(|&number| all[number].clone()).collect());
    assert!(matches!(some(&[0, 1, 3, 4]), Err(PartError::Gap { missing, .. }) if missing == (10..15)));
    assert!(matches!(some(&[0, 1, 1, 2]), Err(PartError::Twice { .. })));
    let half = ("half".to_owned(), part(&question, 0, 2));
    assert!(matches!(merge(vec![half, all[1].clone()]), Err(PartError::Overlap { .. })));
    assert!(matches!(some(&[]), Err(PartError::Empty)));
    assert!(some(&[2, 1, 3]).is_ok_and(|part| !part.is_complete()));
    let other = |question: Question, what: &str| {
        let result = merge(vec![all[0].clone(), (what.to_owned(), part(&question, 1, 5))]);
        assert!(matches!(result, Err(PartError::Different { what: found, .. }) if found == what));
    };
    other(Question { seed: 8, ..question.clone() }, "seed");
    other(Question { samples: 100_004, ..question.clone() }, "number of samples");
    other(Question { events: Vec::new(), ..question.clone() }, "list of events");
    let mut foreign = all[1].clone();
    foreign.1.surrogate.provenance.study_name.push('x');
    assert!(matches!(merge(vec![all[0].clone(), foreign]), Err(PartError::Different { what: "surrogate", .. })));
}

#[test]
fn damaged_files_are_refused() {
    let bytes = part(&rich_question(), 0, 2).to_bytes().unwrap();
    for length in [0, 5, 30, 100, 200, bytes.len() / 2, bytes.len() - 1] {
        assert!(Part::from_bytes(&bytes[..length]).is_err(), "{length} bytes");
    }
    for place in (0..bytes.len()).step_by(997) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 1;
        assert!(Part::from_bytes(&damaged).is_err(), "byte {place}");
    }
    let text = String::from_utf8(bytes).unwrap();
    let newer = text.replacen("\"pcc_part\":2", "\"pcc_part\":3", 1);
    assert!(matches!(Part::from_bytes(newer.as_bytes()), Err(PartError::Version { found: 3 })));
    assert!(matches!(Part::from_bytes(b"mu,k_p\n0.1,2"), Err(PartError::NotAPart)));
}

/// With a right checksum, so that it is the content that is judged.
#[test]
fn counts_that_do_not_fit_the_question_are_refused() {
    let bytes = part(&rich_question(), 0, 2).to_bytes().unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let body = text.split_once('\n').unwrap().1;
    let refused = |from: &str, to: &str| {
        assert!(body.contains(from), "{from}");
        let body = body.replacen(from, to, 1);
        let header = Header { pcc_part: 1, length: body.len() as u64, sha256: sha256(body.as_bytes()) };
        let file = format!("{}\n{body}", serde_json::to_string(&header).unwrap());
        assert!(Part::from_bytes(file.as_bytes()).is_err(), "{from} became {to}");
    };
    refused("\"samples\":100003", "\"samples\":5000");
    refused("\"first\":0,\"end\":12", "\"first\":0,\"end\":13");
    refused("\"level\":3", "\"level\":2");
    refused("\"events\":[{", "\"events\":[],\"was\":[{");
    refused("\"quantity\":\"re_3\"", "\"quantity\":\"re_9\"");
    refused("\"bins\":40", "\"bins\":41");
    refused("\"program\":\"", "\"program\":\"9.");
    refused("\"quantile_levels\":[0.5]", "\"quantile_levels\":[1.5]");
    refused("\"below\":0", "\"below\":18446744073709551615");
    refused("\"squares\":", "\"squares\":-");
    refused("\"count\":", "\"count\":1");
    refused("\"stable\":", "\"stable\":99999999");
    refused("\"replicates\":1", "\"replicates\":4294967295");
    refused("\"sampler\":\"monte-carlo\"", "\"sampler\":\"sobol\"");
}

/// The points of a sweep take the same room, however many samples each has.
#[test]
fn parts_of_sweeps_do_not_grow_with_the_number_of_samples() {
    let sweep = Sweep { input: "mu".to_owned(), from: 0.0, to: 0.5, points: 50 };
    let size = |samples| {
        let question = Question { sweeps: vec![sweep.clone()], ..Question::plain(samples, 1) };
        part(&question, 0, 1).to_bytes().unwrap().len()
    };
    // Counts have more digits.
    assert!(size(7 * 4096) < size(4096) + 50 * 16);
}

/// Pointers to all values inside `value`.
fn places(value: &serde_json::Value, place: String, all: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(fields) => {
            fields.iter().for_each(|(name, field)| places(field, format!("{place}/{name}"), all));
        }
        serde_json::Value::Array(entries) => {
            (0..).zip(entries).for_each(|(k, entry)| places(entry, format!("{place}/{k}"), all));
        }
        _ => {}
    }
    all.push(place);
}

proptest! {
    /// With right checksums, so that it is the content that is judged: nothing makes reading or answering panic.
    #[test]
    fn changed_contents_are_refused_or_answered(
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..12usize), 1..4),
        is_sweep in any::<bool>(),
    ) {
        let sweep = Sweep { input: "mu".to_owned(), from: 0.0, to: 0.5, points: 3 };
        let swept = Question { sweeps: vec![sweep], sampler: Sampler::Sobol, replicates: 4, ..Question::plain(64, 1) };
        let question = if is_sweep { swept } else { Question { samples: 9000, ..rich_question() } };
        let bytes = part(&question, 0, 2).to_bytes().unwrap();
        let body = bytes.splitn(2, |&byte| byte == b'\n').nth(1).unwrap();
        let mut content: serde_json::Value = serde_json::from_slice(body).unwrap();
        for (place, value) in changes {
            let mut all = Vec::new();
            places(&content, String::new(), &mut all);
            all.retain(|place| !place.starts_with("/surrogate") && !place.is_empty());
            let values = [
                0.into(), 1.into(), (-1).into(), u64::MAX.into(), (1u64 << 63).into(), u32::MAX.into(), 1e308.into(),
                (-1e308).into(), 0.5.into(), serde_json::Value::Null, "mu".into(), serde_json::Value::Array(Vec::new()),
            ];
            if let Some(target) = content.pointer_mut(&all[place.index(all.len())]) {
                *target = values[value].clone();
            }
        }
        let body = serde_json::to_string(&content).unwrap();
        let header = Header { pcc_part: 1, length: body.len() as u64, sha256: sha256(body.as_bytes()) };
        let file = format!("{}\n{body}", serde_json::to_string(&header).unwrap());
        if let Ok(part) = Part::from_bytes(file.as_bytes()) {
            let survey = part.survey().unwrap();
            for cell in part.findings.answer(survey.division()).cells {
                let share = cell.share(0.95, |tally| tally.summary.stable);
                prop_assert!((0.0..=1.0).contains(&share.value));
            }
        }
    }
}
