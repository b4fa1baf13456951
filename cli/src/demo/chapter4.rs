//! Chapter 4's comparison on gentle ground: rough-terrain control against velocity control.

use crate::output::say;
use anyhow::{Context, Result};
use bekker::measurement::Table;
use bekker::model::{Model, Summary};
use bekker::terrain::Terrain;
use bekker_reproduction::{Course, Drive, drive, drive_at};
use std::path::{Path, PathBuf};

/// Half a metre of level ground and two waves; a rover that has not arrived in time is reported with what it has done.
const COURSE: Course = Course { length: 5.0, time_limit: 120.0, sample: 0.01 };
/// The thesis's speed: 2.5 rad/s at a radius of 10 cm, m/s.
const SPEED: f64 = 0.25;

/// What was driven on one soil.
struct Trio {
    /// K in mm.
    shear_modulus: f64,
    velocity: Summary,
    rtc: Summary,
    /// Velocity control slowed down or sped up to RTC's mean speed.
    equal: Summary,
    /// RTC with wheel-speed loops, and velocity control at its mean speed.
    speeds: Summary,
    equal_speeds: Summary,
    /// Slip of velocity control on level ground.
    level_slip: f64,
}

/// Drives the rover and prints the table; returns what was written.
pub fn run(out: &Path) -> Result<Vec<(PathBuf, &'static str)>> {
    say!(
        "1. Chapter 4's two-wheeled rover over {} m of gently rolling sand (steepest slope 5 degrees)\n",
        COURSE.length
    );
    let heads = ["windings", "electric", "energy", "slip", "speed", "fastest rim"];
    say!(
        "   {:30} {:>9} {:>9} {:>9} {:>7} {:>9} {:>12}",
        "",
        heads[0],
        heads[1],
        heads[2],
        heads[3],
        heads[4],
        heads[5]
    );
    say!("   {:30} {:>9} {:>9} {:>9} {:>7} {:>9} {:>12}", "", "W", "W", "J/m", "%", "cm/s", "cm/s");
    say!("   {:30} {:>9} {:>9} {:>9} {:>7} {:>9} {:>12}", "thesis, velocity control", "4.7", "-", "-", "9.4", "-", "-");
    say!("   {:30} {:>9} {:>9} {:>9} {:>7} {:>9} {:>12}", "thesis, RTC", "2.9", "-", "-", "5.3", "< 25", "-");
    let mut written = Vec::new();
    let mut trios = Vec::new();
    for shear_modulus in [0.03, 0.01] {
        let trio = Trio::drive(shear_modulus, out, &mut written)?;
        let millimetres = 1e3 * shear_modulus;
        line(&format!("velocity control, K = {millimetres:.0} mm"), &trio.velocity)?;
        line(&format!("RTC, K = {millimetres:.0} mm"), &trio.rtc)?;
        line("  velocity control at that speed", &trio.equal)?;
        line(&format!("RTC by speeds, K = {millimetres:.0} mm"), &trio.speeds)?;
        line("  velocity control at that speed", &trio.equal_speeds)?;
        trios.push(trio);
    }
    explain(&trios)?;
    Ok(written)
}

fn line(label: &str, summary: &Summary) -> Result<()> {
    say!(
        "   {label:30} {:>9.2} {:>9.2} {:>9.1} {:>7.1} {:>9.1} {:>12.1}",
        summary.power,
        summary.electrical_power,
        summary.energy_per_metre,
        100.0 * summary.slip,
        100.0 * summary.speed,
        100.0 * summary.largest_rim_speed
    );
    Ok(())
}

impl Trio {
    fn drive(shear_modulus: f64, out: &Path, written: &mut Vec<(PathBuf, &'static str)>) -> Result<Self> {
        let model = |preset| -> Result<Model> {
            let mut model = Model::preset(preset)?;
            model.rover.soil.shear_modulus = shear_modulus;
            Ok(model)
        };
        let mut save = |preset: &str, table: &Table| -> Result<()> {
            let path = out.join(format!("{preset}_K{:.0}mm.csv", 1e3 * shear_modulus));
            table.save(&path).with_context(|| format!("cannot write `{}`", path.display()))?;
            written.push((path, "signals of that drive over time"));
            Ok(())
        };
        let velocity = driven(&model("gentle_velocity")?, SPEED)?;
        save("gentle_velocity", &velocity.table)?;
        let rtc = driven(&model("gentle_rtc")?, SPEED)?;
        save("gentle_rtc", &rtc.table)?;
        let speeds = driven(&model("gentle_rtc_speed")?, SPEED)?;
        save("gentle_rtc_speed", &speeds.table)?;
        let velocity_at = |speed: f64| -> Result<Drive> {
            drive_at(&model("gentle_velocity")?, speed, &COURSE).map_err(anyhow::Error::from_boxed)
        };
        let (equal, equal_speeds) = (velocity_at(rtc.summary.speed)?, velocity_at(speeds.summary.speed)?);
        let mut level = model("gentle_velocity")?;
        level.rover.terrain = Terrain::default();
        let level_slip = driven(&level, SPEED)?.summary.slip;
        let (velocity, rtc, equal) = (velocity.summary, rtc.summary, equal.summary);
        let (speeds, equal_speeds) = (speeds.summary, equal_speeds.summary);
        Ok(Self { shear_modulus, velocity, rtc, equal, speeds, equal_speeds, level_slip })
    }
}

/// One drive over the course at this commanded speed, m/s; says so where it ends early.
fn driven(model: &Model, speed: f64) -> Result<Drive> {
    let done = drive(model, speed, &COURSE).map_err(anyhow::Error::from_boxed)?;
    if let Some(event) = done.event {
        say!("   {} ended early: {event}", model.name);
    }
    Ok(done)
}

/// Says why our figures differ from the thesis's, with the figures just measured.
fn explain(trios: &[Trio]) -> Result<()> {
    let [stated, firm] = trios else { return Ok(()) };
    say!("\n   Why these differ from the thesis:");
    say!(
        "   - Slip. The stated soil (K = 30 mm) asks for {:.0} % slip on level ground by the full stress",
        100.0 * stated.level_slip
    );
    say!(
        "     integrals and {:.0} % on these waves, not 9.4 %; K = 10 mm gives {:.1} % and {:.1} %.",
        100.0 * stated.velocity.slip,
        100.0 * firm.level_slip,
        100.0 * firm.velocity.slip
    );
    say!("   - Power. Motors, gear, gains, gravity and the centre of mass's height are not in the thesis; ours are");
    say!("     assumptions (`bekker parameters gentle_rtc` lists each), so watts compare only with ours.");
    say!("   - RTC against velocity control: the thesis has -38.3 % power, at speeds that it does not state.");
    for Trio { shear_modulus, velocity, rtc, equal, speeds, equal_speeds, .. } in trios {
        say!(
            "     K = {:.0} mm: {:+.1} % in the windings at {:.1} against {:.1} cm/s; at equal speed {:+.1} % in the windings",
            1e3 * shear_modulus,
            change(velocity.power, rtc.power),
            100.0 * rtc.speed,
            100.0 * velocity.speed,
            change(equal.power, rtc.power)
        );
        say!("     and {:+.1} % energy a metre;", change(equal.energy_per_metre, rtc.energy_per_metre));
        say!(
            "     RTC with wheel-speed loops {:+.1} % energy a metre at equal speed.",
            change(equal_speeds.energy_per_metre, speeds.energy_per_metre)
        );
    }
    say!(
        "     The thesis's RTC commands torques, not speeds: where the soil gives way its wheels run away (fastest rim above)."
    );
    say!("   - Terrain. Figure 4.6 gives no numbers; ours are waves of 2.5 m. RTC here reads speed and contact angles");
    say!("     without noise, knows the true soil and has no resistance term, so it droops below 25 cm/s.");
    Ok(())
}

/// Change from `a` to `b` in per cent.
fn change(a: f64, b: f64) -> f64 {
    100.0 * (b / a - 1.0)
}
