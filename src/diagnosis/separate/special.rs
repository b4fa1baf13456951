//! Experiments that the model is not asked about, because what separates there is known beforehand: a single cause acts.

/// Effects, and the experiment in which they act alone or against all others; the simplest first.
const SPECIAL: [(&[&str], &str); 14] = [
    (
        &["coulomb_friction", "viscous_friction"],
        "spin the lifted wheel at two or more speeds and record its torque: without soil only the friction of the drive is left",
    ),
    (
        &["torque_scale", "gear_efficiency"],
        "drive and back-drive the wheel against a known torque (a brake or a hanging weight): a scale acts the same way in both, an efficiency does not",
    ),
    (
        &["radius_scale", "drag", "odometry_scale"],
        "tow the rover over a hard floor and count wheel turns a metre: without sinkage the radius and the resistance are read directly",
    ),
    (&["payload", "centre_of_mass"], "weigh the rover wheel by wheel: that gives its mass and its centre of mass"),
    (
        &["pitch_bias", "centre_of_mass"],
        "drive the same ground with the heading reversed: the mean of both pitches is the sensor's bias, and what stays of the split of the wheel loads is the centre of mass",
    ),
    (&["multi_pass"], "drive the same rut twice and compare the passes"),
    (&["rate"], "repeat a steady point at three speeds that span a factor of ten"),
    (
        &["winding_heat"],
        "let the loaded drive run for half an hour (a long soak) and record current and voltage: only heat changes with time",
    ),
    (&["tether"], "drive the same length twice with the cable held by hand and laid out"),
    (&["soft_patch"], "repeat the run on freshly prepared soil some metres aside: a patch stays where it is"),
    (
        &["voltage_limit"],
        "drive under load with the wheel speeds recorded beside their commands: a limited supply lets them sag",
    ),
    (&["sensor_lag"], "start and stop in steps: a lag shows in transients only"),
    (
        &["suspension_friction"],
        "drive over a step on a hard floor and back: friction of the joints shows as hysteresis",
    ),
    (
        &["slip_sinkage", "bulldozing", "grousers", "rim_adhesion", "moisture", "slope_strength"],
        "test the soil with a plate and a shear ring and give k_phi, n, cohesion and friction as priors: a calibration then no longer absorbs the effect",
    ),
];

/// An experiment that shows `effect` apart from `other` (or from the calibration where there is no other).
pub(crate) fn special(effect: &str, other: Option<&str>) -> Option<&'static str> {
    let apart = |effects: &[&str]| effects.contains(&effect) && other.is_none_or(|other| !effects.contains(&other));
    let both = |effects: &[&str]| effects.contains(&effect) && other.is_some_and(|other| effects.contains(&other));
    let find = |fits: &dyn Fn(&[&str]) -> bool| SPECIAL.iter().find(|(ids, _)| fits(ids)).map(|(_, text)| *text);
    // An experiment made for the very pair comes first.
    find(&both).or_else(|| find(&apart))
}
