//! Where chassis and links of the nominal rover are, from measured pitch and joint angles.

use super::Nominal;

/// One body's place, in world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct BodyPlacement {
    /// A point of the body: the rover's centre of mass at zero joint angles for the chassis, the joint for a link.
    origin: [f64; 2],
    /// The same point from the chassis reference point, all angles at zero, m.
    reference: [f64; 2],
    sin: f64,
    cos: f64,
    /// Pitch plus joint angles, rad.
    angle: f64,
}

impl BodyPlacement {
    fn point(&self, reference: [f64; 2]) -> [f64; 2] {
        let (x, z) = (reference[0] - self.reference[0], reference[1] - self.reference[1]);
        [self.origin[0] + (x * self.cos - z * self.sin), self.origin[1] + (x * self.sin + z * self.cos)]
    }
}

/// Mass and first moment of bodies that a joint carries.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Load {
    mass: f64,
    moment: [f64; 2],
}

/// Places of all bodies, seen from the rover's centre of mass along world axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Posture {
    /// The chassis, then the links.
    places: Vec<BodyPlacement>,
    /// What each joint carries: its link and all links on that.
    loads: Vec<Load>,
    /// Centre of mass of the whole, from the point from which places count.
    centre: [f64; 2],
}

impl Posture {
    /// A posture of the nominal rover, to be filled by [`update`](Self::update).
    #[must_use]
    pub fn new(nominal: &Nominal) -> Self {
        let links = nominal.links.len();
        Self {
            places: vec![BodyPlacement::default(); 1 + links],
            loads: vec![Load::default(); links],
            centre: [0.0; 2],
        }
    }

    /// Places all bodies; `pitch` and one angle a link in rad.
    pub fn update(&mut self, nominal: &Nominal, pitch: f64, angles: impl Iterator<Item = f64>) {
        let (sin, cos) = pitch.sin_cos();
        self.places[0] = BodyPlacement { origin: [0.0; 2], reference: nominal.centre_of_mass, sin, cos, angle: pitch };
        for (j, (link, angle)) in nominal.links.iter().zip(angles).enumerate() {
            let parent = self.places[link.parent];
            let (reference, angle) = ([link.x, link.z], parent.angle + angle);
            let (sin, cos) = angle.sin_cos();
            self.places[j + 1] = BodyPlacement { origin: parent.point(reference), reference, sin, cos, angle };
        }
        self.weigh(nominal);
    }

    /// Adds up what the joints carry, and finds the centre of mass of the whole.
    fn weigh(&mut self, nominal: &Nominal) {
        if nominal.links.is_empty() {
            return;
        }
        // The chassis alone: the whole at zero angles without its links.
        let (mut mass, mut moment) = (nominal.mass, nominal.centre_of_mass.map(|place| nominal.mass * place));
        for (load, (link, place)) in self.loads.iter_mut().zip(nominal.links.iter().zip(&self.places[1..])) {
            let reference = [link.centre_of_mass_x, link.centre_of_mass_z];
            mass -= link.mass;
            for axis in 0..2 {
                moment[axis] -= link.mass * reference[axis];
            }
            *load = Load { mass: link.mass, moment: place.point(reference).map(|place| link.mass * place) };
        }
        let chassis = self.places[0].point(moment.map(|moment| moment / mass));
        let mut whole = chassis.map(|place| mass * place);
        // Children come after their parents, so that from the last to the first each load is complete.
        for j in (0..nominal.links.len()).rev() {
            let Load { mass, moment } = self.loads[j];
            let parent = nominal.links[j].parent;
            let onto = if parent == 0 { &mut whole } else { &mut self.loads[parent - 1].moment };
            onto[0] += moment[0];
            onto[1] += moment[1];
            if parent > 0 {
                self.loads[parent - 1].mass += mass;
            }
        }
        self.centre = whole.map(|moment| moment / nominal.mass);
    }

    /// The point of `body` (0 the chassis, k link k) that lies at `reference` from the chassis reference point when
    /// all angles are zero; from the centre of mass, m.
    #[must_use]
    pub fn point(&self, body: usize, reference: [f64; 2]) -> [f64; 2] {
        let [x, z] = self.places[body].point(reference);
        [x - self.centre[0], z - self.centre[1]]
    }

    /// The joint of link `link` (counted from 0), from the centre of mass, m.
    #[must_use]
    pub fn joint(&self, link: usize) -> [f64; 2] {
        let [x, z] = self.places[link + 1].origin;
        [x - self.centre[0], z - self.centre[1]]
    }

    /// Mass that the joint of link `link` carries (its link and all links on that), kg, and its centre of mass from
    /// that joint, m.
    #[must_use]
    pub fn carried(&self, link: usize) -> (f64, [f64; 2]) {
        let (Load { mass, moment }, joint) = (self.loads[link], self.places[link + 1].origin);
        (mass, [moment[0] / mass - joint[0], moment[1] / mass - joint[1]])
    }
}
