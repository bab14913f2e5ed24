//! The report, opened in a browser; skipped where there is none.

use std::path::{Path, PathBuf};
use std::process::Command;

fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path)
        .flat_map(|folder| names.map(|name| folder.join(name)))
        .find(|candidate| candidate.is_file());
    if found.is_none() {
        cede_tests::skip("Chromium");
    }
    found
}

/// The page's elements after its scripts have run.
fn open(browser: &Path, page: &Path) -> String {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu"])
        .args([
            "--disable-background-networking",
            "--virtual-time-budget=5000",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(["--window-size=1280,2400", "--dump-dom"])
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    String::from_utf8(output.stdout).unwrap()
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
    let dom = open(&browser, &report(folder.path(), "off"));
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
    let dom = open(&browser, &report(folder.path(), "on"));
    let root = part(&dom, "<html", ">");
    assert!(!root.contains("data-error"), "{root}");
    let section = |id: &str| part(&dom, &format!("<section id=\"{id}\""), "</section>");
    assert!(section("replay").contains("s: shielded: "), "no mark");
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
    let dom = open(&browser, &page);
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
