use super::contract::{any_contract, assumed};
use super::formula::{Formula, all};
use super::motion::{metres, number, speed, state};
use super::symbol::Symbol;
use super::term::{Node, Term};
use super::{Answer, Claim, Solver, lemmas};
use crate::interval::Interval;
use cede_controller::Real;
use cede_controller::dangerous;
use cede_controller::shield::actuation::Inherited;
use cede_controller::shield::reach::Reach;
use cede_controller::shield::{Contract, margin};
use proptest::prelude::*;
use std::collections::HashMap;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(60);

fn solver() -> Option<Solver> {
    let solver = Solver::find(None).ok();
    if solver.is_none() {
        cede_tests::skip("z3");
    }
    solver
}

type Values = HashMap<&'static str, f64>;

fn value(term: Term, of: &Values) -> f64 {
    let at = |term| value(term, of);
    match term.node() {
        Node::Symbol(Symbol { name, .. }) => of[name],
        Node::Constant(bits) => f32::from_bits(bits).into(),
        Node::Add(a, b) => at(a) + at(b),
        Node::Sub(a, b) => at(a) - at(b),
        Node::Mul(a, b) => at(a) * at(b),
        Node::Div(a, b) => at(a) / at(b),
        Node::Neg(a) => -at(a),
        Node::Sqrt(a) => at(a).sqrt(),
        Node::Min(a, b) => at(a).min(at(b)),
        Node::Max(a, b) => at(a).max(at(b)),
    }
}

fn holds(formula: &Formula, of: &Values) -> bool {
    match formula {
        Formula::Less(a, b) => value(*a, of) < value(*b, of),
        Formula::AtMost(a, b) => value(*a, of) <= value(*b, of),
        Formula::Equal(a, b) => value(*a, of) == value(*b, of),
        Formula::All(parts) => parts.iter().all(|part| holds(part, of)),
        Formula::Any(parts) => parts.iter().any(|part| holds(part, of)),
        Formula::Not(part) => !holds(part, of),
    }
}

/// The numbers of `contract` by the names that the lemmas give them.
fn numbers(contract: &Contract) -> Values {
    let (ego, other, follower) = (contract.ego(), contract.other(), contract.follower());
    [
        ("period", contract.period()),
        ("latency", contract.latency()),
        ("position_error", contract.position_error()),
        ("speed_error", contract.speed_error()),
        ("slack", contract.slack()),
        ("ego.max_speed", ego.max_speed),
        ("ego.acceleration", ego.acceleration),
        ("ego.go", ego.go),
        ("ego.braking", ego.braking),
        ("other.max_speed", other.max_speed),
        ("other.acceleration", other.acceleration),
        ("other.braking", other.braking),
        ("follower.reaction", follower.reaction),
        ("follower.braking", follower.braking),
    ]
    .map(|(name, value)| (name, value.into()))
    .into()
}

/// Margins of every kind, over any numbers.
fn margins<R: Real>(contract: &Contract, [s, v, other_v, target]: [R; 4]) -> [R; 6] {
    let departure = margin::departure(contract, v, &Inherited::all(contract, [-v, v]), s);
    let (clears, clearing_speed) = margin::clearing(contract, departure.least, target);
    let rush = margin::rush(contract, other_v, clears);
    let needed = margin::safe_gap(contract, rush.speed, clearing_speed);
    [
        clears,
        margin::clears_before(contract, target, rush),
        margin::enters_ahead(contract, target, rush, needed),
        margin::rest(contract, departure.most, clears),
        margin::stops_short(contract, target, departure.braking.rest(v + R::of(1.0))),
        margin::earliest_rest(contract, other_v),
    ]
}

fn names() -> [Term; 4] {
    let Reach { distance, speed: v } = state(["s", "v"]);
    [distance, v, speed("other_v"), metres("target")]
}

prop_compose! {
    fn contracts()(
        times in [0.01_f32..1.0, 0.0..1.0, 0.0..3.0], errors in [0.0_f32..2.0, 0.0..2.0],
        speeds in [0.5_f32..20.0, 0.5..20.0], accelerations in [0.1_f32..10.0, 0.1..10.0, 0.1..10.0],
        [go, b, b_f] in [0.1_f32..1.0, 0.1..1.0, 0.1..1.0],
    ) -> Contract {
        let brakes = b.max(b_f) * accelerations[2];
        let launch = accelerations[0].min(accelerations[1]).min(brakes);
        let go = (go * launch).max(0.01);
        let latency = times[0] * times[1];
        // What keeps the ego below its limit has to leave it some speed.
        let late = (launch + b * accelerations[2]) * latency;
        let limit = speeds[0] + 2.0 * errors[1] + late + go * times[0];
        Contract::builder()
            .period(times[0])
            .latency(latency)
            .position_error(errors[0])
            .speed_error(errors[1])
            .ego_max_speed(limit)
            .ego_acceleration(launch)
            .ego_go(go)
            .ego_braking(b * accelerations[2])
            .other_max_speed(limit + speeds[1])
            .other_acceleration(accelerations[1])
            .other_braking(accelerations[2])
            .follower_reaction(times[2])
            .follower_braking(b_f * accelerations[2])
            .build()
            .expect("every number is in its range")
    }
}

proptest! {
    #[test]
    fn a_term_is_what_the_margin_computes(
        contract in contracts(), s in -5.0_f32..5.0, v in 0.0_f32..20.0, other_v in 0.0_f32..20.0, target in -10.0_f32..100.0,
    ) {
        let inputs = [s, v, other_v, target];
        let mut of = numbers(&contract);
        of.extend(["s", "v", "other_v", "target"].into_iter().zip(inputs.map(f64::from)));
        let terms = margins(&any_contract(), names());
        let enclosed = margins(&contract, inputs.map(Interval::of));
        for (term, interval) in terms.into_iter().zip(enclosed) {
            prop_assert!(interval.contains(value(term, &of)), "{} not in {interval:?}", value(term, &of));
        }
    }

    #[test]
    fn a_contract_keeps_what_the_lemmas_assume_of_it(contract in contracts()) {
        prop_assert!(holds(&all(assumed()), &numbers(&contract)));
    }
}

#[test]
fn every_number_of_a_contract_has_its_name() {
    let contract = any_contract();
    let [ego, other] = [contract.ego().braking, contract.other().braking].map(Term::of);
    assert_ne!(ego, other);
    let mut of = numbers(&Contract::WORST_CASE);
    assert_eq!(value(other, &of), 8.0);
    let [period, latency] = [contract.shortest_period(), contract.switching()].map(Term::of);
    assert_eq!(
        (value(period, &of), value(latency, &of)),
        (0.1_f32.into(), 0.1_f32.into())
    );
    of.insert("ego.braking", 2.5);
    assert_eq!(value(ego, &of), 2.5);
}

#[test]
fn equal_expressions_are_one_term() {
    let [a, b] = ["s", "t"].map(metres);
    assert_eq!(a + b, metres("s") + b);
    assert_ne!(a + b, b + a);
}

#[test]
fn what_the_solver_reads_is_what_the_term_is() {
    let Some(solver) = solver() else { return };
    let contract = Contract::WORST_CASE;
    let inputs = [-1.7_f32, 6.1, 8.3, 23.9];
    let mut of = numbers(&contract);
    of.extend(
        ["s", "v", "other_v", "target"]
            .into_iter()
            .zip(inputs.map(f64::from)),
    );
    let fixed = names().into_iter().zip(inputs);
    let fixed: Vec<Formula> = fixed.map(|(name, x)| name.equal(number(x))).collect();
    for term in margins(&contract, names()) {
        let near = |off: f32| {
            let value = number(value(term, &of) as f32);
            let off = number(off);
            let close = all([(value - off).at_most(term), term.at_most(value + off)]);
            let script = Claim::new(fixed.clone(), close).script("near");
            solver.ask(&script, LIMIT).expect("a solver")
        };
        assert_eq!(near(1e-4), Answer::Unsat);
    }
}

#[test]
fn all_lemmas_are_proved_and_fail_when_broken() {
    let Some(solver) = solver() else { return };
    for lemma in lemmas() {
        let settled = lemma.settle(&solver, LIMIT).expect("a solver");
        assert!(settled.proved(), "{}: {settled:?}", lemma.id);
    }
}

/// Among others that are slower and gentler than the ego a gap for the last moment at which it may enter need not do
/// for an earlier one: what `entry-ramp` and `entry-cap` assume is necessary.
#[test]
fn among_gentle_others_an_ego_that_enters_sooner_lacks_the_gap() {
    let contract = Contract::WORST_CASE;
    let missing = |contract: &Contract| {
        let (seen, now, time) = (1.0_f32, 2.0, 0.4);
        let rush = margin::rush(contract, seen, time);
        let then = now + contract.ego().go * time;
        let verified = rush.distance + margin::safe_gap(contract, rush.speed, then);
        margin::safe_gap(contract, seen, now) - (verified + contract.slack())
    };
    assert!(missing(&contract) < 0.0);
    let gentle = Contract::builder()
        .other_acceleration(0.1)
        .other_max_speed(1.0);
    // No such contract can be built: the others are weaker than the ego.
    assert!(gentle.build().is_err());
    assert!(missing(&dangerous::unchecked(gentle)) < 0.0);
    let contract = dangerous::unchecked(gentle.follower_reaction(1.5));
    assert!(missing(&contract) > 0.25, "{}", missing(&contract));
}

#[test]
fn a_missing_solver_says_what_to_install() {
    let error = Solver::find(Some("/nowhere/z3".as_ref())).expect_err("nothing is there");
    assert!(error.to_string().contains("/nowhere/z3"));
    assert!(error.mend().contains("apt-get install z3"));
    let error = Solver::find(Some("true".as_ref())).expect_err("true is no solver");
    assert!(error.to_string().contains("not Z3"));
}

#[test]
fn lemmas_have_names_of_their_own() {
    let mut names: Vec<&str> = lemmas().iter().map(|lemma| lemma.id).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}

#[test]
fn the_rocq_development_is_about_the_code_as_it_is() {
    let committed = include_str!("../../../proofs/Shipped.v");
    assert!(
        committed == super::shipped(),
        "proofs/Shipped.v differs from the code: cede verify lemmas --write rocq proofs/Shipped.v, and mend the proofs"
    );
}

/// The table of `docs/theorem.md` names every lemma, and the text how many there are.
#[test]
fn the_theorem_lists_every_lemma() {
    let theorem = include_str!("../../../docs/theorem.md");
    let (_, section) = theorem.split_once("\n## Lemmas\n").expect("a section");
    let (section, _) = section.split_once("\n## ").expect("the next section");
    let rows = section.lines().filter(|line| line.starts_with("| L"));
    let listed: Vec<&str> = rows.filter_map(|row| row.split('`').nth(1)).collect();
    let asked: Vec<&str> = lemmas().iter().map(|lemma| lemma.id).collect();
    let sorted = |mut names: Vec<&'static str>| {
        names.sort_unstable();
        names
    };
    assert_eq!(sorted(listed), sorted(asked.clone()));
    let count = format!("has Z3 prove {} lemmas", asked.len());
    assert!(theorem.contains(&count), "{count}");
}
