//! The page around the sections: style, plotting library, theme.

use super::plots::{LinePlot, lines};
use plotly::Plot;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// A page in the making: one HTML file with style, plots and their library in it.
pub struct Page {
    title: String,
    body: String,
    plots: usize,
    /// Scripts beside that of every page, each once.
    scripts: Vec<&'static str>,
}

impl Page {
    /// An empty page with its title, plain text.
    #[must_use]
    pub fn new(title: &str) -> Self {
        Self { title: escape(title), body: String::new(), plots: 0, scripts: Vec::new() }
    }

    /// Adds HTML as it is.
    pub fn html(&mut self, html: &str) {
        self.body.push_str(html);
        self.body.push('\n');
    }

    /// Runs a script once after that of every page.
    pub(super) fn script(&mut self, script: &'static str) {
        if !self.scripts.contains(&script) {
            self.scripts.push(script);
        }
    }

    /// Adds a heading and the sentence under it, both plain text.
    pub(super) fn section(&mut self, heading: &str, lead: &str) {
        self.html(&format!("<h2>{}</h2>\n<p class=\"lead\">{}</p>", escape(heading), escape(lead)));
    }

    /// Adds a heading and the sentence under it (none where empty), both plain text; links of the page can go to `#place`.
    pub fn section_at(&mut self, place: &str, heading: &str, lead: &str) {
        let lead = if lead.is_empty() { String::new() } else { format!("\n<p class=\"lead\">{}</p>", escape(lead)) };
        self.html(&format!("<h2 id=\"{place}\">{}</h2>{lead}", escape(heading)));
    }

    /// Adds plots side by side as far as the width allows, each with its title; returns what [`again`](Page::again) needs.
    pub(super) fn plots(&mut self, plots: &[(String, Plot)]) -> Vec<(String, usize)> {
        let mut drawn = Vec::new();
        self.body.push_str(if plots.len() == 1 { "<div class=\"wide\">\n" } else { "<div class=\"row\">\n" });
        for (title, plot) in plots {
            self.plots += 1;
            // A tag inside a string of the data would end the script or begin another.
            let json = plot.to_json().replace('<', "\\u003c");
            self.figure(
                title,
                self.plots,
                "",
                &format!("<script type=\"application/json\" data-plot=\"plot{}\">{json}</script>", self.plots),
            );
            drawn.push((title.clone(), self.plots));
        }
        self.body.push_str("</div>\n");
        drawn
    }

    /// Adds plots of lines side by side as far as the width allows, each with its title.
    pub fn lines(&mut self, plots: &[LinePlot]) {
        let plots: Vec<(String, Plot)> = plots.iter().map(|plot| (plot.title.clone(), lines(plot))).collect();
        self.plots(&plots);
    }

    /// Draws plots a second time from the same data, under other boxes and lists.
    pub(super) fn again(&mut self, plots: &[(String, usize)]) {
        self.body.push_str(if plots.len() == 1 { "<div class=\"wide\">\n" } else { "<div class=\"row\">\n" });
        for (title, source) in plots {
            self.plots += 1;
            self.figure(title, self.plots, &format!(" data-again=\"plot{source}\""), "");
        }
        self.body.push_str("</div>\n");
    }

    fn figure(&mut self, title: &str, number: usize, attributes: &str, data: &str) {
        let title = escape(title);
        self.body.push_str(&format!(
            "<figure><figcaption>{title}</figcaption><div class=\"plot\" id=\"plot{number}\" role=\"img\" \
             aria-label=\"{title}\"{attributes}></div>{data}</figure>\n"
        ));
    }

    /// The finished page; it states its own size.
    #[must_use]
    pub fn finish(self) -> String {
        let Self { title, mut body, scripts, .. } = self;
        let scripts = std::iter::once(SCRIPT).chain(scripts).collect::<Vec<_>>().join("\n");
        let size = (plotting_library().len() + STYLE.len() + scripts.len() + body.len()) as f64 / 1e6;
        body.push_str(&format!(
            "<p class=\"small\">Written by Bekker {}. This page is one file of {size:.1} MB and loads nothing from elsewhere.</p>\n\
             <noscript><p>The plots need JavaScript; text and tables do not.</p></noscript>\n",
            env!("CARGO_PKG_VERSION")
        ));
        let library = plotting_library();
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n\
             {library}</head>\n<body>\n<main>\n{body}</main>\n<script>\n{scripts}</script>\n</body>\n</html>\n"
        )
    }
}

/// The plotting library alone: the crate's sources add a typesetter for formulas, which no page here needs.
fn plotting_library() -> String {
    let sources = Plot::offline_js_sources();
    let end = sources.find("</script>").map_or(sources.len(), |at| at + "</script>".len());
    sources[..end].to_owned() + "\n"
}

/// Plain text as HTML.
#[must_use]
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A table: header cells and rows of cells, all plain text; the first column names the row.
#[must_use]
pub fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let cells = |tag: &str, cells: &mut dyn Iterator<Item = &str>| {
        cells.map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect::<String>()
    };
    let body: String =
        rows.iter().map(|row| format!("<tr>{}</tr>\n", cells("td", &mut row.iter().map(String::as_str)))).collect();
    format!(
        "<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>{}</tr></thead>\n<tbody>\n{body}</tbody></table></div>",
        cells("th", &mut header.iter().copied())
    )
}
