//! Builds `bekker-fmu` as a C library, for this build's target and always optimised, once without the plant of
//! rigid bodies and wheels on a carriage and, with the feature `large-library`, once with them, and tells where they are; the
//! crate embeds them. A dependency alone would not do:
//! as a cdylib it would appear only in some builds, and where its features are unified with the workspace's it
//! would carry the HTML reports.

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
    let out = PathBuf::from(variable("OUT_DIR"));
    let glibc = env::var_os(GLIBC).map(|version| version.to_string_lossy().into_owned());
    let (prefix, extension) = names();
    let mut wanted = vec![("PLAIN", "")];
    wanted.extend(env::var_os("CARGO_FEATURE_LARGE_LIBRARY").map(|_| ("RIGID", "carriage,rigid")));
    let libraries = wanted.into_iter().map(|(name, features)| {
        let directory = shared(&out, name, glibc.as_deref());
        (name, Build { manifest: &manifest, target: &target, directory, features, glibc: glibc.as_deref() })
    });
    let libraries: Vec<_> = libraries.collect();
    // Side by side: the linker's optimisation, which takes most of the time, has one thread.
    std::thread::scope(|scope| libraries.iter().for_each(|(_, library)| drop(scope.spawn(|| build(library)))));
    for (name, library) in libraries {
        let built = library.directory.join(&target).join("release").join(format!("{prefix}bekker_fmu.{extension}"));
        let kept = out.join(format!("{name}.{extension}"));
        std::fs::copy(&built, &kept).unwrap_or_else(|error| panic!("cannot copy `{}`: {error}", built.display()));
        watch(&built.with_extension("d"), &root);
        let variable = if name == "PLAIN" { "BEKKER_FMU_LIBRARY" } else { "BEKKER_FMU_RIGID_LIBRARY" };
        println!("cargo::rustc-env={variable}={}", kept.display());
    }
    let word = |name: &str| variable(name).to_string_lossy().into_owned();
    println!("cargo::rustc-env=BEKKER_FMU_ARCHITECTURE={}", word("CARGO_CFG_TARGET_ARCH"));
    println!("cargo::rustc-env=BEKKER_FMU_SYSTEM={}", word("CARGO_CFG_TARGET_OS"));
}

/// Where a build reads and writes.
struct Build<'a> {
    manifest: &'a Path,
    target: &'a str,
    directory: PathBuf,
    features: &'a str,
    glibc: Option<&'a str>,
}

/// The oldest glibc that the library shall load with (`2.17`), by cargo-zigbuild; without it, that of this machine.
const GLIBC: &str = "BEKKER_FMU_GLIBC";

/// The target directory of one library. It is not the outer one, whose lock the outer cargo holds, but lies in it,
/// beside the profiles' folders: tests, lints and the Python package, which each run this script anew, find the library
/// built. What the compiler is not told, and cargo would not notice, is in the folder's name.
fn shared(out: &Path, name: &str, glibc: Option<&str>) -> PathBuf {
    // <target>/<profile>/build/<crate>/out
    let outer = out.ancestors().nth(4).unwrap_or_else(|| panic!("`{}` is not in a target directory", out.display()));
    let glibc = glibc.map(|version| format!("-glibc-{version}")).unwrap_or_default();
    outer.join("fmu-libraries").join(name.to_lowercase() + &glibc)
}

fn build(job: &Build) {
    let Build { glibc, directory, .. } = job;
    let mut cargo = Command::new(if glibc.is_some() { OsString::from("cargo-zigbuild") } else { variable("CARGO") });
    let target = glibc.map_or(job.target.to_owned(), |version| format!("{}.{version}", job.target));
    // Offline: whatever the library needs, the outer build has needed and fetched.
    cargo.args(["rustc", "--offline", "--lib", "--crate-type", "cdylib", "--release", "--target", &target]);
    cargo.args(["--no-default-features", "--features", job.features]);
    cargo.arg("--manifest-path").arg(job.manifest).arg("--target-dir").arg(directory);
    cargo.env("CARGO_PROFILE_RELEASE_LTO", "fat").env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "1");
    cargo.env("CARGO_ENCODED_RUSTFLAGS", flags());
    if job.features.is_empty() {
        // Small: it travels in every FMU. With `z` for parts of it, it is larger. Results are the same bits. Rapier, in
        // the other library, must be fast.
        cargo.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "s");
    }
    // A panic must be caught at the C border, so it has to unwind.
    cargo.env("CARGO_PROFILE_RELEASE_PANIC", "unwind").env("CARGO_PROFILE_RELEASE_STRIP", "symbols");
    // `cargo clippy` and the like put themselves between cargo and the compiler; this build is not theirs.
    cargo.env_remove("RUSTC_WORKSPACE_WRAPPER");
    cargo.arg("--");
    if glibc.is_none() && job.target.ends_with("linux-gnu") {
        cargo.arg(without_libgcc_s(directory));
    }
    if job.features.is_empty() {
        // 28 kB less; what must be fast is marked in the core.
        cargo.arg("-Cllvm-args=-inline-threshold=0");
        if glibc.is_none() && job.target == "x86_64-unknown-linux-gnu" && !chooses_linker() {
            // 4 kB less: functions with the same machine code are kept once. Rust links this target with LLD, which can.
            cargo.arg("-Clink-arg=-Wl,--icf=all");
        }
    }
    let output = cargo.output().unwrap_or_else(|error| panic!("cannot run {cargo:?} for the FMU library: {error}"));
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "the FMU library does not build:\n{messages}");
}

/// The outer build's flags of the compiler, and the folders of the registry cut from the paths in messages of panics: a
/// library that travels names no folder of the machine that built it, and has the same size wherever it is built.
fn flags() -> OsString {
    let mut flags = env::var_os("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| env::home_dir().map(|folder| folder.join(".cargo")));
    let registries = home.and_then(|folder| std::fs::read_dir(folder.join("registry/src")).ok()).into_iter().flatten();
    // Sorted: cargo builds all anew where the flags differ.
    for folder in registries.flatten().map(|entry| entry.path()).collect::<BTreeSet<_>>() {
        if !flags.is_empty() {
            flags.push(SEPARATOR);
        }
        flags.push("--remap-path-prefix=");
        flags.push(folder);
        flags.push("=.");
    }
    flags
}

/// Between the flags in `CARGO_ENCODED_RUSTFLAGS`.
const SEPARATOR: &str = "\x1f";

/// Whether the outer build names a linker, which may lack what the usual one can.
fn chooses_linker() -> bool {
    let flags = env::var_os("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    ["linker", "fuse-ld"].iter().any(|word| flags.to_string_lossy().contains(word))
        || env::var_os("RUSTC_LINKER").is_some()
}

/// The compiler asks for the shared `libgcc_s`, which a host may lack; a linker script of that name gives it the
/// static parts instead.
fn without_libgcc_s(directory: &Path) -> String {
    let folder = directory.join("link");
    let script = "/* GNU ld script: unwinding from the static library. */\nGROUP ( -lgcc_eh -lgcc -lc )\n";
    let written = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(folder.join("libgcc_s.so"), script));
    written.unwrap_or_else(|error| panic!("cannot write in `{}`: {error}", folder.display()));
    format!("-Lnative={}", folder.display())
}

/// How this target's libraries are called.
fn names() -> (&'static str, &'static str) {
    match variable("CARGO_CFG_TARGET_OS").to_string_lossy().as_ref() {
        "linux" => ("lib", "so"),
        "macos" => ("lib", "dylib"),
        "windows" => ("", "dll"),
        other => panic!("FMI has no name for the system `{other}`"),
    }
}

/// Builds again when a source file of the library, a manifest above one, or the lock file changes.
fn watch(dependencies: &Path, root: &Path) {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    println!("cargo::rerun-if-env-changed={GLIBC}");
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
