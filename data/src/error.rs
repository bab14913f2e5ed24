//! What can be wrong with the input: where, what, and how to mend it.

use std::path::{Path, PathBuf};

/// An input file that cannot be used; prints as `file:line: column x: what is wrong`.
#[derive(Debug, thiserror::Error)]
#[error("{}{problem}", place(.path, *.line, .column.as_deref()))]
pub struct DataError {
    /// The file or folder.
    pub path: PathBuf,
    /// Line, counted from 1, if one is to blame.
    pub line: Option<u64>,
    /// Name of the column, if one is to blame.
    pub column: Option<String>,
    /// What is wrong there.
    pub problem: Problem,
}

fn place(path: &Path, line: Option<u64>, column: Option<&str>) -> String {
    let mut place = path.display().to_string();
    if let Some(line) = line {
        place += &format!(":{line}");
    }
    if let Some(column) = column {
        place += &format!(": column `{column}`");
    }
    place + ": "
}

impl DataError {
    /// A problem with a whole file or folder.
    pub(crate) fn new(path: &Path, problem: Problem) -> Self {
        Self {
            path: path.to_owned(),
            line: None,
            column: None,
            problem,
        }
    }

    pub(crate) fn at_line(mut self, line: u64) -> Self {
        self.line = Some(line);
        self
    }

    pub(crate) fn in_column(mut self, column: &str) -> Self {
        self.column = Some(column.to_owned());
        self
    }

    /// What the user can do about it, in one sentence.
    #[must_use]
    pub fn mend(&self) -> &'static str {
        self.problem.mend()
    }
}

/// What is wrong with an input file.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The operating system does not give the file.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// The folder holds no recording.
    #[error("no recorded tracks of site {site} here")]
    NoRecordings {
        /// The site that was asked for.
        site: String,
    },
    /// The folder holds no folder of recordings.
    #[error("no folder with recorded tracks here")]
    NoSites,
    /// A file without rows.
    #[error("no rows")]
    Empty,
    /// The header lacks a column.
    #[error("the header lacks the column `{name}`")]
    MissingColumn {
        /// The column.
        name: &'static str,
        /// What the header should be.
        mend: &'static str,
    },
    /// A pedestrian file where a vehicle file belongs.
    #[error("these are tracks of pedestrians: no heading, no length, no width")]
    Pedestrians,
    /// A row with too few or too many fields.
    #[error("{found} fields where the header has {expected}")]
    FieldCount {
        /// Number of columns in the header.
        expected: usize,
        /// Number of fields in the row.
        found: usize,
    },
    /// The file ends in the middle of its last line.
    #[error("the file ends in the middle of this line")]
    Truncated,
    /// A field without a value.
    #[error("the field is empty")]
    EmptyField,
    /// A field that is not a number.
    #[error("`{0}` is not a number")]
    NotANumber(String),
    /// A field that is not a whole number in range.
    #[error("`{0}` is not a whole number from 0 on")]
    NotWhole(String),
    /// NaN or infinite.
    #[error("{0} is not a finite number")]
    NotFinite(f64),
    /// A coordinate too far from the origin to be resolved to millimetres.
    #[error("{0} m is farther than 8192 m from the origin")]
    TooFar(f64),
    /// A time that no recording has.
    #[error("a time must be from 0 to 1,000,000,000 s, not {0} s")]
    Time(f64),
    /// A vehicle without extent.
    #[error("a vehicle's length and width must be positive, not {0} m")]
    NotPositive(f64),
    /// A track's rows are not in the order of time.
    #[error("time goes backwards: track {track} is at {now} ms after {before} ms")]
    TimeBackwards {
        /// The track.
        track: u32,
        /// Time of the row before, in ms.
        before: u64,
        /// Time of this row, in ms.
        now: u64,
    },
    /// Two rows of one track at one time.
    #[error("duplicate row: track {track} already has a row at {time} ms")]
    Duplicate {
        /// The track.
        track: u32,
        /// The time that occurs twice, in ms.
        time: u64,
    },
    /// A hole in a track that is too long to be bridged.
    #[error("hole in track {track}: nothing between {before} ms and {now} ms")]
    Hole {
        /// The track.
        track: u32,
        /// Last time before the hole, in ms.
        before: u64,
        /// First time after the hole, in ms.
        now: u64,
    },
    /// The site description is not valid.
    #[error("not a site description: {0}")]
    Site(String),
    /// The map is not valid.
    #[error("not a Lanelet2 map: {0}")]
    Map(String),
    /// The scenario is not valid.
    #[error("not a CommonRoad scenario of version 2020a: {0}")]
    Scenario(String),
}

impl Problem {
    fn mend(&self) -> &'static str {
        match self {
            Self::Unreadable(_) => "check the path and that you may read it",
            Self::NoRecordings { .. } => {
                "name the folder that holds the site's vehicle_tracks_NNN.csv, or its parent, and the site with --site"
            }
            Self::NoSites => {
                "name the folder that holds the sites' folders, or one site with --site"
            }
            Self::Empty => "restore the file from its source",
            Self::MissingColumn { mend, .. } => mend,
            Self::Pedestrians => {
                "name it pedestrian_tracks_NNN.csv, and it is passed over; only vehicles are judged"
            }
            Self::FieldCount { .. } => {
                "give the row one field for each column of the header; check for stray commas"
            }
            Self::Truncated => "copy the file anew from its source, or delete its last line",
            Self::EmptyField => "fill in the value, or delete the row",
            Self::NotANumber(_) => {
                "write a plain decimal number in SI units, with a point, as in 1012.35"
            }
            Self::NotWhole(_) => "write a plain whole number, without sign, point or letters",
            Self::NotFinite(_) => "delete the row, or fill it by interpolation",
            Self::TooFar(_) => {
                "subtract a common offset from all coordinates of the site and its map"
            }
            Self::Time(_) => "subtract the first time from all times",
            Self::NotPositive(_) => "give the vehicle's size in metres",
            Self::TimeBackwards { .. } => "sort the rows of each track by time",
            Self::Duplicate { .. } => "delete one of the two rows",
            Self::Hole { .. } => {
                "give the part after the hole a track number of its own; holes up to 1 s are interpolated"
            }
            Self::Site(_) => "compare with data/src/sites/EP0.toml",
            Self::Scenario(_) => {
                "restore the file from its source, or convert it to version 2020a; the vehicles need exact states"
            }
            Self::Map(_) => {
                "restore the map from its source, or remove it: it serves for drawing and rights of way, nothing else"
            }
        }
    }
}
