//! Scenarios by the million.

use crate::outcome::Outcome;
use crate::scenario::{Family, SHARE};
use crate::search::search;
use crate::site::Site;
use crate::tally::Tally;
use crate::world::play;
use cede_controller::dangerous::Rules;
use rayon::prelude::*;
use std::ops::Range;

impl Family {
    /// Scenario `seed`; with `trace` it prints every decision.
    #[must_use]
    pub fn run<R: Rules + Clone>(&self, seed: u64, trace: bool) -> Outcome {
        let site = self.site(seed);
        site.map_or_else(Outcome::default, |site| {
            self.run_on::<R>(&site, seed, trace)
        })
    }

    fn run_on<R: Rules + Clone>(&self, site: &Site, seed: u64, trace: bool) -> Outcome {
        let Some(setup) = self.setup(site, seed) else {
            return Outcome::default();
        };
        if self.searches {
            search::<R>(&setup, trace)
        } else {
            play::<R>(&setup, trace)
        }
    }

    /// Scenarios `from` to `from + count`, on as many threads as there are; the result does not depend on how many.
    #[must_use]
    pub fn campaign<R: Rules + Clone>(&self, from: u64, count: u64) -> Tally {
        let jobs: Vec<Range<u64>> = by_site(from, count).collect();
        let tallies = jobs.into_par_iter().map(|seeds| self.batch::<R>(seeds));
        tallies.reduce(Tally::default, Tally::plus)
    }

    /// Scenarios of one site.
    fn batch<R: Rules + Clone>(&self, seeds: Range<u64>) -> Tally {
        let Some(site) = self.site(seeds.start) else {
            return Tally {
                skipped: seeds.end - seeds.start,
                ..Tally::default()
            };
        };
        let run = |seed| Tally::of(seed, &self.run_on::<R>(&site, seed, false));
        // A search is a few hundred scenarios by itself.
        let step = if self.searches { SHARE as usize } else { 1 };
        seeds
            .step_by(step)
            .map(run)
            .fold(Tally::default(), Tally::plus)
    }
}

/// So many scenarios from this one on, those of one site together.
fn by_site(from: u64, count: u64) -> impl Iterator<Item = Range<u64>> {
    let to = from + count;
    (from / SHARE..to.div_ceil(SHARE))
        .map(move |site| (site * SHARE).max(from)..((site + 1) * SHARE).min(to))
}

/// Some scenarios of every family after the other; rounds are the same on any number of threads.
#[derive(Clone, Copy, Debug)]
pub struct Round {
    first: u64,
    number: u64,
}

impl Round {
    /// The first round begins with this seed.
    #[must_use]
    pub fn from(seed: u64) -> Self {
        Self {
            first: seed,
            number: 0,
        }
    }

    /// What came of the next round, for each of the `families`.
    pub fn next<R: Rules + Clone>(&mut self, families: &[&Family]) -> Vec<Tally> {
        let Self { first, number } = *self;
        self.number += 1;
        let numbered = families.iter().enumerate();
        let jobs: Vec<(usize, &Family, Range<u64>)> = numbered
            .flat_map(|(i, &family)| {
                let count = family.sites * SHARE;
                by_site(first + number * count, count).map(move |seeds| (i, family, seeds))
            })
            .collect();
        let done: Vec<(usize, Tally)> = jobs
            .into_par_iter()
            .map(|(i, family, seeds)| (i, family.batch::<R>(seeds)))
            .collect();
        let mut tallies = vec![Tally::default(); families.len()];
        for (i, tally) in done {
            tallies[i] = std::mem::take(&mut tallies[i]).plus(tally);
        }
        tallies
    }
}
