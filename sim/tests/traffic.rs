//! A share of the vehicles of a recording is driven.

use cede_controller::{Contract, Policy, policy::embedded};
use cede_data::{Dataset, RawState, Recording, Site, Track, Traffic};
use cede_sim::traffic::{Kind, Outcome, Settings, Summary, run};

/// A vehicle that comes from 60 m before the centre at this time (s) with this heading (rad), at 6 m/s.
fn track(id: u32, appears: f64, heading: f64) -> Track {
    track_from(id, appears, heading, -60.0)
}

/// The same from another place on its road (m).
fn track_from(id: u32, appears: f64, heading: f64, from: f64) -> Track {
    let (sin, cos) = heading.sin_cos();
    // On the right of its road.
    let at = |step: i32| {
        let s = 0.6 * f64::from(step) + from;
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
    of(tracks)
}

fn of(tracks: Vec<Track>) -> Traffic {
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

/// A record may begin in the middle of the junction, where somebody comes by who was not there in the recording.
#[test]
fn nobody_appears_in_anothers_way() {
    for tenths in 30..70 {
        let north = std::f64::consts::FRAC_PI_2;
        let tracks = vec![
            track(0, 0.0, 0.0),
            track_from(1, 0.1 * f64::from(tenths), north, -6.0),
        ];
        let outcome = run(&of(tracks), &settings(1.0, Kind::Profile));
        assert_eq!(outcome.collisions, [], "{tenths}");
        assert!(outcome.rides.iter().all(|ride| ride.arrived.is_some()));
    }
}

/// A record may begin so near that a plan of somebody who drives would not be safe any more.
#[test]
fn nobody_appears_whom_a_plan_does_not_bear() {
    let settings = Settings {
        contract: Contract::WORST_CASE,
        ..settings(1.0, Kind::Profile)
    };
    for tenths in 30..90 {
        let north = std::f64::consts::FRAC_PI_2;
        let tracks = vec![
            track(0, 0.0, 0.0),
            track_from(1, 0.1 * f64::from(tenths), north, -24.0),
        ];
        let outcome = run(&of(tracks), &settings);
        assert_eq!(outcome.collisions, [], "{tenths}");
        for ride in &outcome.rides {
            assert_eq!(ride.unplanned, 0, "{tenths} {ride:?}");
        }
    }
}

/// A way that comes back to itself is no path of a junction.
#[test]
fn whose_way_comes_back_to_itself_is_left_out_alone() {
    let mut tracks = vec![track(0, 0.0, 0.0), track(1, 2.0, 3.0)];
    for (step, state) in (0_i32..).zip(&mut tracks[1].states) {
        let (sin, cos) = (0.06 * f64::from(step)).sin_cos();
        (state.x, state.y) = (-40.0 + 10.0 * cos, 10.0 * sin);
        (state.vx, state.vy) = (-6.0 * sin, 6.0 * cos);
        state.heading = cos.atan2(-sin);
    }
    let outcome = run(&of(tracks), &settings(1.0, Kind::Cede));
    assert_eq!(outcome.left_out, 1);
    assert!(outcome.rides[0].driven > 0, "{outcome:?}");
    assert_eq!(outcome.rides[1].steps, 0);
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
