//! What the page asks, and the page itself.

use crate::bench::Step;
use crate::error::Refusal;
use crate::guard::guarded;
use crate::options::Opened;
use crate::state::Shared;
use crate::work::{self, Event, Kind, Order};
use crate::{export, page, set, trial, upload};
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, Path, Query, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::sse::{self, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{delete, get, post, put};
use axum::{Json, Router, middleware};
use bekker::measurement::{self, Meaning};
use futures_util::stream::{self, Stream};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::{Arc, MutexGuard, PoisonError};
use tokio::sync::broadcast::error::RecvError;

type Answer = Result<Json<Value>, Refusal>;

/// Largest body of a request that is no file, bytes.
const LARGEST_REQUEST: usize = 1 << 20;

/// Everything that is answered.
pub fn router(shared: Shared) -> Router {
    let file_limit = lock(&shared).limit();
    let files = put(put_file).layer(DefaultBodyLimit::max(file_limit));
    Router::new()
        .route("/", get(page::index))
        .route("/page.js", get(page::script))
        .route("/page.css", get(page::style))
        .route("/api/experiments", get(list))
        .route("/api/experiments/{id}", get(experiment))
        .route("/api/experiments/{id}/trial", post(trial))
        .route("/api/experiments/{id}/jobs", post(begin))
        .route("/api/experiments/{id}/jobs/{kind}", delete(stop))
        .route("/api/experiments/{id}/events", get(events))
        .route("/api/experiments/{id}/steps", get(steps).post(accept))
        .route("/api/experiments/{id}/export", post(export))
        .route("/api/sets", post(open_set))
        .route("/api/uploads", post(new_upload))
        .route("/api/uploads/{number}/files", files)
        .route("/api/uploads/{number}/proposal", post(propose))
        .route("/api/uploads/{number}/open", post(open_upload))
        .fallback(async || Refusal::missing("such page"))
        .layer(DefaultBodyLimit::max(LARGEST_REQUEST))
        .layer(middleware::from_fn_with_state(Arc::clone(&shared), guarded))
        .with_state(shared)
}

fn lock(shared: &Shared) -> MutexGuard<'_, upload::Uploads> {
    shared.uploads.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A request as JSON, with an error that says what was expected.
fn read<T: DeserializeOwned>(body: &Bytes) -> Result<T, Refusal> {
    let body = if body.is_empty() { b"{}" } else { &body[..] };
    serde_json::from_slice(body).map_err(|error| Refusal::bad(format!("the request: {error}")))
}

/// Work on threads that a person waits for.
async fn quickly<T: Send + 'static>(
    shared: &Shared,
    work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let shared = Arc::clone(shared);
    let done = tokio::task::spawn_blocking(move || shared.quick.install(work)).await;
    done.unwrap_or_else(|_| {
        Err(Refusal::of(StatusCode::INTERNAL_SERVER_ERROR, "the computation failed: this is a fault of the program"))
    })
}

async fn list(State(shared): State<Shared>) -> Json<Value> {
    let all: Vec<Value> = shared.benches().iter().map(|bench| bench.listed()).collect();
    Json(json!({ "experiments": all, "version": env!("CARGO_PKG_VERSION"), "fmu": shared.fmu.is_some() }))
}

async fn experiment(State(shared): State<Shared>, Path(id): Path<String>) -> Answer {
    let bench = shared.bench(&id)?;
    quickly(&shared, move || Ok(Json(bench.shown()))).await
}

async fn trial(State(shared): State<Shared>, Path(id): Path<String>, body: Bytes) -> Answer {
    let bench = shared.bench(&id)?;
    let asked: trial::Asked = read(&body)?;
    quickly(&shared, move || Ok(Json(trial::trial(&bench, &asked)?))).await
}

async fn begin(State(shared): State<Shared>, Path(id): Path<String>, body: Bytes) -> Answer {
    let bench = shared.bench(&id)?;
    let order: Order = read(&body)?;
    if order.kind == Kind::Fit && bench.workbench().baseline().is_none() {
        return Err(Refusal::bad("the soil is not calibrated yet: calibrate before effects are fitted"));
    }
    work::begin(&bench, order);
    Ok(Json(json!({})))
}

async fn stop(State(shared): State<Shared>, Path((id, kind)): Path<(String, String)>) -> Answer {
    let bench = shared.bench(&id)?;
    let kind: Kind = serde_json::from_value(json!(kind)).map_err(|_| Refusal::missing("such work"))?;
    Ok(Json(json!({ "stopped": bench.jobs.stop(kind) })))
}

/// What happens to an experiment: first all that has happened, then each event. A browser that has lost the connection comes back by
/// itself and is told all again.
async fn events(
    State(shared): State<Shared>,
    Path(id): Path<String>,
) -> Result<Sse<impl Stream<Item = Result<sse::Event, Infallible>>>, Refusal> {
    let bench = shared.bench(&id)?;
    let receiver = bench.events.subscribe();
    let first = Some(bench.snapshot());
    let following = stream::unfold((bench, receiver, first), async |(bench, mut receiver, first)| {
        let event = match first {
            Some(event) => event,
            None => match receiver.recv().await {
                Ok(event) => event,
                Err(RecvError::Lagged(_)) => bench.snapshot(),
                Err(RecvError::Closed) => return None,
            },
        };
        Some((Ok(sent(&event)), (bench, receiver, None)))
    });
    Ok(Sse::new(following).keep_alive(KeepAlive::default()))
}

fn sent(event: &Event) -> sse::Event {
    sse::Event::default().event(event.name).data(&*event.data)
}

/// The steps of an experiment, from which another may take its soil.
async fn steps(State(shared): State<Shared>, Path(id): Path<String>) -> Answer {
    Ok(Json(json!({ "steps": shared.bench(&id)?.steps() })))
}

async fn accept(State(shared): State<Shared>, Path(id): Path<String>, body: Bytes) -> Answer {
    let bench = shared.bench(&id)?;
    let step: Step = read(&body)?;
    quickly(&shared, move || Ok(Json(json!({ "at": bench.accept(step)? })))).await
}

async fn export(State(shared): State<Shared>, Path(id): Path<String>, body: Bytes) -> Result<Response, Refusal> {
    let bench = shared.bench(&id)?;
    let asked: export::Asked = read(&body)?;
    let fmu = shared.fmu;
    let file = quickly(&shared, move || export::export(&bench, &asked, fmu)).await?;
    let disposition = format!("attachment; filename=\"{}\"", file.name);
    Ok(([(CONTENT_TYPE, file.kind.to_owned()), (CONTENT_DISPOSITION, disposition)], file.bytes).into_response())
}

async fn open_set(State(shared): State<Shared>, body: Bytes) -> Answer {
    let asked: set::Asked = read(&body)?;
    let opener = Arc::clone(&shared);
    let bench = quickly(&shared, move || set::open(&opener, &asked)).await?;
    Ok(Json(bench.listed()))
}

async fn new_upload(State(shared): State<Shared>) -> Json<Value> {
    Json(json!({ "upload": lock(&shared).begin() }))
}

#[derive(Deserialize)]
struct Named {
    path: String,
}

async fn put_file(
    State(shared): State<Shared>,
    Path(number): Path<u64>,
    Query(named): Query<Named>,
    body: Bytes,
) -> Answer {
    lock(&shared).take(number, &named.path, body.to_vec())?;
    Ok(Json(json!({})))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Choices {
    #[serde(default)]
    kind: Option<measurement::Kind>,
    #[serde(default)]
    columns: BTreeMap<String, Option<Meaning>>,
    #[serde(default)]
    filled: BTreeMap<String, f64>,
}

async fn propose(State(shared): State<Shared>, Path(number): Path<u64>, body: Bytes) -> Answer {
    let choices: Choices = read(&body)?;
    let mut uploads = lock(&shared);
    let upload = uploads.get(number)?;
    if upload.has_settings() {
        return Ok(Json(json!({ "ready": true, "files": upload.names().collect::<Vec<_>>() })));
    }
    let proposal = upload.choose(choices.kind, &choices.columns, &choices.filled)?;
    Ok(Json(json!({
        "ready": false,
        "kind": proposal.kind.name(),
        "columns": proposal.columns(),
        "targets": proposal.targets(),
        "settings": proposal.settings,
        "unsure": proposal.unsure,
        "missing": proposal.missing,
    })))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Opening {
    /// The text of `experiment.toml` in the place of the upload's own.
    #[serde(default)]
    settings: Option<String>,
}

async fn open_upload(State(shared): State<Shared>, Path(number): Path<u64>, body: Bytes) -> Answer {
    let opening: Opening = read(&body)?;
    let (experiment, given) = lock(&shared).get(number)?.experiment(opening.settings.as_deref())?;
    let opener = Arc::clone(&shared);
    let opened = Opened { experiment, given, example: false };
    let bench = quickly(&shared, move || opener.open(opened).map_err(Refusal::bad)).await?;
    lock(&shared).end(number);
    Ok(Json(bench.listed()))
}
