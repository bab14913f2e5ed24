//! The tables of `cede reproduce`: mean ± standard deviation over seeds, confidence intervals, baselines,
//! and the paper's rows.

use crate::table::PAPER;
use cede_sim::evaluate::TableRow;
use cede_sim::statistics::Share;
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use serde::Serialize;

/// A row, and the seed that it was trained from; baselines have none.
#[derive(Serialize)]
pub(super) struct Seeded {
    pub(super) seed: Option<u64>,
    #[serde(flatten)]
    pub(super) row: TableRow,
}

/// One table per site, split and shield, in the order of their first rows, with the paper's rows at its site.
pub(super) fn render(rows: &[Seeded]) -> String {
    let block = |row: &'_ TableRow| (row.site.clone(), row.split.clone(), row.shield.clone());
    let mut blocks = Vec::new();
    for Seeded { row, .. } in rows {
        if !blocks.contains(&block(row)) {
            blocks.push(block(row));
        }
    }
    // The tables without the shield come first: the paper's protocol.
    blocks.sort_by_key(|(_, _, shield)| *shield != "off");
    let tables = blocks.into_iter().map(|of_table| {
        let own: Vec<&Seeded> = rows.iter().filter(|s| block(&s.row) == of_table).collect();
        let (site, split, shield) = of_table;
        let n = own.first().map_or(0, |s| s.row.n);
        let with_paper = site == "EP0" && shield == "off";
        let table = table(&own, if with_paper { &split } else { "" });
        format!(
            "{site}, {split}: n = {n}, joint mode, until conflict, shield {shield}\n{table}\n\n"
        )
    });
    let legend = "mean ± standard deviation over seeds [Wilson 95 % interval of one seed's n]; \
                  collisions and time-outs per seed\n\n";
    tables.collect::<String>() + legend
}

/// The table of `rows`, with the paper's rows for the split `paper`.
fn table(rows: &[&Seeded], paper: &str) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header([
            "driver",
            "seeds",
            "priority accuracy",
            "length error",
            "collisions",
            "time-outs",
            "RMSE 3 s",
            "SVO RMSE",
        ]);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let mut drivers: Vec<&str> = Vec::new();
    for driver in rows.iter().map(|s| s.row.driver.as_str()) {
        if !drivers.contains(&driver) {
            drivers.push(driver);
        }
    }
    for driver in drivers {
        let own: Vec<&Seeded> = rows
            .iter()
            .filter(|s| s.row.driver == driver)
            .copied()
            .collect();
        table.add_row(cells(driver, &own));
    }
    for (driver, split, _, accuracy, length, collisions) in PAPER {
        if split == paper {
            table.add_row([
                driver.to_owned(),
                "1".to_owned(),
                format!("{:.1} %", 100.0 * accuracy),
                format!("{length:.3}"),
                collisions.to_string(),
            ]);
        }
    }
    table
}

fn cells(driver: &str, seeds: &[&Seeded]) -> [String; 8] {
    let over = |f: fn(&TableRow) -> Option<f64>| -> Vec<f64> {
        seeds.iter().filter_map(|s| f(&s.row)).collect()
    };
    let accuracy = over(|row| row.priority_accuracy);
    let percent: Vec<f64> = accuracy.iter().map(|share| 100.0 * share).collect();
    let n = seeds.first().map_or(0, |s| s.row.n);
    let interval = mean(&accuracy).and_then(|mean| {
        let count = (mean * n as f64).round() as usize;
        Share { count, n }.interval()
    });
    let interval =
        interval.map(|[low, high]| format!(" [{:.0}, {:.0}]", 100.0 * low, 100.0 * high));
    // A baseline has no seeds.
    let trained = seeds.iter().filter(|s| s.seed.is_some()).count();
    [
        driver.to_owned(),
        if trained == 0 {
            "–".to_owned()
        } else {
            trained.to_string()
        },
        spread(&percent, 1, " %") + &interval.unwrap_or_default(),
        spread(&over(|row| row.episode_length_error), 3, ""),
        spread(
            &over(|row| Some(row.collisions as f64)),
            usize::from(trained > 1),
            "",
        ),
        spread(
            &over(|row| Some(row.time_outs as f64)),
            usize::from(trained > 1),
            "",
        ),
        spread(&over(|row| row.position_rmse_3s), 2, " m"),
        spread(&over(|row| row.svo_rmse), 2, " rad"),
    ]
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Mean ± sample standard deviation. A single value is printed alone, no value as a dash.
fn spread(values: &[f64], digits: usize, unit: &str) -> String {
    let Some(mean) = mean(values) else {
        return "–".to_owned();
    };
    if values.len() < 2 {
        return format!("{mean:.digits$}{unit}");
    }
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    let deviation = (squares / (values.len() - 1) as f64).sqrt();
    format!("{mean:.digits$} ± {deviation:.digits$}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_is_the_sample_standard_deviation() {
        assert_eq!(spread(&[1.0, 2.0, 3.0], 1, " m"), "2.0 ± 1.0 m");
        assert_eq!(spread(&[0.25], 2, ""), "0.25");
        assert_eq!(spread(&[], 2, " m"), "–");
    }
}
