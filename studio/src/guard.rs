//! Which requests are answered: those that name this server and come from its own page.
//!
//! A page of another site can send requests to a local server, and by DNS rebinding even read the answers. Its requests carry
//! another `Host` or another `Origin`, and are refused. Where the server can be reached from other machines every request has to show
//! the token, which the address that is printed holds; the first answer puts it into a cookie.

use crate::error::Refusal;
use crate::state::Shared;
use axum::extract::{Request, State};
use axum::http::header::{
    CONTENT_SECURITY_POLICY, COOKIE, HOST, HeaderValue, LOCATION, ORIGIN, REFERRER_POLICY, SET_COOKIE,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::{IpAddr, SocketAddr};

/// Name of the cookie that holds the token.
const TOKEN: &str = "bekker_studio";

/// What the page may load: its own files only.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors";

/// Who may show the page within theirs: nobody else, or pages of this machine and of an editor's notebook.
const OWN: &str = "'self'";
const NOTEBOOKS: &str = "'self' http://localhost:* http://127.0.0.1:* vscode-webview:";

/// Who may ask.
#[derive(Clone, Debug)]
pub struct Guard {
    address: SocketAddr,
    token: Option<String>,
    policy: HeaderValue,
}

/// What the page may load and who may show it.
fn policy(in_notebook: bool) -> HeaderValue {
    let text = format!("{POLICY} {}", if in_notebook { NOTEBOOKS } else { OWN });
    // It is plain text, which a header can hold.
    HeaderValue::from_str(&text).unwrap_or_else(|_| HeaderValue::from_static("default-src 'none'"))
}

impl Guard {
    /// For a server that listens on `address`: with a token unless it is of the loopback interface.
    pub fn new(address: SocketAddr, in_notebook: bool) -> std::io::Result<Self> {
        let token = if address.ip().is_loopback() { None } else { Some(random_token()?) };
        Ok(Self { address, token, policy: policy(in_notebook) })
    }

    /// The address for a browser.
    pub fn url(&self) -> String {
        let ip = self.address.ip();
        // An address that stands for all interfaces is none that a browser can go to.
        let host = if ip.is_unspecified() { "localhost".to_owned() } else { bracketed(ip) };
        let token = self.token.as_ref().map_or(String::new(), |token| format!("?token={token}"));
        format!("http://{host}:{}/{token}", self.address.port())
    }

    /// Whether `Host` names this server. Bound to a known address only that one and, on the loopback interface, its names are; bound to
    /// all interfaces any address in numbers is, since a rebound name is none.
    fn knows_host(&self, host: &str) -> bool {
        let (name, port) = host.rsplit_once(':').filter(|(_, port)| !port.ends_with(']')).unwrap_or((host, "80"));
        if port.parse() != Ok(self.address.port()) {
            return false;
        }
        let ip = name.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>().ok();
        let own = self.address.ip();
        match ip {
            Some(ip) => ip == own || own.is_unspecified() || (own.is_loopback() && ip.is_loopback()),
            None => name.eq_ignore_ascii_case("localhost") && (own.is_loopback() || own.is_unspecified()),
        }
    }

    /// Whether a request comes from the page of this server: browsers say the origin with everything that changes something.
    fn knows_origin(&self, headers: &HeaderMap) -> bool {
        let site = headers.get("sec-fetch-site").and_then(|site| site.to_str().ok());
        if matches!(site, Some("cross-site" | "same-site"))
            && headers.get("sec-fetch-mode").is_none_or(|mode| mode != "navigate")
        {
            return false;
        }
        let Some(origin) = headers.get(ORIGIN) else { return true };
        let host = origin.to_str().ok().and_then(|origin| origin.strip_prefix("http://"));
        host.is_some_and(|host| {
            self.knows_host(host) && headers.get(HOST).and_then(|own| own.to_str().ok()) == Some(host)
        })
    }

    fn check(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = headers.get(HOST).and_then(|host| host.to_str().ok()).unwrap_or_default();
        if !self.knows_host(host) {
            return Err(Refusal::forbidden("the request names another host than this server"));
        }
        if !self.knows_origin(headers) {
            return Err(Refusal::forbidden("the request comes from another page"));
        }
        Ok(())
    }

    /// Whether the token is missing.
    fn locks_out(&self, headers: &HeaderMap) -> bool {
        self.token
            .as_ref()
            .is_some_and(|token| !cookies(headers).any(|(name, value)| name == TOKEN && same(value, token)))
    }

    /// The way on for a browser that shows the token in the address: the cookie, and the address without the token.
    fn welcome(&self, uri: &Uri) -> Option<Response> {
        let token = self.token.as_ref()?;
        let shown = uri.query()?.split('&').find_map(|pair| pair.strip_prefix("token="))?;
        if !same(shown, token) {
            return None;
        }
        let cookie = format!("{TOKEN}={token}; HttpOnly; SameSite=Strict; Path=/");
        Some((StatusCode::SEE_OTHER, [(SET_COOKIE, cookie), (LOCATION, uri.path().to_owned())]).into_response())
    }
}

/// Lets through what the guard allows, and tells browsers what the page may do.
pub async fn guarded(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let guard = &shared.guard;
    let mut response = match guard.check(request.headers()) {
        Err(refused) => refused.into_response(),
        Ok(()) if guard.locks_out(request.headers()) => guard.welcome(request.uri()).unwrap_or_else(|| {
            let message = "this server asks for a token: open the address that it has printed";
            Refusal::of(StatusCode::UNAUTHORIZED, message).into_response()
        }),
        Ok(()) => next.run(request).await,
    };
    let headers = response.headers_mut();
    headers.insert(CONTENT_SECURITY_POLICY, guard.policy.clone());
    headers.insert(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    response
}

fn cookies(headers: &HeaderMap) -> impl Iterator<Item = (&str, &str)> {
    let all = headers.get_all(COOKIE).iter().filter_map(|line| line.to_str().ok());
    all.flat_map(|line| line.split(';')).filter_map(|pair| pair.trim().split_once('='))
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differing, (a, b)| differing | (a ^ b)) == 0
}

fn bracketed(ip: IpAddr) -> String {
    if ip.is_ipv6() { format!("[{ip}]") } else { ip.to_string() }
}

/// 128 random bits in hexadecimal.
fn random_token() -> std::io::Result<String> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard(address: &str) -> Guard {
        Guard { address: address.parse().expect("an address"), token: None, policy: policy(false) }
    }

    #[test]
    fn property_only_names_of_this_server_are_hosts() {
        let local = guard("127.0.0.1:8137");
        for host in ["127.0.0.1:8137", "localhost:8137", "LOCALHOST:8137", "[::1]:8137"] {
            assert!(local.knows_host(host), "{host}");
        }
        for host in
            ["evil.example:8137", "localhost:80", "localhost", "127.0.0.1.evil.example:8137", "10.0.0.1:8137", ""]
        {
            assert!(!local.knows_host(host), "{host}");
        }
        let open = guard("0.0.0.0:8137");
        assert!(open.knows_host("192.168.1.5:8137") && !open.knows_host("evil.example:8137"));
    }

    #[test]
    fn property_only_notebooks_of_this_machine_may_show_the_page_and_only_where_asked() {
        let ancestors = |in_notebook| {
            let text = policy(in_notebook).to_str().expect("text").to_owned();
            text.split("frame-ancestors ").nth(1).expect("a rule").to_owned()
        };
        assert_eq!(ancestors(false), "'self'");
        for source in ancestors(true).split(' ') {
            assert!(
                ["'self'", "http://localhost:*", "http://127.0.0.1:*", "vscode-webview:"].contains(&source),
                "{source}"
            );
        }
    }

    #[test]
    fn property_the_token_is_in_the_address_only_where_others_can_ask() {
        assert_eq!(guard("127.0.0.1:8137").url(), "http://127.0.0.1:8137/");
        let open = Guard::new("0.0.0.0:8137".parse().expect("an address"), false).expect("random numbers");
        assert!(open.url().starts_with("http://localhost:8137/?token=") && open.url().len() > 50);
    }
}
