//! The page around the sections: text and tables, figures, and the data that the script reads.

use super::plots::{Figure, LinePlot, lines};

/// A page in the making: one HTML file with style, script and data in it.
pub struct Page {
    title: String,
    body: String,
    figures: usize,
    data: Option<String>,
}

impl Page {
    /// An empty page with its title, plain text.
    #[must_use]
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), body: String::new(), figures: 0, data: None }
    }

    /// Adds HTML as it is.
    pub fn html(&mut self, html: &str) {
        self.body.push_str(html);
        self.body.push('\n');
    }

    /// What the script reads in the place of a server's answers.
    pub(super) fn data(&mut self, data: String) {
        self.data = Some(data);
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

    /// Adds figures side by side as far as the width allows, each with its title.
    pub(super) fn plots(&mut self, plots: &[(String, Figure)]) {
        self.body.push_str(if plots.len() == 1 {
            "<div class=\"figures wide\">\n"
        } else {
            "<div class=\"figures\">\n"
        });
        for (title, figure) in plots {
            self.figures += 1;
            let (number, title) = (self.figures, escape(title));
            // A tag inside a string of the data would end the script or begin another.
            let json = serde_json::json!(figure).to_string().replace('<', "\\u003c");
            self.body.push_str(&format!(
                "<figure><figcaption>{title}</figcaption><div class=\"plot\" id=\"plot{number}\" role=\"img\" aria-label=\"{title}\"></div>\
                 <script type=\"application/json\" data-plot=\"plot{number}\">{json}</script></figure>\n"
            ));
        }
        self.body.push_str("</div>\n");
    }

    /// Adds plots of lines side by side as far as the width allows, each with its title.
    pub fn lines(&mut self, plots: &[LinePlot]) {
        let plots: Vec<(String, Figure)> = plots.iter().map(|plot| (plot.title.clone(), lines(plot))).collect();
        self.plots(&plots);
    }

    /// The finished page; it states its own size.
    #[must_use]
    pub fn finish(self) -> String {
        let Self { title, mut body, data, .. } = self;
        let own = |body: &str| bekker_page::alone(&title, body, data.as_deref());
        let size = own(&body).len() as f64 / 1e6;
        body.push_str(&format!(
            "<p class=\"small\">Written by Bekker {}. This page is one file of {size:.1} MB and loads nothing from elsewhere.</p>\n\
             <noscript><p>The plots need JavaScript; text and tables do not.</p></noscript>\n",
            env!("CARGO_PKG_VERSION")
        ));
        own(&body)
    }
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
        // An empty cell heads nothing.
        let tag = |cell: &str| if cell.is_empty() { "td".to_owned() } else { tag.to_owned() };
        cells.map(|cell| format!("<{0}>{1}</{0}>", tag(cell), escape(cell))).collect::<String>()
    };
    let body: String =
        rows.iter().map(|row| format!("<tr>{}</tr>\n", cells("td", &mut row.iter().map(String::as_str)))).collect();
    format!(
        "<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>{}</tr></thead>\n<tbody>\n{body}</tbody></table></div>",
        cells("th", &mut header.iter().copied())
    )
}
