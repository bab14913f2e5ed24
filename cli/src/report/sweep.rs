//! The share of recorded steps that the shield accepts, as a function of two values of the contract.

use cede_controller::ConflictKind;
use cede_data::Role;
use cede_sim::transparency::Swept;
use serde::Serialize;

/// A heat map: one kind of encounter, one role.
#[derive(Serialize)]
pub(super) struct Panel {
    title: String,
    steps: u64,
    /// The share that must be accepted under the worst-case contract, for both roles together.
    bar: f64,
    /// The other's acceleration, the ego's braking (m/s²), and the share of accepted steps.
    cells: Vec<(f32, f32, f64)>,
}

impl Panel {
    /// A panel of `rows` for each kind with a required share, and each role.
    pub(super) fn all(rows: &[Swept]) -> Vec<Self> {
        let kinds = [
            ("Crossing", ConflictKind::Crossing, 0.995),
            ("Merging", ConflictKind::Merging, 0.99),
        ];
        let roles = [("left-turner", Role::Left), ("other", Role::Other)];
        let panels = kinds.into_iter().flat_map(|(kind_name, kind, bar)| {
            roles.map(|(role_name, role)| {
                let of = rows
                    .iter()
                    .filter(|row| (row.counted.kind, row.counted.role) == (kind, role));
                Self {
                    title: format!("{kind_name}: steps of the {role_name}"),
                    steps: of.clone().map(|row| row.counted.steps).max().unwrap_or(0),
                    bar,
                    cells: of
                        .map(|row| (row.acceleration, row.braking, row.counted.share()))
                        .collect(),
                }
            })
        });
        panels.filter(|panel| panel.steps > 0).collect()
    }
}
