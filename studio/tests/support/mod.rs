//! A workbench on a free port, and a browser that speaks just enough HTTP.

#![allow(dead_code, clippy::unwrap_used, reason = "a test may fail by panicking; not every test uses all of this")]

use bekker::diagnosis::Given;
use bekker::measurement::Experiment;
use bekker_studio::{Opened, Options, Studio};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Long enough for a calibration in a debug build on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Where the shipped example is opened.
pub const EXAMPLE: &str = "/api/experiments/a-wheel-on-dry-sand";

/// A running workbench; it ends with this value.
pub struct Running {
    pub url: String,
    pub port: u16,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// The shipped experiment.
pub fn sand() -> Experiment {
    Experiment::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/sand_wheel")).expect("the shipped example")
}

/// Starts with the shipped example.
pub fn started(address: &str) -> Running {
    started_with(address, sand())
}

/// Starts with an experiment.
pub fn started_with(address: &str, experiment: Experiment) -> Running {
    started_with_all(address, vec![(experiment, Given::default())])
}

/// Starts with several, each by itself.
pub fn started_with_all(address: &str, experiments: Vec<(Experiment, Given)>) -> Running {
    let opened = |(experiment, given)| Opened { experiment, given, example: true };
    let experiments = experiments.into_iter().map(opened).collect();
    let address: SocketAddr = address.parse().expect("an address");
    let options = Options { address, experiments, upload_limit: 1 << 20, ..Options::default() };
    let studio = Studio::start(options).expect("a free port");
    let url = studio.url();
    let port = url.split(':').nth(2).and_then(|rest| rest.split('/').next()).and_then(|port| port.parse().ok());
    let stop = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&stop);
    let thread = std::thread::spawn(move || studio.run(move || asked.load(Ordering::Relaxed)).expect("a clean end"));
    Running { url, port: port.expect("a port"), stop, thread: Some(thread) }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// The sentence of a refusal.
    pub fn error(&self) -> String {
        self.json()["error"].as_str().expect("a sentence").to_owned()
    }
}

impl Running {
    /// Sends a request with these header lines beside `Host`, unless they hold one.
    pub fn ask(&self, method: &str, path: &str, headers: &str, body: &[u8]) -> Answer {
        let mut stream = self.send(method, path, headers, body);
        let mut all = Vec::new();
        stream.read_to_end(&mut all).expect("an answer");
        let end = all.windows(4).position(|four| four == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8_lossy(&all[..end]).into_owned();
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        Answer { status, head, body: all[end + 4..].to_vec() }
    }

    fn send(&self, method: &str, path: &str, headers: &str, body: &[u8]) -> TcpStream {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a time");
        let host = if headers.to_lowercase().contains("host:") {
            String::new()
        } else {
            format!("Host: 127.0.0.1:{}\r\n", self.port)
        };
        let length = body.len();
        let head = format!("{method} {path} HTTP/1.0\r\n{host}{headers}Content-Length: {length}\r\n\r\n");
        stream.write_all(head.as_bytes()).expect("the head is sent");
        // A server that refuses a large body closes before all of it has been sent.
        let _ = stream.write_all(body);
        stream
    }

    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, "", b"")
    }

    pub fn post(&self, path: &str, body: &Value) -> Answer {
        self.ask("POST", path, "", body.to_string().as_bytes())
    }

    /// The events of the example until one that `wanted` likes, which is returned.
    pub fn event(&self, wanted: impl Fn(&str, &Value) -> bool) -> Value {
        let lines = BufReader::new(self.send("GET", &format!("{EXAMPLE}/events"), "", b"")).lines();
        let mut name = String::new();
        for line in lines {
            let line = line.expect("an event");
            if let Some(text) = line.strip_prefix("event: ") {
                text.clone_into(&mut name);
            } else if let Some(text) = line.strip_prefix("data: ") {
                let data = serde_json::from_str(text).expect("JSON");
                if wanted(&name, &data) {
                    return data;
                }
            }
        }
        panic!("the stream has ended")
    }
}
