//! Narrowing the interval in which stability is lost.
//!
//! Interpolate, truncate and project (Oliveira and Takahashi 2020, <https://doi.org/10.1145/3423597>): a trial where
//! the straight line between both ends crosses zero, moved towards the middle so that both ends come closer, and not
//! farther from the middle than bisection could afford. Functions that are nearly straight inside a cell take six to
//! eight trials instead of the 24 of bisection, and no function takes more than one trial more than bisection.

/// Halvings of a cell of the grid of [`crate::evaluation::critical_values`] that bring it from 1/64 to 2⁻³⁰ < 10⁻⁹ of
/// the domain's width.
const HALVINGS: i32 = 24;

/// n₀ of the method: trials that interpolation may cost more than bisection.
const SLACK: i32 = 1;

/// Trials after which every bracket is narrow.
pub(crate) const TRIALS: i32 = HALVINGS + SLACK;

/// κ₁ times the width at the start, and the exponent κ₂ is 2: how far interpolated trials are moved. The authors'
/// choice.
const TRUNCATION: f64 = 0.2;

/// A point of the input's standardized domain with the largest excess there: max Re λ without a margin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    pub xi: f64,
    pub excess: f64,
}

/// A point that is not unstable with an unstable one above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bracket {
    pub stable: End,
    pub unstable: End,
    /// Width before the first trial.
    initial: f64,
    trials: i32,
}

impl Bracket {
    pub fn new(stable: End, unstable: End) -> Self {
        Self { stable, unstable, initial: unstable.xi - stable.xi, trials: 0 }
    }

    /// Whether the ends are as close as they have to be.
    pub fn is_narrow(&self) -> bool {
        self.trials >= TRIALS || self.width() <= self.final_width()
    }

    /// Where to evaluate next.
    pub fn trial(&self) -> f64 {
        let width = self.width();
        let middle = self.stable.xi + 0.5 * width;
        let share = self.stable.excess / (self.stable.excess - self.unstable.excess);
        let interpolated = self.stable.xi + share * width;
        let towards_middle = (middle - interpolated).signum();
        let shift = TRUNCATION * width * width / self.initial;
        let truncated =
            if shift <= (middle - interpolated).abs() { interpolated + towards_middle * shift } else { middle };
        // The greatest width that halvings alone can still make narrow in the trials that are left.
        let affordable = self.final_width() * f64::from(TRIALS - self.trials).exp2();
        let reach = (0.5 * (affordable - width)).max(0.0);
        if (truncated - middle).abs() <= reach { truncated } else { middle - towards_middle * reach }
    }

    /// Takes the excess at the trial.
    pub fn narrow(&mut self, at: End) {
        self.trials += 1;
        *(if at.excess <= 0.0 { &mut self.stable } else { &mut self.unstable }) = at;
    }

    fn width(&self) -> f64 {
        self.unstable.xi - self.stable.xi
    }

    fn final_width(&self) -> f64 {
        self.initial * f64::from(-HALVINGS).exp2()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Width and number of trials of the bracket around the first sign change of `f` from [0, 1/32].
    fn search(f: impl Fn(f64) -> f64) -> (Bracket, i32) {
        let end = |xi| End { xi, excess: f(xi) };
        let mut bracket = Bracket::new(end(0.0), end(1.0 / 32.0));
        while !bracket.is_narrow() {
            let xi = bracket.trial();
            assert!(bracket.stable.xi <= xi && xi <= bracket.unstable.xi, "{bracket:?}: {xi}");
            bracket.narrow(end(xi));
        }
        (bracket, bracket.trials)
    }

    #[test]
    fn smooth_functions_take_few_trials() {
        for root in [1e-4, 0.011, 0.02, 0.0312] {
            // A straight line; a slope that changes by a factor of about 3, and of about 10.
            for (curvature, most) in [(0.0, 8), (32.0, 8), (320.0, 12)] {
                let f = |x: f64| (x - root) * (1.0 + curvature * x);
                let (bracket, trials) = search(f);
                assert!(bracket.stable.xi < root && root <= bracket.unstable.xi);
                assert!(bracket.width() <= 2f64.powi(-29) && trials <= most, "{root}, {curvature}: {trials}");
            }
        }
    }

    #[test]
    fn no_function_takes_more_than_one_trial_more_than_bisection() {
        let root = 0.0123;
        let step = |below: f64, above: f64| move |x: f64| if x < root { below } else { above };
        let kink = |x: f64| if x < root { 1e-9 * (x - root) } else { 1e9 * (x - root) };
        for (below, above) in [(-1.0, 1.0), (-1e300, 1e-300), (-1e-300, 1e300), (-1.7e308, 1.7e308), (0.0, 5e-324)] {
            let (bracket, trials) = search(step(below, above));
            assert!(trials <= TRIALS && bracket.width() <= 2f64.powi(-29) * (1.0 + 1e-6), "{bracket:?}");
            assert!(bracket.stable.xi < root && root <= bracket.unstable.xi);
        }
        let (bracket, _) = search(kink);
        assert!(bracket.width() <= 2f64.powi(-29) && bracket.stable.xi < root && root <= bracket.unstable.xi);
    }

    #[test]
    fn the_end_that_is_not_unstable_may_be_the_crossing_itself() {
        let (bracket, _) = search(|x| x);
        assert!(bracket.stable == End { xi: 0.0, excess: 0.0 } && bracket.width() <= 2f64.powi(-29));
    }
}
