//! `bekker plan`.

use crate::ground::{GroundArguments, degrees, pair};
use crate::output::{check_all_writable, say, write, write_json};
use anyhow::Result;
use bekker::modeldescription::Lookup;
use bekker_planning::answer::PlanAnswer;
use bekker_planning::plan::{Measure, Request};
use std::path::PathBuf;

/// Columns of the path as CSV.
const COLUMNS: &str = "travelled,x,y,z,heading,roll,pitch,stability,thrust,clearance,slip,slip_low,slip_high,slip_none";

/// Plan a path over a map: a search on roughness, turning and length, then pose, stability and forces at every point.
#[derive(clap::Args)]
pub struct Plan {
    #[command(flatten)]
    ground: GroundArguments,
    /// Start, m.
    #[arg(long, value_name = "X,Y", value_parser = pair, allow_hyphen_values = true, required_unless_present = "list")]
    start: Option<[f64; 2]>,
    /// Goal, m.
    #[arg(long, value_name = "X,Y", value_parser = pair, allow_hyphen_values = true, required_unless_present = "list")]
    goal: Option<[f64; 2]>,
    /// Heading at the start, from east towards north, degrees; any where missing.
    #[arg(long, allow_hyphen_values = true)]
    heading: Option<f64>,
    /// The path on which the wheels need the least energy by the wheel-soil model, at any angle; needs --soil.
    #[arg(long)]
    by_energy: bool,
    /// Look for other paths to the goal and say how they compare: a different route, the shortest safe path, the least energy (on soil),
    /// the binary planner. A page (--html) has them in any case; they take some seconds.
    #[arg(long)]
    alternatives: bool,
    /// Most places to evaluate before giving up.
    #[arg(long, default_value_t = 100_000)]
    most_evaluations: usize,
    /// Write plan and failures as JSON (SI units, radians).
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write the path as CSV (SI units, radians; the columns of the slip are empty on firm ground, and where none is enough).
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Write a page with the map, its cost, the path and others, margins and slip along it, and the rover on it.
    #[arg(long)]
    html: Option<PathBuf>,
    /// List the numbers that --set changes, and stop.
    #[arg(long)]
    list: bool,
}

impl Plan {
    pub fn run(self) -> Result<()> {
        let mut site = self.ground.open()?;
        if self.list {
            for (variable, value) in site.settings.list() {
                say!("{} = {value} {} {} ({})", variable.name, variable.unit.symbol, variable.doc, variable.source);
            }
            return Ok(());
        }
        let (Some(start), Some(goal)) = (self.start, self.goal) else { return Ok(()) };
        check_all_writable([&self.json, &self.csv, &self.html])?;
        site.remarks().iter().try_for_each(|remark| crate::output::line(format_args!("map: {remark}")))?;
        let heading = self.heading.map(degrees).transpose()?;
        let request = Request { start, heading, goal, most_evaluations: self.most_evaluations };
        let plan = if self.by_energy { site.plan_by_energy(&request)? } else { site.plan(&request)? };
        let wanted = self.alternatives || self.html.is_some();
        let alternatives = if wanted { Some(site.alternatives(&request, &plan)?) } else { None };
        let answer = PlanAnswer::new(&site, &plan);
        let answer = alternatives.iter().fold(answer, PlanAnswer::with_alternatives);
        print(&answer, plan.measure)?;
        if let Some(file) = &self.csv {
            write(file, &csv(&answer))?;
        }
        if let Some(file) = &self.html {
            write(file, &bekker_planning::page::plan_page(&site, &plan, &answer, alternatives.as_ref()))?;
        }
        self.json.map_or(Ok(()), |file| write_json(&file, &serde_json::to_value(&answer)?))
    }
}

fn print(answer: &PlanAnswer, measure: Measure) -> Result<()> {
    let smallest = |of: &dyn Fn(usize) -> f64| (0..answer.points.len()).map(of).fold(f64::INFINITY, f64::min);
    say!("path of {:.2} m in {} points, {}", answer.length, answer.points.len(), measure.told(answer.cost));
    say!(
        "{} searches, {} places evaluated, {} of them unsafe",
        answer.searches,
        answer.evaluations,
        answer.failures.len()
    );
    say!("smallest stability angle {:.1} deg", smallest(&|k| answer.points[k].stability).to_degrees());
    say!("smallest thrust in reserve {:.2} N", smallest(&|k| answer.points[k].thrust));
    let clearance = smallest(&|k| answer.points[k].clearance.unwrap_or(f64::INFINITY));
    if clearance.is_finite() {
        say!("smallest clearance {clearance:.3} m");
    }
    if let Some(told) = &answer.slip_told {
        print_slip(answer, told)?;
    }
    for route in &answer.alternatives {
        say!("other path, {}: {:.2} m, {}", route.name, route.length, route.verdict);
    }
    for missing in &answer.alternatives_missing {
        say!("no other path, {missing}");
    }
    Ok(())
}

/// The largest slip with its band there, and where none is enough.
fn print_slip(answer: &PlanAnswer, told: &str) -> Result<()> {
    let percent =
        |end: Option<f64>| end.map_or("where none is enough".to_owned(), |slip| format!("{:.0} %", 100.0 * slip));
    let slips = answer.points.iter().filter_map(|point| Some((point.slip?, point)));
    if let Some((slip, point)) = slips.max_by(|a, b| a.0.total_cmp(&b.0)) {
        let (low, high) = (percent(point.slip_low), percent(point.slip_high));
        say!("largest slip {:.0} % after {:.2} m, its band from {low} to {high}", 100.0 * slip, point.travelled);
    }
    let none: Vec<f64> =
        answer.points.iter().filter(|point| point.slip.is_none()).map(|point| point.travelled).collect();
    if let Some(first) = none.first() {
        say!("at {} of {} points no slip is enough, first after {first:.2} m", none.len(), answer.points.len());
    }
    say!("{told}");
    Ok(())
}

fn csv(answer: &PlanAnswer) -> String {
    let rows = answer.points.iter().map(|point| {
        let others = [point.clearance, point.slip, point.slip_low, point.slip_high, point.slip_none];
        let others = others.map(|number| number.map_or(String::new(), |number| number.to_string())).join(",");
        let numbers = [
            point.travelled,
            point.x,
            point.y,
            point.z,
            point.heading,
            point.roll,
            point.pitch,
            point.stability,
            point.thrust,
        ];
        let numbers = numbers.map(|number| number.to_string()).join(",");
        format!("{numbers},{others}\n")
    });
    format!("{COLUMNS}\n{}", rows.collect::<String>())
}
