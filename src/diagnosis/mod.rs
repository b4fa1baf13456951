//! Comparing the model with measurements.
