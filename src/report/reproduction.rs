//! The paper, reproduced, on one page: table 2 and figures 3 and 4 with the paper's figures beside ours, and what it
//! lacks.

use super::charts::{density_chart, sobol_charts};
use super::numbers::significant;
use super::page::Page;
use super::paper_charts::{cost_chart, figure_3, figure_4};
use super::sensitivity::SensitivityReport;
use super::table::{Align, Table};
use crate::reproduce::{Closer, Cloud, MOST_INPUTS, PAIR, PaperRow, Range, Reproduction, Row, TABLE_2};
use pcc_charts::{Chart, Color, sheet};
use pcc_evaluate::foundation::count;

/// Errors below this are not worth digits, in percent.
const SMALLEST_ERROR: f64 = 1e-4;

const INVARIANTS_HEADING: &str = "The same methods on invariants";
const INVARIANTS: &str = "Expanded are modes 1 and 2 themselves and, of the two modes that coalesce, the mean of the eigenvalues and c0, minus \
                          their squared half difference. Least squares take two equations per term.";

/// Panels side by side in a file.
const COLUMNS: usize = 2;

/// Table 2: rows of one kind of build together, smallest and largest values over its designs. The first table has the
/// paper's methods with the paper's figures beside ours, the second the same methods on invariants; empty ones are left
/// out.
pub fn table_2(rows: &[Row]) -> Vec<Table> {
    let (papers, beyond): (Vec<_>, Vec<_>) = groups(rows).into_iter().partition(|group| is_papers(group[0]));
    let tables = [papers_methods(&papers), invariants(&beyond)];
    tables.into_iter().filter(|table| table.rows().len() > 1).collect()
}

/// Whether the paper has this kind of build.
fn is_papers(row: &Row) -> bool {
    row.target == "eigenvalues"
}

/// The same for a terminal: without errors of means and variances, and without the paper's orders.
pub fn short_table_2(rows: &[Row]) -> Vec<Table> {
    const LEFT_OUT: [&str; 2] = ["mean %", "variance %"];
    let shortened = |table: &Table| {
        let heads = &table.rows()[0];
        let is_kept = |k: usize| {
            let about = if heads[k] == PAPER { heads[k - 1].as_str() } else { heads[k].as_str() };
            !(LEFT_OUT.contains(&about) || heads[k] == PAPER && about == "order")
        };
        let kept: Vec<usize> = (0..heads.len()).filter(|&k| is_kept(k)).collect();
        let columns: Vec<(&str, Align)> = kept.iter().map(|&k| (heads[k].as_str(), table.aligns()[k])).collect();
        let mut short = Table::new(&columns);
        table.rows()[1..].iter().for_each(|row| short.row(kept.iter().map(|&k| row[k].as_str())));
        short
    };
    table_2(rows).iter().map(shortened).collect()
}

/// Head of a column with the paper's figures for the column before it.
const PAPER: &str = "paper";

fn papers_methods(groups: &[Vec<&Row>]) -> Table {
    let right = Align::Right;
    let mut table = Table::new(&[
        ("r", right),
        ("method", Align::Left),
        ("order", right),
        ("paper", right),
        ("runs", right),
        ("mesh", right),
        ("paper", right),
        ("mean %", right),
        ("paper", right),
        ("variance %", right),
        ("paper", right),
        ("proportion %", right),
        ("paper", right),
        ("misclassified %", right),
    ]);
    for group in groups {
        let [r, method, order, runs, mesh, mean, variance, proportion, misclassified] = cells(group);
        let paper = papers_row(group[0]);
        let printed = |value: fn(&PaperRow) -> Range| paper.map(value);
        let error = |value: fn(&PaperRow) -> Range| printed(value).map_or(String::new(), as_printed);
        let number = |value: fn(&PaperRow) -> Range| printed(value).map_or(String::new(), whole);
        table.row([
            r,
            method,
            order,
            number(|paper| paper.order),
            runs,
            mesh,
            number(|paper| paper.direct_computations),
            mean,
            error(|paper| paper.mean_error),
            variance,
            error(|paper| paper.variance_error),
            proportion,
            error(|paper| paper.stability_error),
            misclassified,
        ]);
    }
    table
}

fn invariants(groups: &[Vec<&Row>]) -> Table {
    let right = Align::Right;
    let mut table = Table::new(&[
        ("r", right),
        ("method", Align::Left),
        ("order", right),
        ("runs", right),
        ("mesh", right),
        ("mean %", right),
        ("variance %", right),
        ("proportion %", right),
        ("misclassified %", right),
    ]);
    groups.iter().for_each(|group| table.row(cells(group)));
    table
}

/// What was found with one kind of build: r, method, order, runs, runs of the final mesh, errors of mean, variance and
/// proportion, misclassified points.
fn cells(group: &[&Row]) -> [String; 9] {
    let first = group[0];
    let spread = |value: fn(&Row) -> Option<f64>| {
        let values: Option<Vec<f64>> = group.iter().map(|row| value(row)).collect();
        values.map_or("–".to_owned(), |values| range(extremes(values)))
    };
    let counted = |value: fn(&Row) -> u64| whole(extremes(group.iter().map(|row| value(row) as f64).collect()));
    [
        first.r.to_string(),
        name(first),
        counted(|row| row.order.into()),
        counted(|row| row.direct_computations),
        counted(|row| row.final_mesh_computations),
        spread(|row| row.mean_error_percent),
        spread(|row| row.variance_error_percent),
        spread(|row| row.stability_error_percent),
        spread(|row| Some(row.misclassified_percent)),
    ]
}

/// Rows of the same build with other designs.
fn groups(rows: &[Row]) -> Vec<Vec<&Row>> {
    let is_same = |a: &Row, b: &Row| {
        let build = |row: &Row| (row.r, row.method, row.target, row.derivatives);
        build(a) == build(b) && a.method == "sparse"
    };
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        match groups.iter_mut().find(|group| is_same(group[0], row)) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    // As in the paper: by method for each number of parameters.
    let place = |row: &Row| {
        let method = ["gpc", "me-gpc", "sparse"].iter().position(|method| *method == row.method);
        (row.r, method, row.derivatives)
    };
    groups.sort_by_key(|group| place(group[0]));
    groups
}

fn name(row: &Row) -> String {
    let method = match row.method {
        "gpc" if row.is_least_squares => "gPC, least squares",
        "gpc" => "gPC",
        "me-gpc" => "ME-gPC",
        _ => "sparse PC",
    };
    if row.derivatives { format!("{method} with derivatives") } else { method.to_owned() }
}

/// The paper's row for this build, if it has one: quadratures by their number of runs, sparse rows by their method.
fn papers_row(row: &Row) -> Option<&'static PaperRow> {
    let is_same = |paper: &&PaperRow| {
        let same_runs = paper.direct_computations[0] == row.final_mesh_computations as f64;
        (paper.inputs, paper.method) == (row.r, row.method) && (row.method == "sparse" || same_runs)
    };
    TABLE_2.iter().find(is_same)
}

fn extremes(values: Vec<f64>) -> Range {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &value| [low.min(value), high.max(value)])
}

fn whole([low, high]: Range) -> String {
    let [low, high] = [low, high].map(|value| count(value as u64));
    if low == high { low } else { format!("{low}–{high}") }
}

/// The paper's errors with the paper's digits, but for zeros at the end.
fn as_printed([low, high]: Range) -> String {
    if low == high { low.to_string() } else { format!("{low}–{high}") }
}

fn range(values: Range) -> String {
    let [low, high] = values.map(|error| match error {
        error if error > 0.0 && error < SMALLEST_ERROR => format!("< {SMALLEST_ERROR}"),
        error if error < 1.0 => significant(error, 2),
        error => significant(error, 3),
    });
    if low == high { low } else { format!("{low}–{high}") }
}

fn clouds(work: &Reproduction, wanted: impl Fn(usize) -> bool) -> impl Iterator<Item = &Cloud> {
    work.clouds.iter().filter(move |cloud| wanted(cloud.inputs))
}

fn figure_3_charts(work: &Reproduction) -> Vec<Chart> {
    clouds(work, |inputs| inputs == 1 || inputs == MOST_INPUTS).flat_map(figure_3).collect()
}

fn figure_4_charts(work: &Reproduction) -> Vec<Chart> {
    clouds(work, |inputs| inputs >= 3).map(|cloud| figure_4(cloud, "sparse PC", &cloud.sparse)).collect()
}

fn invariants_charts(work: &Reproduction) -> Vec<Chart> {
    clouds(work, |inputs| inputs >= 3).map(|cloud| figure_4(cloud, "invariants", &cloud.invariants)).collect()
}

fn cost_charts(work: &Reproduction) -> Vec<Chart> {
    (3..=MOST_INPUTS).filter_map(|inputs| cost_chart(&work.rows, inputs, work.options().runs)).collect()
}

/// The figures that are there as files, each with its name: `figure3.svg`, `figure4.svg` and, with the table,
/// `errors.svg`.
pub fn figure_sheets(work: &Reproduction) -> Vec<(&'static str, String)> {
    let mut sheets = Vec::new();
    if work.options().figure_3 {
        let description =
            "Growth rates and frequencies of the two modes that coalesce, over the friction coefficient, by the model.";
        sheets.push(("figure3.svg", sheet("Coalescence of two modes", description, &figure_3_charts(work), COLUMNS)));
    }
    if work.options().figure_4 {
        let description = "Growth rates of the two modes over the friction coefficient for 3 to 8 uncertain parameters: model and sparse PC.";
        sheets.push(("figure4.svg", sheet("Model and sparse PC", description, &figure_4_charts(work), COLUMNS)));
    }
    if work.options().table_2 {
        let description =
            "Error of the stability proportion over model runs for all methods and 3 to 8 uncertain parameters.";
        sheets.push(("errors.svg", sheet("Error over cost", description, &cost_charts(work), COLUMNS)));
    }
    sheets
}

impl Reproduction {
    /// What was found as an HTML file.
    pub fn to_html(&self) -> String {
        let mut page = Page::new("Sparse polynomial chaos for the stability of a clutch, reproduced", "reproduce");
        page.paragraph(
            "Kieu, Bergeot and Berger (23ème Congrès Français de Mécanique, Lille 2017) compare full, multi-element and sparse \
             polynomial chaos expansions of the eigenvalues of a clutch with friction. Here are their table 2 and figures 3 and 4, \
             computed anew, and beside them expansions of invariants, which stay smooth where eigenvalues coalesce.",
        );
        if self.options().table_2 {
            self.table_section(&mut page);
        }
        if self.options().figure_3 {
            page.section("Figure 3: coalescence");
            page.paragraph(
                "Growing friction brings two modes to one frequency; from there on one of them is excited. Above is the nominal \
                 clutch, where friction alone is uncertain; below, all eight parameters are.",
            );
            page.charts(&figure_3_charts(self));
        }
        if self.options().figure_4 {
            page.section("Figure 4: growth rates by the model and by sparse PC");
            page.charts(&figure_4_charts(self));
            page.section("The same by invariants");
            page.charts(&invariants_charts(self));
        }
        if let Some(closer) = &self.closer {
            closer_section(&mut page, closer);
        }
        page.into_html()
    }

    fn table_section(&self, page: &mut Page) {
        page.section("Table 2");
        page.paragraph(&self.explanation());
        for (number, table) in table_2(&self.rows).iter().enumerate() {
            if number == 1 {
                page.section(INVARIANTS_HEADING);
                page.paragraph(INVARIANTS);
            }
            page.table(table);
        }
        page.section("Errors over cost");
        page.paragraph(&format!(
            "All model runs spent; the paper counts those of the final mesh, and of its sparse rows the ranges are drawn. Errors below \
             what {} points resolve are drawn at the lower edge.",
            count(self.options().runs)
        ));
        page.charts(&cost_charts(self));
    }

    /// Table 2 as a Markdown file.
    pub fn to_markdown(&self) -> String {
        let mut text =
            format!("# Table 2 of Kieu, Bergeot and Berger (2017), computed anew\n\n{}\n", self.explanation());
        for (number, table) in table_2(&self.rows).iter().enumerate() {
            if number == 1 {
                text.push_str(&format!("\n## {INVARIANTS_HEADING}\n\n{INVARIANTS}\n"));
            }
            text.push_str(&format!("\n{}", table.to_markdown()));
        }
        text
    }

    fn explanation(&self) -> String {
        format!(
            "Every build is compared with the model on the same {} points (seed {}) for each number r of uncertain parameters. Sparse \
             builds are made from five designs; smallest and largest values are given. Runs are all model runs spent; the paper counts \
             those of the final mesh. Errors are of the mean, of the variance and of the proportion of stability; for mean and \
             variance the larger one of Re λ of both modes is given, and the paper does not say which it means. Each column headed \
             \"paper\" has the paper's figures, as printed, for the column before it; its 0.18 % for gPC with r = 2 is probably a \
             misprint, between 6.45 % on either side.",
            count(self.options().runs),
            self.options().seed
        )
    }
}

fn closer_section(page: &mut Page, closer: &Closer) {
    page.section("All eight parameters uncertain");
    let mut charts = vec![density_chart(
        &format!("Density of max Re λ over modes {} and {}", PAIR[0], PAIR[1]),
        &[
            ("model", Color::Blue, &closer.model),
            ("sparse PC", Color::Orange, &closer.sparse),
            ("invariants", Color::Red, &closer.invariants),
        ],
    )];
    let names = closer.names.iter().map(String::as_str);
    charts.extend(sobol_charts(&SensitivityReport::new(names, &closer.sensitivities)));
    page.charts(&charts);
}
