//! What goes wrong, as the page hears it.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde_json::json;

/// Why a studio does not start or ends.
#[derive(Debug, thiserror::Error)]
pub enum StudioError {
    /// The address cannot be listened on.
    #[error("cannot listen on {address}: {source}")]
    Bind {
        /// The address.
        address: std::net::SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// An experiment cannot be placed.
    #[error("{name}: {source}")]
    Experiment {
        /// Its name.
        name: String,
        /// Why.
        source: Box<bekker::diagnosis::CompareError>,
    },
    /// The server failed.
    #[error("the server failed: {0}")]
    Server(#[from] std::io::Error),
    /// The system gives no random numbers for a token.
    #[error("cannot make a token: {0}")]
    Token(std::io::Error),
}

/// A refusal: a status and a sentence for the person who reads it.
#[derive(Debug)]
pub struct Refusal {
    status: StatusCode,
    message: String,
}

impl Refusal {
    /// Something in the request cannot be right.
    pub fn bad(message: impl ToString) -> Self {
        Self { status: StatusCode::UNPROCESSABLE_ENTITY, message: message.to_string() }
    }

    /// There is no such thing.
    pub fn missing(what: &str) -> Self {
        Self { status: StatusCode::NOT_FOUND, message: format!("there is no {what}") }
    }

    /// The request does not come from the page.
    pub fn forbidden(message: &str) -> Self {
        Self { status: StatusCode::FORBIDDEN, message: message.to_owned() }
    }

    /// It is more than is taken.
    pub fn too_large(message: impl ToString) -> Self {
        Self { status: StatusCode::PAYLOAD_TOO_LARGE, message: message.to_string() }
    }

    /// Another status.
    pub fn of(status: StatusCode, message: impl ToString) -> Self {
        Self { status, message: message.to_string() }
    }
}

impl From<bekker::diagnosis::CompareError> for Refusal {
    fn from(error: bekker::diagnosis::CompareError) -> Self {
        Self::bad(error)
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        (self.status, Json(json!({ "error": self.message }))).into_response()
    }
}
