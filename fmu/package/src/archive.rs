//! A zip archive whose bytes depend on nothing but its contents.

use std::io::{Cursor, Write};
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// An archive in memory.
pub struct Archive(ZipWriter<Cursor<Vec<u8>>>);

impl Default for Archive {
    fn default() -> Self {
        Self(ZipWriter::new(Cursor::new(Vec::new())))
    }
}

impl Archive {
    /// Adds a file; `name` has forward slashes.
    pub fn file(&mut self, name: &str, content: &[u8]) -> ZipResult<()> {
        self.add(name, content, 0o644)
    }

    /// Adds a file that systems with permissions may load.
    pub fn program(&mut self, name: &str, content: &[u8]) -> ZipResult<()> {
        self.add(name, content, 0o755)
    }

    fn add(&mut self, name: &str, content: &[u8], permissions: u32) -> ZipResult<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            // The format's first day, for the same bytes at any time.
            .last_modified_time(DateTime::default())
            .unix_permissions(permissions);
        self.0.start_file(name, options)?;
        Ok(self.0.write_all(content)?)
    }

    /// The archive's bytes.
    pub fn finish(self) -> ZipResult<Vec<u8>> {
        Ok(self.0.finish()?.into_inner())
    }
}
