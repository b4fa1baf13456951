//! A plan as one self-contained page: the map with cost, path and alternatives, margins and slip along it, the rover on the ground at any
//! point.

mod cost;

use crate::alternatives::Alternatives;
use crate::answer::{PlanAnswer, RouteAnswer};
use crate::map::ElevationMap;
use crate::plan::{Measure, Plan};
use crate::robot::Frames;
use crate::site::Site;
use cost::CostMap;
use serde::Serialize;

/// A map is thinned to at most this many nodes along a side: what a screen shows.
const SIDE: usize = 260;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = concat!(
    include_str!("common.js"),
    include_str!("map.js"),
    include_str!("rover.js"),
    include_str!("strips.js"),
    include_str!("routes.js"),
    include_str!("main.js"),
);
const BODY: &str = include_str!("page.html");

/// Heights as the page draws them.
#[derive(Serialize)]
struct Heights {
    columns: usize,
    rows: usize,
    cell: f64,
    origin: [f64; 2],
    /// mm; null in a hole.
    heights: Vec<Option<i64>>,
}

/// The rover in one point of the path, m.
#[derive(Serialize)]
struct Rover {
    /// Centres of the wheels.
    wheels: Vec<[f64; 3]>,
    /// Forward and up directions of each wheel's plane.
    planes: Vec<[[f64; 3]; 2]>,
    /// Ends of links, in pairs.
    bars: Vec<[[f64; 3]; 2]>,
    /// Corners of the belly.
    belly: Vec<[f64; 3]>,
}

#[derive(Serialize)]
struct Data<'a> {
    /// The cost in words.
    cost: String,
    by_energy: bool,
    map: Heights,
    cost_map: CostMap,
    answer: &'a PlanAnswer,
    /// The plan's path in the numbers of the alternatives; null where these were not asked for.
    chosen: Option<RouteAnswer>,
    rovers: Vec<Rover>,
    radius: f64,
    stability_limit: f64,
    thrust_limit: f64,
    clearance_limit: f64,
    slip_limit: f64,
}

/// The page of a plan, for a browser without a network; with the other paths where they were asked for.
#[must_use]
pub fn plan_page(site: &Site, plan: &Plan, answer: &PlanAnswer, alternatives: Option<&Alternatives>) -> String {
    let (robot, settings) = (site.robot(), &site.settings);
    let map = site.surface().map();
    let stride = map.columns().max(map.rows()).div_ceil(SIDE);
    let data = Data {
        cost: plan.measure.told(plan.cost),
        by_energy: plan.measure == Measure::Energy,
        map: heights(map, stride),
        cost_map: CostMap::new(site, plan.measure, stride),
        answer,
        chosen: alternatives.map(|found| RouteAnswer { points: Vec::new(), ..RouteAnswer::new(&found.chosen) }),
        rovers: plan.points.iter().map(|point| rover(site, &point.assessment.pose.attitude)).collect(),
        radius: robot.wheel_radius,
        stability_limit: settings.limits.stability,
        thrust_limit: settings.limits.thrust * site.weight(),
        clearance_limit: settings.limits.clearance,
        slip_limit: settings.energy.most_slip,
    };
    // No script can end within a string of it.
    let data = serde_json::to_string(&data).unwrap_or_default().replace("</", "<\\/");
    let body = BODY.replace("{length}", &format!("{:.2}", answer.length));
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Bekker: plan</title>\
         <meta name=\"viewport\" content=\"width=device-width\"><style>{STYLE}</style></head><body>\n\
         {body}<script>const data = {data};\n{SCRIPT}</script></body></html>\n",
    )
}

fn heights(map: &ElevationMap, stride: usize) -> Heights {
    // Thinning leaves 2 x 2 nodes of any map that is longer than the stride.
    let map = map.thinned(stride).unwrap_or_else(|_| map.clone());
    let mm = |z: &f64| z.is_finite().then(|| (z * 1000.0).round() as i64);
    let heights = map.heights().iter().map(mm).collect();
    Heights { columns: map.columns(), rows: map.rows(), cell: map.cell(), origin: map.origin(), heights }
}

fn rover(site: &Site, attitude: &crate::robot::Attitude) -> Rover {
    let robot = site.robot();
    let frames = Frames::new(robot, attitude, &site.active);
    let joint_of = |link: Option<usize>| link.map_or([0.0; 3], |k| robot.links[k].joint.at);
    let bar =
        |link: Option<usize>, to: [f64; 3]| [frames.point(link, joint_of(link)).into(), frames.point(link, to).into()];
    let wheels = robot.wheels.iter().map(|wheel| bar(wheel.link, wheel.centre));
    let links = robot.links.iter().map(|link| bar(link.parent, link.joint.at));
    let plane = |link| [nalgebra::Vector3::x(), nalgebra::Vector3::z()].map(|axis| frames.direction(link, axis).into());
    let belly = robot.belly.map_or(Vec::new(), |belly| {
        let corners = [(belly.rear, -1.0), (belly.front, -1.0), (belly.front, 1.0), (belly.rear, 1.0)];
        corners.map(|(x, side)| frames.point(None, [x, side * belly.half_width, belly.z]).into()).to_vec()
    });
    Rover {
        wheels: robot.wheels.iter().map(|wheel| frames.point(wheel.link, wheel.centre).into()).collect(),
        planes: robot.wheels.iter().map(|wheel| plane(wheel.link)).collect(),
        bars: wheels.chain(links).collect(),
        belly,
    }
}
