//! Where a rover should go, and in which pose: chapter 3 and appendix A of Iagnemma's thesis (MIT, 2001).
//!
//! | module | what it holds | in the thesis |
//! |---|---|---|
//! | [`map`] | heights on a grid, the surface between them, files, doubts, the sensor's error | 3.2.3, (3.13)-(3.15), (3.18) |
//! | [`robot`] | robots as trees of links; the rocker-bogie, the Sample Return Rover | 3.4, figure A.1 |
//! | [`pose`] | the pose on the ground at a place and heading | (A.1)-(A.6), (3.12) |
//! | [`force`] | forces that hold and drive the robot, as a convex programme; the size of their space | (A.7)-(A.13) |
//! | [`stability`] | the margin against tipping over | (3.6)-(3.11), (3.21)-(3.22) |
//! | [`plan`] | search on the performance index, model-based evaluation, and again | (3.1)-(3.5), (3.16)-(3.19) |
//! | [`incremental`] | replanning where the map changes, D* Lite | suggested in 5.2 |
//! | [`anisotropic`] | costs by direction of travel from the core's wheel on its soil, any-angle paths | beyond the thesis |
//! | [`reconfigure`] | active joints put where the robot stands safest | 3.4, (3.23)-(3.24) |
//! | [`traction`] | the same for the largest thrust | suggested in 5.2 |
//! | [`drive`] | a path driven by half of the robot as the core's planar rover | |
//! | [`slip`] | slip that a slope needs, with the band of what is not known of the soil | beyond the thesis |
//! | [`alternatives`] | other paths to the same goal, judged as the plan is | 3.3 |
//! | [`trial`] | the comparison with a binary planner | 3.3, table 3.1 |
//! | [`site`], [`answer`], [`page`] | all of it in one value, answers and a page as every door gives them | |
//!
//! A module uses those above it. The soil under the wheels and its strength come from the core, `bekker`, which knows nothing of
//! this crate.
//!
//! ```
//! use bekker_planning::plan::Request;
//! use bekker_planning::site::{Site, Source};
//!
//! let site = Site::open(&Source::new("benign:1", "fsrl"))?;
//! let request = Request { start: [2.0, 2.0], heading: None, goal: [3.0, 3.0], most_evaluations: 5000 };
//! let plan = site.plan(&request)?;
//! assert!(plan.length >= 2.0_f64.sqrt() - 0.1);
//! # Ok::<(), bekker_planning::site::SiteError>(())
//! ```

pub mod alternatives;
pub mod anisotropic;
pub mod answer;
pub mod drive;
pub mod force;
pub mod incremental;
pub mod map;
pub mod page;
pub mod plan;
pub mod pose;
pub mod reconfigure;
pub mod robot;
pub mod site;
pub mod slip;
pub mod stability;
pub mod traction;
pub mod trial;
