//! The page of the workbench and of saved reports, as it is built from the TypeScript in `src/`.
//!
//! The workbench serves [`INDEX`], [`SCRIPT`] and [`STYLE`] as files. A report is [one file](alone) with both in it, text that can be
//! read without a script, and data in the place of a server.

/// The page of the workbench, which loads `page.js` and `page.css`.
pub const INDEX: &str = include_str!("built/index.html");

/// The script.
pub const SCRIPT: &str = include_str!("built/page.js");

/// The style.
pub const STYLE: &str = include_str!("built/page.css");

/// One file with everything in it: `title` is plain text, `body` HTML that stands below the plots, `data` the JSON that the script reads
/// in the place of a server's answers; without it the script draws the figures of the body only.
#[must_use]
pub fn alone(title: &str, body: &str, data: Option<&str>) -> String {
    // A tag inside a string of the data would end its script.
    let data = data.map_or_else(String::new, |data| {
        format!("<script type=\"application/json\" id=\"saved\">{}</script>\n", data.replace('<', "\\u003c"))
    });
    // The script ends at the first tag of this name, of which its text must have none.
    let script = SCRIPT.replace("</script", "<\\/script");
    let title = title.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n\
         <body class=\"saved\">\n<div id=\"page\"></div>\n<article id=\"report\" role=\"region\" aria-label=\"Report\">\n{body}</article>\n{data}\
         <script type=\"module\">\n{script}</script>\n</body>\n</html>\n"
    )
}
