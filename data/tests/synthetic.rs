//! Synthetic traffic: what is written is read back, and what people do is plausible.

use cede_controller::geometry::unit;
use cede_controller::separation::OrientedBox;
use cede_controller::{Footprint, Point, Pose};
use cede_data::{Dataset, Split, Track, synthetic};

#[test]
fn written_recordings_are_read_back_to_the_same_encounters() {
    let folder = tempfile::tempdir().unwrap();
    let written = synthetic::write(folder.path(), 60, 11).unwrap();
    let mut read = Vec::new();
    let mut test = 0;
    for site in &written {
        let description = folder.path().join(format!("{}.toml", site.name));
        let data = Dataset::load(folder.path(), &description.to_string_lossy()).unwrap();
        assert_eq!(data.encounters.len(), site.encounters);
        let map = data.map.as_ref().expect("a map is beside the recordings");
        assert!(map.lanelets.len() >= 6 && map.lines.len() >= 6);
        test += data.split(Split::Test).count();
        read.extend(data.encounters);
    }
    read.sort_by_key(|encounter| encounter.id.file);
    let made = Dataset::synthetic(60, 11);
    assert_eq!(format!("{read:?}"), format!("{:?}", made.encounters));
    assert_eq!(test, made.split(Split::Test).count());
}

#[test]
fn people_drive_as_people_do() {
    let data = Dataset::synthetic(150, 5);
    let mut hard = 0;
    let mut steps = 0;
    for track in data
        .recordings
        .iter()
        .flat_map(|recording| &recording.tracks)
    {
        let speeds: Vec<f64> = track.states.iter().map(|s| s.vx.hypot(s.vy)).collect();
        for pair in speeds.windows(2) {
            let acceleration = (pair[1] - pair[0]) / 0.1;
            // Speeds have three decimals, and one that stops does so within a step.
            assert!(
                acceleration.abs() < 3.05,
                "{acceleration} m/s² of track {}",
                track.id
            );
            hard += usize::from(acceleration.abs() > 2.5);
            steps += 1;
        }
        assert!(speeds.iter().all(|&v| v < 29.0));
    }
    assert!(
        hard * 100 < steps,
        "{hard} of {steps} steps beyond 2.5 m/s²"
    );
}

/// Drivers misjudge now and then: docs/synthetic.md says how often.
#[test]
fn hardly_anybody_is_hit_and_nobody_waits_for_ever() {
    let data = Dataset::synthetic(300, 9);
    let mut hit = 0;
    for recording in &data.recordings {
        for (i, a) in recording.tracks.iter().enumerate() {
            hit += recording.tracks[..i]
                .iter()
                .filter(|b| touch(a, b).is_some())
                .count();
            let rest = a.states.iter().filter(|s| s.vx.hypot(s.vy) < 0.1).count();
            assert!(
                rest < 900,
                "file {}: {} rests for {rest} steps",
                recording.file,
                a.id
            );
        }
    }
    assert!(hit <= 1, "{hit} pairs touch");
}

/// The time (ms) at which the two overlap first.
fn touch(a: &Track, b: &Track) -> Option<u64> {
    let begin = a.first_ms.max(b.first_ms);
    let end = a.last_ms().min(b.last_ms());
    (begin..=end)
        .step_by(100)
        .find(|&time| covered(a, time).overlaps(&covered(b, time)))
}

fn covered(track: &Track, time: u64) -> OrientedBox {
    let state = &track.states[((time - track.first_ms) / 100) as usize];
    let (sin, cos) = state.heading.sin_cos();
    let pose = Pose {
        position: Point::new(state.x as f32, state.y as f32),
        direction: unit(cos as f32, sin as f32),
    };
    let (length, width) = (track.length as f32, track.width as f32);
    OrientedBox::new(pose, Footprint { length, width })
}

#[test]
fn a_site_by_name_has_the_description_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let written = synthetic::write(dir, 60, 11).unwrap();
    let site = written.iter().find(|site| site.encounters > 0).unwrap();
    let recordings = dir.join(&site.name);
    let file = recordings.join(format!("vehicle_tracks_{:03}.csv", site.files[0]));
    let path = dir.join(format!("{}.toml", site.name));
    let described = Dataset::load(dir, path.to_str().unwrap()).unwrap();
    for place in [dir, &recordings] {
        let named = Dataset::load(place, &site.name).unwrap();
        assert_eq!(format!("{named:?}"), format!("{described:?}"));
        assert_eq!(named.site.remark(), None);
    }
    assert_eq!(
        Dataset::load(&file, &site.name).unwrap().site.remark(),
        None
    );
    std::fs::remove_file(&path).unwrap();
    let by_headings = Dataset::load(dir, &site.name).unwrap();
    let remark = by_headings.site.remark().unwrap();
    assert!(
        remark.contains(&format!("no {}.toml", site.name)),
        "{remark}"
    );
}

#[test]
fn what_was_written_is_removed_and_all_else_stays() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let written = synthetic::write(dir, 60, 11).unwrap();
    let notes = [
        dir.join("notes.toml"),
        dir.join(&written[0].name).join("notes.txt"),
    ];
    for path in &notes {
        std::fs::write(path, "mine").unwrap();
    }
    synthetic::remove(dir).unwrap();
    assert!(notes.iter().all(|path| path.is_file()));
    for path in [dir.to_owned(), dir.join(&written[0].name)] {
        assert_eq!(
            std::fs::read_dir(&path).unwrap().count(),
            if path == dir { 2 } else { 1 }
        );
    }
}
