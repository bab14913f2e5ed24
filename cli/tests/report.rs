//! The report, opened in a browser; skipped where there is none.

mod chromium;

use chromium::{browser, open};
use std::path::{Path, PathBuf};

fn url(page: &Path) -> String {
    format!("file://{}", page.display())
}

fn report(folder: &Path, shield: &str) -> PathBuf {
    let page = folder.join("report.html");
    assert_cmd::Command::cargo_bin("cede")
        .unwrap()
        .args(["evaluate", "--data", "synthetic", "--split", "test"])
        .args(["--driver", "replay,nearer-first", "--until", "cleared"])
        .args(["--shield", shield])
        .arg("--report")
        .arg(&page)
        .assert()
        .success();
    page
}

/// The element that begins with `begin` and ends with `end`.
fn part<'p>(page: &'p str, begin: &str, end: &str) -> &'p str {
    let from = page.find(begin).unwrap_or_else(|| panic!("no {begin}"));
    let length = page[from..].find(end).unwrap_or_else(|| panic!("no {end}"));
    &page[from..from + length]
}

#[test]
fn the_page_draws_itself_without_an_error() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let dom = open(&browser, &url(&report(folder.path(), "off")));
    let root = part(&dom, "<html", ">");
    assert!(!root.contains("data-error"), "{root}");
    assert!(root.contains("data-status=\"ready\""), "{root}");
    let table = part(&dom, "<tbody>", "</tbody>");
    assert_eq!(table.matches("<tr").count(), 2, "one row a driver");
    assert!(table.contains("nearer-first"));
    let section = |id: &str| part(&dom, &format!("<section id=\"{id}\""), "</section>");
    let hidden = |id: &str| part(section(id), "<section", ">").contains("hidden");
    assert!(part(&dom, "<p id=\"why\"", ">").contains("hidden"));
    for id in ["replay", "distributions"] {
        assert!(!hidden(id), "{id} is hidden");
        assert!(
            section(id).contains("<option"),
            "{id} has nothing to choose from"
        );
        assert!(section(id).contains("<path d=\"M"), "{id} has no curve");
    }
    assert!(hidden("shield") && hidden("sweep"), "no shield was on");
}

#[test]
fn the_page_says_where_and_why_the_shield_acted() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = url(&report(folder.path(), "on"));
    let dom = open(&browser, &page);
    let root = part(&dom, "<html", ">");
    assert!(!root.contains("data-error"), "{root}");
    let section = |id: &str| part(&dom, &format!("<section id=\"{id}\""), "</section>");
    let marked = |case: usize| {
        let dom = open(&browser, &format!("{page}#case={case}"));
        part(&dom, "<section id=\"replay\"", "</section>").contains("s: shielded: ")
    };
    assert!((0..8).any(marked), "no mark");
    assert!(section("shield").contains(" steps</span>"), "no reasons");
    assert_eq!(section("sweep").matches("class=\"named\"").count(), 4);
}

#[test]
fn a_broken_script_is_noticed() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = report(folder.path(), "off");
    let html = std::fs::read_to_string(&page).unwrap();
    let broken = html.replacen("tables(document", "tablez(document", 1);
    assert_ne!(html, broken);
    std::fs::write(&page, broken).unwrap();
    let dom = open(&browser, &url(&page));
    let root = part(&dom, "<html", ">");
    assert!(
        root.contains("data-error") && !root.contains("data-status"),
        "{root}"
    );
}

#[test]
fn the_page_needs_no_network() {
    let folder = tempfile::tempdir().unwrap();
    let html = std::fs::read_to_string(report(folder.path(), "off")).unwrap();
    for reference in [
        "src=\"http",
        "href=\"http",
        "url(http",
        "@import",
        "fetch(",
        "XMLHttpRequest",
    ] {
        assert!(!html.contains(reference), "{reference}");
    }
}
