//! Ground of the thesis's experiments, where a preset with a few numbers does not describe it.

use super::{
    Profile, Random, Samples, SamplesError, SoilColumn, SoilTable, SoilTableError, Spectrum, Terrain, TerrainSpecError,
};
use std::sync::Arc;

/// Distance between the samples of a course, m: fine beside every wheel that the project ships.
const SPACING: f64 = 0.01;
/// Known ground behind the start, m.
const BEHIND: f64 = 3.0;

/// Rough ground behind a level run-in, scaled so that its steepest place has a given slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rough {
    /// Slope of the steepest place between run-in and end, rad.
    pub steepest: f64,
    /// Longest wavelength, m.
    pub wavelength: f64,
    /// Spectral exponent of the height; larger is smoother.
    pub exponent: f64,
    /// Level ground ahead of the start, then 0.5 m over which the roughness sets in, m.
    pub run_in: f64,
    /// End of the known ground, m.
    pub length: f64,
    /// Seed of the phases.
    pub seed: u32,
}

impl Default for Rough {
    /// The stand-in for figure 4.8 of Iagnemma 2001, which gives no numbers but "maximum slopes near the internal friction
    /// angle" of 29 degrees. Wavelengths of twice the rover's length and an exponent at which wavelengths under a wheel's
    /// radius hardly matter are assumptions.
    fn default() -> Self {
        Self { steepest: 29.0_f64.to_radians(), wavelength: 2.0, exponent: 4.0, run_in: 0.5, length: 9.0, seed: 0 }
    }
}

impl Rough {
    /// Length over which the roughness sets in, m.
    const BLEND: f64 = 0.5;

    /// The ground.
    ///
    /// # Errors
    /// [`SamplesError`] where a number is not finite or the course is shorter than two samples.
    pub fn terrain(&self) -> Result<Terrain, SamplesError> {
        let spectrum = Spectrum { roughness: 1.0, wavelength: self.wavelength, exponent: self.exponent };
        let ground = Terrain::new(Profile::Random(Random::new(spectrum, self.seed)));
        let x = positions(self.length);
        let shape: Vec<f64> = x.iter().map(|&x| self.share(x) * ground.at(x).height).collect();
        let slopes = shape.windows(2).map(|pair| ((pair[1] - pair[0]) / SPACING).abs());
        let scale = self.steepest.tan() / slopes.fold(0.0, f64::max);
        let z: Vec<f64> = shape.iter().map(|z| scale * z).collect();
        Ok(Terrain::new(Profile::Samples(Arc::new(Samples::new(&x, &z)?))))
    }

    /// Share of the roughness at `x`: 0 on the run-in, 1 behind the blend, C1 between.
    fn share(&self, x: f64) -> f64 {
        let u = ((x - self.run_in) / Self::BLEND).clamp(0.0, 1.0);
        u * u * (3.0 - 2.0 * u)
    }
}

/// Level ground, then a plane of constant slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incline {
    /// Slope of the plane, rad.
    pub slope: f64,
    /// Where the level ends, m.
    pub start: f64,
    /// Length along x over which the slope grows from 0, m.
    pub transition: f64,
    /// End of the known ground, m.
    pub length: f64,
}

impl Default for Incline {
    /// The 20 degree incline of Iagnemma 2001, 2.6.2; where it begins and how sharp its foot is are assumptions.
    fn default() -> Self {
        Self { slope: 20.0_f64.to_radians(), start: 0.5, transition: 0.1, length: 3.0 }
    }
}

impl Incline {
    /// The ground.
    ///
    /// # Errors
    /// [`SamplesError`] where a number is not finite or the course is shorter than two samples.
    pub fn terrain(&self) -> Result<Terrain, SamplesError> {
        let x = positions(self.length);
        let z: Vec<f64> = x.iter().map(|&x| self.height(x)).collect();
        Ok(Terrain::new(Profile::Samples(Arc::new(Samples::new(&x, &z)?))))
    }

    /// The integral of a slope that grows linearly over the transition.
    fn height(&self, x: f64) -> f64 {
        let along = (x - self.start).max(0.0);
        let bent = along.min(self.transition);
        let parabola = if self.transition > 0.0 { 0.5 * bent * bent / self.transition } else { 0.0 };
        self.slope.tan() * (parabola + along - bent)
    }
}

/// A ditch of loose sand in firmer ground: straight walls with rounded rims and a rounded bottom.
///
/// Loose sand slides down to its angle of repose, about its friction angle, so that depth and width hang together: a
/// ditch as wide as `width` is at most tan(wall) (width/2 - rounding sin(wall)) deep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LooseDitch {
    /// Distance from rim to rim, m.
    pub width: f64,
    /// Slope of the walls, rad.
    pub wall: f64,
    /// Radius of rims and bottom, m; no less than that of a wheel, which shapes loose sand so.
    pub rounding: f64,
    /// Position of the deepest place, m.
    pub position: f64,
    /// Cohesion of the loose sand, Pa.
    pub cohesion: f64,
    /// Factor of the loose sand on Bekker's moduli.
    pub modulus_factor: f64,
}

impl LooseDitch {
    /// Width along x over which the soil changes, m.
    const EDGE: f64 = 0.02;
    /// Distance between the samples of the ditch, m.
    const SPACING: f64 = 0.0025;
    /// Known ground before and behind the ditch, m.
    const AROUND: f64 = 5.0;

    /// Depth of the deepest place below the level ground, m.
    #[must_use]
    pub fn depth(&self) -> f64 {
        -self.height(0.0)
    }

    /// The ground; `firm_cohesion` (Pa) is that of the soil outside.
    ///
    /// # Errors
    /// [`TerrainSpecError`] where a number is out of range.
    pub fn terrain(&self, firm_cohesion: f64) -> Result<Terrain, TerrainSpecError> {
        let half = 0.5 * self.width;
        let count = (self.width / Self::SPACING).max(2.0).ceil() as usize;
        let along = |i: usize| -half + self.width * i as f64 / count as f64;
        // A sample a spacing outside keeps the level ground level up to the rims.
        let beside = [half + Self::AROUND, half + Self::SPACING];
        let mut places: Vec<f64> = beside.iter().map(|x| -x).collect();
        places.extend((0..=count).map(along));
        places.extend(beside.iter().rev());
        let z: Vec<f64> = places.iter().map(|&along| self.height(along)).collect();
        let x: Vec<f64> = places.iter().map(|along| self.position + along).collect();
        let ground = Terrain::new(Profile::Samples(Arc::new(Samples::new(&x, &z)?)));
        Ok(ground.with_soil(self.soil(firm_cohesion)?))
    }

    fn soil(&self, firm_cohesion: f64) -> Result<SoilTable, SoilTableError> {
        let (from, to) = (self.position - 0.5 * self.width, self.position + 0.5 * self.width);
        let x = vec![from - Self::EDGE, from, to, to + Self::EDGE];
        let column = |name: &str, firm: f64, loose: f64| SoilColumn {
            name: name.to_owned(),
            values: vec![firm, loose, loose, firm],
        };
        let columns = vec![
            column("cohesion", firm_cohesion, self.cohesion),
            column("k_phi_factor", 1.0, self.modulus_factor),
            column("k_c_factor", 1.0, self.modulus_factor),
        ];
        SoilTable::new(x, columns)
    }

    /// Height at a distance from the middle, m: arcs of circles and straight lines, C1. A ditch too narrow for its walls
    /// has its rims' arcs meet the bottom's.
    fn height(&self, along: f64) -> f64 {
        let half = 0.5 * self.width;
        let wall = self.wall.min((0.5 * half / self.rounding).min(1.0).asin());
        let (sin, cos) = wall.sin_cos();
        // Each arc reaches `reach` along x and `rise` in height.
        let (reach, rise) = (self.rounding * sin, self.rounding * (1.0 - cos));
        let depth = 2.0 * rise + wall.tan() * (half - 2.0 * reach);
        let from_rim = (half - along.abs()).max(0.0);
        let from_middle = half - from_rim;
        let arc = |x: f64| self.rounding - (self.rounding * self.rounding - x * x).max(0.0).sqrt();
        if from_rim < reach {
            -arc(from_rim)
        } else if from_middle < reach {
            arc(from_middle) - depth
        } else {
            -rise - wall.tan() * (from_rim - reach)
        }
    }
}

/// Sample positions from behind the start to `length`.
fn positions(length: f64) -> Vec<f64> {
    let count = ((length + BEHIND) / SPACING).max(0.0).round() as usize;
    (0..=count).map(|i| -BEHIND + SPACING * i as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    #[test]
    fn analytic_rough_ground_is_as_steep_as_asked() -> Outcome {
        for seed in 0..20 {
            let course = Rough { seed, ..Rough::default() };
            let terrain = course.terrain()?;
            let steepest = (0..9000).map(|i| terrain.at(1e-3 * f64::from(i)).slope.abs()).fold(0.0, f64::max);
            // Secants of 1 cm set the scale; the curve between samples may be a little steeper.
            assert!((steepest.atan() - course.steepest).abs() < 0.01, "{seed}: {}", steepest.atan());
            assert!((0..50).all(|i| terrain.at(0.01 * f64::from(i)).height == 0.0));
        }
        Ok(())
    }

    #[test]
    fn analytic_an_incline_is_level_then_constant() -> Outcome {
        let course = Incline::default();
        let terrain = course.terrain()?;
        assert_eq!(terrain.at(0.4).height, 0.0);
        let far = terrain.at(2.0);
        assert!((far.slope - course.slope.tan()).abs() < 1e-9);
        let expected = course.slope.tan() * (2.0 - course.start - 0.5 * course.transition);
        assert!((far.height - expected).abs() < 1e-9, "{}", far.height);
        Ok(())
    }

    /// Secants of 2.5 mm between arcs of 8 cm.
    const SAMPLED: f64 = 0.01;

    #[test]
    fn analytic_a_loose_ditch_has_walls_of_the_given_slope() -> Outcome {
        let wall = 28.0_f64.to_radians();
        let ditch =
            LooseDitch { width: 0.4, wall, rounding: 0.08, position: 1.0, cohesion: 180.0, modulus_factor: 0.5 };
        // The straight wall would reach the middle `reach/2` on either side lower than the arcs let it.
        let reach = 0.08 * wall.sin();
        let depth = wall.tan() * (0.2 - 2.0 * reach) + 2.0 * 0.08 * (1.0 - wall.cos());
        assert!((ditch.depth() - depth).abs() < 1e-12);
        let terrain = ditch.terrain(1000.0)?;
        assert!((terrain.at(1.0).height + depth).abs() < 1e-6 && terrain.at(1.0).slope.abs() < SAMPLED);
        assert!((terrain.at(1.1).slope - wall.tan()).abs() < 1e-6);
        assert_eq!((terrain.at(0.79).height, terrain.at(1.21).height), (0.0, 0.0));
        let steepest = (0..400).map(|i| terrain.at(0.8 + 1e-3 * f64::from(i)).slope.abs()).fold(0.0, f64::max);
        assert!((steepest - wall.tan()).abs() < SAMPLED, "{steepest}");
        // Too narrow for walls of that slope: arcs alone, less steep.
        let narrow = LooseDitch { width: 0.1, ..ditch };
        assert!(narrow.depth() > 0.0 && narrow.depth() < 0.5 * wall.tan() * 0.1);
        Ok(())
    }
}
