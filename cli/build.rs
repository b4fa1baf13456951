//! Embeds the shipped experiment.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("set by cargo")).join("../examples/sand_wheel");
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut files = vec![folder.join("experiment.toml")];
    files
        .extend(fs::read_dir(folder.join("runs")).expect("examples/sand_wheel/runs").map(|e| e.expect("entry").path()));
    files.sort();
    let mut list = String::from("[");
    for file in &files {
        let name = file.strip_prefix(&folder).expect("inside").to_string_lossy().replace('\\', "/");
        let _ = write!(list, "({name:?}, include_str!({:?})),", file.display().to_string());
    }
    list.push(']');
    let out = PathBuf::from(env::var("OUT_DIR").expect("set by cargo")).join("sand_wheel.rs");
    fs::write(out, list).expect("OUT_DIR is writable");
}
