//! What each component misses at model runs that the fit has not seen.

/// Runs that are kept: intervals at 99.5 % need 199, and more make them no sharper.
const MOST_RUNS: usize = 200;

/// Residuals of all components at runs of the design, each by the fit without the run. Runs that were chosen near the
/// stability boundary are not among them: they say nothing of the inputs' laws.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::surrogate::LeftOut;
/// let left_out = LeftOut::new(vec![vec![0.1, -0.2], vec![0.0, 0.3]]).expect("two residuals at each of two runs");
/// assert_eq!(left_out.runs().len(), 2);
/// assert!(LeftOut::new(Vec::new()).is_none());
/// assert!(LeftOut::new(vec![vec![0.1], vec![f64::NAN]]).is_none());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOut {
    runs: Vec<Vec<f64>>,
}

impl LeftOut {
    /// Residuals in the units of the components: a list per run, with one entry per component by id. Of more than 200
    /// runs so many are kept, evenly spread. `None` without runs, if lists differ in length or are empty, and if a
    /// residual is not finite.
    pub fn new(runs: Vec<Vec<f64>>) -> Option<Self> {
        let components = runs.first()?.len();
        let is_whole = |run: &Vec<f64>| run.len() == components && run.iter().all(|residual| residual.is_finite());
        if components == 0 || !runs.iter().all(is_whole) {
            return None;
        }
        let (all, kept) = (runs.len(), runs.len().min(MOST_RUNS));
        let mut is_kept = vec![false; all];
        (0..kept).for_each(|k| is_kept[k * all / kept] = true);
        let runs = runs.into_iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(run, _)| run).collect();
        Some(Self { runs })
    }

    /// The residuals at each run, by component.
    pub fn runs(&self) -> &[Vec<f64>] {
        &self.runs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_runs_two_hundred_are_kept_evenly_spread() {
        let runs = |count: u32| (0..count).map(|i| vec![f64::from(i)]).collect::<Vec<_>>();
        assert_eq!(LeftOut::new(runs(200)).unwrap().runs(), runs(200));
        let kept = LeftOut::new(runs(500)).unwrap();
        assert_eq!(kept.runs().len(), 200);
        assert_eq!(kept.runs()[..4], [[0.0], [2.0], [5.0], [7.0]]);
    }

    #[test]
    fn what_is_not_whole_is_none() {
        for wrong in [vec![vec![]], vec![vec![1.0], vec![1.0, 2.0]], vec![vec![f64::INFINITY]]] {
            assert_eq!(LeftOut::new(wrong.clone()), None, "{wrong:?}");
        }
    }
}
