//! x
use cede_attack::scenario::FAMILIES;
use cede_controller::dangerous::Sound;
fn main() {
    let count: u64 = std::env::args().nth(1).map_or(64, |a| a.parse().unwrap());
    let only = std::env::args().nth(2);
    if let Some(name) = std::env::args().nth(3) { let f = cede_attack::scenario::Family::named(&name).unwrap(); let o = f.run::<Sound>(count, true); println!("{o:?}"); let site = f.site(count).unwrap(); let s = f.setup(&site, count).unwrap(); println!("{:?} {:?} tol {} order {:?}", s.contract, s.sensing, site.tolerance, site.order); for c in &s.cars { println!("{c:?}"); } for a in &s.cars { println!("line {} len {} {:?}", site.line(a.lane), site.lanes[a.lane].line.length(), site.lanes[a.lane].size); for b in &s.cars { println!("   lanes {} {}: {:?}", a.lane, b.lane, site.areas(a.lane, b.lane)); } } return; }
    for family in FAMILIES {
        if only.as_ref().is_some_and(|only| only != family.name) { continue; }
        let count = if family.name == "search" { count.div_ceil(64) } else { count };
        let start = std::time::Instant::now();
        let t = family.campaign::<Sound>(0, count);
        let secs = start.elapsed().as_secs_f64();
        println!("{:14} {:6} of {:6} steps {:8} overlaps {} breach {} fault {} unplanned {} diff {} unwatched {} through {}/{} interv {:.2} {:.0} steps/s {:?}", family.name, t.scenarios, t.scenarios+t.skipped, t.steps, t.overlaps, t.false_breaches, t.false_faults, t.unplanned, t.different, t.unwatched, t.through, t.shielded, t.interventions as f64 / t.steps.max(1) as f64, t.steps as f64/secs, t.case);
    }
}
