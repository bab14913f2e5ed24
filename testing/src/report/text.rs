//! The report for people.

use super::{Outcome, Report, Verdict};
use std::fmt::{Display, Formatter, Result};

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(
            f,
            "{}; seed {}, {} cases a check",
            self.subject, self.seed, self.cases
        )?;
        self.outcomes
            .iter()
            .try_for_each(|outcome| write!(f, "{outcome}"))?;
        let (failed, skipped) = (self.failed().count(), self.skipped().count());
        let passed = self.outcomes.len() - failed - skipped;
        write!(f, "{passed} passed, {failed} failed, {skipped} SKIPPED")?;
        for outcome in self.skipped() {
            write!(f, "\nNOT CHECKED: {}", outcome.id)?;
        }
        Ok(())
    }
}

impl Display for Outcome {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self {
            id,
            sentence,
            verdict,
            cases,
            skipped_cases,
            numbers,
            seconds,
        } = self;
        let word = match verdict {
            Verdict::Passed => "ok",
            Verdict::Failed(_) => "FAILED",
            Verdict::Skipped(_) => "SKIPPED",
        };
        write!(f, "{word:7} {id}: {sentence} [{cases} cases")?;
        if *skipped_cases > 0 {
            write!(f, ", {skipped_cases} did not count")?;
        }
        writeln!(f, ", {seconds:.1} s]")?;
        for (name, value) in numbers {
            writeln!(f, "        {name}: {value:.3}")?;
        }
        match verdict {
            Verdict::Passed => Ok(()),
            Verdict::Skipped(why) => writeln!(f, "        not checked: {why}"),
            Verdict::Failed(failure) => {
                writeln!(f, "        {}", failure.message)?;
                if let Some(mend) = &failure.mend {
                    writeln!(f, "        To mend it: {mend}.")?;
                }
                let case = failure.case.as_deref().unwrap_or_default();
                case.lines()
                    .try_for_each(|line| writeln!(f, "        {line}"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn failures_come_with_their_mend_and_skips_are_loud() {
        let text = super::super::example().to_string();
        assert!(text.contains("FAILED  bad: "), "{text}");
        assert!(text.contains("To mend it: change ego.braking."), "{text}");
        assert!(
            text.ends_with("1 passed, 1 failed, 1 SKIPPED\nNOT CHECKED: left-out"),
            "{text}"
        );
    }
}
