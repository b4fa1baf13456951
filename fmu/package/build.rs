//! Builds `bekker-fmu` as a C library, for this build's target and always optimised, and tells where it
//! is; the crate embeds it. A dependency alone would not do: as a cdylib it would appear only in some
//! builds, and where its features are unified with the workspace's it would carry the HTML reports.

use std::collections::BTreeSet;
use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The workspace, seen from this crate.
const ROOT: &str = "../..";

fn main() {
    // Beside this crate in the checkout and in a source distribution. All paths start from here: absolute
    // ones, kept in a target directory that is moved or copied, would name the sources of another checkout.
    let root = canonical(&Path::new(&variable("CARGO_MANIFEST_DIR")).join(ROOT));
    let manifest = root.join("fmu/Cargo.toml");
    let target = variable("TARGET").into_string().unwrap_or_else(|name| panic!("target {name:?} is not a text"));
    // A target directory of its own: the outer cargo holds the lock of the other one.
    let directory = Path::new(&variable("OUT_DIR")).join("target");
    build(&manifest, &target, &directory);

    let (platform, prefix, extension) = platform();
    let release = directory.join(&target).join("release");
    println!(
        "cargo::rustc-env=BEKKER_FMU_LIBRARY={}",
        release.join(format!("{prefix}bekker_fmu.{extension}")).display()
    );
    println!("cargo::rustc-env=BEKKER_FMU_PLATFORM={platform}");
    println!("cargo::rustc-env=BEKKER_FMU_EXTENSION={extension}");
    watch(&release.join(format!("{prefix}bekker_fmu.d")), &root);
}

fn build(manifest: &Path, target: &str, directory: &Path) {
    let mut cargo = Command::new(variable("CARGO"));
    // Offline: whatever the library needs, the outer build has needed and fetched.
    cargo.args(["rustc", "--offline", "--lib", "--crate-type", "cdylib", "--release", "--target", target]);
    cargo.arg("--manifest-path").arg(manifest).arg("--target-dir").arg(directory);
    cargo.env("CARGO_PROFILE_RELEASE_LTO", "fat").env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "1");
    // A panic must be caught at the C border, so it has to unwind.
    cargo.env("CARGO_PROFILE_RELEASE_PANIC", "unwind").env("CARGO_PROFILE_RELEASE_STRIP", "symbols");
    // `cargo clippy` and the like put themselves between cargo and the compiler; this build is not theirs.
    cargo.env_remove("RUSTC_WORKSPACE_WRAPPER");
    let output = cargo.output().unwrap_or_else(|error| panic!("cannot run cargo for the FMU library: {error}"));
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "the FMU library does not build:\n{messages}");
}

/// The platform's name in FMI 3.0, 2.5.1.4.3, and how its libraries are called.
fn platform() -> (String, &'static str, &'static str) {
    let word = |name: &str| variable(name).to_string_lossy().into_owned();
    let (architecture, system) = (word("CARGO_CFG_TARGET_ARCH"), word("CARGO_CFG_TARGET_OS"));
    match system.as_str() {
        "linux" => (format!("{architecture}-linux"), "lib", "so"),
        "macos" => (format!("{architecture}-darwin"), "lib", "dylib"),
        "windows" => (format!("{architecture}-windows"), "", "dll"),
        other => panic!("FMI 3.0 has no name for the platform `{architecture}-{other}`"),
    }
}

/// Builds again when a source file of the library, a manifest above one, or the lock file changes.
fn watch(dependencies: &Path, root: &Path) {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    let list = std::fs::read_to_string(dependencies)
        .unwrap_or_else(|error| panic!("cannot read `{}`: {error}", dependencies.display()));
    let (_, files) = list.split_once(": ").unwrap_or_default();
    // Make's format: a blank in a path has a backslash before it.
    let files = files.lines().next().unwrap_or_default().replace("\\ ", "\0");
    let sources: Vec<PathBuf> = files.split(' ').map(|file| canonical(Path::new(&file.replace('\0', " ")))).collect();
    let manifests = sources.iter().filter_map(|file| above(file, "Cargo.toml"));
    let lock = Some(root.join("Cargo.lock")).filter(|file| file.is_file());
    let watched: BTreeSet<PathBuf> = manifests.chain(lock).chain(sources.iter().cloned()).collect();
    assert!(watched.contains(&root.join("fmu/src/lib.rs")), "`{}` does not name the sources", dependencies.display());
    for file in watched {
        // Cargo reads relative paths from this crate's folder.
        let relative = file.strip_prefix(root).map_or(file.clone(), |inside| Path::new(ROOT).join(inside));
        println!("cargo::rerun-if-changed={}", relative.display());
    }
}

fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|error| panic!("cannot find `{}`: {error}", path.display()))
}

/// The nearest file called `name` in a folder above `place`.
fn above(place: &Path, name: &str) -> Option<PathBuf> {
    place.ancestors().skip(1).map(|folder| folder.join(name)).find(|file| file.is_file())
}

fn variable(name: &str) -> OsString {
    env::var_os(name).unwrap_or_else(|| panic!("cargo does not set {name}"))
}
