//! One record of a journal as bytes.
//!
//! A frame is the length of its body (u32), the CRC-32 of length and body (u32), and the body; all numbers are
//! little-endian, floating-point numbers are their bits. The body:
//!
//! | bytes | field |
//! |---|---|
//! | 32 | hash of the model, SHA-256 |
//! | 8 | seconds that the run took |
//! | 4, 8 r | number r of inputs, their values x in physical units |
//! | 1 | status: 0 answered, 1 failed, 2 failed by circumstances |
//! | … | answered: number of eigenvalues (u32), Re λ and Im λ of each, then what else is known, by kind: 0 nothing, 3 reduced systems; in version 1 also 1 and 2 |
//! | … | before these there can be a 4: errors of Re λ and of λ for each eigenvalue |
//! | … | with 3: number of modes of interest (u32), their ranks (u32 each), number of reduced systems (u32) |
//! | … | each system: numbers m of its eigenvalues and n of states (u32 each), the eigenvalues, T and D_1 … D_r, m × m complex numbers each, right eigenvectors, n × m, left eigenvectors, m × n, all by columns |
//! | … | with 1, modes could not be separated, and 2, reduced: number m of modes (u32), their ranks (u32 each) |
//! | … | with 2: T and D_1 … D_r, m × m complex numbers each, by columns. What 1 and 2 say is not used any more |
//! | … | failed: number of attempts (u32), length (u32) and UTF-8 text of the cause |

use crate::mechanics::spectrum::{Computation, ReducedSystem, Reductions};
use crate::numerics::accuracy::Accuracy;
use nalgebra::{Complex, DMatrix};

/// Bytes of the hash that names a model.
pub const HASH_BYTES: usize = 32;

/// Length and CRC before a body.
pub(super) const FRAME_HEAD: usize = 8;

/// What follows the eigenvalues of an answer.
const NO_DERIVATIVES: u8 = 0;
const INSEPARABLE_V1: u8 = 1;
const REDUCED_V1: u8 = 2;
const REDUCED: u8 = 3;
const ACCURACIES: u8 = 4;

/// A body of more bytes is no record: 1000 modes with 50 derivatives fit.
pub(super) const LARGEST_BODY: usize = 1 << 30;

/// How a recorded run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum RunOutcome {
    /// The model answered.
    Answered(Computation),
    /// It did not, in so many attempts.
    Failed {
        /// Number of attempts.
        attempts: u32,
        /// Why, with what was captured of its output.
        cause: String,
        /// Whether something else than the model ended it, a signal say: another attempt may go well.
        by_circumstances: bool,
    },
}

/// One run of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Hash of the model: the same for all studies of it, whatever their distributions and fits.
    pub model: [u8; HASH_BYTES],
    /// The inputs, in physical units.
    pub point: Vec<f64>,
    /// What came of it.
    pub outcome: RunOutcome,
    /// Wall-clock time of the run; 0 if it is not known.
    pub seconds: f64,
}

impl Record {
    /// The record as a frame; `None` if it would be too large.
    pub(super) fn frame(&self) -> Option<Vec<u8>> {
        let mut body = Vec::new();
        body.extend_from_slice(&self.model);
        put_number(&mut body, self.seconds);
        put_count(&mut body, self.point.len());
        self.point.iter().for_each(|&value| put_number(&mut body, value));
        match &self.outcome {
            RunOutcome::Answered(computation) => {
                body.push(0);
                put_computation(&mut body, computation);
            }
            RunOutcome::Failed { attempts, cause, by_circumstances } => {
                body.push(if *by_circumstances { 2 } else { 1 });
                body.extend_from_slice(&attempts.to_le_bytes());
                put_count(&mut body, cause.len());
                body.extend_from_slice(cause.as_bytes());
            }
        }
        if body.len() > LARGEST_BODY {
            return None;
        }
        let length = (body.len() as u32).to_le_bytes();
        let mut frame = Vec::with_capacity(FRAME_HEAD + body.len());
        frame.extend_from_slice(&length);
        frame.extend_from_slice(&checksum(&length, &body).to_le_bytes());
        frame.append(&mut body);
        Some(frame)
    }

    /// The record at the start of `bytes` and the length of its frame; `None` if there is no whole, sound one.
    pub(super) fn read(bytes: &[u8]) -> Option<(Self, usize)> {
        let length: [u8; 4] = bytes.get(..4)?.try_into().ok()?;
        let crc: [u8; 4] = bytes.get(4..FRAME_HEAD)?.try_into().ok()?;
        let size = u32::from_le_bytes(length) as usize;
        if size > LARGEST_BODY {
            return None;
        }
        let body = bytes.get(FRAME_HEAD..FRAME_HEAD + size)?;
        // Cheaper than a checksum over what is no record at all.
        let inputs: [u8; 4] = body.get(HASH_BYTES + 8..HASH_BYTES + 12)?.try_into().ok()?;
        let status = (u32::from_le_bytes(inputs) as usize).checked_mul(8)?.checked_add(HASH_BYTES + 12)?;
        if !matches!(body.get(status), Some(0..=2)) {
            return None;
        }
        if checksum(&length, body) != u32::from_le_bytes(crc) {
            return None;
        }
        let mut reader = Reader { bytes: body };
        let record = reader.record()?;
        reader.bytes.is_empty().then_some((record, FRAME_HEAD + size))
    }
}

fn checksum(length: &[u8; 4], body: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(length);
    hasher.update(body);
    hasher.finalize()
}

fn put_count(bytes: &mut Vec<u8>, count: usize) {
    bytes.extend_from_slice(&(count as u32).to_le_bytes());
}

fn put_number(bytes: &mut Vec<u8>, value: f64) {
    bytes.extend_from_slice(&value.to_bits().to_le_bytes());
}

fn put_complex(bytes: &mut Vec<u8>, value: Complex<f64>) {
    put_number(bytes, value.re);
    put_number(bytes, value.im);
}

fn put_computation(bytes: &mut Vec<u8>, computation: &Computation) {
    put_count(bytes, computation.eigenvalues.len());
    computation.eigenvalues.iter().for_each(|&lambda| put_complex(bytes, lambda));
    if !computation.accuracies.is_empty() {
        bytes.push(ACCURACIES);
        for accuracy in &computation.accuracies {
            put_number(bytes, accuracy.re);
            put_number(bytes, accuracy.whole);
        }
    }
    let Some(Reductions { modes, systems }) = &computation.reductions else {
        bytes.push(NO_DERIVATIVES);
        return;
    };
    bytes.push(REDUCED);
    put_count(bytes, modes.len());
    modes.iter().for_each(|&mode| put_count(bytes, mode));
    put_count(bytes, systems.len());
    for system in systems {
        put_count(bytes, system.eigenvalues().len());
        put_count(bytes, system.right().nrows());
        system.eigenvalues().iter().for_each(|&lambda| put_complex(bytes, lambda));
        let matrices = std::iter::once(system.state_matrix()).chain(system.derivatives());
        let matrices = matrices.chain([system.right(), system.left()]);
        matrices.flat_map(|matrix| matrix.iter()).for_each(|&entry| put_complex(bytes, entry));
    }
}

/// Takes fields off the front of a body.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        Some(taken)
    }

    fn byte(&mut self) -> Option<u8> {
        self.take(1).map(|bytes| bytes[0])
    }

    fn count(&mut self) -> Option<usize> {
        let bytes: [u8; 4] = self.take(4)?.try_into().ok()?;
        Some(u32::from_le_bytes(bytes) as usize)
    }

    fn number(&mut self) -> Option<f64> {
        let bytes: [u8; 8] = self.take(8)?.try_into().ok()?;
        Some(f64::from_bits(u64::from_le_bytes(bytes)))
    }

    fn numbers(&mut self, count: usize) -> Option<Vec<f64>> {
        // What is announced but not there must not be allocated.
        if count.checked_mul(8)? > self.bytes.len() {
            return None;
        }
        (0..count).map(|_| self.number()).collect()
    }

    fn complex(&mut self, count: usize) -> Option<Vec<Complex<f64>>> {
        let numbers = self.numbers(count.checked_mul(2)?)?;
        Some(numbers.chunks_exact(2).map(|pair| Complex::new(pair[0], pair[1])).collect())
    }

    fn record(&mut self) -> Option<Record> {
        let model = self.take(HASH_BYTES)?.try_into().ok()?;
        let seconds = self.number()?;
        let inputs = self.count()?;
        let point = self.numbers(inputs)?;
        let outcome = match self.byte()? {
            0 => RunOutcome::Answered(self.computation(inputs)?),
            status @ (1 | 2) => {
                let (attempts, length) = (self.count()? as u32, self.count()?);
                let cause = String::from_utf8(self.take(length)?.to_vec()).ok()?;
                RunOutcome::Failed { attempts, cause, by_circumstances: status == 2 }
            }
            _ => return None,
        };
        Some(Record { model, point, outcome, seconds })
    }

    fn computation(&mut self, inputs: usize) -> Option<Computation> {
        let count = self.count()?;
        let eigenvalues = self.complex(count)?;
        let (mut kind, mut accuracies) = (self.byte()?, Vec::new());
        if kind == ACCURACIES {
            let numbers = self.numbers(count.checked_mul(2)?)?;
            let is_error = |error: &f64| *error >= 0.0;
            numbers.iter().all(is_error).then_some(())?;
            accuracies = numbers.chunks_exact(2).map(|pair| Accuracy { re: pair[0], whole: pair[1] }).collect();
            kind = self.byte()?;
        }
        let reductions = match kind {
            NO_DERIVATIVES => None,
            REDUCED => Some(self.reductions(inputs)?),
            kind @ (INSEPARABLE_V1 | REDUCED_V1) => {
                self.skip_version_1(kind, inputs)?;
                None
            }
            _ => return None,
        };
        Some(Computation { eigenvalues, accuracies, reductions })
    }

    fn counts(&mut self) -> Option<Vec<usize>> {
        let count = self.count()?;
        if count.checked_mul(4)? > self.bytes.len() {
            return None;
        }
        (0..count).map(|_| self.count()).collect()
    }

    fn matrix(&mut self, rows: usize, columns: usize) -> Option<DMatrix<Complex<f64>>> {
        Some(DMatrix::from_vec(rows, columns, self.complex(rows.checked_mul(columns)?)?))
    }

    fn reductions(&mut self, inputs: usize) -> Option<Reductions> {
        let modes = self.counts()?;
        let count = self.count()?;
        let systems = (0..count).map(|_| self.system(inputs)).collect::<Option<_>>()?;
        Some(Reductions { modes, systems })
    }

    fn system(&mut self, inputs: usize) -> Option<ReducedSystem> {
        let (count, states) = (self.count()?, self.count()?);
        let eigenvalues = self.complex(count)?;
        let state_matrix = self.matrix(count, count)?;
        let derivatives = (0..inputs).map(|_| self.matrix(count, count)).collect::<Option<_>>()?;
        let (right, left) = (self.matrix(states, count)?, self.matrix(count, states)?);
        ReducedSystem::from_parts(eigenvalues, state_matrix, derivatives, right, left)
    }

    fn skip_version_1(&mut self, kind: u8, inputs: usize) -> Option<()> {
        let count = self.counts()?.len();
        let matrices = if kind == REDUCED_V1 { 1 + inputs } else { 0 };
        self.take(count.checked_mul(count)?.checked_mul(16)?.checked_mul(matrices)?).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    pub(crate) fn record(point: &[f64]) -> Record {
        let lambda = Complex::new(-0.1, 1.0 / 3.0);
        let matrix = |value: f64| DMatrix::from_element(2, 2, Complex::new(value, -value));
        let derivatives = vec![matrix(2.0); point.len()];
        let vectors = |rows, columns| DMatrix::from_fn(rows, columns, |i, j| Complex::new(i as f64, j as f64));
        let eigenvalues = vec![lambda, lambda.conj()];
        let system =
            ReducedSystem::from_parts(eigenvalues.clone(), matrix(0.1), derivatives, vectors(3, 2), vectors(2, 3));
        let reductions = Some(Reductions { modes: vec![1], systems: vec![system.unwrap()] });
        let accuracies = vec![Accuracy { re: 1e-12, whole: 1e-9 }; 2];
        let outcome = RunOutcome::Answered(Computation { eigenvalues, accuracies, reductions });
        Record { model: [7; HASH_BYTES], point: point.to_vec(), outcome, seconds: 0.25 }
    }

    fn kinds() -> Vec<Record> {
        let full = record(&[0.1, -2e300]);
        let with = |reductions| Record {
            outcome: RunOutcome::Answered(Computation {
                eigenvalues: vec![Complex::new(1.0, 2.0)],
                accuracies: Vec::new(),
                reductions,
            }),
            ..full.clone()
        };
        let failed = |by_circumstances| {
            let cause = "μ was too large\nsecond line".to_owned();
            Record { outcome: RunOutcome::Failed { attempts: 3, cause, by_circumstances }, ..full.clone() }
        };
        vec![
            with(None),
            with(Some(Reductions { modes: vec![3, 4], systems: Vec::new() })),
            failed(false),
            failed(true),
            Record { point: Vec::new(), ..record(&[]) },
            full,
        ]
    }

    /// What version 1 said of derivatives is passed over.
    #[test]
    fn records_of_version_1_are_read() {
        let full = record(&[0.1, -2e300]);
        let RunOutcome::Answered(computation) = full.outcome.clone() else { panic!() };
        for (kind, rest) in [(INSEPARABLE_V1, 0), (REDUCED_V1, 3 * 4 * 16)] {
            let plain =
                RunOutcome::Answered(Computation { accuracies: Vec::new(), reductions: None, ..computation.clone() });
            let record = Record { outcome: plain, ..full.clone() };
            let mut body = record.frame().unwrap()[FRAME_HEAD..].to_vec();
            body.pop();
            body.push(kind);
            [2u32, 3, 4].iter().for_each(|count| body.extend_from_slice(&count.to_le_bytes()));
            body.extend(vec![0; rest]);
            let length = (body.len() as u32).to_le_bytes();
            let bytes = [&length[..], &checksum(&length, &body).to_le_bytes(), &body].concat();
            assert_eq!(Record::read(&bytes), Some((record, bytes.len())), "{kind}");
        }
    }

    #[test]
    fn records_read_back_as_they_were_written() {
        for record in kinds() {
            let frame = record.frame().unwrap();
            assert_eq!(Record::read(&frame), Some((record.clone(), frame.len())));
            for end in 0..frame.len() {
                assert_eq!(Record::read(&frame[..end]), None, "{end} of {} bytes", frame.len());
            }
        }
    }

    proptest! {
        #[test]
        fn a_changed_bit_is_seen(kind in 0..6usize, at in any::<prop::sample::Index>(), bit in 0..8u8) {
            let mut frame = kinds()[kind].frame().unwrap();
            let at = at.index(frame.len());
            frame[at] ^= 1 << bit;
            prop_assert_eq!(Record::read(&frame), None);
        }

        #[test]
        fn changed_fields_with_a_right_checksum_never_panic(
            kind in 0..6usize, at in any::<prop::sample::Index>(), value: u32,
        ) {
            let frame = kinds()[kind].frame().unwrap();
            let mut body = frame[FRAME_HEAD..].to_vec();
            let at = at.index(body.len() - 3);
            body[at..at + 4].copy_from_slice(&value.to_le_bytes());
            let length = (body.len() as u32).to_le_bytes();
            let bytes = [&length[..], &checksum(&length, &body).to_le_bytes(), &body].concat();
            let _ = Record::read(&bytes);
        }
    }
}
