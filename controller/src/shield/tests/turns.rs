//! Two shields that number their paths differently.

use super::*;

/// A site with the ego's own road as path 0, whichever it is, which has this place in the order of turns.
fn own(first: Route<4>, second: Route<4>, order: Option<[u16; 2]>) -> Site {
    let mut builder = Site::builder();
    builder.tolerance(0.0);
    for (index, route) in [first, second].iter().enumerate() {
        let path = builder.path(route, Class::Car, Footprint::PAPER).unwrap();
        if let Some(order) = order {
            builder.order(path, order[index]).unwrap();
        }
    }
    builder.build().unwrap()
}

/// Periods in which both have precedence, and those in which one has, while two rest at their lines that came at once.
fn claims(order: Option<[u16; 2]>) -> (u32, u32) {
    let reversed = order.map(|[a, b]| [b, a]);
    let sites = [own(east(), north(), order), own(north(), east(), reversed)];
    let mut runs = [0, 1].map(|i| Run::new(&sites[i], Contract::ALL_WAY_STOP));
    let line = sites[0].path(EGO).unwrap().line();
    let (mut both, mut one) = (0, 0);
    for period in 0..200_u8 {
        // They come from 10 m before their lines, and rest there from the fifth second on.
        let left = f32::from(50_u8.saturating_sub(period)) / 50.0;
        let state = [line - 0.01 - 10.0 * left * left, 4.0 * left];
        let first = [0, 1].map(|i| {
            runs[i].decide(state, &[(1, state)], -3.0);
            runs[i].shield.goes_before(1)
        });
        both += u32::from(first == [true; 2]);
        one += u32::from(first[0] != first[1]);
    }
    (both, one)
}

#[test]
fn shields_that_agree_on_the_order_of_turns_never_both_go_first() {
    // Each has its own path as number 0: each takes the other for the one with the first turns.
    let (both, _) = claims(None);
    assert!(both > 0);
    let (both, one) = claims(Some([3, 7]));
    assert_eq!(both, 0);
    assert!(one > 20, "{one}");
}
