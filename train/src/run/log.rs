//! Files for plots: `scalars.csv` and TensorBoard's event file, with one line and one event per scalar.
//!
//! An event file is a TFRecord file of protobuf messages. A record consists of the message's length
//! (u64, little-endian), the length's checksum, the message, and the message's checksum. Checksums
//! are masked CRC-32C. Both files are appended to, so they can be read during the run.

use crc::{CRC_32_ISCSI, Crc};
use prost::Message;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// The fields of `tensorflow.Event` that TensorBoard needs for scalars.
#[derive(Clone, PartialEq, Message)]
struct Event {
    /// Seconds since 1970.
    #[prost(double, tag = "1")]
    wall_time: f64,
    #[prost(int64, tag = "2")]
    step: i64,
    #[prost(oneof = "What", tags = "3, 5")]
    what: Option<What>,
}

#[derive(Clone, PartialEq, prost::Oneof)]
enum What {
    /// In the first event of a file.
    #[prost(string, tag = "3")]
    FileVersion(String),
    #[prost(message, tag = "5")]
    Summary(Summary),
}

/// `tensorflow.Summary`.
#[derive(Clone, PartialEq, Message)]
struct Summary {
    #[prost(message, repeated, tag = "1")]
    value: Vec<Value>,
}

/// `tensorflow.Summary.Value`. The value is a member of a oneof, so it is written even if it is 0.
#[derive(Clone, PartialEq, Message)]
struct Value {
    #[prost(string, tag = "1")]
    tag: String,
    #[prost(float, optional, tag = "2")]
    simple_value: Option<f32>,
}

/// Both files, open.
#[derive(Debug)]
pub struct Log {
    csv: File,
    events: File,
}

impl Log {
    /// Opens `scalars.csv` and `events.out.tfevents.0.cede` in `folder`, and creates the folder if it
    /// does not exist. Keeps the content of the files if `append`, otherwise clears them.
    ///
    /// # Errors
    /// The folder or a file cannot be written.
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
            let version = What::FileVersion("brain.Event:2".to_owned());
            log.events.write_all(&record(&event(0, version)))?;
        }
        Ok(log)
    }

    /// Appends the scalars of `step`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn add(&mut self, step: u64, scalars: &[(&str, f32)]) -> io::Result<()> {
        let (mut lines, mut records) = (String::new(), Vec::new());
        for (name, value) in scalars {
            lines += &format!("{step},{name},{value}\n");
            records.extend(record(&event(step, scalar(name, *value))));
        }
        self.csv.write_all(lines.as_bytes())?;
        self.events.write_all(&records)
    }
}

fn event(step: u64, what: What) -> Event {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    Event {
        wall_time: since.map_or(0.0, |since| since.as_secs_f64()),
        step: i64::try_from(step).unwrap_or(i64::MAX),
        what: Some(what),
    }
}

fn scalar(name: &str, value: f32) -> What {
    What::Summary(Summary {
        value: vec![Value {
            tag: name.to_owned(),
            simple_value: Some(value),
        }],
    })
}

/// The checksum of a TFRecord.
fn masked_crc(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
        .rotate_right(15)
        .wrapping_add(0xa282_ead8)
}

fn record(event: &Event) -> Vec<u8> {
    let message = event.encode_to_vec();
    let length = (message.len() as u64).to_le_bytes();
    let mut record = length.to_vec();
    record.extend(masked_crc(&length).to_le_bytes());
    record.extend(&message);
    record.extend(masked_crc(&message).to_le_bytes());
    record
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The events of a file, whose framing is checked.
    fn events(mut bytes: &[u8]) -> Vec<Event> {
        let mut events = Vec::new();
        while let Some((length, rest)) = bytes.split_first_chunk::<8>() {
            let n = usize::try_from(u64::from_le_bytes(*length)).unwrap();
            assert_eq!(rest[..4], masked_crc(length).to_le_bytes());
            let message = &rest[4..][..n];
            assert_eq!(rest[4 + n..][..4], masked_crc(message).to_le_bytes());
            events.push(Event::decode(message).unwrap());
            bytes = &rest[n + 8..];
        }
        assert!(bytes.is_empty());
        events
    }

    #[test]
    fn the_checksum_is_tensorflows_masked_crc() {
        // The check value of CRC-32C, rotated right by 15 bits, plus 0xa282_ead8 (TensorFlow's crc32c.h).
        assert_eq!(CRC.checksum(b"123456789"), 0xe306_9283);
        assert_eq!(masked_crc(b"123456789"), 0xc78a_b0e5);
    }

    #[test]
    fn an_event_has_the_bytes_of_tensorflows_messages() {
        let event = Event {
            wall_time: 1.0,
            step: 300,
            what: Some(scalar("loss", 0.0)),
        };
        let expected: &[&[u8]] = &[
            b"\x09\0\0\0\0\0\0\xf0\x3f", // 1: double 1.0
            b"\x10\xac\x02",             // 2: varint 300
            b"\x2a\x0d\x0a\x0b",         // 5: summary, 1: value
            b"\x0a\x04loss",             // 1: tag
            b"\x15\0\0\0\0",             // 2: float 0, present
        ];
        assert_eq!(event.encode_to_vec(), expected.concat());
    }

    #[test]
    fn scalars_reach_both_files_and_appending_keeps_the_old_ones() {
        let folder = tempfile::tempdir().unwrap();
        for (step, value) in [(3, 0.5), (300, 0.0)] {
            let mut log = Log::open(folder.path(), step > 3).unwrap();
            log.add(step, &[("loss", value)]).unwrap();
        }
        let csv = std::fs::read_to_string(folder.path().join("scalars.csv")).unwrap();
        assert_eq!(csv, "step,name,value\n3,loss,0.5\n300,loss,0\n");
        let bytes = std::fs::read(folder.path().join("events.out.tfevents.0.cede")).unwrap();
        let [version, first, second] = events(&bytes).try_into().unwrap();
        let named = What::FileVersion("brain.Event:2".to_owned());
        assert_eq!((version.step, version.what), (0, Some(named)));
        assert_eq!((first.step, first.what), (3, Some(scalar("loss", 0.5))));
        assert_eq!((second.step, second.what), (300, Some(scalar("loss", 0.0))));
    }
}
