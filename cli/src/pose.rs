//! `bekker pose`.

use crate::ground::{GroundArguments, degrees, pair};
use crate::output::{say, write_json};
use anyhow::Result;
use bekker_planning::answer::PoseAnswer;
use std::path::PathBuf;

/// Place a robot on a map: its pose, wheel contacts, stability and thrust.
#[derive(clap::Args)]
pub struct Pose {
    #[command(flatten)]
    ground: GroundArguments,
    /// Where the robot's reference point is, m.
    #[arg(long, value_name = "X,Y", value_parser = pair, allow_hyphen_values = true)]
    at: [f64; 2],
    /// Heading from east (x) towards north (y), degrees.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    heading: f64,
    /// Write everything as JSON (SI units, radians).
    #[arg(long)]
    json: Option<PathBuf>,
}

impl Pose {
    pub fn run(self) -> Result<()> {
        let site = self.ground.open()?;
        site.remarks().iter().try_for_each(|remark| crate::output::line(format_args!("map: {remark}")))?;
        let (pose, failure) = site.pose(self.at, degrees(self.heading)?)?;
        let answer = PoseAnswer::new(&site, &pose, failure.as_ref());
        let [x, y, z] = answer.position;
        say!("reference point ({x:.3}, {y:.3}, {z:.3}) m");
        say!(
            "roll {:.2} deg (left side up), pitch {:.2} deg (nose up)",
            answer.roll.to_degrees(),
            answer.pitch.to_degrees()
        );
        for joint in &answer.joints {
            say!("  {:16} {:8.4}", joint.name, joint.value);
        }
        for wheel in &answer.wheels {
            let [x, y, z] = wheel.point;
            say!(
                "  {:16} touches ({x:.3}, {y:.3}, {z:.3}) m, slope {:.1} deg",
                wheel.name,
                wheel.contact_angle.to_degrees()
            );
        }
        if let Some(clearance) = answer.clearance {
            say!("belly {clearance:.3} m over the ground");
        }
        if let Some(stability) = answer.stability {
            say!("stability angle {:.1} deg", stability.to_degrees());
        }
        match answer.thrust {
            Some(thrust) => say!("largest thrust {thrust:.2} N"),
            None => say!("no forces within friction and drives hold the robot"),
        }
        match &answer.failure {
            None => say!("safe"),
            Some(reason) => say!("not safe: {reason}"),
        }
        self.json.map_or(Ok(()), |file| write_json(&file, &serde_json::to_value(&answer)?))
    }
}
