//! The answer in a sentence: how often unstable, which mode, at what frequency, in which way, and which input decides.

use super::eval::{EvalReport, ModeReport, RealReport};
use super::judgement::MarginReport;
use super::numbers::{plain, share, share_range, significant};
use super::sensitivity::SensitivityReport;
use super::shapley::ShapleyReport;
use super::sight::Sight;
use super::survey::conditions_text;
use pcc_evaluate::foundation::plural;

/// Below this the smaller of stable and unstable is the one that is named.
const RARE: f64 = 0.01;

/// Modes that are unstable less often than this share of the first are not in the sentence.
const WORTH_NAMING: f64 = 0.1;

/// Modes, and inputs, in the sentence at most.
const MOST_NAMED: usize = 3;

/// Inputs with this part of the first one's share decide as well.
const AS_WELL: f64 = 0.5;

/// What is unstable in some samples: a mode or a real eigenvalue.
struct Instability {
    name: String,
    /// Share of the samples.
    share: f64,
    verb: &'static str,
    /// Mean frequency where it flutters, in Hz.
    frequency: Option<f64>,
}

impl EvalReport {
    /// Whether the share of unstable samples is the one to name: it is rare.
    pub(super) fn names_unstable(&self) -> bool {
        self.unstable_proportion < RARE && self.marginal_proportion == 0.0
    }

    /// The answer in a sentence, and a second one where the model did not answer everywhere.
    pub(super) fn verdict_sentence(&self) -> String {
        let where_asked = match self.conditions.is_empty() {
            true => String::new(),
            false => format!(" with {}", conditions_text(&self.conditions, &self.only_in_text.inputs)),
        };
        let mut reasons = Vec::new();
        if self.unstable_proportion > 0.0 {
            reasons.extend(self.instabilities());
            let indices = self.sensitivity.as_ref().and_then(SensitivityReport::ranked_for_stability);
            let effects = self.shapley.as_ref().and_then(ShapleyReport::ranked_for_stability);
            reasons.extend(indices.or(effects).and_then(|ranked| deciding_inputs(&ranked)));
        }
        let reasons = if reasons.is_empty() { String::new() } else { format!(": {}", reasons.join("; ")) };
        let sight = self.only_in_text.sight.and_then(Sight::sentence).map_or(String::new(), |text| format!(" {text}"));
        format!("{}{where_asked} {}{reasons}.{sight}{}", self.study, self.shares(), self.unknown())
    }

    /// How often.
    fn shares(&self) -> String {
        let [stable, marginal, unstable] =
            [self.stable_proportion, self.marginal_proportion, self.unstable_proportion].map(share);
        let (is_unstable, is_never) = match self.margin {
            None => ("is unstable".to_owned(), "is never unstable".to_owned()),
            Some(margin) => {
                let slow = match margin {
                    MarginReport::GrowthRate(rate) => format!("decays more slowly than {} 1/s", plain(rate)),
                    MarginReport::DampingRatio(ratio) => format!("has a damping ratio below {}", plain(ratio)),
                };
                (slow.clone(), format!("never {slow}"))
            }
        };
        if self.undamped {
            let never = self.unstable_proportion == 0.0;
            let unstable = if never { String::new() } else { format!(", unstable in {unstable}") };
            return format!("is undamped: marginal in {marginal} of cases{unstable}");
        }
        // What was found of the whole domain is no answer to conditions.
        if let Some(sight) = self.only_in_text.sight.filter(|_| self.conditions.is_empty()) {
            let is_seen = match sight {
                Sight::Everywhere { nearest, .. } if nearest > 0.0 => self.unstable_proportion == 1.0,
                Sight::Everywhere { .. } => self.unstable_proportion == 0.0 && self.marginal_proportion == 0.0,
                Sight::Unknown { .. } => false,
            };
            if is_seen {
                return format!(
                    "is {}",
                    sight.seen_in(self.samples, [self.max_re.minimum, self.max_re.maximum]).words()
                );
            }
        }
        let samples = plural(self.samples as usize, "sample");
        if self.unstable_proportion == 0.0 && self.marginal_proportion == 0.0 {
            let most = share_range(0.0, self.intervals.unstable.upper);
            return format!("{is_never} in {samples} (unstable: {most}, 95 %)");
        }
        if self.unstable_proportion == 1.0 {
            let most = share_range(0.0, self.intervals.stable.upper);
            return format!("{is_unstable} in all of {samples} (stable: {most}, 95 %)");
        }
        let marginal = match self.marginal_proportion > 0.0 {
            true => format!(", marginal in {marginal}"),
            false => String::new(),
        };
        match self.stable_proportion < RARE && marginal.is_empty() {
            true => format!("{is_unstable} in all but {stable} of cases"),
            false => format!("{is_unstable} in {unstable} of cases{marginal}"),
        }
    }

    /// Which modes, in which way and at what frequencies.
    fn instabilities(&self) -> Option<String> {
        let has_margin = self.margin.is_some();
        let mode = |mode: &ModeReport| Instability {
            name: format!("mode {}", mode.mode),
            share: mode.unstable_share,
            verb: match (has_margin, mode.flutter_share >= mode.divergence_share) {
                (true, _) => "decays too slowly",
                (false, true) if mode.divergence_share > WORTH_NAMING * mode.flutter_share => "flutters or diverges",
                (false, true) => "flutters",
                (false, false) if mode.flutter_share > WORTH_NAMING * mode.divergence_share => "diverges or flutters",
                (false, false) => "diverges",
            },
            frequency: mode.flutter_frequency_hz.map(|frequency| frequency.mean),
        };
        let real = |real: &RealReport| Instability {
            name: real.name.clone(),
            share: real.divergence_share,
            verb: if has_margin { "decays too slowly" } else { "diverges" },
            frequency: None,
        };
        let mut all: Vec<Instability> =
            self.modes.iter().map(mode).chain(self.real_eigenvalues.iter().map(real)).collect();
        all.retain(|one| one.share > 0.0);
        all.sort_by(|a, b| b.share.total_cmp(&a.share));
        let least = WORTH_NAMING * all.first()?.share;
        let (named, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|one| one.share >= least);
        let text = |Instability { name, verb, frequency, .. }: &Instability| match frequency {
            Some(frequency) => format!("{name} {verb} at about {} Hz", significant(*frequency, 3)),
            None => format!("{name} {verb}"),
        };
        let mut texts: Vec<String> = named.iter().take(MOST_NAMED).map(text).collect();
        match (named.len().saturating_sub(MOST_NAMED), others.len()) {
            (0, 0) => {}
            (0, 1) => texts.push("another more rarely".to_owned()),
            (0, rare) => texts.push(format!("{} more rarely", plural(rare, "other"))),
            (as_often, rare) => texts.push(plural(as_often + rare, "other")),
        }
        Some(texts.join(", "))
    }

    /// What the model did not answer.
    fn unknown(&self) -> String {
        match (self.unanswered_proportion, self.bounds) {
            (Some(unanswered), Some(bounds)) => format!(
                " The model did not answer in about {}, as far as its runs tell: {} are stable, whatever it would answer \
                 there.",
                share(unanswered),
                share_range(bounds.stable.lower, bounds.stable.upper)
            ),
            _ => String::new(),
        }
    }
}

/// The inputs that decide stability: the first, and those that do about as much. Nothing if that is not known.
fn deciding_inputs(ranked: &[(&str, f64)]) -> Option<String> {
    let first = ranked.first().filter(|(_, total)| *total > 0.0)?.1;
    let names: Vec<&str> =
        ranked.iter().filter(|(_, total)| *total >= AS_WELL * first).map(|(name, _)| *name).collect();
    Some(match names[..] {
        ref many if many.len() > MOST_NAMED => format!("{} inputs decide about as much", many.len()),
        [only] => format!("{only} decides"),
        [ref before @ .., last] => format!("{} and {last} decide most", before.join(", ")),
        [] => return None,
    })
}
