//! The table on stdout, with the paper's rows for comparison.

use crate::plural::Count;
use cede_sim::evaluate::{ConfidenceInterval, TableRow};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};

/// The paper's Table II for the site EP0: driver, split, n, priority accuracy,
/// episode length error, collisions.
pub(crate) const PAPER: [(&str, &str, usize, f64, f64, usize); 6] = [
    ("paper: BC", "train", 215, 0.7209, 0.5540, 1),
    ("paper: SACER-V", "train", 215, 0.6465, 0.2462, 4),
    ("paper: SACER-SVO", "train", 215, 0.8186, 0.3835, 1),
    ("paper: BC", "test", 17, 0.6471, 0.5759, 0),
    ("paper: SACER-V", "test", 17, 0.7646, 0.3843, 1),
    ("paper: SACER-SVO", "test", 17, 0.9412, 0.3078, 0),
];

const HEADER: [&str; 12] = [
    "driver",
    "n",
    "priority accuracy",
    "length error",
    "in s",
    "collisions",
    "time-outs",
    "RMSE 3 s",
    "SVO RMSE",
    "TTC < 1.5 s",
    "jerk",
    "shielded",
];

/// What is told of one vehicle under test alone.
const EGO_HEADER: [&str; 2] = ["went first", "delay"];

/// The rows of `rows` in blocks of equal site, split, mode, end and shield, with the paper's rows in the
/// blocks that follow its protocol on its site.
pub(crate) fn render(rows: &[TableRow]) -> String {
    let mut table = Table::new();
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_content_arrangement(ContentArrangement::Disabled);
    let mut text = String::new();
    for block in rows.chunk_by(|a, b| block_of(a) == block_of(b)) {
        let mut table = table.clone();
        let alone = block.iter().any(|row| row.mode == "ego");
        table.set_header(
            HEADER
                .iter()
                .chain(if alone { &EGO_HEADER[..] } else { &[] }),
        );
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        for row in block {
            let ego = if alone {
                ego_cells(row).to_vec()
            } else {
                vec![]
            };
            table.add_row(cells(row).into_iter().chain(ego));
        }
        if let Some(first) = block.first() {
            let protocol = (
                first.site.as_str(),
                first.mode.as_str(),
                first.until.as_str(),
            );
            if protocol == ("EP0", "joint", "conflict") {
                for row in PAPER.iter().filter(|row| row.1 == first.split) {
                    table.add_row(paper_cells(*row));
                }
            }
            text += &format!("{}\n{table}\n\n", heading(first));
        }
    }
    text
}

/// One row a driver for the first protocol of `rows`, without the shield beside behind it; Cede first, baselines after.
pub(crate) fn compact(rows: &[TableRow]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let protocol = |row: &&TableRow| {
        (&row.site, &row.split, &row.mode, &row.until)
            == (&first.site, &first.split, &first.mode, &first.until)
    };
    let same: Vec<&TableRow> = rows.iter().filter(protocol).collect();
    let mut alone: Vec<&TableRow> = same
        .iter()
        .filter(|row| row.shield == "off")
        .copied()
        .collect();
    alone.sort_by_key(|row| row.driver != "cede");
    let mut table = Table::new();
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header([
            "driver (without → with shield)",
            "priority accuracy",
            "length error",
            "collisions",
            "time-outs",
        ]);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    for row in alone {
        let shielded = same
            .iter()
            .find(|it| it.driver == row.driver && it.shield != "off");
        let both = |show: &dyn Fn(&TableRow) -> String| {
            let behind = shielded.map_or_else(String::new, |it| show(it));
            format!("{} → {behind}", show(row))
        };
        table.add_row([
            row.driver.clone(),
            both(&|it| percent(it.priority_accuracy)),
            both(&|it| number(it.episode_length_error, 3, "")),
            both(&|it| it.collisions.to_string()),
            both(&|it| it.time_outs.to_string()),
        ]);
    }
    let n = Count(first.encounters, "encounter");
    format!(
        "{}: {n}, {} mode, until {}\n{table}\n",
        first.split, first.mode, first.until
    )
}

fn block_of(row: &TableRow) -> (&str, &str, &str, &str, &str) {
    (&row.site, &row.split, &row.mode, &row.until, &row.shield)
}

fn heading(row: &TableRow) -> String {
    let TableRow {
        site,
        split,
        mode,
        until,
        shield,
        encounters,
        ..
    } = row;
    let encounters = Count(*encounters, "encounter");
    format!("{site}, {split}: {encounters}, {mode} mode, until {until}, shield {shield}")
}

fn cells(row: &TableRow) -> [String; 12] {
    [
        row.driver.clone(),
        row.n.to_string(),
        share(row.priority_accuracy, row.priority_accuracy_interval),
        number(row.episode_length_error, 3, ""),
        number(row.episode_length_error_s, 2, " s"),
        row.collisions.to_string(),
        row.time_outs.to_string(),
        number(row.position_rmse_3s, 2, " m"),
        number(row.svo_rmse, 2, " rad"),
        percent(row.critical_ttc_share),
        number(row.jerk_rms, 1, " m/s³"),
        percent(row.shielded_steps),
    ]
}

fn ego_cells(row: &TableRow) -> [String; 2] {
    let range = row
        .delay_s_interval_by_file
        .map(|[low, high]| format!(" [{low:.2}, {high:.2}]"));
    [
        share(row.went_first, row.went_first_interval),
        number(row.delay_s, 2, " s") + &range.unwrap_or_default(),
    ]
}

fn paper_cells(row: (&str, &str, usize, f64, f64, usize)) -> Vec<String> {
    let (driver, _, n, accuracy, length, collisions) = row;
    vec![
        driver.to_owned(),
        n.to_string(),
        percent(Some(accuracy)),
        number(Some(length), 3, ""),
        String::new(),
        collisions.to_string(),
    ]
}

fn number(value: Option<f64>, digits: usize, unit: &str) -> String {
    value.map_or_else(|| "–".to_owned(), |x| format!("{x:.digits$}{unit}"))
}

fn percent(value: Option<f64>) -> String {
    number(value.map(|x| 100.0 * x), 1, " %")
}

fn share(value: Option<f64>, interval: Option<ConfidenceInterval>) -> String {
    let range = interval.map(|[low, high]| format!(" [{:.0}, {:.0}]", 100.0 * low, 100.0 * high));
    percent(value) + &range.unwrap_or_default()
}
