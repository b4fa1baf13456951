//! Findings as CSV.

use super::{Finding, LinePlot};

/// All rows: id, section, quantity, thesis, median, low, high, trials, reason.
#[must_use]
pub fn rows_csv(findings: &[Finding]) -> String {
    let header = ["id", "section", "quantity", "thesis", "median", "low", "high", "trials", "reason"];
    let rows = findings.iter().flat_map(|finding| {
        finding.rows.iter().map(move |row| {
            let thesis = row.thesis.map_or(String::new(), |value| value.to_string());
            let ours = [row.ours.median, row.ours.low, row.ours.high].map(|value| value.to_string());
            let [median, low, high] = ours;
            let trials = row.ours.trials.to_string();
            let (id, section) = (finding.id.clone(), finding.section.clone());
            vec![id, section, row.quantity.clone(), thesis, median, low, high, trials, row.reason.clone()]
        })
    });
    table(&header, rows)
}

/// The points of a plot: series, abscissa, ordinate; a gap is an empty cell.
#[must_use]
pub fn plot_csv(plot: &LinePlot) -> String {
    let header = ["series", plot.x_label.as_str(), plot.y_label.as_str()];
    let rows = plot.series.iter().flat_map(|series| {
        series.x.iter().zip(&series.y).map(|(x, y)| {
            let y = if y.is_finite() { y.to_string() } else { String::new() };
            vec![series.name.clone(), x.to_string(), y]
        })
    });
    table(&header, rows)
}

fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory does not fail, and every row has the header's length.
    let written =
        writer.write_record(header).and_then(|()| rows.into_iter().try_for_each(|row| writer.write_record(&row)));
    debug_assert!(written.is_ok(), "{written:?}");
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::super::{Row, Series, Spread};
    use super::*;

    #[test]
    fn analytic_csv_quotes_what_needs_it_and_leaves_gaps() {
        let row =
            Row { quantity: "slip, %".into(), thesis: None, ours: Spread::exact(0.5), reason: "a \"why\"".into() };
        let finding = Finding {
            id: "x".into(),
            section: "4.4".into(),
            title: String::new(),
            rows: vec![row],
            plots: Vec::new(),
            assumptions: Vec::new(),
        };
        let text = rows_csv(&[finding]);
        assert!(text.ends_with("x,4.4,\"slip, %\",,0.5,0.5,0.5,1,\"a \"\"why\"\"\"\n"), "{text}");
        let series = Series { name: "s".into(), x: vec![0.0, 1.0], y: vec![2.0, f64::NAN] };
        let (id, title) = (String::new(), String::new());
        let plot = LinePlot { id, title, x_label: "time, s".into(), y_label: "slip".into(), series: vec![series] };
        assert_eq!(plot_csv(&plot), "series,\"time, s\",slip\ns,0,2\ns,1,\n");
    }
}
