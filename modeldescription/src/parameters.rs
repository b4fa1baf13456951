//! The visit from which names, bounds, defaults, documents and calibration vectors follow.

use crate::Variable;
use std::fmt;

/// A group of named quantities of scalar type `S`.
pub trait Parameters<S> {
    /// Calls `f` with the description and the place of every quantity, in a fixed order; names are
    /// prefixed with `prefix` and a dot unless it is empty.
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S));

    /// Calls `f` with every value in the order of [`visit`](Parameters::visit), without building
    /// descriptions (no allocation).
    fn values(&self, f: &mut dyn FnMut(S));

    /// Calls `f` with the place of every value in the order of [`visit`](Parameters::visit); groups of
    /// [`parameters!`](crate::parameters) do so without building descriptions.
    fn places(&mut self, f: &mut dyn FnMut(&mut S)) {
        self.visit("", &mut |_, place| f(place));
    }
}

/// A group of numbers that exists over any scalar.
pub trait Over<S, T> {
    /// The same group over `T`.
    type Output;

    /// The group with `f` of every number.
    #[must_use]
    fn over(&self, f: &dyn Fn(S) -> T) -> Self::Output;

    /// Replaces every number by `f` of it and of the one in its place in `other`.
    fn merge(&mut self, other: &Self::Output, f: &dyn Fn(S, T) -> S);
}

/// Why a parameter could not be read or set.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterError {
    /// No parameter has this name; the nearest known names follow.
    Unknown {
        /// The name asked for.
        name: String,
        /// Known names that look alike.
        suggestions: Vec<String>,
    },
    /// The value is outside the allowed range, or not finite.
    OutOfRange {
        /// The parameter's full name.
        name: String,
        /// The value that was refused.
        value: f64,
        /// The allowed range with its unit.
        range: String,
    },
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { name, suggestions } if suggestions.is_empty() => write!(f, "unknown parameter `{name}`"),
            Self::Unknown { name, suggestions } => {
                write!(f, "unknown parameter `{name}`; did you mean {}?", suggestions.join(", "))
            }
            Self::OutOfRange { name, value, range } => {
                write!(f, "parameter `{name}` = {value} is outside its allowed range {range}")
            }
        }
    }
}

impl std::error::Error for ParameterError {}

/// Reading and setting by name; follows from [`Parameters`].
pub trait Lookup: Parameters<f64> {
    /// Descriptions of all quantities, in order, with their present values.
    fn list(&mut self) -> Vec<(Variable, f64)> {
        let mut all = Vec::new();
        self.visit("", &mut |variable, value| all.push((variable, *value)));
        all
    }

    /// Value of the quantity called `name`.
    ///
    /// # Errors
    /// [`ParameterError::Unknown`] with names that look alike.
    fn get(&mut self, name: &str) -> Result<f64, ParameterError> {
        let mut found = None;
        self.visit("", &mut |variable, value| {
            if variable.name == name {
                found = Some(*value);
            }
        });
        found.ok_or_else(|| self.unknown(name))
    }

    /// Sets the quantity called `name`.
    ///
    /// # Errors
    /// [`ParameterError::Unknown`], or [`ParameterError::OutOfRange`] where the value is not finite or
    /// outside the bounds; nothing is changed then.
    fn set(&mut self, name: &str, value: f64) -> Result<(), ParameterError> {
        let mut outcome = None;
        self.visit("", &mut |variable, place| {
            if variable.name == name {
                outcome = Some(if variable.allows(value) {
                    *place = value;
                    Ok(())
                } else {
                    Err(ParameterError::OutOfRange { range: variable.range(), name: variable.name, value })
                });
            }
        });
        outcome.unwrap_or_else(|| Err(self.unknown(name)))
    }

    /// Checks every value against its bounds.
    ///
    /// # Errors
    /// [`ParameterError::OutOfRange`] for the first value that is not allowed.
    fn check(&mut self) -> Result<(), ParameterError> {
        let mut outcome = Ok(());
        self.visit("", &mut |variable, value| {
            if outcome.is_ok() && !variable.allows(*value) {
                let range = variable.range();
                outcome = Err(ParameterError::OutOfRange { name: variable.name, value: *value, range });
            }
        });
        outcome
    }

    /// The error for a name that does not exist, with the nearest names.
    fn unknown(&mut self, name: &str) -> ParameterError {
        let mut known = Vec::new();
        self.visit("", &mut |variable, _| known.push(variable.name));
        ParameterError::Unknown { name: name.to_owned(), suggestions: nearest(name, known) }
    }
}

impl<P: Parameters<f64> + ?Sized> Lookup for P {}

/// Up to three of the known names that look like `name`, the most alike first.
#[must_use]
pub fn nearest(name: &str, known: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut near: Vec<(usize, String)> =
        known.into_iter().map(|other| (strsim::levenshtein(name, &other), other)).collect();
    near.sort();
    near.into_iter().filter(|(d, n)| *d <= 2 + n.len() / 4).take(3).map(|(_, n)| n).collect()
}

/// Joins a prefix and a field name.
#[doc(hidden)]
#[must_use]
pub fn join(prefix: &str, field: &str) -> String {
    if prefix.is_empty() { field.to_owned() } else { format!("{prefix}.{field}") }
}

/// Declares a group of parameters or signals, generic over the scalar, from one table. Traits of `#[derive(..)]` are derived
/// beside `Clone`, `Copy`, `Debug` and `PartialEq`.
///
/// ```
/// use bekker_modeldescription::{parameters, Lookup, Unit};
/// parameters! {
///     /// A spring.
///     pub struct Spring {
///         /// Stiffness.
///         stiffness: [Unit::NEWTON_PER_METRE] = 100.0, 0.0..=1e6, Calibrated, "catalogue";
///     }
/// }
/// let mut spring = Spring::default();
/// spring.set("stiffness", 250.0).unwrap();
/// assert_eq!(spring.stiffness, 250.0);
/// assert!(spring.set("stiffness", -1.0).is_err());
/// ```
#[macro_export]
macro_rules! parameters {
    (
        $(#[doc = $about:literal])+
        $(#[derive($($derived:ident),+ $(,)?)])?
        $vis:vis struct $group:ident {
            $(
                $(#[doc = $doc:literal])+
                $field:ident: [$unit:expr] = $default:expr, $bounds:expr, $role:ident, $source:literal;
            )*
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug, PartialEq $($(, $derived)+)?)]
        $vis struct $group<S = f64> {
            $($(#[doc = $doc])+ pub $field: S,)*
        }

        impl<S: From<f64>> Default for $group<S> {
            fn default() -> Self {
                Self { $($field: S::from($default),)* }
            }
        }

        impl<S: Copy> $group<S> {
            /// The same group over another scalar.
            #[must_use]
            #[allow(dead_code)]
            pub fn map<T>(&self, f: &dyn Fn(S) -> T) -> $group<T> {
                let _ = f;
                $group { $($field: f(self.$field),)* }
            }
        }

        impl<S: Copy, T: Copy> $crate::Over<S, T> for $group<S> {
            type Output = $group<T>;

            fn over(&self, f: &dyn Fn(S) -> T) -> $group<T> {
                self.map(f)
            }

            fn merge(&mut self, other: &$group<T>, f: &dyn Fn(S, T) -> S) {
                let _ = (other, &f);
                $(self.$field = f(self.$field, other.$field);)*
            }
        }

        impl<S: Copy> $crate::Parameters<S> for $group<S> {
            fn visit(&mut self, prefix: &str, f: &mut dyn FnMut($crate::Variable, &mut S)) {
                let _ = (prefix, &f);
                $({
                    let bounds: std::ops::RangeInclusive<f64> = $bounds;
                    let variable = $crate::Variable {
                        name: $crate::join(prefix, stringify!($field)),
                        doc: std::borrow::Cow::Borrowed(concat!($($doc),+).trim_start()),
                        unit: $unit,
                        default: $default,
                        min: *bounds.start(),
                        max: *bounds.end(),
                        role: $crate::Role::$role,
                        source: std::borrow::Cow::Borrowed($source),
                    };
                    f(variable, &mut self.$field);
                })*
            }

            fn values(&self, f: &mut dyn FnMut(S)) {
                let _ = &f;
                $(f(self.$field);)*
            }

            fn places(&mut self, f: &mut dyn FnMut(&mut S)) {
                let _ = &f;
                $(f(&mut self.$field);)*
            }
        }
    };
}
