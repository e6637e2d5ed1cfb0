//! What can be asked about: max Re λ, parts of eigenvalues, components, kinds of instability.

use crate::components::damping_ratio;
use crate::evaluation::kernel::lanes::{BLOCK_POINTS, Lanes};
use crate::evaluation::kernel::results::Results;
use crate::surrogate::Surrogate;
use std::f64::consts::TAU;

/// Names of verdicts, which are events by themselves.
pub(super) const FLUTTER: &str = "flutter";
pub(super) const DIVERGENCE: &str = "divergence";
pub(super) const MARGINAL: &str = "marginal";

/// A number that every sample has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Spectral abscissa max Re λ, in 1/s: `max_re`.
    MaxRe,
    /// Re λ of an eigenvalue by position, in 1/s: `re_3` for mode 3, `re_3_b` for its second eigenvalue, `real_1`.
    GrowthRate(usize),
    /// Im λ of a mode by the position of its eigenvalue, in rad/s: `im_3`.
    AngularFrequency(usize),
    /// Im λ/2π of a mode by the position of its eigenvalue, in Hz: `frequency_3`.
    Frequency(usize),
    /// Damping ratio −Re λ/|λ| of a mode by the position of its eigenvalue: `damping_3`.
    DampingRatio(usize),
    /// A component by id: its own name.
    Component(usize),
    /// 1 where the eigenvalue that decides is unstable and oscillates, else 0: `flutter`.
    Flutter,
    /// 1 where the eigenvalue that decides is unstable and real, else 0: `divergence`.
    Divergence,
    /// 1 where the eigenvalue that decides neither grows nor decays, else 0: `marginal`.
    Marginal,
}

impl Quantity {
    /// The quantity of this name; `None` if the surrogate has none such.
    pub fn named(name: &str, surrogate: &Surrogate) -> Option<Self> {
        let kinds = [Self::Flutter, Self::Divergence, Self::Marginal];
        Self::all(surrogate).into_iter().chain(kinds).find(|quantity| quantity.name(surrogate) == name)
    }

    /// All quantities of a surrogate that vary, not the kinds of instability; components that are parts of eigenvalues
    /// by themselves are not repeated.
    pub fn all(surrogate: &Surrogate) -> Vec<Self> {
        let labels = surrogate.labels();
        let is_mode = |at: &usize| labels[*at].mode().is_some();
        let modes = || (0..labels.len()).filter(is_mode);
        let mut all = vec![Self::MaxRe];
        for at in 0..labels.len() {
            all.push(Self::GrowthRate(at));
            all.extend(Some(Self::AngularFrequency(at)).filter(|_| is_mode(&at)));
        }
        all.extend(modes().map(Self::Frequency));
        all.extend(modes().map(Self::DampingRatio));
        let names: Vec<String> = all.iter().map(|quantity| quantity.name(surrogate)).collect();
        let components = (0..surrogate.component_count()).map(Self::Component);
        all.extend(components.filter(|component| !names.contains(&component.name(surrogate))));
        all
    }

    /// Name on the command line and in reports.
    pub fn name(self, surrogate: &Surrogate) -> String {
        let label = |at: usize| surrogate.labels()[at];
        let mode = |at: usize| label(at).mode().unwrap_or_default();
        match self {
            Self::MaxRe => "max_re".to_owned(),
            Self::GrowthRate(at) => label(at).growth_rate(),
            Self::AngularFrequency(at) => format!("im_{}", mode(at)),
            Self::Frequency(at) => format!("frequency_{}", mode(at)),
            Self::DampingRatio(at) => format!("damping_{}", mode(at)),
            Self::Component(id) => {
                let components = surrogate.components();
                components.iter().find(|component| component.id == id).map(|c| c.name.clone()).unwrap_or_default()
            }
            Self::Flutter => FLUTTER.to_owned(),
            Self::Divergence => DIVERGENCE.to_owned(),
            Self::Marginal => MARGINAL.to_owned(),
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
            Self::Flutter => indicator(results, |excess, frequency| excess > 0.0 && frequency != 0.0),
            Self::Divergence => indicator(results, |excess, frequency| excess > 0.0 && frequency == 0.0),
            Self::Marginal => indicator(results, |excess, _| excess == 0.0),
        }
    }
}

/// 1 where the largest excess and Im λ of its eigenvalue are as they should be.
#[inline(always)]
fn indicator(results: &Results, holds: impl Fn(f64, f64) -> bool) -> Lanes {
    let mut found = Lanes::splat(0.0);
    for lane in 0..BLOCK_POINTS {
        found.0[lane] = if holds(results.excess.0[lane], results.top_frequency.0[lane]) { 1.0 } else { 0.0 };
    }
    found
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
