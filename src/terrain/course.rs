//! Ground of the thesis's experiments, where a preset with a few numbers does not describe it.

use super::{Ditch, Profile, Random, Samples, SamplesError, SoilColumn, SoilTable, SoilTableError, Spectrum, Terrain};
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

/// A ditch filled with loose sand in firmer ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LooseDitch {
    /// Shape of its surface.
    pub ditch: Ditch,
    /// Cohesion of the loose sand, Pa.
    pub cohesion: f64,
    /// Factor of the loose sand on Bekker's moduli.
    pub modulus_factor: f64,
}

impl LooseDitch {
    /// Width along x over which the soil changes, m.
    const EDGE: f64 = 0.02;

    /// The ground; `firm_cohesion` (Pa) is that of the soil outside.
    ///
    /// # Errors
    /// [`SoilTableError`] where a number is out of range.
    pub fn terrain(&self, firm_cohesion: f64) -> Result<Terrain, SoilTableError> {
        let Ditch { width, position, .. } = self.ditch;
        let (from, to) = (position - 0.5 * width, position + 0.5 * width);
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
        Ok(Terrain::new(Profile::Ditch(self.ditch)).with_soil(SoilTable::new(x, columns)?))
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
}
