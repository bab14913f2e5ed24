//! A scenario in words.

use super::Family;

impl Family {
    /// Prints scenario `seed`: its contract, its lanes, its zones and its vehicles.
    pub fn describe(&self, seed: u64) {
        println!("{}: {}; scenario {seed}", self.name, self.about);
        let Some(site) = self.site(seed) else {
            println!("the controller refuses its site");
            return;
        };
        let Some(setup) = self.setup(&site, seed) else {
            println!("no room for its vehicles");
            return;
        };
        println!("{:#?}\n{:?}", setup.contract, setup.sensing);
        println!(
            "tolerance {} m, order of the lanes {:?}",
            site.tolerance, site.order
        );
        for (i, car) in setup.cars.iter().enumerate() {
            let lane = &site.lanes[car.lane];
            println!(
                "vehicle {i}: {car:?}, {:?}, waits at {:.3} m",
                lane.size,
                site.line(car.lane)
            );
            for (j, other) in setup.cars.iter().enumerate().filter(|&(j, _)| j != i) {
                for area in site.areas(car.lane, other.lane) {
                    println!("    with {j}: {area:?}");
                }
            }
        }
    }
}
