//! Crowds at random, of whom the shield has room for few: nobody is met and no plan is void.

use super::*;

/// Three paths that the ego crosses, the first two at nearly one place.
pub(super) fn crowded() -> Site {
    let north = |x: f32| route(&[(x, -60.0), (x, 60.0)]);
    site(&[east(), north(0.0), north(-1.0), north(24.0)])
}

pub(super) fn numbered(site: &Site, number: u16, path: u8, state: State) -> Track {
    let path = PathId::new(path);
    Track::on(number, path, on(site, path, state))
}

/// Numbers that look random.
struct Dice(u64);

impl Dice {
    fn unit(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u32 << 24) as f32
    }

    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
}

/// A vehicle that accelerates for a time, up to a speed.
pub(super) fn drive([s, v]: [f64; 2], a: f64, time: f64, cap: f64) -> [f64; 2] {
    let steps = 10;
    let dt = time / f64::from(steps);
    (0..steps).fold([s, v], |[s, v], _| {
        let w = (v + a * dt).clamp(0.0, cap.max(v));
        [s + 0.5 * (v + w) * dt, w]
    })
}

/// Others of whom one at most is watched, all of them there from the beginning, that do anything that the contract
/// allows: the ego is never in a zone together with one of them, and its plan is never void.
fn crowd<const N: usize>(seed: u64, faults: bool) -> Result<bool, std::string::String> {
    let site = crowded();
    let contract = WORST
        .to_builder()
        .position_error(0.3)
        .speed_error(0.2)
        .build()
        .unwrap();
    let mut run = Run::<Sound, N>::with_rules(&site, contract);
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1);
    let mut own = [
        f64::from(dice.within(20.0, 56.0)),
        f64::from(dice.within(0.0, 12.0)),
    ];
    let mut others: std::vec::Vec<(u16, u8, [f64; 2], f32)> = (0..5_u16)
        .map(|i| {
            let path = 1 + (dice.unit() * 3.0) as u8;
            let state = [dice.within(1.0, 62.0), dice.within(0.0, 12.0)].map(f64::from);
            (10 + i, path, state, dice.within(-3.0, 3.0))
        })
        .collect();
    let mut planned = false;
    let mut passed = false;
    let mut before = 0.0_f32;
    for frame in 0..120 {
        let noisy = |dice: &mut Dice, [s, v]: [f64; 2]| {
            let s = s as f32 + dice.within(-0.29, 0.29);
            [s, (v as f32 + dice.within(-0.19, 0.19)).max(0.0)]
        };
        let mut tracks = std::vec::Vec::new();
        for &(number, path, state, _) in &others {
            let end = f64::from(zone(&site, path).other.to);
            let [s, v] = noisy(&mut dice, state);
            let missing = dice.unit() < 0.1 && frame > 0;
            let wrong = dice.unit() < 0.1 && frame > 0 && faults && state[0] < end;
            if state[0] < 118.0 && !missing && s > 0.0 {
                let mut track = numbered(&site, number, path, [s, v]);
                if wrong {
                    track.speed = f32::NAN;
                }
                let place = (dice.unit() * (tracks.len() + 1) as f32) as usize;
                tracks.insert(place.min(tracks.len()), track);
            }
        }
        let sensed = noisy(&mut dice, own);
        let proposal = if dice.unit() < 0.7 {
            3.0
        } else {
            dice.within(-3.0, 3.0)
        };
        let decision = run.observe(ego(&site, sensed), &tracks, proposal);
        if let Some(breach) = decision.breach {
            return Err(std::format!("{seed} {frame}: {breach:?}"));
        }
        if planned && decision.plan.is_none() {
            return Err(std::format!(
                "{seed} {frame}: {decision} {own:?} {others:?}"
            ));
        }
        planned |= decision.plan.is_some();
        let late = f64::from(dice.within(0.0, 0.1));
        for (_, _, state, a) in &mut others {
            if dice.unit() < 0.2 {
                *a = if dice.unit() < 0.2 {
                    -8.0
                } else {
                    dice.within(-3.0, 3.0)
                };
            }
            *state = drive(*state, f64::from(*a), 0.1, 15.0);
        }
        own = drive(own, before.into(), late, 100.0);
        own = drive(own, decision.acceleration.into(), 0.1 - late, 100.0);
        before = decision.acceleration;
        for &(number, path, [t, _], _) in &others {
            let zone = zone(&site, path);
            let inside = |span: Span, x: f64| {
                f64::from(span.from) + 0.02 < x && x + 0.02 < f64::from(span.to)
            };
            if planned && inside(zone.ego, own[0]) && inside(zone.other, t) {
                return Err(std::format!("{seed} {frame}: together with {number}"));
            }
        }
        passed |= own[0] > 65.0;
        if own[0] > 115.0 {
            break;
        }
    }
    Ok(planned && passed)
}

fn crowds<const N: usize>(faults: bool) {
    let mut passed = 0;
    let mut wrong = std::vec::Vec::new();
    for seed in 0..3000 {
        match crowd::<N>(seed, faults) {
            Ok(went) => passed += u32::from(went),
            Err(what) => wrong.push(what),
        }
    }
    std::println!("{passed} of 3000 passed, {} wrong", wrong.len());
    assert!(wrong.is_empty(), "{} wrong: {}", wrong.len(), wrong[0]);
    assert!(passed > 300, "{passed}");
}

#[test]
fn a_crowd_for_which_there_is_no_room_is_met_by_nobody() {
    crowds::<1>(false);
}

#[test]
fn nor_if_some_states_are_refused() {
    crowds::<1>(true);
    crowds::<2>(true);
}

#[test]
fn nor_if_there_is_room() {
    crowds::<8>(true);
}

/// The same with lanes: others merge, lead, and follow; whoever is behind brakes as late as it may.
fn lanes<const N: usize>(seed: u64) -> Result<bool, std::string::String> {
    let site = site(&[
        east(),
        ramp(),
        east(),
        route(&[(20.0, -60.0), (20.0, 60.0)]),
    ]);
    let contract = WORST
        .to_builder()
        .position_error(0.3)
        .speed_error(0.2)
        .build()
        .unwrap();
    let mut run = Run::<Sound, N>::with_rules(&site, contract);
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 7);
    let mut own = [dice.within(20.0, 48.0), dice.within(0.0, 12.0)].map(f64::from);
    let lead_to = |path: u8| f64::from(zone(&site, path).lead.to);
    let needs = |v: f64, w: f64| (v * v - w * w) / 8.0;
    let mut others = std::vec::Vec::new();
    for i in 0..5_u16 {
        let path = 1 + (dice.unit() * 3.0) as u8;
        let state = [dice.within(1.0, 100.0), dice.within(0.0, 12.0)].map(f64::from);
        let gap = (own[0] - state[0]).abs() - lead_to(2);
        let fast = state[1] + 1.5;
        let far = needs(fast, own[1]) + 0.5 * fast + 0.7;
        // Behind, it has the safe gap; ahead, it is not too near.
        if path != 2 || (gap > 1.0 && (state[0] > own[0] || gap > far)) {
            others.push((10 + i, path, state, dice.within(-3.0, 3.0)));
        }
    }
    let (mut planned, mut before) = (false, 0.0_f32);
    for frame in 0..120 {
        let noisy = |dice: &mut Dice, [s, v]: [f64; 2]| {
            let s = s as f32 + dice.within(-0.29, 0.29);
            [s, (v as f32 + dice.within(-0.19, 0.19)).max(0.0)]
        };
        let mut tracks = std::vec::Vec::new();
        for &(number, path, state, _) in &others {
            let [s, v] = noisy(&mut dice, state);
            let missing = dice.unit() < 0.1 && frame > 0;
            let wrong = dice.unit() < 0.05 && frame > 0 && state[0] > own[0];
            let length = site.polyline(PathId::new(path)).unwrap().length();
            if state[0] < f64::from(length) - 1.0 && !missing {
                let mut track = numbered(&site, number, path, [s, v]);
                if wrong {
                    track.speed = f32::NAN;
                }
                let place = (dice.unit() * (tracks.len() + 1) as f32) as usize;
                tracks.insert(place.min(tracks.len()), track);
            }
        }
        let sensed = noisy(&mut dice, own);
        let proposal = if dice.unit() < 0.7 {
            3.0
        } else {
            dice.within(-3.0, 3.0)
        };
        let decision = run.observe(ego(&site, sensed), &tracks, proposal);
        if let Some(breach) = decision.breach {
            return Err(std::format!("{seed} {frame}: {breach:?}"));
        }
        if planned && decision.plan.is_none() {
            return Err(std::format!(
                "{seed} {frame}: {decision} {own:?} {others:?}"
            ));
        }
        planned |= decision.plan.is_some();
        let late = f64::from(dice.within(0.0, 0.1));
        let mut next = drive(own, before.into(), late, 100.0);
        next = drive(next, decision.acceleration.into(), 0.1 - late, 100.0);
        for (_, path, state, a) in &mut others {
            if dice.unit() < 0.2 {
                *a = if dice.unit() < 0.2 {
                    -8.0
                } else {
                    dice.within(-3.0, 3.0)
                };
            }
            let goes = drive(*state, f64::from(*a), 0.1, 15.0);
            let lane = zone(&site, *path);
            let behind = lane.is_lane()
                && next[0] >= f64::from(lane.ego.from)
                && own[0] - state[0] > f64::from(lane.middle());
            let gap = next[0] - goes[0] - f64::from(lane.lead.to);
            let brakes = behind && gap < needs(goes[1], next[1]).max(0.0) + 0.02;
            *state = if brakes && *a > -4.0 {
                drive(*state, -4.0, 0.1, 15.0)
            } else {
                goes
            };
        }
        own = next;
        before = decision.acceleration;
        for &(number, path, [t, v], _) in &others {
            let zone = zone(&site, path);
            let inside = |span: Span, x: f64| {
                f64::from(span.from) + 0.05 < x && x + 0.05 < f64::from(span.to)
            };
            if planned
                && inside(zone.ego, own[0])
                && inside(zone.other, t)
                && inside(zone.lead, own[0] - t)
            {
                return Err(std::format!(
                    "{seed} {frame}: {own:?} together with {number} on {path} {t} {v}"
                ));
            }
        }
        if own[0] > 115.0 {
            return Ok(planned);
        }
    }
    Ok(planned && own[0] > 65.0)
}

fn in_lanes<const N: usize>() {
    let mut passed = 0;
    let mut wrong = std::vec::Vec::new();
    for seed in 0..3000 {
        match lanes::<N>(seed) {
            Ok(went) => passed += u32::from(went),
            Err(what) => wrong.push(what),
        }
    }
    std::println!("{N}: {passed} of 3000 passed, {} wrong", wrong.len());
    assert!(
        wrong.is_empty(),
        "{N}: {} wrong: {:#?}",
        wrong.len(),
        &wrong[..wrong.len().min(4)]
    );
}

#[test]
fn nobody_is_met_in_lanes_either() {
    in_lanes::<8>();
    in_lanes::<1>();
    in_lanes::<2>();
}

/// Of as many as there is room for, each on its path, one is watched or not, but never known twice, whatever is seen of it:
/// `firmware/loops.txt` counts on it.
fn known_once(seed: u64) {
    let site = crowded();
    let mut run = Run::new(&site, WORST);
    let mut dice = Dice(seed);
    let mut states: std::vec::Vec<State> = (0..8)
        .map(|_| [dice.within(0.0, 70.0), dice.within(0.0, 12.0)])
        .collect();
    for _ in 0..40 {
        let mut tracks = std::vec::Vec::new();
        for (number, state) in (0_u16..).zip(&mut states) {
            state[0] += 0.1 * state[1];
            let seen = match dice.unit() {
                unseen if unseen < 0.2 => continue,
                jumps if jumps < 0.3 => [dice.within(-20.0, 200.0), state[1]],
                _ => *state,
            };
            let speed = if dice.unit() < 0.1 { f32::NAN } else { seen[1] };
            let path = 1 + (number % 3) as u8;
            tracks.push(numbered(&site, number, path, [seen[0], speed]));
        }
        let own = ego(&site, [dice.within(20.0, 90.0), 5.0]);
        run.observe(own, &tracks, 1.0);
        let mut known: std::vec::Vec<_> = run.shield.tracks.known().collect();
        known.sort_unstable();
        let all = known.len();
        known.dedup();
        assert_eq!(known.len(), all, "{seed}: {known:?}");
    }
}

#[test]
fn who_keeps_number_and_path_is_known_once() {
    for seed in 1..200 {
        known_once(seed);
    }
}
