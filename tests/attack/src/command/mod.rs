//! The commands, one file each; each says whether the shield held.

pub(crate) mod outside;
pub(crate) mod replay;
pub(crate) mod run;
pub(crate) mod sharp;
pub(crate) mod zones;

use cede_attack::scenario::{FAMILIES, Family};

/// Prints the families.
pub(crate) fn families() -> bool {
    for family in FAMILIES {
        println!("{:14} {}", family.name, family.about);
    }
    true
}

/// A family by its name, for clap.
fn family(name: &str) -> Result<&'static Family, String> {
    let names = || FAMILIES.iter().map(|family| family.name);
    Family::named(name).ok_or_else(|| {
        let names: Vec<&str> = names().collect();
        format!("none of {}", names.join(", "))
    })
}

/// A count that may be written as 2e8.
fn count(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(number) if (1.0..1e18).contains(&number) => Ok(number as u64),
        _ => Err("not a positive number".into()),
    }
}
