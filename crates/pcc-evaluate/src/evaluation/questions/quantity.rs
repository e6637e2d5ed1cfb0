//! What can be asked about: max Re λ, parts of modes, components.

use crate::components::damping_ratio;
use crate::evaluation::kernel::lanes::{BLOCK_POINTS, Lanes};
use crate::evaluation::kernel::results::Results;
use crate::surrogate::Surrogate;
use std::f64::consts::TAU;

/// A number that every sample has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Spectral abscissa max Re λ, in 1/s: `max_re`.
    MaxRe,
    /// Re λ of a mode by position, in 1/s: `re_3` for the mode of rank 3.
    GrowthRate(usize),
    /// Im λ of a mode by position, in rad/s: `im_3`.
    AngularFrequency(usize),
    /// Im λ/2π of a mode by position, in Hz: `frequency_3`.
    Frequency(usize),
    /// Damping ratio −Re λ/|λ| of a mode by position: `damping_3`.
    DampingRatio(usize),
    /// A component by id: its own name.
    Component(usize),
}

impl Quantity {
    /// The quantity of this name; `None` if the surrogate has none such.
    pub fn named(name: &str, surrogate: &Surrogate) -> Option<Self> {
        Self::all(surrogate).into_iter().find(|quantity| quantity.name(surrogate) == name)
    }

    /// All quantities of a surrogate; components that are parts of modes by themselves are not repeated.
    pub fn all(surrogate: &Surrogate) -> Vec<Self> {
        let modes = surrogate.modes().len();
        let mut all = vec![Self::MaxRe];
        all.extend((0..modes).flat_map(|mode| [Self::GrowthRate(mode), Self::AngularFrequency(mode)]));
        all.extend((0..modes).map(Self::Frequency));
        all.extend((0..modes).map(Self::DampingRatio));
        let names: Vec<String> = all.iter().map(|quantity| quantity.name(surrogate)).collect();
        let components = (0..surrogate.component_count()).map(Self::Component);
        all.extend(components.filter(|component| !names.contains(&component.name(surrogate))));
        all
    }

    /// Name on the command line and in reports.
    pub fn name(self, surrogate: &Surrogate) -> String {
        let rank = |mode: usize| surrogate.modes().get(mode).copied().unwrap_or_default();
        match self {
            Self::MaxRe => "max_re".to_owned(),
            Self::GrowthRate(mode) => format!("re_{}", rank(mode)),
            Self::AngularFrequency(mode) => format!("im_{}", rank(mode)),
            Self::Frequency(mode) => format!("frequency_{}", rank(mode)),
            Self::DampingRatio(mode) => format!("damping_{}", rank(mode)),
            Self::Component(id) => {
                let components = surrogate.components();
                components.iter().find(|component| component.id == id).map(|c| c.name.clone()).unwrap_or_default()
            }
        }
    }

    /// Its values at the points of a block.
    #[inline(always)]
    pub(crate) fn values(self, results: &Results) -> Lanes {
        match self {
            Self::MaxRe => results.max_re,
            Self::GrowthRate(mode) => results.growth_rates[mode],
            Self::AngularFrequency(mode) => results.angular_frequencies[mode],
            Self::Frequency(mode) => {
                let mut frequency = results.angular_frequencies[mode];
                frequency.0.iter_mut().for_each(|value| *value *= 1.0 / TAU);
                frequency
            }
            Self::DampingRatio(mode) => damping_ratios(&results.growth_rates[mode], &results.angular_frequencies[mode]),
            Self::Component(id) => results.components[id],
        }
    }
}

/// −Re λ/|λ|.
#[inline(always)]
pub(crate) fn damping_ratios(growth_rate: &Lanes, angular_frequency: &Lanes) -> Lanes {
    let mut ratios = Lanes::splat(0.0);
    for lane in 0..BLOCK_POINTS {
        let (re, im) = (growth_rate.0[lane], angular_frequency.0[lane]);
        ratios.0[lane] = damping_ratio(re, im);
    }
    ratios
}
