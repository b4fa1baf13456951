//! The page of the thesis's results beside ours.

use super::{Finding, Row, Spread};
use bekker::report::{Page, escape, short, table};

/// A self-contained HTML page of findings: all numbers in one table first, then each experiment with its figures,
/// reasons and assumptions.
#[must_use]
pub fn reproduction_page(findings: &[Finding]) -> String {
    let mut page = Page::new("The thesis's results beside ours");
    page.html("<h1>Iagnemma 2001, sections 2.3, 2.4, 2.6, 3.3, 3.5 and 4.4: published and reproduced</h1>");
    page.html(
        "<p class=\"lead\">Every number below was computed when this page was written, by the same simulation, sensors, \
         estimators and controllers as every other door of Bekker. Ours is the median over trials with its 10 to 90 % \
         interval. No terrain, gain or soil was tuned towards a published number; where ours differs, the reason stands \
         beside it.</p>",
    );
    let link = |finding: &Finding| format!("<a href=\"#{}\">{}</a> ", finding.id, escape(&finding.section));
    let links: String = findings.iter().map(link).collect();
    page.html(&format!("<nav aria-label=\"Contents\">{links}</nav>"));
    let published = published(findings);
    if !published.is_empty() {
        page.section_at("numbers", "All numbers with a published counterpart", "");
        page.html(&in_words(&table(&["quantity", "thesis", "ours", "10 to 90 %", "trials", "where"], &published)));
    }
    for finding in findings {
        add(&mut page, finding);
    }
    page.finish()
}

/// A table whose first and last column hold sentences, which may wrap.
fn in_words(table: &str) -> String {
    format!("<div class=\"words\">{table}</div>")
}

/// Rows that the thesis has a number for.
fn published(findings: &[Finding]) -> Vec<Vec<String>> {
    let rows = findings.iter().flat_map(|finding| finding.rows.iter().map(move |row| (finding, row)));
    rows.filter(|(_, row)| row.thesis.is_some())
        .map(|(finding, row)| {
            let mut cells = numbers(row).to_vec();
            cells.push(format!("{} ({})", finding.title, finding.section));
            cells
        })
        .collect()
}

/// Quantity, thesis, ours, interval, trials.
fn numbers(row: &Row) -> [String; 5] {
    let Spread { median, low, high, trials } = row.ours;
    let interval = if trials > 1 { format!("{} .. {}", short(low), short(high)) } else { "exact".to_owned() };
    let thesis = row.thesis.map_or("-".to_owned(), short);
    [row.quantity.clone(), thesis, short(median), interval, trials.to_string()]
}

fn add(page: &mut Page, finding: &Finding) {
    page.section_at(&finding.id, &finding.title, &format!("Section {}.", finding.section));
    if !finding.rows.is_empty() {
        let cells = |row: &Row| {
            let mut cells = numbers(row).to_vec();
            cells.push(row.reason.clone());
            cells
        };
        let rows: Vec<Vec<String>> = finding.rows.iter().map(cells).collect();
        page.html(&in_words(&table(&["quantity", "thesis", "ours", "10 to 90 %", "trials", "why"], &rows)));
    }
    if !finding.plots.is_empty() {
        page.lines(&finding.plots);
    }
    if !finding.assumptions.is_empty() {
        let items: String = finding.assumptions.iter().map(|text| format!("<li>{}</li>", escape(text))).collect();
        page.html(&format!("<p>Assumed, where the thesis is silent:</p><ul>{items}</ul>"));
    }
}
