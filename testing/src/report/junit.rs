//! JUnit XML, as CI systems read it.
//!
//! Written by hand: one element a check needs no library.

use super::{Outcome, Report, Verdict};
use std::fmt::Write;

/// The report as XML.
pub(super) fn write(report: &Report) -> String {
    let (tests, failures, skipped) = (
        report.outcomes.len(),
        report.failed().count(),
        report.skipped().count(),
    );
    let time: f64 = report.outcomes.iter().map(|outcome| outcome.seconds).sum();
    let name = escaped(&report.subject);
    let cases: String = report.outcomes.iter().map(case).collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <testsuites name=\"cede-conformance\" tests=\"{tests}\" failures=\"{failures}\" skipped=\"{skipped}\" time=\"{time:.3}\">\n\
         <testsuite name=\"{name}\" tests=\"{tests}\" failures=\"{failures}\" errors=\"0\" skipped=\"{skipped}\" time=\"{time:.3}\">\n\
         <properties><property name=\"seed\" value=\"{}\"/><property name=\"cases\" value=\"{}\"/></properties>\n\
         {cases}</testsuite>\n</testsuites>\n",
        report.seed, report.cases,
    )
}

fn case(outcome: &Outcome) -> String {
    let Outcome {
        id,
        sentence,
        seconds,
        ..
    } = outcome;
    let body = match &outcome.verdict {
        Verdict::Passed => String::new(),
        Verdict::Skipped(why) => format!("<skipped message=\"{}\"/>", escaped(why)),
        Verdict::Failed(failure) => {
            let mend = failure.mend.as_deref().unwrap_or_default();
            let case = failure.case.as_deref().unwrap_or_default();
            let text = format!("{sentence}\n{}\n{mend}\n{case}", failure.message);
            format!(
                "<failure message=\"{}\">{}</failure>",
                escaped(&failure.message),
                escaped(&text)
            )
        }
    };
    let mut out = format!("<system-out>{}", escaped(sentence));
    for (name, value) in &outcome.numbers {
        let _ = write!(out, "\n{}: {value:.4}", escaped(name));
    }
    format!(
        "<testcase classname=\"cede\" name=\"{id}\" time=\"{seconds:.3}\">{body}{out}</system-out></testcase>\n"
    )
}

/// `text` for the inside of an element or of an attribute in double quotes. Line breaks are kept; characters that XML
/// does not have become `\u{FFFD}`.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            '\t' => escaped.push_str("&#9;"),
            c if c < ' ' || c == '\u{FFFE}' || c == '\u{FFFF}' => escaped.push('\u{FFFD}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use proptest::prelude::*;

    #[test]
    fn a_reader_of_xml_reads_everything_back() {
        let xml = example().to_junit();
        let document = roxmltree::Document::parse(&xml).unwrap();
        let named = |name| {
            document
                .descendants()
                .find(move |n| n.attribute("name") == Some(name))
        };
        let suite = document
            .descendants()
            .find(|n| n.has_tag_name("testsuite"))
            .unwrap();
        assert_eq!(
            (suite.attribute("tests"), suite.attribute("failures")),
            (Some("3"), Some("1"))
        );
        let failure = named("bad").unwrap().first_element_child().unwrap();
        assert_eq!(failure.attribute("message"), Some("a < b & \"c\"\u{FFFD}"));
        assert!(
            failure
                .text()
                .unwrap()
                .ends_with("change ego.braking\nE ]]> 1\n'")
        );
        let skipped = named("left-out").unwrap().first_element_child().unwrap();
        assert_eq!(skipped.attribute("message"), Some("no rule"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn any_text_is_escaped(text in any::<String>()) {
            let mut report = example();
            report.subject = text;
            let xml = report.to_junit();
            prop_assert!(roxmltree::Document::parse(&xml).is_ok(), "{}", xml);
        }
    }
}
