//! A CSV file as typed rows, with errors that name line and column.

use super::error::{DataError, Problem};
use csv::{ByteRecord, Position};
use serde::Deserialize;
use std::path::Path;

/// A CSV file in memory; the INTERACTION files have some megabytes.
pub(crate) struct Table<'p> {
    path: &'p Path,
    bytes: Vec<u8>,
}

/// A file format: what its header must hold.
pub(crate) struct Format {
    /// Columns without which a row makes no sense.
    pub(crate) required: &'static [&'static str],
    /// What to tell whoever left one out.
    pub(crate) mend: &'static str,
}

/// Where a row is, for messages.
#[derive(Clone, Copy)]
pub(crate) struct Place<'p> {
    path: &'p Path,
    pub(crate) line: u64,
    /// The file's last line, and it has no line break: it may have been cut off.
    pub(crate) cut: bool,
}

impl Place<'_> {
    pub(crate) fn error(&self, problem: Problem) -> DataError {
        DataError::new(self.path, problem).at_line(self.line)
    }

    /// `value`, if it is finite.
    pub(crate) fn finite(&self, column: &str, value: f64) -> Result<f64, DataError> {
        self.check(column, value, f64::is_finite, Problem::NotFinite)
    }

    /// `value`, if it is a coordinate that single precision resolves to a millimetre.
    pub(crate) fn coordinate(&self, column: &str, value: f64) -> Result<f64, DataError> {
        let near = |c: f64| c.abs() <= 8192.0;
        self.check(column, self.finite(column, value)?, near, Problem::TooFar)
    }

    /// `value`, if it is a length.
    pub(crate) fn positive(&self, column: &str, value: f64) -> Result<f64, DataError> {
        let positive = |l: f64| l > 0.0;
        self.check(
            column,
            self.finite(column, value)?,
            positive,
            Problem::NotPositive,
        )
    }

    /// `value`, if it is a time.
    pub(crate) fn time(&self, column: &str, value: f64) -> Result<f64, DataError> {
        let within = |t: f64| (0.0..=1e9).contains(&t);
        self.check(column, self.finite(column, value)?, within, Problem::Time)
    }

    fn check(
        &self,
        column: &str,
        value: f64,
        holds: impl Fn(f64) -> bool,
        problem: impl Fn(f64) -> Problem,
    ) -> Result<f64, DataError> {
        if holds(value) {
            return Ok(value);
        }
        Err(self.error(problem(value)).in_column(column))
    }
}

impl<'p> Table<'p> {
    pub(crate) fn read(path: &'p Path) -> Result<Self, DataError> {
        let bytes = std::fs::read(path)
            .map_err(|error| DataError::new(path, Problem::Unreadable(error)))?;
        Ok(Self { path, bytes })
    }

    /// Hands every row to `each`.
    pub(crate) fn for_each<R: for<'r> Deserialize<'r>>(
        &self,
        format: &Format,
        mut each: impl FnMut(Place<'_>, R) -> Result<(), DataError>,
    ) -> Result<(), DataError> {
        let path = self.path;
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(self.bytes.as_slice());
        let header = reader
            .byte_headers()
            .map_err(|error| self.unreadable(error))?
            .clone();
        self.check_header(&header, format)?;
        let ended = self.bytes.ends_with(b"\n");
        let end = self.bytes.len() as u64;
        let mut record = ByteRecord::new();
        let mut rows = 0_u64;
        while reader
            .read_byte_record(&mut record)
            .map_err(|error| self.unreadable(error))?
        {
            let place = Place {
                path,
                line: record.position().map_or(0, Position::line),
                cut: !ended && reader.position().byte() >= end,
            };
            each(place, typed(place, &record, &header)?)?;
            rows += 1;
        }
        if rows == 0 {
            return Err(DataError::new(path, Problem::Empty));
        }
        Ok(())
    }

    /// Whether `word` stands anywhere in the file.
    pub(crate) fn mentions(&self, word: &str) -> bool {
        self.bytes
            .windows(word.len())
            .any(|window| window == word.as_bytes())
    }

    fn check_header(&self, header: &ByteRecord, format: &Format) -> Result<(), DataError> {
        if header.is_empty() {
            return Err(DataError::new(self.path, Problem::Empty));
        }
        let has = |name: &str| header.iter().any(|column| column == name.as_bytes());
        match format.required.iter().find(|name| !has(name)) {
            None => Ok(()),
            Some(name) => {
                let mend = format.mend;
                let problem = Problem::MissingColumn { name, mend };
                Err(DataError::new(self.path, problem).at_line(1))
            }
        }
    }

    fn unreadable(&self, error: csv::Error) -> DataError {
        DataError::new(self.path, Problem::Unreadable(error.into()))
    }
}

fn typed<R: for<'r> Deserialize<'r>>(
    place: Place<'_>,
    record: &ByteRecord,
    header: &ByteRecord,
) -> Result<R, DataError> {
    let (expected, found) = (header.len(), record.len());
    if found < expected && place.cut {
        return Err(place.error(Problem::Truncated));
    }
    if found != expected {
        return Err(place.error(Problem::FieldCount { expected, found }));
    }
    record.deserialize(Some(header)).map_err(|error| {
        if place.cut {
            return place.error(Problem::Truncated);
        }
        let field = match error.kind() {
            csv::ErrorKind::Deserialize { err, .. } => err.field(),
            _ => None,
        };
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let field = field.and_then(|i| usize::try_from(i).ok());
        let at = |record: &ByteRecord| field.and_then(|i| record.get(i)).map(text);
        let value = at(record).unwrap_or_default();
        let problem = match error.kind() {
            _ if value.is_empty() => Problem::EmptyField,
            csv::ErrorKind::Deserialize { err, .. } if is_whole(err) => Problem::NotWhole(value),
            _ => Problem::NotANumber(value),
        };
        place
            .error(problem)
            .in_column(&at(header).unwrap_or_default())
    })
}

/// Whether a whole number should have stood there.
fn is_whole(error: &csv::DeserializeError) -> bool {
    matches!(error.kind(), csv::DeserializeErrorKind::ParseInt(_))
}
