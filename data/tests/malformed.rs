//! What users read when a recording is not as it should be.

use cede_data::{DataError, Dataset, generic, interaction, lanelet};
use insta::assert_snapshot;
use std::path::Path;

const HEADER: &str = "track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy,psi_rad,length,width\n";

/// A file of three rows in which `wrong` stands instead of `right`.
fn interaction_file(right: &str, wrong: &str) -> String {
    let rows = "\
        1,1,100,car,965.783,988.577,-6.7,0.492,3.068,4.15,1.72\n\
        1,2,200,car,965.113,988.626,-6.701,0.489,3.069,4.15,1.72\n\
        1,3,300,car,964.443,988.674,-6.692,0.485,3.069,4.15,1.72\n";
    let good = HEADER.to_owned() + rows;
    assert!(good.contains(right));
    good.replacen(right, wrong, 1)
}

/// What the error says and how to mend it; the folder is cut off, as it changes with every run.
fn message<T: std::fmt::Debug>(
    read: impl Fn(&Path) -> Result<T, DataError>,
    name: &str,
    content: &str,
) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), content).unwrap();
    let error = read(&folder.path().join(name)).unwrap_err();
    let text = format!("{error}\n{}", error.mend());
    text.replace(&format!("{}/", folder.path().display()), "")
}

fn of_interaction(right: &str, wrong: &str) -> String {
    let content = interaction_file(right, wrong);
    message(interaction::read, "vehicle_tracks_000.csv", &content)
}

fn of_generic(content: &str) -> String {
    message(generic::read, "tracks.csv", content)
}

#[test]
fn a_good_file_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("vehicle_tracks_000.csv");
    std::fs::write(&path, interaction_file("", "")).unwrap();
    let tracks = interaction::read(&path).unwrap();
    assert_eq!((tracks.len(), tracks[0].states.len()), (1, 3));
    assert_eq!((tracks[0].first_ms, tracks[0].last_ms()), (100, 300));
    assert_eq!(tracks[0].states[1].x, 965.113);
}

#[test]
fn missing_column() {
    assert_snapshot!(of_interaction("timestamp_ms,", "time,"), @r"
    vehicle_tracks_000.csv:1: the header lacks the column `timestamp_ms`
    the header should be track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy,psi_rad,length,width
    ");
}

#[test]
fn not_a_number() {
    assert_snapshot!(of_interaction("965.113", "west"), @r"
    vehicle_tracks_000.csv:3: column `x`: `west` is not a number
    write a plain decimal number in SI units, with a point, as in 1012.35
    ");
}

#[test]
fn decimal_comma() {
    assert_snapshot!(of_interaction("965.113", "965,113"), @r"
    vehicle_tracks_000.csv:3: 12 fields where the header has 11
    give the row one field for each column of the header; check for stray commas
    ");
}

#[test]
fn quoted_decimal_comma() {
    assert_snapshot!(of_interaction("965.113", "\"965,113\""), @r"
    vehicle_tracks_000.csv:3: column `x`: `965,113` is not a number
    write a plain decimal number in SI units, with a point, as in 1012.35
    ");
}

#[test]
fn empty_field() {
    assert_snapshot!(of_interaction("965.113", ""), @r"
    vehicle_tracks_000.csv:3: column `x`: the field is empty
    fill in the value, or delete the row
    ");
}

#[test]
fn not_a_finite_number() {
    assert_snapshot!(of_interaction("-6.701", "NaN"), @r"
    vehicle_tracks_000.csv:3: column `vx`: NaN is not a finite number
    delete the row, or fill it by interpolation
    ");
    assert_snapshot!(of_interaction("988.626", "inf"), @r"
    vehicle_tracks_000.csv:3: column `y`: inf is not a finite number
    delete the row, or fill it by interpolation
    ");
}

#[test]
fn coordinates_that_single_precision_cannot_hold() {
    assert_snapshot!(of_interaction("965.113", "4182965.113"), @r"
    vehicle_tracks_000.csv:3: column `x`: 4182965.113 m is farther than 8192 m from the origin
    subtract a common offset from all coordinates of the site and its map
    ");
}

#[test]
fn a_vehicle_without_extent() {
    assert_snapshot!(of_interaction("4.15", "0"), @r"
    vehicle_tracks_000.csv:2: column `length`: a vehicle's length and width must be positive, not 0 m
    give the vehicle's size in metres
    ");
}

#[test]
fn time_goes_backwards() {
    assert_snapshot!(of_interaction("1,3,300", "1,3,150"), @r"
    vehicle_tracks_000.csv:4: time goes backwards: track 1 is at 150 ms after 200 ms
    sort the rows of each track by time
    ");
}

#[test]
fn negative_time() {
    assert_snapshot!(of_interaction("1,3,300", "1,3,-300"), @r"
    vehicle_tracks_000.csv:4: column `timestamp_ms`: `-300` is not a whole number from 0 on
    write a plain whole number, without sign, point or letters
    ");
}

#[test]
fn duplicate_row() {
    assert_snapshot!(of_interaction("1,3,300", "1,3,200"), @r"
    vehicle_tracks_000.csv:4: duplicate row: track 1 already has a row at 200 ms
    delete one of the two rows
    ");
}

#[test]
fn hole() {
    assert_snapshot!(of_interaction("1,3,300", "1,3,3000"), @r"
    vehicle_tracks_000.csv:4: hole in track 1: nothing between 200 ms and 3000 ms
    give the part after the hole a track number of its own; holes up to 1 s are interpolated
    ");
}

#[test]
fn last_line_cut_off() {
    let content = interaction_file("", "");
    let cut = |bytes: usize| {
        let name = "vehicle_tracks_000.csv";
        message(interaction::read, name, &content[..content.len() - bytes])
    };
    assert_snapshot!(cut(12), @r"
    vehicle_tracks_000.csv:4: the file ends in the middle of this line
    copy the file anew from its source, or delete its last line
    ");
    // In the middle of the last field, in an empty field, in the middle of the line.
    for bytes in [2, 3, 4, 5, 6, 20, 40] {
        assert_eq!(cut(bytes), cut(12), "{bytes} bytes cut off");
    }
}

#[test]
fn a_missing_line_break_at_the_end_does_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("vehicle_tracks_000.csv");
    std::fs::write(&path, interaction_file("", "").trim_end()).unwrap();
    assert_eq!(interaction::read(&path).unwrap()[0].states.len(), 3);
}

#[test]
fn empty_files() {
    let read = |content| message(interaction::read, "vehicle_tracks_000.csv", content);
    assert_snapshot!(read(""), @r"
    vehicle_tracks_000.csv: no rows
    restore the file from its source
    ");
    assert_eq!(read(HEADER), read(""));
}

#[test]
fn not_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("vehicle_tracks_000.csv");
    std::fs::write(&path, [0x1f, 0x8b, 0xff, 0x00, 0x0a, 0xfe]).unwrap();
    let error = interaction::read(&path).unwrap_err().to_string();
    let (_, what) = error.rsplit_once('/').unwrap();
    assert_snapshot!(what, @"vehicle_tracks_000.csv:1: the header lacks the column `track_id`");
}

#[test]
fn pedestrians_named_as_vehicles() {
    let content = "track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy\n\
        P1,1,100,pedestrian/bicycle,965.783,988.577,-0.7,0.492\n";
    assert_snapshot!(message(interaction::read, "vehicle_tracks_000.csv", content), @r"
    vehicle_tracks_000.csv: these are tracks of pedestrians: no heading, no length, no width
    name it pedestrian_tracks_NNN.csv, and it is passed over; only vehicles are judged
    ");
}

#[test]
fn pedestrian_files_are_passed_over_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    std::fs::write(file("vehicle_tracks_000.csv"), interaction_file("", "")).unwrap();
    std::fs::write(file("pedestrian_tracks_000.csv"), "anything").unwrap();
    let dataset = Dataset::load(folder.path(), "EP0").unwrap();
    assert_eq!(dataset.recordings.len(), 1);
    assert_eq!(dataset.passed_over, [file("pedestrian_tracks_000.csv")]);
}

#[test]
fn no_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let error = Dataset::load(folder.path(), "EP0").unwrap_err();
    let text = format!("{error}\n{}", error.mend());
    assert_snapshot!(text.replace(&folder.path().display().to_string(), "DIR"), @r"
    DIR: no recorded tracks of site EP0 here
    name the folder that holds the site's vehicle_tracks_NNN.csv, or its parent, and the site with --site
    ");
    let error = Dataset::load(&folder.path().join("nowhere"), "EP0").unwrap_err();
    let text = format!("{error}\n{}", error.mend());
    assert_snapshot!(text.replace(&folder.path().display().to_string(), "DIR"), @r"
    DIR/nowhere: cannot be read: No such file or directory (os error 2)
    check the path and that you may read it
    ");
}

#[test]
fn generic_files() {
    assert_snapshot!(of_generic("track,time,x,y\n1,0,0,0\n"), @r"
    tracks.csv:1: the header lacks the column `t`
    the header needs track,t,x,y (s, m) and may have vx,vy,heading,length,width; INTERACTION's files are told by their name, vehicle_tracks_NNN.csv
    ");
    assert_snapshot!(of_generic("track,t,x,y\n1,-0.1,0,0\n"), @r"
    tracks.csv:2: column `t`: a time must be from 0 to 1,000,000,000 s, not -0.1 s
    subtract the first time from all times
    ");
    assert_snapshot!(of_generic("track,t,x,y,length\n1,0.1,0,0,long\n"), @r"
    tracks.csv:2: column `length`: `long` is not a number
    write a plain decimal number in SI units, with a point, as in 1012.35
    ");
    assert_snapshot!(of_generic("track,t,x,y\n1,0.1,0,0\n1,0.1,0,0\n"), @r"
    tracks.csv:3: duplicate row: track 1 already has a row at 100 ms
    delete one of the two rows
    ");
}

#[test]
fn site_descriptions() {
    let read = |content| {
        message(
            |path| Dataset::load(path, path.to_str().unwrap()),
            "X.toml",
            content,
        )
    };
    assert_snapshot!(read("name = \"X\"\nfolder = \"X\"\nlanes = 4\n"), @r"
    X.toml: not a site description: TOML parse error at line 3, column 1
      |
    3 | lanes = 4
      | ^^^^^
    unknown field `lanes`, expected one of `name`, `folder`, `split`, `every_pair`, `arm`, `movement`, `conflict`
    compare with data/src/sites/EP0.toml
    ");
    let unknown_arm = "name = \"X\"\nfolder = \"X\"\n[[conflict]]\nkind = \"crossing\"\n\
        left = { from = \"A\", to = \"B\" }\nother = { from = \"A\", to = \"B\" }\n";
    assert_snapshot!(read(unknown_arm), @r"
    X.toml: not a site description: there is no arm `A`
    compare with data/src/sites/EP0.toml
    ");
}

#[test]
fn maps() {
    let map = |content| message(lanelet::read, "X.osm", content);
    assert_snapshot!(map("<osm><node id='1'"), @r"
    X.osm:1: not a Lanelet2 map: the root node was opened but never closed
    restore the map from its source, or remove it: it serves for drawing and rights of way, nothing else
    ");
    assert_snapshot!(map("<osm>\n<node id='1' lat='0.1' lon='east'/>\n</osm>"), @r"
    X.osm:2: not a Lanelet2 map: `east` is not a number of degrees
    restore the map from its source, or remove it: it serves for drawing and rights of way, nothing else
    ");
    assert_snapshot!(map("<osm>\n<way id='2'><nd ref='1'/></way>\n</osm>"), @r"
    X.osm:2: not a Lanelet2 map: there is no node 1
    restore the map from its source, or remove it: it serves for drawing and rights of way, nothing else
    ");
    let lanelet = "<osm>\n<relation id='3'><tag k='type' v='lanelet'/></relation>\n</osm>";
    assert_snapshot!(map(lanelet), @r"
    X.osm:2: not a Lanelet2 map: a lanelet without a left bound
    restore the map from its source, or remove it: it serves for drawing and rights of way, nothing else
    ");
    let regulation = |member: &str| {
        format!(
            "<osm>\n<relation id='5'>\n<member {member}/>\n<tag k='type' v='regulatory_element'/>\n<tag k='subtype' v='right_of_way'/></relation>\n</osm>"
        )
    };
    let lane = regulation("type='relation' ref='7' role='yield'");
    assert_snapshot!(map(&lane), @r"
    X.osm:3: not a Lanelet2 map: there is no lanelet 7
    restore the map from its source, or remove it: it serves for drawing and rights of way, nothing else
    ");
    let line = regulation("type='way' ref='8' role='ref_line'");
    assert_snapshot!(map(&line), @r"
    X.osm:3: not a Lanelet2 map: there is no way 8
    restore the map from its source, or remove it: it serves for drawing and rights of way, nothing else
    ");
}
