//! What a studio is started with.

use bekker::diagnosis::Given;
use bekker::measurement::Experiment;
use bekker::model::Model;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};

/// Makes the FMU of a model, or says why it cannot.
pub type FmuPacker = fn(&Model) -> Result<Vec<u8>, String>;

/// An experiment that is open from the start.
#[derive(Clone, Debug)]
pub struct Opened {
    /// The experiment.
    pub experiment: Experiment,
    /// The model beside it.
    pub given: Given,
    /// Whether it is the shipped example, with which the page teaches its use.
    pub example: bool,
}

/// How to start.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where to listen; port 0 takes a free one. An address that is not of the loopback interface needs a token from every browser.
    pub address: SocketAddr,
    /// Experiments that are open from the start.
    pub experiments: Vec<Opened>,
    /// The packer of FMUs; without it the page offers none.
    pub fmu: Option<FmuPacker>,
    /// Largest sum of the bytes of one upload.
    pub upload_limit: usize,
    /// Whether pages of notebooks on this machine may show the page within theirs.
    pub in_notebook: bool,
}

/// Largest upload, unless said otherwise: a traverse of an hour at 100 Hz with 20 columns is half of it.
const UPLOAD_LIMIT: usize = 64 << 20;

/// The port, unless another is asked for.
const PORT: u16 = 8137;

impl Default for Options {
    fn default() -> Self {
        Self {
            address: SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), PORT),
            experiments: Vec::new(),
            fmu: None,
            upload_limit: UPLOAD_LIMIT,
            in_notebook: false,
        }
    }
}
