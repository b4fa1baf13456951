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
    let unknown = || UNKNOWN.to_owned();
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
    root_of(&file).ok_or_else(unknown)
}

#[cfg(windows)]
fn beside_the_library() -> Result<PathBuf, String> {
    use std::os::windows::ffi::OsStringExt;
    /// The longest path of Windows, in UTF-16 units.
    const LONGEST: u32 = 32_768;
    /// The address lies in the module; do not count a reference.
    const FROM_ADDRESS: u32 = 0x4 | 0x2;
    #[link(name = "kernel32")]
    unsafe extern "system" {
        fn GetModuleHandleExW(flags: u32, address: *const u16, module: *mut *mut std::ffi::c_void) -> i32;
        fn GetModuleFileNameW(module: *mut std::ffi::c_void, text: *mut u16, size: u32) -> u32;
    }
    let mut module = std::ptr::null_mut();
    let mut text = vec![0_u16; LONGEST as usize];
    // SAFETY: the address is one of this library's functions; both places outlive the calls.
    let length = unsafe {
        match GetModuleHandleExW(FROM_ADDRESS, beside_the_library as *const u16, &raw mut module) {
            0 => 0,
            _ => GetModuleFileNameW(module, text.as_mut_ptr(), LONGEST),
        }
    };
    let file = PathBuf::from(std::ffi::OsString::from_wide(&text[..(length as usize).min(text.len())]));
    root_of(&file).ok_or_else(|| UNKNOWN.to_owned())
}

const UNKNOWN: &str = "no resource path was given, and the library cannot tell where it is";

/// The resources beside the folder `binaries` in which a library lies.
fn root_of(file: &std::path::Path) -> Option<PathBuf> {
    let root = file.parent().and_then(|platform| platform.parent()).and_then(|binaries| binaries.parent());
    root.map(|root| root.join("resources"))
}

/// The path in FMI 2.0's resource location, which is a URI (`file:///tmp/fmu/resources`, with escapes); a plain path,
/// which some importers pass, is taken as it is.
///
/// # Errors
/// A sentence where it is not UTF-8 text, or of another scheme.
pub fn path_of_uri(uri: &CStr) -> Result<String, String> {
    let text = uri.to_str().map_err(|_| "the resource location is not UTF-8 text".to_owned())?;
    let Some(rest) = text.strip_prefix("file:") else {
        let elsewhere = text.contains("://");
        return if elsewhere {
            Err(format!("the resource location `{text}` is not on this machine"))
        } else {
            Ok(text.into())
        };
    };
    // `file:///path`, `file://localhost/path` and, from some importers, `file:/path` or `file://C:/path`.
    let rest = rest.strip_prefix("//localhost").or_else(|| rest.strip_prefix("//")).unwrap_or(rest);
    let path = unescaped(rest).ok_or_else(|| format!("the resource location `{text}` has a wrong escape"))?;
    let drive = path.strip_prefix('/').filter(|rest| rest.as_bytes().get(1) == Some(&b':'));
    Ok(drive.map_or(path.clone(), str::to_owned))
}

/// Undoes the escapes of a URI (`%20`).
fn unescaped(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte != b'%' {
            bytes.push(byte);
            continue;
        }
        let digit = |byte: Option<u8>| byte.and_then(|byte| char::from(byte).to_digit(16));
        let (high, low) = (digit(rest.next())?, digit(rest.next())?);
        bytes.push(u8::try_from(16 * high + low).ok()?);
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::path_of_uri;

    #[test]
    fn published_forms_of_a_file_uri() {
        // RFC 8089, section 2 and appendices B and E.2; percent-encoding by RFC 3986, 2.1. Importers also give plain paths.
        let cases = [
            (c"file:///tmp/a/resources", "/tmp/a/resources"),
            (c"file:/tmp/a", "/tmp/a"),
            (c"file://localhost/tmp/a", "/tmp/a"),
            (c"file:///tmp/with%20space%C3%A4", "/tmp/with space\u{e4}"),
            (c"file:///C:/fmu/resources", "C:/fmu/resources"),
            (c"/plain/path", "/plain/path"),
        ];
        for (uri, path) in cases {
            assert_eq!(path_of_uri(uri).as_deref(), Ok(path));
        }
        for wrong in [c"http://host/a", c"file:///a%2", c"file:///a%zz", c"file:///%ff"] {
            assert!(path_of_uri(wrong).is_err(), "{wrong:?}");
        }
    }
}
