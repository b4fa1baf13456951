//! For which platforms a library is, read from its header.

use std::fmt;

/// An architecture and a system in the words of the Rust compiler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Platform {
    /// For example `x86_64`.
    pub architecture: &'static str,
    /// For example `linux`.
    pub system: &'static str,
}

impl fmt::Display for Platform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.architecture, self.system)
    }
}

impl Platform {
    /// Of this crate's target.
    pub const OWN: Self = Self { architecture: env!("BEKKER_FMU_ARCHITECTURE"), system: env!("BEKKER_FMU_SYSTEM") };

    /// The ending of a library's file name there.
    pub(crate) fn extension(self) -> &'static str {
        match self.system {
            "windows" => "dll",
            "macos" => "dylib",
            _ => "so",
        }
    }
}

/// A function of every FMU library of ours, in its table of symbols.
const FUNCTION: &[u8] = b"fmi3InstantiateCoSimulation";

/// The platforms of a library: one, or for macOS one for each architecture of a universal file.
///
/// # Errors
/// What was expected, where this is no library of an FMU.
pub fn platforms(library: &[u8]) -> Result<Vec<Platform>, &'static str> {
    if !library.windows(FUNCTION.len()).any(|part| part == FUNCTION) {
        return Err("expected a library of FMUs, built from `fmu/` by cargo");
    }
    let found = match library.get(..4) {
        Some(b"\x7fELF") => vec![(elf(library), "linux")],
        Some([b'M', b'Z', ..]) => vec![(pe(library), "windows")],
        Some(b"\xcf\xfa\xed\xfe") => vec![(number(library, 4, true).and_then(mach), "macos")],
        Some(b"\xca\xfe\xba\xbe") => universal(library).into_iter().map(|found| (found, "macos")).collect(),
        _ => return Err("expected an ELF, PE or Mach-O library"),
    };
    let known = found.into_iter().map(|(architecture, system)| Some(Platform { architecture: architecture?, system }));
    let known: Option<Vec<Platform>> = known.collect();
    known.filter(|list| !list.is_empty()).ok_or("expected a library for x86_64, aarch64 or x86")
}

/// The field `e_machine` of an ELF header.
fn elf(library: &[u8]) -> Option<&'static str> {
    match half(library, 18)? {
        62 => Some("x86_64"),
        183 => Some("aarch64"),
        3 => Some("x86"),
        _ => None,
    }
}

/// The field `Machine` behind the signature of a PE file, whose place the old header gives at 0x3c.
fn pe(library: &[u8]) -> Option<&'static str> {
    let place = number(library, 0x3c, true)? as usize;
    if library.get(place..place.checked_add(4)?)? != b"PE\0\0" {
        return None;
    }
    match half(library, place + 4)? {
        0x8664 => Some("x86_64"),
        0xaa64 => Some("aarch64"),
        0x014c => Some("x86"),
        _ => None,
    }
}

/// `cputype` of Mach-O.
fn mach(kind: u32) -> Option<&'static str> {
    match kind {
        0x0100_0007 => Some("x86_64"),
        0x0100_000c => Some("aarch64"),
        _ => None,
    }
}

/// The architectures of a universal file: its header is big-endian, a count and 20 bytes each.
fn universal(library: &[u8]) -> Vec<Option<&'static str>> {
    let count = number(library, 4, false).unwrap_or(0).min(8) as usize;
    (0..count).map(|k| number(library, 8 + 20 * k, false).and_then(mach)).collect()
}

fn half(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at.checked_add(2)?)?.try_into().ok()?))
}

fn number(bytes: &[u8], at: usize, little: bool) -> Option<u32> {
    let bytes: [u8; 4] = bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
    Some(if little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(begin: &[u8], fields: &[(usize, &[u8])]) -> Vec<u8> {
        let mut library = vec![0; 256];
        library[..begin.len()].copy_from_slice(begin);
        fields.iter().for_each(|(at, field)| library[*at..at + field.len()].copy_from_slice(field));
        library.extend_from_slice(FUNCTION);
        library
    }

    #[test]
    fn published_headers_name_their_platforms() {
        // The values of the ELF, PE and Mach-O specifications.
        let pe = |machine: &'static [u8]| header(b"MZ", &[(0x3c, &[0x80]), (0x80, b"PE\0\0"), (0x84, machine)]);
        let fat = header(b"\xca\xfe\xba\xbe\0\0\0\x02", &[(8, b"\x01\0\0\x07"), (28, b"\x01\0\0\x0c")]);
        for (library, expected) in [
            (header(b"\x7fELF", &[(18, &[62])]), vec!["x86_64 linux"]),
            (header(b"\x7fELF", &[(18, &[183])]), vec!["aarch64 linux"]),
            (pe(b"\x64\x86"), vec!["x86_64 windows"]),
            (pe(b"\x64\xaa"), vec!["aarch64 windows"]),
            (header(b"\xcf\xfa\xed\xfe\x0c\0\0\x01", &[]), vec!["aarch64 macos"]),
            (fat, vec!["x86_64 macos", "aarch64 macos"]),
        ] {
            let found = platforms(&library).map(|list| list.iter().map(Platform::to_string).collect::<Vec<_>>());
            assert_eq!(found, Ok(expected.into_iter().map(str::to_owned).collect()));
        }
    }

    #[test]
    fn property_what_is_no_library_is_refused() {
        for library in [header(b"\x7fELF", &[(18, &[8])]), header(b"MZ", &[(0x3c, &[0xff; 4])]), header(b"PK", &[])] {
            assert!(platforms(&library).is_err());
        }
        assert!(platforms(b"\x7fELF").is_err_and(|message| message.contains("library of FMUs")));
        assert!(platforms(b"").is_err());
    }
}
