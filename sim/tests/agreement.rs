//! The fast box test against rapier2d, the judge: on every step of long random runs, and on
//! vehicles that graze each other.
//!
//! Tolerance: where the two disagree, the rectangles are within [`TOLERANCE`] of touching. Both
//! compute in `f32` from the same poses. At distances of up to 10 m a sum of a few products carries
//! some 10 × 10 × 2⁻²⁴ ≈ 6·10⁻⁶ m of rounding, which is what the tolerance allows (seen: 2·10⁻⁷ m).
//! It is a ten-thousandth of what a GNSS-aided vehicle knows of its place.

mod scenes;

use cede_controller::geometry::{distance, length, unit};
use cede_controller::separation::OrientedBox;
use cede_controller::{Footprint, Point, Pose};
use cede_sim::Judge;
use cede_sim::batch::{Block, LANES, Library};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Metres.
const TOLERANCE: f32 = 1e-5;

/// What a comparison has seen.
#[derive(Debug, Default)]
struct Tally {
    /// Pairs of vehicles.
    compared: u64,
    contacts: u64,
    /// Of pairs within a centimetre of touching.
    grazing: u64,
    disagreements: u64,
    /// Largest distance from touching (m) at which the two disagreed.
    worst: f32,
}

impl Tally {
    fn add(&mut self, ours: bool, theirs: bool, separation: f32) {
        self.compared += 1;
        self.contacts += u64::from(theirs);
        self.grazing += u64::from(separation.abs() < 0.01);
        if ours != theirs {
            self.disagreements += 1;
            self.worst = self.worst.max(separation.abs());
        }
    }
}

type BoxTest = fn(&OrientedBox, &OrientedBox) -> bool;

fn pose(x: f32, y: f32, heading: f32) -> Pose {
    Pose {
        position: Point::new(x, y),
        direction: unit(heading.cos(), heading.sin()),
    }
}

/// Two vehicles in random attitudes, far from the origin, the second moved along one of the four
/// directions of the sides until the two are within `margin` of touching.
fn grazing_pair(random: &mut Pcg64, margin: f32) -> [Pose; 2] {
    let mut anywhere = |span: f32| random.random_range(-span..span);
    let (x, y) = (1000.0 + anywhere(100.0), 1000.0 + anywhere(100.0));
    let a = pose(x, y, anywhere(3.2));
    let mut b = pose(x + anywhere(6.0), y + anywhere(6.0), anywhere(3.2));
    let away = b.position - a.position;
    let away = away * (1.0 / length(&away).max(0.1));
    let wanted = anywhere(margin);
    // Secant steps: the separation grows monotonically along `away`, with slope at most 1.
    for _ in 0..60 {
        let gap = separation(a, b) - wanted;
        b.position -= away * gap;
    }
    [a, b]
}

fn outline(pose: Pose) -> OrientedBox {
    OrientedBox::new(pose, Footprint::PAPER)
}

fn separation(a: Pose, b: Pose) -> f32 {
    outline(a).separation(&outline(b))
}

fn compare_grazing(test: BoxTest, count: u32, margin: f32) -> Tally {
    let mut random = Pcg64::seed_from_u64(11);
    let mut judge = Judge::new(&[Footprint::PAPER; 2]);
    let mut tally = Tally::default();
    for _ in 0..count {
        let [a, b] = grazing_pair(&mut random, margin);
        let theirs = judge.touching(&[Some(a), Some(b)]).next().is_some();
        tally.add(test(&outline(a), &outline(b)), theirs, separation(a, b));
    }
    tally
}

/// Every step of random episodes of three vehicles: two that cross each other's path and do not look, and a
/// follower. All pairs that involve one of the first two are compared.
fn compare_episodes(steps: usize) -> Tally {
    let recorded = scenes::encounters(200, 3, 5);
    let library = Library::new(&recorded, Footprint::PAPER).unwrap();
    let mut block = Block::<3>::new(&library, 6, 0);
    let mut judges: Vec<_> = (0..LANES)
        .map(|_| Judge::new(&[Footprint::PAPER; 3]))
        .collect();
    let mut random = Pcg64::seed_from_u64(7);
    let mut tally = Tally::default();
    for _ in 0..steps.div_ceil(LANES) {
        let mut accelerations = [[0.0; LANES]; 3];
        block.recorded(&library, 2..3, &mut accelerations);
        for asked in accelerations.iter_mut().take(2).flatten() {
            *asked = random.random_range(-2.0..3.0);
        }
        block.advance(&library, &accelerations);
        for (lane, judge) in judges.iter_mut().enumerate() {
            let poses: [_; 3] = std::array::from_fn(|vehicle| {
                let there = block.present(vehicle, lane);
                there.then(|| block.vehicles()[vehicle].pose(lane))
            });
            let touching: Vec<_> = judge.touching(&poses).collect();
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                if let (Some(a), Some(b)) = (poses[i], poses[j]) {
                    let ours = outline(a).overlaps(&outline(b));
                    tally.add(ours, touching.contains(&(i, j)), separation(a, b));
                }
            }
            let collided = block.outcome(lane) == cede_sim::batch::Outcome::Collided;
            let gap = block.gap()[lane];
            if gap.abs() > TOLERANCE {
                assert_eq!(collided, !touching.is_empty(), "{poses:?}");
            }
        }
        block.restart(&library);
    }
    tally
}

#[test]
fn box_test_agrees_with_the_judge_on_every_step() {
    let tally = compare_episodes(1_000_000);
    println!("episodes: {tally:?}");
    assert!(tally.contacts > 1_000, "{tally:?}");
    assert!(tally.worst <= TOLERANCE, "{tally:?}");
}

#[test]
fn box_test_agrees_with_the_judge_on_grazing_vehicles() {
    let tally = compare_grazing(OrientedBox::overlaps, 200_000, 0.002);
    println!("within 2 mm: {tally:?}");
    assert!(tally.grazing > 190_000, "{tally:?}");
    assert!(
        tally.contacts > 50_000 && tally.contacts < 150_000,
        "{tally:?}"
    );
    assert!(tally.worst <= TOLERANCE, "{tally:?}");
}

/// The comparison has teeth: each of these errors is found within a few thousand pairs.
#[test]
fn wrong_box_tests_are_found_out() {
    let one_vehicle_s_axes_only: BoxTest = |a, b| {
        let d = b.centre - a.centre;
        let cos = a.direction.dot(&b.direction).abs();
        let sin = a.direction.perp(&b.direction).abs();
        d.dot(&a.direction).abs() <= a.half_length + b.half_length * cos + b.half_width * sin
            && d.perp(&a.direction).abs() <= a.half_width + b.half_length * sin + b.half_width * cos
    };
    let a_centimetre_too_short: BoxTest = |a, b| {
        let shorter = |vehicle: &OrientedBox| OrientedBox {
            half_length: vehicle.half_length - 0.005,
            ..*vehicle
        };
        shorter(a).overlaps(&shorter(b))
    };
    let circles: BoxTest = |a, b| distance(&a.centre, &b.centre) <= 2.0 * a.half_length;
    let half_a_millimetre_too_wide: BoxTest = |a, b| a.separation(b) <= 5e-4;
    for wrong in [
        one_vehicle_s_axes_only,
        a_centimetre_too_short,
        circles,
        half_a_millimetre_too_wide,
    ] {
        let tally = compare_grazing(wrong, 5_000, 0.02);
        assert!(tally.worst > TOLERANCE, "{tally:?}");
    }
}
