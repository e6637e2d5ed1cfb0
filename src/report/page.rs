//! HTML pages that stand alone: one file without scripts, without anything to load, readable on a phone, on paper, in
//! light and in dark.

use super::table::{Align, Table};
use pcc_charts::{Chart, STYLE, Sparkline, escape};
use std::fmt::Write;

/// Nothing but the styles and links inside the page may be loaded, whatever names it shows.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";

const PAGE_STYLE: &str = "
:root { color-scheme: light dark; --ink: #1b1f24; --soft: #57606a; --paper: #ffffff; --line: #d0d7de; --note: #f6f8fa; --link: #0a58ca; }
@media screen and (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ec; --soft: #a0a8b0; --paper: #14171a; --line: #3a4148; --note: #1d2226; --link: #7ab4ff; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 74rem; padding: 1rem; background: var(--paper); color: var(--ink); font: 1rem/1.5 system-ui, sans-serif; overflow-wrap: anywhere; }
.chart { --chart-paper: var(--paper); width: 100%; height: auto; }
.chart-sparkline { width: 7.5rem; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0.5rem 0; }
h2 { font-size: 1.2rem; margin: 2rem 0 0.5rem; border-bottom: 1px solid var(--line); padding-bottom: 0.25rem; }
p, li, dd { max-width: 46rem; }
a { color: var(--link); }
.lead { font-size: 1.25rem; margin: 0.5rem 0; }
.soft, footer, figcaption { color: var(--soft); }
figcaption, footer { font-size: 0.875rem; }
dl { display: grid; grid-template-columns: minmax(8rem, max-content) 1fr; gap: 0.25rem 1rem; margin: 0.5rem 0; }
dt { color: var(--soft); }
dd { margin: 0; }
.warning { border-left: 0.25rem solid #b35900; background: var(--note); padding: 0.5rem 0.75rem; margin: 0.5rem 0; }
.figures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 26rem), 1fr)); gap: 1rem; }
figure { margin: 0.5rem 0; min-width: 0; }
.scroll { overflow-x: auto; margin: 0.5rem 0; }
table { border-collapse: collapse; font-size: 0.8125rem; font-variant-numeric: tabular-nums; overflow-wrap: normal; }
th, td { padding: 0.2rem 0.35rem; text-align: left; border-bottom: 1px solid var(--line); vertical-align: top; white-space: nowrap; }
th { white-space: normal; vertical-align: bottom; }
th { font-weight: 600; }
.right { text-align: right; }
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; }
  figure, tr, .warning { break-inside: avoid; }
  h2 { break-after: avoid; }
  .scroll { overflow: visible; }
  .download { display: none; }
}
";

/// A page that grows section by section.
#[derive(Debug)]
pub(super) struct Page {
    command: &'static str,
    title: String,
    body: String,
    figures: usize,
}

impl Page {
    /// A page with this title, as text, made by this command.
    pub fn new(title: &str, command: &'static str) -> Self {
        Self { command, title: escape(title), body: format!("<h1>{}</h1>\n", escape(title)), figures: 0 }
    }

    /// A heading, as text.
    pub fn section(&mut self, heading: &str) {
        let _ = writeln!(self.body, "<h2>{}</h2>", escape(heading));
    }

    /// A paragraph, as text.
    pub fn paragraph(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p>{}</p>", prose(text));
    }

    /// The answer of the page, as text.
    pub fn lead(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p class=\"lead\">{}</p>", prose(text));
    }

    /// A warning, as text.
    pub fn warning(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p class=\"warning\">{}</p>", prose(text));
    }

    /// Terms and what is to say of them, as text.
    pub fn facts<T: AsRef<str>>(&mut self, facts: &[(T, String)]) {
        self.body.push_str("<dl>\n");
        for (term, text) in facts {
            let _ = writeln!(self.body, "<dt>{}</dt><dd>{}</dd>", escape(term.as_ref()), prose(text));
        }
        self.body.push_str("</dl>\n");
    }

    /// A table.
    pub fn table(&mut self, table: &Table) {
        self.table_with_pictures(table, "", &[]);
    }

    /// A table with a picture at the end of each row, under a head of its own.
    pub fn table_with_pictures(&mut self, table: &Table, head: &str, pictures: &[Sparkline]) {
        let picture = |row: usize| match row.checked_sub(1) {
            _ if pictures.is_empty() => String::new(),
            None => format!("<th>{}</th>", escape(head)),
            Some(at) => format!("<td>{}</td>", pictures.get(at).map_or_else(String::new, Sparkline::to_svg)),
        };
        let cells = |tag: &str, row: &[String]| {
            let cell = |(cell, align): (&String, &Align)| match align {
                Align::Left => format!("<{tag}>{}</{tag}>", escape(cell)),
                Align::Right => format!("<{tag} class=\"right\">{}</{tag}>", escape(cell)),
            };
            row.iter().zip(table.aligns()).map(cell).collect::<String>()
        };
        self.body.push_str("<div class=\"scroll\"><table>\n");
        for (k, row) in table.rows().iter().enumerate() {
            let (tag, before, after) = match k {
                0 => ("th", "<thead>", "</thead>\n<tbody>"),
                _ => ("td", "", ""),
            };
            let _ = writeln!(self.body, "{before}<tr>{}{}</tr>{after}", cells(tag, row), picture(k));
        }
        self.body.push_str("</tbody></table></div>\n");
    }

    /// Charts side by side where there is room, each with what it shows below it and its data behind a link.
    pub fn charts(&mut self, charts: &[Chart]) {
        self.body.push_str("<div class=\"figures\">\n");
        for chart in charts {
            self.figures += 1;
            let id = format!("figure-{}", self.figures);
            let _ = writeln!(
                self.body,
                "<figure id=\"{id}\">{}<figcaption>{} <a class=\"download\" download=\"{id}.csv\" href=\"{}\">Data as \
                 CSV</a></figcaption></figure>",
                chart.to_svg(&format!("{id}-chart")),
                escape(&chart.description),
                data_link(&chart.to_csv()),
            );
        }
        self.body.push_str("</div>\n");
    }

    /// The whole file.
    pub fn into_html(self) -> String {
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width, initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" \
             content=\"{POLICY}\">\n<meta name=\"generator\" content=\"pcc {command} {version}\">\n<title>{title}</title>\n\
             <style>{PAGE_STYLE}{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n<footer><p>Made by pcc {version}. \
             This file stands alone: it loads nothing.</p></footer>\n</body>\n</html>\n",
            version = env!("CARGO_PKG_VERSION"),
            command = self.command,
            title = self.title,
            body = self.body,
        )
    }
}

/// Sentences written for a terminal, as text of a page: numbers stay on the line of their percent sign, columns become
/// a list, commands need no quotes.
fn prose(text: &str) -> String {
    escape(text).replace(" %", "\u{a0}%").replace("   ", ", ").replace('`', "")
}

/// CSV as a link inside the page: bytes that could end the attribute or the URL are percent-encoded (RFC 2397 and
/// 3986).
fn data_link(csv: &str) -> String {
    let mut link = "data:text/csv;charset=utf-8,".to_owned();
    for byte in csv.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b',' => link.push(byte.into()),
            _ => {
                let _ = write!(link, "%{byte:02X}");
            }
        }
    }
    link
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_charts::{Axis, Color, Marks, Series};

    const HOSTILE: &str = "</script><img src=x onerror=alert(1)>\"'&";

    #[test]
    fn names_are_text_wherever_they_stand() {
        let mut page = Page::new(HOSTILE, "report");
        page.section(HOSTILE);
        page.paragraph(HOSTILE);
        page.lead(HOSTILE);
        page.warning(HOSTILE);
        page.facts(&[(HOSTILE, HOSTILE.to_owned())]);
        let mut table = Table::new(&[(HOSTILE, Align::Left), ("n", Align::Right)]);
        table.row([HOSTILE, HOSTILE]);
        page.table(&table);
        page.charts(&[Chart {
            title: HOSTILE.to_owned(),
            description: HOSTILE.to_owned(),
            x: Axis::linear(HOSTILE),
            y: Axis::categories(HOSTILE, vec![HOSTILE.to_owned()]),
            series: vec![Series::new(HOSTILE, Color::Blue, Marks::Points(vec![[0.0, 1.0]]))],
            guides: Vec::new(),
        }]);
        let html = page.into_html();
        assert!(!html.contains("<img") && !html.contains("</script"), "{html}");
        // Escaped once in every place: title twice, section, paragraph, lead, warning, two facts, three cells at least.
        assert!(html.matches("&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;&quot;&#39;&amp;").count() >= 11);
    }

    #[test]
    fn data_links_hold_every_byte() {
        assert_eq!(data_link("a,\"é\"\r\n"), "data:text/csv;charset=utf-8,a,%22%C3%A9%22%0D%0A");
    }
}
