//! Threads that a batch owns.
//!
//! A pool that all of a program shares hangs in a process that is forked off, which has its memory but not its threads. So
//! these belong to one batch, and know the process in which they were started.

use super::shard::Shard;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

#[derive(Debug)]
pub struct Pool {
    size: usize,
    /// None before the first step.
    crew: Option<Crew>,
}

/// Workers of one process.
#[derive(Debug)]
struct Crew {
    process: u32,
    workers: Vec<Worker>,
}

#[derive(Debug)]
struct Worker {
    desk: Arc<Desk>,
    thread: JoinHandle<()>,
}

/// Where work is handed over.
#[derive(Debug, Default)]
struct Desk {
    task: Mutex<Task>,
    changed: Condvar,
}

#[derive(Debug, Default)]
enum Task {
    #[default]
    None,
    Given(Box<Shard>),
    Done(Box<Shard>),
    Over,
}

impl Pool {
    /// So many workers, started when they are first needed.
    pub fn new(size: usize) -> Self {
        Self { size, crew: None }
    }

    /// Steps all shards: the first by the calling thread, the others by a worker each, as far as the system gives threads.
    pub fn step(&mut self, shards: &mut Vec<Box<Shard>>) {
        if self.size == 0 {
            return shards.iter_mut().for_each(|shard| shard.step());
        }
        let crew = self.crew();
        let own = shards.len() - crew.workers.len();
        for (worker, shard) in crew.workers.iter().zip(shards.drain(own..)) {
            worker.desk.put(Task::Given(shard));
        }
        shards.iter_mut().for_each(|shard| shard.step());
        shards.extend(crew.workers.iter().map(|worker| worker.desk.result()));
    }

    /// The workers of this process. Those of the process that it was forked from are not there: what is left of them is
    /// forgotten, as to join or detach a thread that does not exist has no meaning.
    fn crew(&mut self) -> &Crew {
        let process = std::process::id();
        if self.crew.as_ref().is_some_and(|crew| crew.process != process) {
            std::mem::forget(self.crew.take());
        }
        let size = self.size;
        self.crew.get_or_insert_with(|| Crew { process, workers: (0..size).map_while(|_| Worker::start()).collect() })
    }
}

impl Worker {
    /// None where the system has no thread left.
    fn start() -> Option<Self> {
        let desk = Arc::new(Desk::default());
        let own = Arc::clone(&desk);
        let thread = std::thread::Builder::new().name("bekker-batch".to_owned()).spawn(move || own.serve()).ok()?;
        Some(Self { desk, thread })
    }
}

impl Desk {
    fn lock(&self) -> MutexGuard<'_, Task> {
        // Nothing that is done with the lock held can leave the task half written.
        self.task.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn put(&self, task: Task) {
        *self.lock() = task;
        self.changed.notify_all();
    }

    /// Waits for a task that `wanted` takes out.
    fn wait<T>(&self, wanted: impl Fn(Task) -> Result<T, Task>) -> T {
        let mut task = self.lock();
        loop {
            match wanted(std::mem::take(&mut *task)) {
                Ok(found) => return found,
                Err(other) => *task = other,
            }
            task = self.changed.wait(task).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn result(&self) -> Box<Shard> {
        self.wait(|task| if let Task::Done(shard) = task { Ok(shard) } else { Err(task) })
    }

    /// The worker's life.
    fn serve(&self) {
        let next = || {
            self.wait(|task| match task {
                Task::Given(shard) => Ok(Some(shard)),
                Task::Over => Ok(None),
                other => Err(other),
            })
        };
        while let Some(mut shard) = next() {
            shard.step();
            self.put(Task::Done(shard));
        }
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        let Some(Crew { process, workers }) = self.crew.take() else { return };
        if process != std::process::id() {
            return std::mem::forget(workers);
        }
        for worker in workers {
            worker.desk.put(Task::Over);
            // A worker catches its panics; there is nothing to learn from how it ended.
            drop(worker.thread.join());
        }
    }
}
