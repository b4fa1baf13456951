//! What all requests share.

use crate::bench::Bench;
use crate::error::{Refusal, StudioError};
use crate::guard::Guard;
use crate::options::{FmuPacker, Opened};
use crate::upload::Uploads;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// Most experiments that are open at a time: each holds its measurements in memory.
const MOST_OPEN: usize = 32;

/// What all requests share.
pub struct Studio {
    pub guard: Guard,
    pub fmu: Option<FmuPacker>,
    pub uploads: Mutex<Uploads>,
    /// Threads for what a person waits for: work in the background has the others.
    pub quick: rayon::ThreadPool,
    benches: RwLock<Vec<Arc<Bench>>>,
}

/// See [`Studio`].
pub type Shared = Arc<Studio>;

impl Studio {
    pub fn new(guard: Guard, fmu: Option<FmuPacker>, upload_limit: usize) -> std::io::Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new().thread_name(|k| format!("quick {k}"));
        Ok(Self {
            guard,
            fmu,
            uploads: Mutex::new(Uploads::new(upload_limit)),
            quick: pool.build().map_err(std::io::Error::other)?,
            benches: RwLock::default(),
        })
    }

    /// Opens an experiment under an id of its own.
    pub fn open(&self, opened: Opened) -> Result<Arc<Bench>, StudioError> {
        let name = opened.experiment.name.clone();
        let failed = |source| StudioError::Experiment { name, source: Box::new(source) };
        let bench = Bench::open(self.free_id(&opened.experiment.name), opened).map_err(failed)?;
        let bench = Arc::new(bench);
        let mut benches = self.benches.write().unwrap_or_else(PoisonError::into_inner);
        // Two tabs may have opened one at the same time.
        let taken = |id: &str| benches.iter().any(|other| other.id == id);
        if taken(&bench.id) || benches.len() >= MOST_OPEN {
            benches.retain(|other| other.id != bench.id);
            if benches.len() >= MOST_OPEN {
                benches.remove(0);
            }
        }
        benches.push(Arc::clone(&bench));
        Ok(bench)
    }

    /// A short name for an address: letters and digits of the experiment's own.
    fn free_id(&self, name: &str) -> String {
        let plain: String =
            name.to_lowercase().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { ' ' }).collect();
        let plain = plain.split_whitespace().take(6).collect::<Vec<_>>().join("-");
        let plain = if plain.is_empty() { "experiment".to_owned() } else { plain };
        let numbered = |k: usize| if k == 1 { plain.clone() } else { format!("{plain}-{k}") };
        let benches = self.benches();
        let free = (1..).map(numbered).find(|id| !benches.iter().any(|bench| bench.id == *id));
        free.unwrap_or(plain)
    }

    /// All open experiments, in the order in which they were opened.
    pub fn benches(&self) -> Vec<Arc<Bench>> {
        self.benches.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The experiment called `id`.
    pub fn bench(&self, id: &str) -> Result<Arc<Bench>, Refusal> {
        let found = self.benches().into_iter().find(|bench| bench.id == id);
        found.ok_or_else(|| Refusal::missing(&format!("open experiment `{id}`")))
    }
}
