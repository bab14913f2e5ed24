//! What a table of results says of Cede, in a sentence.

use crate::plural::Count;
use cede_sim::evaluate::TableRow;

/// What the shield does for driver `cede` in the first protocol of `rows`; none without both.
pub(crate) fn sentence(rows: &[TableRow]) -> Option<String> {
    let first = rows.first()?;
    let same = |row: &&TableRow| {
        row.driver == "cede"
            && (&row.site, &row.split, &row.mode, &row.until)
                == (&first.site, &first.split, &first.mode, &first.until)
    };
    let mut cede = rows.iter().filter(same);
    let alone = cede.clone().find(|row| row.shield == "off")?;
    let shielded = cede.find(|row| row.shield != "off")?;
    let percent = |row: &TableRow| row.priority_accuracy.map(|share| 100.0 * share);
    Some(format!(
        "Cede behind its shield: {} in {} ({} without it); who goes first is as recorded in {:.0} % of them ({:.0} % without it).",
        Count(shielded.collisions, "collision"),
        Count(shielded.encounters, "encounter"),
        alone.collisions,
        percent(shielded)?,
        percent(alone)?,
    ))
}
