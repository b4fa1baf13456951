//! Where a rover should go, and in which pose: chapter 3 and appendix A of Iagnemma's thesis (MIT, 2001).

pub mod force;
pub mod map;
pub mod pose;
pub mod robot;
pub mod stability;
