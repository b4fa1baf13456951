//! The workbench: a local server and its page, on which a diagnosis is done by looking.
//!
//! A [`Studio`] holds experiments ready in memory ([`bekker::diagnosis::Workbench`]) and answers a page in a browser: it runs the
//! model with the values that the page sends as numbers, calibrates, ranks the missing effects and plans experiments in the
//! background, and writes models and reports. Every number comes from the library calls that the command line makes.
//!
//! The parts: [`guard`](self) refuses requests that do not come from the page, `bench` holds one experiment with its steps, `work` runs
//! what takes long and tells of it as it comes, `upload` takes files in memory, `set` puts open experiments
//! together, `api` is what the page asks, `page` the page itself, which
//! the crate `bekker-page` holds.
//!
//! Safety: it listens on the loopback interface unless an address is given, and then asks for a token. Requests with a foreign `Host` or
//! `Origin` are refused. Uploaded files stay in memory and never become paths; nothing of them is executed.

mod api;
mod bench;
mod error;
mod export;
mod guard;
mod options;
mod page;
mod server;
mod set;
mod state;
mod trial;
mod upload;
mod work;

pub use error::StudioError;
pub use options::{FmuPacker, Opened, Options};
pub use server::Studio;
