//! Why words are not a network.

/// Why words are not a weights file, or a draft cannot become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum WeightsError {
    /// It does not begin with the letters `CEDE`.
    Magic,
    /// The checksum does not fit: a bit has changed.
    Checksum,
    /// A version, feature set, perspective or kind of numbers that this program does not know.
    Unknown,
    /// The number of words does not fit the layers' sizes, or the sizes are out of range.
    Shape,
    /// A number is not finite or too large.
    OutOfRange,
    /// The buffer that it is to be written to is too short.
    NoRoom,
    /// A sum of a network of integers could exceed 32 bits.
    Overflow,
}

impl core::fmt::Display for WeightsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Magic => "not a weights file: it does not begin with CEDE",
            Self::Checksum => "the checksum does not fit: the file is damaged",
            Self::Unknown => {
                "a version, feature set, perspective or kind of numbers that this program does not know; if the file is older, train or import it again"
            }
            Self::Shape => "the layers' sizes do not fit the file's length or the limits",
            Self::OutOfRange => "a weight is not finite or too large",
            Self::NoRoom => "the buffer is too short for the weights",
            Self::Overflow => {
                "a sum of the integer network could exceed 32 bits: quantise it with fewer fractional bits"
            }
        })
    }
}

impl core::error::Error for WeightsError {}
