//! Training curves: a CSV file and TensorBoard's event file, a line and an event a scalar.
//!
//! An event file is a row of records: length (u64), its checksum, the bytes of
//! a protobuf `Event`, their checksum; checksums are CRC-32C, rotated and offset
//! ("masked"), so that a checksum of checksums is not zero. Both files are
//! appended to, so they are readable while the run goes on.

use crc::{CRC_32_ISCSI, Crc};
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// Both files, open.
#[derive(Debug)]
pub struct Log {
    csv: File,
    events: File,
}

impl Log {
    /// Opens `scalars.csv` and `events.out.tfevents.0.cede` in `folder`, made if need be; what is
    /// there already is kept if `append`, else overwritten.
    ///
    /// # Errors
    /// When the folder or a file cannot be written.
    pub fn open(folder: &Path, append: bool) -> io::Result<Self> {
        std::fs::create_dir_all(folder)?;
        let open = |name: &str| {
            let mut options = OpenOptions::new();
            options
                .create(true)
                .append(append)
                .write(true)
                .truncate(!append);
            options.open(folder.join(name))
        };
        let mut log = Self {
            csv: open("scalars.csv")?,
            events: open("events.out.tfevents.0.cede")?,
        };
        if log.csv.metadata()?.len() == 0 {
            log.csv.write_all(b"step,name,value\n")?;
            log.events
                .write_all(&record(&event(now(), 0, &version())))?;
        }
        Ok(log)
    }

    /// Adds the scalars of `step`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add(&mut self, step: u64, scalars: &[(&str, f32)]) -> io::Result<()> {
        let (mut lines, mut records) = (String::new(), Vec::new());
        for (name, value) in scalars {
            lines += &format!("{step},{name},{value}\n");
            records.extend(record(&event(now(), step, &summary(name, *value))));
        }
        self.csv.write_all(lines.as_bytes())?;
        self.events.write_all(&records)
    }
}

fn now() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
}

fn masked(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
        .rotate_right(15)
        .wrapping_add(0xa282_ead8)
}

fn record(content: &[u8]) -> Vec<u8> {
    let length = (content.len() as u64).to_le_bytes();
    let mut record = length.to_vec();
    record.extend(masked(&length).to_le_bytes());
    record.extend(content);
    record.extend(masked(content).to_le_bytes());
    record
}

/// `Event { double wall_time = 1; int64 step = 2; … }` with one more field.
fn event(time: f64, step: u64, field: &[u8]) -> Vec<u8> {
    let mut event = vec![1 << 3 | 1];
    event.extend(time.to_le_bytes());
    event.push(2 << 3);
    varint(step, &mut event);
    event.extend(field);
    event
}

/// `string file_version = 3`.
fn version() -> Vec<u8> {
    bytes(3, b"brain.Event:2")
}

/// `Summary summary = 5` with `repeated Value value = 1 { string tag = 1; float simple_value = 2 }`.
fn summary(tag: &str, value: f32) -> Vec<u8> {
    let mut content = bytes(1, tag.as_bytes());
    content.push(2 << 3 | 5);
    content.extend(value.to_le_bytes());
    bytes(5, &bytes(1, &content))
}

fn bytes(field: u8, content: &[u8]) -> Vec<u8> {
    let mut bytes = vec![field << 3 | 2];
    varint(content.len() as u64, &mut bytes);
    bytes.extend(content);
    bytes
}

fn varint(mut value: u64, to: &mut Vec<u8>) {
    while value >= 0x80 {
        to.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    to.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_framed_as_tensorflow_frames_them() {
        // The check value of CRC-32C, and the mask of TensorFlow's crc32c.h.
        assert_eq!(CRC.checksum(b"123456789"), 0xe306_9283);
        let record = record(b"abc");
        assert_eq!(record[..8], 3_u64.to_le_bytes());
        assert_eq!(record.len(), 8 + 4 + 3 + 4);
        // That check value, turned right by 15 bits, and 0xa282_ead8 added.
        assert_eq!(masked(b"123456789"), 0xc78a_b0e5);
    }

    #[test]
    fn scalars_reach_both_files_and_appending_keeps_the_old_ones() {
        let folder = tempfile::tempdir().unwrap();
        Log::open(folder.path(), false)
            .unwrap()
            .add(3, &[("loss", 0.5)])
            .unwrap();
        Log::open(folder.path(), true)
            .unwrap()
            .add(300, &[("loss", 0.25)])
            .unwrap();
        let csv = std::fs::read_to_string(folder.path().join("scalars.csv")).unwrap();
        assert_eq!(csv, "step,name,value\n3,loss,0.5\n300,loss,0.25\n");
        let events = std::fs::read(folder.path().join("events.out.tfevents.0.cede")).unwrap();
        let (mut rest, mut records) = (events.as_slice(), 0);
        while let Some((length, tail)) = rest.split_first_chunk::<8>() {
            let length = usize::try_from(u64::from_le_bytes(*length)).unwrap();
            assert_eq!(
                tail[4 + length..][..4],
                masked(&tail[4..][..length]).to_le_bytes()
            );
            rest = &tail[length + 8..];
            records += 1;
        }
        assert_eq!((records, rest.len()), (3, 0));
    }
}
