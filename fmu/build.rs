//! Publishes where this crate's manifest is: `fmu/package` reads it as `DEP_BEKKER_FMU_MANIFEST`.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::metadata=manifest={}/Cargo.toml", env!("CARGO_MANIFEST_DIR"));
}
