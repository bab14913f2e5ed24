//! What the fuzz targets share.
#![forbid(unsafe_code)]

use crc::{CRC_32_ISO_HDLC, Crc};
use std::cell::RefCell;
use std::path::Path;
use tempfile::TempDir;

/// Calls `read` with the path of a file `name` that holds `bytes`; the next call overwrites it.
pub fn with_file(name: &str, bytes: &[u8], read: impl FnOnce(&Path)) {
    thread_local! {
        static FOLDER: RefCell<Option<TempDir>> = const { RefCell::new(None) };
    }
    FOLDER.with_borrow_mut(|folder| {
        let folder = folder.get_or_insert_with(|| TempDir::new().expect("a temporary folder"));
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("room for a small file");
        read(&path);
    });
}

/// `bytes` with their last four replaced by the CRC-32 of the others: a mutation behind a checksum gets through.
#[must_use]
pub fn with_checksum(bytes: &[u8]) -> Vec<u8> {
    let content = &bytes[..bytes.len().saturating_sub(4)];
    let checksum = Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(content);
    [content, &checksum.to_le_bytes()].concat()
}
