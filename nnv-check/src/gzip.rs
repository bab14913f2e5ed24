//! Files that are packed with gzip, as the competition's are.

use flate2::read::MultiGzDecoder;
use std::borrow::Cow;
use std::io::{self, Read as _};

/// The most bytes that a file may unpack to: 2³⁰.
const MOST_BYTES: u64 = 1 << 30;

/// The file's content: unpacked if it begins as a gzip file does, else as it is.
pub(crate) fn unpacked(bytes: &[u8]) -> io::Result<Cow<'_, [u8]>> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut content = Vec::new();
    let mut packed = MultiGzDecoder::new(bytes).take(MOST_BYTES + 1);
    packed.read_to_end(&mut content)?;
    if content.len() as u64 > MOST_BYTES {
        let what = format!("unpacks to more than {MOST_BYTES} (2³⁰) bytes");
        return Err(io::Error::new(io::ErrorKind::InvalidData, what));
    }
    Ok(Cow::Owned(content))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write as _;

    #[test]
    fn packed_and_plain_files_have_the_same_content() {
        let mut packer = GzEncoder::new(Vec::new(), Compression::default());
        packer.write_all(b"(assert (or))").expect("memory");
        let packed = packer.finish().expect("memory");
        let content = unpacked(&packed).expect("a gzip file");
        assert_eq!(&*content, b"(assert (or))");
        assert_eq!(&*unpacked(b"(assert (or))").expect("plain"), &*content);
        assert!(unpacked(&packed[..packed.len() / 2]).is_err(), "cut off");
    }
}
