//! Worker threads of one batch.
//!
//! A batch has its own threads, since a pool that the whole process shares blocks for ever in a forked process: a fork copies
//! the memory and not the threads. The pool therefore records the process in which its threads were started, and starts new
//! ones where it finds itself in another process.

use super::shard::Shard;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

#[derive(Debug)]
pub struct Pool {
    size: usize,
    /// None before the first step.
    started: Option<Started>,
}

/// Worker threads, and the process in which they were started.
#[derive(Debug)]
struct Started {
    process: u32,
    workers: Vec<Worker>,
}

#[derive(Debug)]
struct Worker {
    mailbox: Arc<Mailbox>,
    thread: JoinHandle<()>,
}

/// Holds the one task that passes between the calling thread and a worker.
#[derive(Debug, Default)]
struct Mailbox {
    task: Mutex<Task>,
    changed: Condvar,
}

/// Boxed shards, so that a pointer is moved between threads and not a shard of many kilobytes.
#[derive(Debug, Default)]
enum Task {
    #[default]
    None,
    /// To be stepped by the worker.
    Given(Box<Shard>),
    /// Stepped, to be taken back by the calling thread.
    Done(Box<Shard>),
    /// The worker ends.
    Over,
}

impl Pool {
    /// A pool of `size` workers, started when they are first needed.
    pub fn new(size: usize) -> Self {
        Self { size, started: None }
    }

    /// Steps all shards: the last ones by one worker each, as far as the system gives threads, the others by the calling
    /// thread.
    #[allow(clippy::vec_box, reason = "shards move between threads as pointers")]
    pub fn step(&mut self, shards: &mut Vec<Box<Shard>>) {
        if self.size == 0 {
            return shards.iter_mut().for_each(|shard| shard.step());
        }
        let workers = self.workers();
        let own = shards.len() - workers.len();
        for (worker, shard) in workers.iter().zip(shards.drain(own..)) {
            worker.mailbox.put(Task::Given(shard));
        }
        shards.iter_mut().for_each(|shard| shard.step());
        shards.extend(workers.iter().map(|worker| worker.mailbox.result()));
    }

    /// The workers of this process, started if there are none. Handles of threads that belong to the process from which this
    /// one was forked are leaked: those threads do not exist here and can be neither joined nor detached.
    fn workers(&mut self) -> &[Worker] {
        let process = std::process::id();
        if self.started.as_ref().is_some_and(|started| started.process != process) {
            std::mem::forget(self.started.take());
        }
        let start = || Started { process, workers: (0..self.size).map_while(|_| Worker::start()).collect() };
        &self.started.get_or_insert_with(start).workers
    }
}

impl Worker {
    /// None where the system has no thread left.
    fn start() -> Option<Self> {
        let mailbox = Arc::new(Mailbox::default());
        let own = Arc::clone(&mailbox);
        let thread = std::thread::Builder::new().name("bekker-batch".to_owned()).spawn(move || own.serve()).ok()?;
        Some(Self { mailbox, thread })
    }
}

impl Mailbox {
    fn lock(&self) -> MutexGuard<'_, Task> {
        // A poisoned lock is safe to use: no operation under the lock leaves the task partly written.
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

    /// Steps the shards that are put in, until the task is [`Task::Over`].
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
        let Some(Started { process, workers }) = self.started.take() else { return };
        if process != std::process::id() {
            return std::mem::forget(workers);
        }
        for worker in workers {
            worker.mailbox.put(Task::Over);
            // A worker catches its panics; there is nothing to learn from how it ended.
            drop(worker.thread.join());
        }
    }
}
