//! A wheel on a carriage: points with error bars, and the model as curves at each group's typical inputs.

use super::{Panel, area, legend_line, list};
use crate::diagnosis::{Axis, Curve, CurveGroup, Curves, Fit};
use crate::report::plots::{COLOURS, DrawnModel, GREY, View, all_rounded, axis, between, faded, layout_with};
use crate::report::units::{Shown, of_column, short, spoken};
use plotly::common::{ErrorData, ErrorType, HoverInfo, Line, Marker, MarkerSymbol, Mode};
use plotly::{Plot, Scatter};

/// Where all rows are one group, runs are told apart by these colours up to this many; the models have their own.
const RUNS: [&str; 4] = [COLOURS[0], COLOURS[4], COLOURS[5], COLOURS[3]];

/// Where there are more points than this, the model's value at each is not marked at first.
const MOST_MARKED: usize = 60;

/// More groups than this have colours in order from the first to the last of these, and no room in a legend.
pub(in crate::report) const MOST_NAMED: usize = COLOURS.len();
const ORDER: [&str; 4] = [COLOURS[0], COLOURS[2], COLOURS[1], COLOURS[3]];

/// A band narrower than this share of the plot's height is no wider than the curve's line.
const THIN: f64 = 0.006;

/// One panel an axis.
pub(in crate::report) fn panels(view: &View) -> Vec<Panel> {
    let one = |curves: Option<&Curves>| {
        let signals = view.experiment.signals();
        let plots = signals.iter().map(|signal| (spoken(signal), overlay(view, curves, signal)));
        let when = curves.map_or(String::new(), |curves| format!("axis={}", curves.axis.name()));
        Panel { when, plots: plots.collect() }
    };
    if view.curves.is_empty() { vec![one(None)] } else { view.curves.iter().map(|c| one(Some(c))).collect() }
}

/// Lists that choose the axis and the rows, and a box for the model at each point.
pub(in crate::report) fn controls(view: &View) -> String {
    let mut html = String::new();
    let axes = view.curves.iter().map(|curves| (curves.axis.name(), spoken(curves.axis.name())));
    html.push_str(&list("Over", "axis", "", &axes.collect::<Vec<_>>()));
    for curves in view.curves {
        let names = curves.groups.iter().enumerate().map(|(k, group)| (k.to_string(), group.name.clone()));
        let mut options = vec![("all".to_owned(), "all".to_owned())];
        options.extend(names);
        let when = format!(" data-when=\"axis={}\"", curves.axis.name());
        if curves.groups.len() > 1 {
            html.push_str(&list("Rows", group_key(curves.axis), &when, &options));
        }
    }
    let points = view.experiment.runs.iter().map(|run| run.data.rows()).sum::<usize>();
    let checked = if points <= MOST_MARKED { " checked" } else { "" };
    html.push_str(&format!(
        "<label><input type=\"checkbox\" data-key=\"points\" value=\"yes\"{checked}> model at each point</label>"
    ));
    html
}

/// A wheel on a carriage without an axis: the rows as one group.
fn without_curves(view: &View) -> CurveGroup {
    let runs = view.experiment.runs.iter().enumerate();
    let rows = runs.flat_map(|(run, data)| (0..data.data.rows()).map(move |row| (run, row))).collect();
    let none = (f64::NAN, f64::NAN);
    CurveGroup {
        name: String::new(),
        rows,
        loads: none,
        slips: none,
        wheel_speeds: none,
        at: Vec::new(),
        inputs: Vec::new(),
        models: Vec::new(),
    }
}

/// The key of the list that chooses among the groups of an axis.
pub(super) fn group_key(axis: Axis) -> &'static str {
    match axis {
        Axis::Slip => "group-slip",
        Axis::Load => "group-load",
        Axis::WheelSpeed => "group-speed",
    }
}

/// What the traces of one signal share.
struct Drawing<'a> {
    view: &'a View<'a>,
    signal: &'a str,
    axis: Axis,
    shown: Shown,
    at: Shown,
    /// Number of groups; of several each has a colour.
    groups: usize,
    /// Highest less lowest measured value, in SI units.
    height: f64,
}

/// The plot of one signal over the axis of `curves`; over slip without curves where no input was varied.
pub(super) fn overlay(view: &View, curves: Option<&Curves>, signal: &str) -> Plot {
    let alone = curves.is_none().then(|| without_curves(view));
    let groups = curves.map(|curves| &curves.groups[..]).or(alone.as_ref().map(std::slice::from_ref));
    let groups = groups.unwrap_or_default();
    let over = curves.map_or(Axis::Slip, |curves| curves.axis);
    let measured = view.models.iter().take(1).flat_map(|model| &model.fit.runs).filter_map(|run| run.signal(signal));
    let measured = measured.flat_map(|fit| &fit.measured).filter(|value| !value.is_nan());
    let (low, high) = measured.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let (shown, at) = (of_column(signal), of_column(over.name()));
    let drawing = Drawing { view, signal, axis: over, shown, at, groups: groups.len(), height: high - low };
    let mut plot = Plot::new();
    // Bands lie below, points above.
    for (k, group) in groups.iter().enumerate() {
        drawing.bands(&mut plot, k, group);
    }
    for (k, group) in groups.iter().enumerate() {
        drawing.curves(&mut plot, k, group);
    }
    for (k, group) in groups.iter().enumerate() {
        drawing.points(&mut plot, k, group);
    }
    if !groups.is_empty() {
        view.models
            .iter()
            .for_each(|model| plot.add_trace(legend_line(model, if groups.len() > 1 { GREY } else { model.colour })));
    }
    plot.set_layout(layout_with(axis(&at.axis(&spoken(over.name()))), axis(&shown.axis(&spoken(signal))), true));
    plot
}

/// Name, colour and rows (run, row) of points that are drawn alike.
type Part = (String, String, Vec<(usize, usize)>);

impl Drawing<'_> {
    fn grouped(&self) -> bool {
        self.groups > 1
    }

    /// The colour of a group, or, where there is one group only, that of a model.
    fn colour(&self, group: usize, model: Option<&DrawnModel>) -> String {
        match model {
            Some(model) if !self.grouped() => model.colour.to_owned(),
            _ if self.groups <= MOST_NAMED => COLOURS[group].to_owned(),
            _ => between(&ORDER, group as f64 / (self.groups - 1) as f64),
        }
    }

    fn meta(&self, group: usize, model: Option<&DrawnModel>, more: &str) -> String {
        let model = model.map_or(String::new(), |model| format!("model={};", model.key));
        format!("{model}{more}{}={group}", group_key(self.axis))
    }

    /// The curve of a model in a group.
    fn curve<'g>(&self, group: &'g CurveGroup, model: &DrawnModel) -> Option<&'g Curve> {
        let own = group.models.iter().find(|own| own.step == model.step)?;
        own.signals.get(self.signal).filter(|_| !group.at.is_empty())
    }

    fn bands(&self, plot: &mut Plot, k: usize, group: &CurveGroup) {
        for model in &self.view.models {
            let Some(curve) = self.curve(group, model) else { continue };
            let width = curve.high.iter().zip(&curve.low).map(|(high, low)| high - low).fold(0.0, f64::max);
            if width > THIN * self.height {
                let scaled = |values: &[f64]| values.iter().map(|v| v * self.shown.factor).collect::<Vec<_>>();
                let at: Vec<f64> = group.at.iter().map(|x| x * self.at.factor).collect();
                let (low, high) = (scaled(&curve.low), scaled(&curve.high));
                let band = area(&at, &low, &high, &self.colour(k, Some(model)), 0.16);
                plot.add_trace(band.meta(self.meta(k, Some(model), "")).legend_group(&group.name));
            }
        }
    }

    fn curves(&self, plot: &mut Plot, k: usize, group: &CurveGroup) {
        for model in &self.view.models {
            let Some(curve) = self.curve(group, model) else { continue };
            let x = all_rounded(group.at.iter().map(|x| x * self.at.factor));
            let y = all_rounded(curve.value.iter().map(|v| v * self.shown.factor));
            let name = if self.grouped() { format!("{}, {}", group.name, model.name) } else { model.name.clone() };
            plot.add_trace(
                Scatter::new(x, y)
                    .mode(Mode::Lines)
                    .name(name)
                    .legend_group(&group.name)
                    .show_legend(false)
                    .meta(self.meta(k, Some(model), ""))
                    .line(Line::new().color(self.colour(k, Some(model))).width(2.0).dash(model.dash.clone())),
            );
        }
    }

    /// The rows of a group by run, where runs have colours of their own.
    fn parts(&self, k: usize, group: &CurveGroup) -> Vec<Part> {
        let mut runs: Vec<usize> = group.rows.iter().map(|(run, _)| *run).collect();
        runs.dedup();
        if self.grouped() || runs.len() < 2 || runs.len() > RUNS.len() {
            let name = if self.grouped() { group.name.clone() } else { "measured".to_owned() };
            return vec![(name, self.colour(k, None), group.rows.clone())];
        }
        let own = |run: usize| group.rows.iter().copied().filter(|(own, _)| *own == run).collect();
        let name = |run: usize| self.view.experiment.runs[run].name.clone();
        runs.iter().zip(RUNS).map(|(run, colour)| (name(*run), colour.to_owned(), own(*run))).collect()
    }

    /// Measured values with error bars, and the model's value at each.
    fn points(&self, plot: &mut Plot, k: usize, group: &CurveGroup) {
        for (name, colour, rows) in self.parts(k, group) {
            for model in &self.view.models {
                let (x, y) = self.samples(&rows, |row| self.value(model.fit, row, true));
                plot.add_trace(
                    Scatter::new(x, y)
                        .mode(Mode::Markers)
                        .name(format!("{} at each point", model.short))
                        .legend_group(&name)
                        .show_legend(false)
                        .hover_info(HoverInfo::Skip)
                        .meta(self.meta(k, Some(model), "points=yes;"))
                        .marker(
                            Marker::new().color(self.colour(k, Some(model))).size(6).symbol(MarkerSymbol::DiamondOpen),
                        ),
                );
            }
            let Some(fit) = self.view.models.first().map(|model| model.fit) else { continue };
            let (x, y) = self.samples(&rows, |row| self.value(fit, row, false));
            let there = rows.iter().filter(|row| self.value(fit, **row, false).is_some());
            let mut points = Scatter::new(x, y)
                .mode(Mode::Markers)
                .name(&name)
                .legend_group(&name)
                .show_legend(self.groups <= MOST_NAMED)
                .hover_info(HoverInfo::Text)
                .hover_text_array(there.map(|row| self.words(*row)).collect())
                .meta(self.meta(k, None, ""))
                .marker(Marker::new().color(colour.clone()).size(6));
            if let Some(deviation) = self.view.noise.get(self.signal) {
                points = points.error_y(
                    ErrorData::new(ErrorType::Constant)
                        .value(2.0 * deviation * self.shown.factor)
                        .color(faded(&colour, 0.55))
                        .thickness(1.2)
                        .width(3),
                );
            }
            plot.add_trace(points);
        }
    }

    /// Places on the axis and values, display units, of the rows that have one.
    fn samples(&self, rows: &[(usize, usize)], value: impl Fn((usize, usize)) -> Option<f64>) -> (Vec<f64>, Vec<f64>) {
        let place = |(run, row): (usize, usize)| self.view.experiment.runs[run].data.value(self.axis.name(), row);
        let point = |row: &(usize, usize)| Some((place(*row)? * self.at.factor, value(*row)? * self.shown.factor));
        let (x, y): (Vec<f64>, Vec<f64>) = rows.iter().filter_map(point).unzip();
        (all_rounded(x), all_rounded(y))
    }

    fn value(&self, fit: &Fit, (run, row): (usize, usize), modelled: bool) -> Option<f64> {
        let own = fit.runs.get(run)?.signal(self.signal)?;
        // The model is shown where something was measured.
        let measured = own.measured.get(row).copied().filter(|value| !value.is_nan())?;
        let value = if modelled { own.modelled.get(row).copied()? } else { measured };
        (!value.is_nan()).then_some(value)
    }

    /// A point in words: where it was measured, what the models say there.
    fn words(&self, (run, row): (usize, usize)) -> String {
        let data = &self.view.experiment.runs[run];
        let input = |name: &str| {
            let value = data.data.value(name, row)?;
            Some(format!("{} {}", spoken(name), of_column(name).plain(value)))
        };
        let mut lines = vec![format!("{}, row {}", data.name, row + 1)];
        lines
            .push(["slip", "load", "wheel_speed"].iter().filter_map(|name| input(name)).collect::<Vec<_>>().join(", "));
        let fit = self.view.models.first().map(|model| model.fit);
        if let Some(measured) = fit.and_then(|fit| self.value(fit, (run, row), false)) {
            lines.push(format!("measured {}", self.shown.number(measured)));
            for model in &self.view.models {
                let Some(modelled) = self.value(model.fit, (run, row), true) else { continue };
                let apart = (measured - modelled) * self.shown.factor;
                lines.push(format!("{} {}, residual {}", model.short, self.shown.number(modelled), short(apart)));
            }
        }
        // Names come from files: the plot reads tags in this text.
        lines.iter().map(|line| crate::report::page::escape(line)).collect::<Vec<_>>().join("<br>")
    }
}
