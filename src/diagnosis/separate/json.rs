//! The JSON of a separation. Keys may be added, none changes its meaning.

use super::separation::Separation;
use serde_json::{Map, Value, json};

impl Separation {
    /// The separation as JSON, in SI units. Numbers that are not finite are null.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let noise = self.noise.iter().map(|(signal, assumed)| {
            (signal.clone(), json!({"deviation": assumed.model.deviation, "source": assumed.source.name()}))
        });
        let absorbing = self.absorbing.iter().map(|(name, value)| (name.clone(), json!(value)));
        json!({
            "experiment": self.name,
            "calibrated": self.calibrated,
            "noise": noise.collect::<Map<_, _>>(),
            "absorbing": absorbing.collect::<Map<_, _>>(),
            "effects": self.effects.iter().map(|sight| json!({
                "effect": sight.effect,
                "visible": sight.visible,
                "visible_share": sight.visible_share,
                "size": sight.size,
                "smallest": sight.smallest.iter().map(|strength| json!({
                    "parameter": strength.variable.name,
                    "unit": strength.variable.unit.symbol,
                    "neutral": strength.neutral,
                    "value": strength.value,
                    "bounds": [strength.variable.min, strength.variable.max],
                })).collect::<Vec<_>>(),
            })).collect::<Vec<_>>(),
            "invisible": self.invisible,
            "determined": self.identified,
            "additions": self.additions,
            "sources": self.sources,
            "pairs": self.pairs.iter().map(|pair| json!({
                "effects": pair.effects, "cosine": pair.cosine, "likeness": pair.likeness.name(),
            })).collect::<Vec<_>>(),
        })
    }
}
