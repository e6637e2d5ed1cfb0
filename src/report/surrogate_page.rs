//! A surrogate on one page: the answer and how sure it is, what the surrogate is made of, and pictures.

use super::charts::{density_chart, mode_charts, shapley_charts, sobol_charts, spectrum_chart, validation_chart};
use super::compare::CompareReport;
use super::density;
use super::eval::EvalReport;
use super::inspect::InspectReport;
use super::numbers::{share, significant};
use super::page::Page;
use super::section_chart::section_chart;
use pcc_charts::Color;
use pcc_evaluate::components::Block;
use pcc_evaluate::evaluation::{Plan, evaluate_points};
use pcc_evaluate::foundation::count;
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::surrogate::Surrogate;

/// Inputs over which modes are drawn.
const DRAWN_INPUTS: usize = 3;

/// Relative errors of the proportion and misclassified shares from here on are shown as a warning, in percent.
const LARGE_ERROR_PERCENT: f64 = 1.0;

/// Points of the surrogate that are kept for pictures.
const POINTS: u64 = 20_000;

/// Points of a scatter: more would only hide each other.
const SCATTER: usize = 1500;

/// A surrogate and what was found with it.
#[derive(Debug)]
pub struct SurrogatePage<'a> {
    /// The surrogate.
    pub surrogate: &'a Surrogate,
    /// What is inside its file.
    pub inspect: &'a InspectReport,
    /// What samples of it say.
    pub eval: &'a EvalReport,
    /// Standardized points.
    pub points: &'a [Vec<f64>],
    /// The surrogate there.
    pub block: &'a Block,
    /// The model at the same points, if a study was given.
    pub validation: Option<Validation<'a>>,
}

/// The first points that `eval` and `reference` take, standardized, and the surrogate there: what a page draws.
pub fn page_points(surrogate: &Surrogate, seed: u64) -> (Vec<Vec<f64>>, Block) {
    let points = random_points(&surrogate.inputs, seed, Purpose::Evaluation, 0..POINTS);
    let references: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
    let block = evaluate_points(surrogate, &Plan::new(surrogate), &references);
    (points, block)
}

/// The model at the points of a page.
#[derive(Debug)]
pub struct Validation<'a> {
    /// max Re λ of the model at the first points, over all its eigenvalues, in 1/s.
    pub max_re: &'a [f64],
    /// Surrogate and model on all of these.
    pub compare: &'a CompareReport,
}

impl SurrogatePage<'_> {
    /// The page as an HTML file.
    pub fn to_html(&self) -> String {
        let mut page = Page::new(&format!("Stability of {}", self.eval.study), "report");
        self.answer(&mut page);
        self.pictures(&mut page);
        self.modes(&mut page);
        self.content(&mut page);
        page.into_html()
    }

    fn answer(&self, page: &mut Page) {
        let eval = self.eval;
        page.lead(&eval.verdict);
        page.facts(&eval.facts().pairs());
        if let Some((name, value, words)) = eval.extrapolation() {
            page.facts(&[(name, format!("{value}; {words}"))]);
        }
        eval.warnings.iter().for_each(|warning| page.warning(warning));
        if let Some(Validation { compare, .. }) = &self.validation {
            let checked = format!(
                "The model was run at the first {} of these samples, too: of those {} are stable by the model and {} by the \
                 surrogate, a relative error of {} of the {} share, and {} % are misclassified.",
                count(compare.samples),
                share(compare.proportion_model),
                share(compare.proportion_surrogate),
                compare
                    .smallest_share
                    .relative_error_percent
                    .map_or("infinity".to_owned(), |error| format!("{} %", significant(error, 2))),
                compare.smallest_share.name,
                significant(compare.misclassified_percent, 2)
            );
            let is_close =
                compare.smallest_share.relative_error_percent.is_some_and(|error| error < LARGE_ERROR_PERCENT)
                    && compare.misclassified_percent < LARGE_ERROR_PERCENT;
            if is_close { page.paragraph(&checked) } else { page.warning(&checked) }
        }
    }

    fn pictures(&self, page: &mut Page) {
        page.section("Where it loses stability, and why");
        let mut charts = Vec::new();
        let title = format!("Density of max Re λ over {}", self.eval.judged_by);
        let surrogate = ("surrogate", Color::Red, self.block.max_re.as_slice());
        match &self.validation {
            Some(Validation { max_re, .. }) => {
                charts.push(density_chart(&title, &[("model", Color::Blue, max_re), surrogate]));
                let shown = max_re.len().min(self.block.max_re.len()).min(SCATTER);
                charts.push(validation_chart(&max_re[..shown], &self.block.max_re[..shown]));
            }
            None => charts.push(density_chart(&title, &[surrogate])),
        }
        if let Some(sensitivity) = &self.eval.sensitivity {
            charts.extend(sobol_charts(sensitivity));
        }
        if let Some(shapley) = &self.eval.shapley {
            charts.extend(shapley_charts(shapley));
        }
        page.charts(&charts);
    }

    fn modes(&self, page: &mut Page) {
        page.section("Modes over the most influential inputs");
        let inputs: Vec<usize> = match (&self.eval.sensitivity, &self.eval.shapley) {
            (Some(sensitivity), _) => sensitivity.order(),
            (None, Some(shapley)) => shapley.order(),
            (None, None) => (0..self.surrogate.inputs.dimension()).collect(),
        };
        let shown = self.points.len().min(SCATTER);
        let mut charts = Vec::new();
        let few = self.block.first(shown);
        let influential = inputs.into_iter().take(DRAWN_INPUTS);
        for j in influential.clone() {
            let input = &self.surrogate.inputs.inputs()[j];
            let x: Vec<f64> = self.points[..shown].iter().map(|point| input.marginal.physical(point[j])).collect();
            charts.extend(mode_charts(input, &x, &self.surrogate.labels(), &few));
        }
        page.charts(&charts);
        page.table(&self.eval.mode_table());
        page.section("Along the most influential inputs");
        page.paragraph(
            "The other inputs stay at their medians. Intervals say how far the surrogate may be off at a point, by runs \
             left out of the fit.",
        );
        page.charts(&influential.map(|j| section_chart(self.surrogate, j)).collect::<Vec<_>>());
    }

    fn content(&self, page: &mut Page) {
        page.section("Inputs");
        let sparkline = |(j, input)| density::sparkline(input, self.surrogate.trained_interval(j));
        let densities: Vec<_> = self.surrogate.inputs.inputs().iter().enumerate().map(sparkline).collect();
        page.table_with_pictures(&self.inspect.input_table(), "density", &densities);
        if let Some(ranges) = self.inspect.range_table() {
            page.table(&ranges);
        }
        if self.surrogate.trained_domain.is_some() {
            page.paragraph(
                "Densities are filled where the model was run, up to the marks. Beyond, the surrogate extrapolates.",
            );
        }
        page.section("How the surrogate was made");
        page.facts(&self.inspect.facts().pairs());
        page.facts(&self.inspect.further_facts().pairs());
        page.facts(&self.inspect.hashes());
        page.table(&super::fit::FitReport::table(&self.inspect.components));
        page.paragraph(
            "R² is the share of the variance explained at the points of the design, S² that at points left out of the fit.",
        );
        page.charts(&[spectrum_chart(self.surrogate)]);
        if let Some(Validation { compare, .. }) = &self.validation {
            page.section("Errors against the model");
            page.table(&compare.component_table());
        }
    }
}
