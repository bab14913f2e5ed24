//! A weights file as part of a program, and the words of one that is read.

#[cfg(doc)]
use super::Weights;

/// The words of a file read as bytes. A length that is no multiple of four gives one word more than
/// it should, so that [`Weights::parse`] refuses it.
pub fn words(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    bytes.chunks(4).map(|chunk| {
        let mut word = [0; 4];
        for (place, &byte) in word.iter_mut().zip(chunk) {
            *place = byte;
        }
        u32::from_le_bytes(word)
    })
}

/// Words on a boundary of 64 bytes, a cache line: where a network runs fastest.
#[repr(C, align(64))]
pub struct Aligned<const N: usize>(pub [u32; N]);

impl<const N: usize> Aligned<N> {
    /// The words of a file at compile time; see [`include_weights!`](crate::include_weights).
    ///
    /// # Panics
    /// If `bytes` is not `4 · N` long: at compile time, when it makes a constant or a static.
    #[must_use]
    pub const fn new(bytes: &[u8]) -> Self {
        let (chunks, rest) = bytes.as_chunks::<4>();
        assert!(
            chunks.len() == N && rest.is_empty(),
            "not a whole number of words"
        );
        let mut words = [0; N];
        let mut i = 0;
        while i < N {
            words[i] = u32::from_le_bytes(chunks[i]);
            i += 1;
        }
        Self(words)
    }
}

/// A weights file as a `&'static [u32]` in read-only memory, for [`Weights::parse`].
///
/// The path is relative to the source file, as in `include_bytes!`.
#[macro_export]
macro_rules! include_weights {
    ($path:expr) => {{
        const BYTES: &[u8] = include_bytes!($path);
        static WORDS: $crate::policy::weights::Aligned<{ BYTES.len() / 4 }> =
            $crate::policy::weights::Aligned::new(BYTES);
        &WORDS.0 as &'static [u32]
    }};
}
