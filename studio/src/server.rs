//! The server from start to end.

use crate::api;
use crate::error::StudioError;
use crate::guard::Guard;
use crate::options::Options;
use crate::state;
use std::net::TcpListener;
use std::sync::Arc;

/// A server that listens and is not running yet.
pub struct Studio {
    listener: TcpListener,
    shared: state::Shared,
}

impl Studio {
    /// Listens, and opens the experiments.
    ///
    /// # Errors
    /// [`StudioError`] where the address is taken, or an experiment does not fit its model.
    pub fn start(options: Options) -> Result<Self, StudioError> {
        let Options { address, experiments, fmu, upload_limit, in_notebook } = options;
        let refused = |source| StudioError::Bind { address, source };
        let listener = TcpListener::bind(address).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let guard = Guard::new(listener.local_addr().map_err(refused)?, in_notebook).map_err(StudioError::Token)?;
        let shared = Arc::new(state::Studio::new(guard, fmu, upload_limit)?);
        for opened in experiments {
            shared.open(opened)?;
        }
        Ok(Self { listener, shared })
    }

    /// The address for a browser, with the token where one is asked for.
    #[must_use]
    pub fn url(&self) -> String {
        self.shared.guard.url()
    }

    /// Answers until `stop` says to end, which is asked a few times a second.
    ///
    /// # Errors
    /// [`StudioError::Server`].
    pub fn run(self, stop: impl Fn() -> bool + Send + 'static) -> Result<(), StudioError> {
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
        let Self { listener, shared } = self;
        let outcome = runtime.block_on(async move {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            let router = api::router(Arc::clone(&shared));
            let asked = async move {
                while !stop() {
                    tokio::time::sleep(std::time::Duration::from_millis(200)).await;
                }
            };
            // Streams of events never end by themselves: what is open is cut off.
            tokio::select! {
                served = async { axum::serve(listener, router).await } => served,
                () = asked => Ok(()),
            }
        });
        // Work in the background does not keep the program.
        runtime.shutdown_background();
        Ok(outcome?)
    }
}
