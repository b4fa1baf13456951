//! Values by reference: what every model of this crate has in common.

use bekker_modeldescription::xml::Description;

/// The answers of a [`FmuModel`](crate::model::Model) that has the fields `description`, `values` (by reference; that of time is not
/// used) and `time`, and is a [`Clone`] of its whole state.
macro_rules! by_reference {
    () => {
        fn description(&self) -> &Description {
            &self.description
        }

        fn get(&self, reference: usize) -> f64 {
            self.values[reference]
        }

        fn set(&mut self, reference: usize, value: f64) {
            self.values[reference] = value;
        }

        fn elapsed(&self) -> f64 {
            self.time
        }

        fn duplicate(&self) -> Box<dyn FmuModel> {
            Box::new(self.clone())
        }
    };
}
pub(super) use by_reference;

/// The values at which a model was loaded.
pub(super) fn starts(description: &Description) -> Vec<f64> {
    description.entries.iter().map(|entry| entry.start).collect()
}

/// Puts every value that it is called with into the next of `places`.
pub(super) fn into_places<'a>(places: &'a mut [f64]) -> impl FnMut(f64) + 'a {
    let mut places = places.iter_mut();
    move |value| places.next().into_iter().for_each(|place| *place = value)
}

/// Puts the next of `values` into every place that it is called with.
pub(super) fn from_values<'a>(values: &'a [f64]) -> impl FnMut(&mut f64) + 'a {
    let mut values = values.iter();
    move |place| values.next().into_iter().for_each(|value| *place = *value)
}
