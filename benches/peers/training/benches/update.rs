//! Updates of soft actor-critic a CPU-second in Cede, candle and burn, in turn and in one run, after a check
//! that each learns. Processor time, so that a loaded machine matters less.

use cede_peers_training::burn::burn;
use cede_peers_training::candle::candle;
use cede_peers_training::cede::cede;
use cede_peers_training::{Failure, Update};
use cpu_time::ProcessTime;

const ROUNDS: usize = 3;
const SECONDS: f64 = 1.0;
const NAMES: [&str; 3] = ["cede", "candle", "burn"];

/// Updates a CPU-second, after warming up.
fn rate(update: &mut Update) -> Result<f64, Failure> {
    let mut measure = |seconds: f64| -> Result<f64, Failure> {
        let (start, mut count) = (ProcessTime::now(), 0.0);
        while start.elapsed().as_secs_f64() < seconds {
            update()?;
            count += 1.0;
        }
        Ok(count / start.elapsed().as_secs_f64())
    };
    measure(0.3)?;
    measure(SECONDS)
}

/// On a batch that stays, the critics' loss falls to less than half.
fn check(name: &str, update: &mut Update) -> Result<(), Failure> {
    let first = update()?;
    for _ in 0..300 {
        update()?;
    }
    let last = update()?;
    println!("{name}: critics' loss {first:.3}, after 300 updates {last:.3}");
    if last < 0.5 * first {
        Ok(())
    } else {
        Err(format!("{name} does not learn").into())
    }
}

fn median(mut values: [f64; ROUNDS]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[ROUNDS / 2]
}

fn main() -> Result<(), Failure> {
    // Without it candle counts the machine's cores before each product.
    if std::env::var_os("RAYON_NUM_THREADS").is_none_or(|n| n != "1") {
        return Err("set RAYON_NUM_THREADS=1, for a comparison on one thread".into());
    }
    for width in [128, 256] {
        println!("3 x {width}");
        let mut updates = [cede(width), candle(width)?, burn(width)];
        for (name, update) in NAMES.iter().zip(&mut updates) {
            check(name, update)?;
        }
        let mut rates = [[0.0; ROUNDS]; NAMES.len()];
        for round in 0..ROUNDS {
            for (rates, update) in rates.iter_mut().zip(&mut updates) {
                rates[round] = rate(update)?;
            }
        }
        for (name, own) in NAMES.iter().zip(rates) {
            let ratios = std::array::from_fn(|round| rates[0][round] / own[round]);
            let (least, most) = (
                ratios.into_iter().fold(f64::INFINITY, f64::min),
                ratios.into_iter().fold(0.0, f64::max),
            );
            println!(
                "{name:<7} {:6.1} updates a CPU-second; ours {:.2} times as fast ({least:.2} to {most:.2} by round)",
                median(own),
                median(ratios),
            );
        }
    }
    Ok(())
}
