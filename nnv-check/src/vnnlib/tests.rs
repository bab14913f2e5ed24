use super::*;
use proptest::prelude::*;

const SMALL: &str = "
    ; a comment
    (declare-const X_0 Real) (declare-const X_1 Real)
    (declare-const Y_0 Real) (declare-const Y_1 Real)
    (assert (>= X_0 -1)) (assert (<= X_0 2.5e-1))
    (assert (and (<= 0 X_1) (<= X_1 3)))
    (assert (or (and (<= Y_0 Y_1) (>= Y_0 2)) (and (>= (+ Y_0 (* 2 Y_1)) 7))))
";

fn half(coefficients: [f64; 2], bound: f64) -> Halfspace {
    Halfspace::new(coefficients.to_vec(), bound)
}

#[test]
fn conjunctions_and_disjunctions_share_their_box() {
    let property = read(SMALL).expect("well formed");
    assert_eq!(
        (property.inputs, property.outputs, property.queries.len()),
        (2, 2, 1)
    );
    let query = &property.queries[0];
    assert_eq!(
        query.region,
        InputBox {
            lower: vec![-1.0, 0.0],
            upper: vec![0.25, 3.0]
        }
    );
    let first = vec![half([1.0, -1.0], 0.0), half([-1.0, 0.0], -2.0)];
    assert_eq!(
        query.unsafe_set,
        vec![first, vec![half([-1.0, -2.0], -7.0)]]
    );
}

#[test]
fn several_boxes_are_several_queries() {
    let text = "(declare-const X_0 Real)(declare-const Y_0 Real)
        (assert (or (and (>= X_0 0)(<= X_0 1)(<= Y_0 0)) (and (>= X_0 2)(<= X_0 3)(<= Y_0 1)) (and (>= X_0 3)(<= X_0 2))))";
    let property = read(text).expect("well formed");
    assert_eq!(property.queries.len(), 2, "an empty box is no query");
}

#[test]
fn errors_say_where_and_what() {
    let at = |text: &str| read(text).expect_err("malformed");
    assert_eq!(at("(assert (<= X_0 1)").what, "a '(' that is never closed");
    let error = at("(declare-const X_0 Real)\n(assert (<= X_0 zebra))");
    assert_eq!((error.line, error.column), (2, 17));
    assert!(
        at("(declare-const X_0 Real)(assert (<= X_0 1))")
            .what
            .contains("X_0 is not bounded")
    );
    assert!(
        at("(declare-const X_0 Real)(assert (<= (* X_0 X_0) 1))")
            .what
            .contains("not linear")
    );
    assert!(at(&"(".repeat(1000)).what.contains("nested"));
}

#[test]
fn constants_are_computed_exactly_or_refused() {
    let text = |comparison: &str| {
        format!(
            "(declare-const X_0 Real)(declare-const Y_0 Real)(assert (and (<= 0 X_0 1) {comparison}))"
        )
    };
    let atom = |comparison: &str| {
        let property = read(&text(comparison)).expect("well formed");
        property.queries[0].unsafe_set[0][0].clone()
    };
    let one = |coefficient, bound| Halfspace::new(vec![coefficient], bound);
    assert_eq!(atom("(<= (+ Y_0 1e17 -1 -1e17) 0)"), one(1.0, 1.0));
    assert_eq!(atom("(< (* 2 3 Y_0) (/ 3 2))"), one(6.0, 1.5).strict());
    assert_eq!(atom("(>= (- Y_0) (- 1 2 3))"), one(1.0, 4.0));
    // 0.1·y ≤ 0.3 is y ≤ 3, times a power of two.
    let tenth = atom("(<= (* 0.1 Y_0) 0.3)");
    assert_eq!(tenth.bound() / tenth.coefficients()[0], 3.0);
    assert!(!tenth.is_rounded());
    assert!(atom("(<= (* 1e-400 Y_0) 1)").is_rounded());
    for hostile in [
        "(<= Y_0 1e9999)".to_owned(),
        format!("(<= Y_0 (* {}))", "1e2000 ".repeat(100)),
        format!("(<= Y_0 {})", "1".repeat(10_000)),
    ] {
        assert!(read(&text(&hostile)).is_err());
    }
}

#[test]
fn limits_that_are_no_floats_or_strict_are_kept() {
    let text = "(declare-const X_0 Real)(declare-const X_1 Real)(declare-const Y_0 Real)
        (assert (and (>= X_0 0.1)(< X_0 1)(<= X_1 2 )(>= X_1 -2)(<= Y_0 0)))";
    let query = &read(text).expect("well formed").queries[0];
    let sides: Vec<_> = query
        .limits
        .iter()
        .map(|l| (l.input, l.upper, l.strict))
        .collect();
    assert_eq!(sides, [(0, false, false), (0, true, true)]);
    assert!(
        query.region.lower[0] < 0.1,
        "the float 0.1 is above the decimal"
    );
}

const SECOND: &str = "
    ; version 2
    (vnnlib-version <2.0>)
    (declare-network acc
        (declare-input X Real [1, 2] \"input 0\")
        (declare-output Y Real []))
    (assert (and (>= X[0,0] -1.0) (<= X [0,0] 0.25)))
    (assert (<= 0 X[0, 1])) (assert (<= X[0,1] 3))
    (assert (or (<= Y -3.0) (>= (* 2.0 Y) 1)))
";

#[test]
fn the_second_version_says_the_same_of_tensors() {
    let first = "(declare-const X_0 Real)(declare-const X_1 Real)(declare-const Y_0 Real)
        (assert (and (>= X_0 -1)(<= X_0 0.25)(<= 0 X_1)(<= X_1 3)))
        (assert (or (<= Y_0 -3) (>= (* 2 Y_0) 1)))";
    let [first, second] = [first, SECOND].map(|text| read(text).expect("well formed"));
    assert_eq!(second.queries, first.queries);
    assert_eq!((second.inputs, second.outputs), (2, 1));
}

#[test]
fn equal_and_not_equal_are_what_they_say() {
    let text = |comparison: &str| {
        let property = format!(
            "(vnnlib-version <2.0>)(declare-network n (declare-input X float32 [1])(declare-output Y float32 [2,2]))
            (assert (and (<= 0 X[0]) (<= X[0] 1)))(assert {comparison})"
        );
        read(&property).expect("well formed").queries[0]
            .unsafe_set
            .clone()
    };
    let row = |sign: f64, bound| Halfspace::new(vec![0.0, 0.0, sign, 0.0], bound);
    assert_eq!(text("(== Y[1,0] 2)"), [[row(1.0, 2.0), row(-1.0, -2.0)]]);
    let apart = [vec![row(1.0, 2.0).strict()], vec![row(-1.0, -2.0).strict()]];
    assert_eq!(text("(!= Y[1,0] 2)"), apart);
}

#[test]
fn errors_of_the_second_version_say_where_and_what() {
    let network = "(declare-network n (declare-input X Real [2,3]) (declare-output Y Real [1]))";
    for (text, line, what) in [
        ("(vnnlib-version <3.0>)", 1, "version <3.0>: expected <2.0>"),
        (
            "(vnnlib-version <2.0>)\n(assert (<= X[0] 1))",
            2,
            "X is not declared",
        ),
        (
            "(vnnlib-version <2.0>)\nNETWORK\n(assert (<= Z[0] 1))",
            3,
            "Z is not declared: there are X and Y",
        ),
        (
            "(vnnlib-version <2.0>)\nNETWORK\n(assert (<= X[2,0] 1))",
            3,
            "X[2, 0] is no element: the shape is [2, 3]",
        ),
        (
            "(vnnlib-version <2.0>)\nNETWORK\n(assert (<= X[0] 1))",
            3,
            "the shape is [2, 3]",
        ),
        (
            "(vnnlib-version <2.0>)\nNETWORK\n(assert (<= X[-1,0] 1))",
            3,
            "expected numbers with commas",
        ),
        (
            "(vnnlib-version <2.0>)\nNETWORK\n(assert (<= Y 1))",
            3,
            "Y[] is no element",
        ),
        (
            "(vnnlib-version <2.0>)\nNETWORK\nNETWORK",
            3,
            "a second network",
        ),
        (
            "(vnnlib-version <2.0>)\n(declare-const X_0 Real)",
            2,
            "belongs to VNN-LIB 1",
        ),
        ("NETWORK", 1, "begin with (vnnlib-version <2.0>)"),
        (
            "(declare-const X_0 Real)\n(assert (<= X[0] 1))",
            2,
            "begin with (vnnlib-version <2.0>)",
        ),
        ("NETWORK\n(vnnlib-version <2.0>)", 1, "begin with"),
        (
            "(vnnlib-version <2.0>)\n(vnnlib-version <2.0>)",
            2,
            "comes first, and once",
        ),
        (
            "(vnnlib-version <2.0>)\n(declare-network n\n(declare-input X int8 [1])(declare-output Y Real [1]))",
            3,
            "type int8",
        ),
        (
            "(vnnlib-version <2.0>)\n(declare-network n\n(declare-input X Real [0])(declare-output Y Real [1]))",
            3,
            "0 elements",
        ),
        (
            "(vnnlib-version <2.0>)\n(declare-network n\n(declare-hidden H Real [1] \"h\"))",
            3,
            "declare-hidden is not supported",
        ),
        (
            "(vnnlib-version <2.0>)\n(declare-network n (declare-input X Real [1]))",
            2,
            "one (declare-output …)",
        ),
        (
            "(vnnlib-version <2.0>)\nNETWORK\n(assert (<= Y[0 1))",
            3,
            "not closed in its line",
        ),
        (
            "(vnnlib-version <2.0>)\nNETWORK\n(assert (<= Y[0] 1))",
            1,
            "X[0, 0] is not bounded on both sides",
        ),
    ] {
        let error = read(&text.replace("NETWORK", network)).expect_err(text);
        assert!(
            error.what.contains(what) && error.line == line,
            "{text}: {error}"
        );
    }
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in "[\\]\\[()<=>!*+XY_0-9.a-z;\" \n-]{0,300}") {
        let _ = read(&text);
    }

    #[test]
    fn a_damaged_property_is_read_or_refused(
        text in prop_oneof![Just(SMALL), Just(SECOND)],
        at in 0..SMALL.len().min(SECOND.len()),
        byte in 32_u8..127,
        cut in 0..SMALL.len().max(SECOND.len()),
    ) {
        let mut bytes = text.as_bytes().to_vec();
        bytes[at] = byte;
        bytes.truncate(cut.max(1));
        let _ = read(&String::from_utf8_lossy(&bytes));
    }
}
