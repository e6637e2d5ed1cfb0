//! Questions as they are typed: `mu=0.1..0.2`, `mu=0..0.5:101`, `max_re<-1`, `max_re=-20..20:40`.

use clap::{Args, ValueEnum};
use pcc_evaluate::evaluation::{Condition, Event, Sampler, Sweep};
use pcc_evaluate::session::HistogramRequest;

/// Groups of the help.
const SAMPLED: &str = "What is sampled";
pub(super) const ASKED: &str = "What is asked beside stability";

/// What is asked beside the stability of random samples.
#[derive(Debug, Args)]
#[group(skip)]
pub(super) struct QuestionOptions {
    /// How samples are drawn
    #[arg(long, help_heading = SAMPLED, value_enum, default_value = "monte-carlo", conflicts_with = "points")]
    pub sampler: SamplerName,

    /// Independent randomisations that the samples of sobol or latin-hypercube are divided among, at least 2; the error
    /// is estimated from their spread [default: 16]
    #[arg(long, help_heading = SAMPLED, value_name = "R", conflicts_with = "points", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub replicates: Option<u32>,

    /// Confine or fix inputs, in physical units, with decimal points: mu=0.1..0.2,k_p=15.8e6
    #[arg(long = "where", help_heading = SAMPLED, value_name = "CONDITIONS", value_delimiter = ',', value_parser = condition, conflicts_with = "points")]
    pub conditions: Vec<Condition>,

    /// Set INPUT to POINTS values one after the other, each with all samples; give it twice for a stability map, more
    /// often for a longer table. Without --histogram, --quantiles and --critical
    #[arg(long, help_heading = ASKED, value_name = "INPUT=FROM..TO:POINTS", value_parser = sweep, conflicts_with = "points")]
    pub sweep: Vec<Sweep>,

    /// Also count the samples with max_re, re_K, im_K, frequency_K, damping_K (mode K) or a component below or above a
    /// value: 'max_re<-0.1,frequency_3>600'
    #[arg(long, help_heading = ASKED, value_name = "EVENTS", value_delimiter = ',', value_parser = event, conflicts_with = "points")]
    pub events: Vec<Event>,

    /// Also show the histogram of a quantity, as in --events [default: max_re]
    #[arg(
        long,
        help_heading = ASKED,
        value_name = "QUANTITY[=LOWER..UPPER:BINS]",
        value_parser = histogram,
        num_args = 0..=1,
        default_missing_value = "max_re",
        conflicts_with_all = ["points", "sweep"]
    )]
    pub histogram: Vec<HistogramRequest>,

    /// Also show quantiles of max_re and of every mode at these probabilities, from 0 to 1 [default:
    /// 0.01,0.05,0.25,0.5,0.75,0.95,0.99]
    #[arg(
        long,
        help_heading = ASKED,
        value_name = "LEVELS",
        value_delimiter = ',',
        value_parser = level,
        num_args = 0..=1,
        default_missing_values = ["0.01", "0.05", "0.25", "0.5", "0.75", "0.95", "0.99"],
        conflicts_with_all = ["points", "sweep"]
    )]
    pub quantiles: Vec<f64>,
}

/// A sampler by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum SamplerName {
    /// Independent random points
    MonteCarlo,
    /// Scrambled Sobol' points: far smaller errors for the same number of samples
    Sobol,
    /// Latin hypercubes: smaller errors where inputs act on their own
    LatinHypercube,
}

impl From<SamplerName> for Sampler {
    fn from(name: SamplerName) -> Self {
        match name {
            SamplerName::MonteCarlo => Self::MonteCarlo,
            SamplerName::Sobol => Self::Sobol,
            SamplerName::LatinHypercube => Self::LatinHypercube,
        }
    }
}

/// Shard number and number of shards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shard {
    pub number: u64,
    pub of: u64,
}

/// `INPUT=LOWER..UPPER` or `INPUT=VALUE`.
pub(super) fn condition(text: &str) -> Result<Condition, String> {
    const FORM: &str = "write INPUT=LOWER..UPPER or INPUT=VALUE, like mu=0.1..0.2,k_p=15.8e6: decimal points, and commas between conditions";
    let (input, value) = named(text).ok_or(FORM)?;
    let (lower, upper) = value.split_once("..").unwrap_or((value, value));
    let (lower, upper) = (number(lower).ok_or(FORM)?, number(upper).ok_or(FORM)?);
    Ok(Condition { input, lower, upper })
}

/// `INPUT=FROM..TO:POINTS`.
pub(super) fn sweep(text: &str) -> Result<Sweep, String> {
    const FORM: &str = "write INPUT=FROM..TO:POINTS, like mu=0..0.5:101";
    let (input, value) = named(text).ok_or(FORM)?;
    let (from, to, points) = divided_range(value).ok_or(FORM)?;
    if points < 2 {
        return Err("a sweep has at least 2 points, its first and its last value".to_owned());
    }
    Ok(Sweep { input, from, to, points })
}

/// `QUANTITY<VALUE`, `QUANTITY>VALUE`, `flutter` or `divergence`.
pub(super) fn event(text: &str) -> Result<Event, String> {
    const FORM: &str = "write QUANTITY<VALUE or QUANTITY>VALUE in quotes, like 'max_re<-1', or a word: flutter, divergence or marginal";
    if let Some(event) = Event::of_kind(text.trim()) {
        return Ok(event);
    }
    let place = text.find(['<', '>']).ok_or(FORM)?;
    let (quantity, rest) = text.split_at(place);
    let quantity = quantity.trim();
    let threshold = number(&rest[1..]).filter(|_| !quantity.is_empty()).ok_or(FORM)?;
    Ok(Event { quantity: quantity.to_owned(), below: rest.starts_with('<'), threshold })
}

/// `QUANTITY` or `QUANTITY=LOWER..UPPER:BINS`.
pub(super) fn histogram(text: &str) -> Result<HistogramRequest, String> {
    const FORM: &str = "write QUANTITY or QUANTITY=LOWER..UPPER:BINS, like max_re=-20..20:40";
    if !text.contains('=') {
        return Ok(HistogramRequest { quantity: text.trim().to_owned(), bins: None });
    }
    let (quantity, value) = named(text).ok_or(FORM)?;
    Ok(HistogramRequest { quantity, bins: Some(divided_range(value).ok_or(FORM)?) })
}

/// A probability.
pub(super) fn level(text: &str) -> Result<f64, String> {
    number(text)
        .filter(|level| (0.0..=1.0).contains(level))
        .ok_or("write a probability from 0 to 1, like 0.99".to_owned())
}

/// `NUMBER/OF`, from 0.
pub(super) fn shard(text: &str) -> Result<Shard, String> {
    const FORM: &str = "write NUMBER/OF, numbers from 0, like 0/8 to 7/8";
    let (shard, of) = text.split_once('/').ok_or(FORM)?;
    let (number, of): (u64, u64) = (shard.trim().parse().map_err(|_| FORM)?, of.trim().parse().map_err(|_| FORM)?);
    match of {
        0 => Err(FORM.to_owned()),
        _ if number >= of => Err(format!("the last of {of} shards is {}/{of}, numbers are from 0", of - 1)),
        _ => Ok(Shard { number, of }),
    }
}

/// Name and value on either side of the first `=`.
fn named(text: &str) -> Option<(String, &str)> {
    let (name, value) = text.split_once('=')?;
    let name = name.trim();
    (!name.is_empty()).then(|| (name.to_owned(), value))
}

/// `FROM..TO:COUNT`.
fn divided_range(text: &str) -> Option<(f64, f64, u32)> {
    let (range, count) = text.split_once(':')?;
    let (from, to) = range.split_once("..")?;
    // Also 1e3; more than fits is too many in any case, and refused as such.
    let count = number(count).filter(|count| count.fract() == 0.0 && *count >= 0.0)?;
    Some((number(from)?, number(to)?, count as u32))
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn questions_are_read_as_they_are_meant() {
        let mu = |lower, upper| Condition { input: "mu".to_owned(), lower, upper };
        assert_eq!(condition("mu=0.1..0.2"), Ok(mu(0.1, 0.2)));
        assert_eq!(condition("mu = -1e-3 .. .5"), Ok(mu(-1e-3, 0.5)));
        assert_eq!(condition("mu=0.3"), Ok(mu(0.3, 0.3)));
        assert_eq!(sweep("mu=0..0.5:101"), Ok(Sweep { input: "mu".to_owned(), from: 0.0, to: 0.5, points: 101 }));
        let margin = |below| Event { quantity: "max_re".to_owned(), below, threshold: -1.0 };
        assert_eq!((event("max_re<-1"), event("max_re > -1")), (Ok(margin(true)), Ok(margin(false))));
        let request = |bins| HistogramRequest { quantity: "re_3".to_owned(), bins };
        assert_eq!(histogram("re_3"), Ok(request(None)));
        assert_eq!(histogram("re_3=-20..20:40"), Ok(request(Some((-20.0, 20.0, 40)))));
        assert_eq!(shard("2/3"), Ok(Shard { number: 2, of: 3 }));
        assert_eq!(level("0.99"), Ok(0.99));
    }

    #[test]
    fn what_is_not_understood_is_refused() {
        for text in ["", "mu", "=1", "mu=", "mu=1..", "mu=..2", "mu=1..2..3", "mu=nan", "mu=1..inf", "mu=a"] {
            assert!(condition(text).is_err(), "{text}");
        }
        for text in [
            "",
            "mu",
            "mu=0..1",
            "mu=0..1:0",
            "mu=0..1:1",
            "mu=0..1:2.5",
            "mu=0..1:-3",
            "mu=0..1:2:3",
            "=0..1:2",
            "mu=..1:2",
        ] {
            assert!(sweep(text).is_err(), "{text}");
        }
        for text in ["", "max_re", "max_re<", "<1", "max_re=1", "max_re<x", "max_re<<1"] {
            assert!(event(text).is_err(), "{text}");
        }
        for text in ["max_re=", "max_re=1", "max_re=1..2", "max_re=1..2:x", "=1..2:3"] {
            assert!(histogram(text).is_err(), "{text}");
        }
        for text in ["", "1", "3/3", "4/3", "0/0", "-1/3", "a/3", "1/b", "1/2/3"] {
            assert!(shard(text).is_err(), "{text}");
        }
        for text in ["", "x", "-0.1", "1.1", "nan"] {
            assert!(level(text).is_err(), "{text}");
        }
    }
}
