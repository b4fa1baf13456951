//! Who is answered, and what files may do.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use serde_json::json;
use support::{EXAMPLE, Running, started};

const LOCAL: &str = "127.0.0.1:0";

#[test]
fn property_other_hosts_and_other_pages_are_refused() {
    let running = started(LOCAL);
    let port = running.port;
    assert_eq!(running.get("/").status, 200);
    for host in ["evil.example", &format!("evil.example:{port}"), "127.0.0.1:1", "10.1.2.3:80"] {
        let answer = running.ask("GET", "/api/experiments", &format!("Host: {host}\r\n"), b"");
        assert_eq!(answer.status, 403, "{host}");
        assert!(answer.error().contains("another host"));
    }
    for origin in ["http://evil.example", "https://127.0.0.1", "null", &format!("http://localhost:{port}")] {
        let answer = running.ask("POST", "/api/uploads", &format!("Origin: {origin}\r\n"), b"");
        assert_eq!(answer.status, 403, "{origin}");
    }
    assert_eq!(
        running.ask("GET", EXAMPLE, "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: no-cors\r\n", b"").status,
        403
    );
    let own = format!("Origin: http://127.0.0.1:{port}\r\n");
    assert_eq!(running.ask("POST", "/api/uploads", &own, b"").status, 200);
    let named = format!("Host: localhost:{port}\r\nOrigin: http://localhost:{port}\r\n");
    assert_eq!(running.ask("POST", "/api/uploads", &named, b"").status, 200);
}

#[test]
fn property_a_server_that_others_can_reach_asks_for_its_token() {
    let running = started("0.0.0.0:0");
    let token = running.url.split("token=").nth(1).unwrap().to_owned();
    assert_eq!(running.get("/").status, 401);
    assert_eq!(running.get("/api/experiments").status, 401);
    assert_eq!(running.get("/?token=0123").status, 401);
    let welcome = running.get(&format!("/?token={token}"));
    assert_eq!(welcome.status, 303);
    assert!(welcome.head.contains("HttpOnly") && welcome.head.contains("SameSite=Strict"), "{}", welcome.head);
    let cookie = format!("Cookie: other=1; bekker_studio={token}\r\n");
    assert_eq!(running.ask("GET", "/api/experiments", &cookie, b"").status, 200);
    assert_eq!(running.ask("GET", "/api/experiments", "Cookie: bekker_studio=0123\r\n", b"").status, 401);
    let rebound = format!("{cookie}Host: evil.example:{}\r\n", running.port);
    assert_eq!(running.ask("GET", "/api/experiments", &rebound, b"").status, 403);
}

#[test]
fn property_the_page_may_load_nothing_from_elsewhere() {
    let running = started(LOCAL);
    for path in ["/", "/page.js", "/page.css"] {
        let answer = running.get(path);
        assert_eq!(answer.status, 200, "{path}");
        assert!(
            answer.head.contains("content-security-policy: default-src 'none'; script-src 'self'"),
            "{}",
            answer.head
        );
        let text = String::from_utf8(answer.body).unwrap();
        let elsewhere = text.split("http").skip(1).map(|rest| rest.chars().take(40).collect::<String>());
        // Names of namespaces are no addresses that are loaded.
        let strange: Vec<String> =
            elsewhere.filter(|rest| rest.contains("://") && !rest.contains("www.w3.org")).collect();
        assert!(strange.is_empty(), "{path}: {strange:?}");
    }
}

#[test]
fn property_files_do_not_leave_their_folder() {
    let running = started(LOCAL);
    assert_eq!(running.get("/..%2f..%2fetc/passwd").status, 404);
    assert_eq!(running.get("/api/experiments/..%2f..").status, 404);
    let number = running.post("/api/uploads", &json!({})).json()["upload"].as_u64().unwrap();
    for path in ["..%2Fx.csv", "%2Fetc%2Fpasswd", "a%2F..%2F..%2Fx.csv", "C%3A%5Cx.csv"] {
        let answer = put(&running, number, path, b"a,b\n1,2\n");
        assert_eq!(answer.status, 422, "{path}");
        assert!(answer.error().contains("no name of a file below a folder"));
    }
    // Settings that name a file beside the upload find nothing.
    let settings = "name = \"x\"\nkind = \"single_wheel\"\n[[run]]\nfile = \"/etc/passwd\"\n";
    assert_eq!(put(&running, number, "experiment.toml", settings.as_bytes()).status, 200);
    let answer = running.post(&format!("/api/uploads/{number}/open"), &json!({}));
    assert_eq!(answer.status, 422);
    assert!(answer.error().contains("there is no such file"), "{}", answer.error());
}

#[test]
fn property_an_uploaded_model_reads_no_file() {
    let running = started(LOCAL);
    let number = running.post("/api/uploads", &json!({})).json()["upload"].as_u64().unwrap();
    let settings = "name = \"x\"\nkind = \"single_wheel\"\nmodel = \"m.toml\"\n[[run]]\nfile = \"a.csv\"\n";
    put(&running, number, "experiment.toml", settings.as_bytes());
    put(&running, number, "a.csv", b"load,slip,wheel_speed,drawbar_pull\n20,0.1,0.2,1.0\n20,0.2,0.2,2.0\n");
    let open = |running: &Running| running.post(&format!("/api/uploads/{number}/open"), &json!({})).error();
    assert!(open(&running).contains("neither among the files nor a built-in model"));
    put(&running, number, "m.toml", b"[terrain]\nfile = \"/etc/passwd\"\n");
    assert!(open(&running).contains("is not read from an upload"), "{}", open(&running));
}

#[test]
fn property_uploads_have_a_limit_and_bad_files_the_errors_of_the_command_line() {
    let running = started(LOCAL);
    let number = running.post("/api/uploads", &json!({})).json()["upload"].as_u64().unwrap();
    assert_eq!(put(&running, number, "large.csv", &vec![b'1'; (1 << 20) + 1]).status, 413);
    let answer = put(&running, number, "a.csv", b"load,slip\n20,\xb0\n");
    assert!(answer.error().contains("a.csv") && answer.error().contains("line 2") && answer.error().contains("UTF-8"));
    let settings = "name = \"x\"\nkind = \"single_wheel\"\n[[run]]\nfile = \"a.csv\"\n";
    put(&running, number, "experiment.toml", settings.as_bytes());
    put(&running, number, "a.csv", b"load,slip,wheel_speed,drawbar_pull\n20,0.1,0.2,one\n");
    let shown = running.post(&format!("/api/uploads/{number}/open"), &json!({})).error();
    let texts = [("experiment.toml", settings), ("a.csv", "load,slip,wheel_speed,drawbar_pull\n20,0.1,0.2,one\n")];
    let texts = texts.into_iter().map(|(name, text)| (name.to_owned(), text.to_owned())).collect();
    let expected = bekker::measurement::Experiment::from_texts(&texts).unwrap_err().to_string();
    assert_eq!(shown, expected);
}

fn put(running: &Running, number: u64, path: &str, body: &[u8]) -> support::Answer {
    running.ask("PUT", &format!("/api/uploads/{number}/files?path={path}"), "", body)
}
