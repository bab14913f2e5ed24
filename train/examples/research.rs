#![allow(missing_docs)]
use cede_controller::FeatureSet;
use cede_sim::Encounter;
use cede_sim::Sight;
use cede_sim::data::{Dataset, Split};
use cede_train::apg::{Apg, Settings};
use cede_train::closed_loop::Cost;
use cede_train::judge::{Score, judge};
use cede_train::network::Tape;
use rayon::prelude::*;
use std::time::Instant;

fn sights<'e>(e: impl IntoIterator<Item = &'e Encounter>) -> Vec<Sight<'e>> {
    e.into_iter().map(|e| Sight::new(e)).collect()
}
fn score(apg: &Apg<'_>, s: &[Sight<'_>]) -> Score {
    let mut tape = Tape::default();
    let pilot = apg.pilot();
    judge(s, |pairs| pilot.drive(pairs, &mut tape))
}
fn show(name: &str, s: &Score) -> String {
    format!(
        "  {name} {:.1}% {:.3} c{} t{}",
        100.0 * s.priority_accuracy,
        s.length_error,
        s.collisions,
        s.time_outs
    )
}
fn sum(all: &[Score]) -> Score {
    let n: usize = all.iter().map(|s| s.n).sum();
    let mean =
        |f: &dyn Fn(&Score) -> f32| all.iter().map(|s| f(s) * s.n as f32).sum::<f32>() / n as f32;
    Score {
        n,
        priority_accuracy: mean(&|s| s.priority_accuracy),
        length_error: mean(&|s| s.length_error),
        collisions: all.iter().map(|s| s.collisions).sum(),
        time_outs: all.iter().map(|s| s.time_outs).sum(),
    }
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let get = |k: &str, d: f32| {
        args.iter()
            .find_map(|a| a.strip_prefix(&format!("{k}=")))
            .map_or(d, |v| v.parse().unwrap())
    };
    let mode = args.get(1).cloned().unwrap_or_default();
    let dir = std::path::Path::new("/work/shared/interaction");
    let set = Dataset::load(dir, "EP0").unwrap();
    let every = |name: &str| -> Vec<Encounter> {
        let base = Dataset::load(dir, name).unwrap();
        let mut site = base.site.clone();
        site.every_pair = true;
        Dataset::new(site, base.recordings).encounters
    };
    if mode == "count" {
        for name in ["EP0", "DR_USA_Intersection_MA"] {
            let e = every(name);
            let t = Instant::now();
            let s = sights(&e);
            println!(
                "{name}: {} pairs, sights {:?}, {} steps",
                s.len(),
                t.elapsed(),
                e.iter().map(|e| e.steps).sum::<u32>()
            );
        }
        return;
    }
    let features = FeatureSet::ALL[get("features", 3.0) as usize];
    let s = Settings {
        updates: get("updates", 600.0) as u32,
        batch: get("batch", 256.0) as usize,
        width: get("width", 64.0) as usize,
        rate: get("rate", 2e-3),
        horizon: get("horizon", 20.0) as usize,
        last_horizon: get("last", 40.0) as usize,
        from_start: get("from", 0.3),
        position_jitter: get("pj", 0.5),
        speed_jitter: get("vj", 0.15),
        features,
        carry_on: get("carry", 0.5),
        cost: Cost {
            huber: get("huber", 1.0),
            speed: get("sw", 0.3),
            order: get("order", 10.0),
            contact: get("contact", 20.0),
            gap: get("gap", 0.5),
            ..Cost::default()
        },
        own_share: get("judged", 0.5),
        ..Settings::default()
    };
    let ep0 = if get("ep0", 0.0) > 0.0 {
        every("EP0")
    } else {
        Vec::new()
    };
    let ma = if get("ma", 0.0) > 0.0 {
        every("DR_USA_Intersection_MA")
    } else {
        Vec::new()
    };
    let ma = sights(ma.iter().step_by(get("ma", 1.0).max(1.0) as usize));
    let ep0 = sights(&ep0);
    println!("{} {}", ep0.len(), ma.len());
    let seed = get("seed", 1.0) as u64;
    let t = Instant::now();
    if mode == "replay" {
        for split in [Split::Train, Split::Validation] {
            let s = sights(set.split(split));
            let mut c = 0;
            for sight in &s {
                let r = |i: usize| &sight.encounter.participants[i].record;
                let mut step = 0;
                let one = std::slice::from_ref(sight);
                let score = judge(one, |_| {
                    step += 1;
                    vec![[r(0)[step - 1].a, r(1)[step - 1].a]]
                });
                c += score.collisions;
                if score.collisions > 0 || score.priority_accuracy < 1.0 {
                    println!(
                        "{:?} {:?} {:?} {}",
                        sight.encounter.id, score, sight.encounter.kind, sight.encounter.steps
                    );
                }
            }
            println!("replay {split:?} collisions {c}");
        }
    } else if mode == "lofo" {
        let folds = set.folds();
        let results: Vec<(Score, Score)> = folds
            .par_iter()
            .map(|fold| {
                let (train, held) = (
                    sights(fold.train.iter().copied()),
                    sights(fold.held_out.iter().copied()),
                );
                let judged = train.len();
                let mut all = train.clone();
                all.extend(
                    ep0.iter()
                        .filter(|s| s.encounter.id.file != fold.file)
                        .cloned(),
                );
                all.extend(ma.iter().cloned());
                let mut apg = Apg::new(s.clone(), &all, judged, seed);
                while apg.update().is_some() {}
                (score(&apg, &train), score(&apg, &held))
            })
            .collect();
        let (a, b): (Vec<_>, Vec<_>) = results.into_iter().unzip();
        let each: Vec<String> = b
            .iter()
            .map(|s| format!("{:.0}", s.priority_accuracy * 100.0))
            .collect();
        println!(
            "{}: {} {} [{}] {:.0}s",
            args[2..].join(" "),
            show("train", &sum(&a)),
            show("LOFO", &sum(&b)),
            each.join(" "),
            t.elapsed().as_secs_f32()
        );
    } else {
        let (train, valid) = (
            sights(set.split(Split::Train)),
            sights(set.split(Split::Validation)),
        );
        let judged = train.len();
        let mut all = train.clone();
        all.extend(ep0.iter().filter(|s| s.encounter.id.file != 4).cloned());
        all.extend(ma.iter().cloned());
        let mut apg = Apg::new(s, &all, judged, seed);
        let (mut k, mut total) = (0, 0.0);
        while let Some(loss) = apg.update() {
            total += loss;
            k += 1;
            if k % 200 == 0 {
                println!(
                    "{k} {:.1}s loss {:.4} {} {}",
                    t.elapsed().as_secs_f32(),
                    total / 200.0,
                    show("train", &score(&apg, &train)),
                    show("valid", &score(&apg, &valid))
                );
                total = 0.0;
            }
        }
    }
}
