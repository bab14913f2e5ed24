//! One line per episode: CSV for spreadsheets, Parquet for data frames.

use crate::failure::Failure;
use cede_data::{Role, output};
use cede_sim::episode::End;
use cede_sim::evaluate::{Drive, TableRow};
use parquet::errors::ParquetError;
use parquet::file::writer::SerializedFileWriter;
use parquet::record::RecordWriter;
use parquet_derive::ParquetRecordWriter;
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

/// A file for the episodes; its extension gives the format.
#[derive(Clone, Debug)]
pub(crate) struct EpisodeFile {
    path: PathBuf,
    format: Format,
}

#[derive(Clone, Copy, Debug)]
enum Format {
    Csv,
    Parquet,
}

impl FromStr for EpisodeFile {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let path = PathBuf::from(text);
        let format = match path.extension().and_then(|ending| ending.to_str()) {
            Some("csv") => Format::Csv,
            Some("parquet") => Format::Parquet,
            _ => return Err("the file's name has to end in .csv or .parquet"),
        };
        Ok(Self { path, format })
    }
}

impl EpisodeFile {
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes `records`. An earlier file stays unless all of them are written.
    pub(crate) fn write(&self, records: &[Record]) -> Result<(), Failure> {
        output::write(&self.path, |file| match self.format {
            Format::Csv => write_csv(file, records),
            Format::Parquet => write_parquet(file, records).map_err(io::Error::other),
        })?;
        Ok(())
    }
}

/// One episode. Fields are empty where the episode does not define them. Units are those in the names;
/// positions are in m, angles in rad.
#[derive(Serialize, ParquetRecordWriter)]
pub(crate) struct Record {
    driver: String,
    split: String,
    mode: String,
    until: String,
    shield: String,
    site: String,
    file: i32,
    left_track: i64,
    other_track: i64,
    kind: String,
    ego: Option<String>,
    end: String,
    correct: bool,
    recorded_first: String,
    first: Option<String>,
    recorded_steps: i32,
    steps: i32,
    length_error: f64,
    length_error_s: f64,
    position_rmse_1s: Option<f64>,
    position_rmse_3s: Option<f64>,
    position_rmse_5s: Option<f64>,
    position_rmse: f64,
    svo_rmse: Option<f64>,
    pet_error_s: Option<f64>,
    min_ttc_s: Option<f64>,
    jerk_rms: Option<f64>,
    shielded_steps: f64,
}

/// The episodes of `row`.
pub(crate) fn records(row: &TableRow, drives: &[Drive<'_>]) -> impl Iterator<Item = Record> {
    drives.iter().map(|drive| record(row, drive))
}

fn record(row: &TableRow, drive: &Drive<'_>) -> Record {
    let Drive {
        encounter,
        ego,
        episode,
        measures,
    } = drive;
    Record {
        driver: row.driver.clone(),
        split: row.split.clone(),
        mode: row.mode.clone(),
        until: row.until.clone(),
        shield: row.shield.clone(),
        site: encounter.id.site.clone(),
        file: encounter.id.file.into(),
        left_track: encounter.id.left.into(),
        other_track: encounter.id.other.into(),
        kind: format!("{:?}", encounter.kind).to_lowercase(),
        ego: ego.map(role),
        end: end(episode.end).to_owned(),
        correct: measures.correct,
        recorded_first: role(encounter.first),
        first: episode.first().map(role),
        recorded_steps: encounter.steps.try_into().unwrap_or(i32::MAX),
        steps: measures.length.try_into().unwrap_or(i32::MAX),
        length_error: measures.length_error,
        length_error_s: measures.length_error_s,
        position_rmse_1s: measures.position_error[0],
        position_rmse_3s: measures.position_error[1],
        position_rmse_5s: measures.position_error[2],
        position_rmse: measures.position_rmse,
        svo_rmse: measures.svo_rmse,
        pet_error_s: measures.pet_error,
        min_ttc_s: measures.min_ttc,
        jerk_rms: measures.jerk,
        shielded_steps: measures.shielded,
    }
}

fn role(role: Role) -> String {
    match role {
        Role::Left => "left",
        Role::Other => "other",
    }
    .to_owned()
}

const fn end(end: End) -> &'static str {
    match end {
        End::Finished => "finished",
        End::Collision => "collision",
        End::TimeOut => "time-out",
    }
}

fn write_csv(file: &mut dyn Write, records: &[Record]) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(file);
    for record in records {
        writer.serialize(record).map_err(io::Error::other)?;
    }
    writer.flush()
}

fn write_parquet(file: &mut dyn Write, records: &[Record]) -> Result<(), ParquetError> {
    // The Parquet writer needs an owned `Send` sink. The file is small enough to be built in memory.
    let schema = records.schema()?;
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::default())?;
    let mut group = writer.next_row_group()?;
    records.write_to_row_group(&mut group)?;
    group.close()?;
    file.write_all(&writer.into_inner()?)?;
    Ok(())
}
