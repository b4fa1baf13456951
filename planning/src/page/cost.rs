//! The cost over the map, as the page draws it.

use crate::anisotropic::{DirectionTable, DirectionalCost, GroundEnergy};
use crate::map::{ElevationMap, Surface};
use crate::plan::{CostField, Measure};
use crate::site::Site;
use serde::Serialize;

/// Costs are drawn between those that these shares of the nodes do not pass.
const DRAWN: [f64; 2] = [0.01, 0.99];

/// How a cost becomes a colour. The index grows with a power of the roughness, energy with the slope.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
enum Scale {
    Linear,
    Logarithm,
}

/// Cost of a metre or step at the nodes of a thinned map.
#[derive(Serialize)]
pub(super) struct CostMap {
    /// What it is.
    name: &'static str,
    /// Smallest and largest that are drawn, in words.
    least: String,
    most: String,
    scale: Scale,
    /// From 0 to 255 by the scale; null where the rover cannot go.
    levels: Vec<Option<u8>>,
}

impl CostMap {
    /// The cost that a plan of this measure counts at every `stride`-th node of the site's map.
    pub(super) fn new(site: &Site, measure: Measure, stride: usize) -> Self {
        let map = site.surface().map();
        let energy = site.slope_energy().and_then(Result::ok).filter(|_| measure == Measure::Energy);
        match energy {
            Some(energy) => {
                let ground = GroundEnergy::new(site.surface(), &energy, site.resistance());
                Self::of(
                    "Energy of a metre, J, mean over the directions that can be driven",
                    Scale::Linear,
                    &energies(site.surface(), &ground, stride),
                )
            }
            None => {
                let costs = CostField::means(map, site.robot(), &site.settings.index, stride);
                Self::of("Performance index of a step, mean over the headings", Scale::Logarithm, &costs)
            }
        }
    }

    fn of(name: &'static str, scale: Scale, costs: &[f64]) -> Self {
        let mut sorted: Vec<f64> = costs.iter().copied().filter(|cost| cost.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().saturating_sub(1) as f64;
        let [least, most] = DRAWN.map(|share| sorted.get((share * last) as usize).copied().unwrap_or(1.0));
        let shade = |cost: f64| match scale {
            Scale::Linear => (cost - least) / (most - least).max(f64::MIN_POSITIVE),
            Scale::Logarithm => (cost / least).ln() / (most / least).ln().max(f64::MIN_POSITIVE),
        };
        let level = |cost: &f64| cost.is_finite().then(|| (255.0 * shade(*cost)).clamp(0.0, 255.0) as u8);
        let told = |cost: f64| if cost < 10.0 { format!("{cost:.3}") } else { format!("{cost:.1}") };
        Self { name, least: told(least), most: told(most), scale, levels: costs.iter().map(level).collect() }
    }
}

/// Mean energy of a metre over the directions that can be driven, J; infinite where none can.
fn energies(surface: &Surface, ground: &GroundEnergy, stride: usize) -> Vec<f64> {
    let directions = DirectionTable::directions();
    let mean = |place: [f64; 2]| {
        let costs = directions.iter().map(|direction| ground.per_metre(place, *direction));
        let (count, sum) =
            costs.filter(|cost| cost.is_finite()).fold((0.0, 0.0), |(count, sum), cost| (count + 1.0, sum + cost));
        if count > 0.0 { sum / count } else { f64::INFINITY }
    };
    thinned(surface.map(), stride).map(mean).collect()
}

/// Places of every `stride`-th node, m.
fn thinned(map: &ElevationMap, stride: usize) -> impl Iterator<Item = [f64; 2]> {
    let rows = (0..map.rows()).step_by(stride);
    rows.flat_map(move |row| (0..map.columns()).step_by(stride).map(move |column| map.place(column, row)))
}
