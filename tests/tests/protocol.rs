//! The paper's protocol on recorded encounters: the simulator's own error, and the baselines.

use cede_data::Dataset;
use cede_sim::driver::Baseline;
use cede_sim::episode::Until;
use cede_sim::evaluate::{Label, Mode, Protocol, Selection, TableRow, evaluate};
use cede_tests::interaction;

/// The row of `baseline` on `selection` in the paper's protocol.
fn row(dataset: &Dataset, baseline: Baseline, selection: Selection) -> TableRow {
    let protocol = Protocol {
        mode: Mode::Joint,
        until: Until::Conflict,
        seed: 0,
    };
    let mut drives = Vec::new();
    for round in selection.rounds(dataset) {
        let factory = baseline.fit(&round.training).unwrap();
        drives.extend(evaluate(&*factory, &round.judged, protocol).drives);
    }
    let label = Label {
        site: &dataset.site.name,
        driver: baseline.name(),
        split: selection.name(),
        mode: "joint",
        until: "conflict",
        shield: "off",
    };
    TableRow::of(label, &drives)
}

#[test]
fn replay_is_the_record_on_the_train_split() {
    let Some(folder) = interaction() else { return };
    let dataset = Dataset::load(&folder, "EP0").unwrap();
    let row = row(&dataset, Baseline::Replay, "train".parse().unwrap());
    assert_eq!(row.n, 215);
    assert!(row.priority_accuracy.unwrap() >= 0.99, "{row:?}");
    assert!(row.episode_length_error.unwrap() <= 0.03, "{row:?}");
    assert_eq!(row.collisions + row.time_outs, 0, "{row:?}");
}

#[test]
fn the_initial_state_tells_who_goes_first_in_files_left_out() {
    let Some(folder) = interaction() else { return };
    let dataset = Dataset::load(&folder, "EP0").unwrap();
    let selection = "leave-one-file-out".parse().unwrap();
    let row = row(&dataset, Baseline::Logistic, selection);
    assert_eq!(row.n, 281);
    assert!(row.priority_accuracy.unwrap() >= 0.85, "{row:?}");
}

/// Synthetic encounters are the same on every machine, and so is every digit of the table.
#[test]
fn the_table_of_synthetic_encounters() {
    let dataset = Dataset::synthetic(300, 1);
    let mut table = String::new();
    for selection in ["train", "test"] {
        for baseline in Baseline::ALL {
            let row = row(&dataset, baseline, selection.parse().unwrap());
            table += &format!(
                "{:<6} {:<13} n {:<3} priority {:.6} length {:.6} collisions {} time-outs {} RMSE {:.6} SVO {:.6}\n",
                row.split,
                row.driver,
                row.n,
                row.priority_accuracy.unwrap(),
                row.episode_length_error.unwrap(),
                row.collisions,
                row.time_outs,
                row.position_rmse.unwrap(),
                row.svo_rmse.unwrap(),
            );
        }
    }
    insta::assert_snapshot!(table);
}
