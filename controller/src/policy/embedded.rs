//! The policy that comes with the program: trained on synthetic scenarios alone.
//!
//! `assets/embedded.txt` says how it was made and by which command it is made again.

/// The words of its weights file, for [`Policy::new`](crate::Policy::new).
#[must_use]
pub fn words() -> &'static [u32] {
    crate::include_weights!("../../assets/embedded.cede")
}

#[cfg(test)]
mod tests {
    use crate::{FeatureSet, Perspective, Policy};

    #[test]
    fn the_embedded_policy_is_sound() {
        let policy = Policy::new(super::words()).unwrap();
        assert_eq!(policy.weights().features(), FeatureSet::Rights);
        assert_eq!(policy.weights().perspective(), Perspective::Ego);
    }
}
