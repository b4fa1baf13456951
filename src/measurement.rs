//! Experiment folders and records.
