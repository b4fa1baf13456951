//! What is known of a soil from experiments: values with their covariance, kept in a file and drawn from.
//!
//! ```toml
//! name = "plates on dense sand"
//! contact_widths = [0.025, 0.05]     # widths of contact, m, at which it was found
//!
//! [[parameter]]
//! name = "soil.k_phi"
//! value = 5.2e6
//! unit = "N/m^(n+2)"
//! scale = "logarithm"                # of what the covariance is: the parameter (linear) or its natural logarithm
//! sd = 3.1e5                         # for readers: the root of the diagonal, in the parameter's unit
//! at_bound = false                   # whether the fit wanted to go further than is believable
//! covariance = [0.0036, -0.0011]     # with each parameter, in the order of the file
//! ```
//!
//! The covariance is that of all parameters together. It is a Gauss-Newton one: the inverse of what the measurements and the
//! priors tell, enlarged where they scatter more than their noise, with what nothing determines spread over its bounds. A
//! parameter on a bound has its full width there too, as if the bound were not active: the truth may lie inside.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Of what a covariance is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// The parameter.
    Linear,
    /// Its natural logarithm.
    Logarithm,
}

impl Scale {
    /// The coordinate of a value.
    #[must_use]
    pub fn coordinate(self, value: f64) -> f64 {
        if self == Self::Linear { value } else { value.ln() }
    }

    /// The value at a coordinate.
    #[must_use]
    pub fn value(self, coordinate: f64) -> f64 {
        if self == Self::Linear { coordinate } else { coordinate.exp() }
    }

    /// Derivative of the coordinate in the value.
    #[must_use]
    pub fn slope(self, value: f64) -> f64 {
        if self == Self::Linear { 1.0 } else { value.recip() }
    }
}

/// One parameter of a known soil.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownParameter {
    /// The model's name.
    pub name: String,
    /// SI value.
    pub value: f64,
    /// Symbol of its SI unit.
    pub unit: String,
    /// Of what the covariance is.
    pub scale: Scale,
    /// Standard deviation in the parameter's unit.
    pub sd: f64,
    /// Whether the value sits on a bound of the fit.
    pub at_bound: bool,
    /// Covariance with each parameter, in their order.
    pub covariance: Vec<f64>,
}

/// Values of a soil with their covariance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownSoil {
    /// What it was found from, for people.
    pub name: String,
    /// Widths of contact, m, at which it was found, rising.
    #[serde(default)]
    pub contact_widths: Vec<f64>,
    /// The parameters.
    #[serde(rename = "parameter")]
    pub parameters: Vec<KnownParameter>,
}

/// Why a file is no known soil.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KnownSoilError {
    /// The file cannot be read or written.
    #[error("cannot open `{file}`: {message}")]
    File {
        /// The file.
        file: String,
        /// What the system says.
        message: String,
    },
    /// The text has not this form.
    #[error("no known soil (a file that `bekker calibrate --save-soil` writes): {0}")]
    Form(String),
}

/// Relative size of a negative eigenvalue, or an asymmetry, that is rounding of a written number.
const ROUNDING: f64 = 1e-9;

impl KnownSoil {
    /// Reads the text of a file.
    ///
    /// # Errors
    /// [`KnownSoilError::Form`] says what is wrong.
    pub fn from_toml(text: &str) -> Result<Self, KnownSoilError> {
        let soil: Self = toml::from_str(text).map_err(|error| KnownSoilError::Form(error.message().to_owned()))?;
        soil.check().map_err(KnownSoilError::Form)?;
        Ok(soil)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`KnownSoilError`].
    pub fn read(path: &Path) -> Result<Self, KnownSoilError> {
        let failed = |error: std::io::Error| KnownSoilError::File {
            file: path.display().to_string(),
            message: error.to_string(),
        };
        let soil = Self::from_toml(&std::fs::read_to_string(path).map_err(failed)?);
        soil.map_err(|error| match error {
            KnownSoilError::Form(message) => KnownSoilError::Form(format!("in `{}`: {message}", path.display())),
            other => other,
        })
    }

    /// The text of a file; numbers keep their bits.
    ///
    /// # Errors
    /// [`KnownSoilError::Form`] where a number has no form in TOML.
    pub fn to_toml(&self) -> Result<String, KnownSoilError> {
        toml::to_string(self).map_err(|error| KnownSoilError::Form(error.to_string()))
    }

    fn check(&self) -> Result<(), String> {
        let count = self.parameters.len();
        if count == 0 {
            return Err("it has no [[parameter]]".to_owned());
        }
        for (k, parameter) in self.parameters.iter().enumerate() {
            let name = &parameter.name;
            if !name.starts_with("soil.") {
                return Err(format!("`{name}` is no parameter of a soil: expected `soil.` and its name"));
            }
            if self.parameters[..k].iter().any(|other| other.name == *name) {
                return Err(format!("`{name}` is there twice"));
            }
            if parameter.covariance.len() != count {
                let found = parameter.covariance.len();
                return Err(format!(
                    "`{name}` has {found} numbers under `covariance`, expected {count}: one a parameter"
                ));
            }
            let finite = parameter.value.is_finite() && parameter.covariance.iter().all(|c| c.is_finite());
            if !finite || (parameter.scale == Scale::Logarithm && parameter.value <= 0.0) {
                return Err(format!(
                    "`{name}` = {}: expected finite numbers, above 0 for a logarithm",
                    parameter.value
                ));
            }
        }
        let covariance = self.covariance();
        let size = covariance.diagonal();
        for i in 0..count {
            for j in 0..i {
                let allowed = ROUNDING * (size[i] * size[j]).abs().sqrt();
                if (covariance[(i, j)] - covariance[(j, i)]).abs() > allowed {
                    let (a, b) = (&self.parameters[i].name, &self.parameters[j].name);
                    return Err(format!("the covariance of `{a}` with `{b}` is not that of `{b}` with `{a}`"));
                }
            }
        }
        if covariance.cholesky().is_none() {
            return Err("the covariance is none: its eigenvalues are not all positive".to_owned());
        }
        Ok(())
    }

    /// The covariance matrix, in the coordinates of the parameters' scales.
    #[must_use]
    pub fn covariance(&self) -> DMatrix<f64> {
        let count = self.parameters.len();
        DMatrix::from_fn(count, count, |i, j| self.parameters[i].covariance[j])
    }

    /// What is left of it without some parameters: what they say of the others is lost.
    #[must_use]
    pub fn without(&self, dropped: impl Fn(&str) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.parameters.len()).filter(|k| !dropped(&self.parameters[*k].name)).collect();
        let of = |k: &usize| KnownParameter {
            covariance: kept.iter().map(|j| self.parameters[*k].covariance[*j]).collect(),
            ..self.parameters[*k].clone()
        };
        Self { parameters: kept.iter().map(of).collect(), ..self.clone() }
    }

    /// What it says of the others where some parameters are known, by name and value; how far these values are from what it says of
    /// them, in its own standard deviations.
    #[must_use]
    pub fn given(&self, known: &[(String, f64)]) -> (Self, Vec<f64>) {
        let place = |name: &str| self.parameters.iter().position(|parameter| parameter.name == name);
        let known: Vec<(usize, f64)> = known.iter().filter_map(|(name, value)| Some((place(name)?, *value))).collect();
        let covariance = self.covariance();
        let off = |(k, value): &(usize, f64)| {
            let parameter = &self.parameters[*k];
            parameter.scale.coordinate(*value) - parameter.scale.coordinate(parameter.value)
        };
        let shifts = known.iter().map(|at| off(at) / covariance[(at.0, at.0)].sqrt()).collect();
        let open: Vec<usize> =
            (0..self.parameters.len()).filter(|k| known.iter().all(|(other, _)| other != k)).collect();
        let fixed: Vec<usize> = known.iter().map(|(k, _)| *k).collect();
        let part = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, j| covariance[(rows[i], columns[j])])
        };
        let Some(inverse) = part(&fixed, &fixed).try_inverse() else { return (self.clone(), shifts) };
        let gain = part(&open, &fixed) * inverse;
        let moved = &gain * DVector::from_iterator(known.len(), known.iter().map(off));
        let left = part(&open, &open) - &gain * part(&fixed, &open);
        let parameters = open.iter().enumerate().map(|(row, k)| {
            let parameter = &self.parameters[*k];
            let value = parameter.scale.value(parameter.scale.coordinate(parameter.value) + moved[row]);
            KnownParameter {
                value,
                sd: left[(row, row)].max(0.0).sqrt() / parameter.scale.slope(value),
                covariance: (0..open.len()).map(|j| 0.5 * (left[(row, j)] + left[(j, row)])).collect(),
                ..parameter.clone()
            }
        });
        (Self { parameters: parameters.collect(), ..self.clone() }, shifts)
    }

    /// Values for standard normal numbers, one a parameter: values of all parameters that hang together as the covariance says.
    /// `None` where the covariance is none.
    #[must_use]
    pub fn drawn(&self, normal: &[f64]) -> Option<Vec<(String, f64)>> {
        let root = self.covariance().cholesky()?.unpack();
        let moved = root * DVector::from_column_slice(normal.get(..self.parameters.len())?);
        let of = |(k, parameter): (usize, &KnownParameter)| {
            let at = parameter.scale.coordinate(parameter.value) + moved[k];
            (parameter.name.clone(), parameter.scale.value(at))
        };
        Some(self.parameters.iter().enumerate().map(of).collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

    use super::*;

    /// Rounding of a few products.
    const ROUNDING: f64 = 1e-12;

    /// Two parameters that hang together, one of them by its logarithm.
    fn soil() -> KnownSoil {
        let parameter = |name: &str, value: f64, scale: Scale, sd: f64, covariance: [f64; 2]| KnownParameter {
            name: name.to_owned(),
            value,
            unit: "1".to_owned(),
            scale,
            sd,
            at_bound: false,
            covariance: covariance.to_vec(),
        };
        KnownSoil {
            name: "two".to_owned(),
            contact_widths: vec![0.05],
            parameters: vec![
                parameter("soil.k_phi", 2e6, Scale::Logarithm, 0.3 * 2e6, [0.09, 0.024]),
                parameter("soil.exponent", 1.1, Scale::Linear, 0.1, [0.024, 0.01]),
            ],
        }
    }

    #[test]
    fn property_a_file_keeps_all_bits() {
        let soil = soil();
        assert_eq!(KnownSoil::from_toml(&soil.to_toml().unwrap()).unwrap(), soil);
    }

    #[test]
    fn property_a_file_that_is_no_soil_is_refused_in_words() {
        let text = soil().to_toml().unwrap();
        for (changed, words) in [
            (text.replace("soil.exponent", "wheel.radius"), "no parameter of a soil"),
            (text.replace("soil.exponent", "soil.k_phi"), "twice"),
            (text.replace("[0.024, 0.01]", "[0.024]"), "expected 2"),
            (text.replace("[0.024, 0.01]", "[0.02, 0.01]"), "is not that of"),
            (text.replace("0.024", "0.05"), "eigenvalues"),
            ("name = \"empty\"\nparameter = []".to_owned(), "no [[parameter]]"),
            (text.replace("2000000.0", "-1.0"), "above 0"),
        ] {
            let error = KnownSoil::from_toml(&changed).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn analytic_what_is_known_moves_the_others_as_in_a_normal_distribution() {
        // x given y: mean m_x + s_xy/s_yy (y - m_y), variance s_xx - s_xy^2/s_yy.
        let (left, shifts) = soil().given(&[("soil.exponent".to_owned(), 1.25)]);
        assert!((shifts[0] - 1.5).abs() < ROUNDING);
        let only = &left.parameters[0];
        assert!((only.value.ln() - (2e6_f64.ln() + 2.4 * 0.15)).abs() < ROUNDING);
        assert!((only.covariance[0] - (0.09 - 0.024 * 2.4)).abs() < ROUNDING);
        assert!((only.sd / only.value - only.covariance[0].sqrt()).abs() < ROUNDING);
        let marginal = soil().without(|name| name == "soil.exponent");
        assert_eq!(marginal.parameters[0].covariance, [0.09]);
    }

    #[test]
    fn analytic_draws_have_the_covariance() {
        let at = |normal: [f64; 2]| {
            let drawn = soil().drawn(&normal).unwrap();
            [drawn[0].1.ln() - 2e6_f64.ln(), drawn[1].1 - 1.1]
        };
        // Columns of a root R of the covariance: R R^T gives it back.
        let (a, b) = (at([1.0, 0.0]), at([0.0, 1.0]));
        for (i, j, expected) in [(0, 0, 0.09), (0, 1, 0.024), (1, 1, 0.01)] {
            assert!((a[i] * a[j] + b[i] * b[j] - expected).abs() < 1e-9, "{i} {j}");
        }
    }
}
