//! The policy that comes with the program: trained on synthetic scenarios alone.
//!
//! `assets/embedded.txt` says how it was made and by which command it is made again.

/// The words of its weights file, for [`Policy::new`](crate::Policy::new).
#[must_use]
pub fn words() -> &'static [u32] {
    crate::include_weights!("../../assets/embedded.cede")
}

/// The same policy in integers, for cores without an FPU: what `cede export --quantise i16` makes of it.
#[must_use]
pub fn words_i16() -> &'static [u32] {
    crate::include_weights!("../../assets/embedded-i16.cede")
}

#[cfg(test)]
mod tests {
    use crate::{FeatureSet, Perspective, Policy};

    #[test]
    fn the_embedded_policy_is_sound() {
        for words in [super::words(), super::words_i16()] {
            let policy = Policy::new(words).unwrap();
            assert_eq!(policy.weights().features(), FeatureSet::Rights);
            assert_eq!(policy.weights().perspective(), Perspective::Ego);
        }
    }
}
