//! The built page belongs to its sources, so that `cargo build` needs no Node.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use std::fs;
use std::path::{Path, PathBuf};

/// Files of the page that are no TypeScript.
const NAMED: [&str; 5] = ["index.html", "package-lock.json", "package.json", "tsconfig.json", "vite.config.ts"];

fn page() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("page")
}

/// 64-bit FNV-1a over the names and texts of all sources, as `page/fingerprint.mjs` computes it when the page is built.
fn fingerprint() -> String {
    let mut sources: Vec<String> = NAMED.iter().map(|name| (*name).to_owned()).collect();
    let below = fs::read_dir(page().join("src")).unwrap();
    sources.extend(below.map(|entry| format!("src/{}", entry.unwrap().file_name().to_string_lossy())));
    sources.sort();
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    let mut take = |text: &str| {
        for byte in text.bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    };
    for name in sources {
        take(&format!("{name}\n"));
        take(&fs::read_to_string(page().join(&name)).unwrap().replace("\r\n", "\n"));
    }
    format!("{hash:016x}\n")
}

#[test]
fn property_the_built_page_is_that_of_its_sources() {
    let built = fs::read_to_string(page().join("built/sources")).unwrap();
    assert_eq!(
        built,
        fingerprint(),
        "the page has changed since it was built: in studio/page run `npm ci && npm run build`"
    );
}

#[test]
fn property_the_page_is_small() {
    let size: u64 = ["index.html", "page.js", "page.css"]
        .iter()
        .map(|name| fs::metadata(page().join("built").join(name)).unwrap().len())
        .sum();
    // It is embedded in the program and in every saved report.
    assert!(size < 300_000, "{size} bytes");
}
