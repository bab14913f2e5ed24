//! A share of the vehicles of a recording is driven.

use cede_controller::{Contract, Policy, policy::embedded};
use cede_data::{Dataset, RawState, Recording, Site, Track, Traffic};
use cede_sim::traffic::{Kind, Outcome, Settings, Summary, run};

/// A vehicle that comes from 60 m before the centre at this time (s) with this heading (rad), at 6 m/s.
fn track(id: u32, appears: f64, heading: f64) -> Track {
    let (sin, cos) = heading.sin_cos();
    // On the right of its road.
    let at = |step: i32| {
        let s = 0.6 * f64::from(step) - 60.0;
        RawState {
            x: s * cos + 1.75 * sin,
            y: s * sin - 1.75 * cos,
            vx: 6.0 * cos,
            vy: 6.0 * sin,
            heading,
        }
    };
    Track {
        id,
        first_ms: 100 * (10.0 * appears) as u64,
        length: 4.5,
        width: 1.8,
        states: (0..200).map(at).collect(),
    }
}

/// Four roads, a vehicle every second and a half.
fn traffic() -> Traffic {
    let quarter = std::f64::consts::FRAC_PI_2;
    let tracks = (0..24_u32)
        .map(|i| {
            track(
                i,
                1.5 * f64::from(i),
                quarter * f64::from((5 * i + i / 3) % 4),
            )
        })
        .collect();
    let recording = Recording {
        file: 0,
        tracks,
        scene: None,
    };
    let dataset = Dataset::new(Site::by_headings("four roads"), vec![recording], None);
    Traffic::of(&dataset, &dataset.recordings[0])
}

fn settings(share: f64, kind: Kind) -> Settings<'static> {
    Settings {
        share,
        seed: 1,
        kind,
        policy: Policy::new(embedded::words()).expect("the embedded policy"),
        contract: Contract::ALL_WAY_STOP,
    }
}

#[test]
fn where_nobody_is_driven_everybody_repeats_his_record() {
    let outcome = run(&traffic(), &settings(0.0, Kind::Cede));
    assert_eq!(outcome.rides.len(), 24);
    for ride in &outcome.rides {
        assert_eq!((ride.steps, ride.driven), (199, 0), "{ride:?}");
        assert!(
            ride.arrived.is_some_and(|late| late.abs() < 0.11),
            "{ride:?}"
        );
    }
    assert_eq!(outcome.collisions, []);
}

#[test]
fn where_all_are_driven_they_arrive_and_nobody_is_met() {
    for kind in [Kind::Profile, Kind::Cede] {
        let outcome = run(&traffic(), &settings(1.0, kind));
        let row = Summary::of(
            "four roads",
            &settings(1.0, kind),
            std::slice::from_ref(&outcome),
        );
        assert_eq!((row.driven, row.refused), (24, 0), "{row:?}");
        assert_eq!((row.collisions, row.others_touched), (0, 0), "{row:?}");
        assert!(row.arrived + row.stuck == 24 && row.stuck <= 2, "{row:?}");
    }
}

/// Drivers that have no shield do meet in this traffic: their records cross.
#[test]
fn the_records_of_this_traffic_cross() {
    let outcome = run(&traffic(), &settings(0.0, Kind::Cede));
    assert!(outcome.others_touched > 0, "{outcome:?}");
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let on = |threads: usize| -> Outcome {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("a pool of threads");
        pool.install(|| run(&traffic(), &settings(0.5, Kind::Cede)))
    };
    let outcome = on(1);
    assert_eq!(outcome, on(2));
    let driven = outcome.rides.iter().filter(|ride| ride.driven > 0).count();
    assert!((6..=18).contains(&driven), "{driven}");
}
