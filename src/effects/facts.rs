//! What others need to know of an effect beside its hooks. Tables elsewhere ask for it here and name no effect.

/// What a rover must have for an effect to act on it at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing beside wheels and soil.
    Nothing,
    /// Commanded torques: a wheel whose speed is imposed does not feel the effect.
    CommandedTorque,
    /// Passive joints: a rigid chassis does not feel the effect.
    Joints,
}

/// The equipment that an advised experiment takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equipment {
    /// A wheel on a carriage, which can be lifted and loaded.
    Carriage,
    /// A rover: several wheels, its own pitch, a way to go.
    Rover,
    /// A rover with passive joints.
    JointedRover,
    /// A plate and a shear ring beside either rig, and soil parameters that are free and not known from such a test yet.
    SoilTest,
    /// A plate that is pressed into the soil.
    Plate,
    /// A shear ring or box.
    ShearBox,
}

/// An experiment in which an effect acts alone or against all others, so that no simulation has to be asked whether it
/// separates. Effects that list the same advice act in the same experiment, and it tells them apart from each other too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Advice {
    /// What it takes.
    pub equipment: Equipment,
    /// What to do and why it decides, as a page prints it.
    pub text: &'static str,
}

impl Advice {
    /// An experiment with a wheel on a carriage.
    #[must_use]
    pub const fn carriage(text: &'static str) -> Self {
        Self { equipment: Equipment::Carriage, text }
    }

    /// An experiment with a rover.
    #[must_use]
    pub const fn rover(text: &'static str) -> Self {
        Self { equipment: Equipment::Rover, text }
    }

    /// An experiment with a plate.
    #[must_use]
    pub const fn plate(text: &'static str) -> Self {
        Self { equipment: Equipment::Plate, text }
    }

    /// An experiment with a shear ring or box.
    #[must_use]
    pub const fn shear(text: &'static str) -> Self {
        Self { equipment: Equipment::ShearBox, text }
    }
}

/// Words that the header of a recorded column has where it means a parameter of the effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// All of these words, in small letters.
    pub words: &'static [&'static str],
    /// The parameter, without the effect's id.
    pub parameter: &'static str,
}

/// What others need to know of an effect; none of it depends on the values of its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    /// What a rover must have for the effect to act at all.
    pub needs: Needs,
    /// Signals of a wheel on a carriage in which the effect shows; none where it changes nothing there, to the last bit.
    pub seen_on_carriage: &'static [&'static str],
    /// Signals of a rover that has what the effect needs, in which it shows: wheel 1 stands for all wheels.
    pub seen_on_rover: &'static [&'static str],
    /// Signals of a test of the soil, by a plate or by shear, in which the effect shows; none where it changes nothing there.
    pub seen_in_soil_test: &'static [&'static str],
    /// Values, in SI units, with which a rover of 10 kg drives and the effect shows. Of a parameter that is not listed, a
    /// quarter of the way from neutral to the farther bound is such a value.
    pub typical: &'static [(&'static str, f64)],
    /// Experiments that show the effect apart from others, the simplest first.
    pub advice: &'static [Advice],
    /// Whether the parameters may change while a run is under way: not where a wheel's size or the length of a memory
    /// depends on them.
    pub tunable: bool,
    /// Parameters, without the effect's id, that may not change then although the others may.
    pub not_tunable: &'static [&'static str],
    /// Parameters, without the effect's id, beside whose neutral value no other law begins once another parameter of the effect is not
    /// neutral: the same formulas, branches and quadrature hold there, so that a finite difference gives the derivative.
    pub smooth_at_neutral: &'static [&'static str],
    /// Headers of recorded columns that mean one of the parameters.
    pub headers: &'static [Header],
}

impl Facts {
    /// The usual: an effect that needs nothing, is tunable, and shows nowhere. An effect overwrites at least
    /// [`seen_on_rover`](Self::seen_on_rover).
    pub const USUAL: Self = Self {
        needs: Needs::Nothing,
        seen_on_carriage: &[],
        seen_on_rover: &[],
        seen_in_soil_test: &[],
        typical: &[],
        advice: &[],
        tunable: true,
        not_tunable: &[],
        smooth_at_neutral: &[],
        headers: &[],
    };
}

/// What a test of the soil is good for: four effects of the soil under a wheel list it.
pub const SOIL_TEST: Advice = Advice {
    equipment: Equipment::SoilTest,
    text: "test the soil with a plate and a shear ring and give k_phi, n, cohesion and friction as priors: a calibration then no longer absorbs the effect",
};
