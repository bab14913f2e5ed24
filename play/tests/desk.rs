//! A desk refuses what it cannot answer, says why, and goes on.

use cede_play::{Call, Desk, Input, Output, Place};

fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

/// The words of a path for cars along points.
fn path(points: &[(f32, f32)]) -> Vec<u32> {
    let mut words = vec![0];
    words.extend(bits(&[4.6, 1.9]));
    words.push(points.len() as u32);
    words.extend(points.iter().flat_map(|&(x, y)| bits(&[x, y])));
    words
}

/// A vehicle at arc length `s` of a path that begins at (`x`, `y`) and goes north or east.
fn vehicle(s: f32, speed: f32, (x, y): (f32, f32), north: bool) -> Vec<u32> {
    let (dx, dy) = if north { (0.0, 1.0) } else { (1.0, 0.0) };
    bits(&[s, speed, x + s * dx, y + s * dy, dx, dy])
}

fn ask(desk: &mut Desk<'_>, call: Call, words: &[u32]) -> Option<Vec<u32>> {
    let mut out = Output::new();
    desk.call(call as u32, Input(words), &mut out)
        .then(|| out.words().to_vec())
}

fn said(desk: &mut Desk<'_>) -> String {
    let words = ask(desk, Call::Text, &[]).unwrap();
    let bytes = words[1..].iter().flat_map(|word| word.to_le_bytes());
    String::from_utf8(bytes.take(words[0] as usize).collect()).unwrap()
}

/// Two ways that cross at right angles, the ego's from the south and the other's from the west.
fn crossing(place: &Place) -> Desk<'_> {
    let mut desk = Desk::new(place);
    let mut must = |call, words: &[u32]| assert!(ask(&mut desk, call, words).is_some());
    must(Call::Path, &path(&[(0.0, -50.0), (0.0, 50.0)]));
    must(Call::Path, &path(&[(-50.0, 0.0), (50.0, 0.0)]));
    must(Call::Build, &[]);
    desk
}

/// An observation at the clock's `micros`: the ego and one other.
fn observation(micros: u32, ego: (f32, f32), other: (f32, f32)) -> Vec<u32> {
    let mut words = vec![micros, 0];
    words.extend(vehicle(ego.0, ego.1, (0.0, -50.0), true));
    words.extend([1, 7, 0, 1]);
    words.extend(vehicle(other.0, other.1, (-50.0, 0.0), false));
    words
}

#[test]
fn it_says_why_it_refuses() {
    let place = Place::new();
    let mut desk = crossing(&place);
    let cases: [(u32, Vec<u32>, &str); 8] = [
        (99, vec![], "no such call"),
        (Call::Path as u32, vec![0], "words are missing"),
        (
            Call::Path as u32,
            path(&[(0.0, 0.0), (9.0, 0.0)]),
            "the junction is built already",
        ),
        (Call::Named as u32, vec![9], "no such choice"),
        (
            Call::Zones as u32,
            vec![0, 5],
            "the junction is not built, or has no such path",
        ),
        (
            Call::Decide as u32,
            observation(0, (10.0, 5.0), (10.0, 5.0)),
            "nobody drives yet",
        ),
        (Call::Forget as u32, vec![70_000], "no such choice"),
        (Call::Pose as u32, vec![0], "words are missing"),
    ];
    for (call, words, why) in cases {
        let mut out = Output::new();
        assert!(!desk.call(call, Input(&words), &mut out), "{why}");
        assert_eq!(said(&mut desk), why);
    }
}

#[test]
fn a_contract_that_is_refused_is_named_and_the_one_before_it_stays() {
    let place = Place::new();
    let mut desk = crossing(&place);
    let numbers = ask(&mut desk, Call::Named, &[1]).unwrap();
    assert!(ask(&mut desk, Call::Contract, &numbers).is_some());
    let mut wrong = numbers;
    wrong[1] = 20.0_f32.to_bits();
    assert!(ask(&mut desk, Call::Contract, &wrong).is_none());
    let why = said(&mut desk);
    assert!(
        why.starts_with("position_error = 20 is outside [0, 10]"),
        "{why}"
    );
    assert!(ask(&mut desk, Call::Enter, &[]).is_some());
}

#[test]
fn it_brakes_for_one_that_would_be_hit_and_plans_to_stop_before_the_zone() {
    let place = Place::new();
    let mut desk = crossing(&place);
    assert!(ask(&mut desk, Call::Enter, &[]).is_some());
    let zones = ask(&mut desk, Call::Zones, &[0, 1]).unwrap();
    let from = f32::from_bits(zones[1]);
    let decided = ask(
        &mut desk,
        Call::Decide,
        &observation(0, (34.0, 8.0), (34.0, 10.0)),
    )
    .unwrap();
    let acceleration = f32::from_bits(decided[0]);
    assert!((-3.0..-1.0).contains(&acceleration), "{acceleration}");
    let plan = ask(&mut desk, Call::Plan, &[]).unwrap();
    let stop = f32::from_bits(plan[0]);
    assert!(stop <= from, "at rest at {stop}, the zone begins at {from}");
    // Nominally, it is at rest no later than that.
    assert!(
        plan[1..]
            .iter()
            .all(|&s| f32::from_bits(s) <= stop + 1.0e-3)
    );
    assert!(!said(&mut desk).is_empty());
}

#[test]
fn an_other_may_be_anywhere_from_braking_to_rushing() {
    let place = Place::new();
    let mut desk = crossing(&place);
    let reach = ask(&mut desk, Call::Reach, &bits(&[20.0, 8.0, 1.0])).unwrap();
    // Worst case: it brakes at 8 m/s² and is at rest after 4 m, or accelerates at 3 m/s².
    let [least, most] = [reach[0], reach[1]].map(f32::from_bits);
    assert!((least - 24.0).abs() < 1.0e-3, "{least}");
    assert!((most - 29.5).abs() < 1.0e-3, "{most}");
}
