//! The scene description (TOML) of a synthetic site: which tracks meet there.

use super::layout::{CENTRE, Layout, Movement};
use super::plan::{files_of, in_test, in_validation};
use crate::Site;
use crate::role::Manoeuvre;
use std::fmt::Write;
use std::path::Path;

/// Names of the arms, in the layout's order.
pub(super) const ARMS: [&str; 4] = ["E", "N", "W", "S"];

impl Layout {
    /// The site as the extraction knows it.
    pub(super) fn site(&self) -> Site {
        // The description is ours and its tests read it; headings would serve if it were wrong.
        let parsed = Site::parse(Path::new(&self.name), &self.description());
        parsed.unwrap_or_else(|_| Site::by_headings(&self.name))
    }

    /// The scene description, as `Site::named` reads it from a file.
    pub(super) fn description(&self) -> String {
        let mut text = format!(
            "# A synthetic site. Its conflicts name the vehicle that has to give way first.\n\n\
             name = \"{0}\"\nfolder = \"{0}\"\n",
            self.name
        );
        let _ = writeln!(
            text,
            "\n# Numbers of the recording files; a file that is in none of the lists is for training.\n\
             [split]\nvalidation = {:?}\ntest = {:?}",
            files_of(self.number)
                .filter(|&file| in_validation(file))
                .collect::<Vec<_>>(),
            files_of(self.number)
                .filter(|&file| in_test(file))
                .collect::<Vec<_>>(),
        );
        for (arm, name) in self.arms.iter().zip(ARMS) {
            let (along, main, side) = if arm.outward.x.abs() > arm.outward.y.abs() {
                (arm.outward.x.signum(), "x", "y")
            } else {
                (arm.outward.y.signum(), "y", "x")
            };
            // Beyond the line along the arm, and no farther aside than its tilt takes it.
            let beyond = if along > 0.0 { "above" } else { "below" };
            let at = CENTRE.x + along * (arm.line - 3.0);
            let aside = 8.0 + 0.2 * arm.edge;
            let (low, high) = (CENTRE.x - aside, CENTRE.x + aside);
            let _ = write!(
                text,
                "\n[[arm]]\nname = \"{name}\"\n{beyond}_{main} = {at:.2}\nabove_{side} = {low:.2}\nbelow_{side} = {high:.2}\n"
            );
        }
        for movement in &self.movements {
            let manoeuvre = match movement.manoeuvre {
                Manoeuvre::Left => "left",
                Manoeuvre::Straight => "straight",
                Manoeuvre::Right => "right",
                Manoeuvre::Unknown => "unknown",
            };
            let way = way(movement);
            let _ = write!(
                text,
                "\n[[movement]]\nway = {way}\nmanoeuvre = \"{manoeuvre}\"\n"
            );
        }
        for conflict in &self.conflicts {
            let _ = write!(
                text,
                "\n[[conflict]]\nleft = {}\nother = {}\nkind = \"{}\"\n",
                way(&self.movements[conflict.yielding]),
                way(&self.movements[conflict.other]),
                conflict.kind,
            );
        }
        text
    }
}

fn way(movement: &Movement) -> String {
    format!(
        "{{ from = \"{}\", to = \"{}\" }}",
        ARMS[movement.from], ARMS[movement.to]
    )
}
