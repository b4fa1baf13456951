//! The page: the built form of `page/`, embedded so that nothing else has to be installed.

use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};

const INDEX: &str = include_str!("../page/built/index.html");
const SCRIPT: &str = include_str!("../page/built/page.js");
const STYLE: &str = include_str!("../page/built/page.css");

fn file(kind: &'static str, text: &'static str) -> Response {
    // A newer program has a newer page under the same address.
    ([(CONTENT_TYPE, kind), (CACHE_CONTROL, "no-cache")], text).into_response()
}

pub async fn index() -> Response {
    file("text/html; charset=utf-8", INDEX)
}

pub async fn script() -> Response {
    file("text/javascript; charset=utf-8", SCRIPT)
}

pub async fn style() -> Response {
    file("text/css; charset=utf-8", STYLE)
}
