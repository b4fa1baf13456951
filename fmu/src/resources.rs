//! Where the files are that were packed with an FMU.

use std::ffi::CStr;
use std::path::PathBuf;

/// The resources folder: `given` by the importer or, where it gives none, found from the place of this
/// library, `binaries/<platform>/<name>` beside `resources`.
///
/// # Errors
/// A sentence where the given path is no folder, or the library's own place is not known.
pub fn folder(given: Option<&CStr>) -> Result<PathBuf, String> {
    // FMI 3.0.2 asks for NULL where there is no path; an empty text is what some importers pass for it.
    let folder = match given.filter(|text| !text.is_empty()) {
        Some(text) => PathBuf::from(text.to_str().map_err(|_| "the resource path is not UTF-8 text".to_owned())?),
        None => beside_the_library()?,
    };
    if folder.is_dir() { Ok(folder) } else { Err(format!("the resource path `{}` is not a folder", folder.display())) }
}

#[cfg(unix)]
fn beside_the_library() -> Result<PathBuf, String> {
    use std::os::unix::ffi::OsStrExt;
    let unknown = || "no resource path was given, and the library cannot tell where it is".to_owned();
    let mut place = libc::Dl_info {
        dli_fname: std::ptr::null(),
        dli_fbase: std::ptr::null_mut(),
        dli_sname: std::ptr::null(),
        dli_saddr: std::ptr::null_mut(),
    };
    // SAFETY: the address is one of this library's functions, and `place` outlives the call.
    let found = unsafe { libc::dladdr(beside_the_library as *const libc::c_void, &raw mut place) };
    if found == 0 || place.dli_fname.is_null() {
        return Err(unknown());
    }
    // SAFETY: the loader's text, NUL-terminated and valid while the library is loaded.
    let file = unsafe { CStr::from_ptr(place.dli_fname) };
    let file = PathBuf::from(std::ffi::OsStr::from_bytes(file.to_bytes()));
    let root = file.parent().and_then(|platform| platform.parent()).and_then(|binaries| binaries.parent());
    root.map(|root| root.join("resources")).ok_or_else(unknown)
}

#[cfg(not(unix))]
fn beside_the_library() -> Result<PathBuf, String> {
    Err("no resource path was given; on this platform the importer must give one".to_owned())
}
