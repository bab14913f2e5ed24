//! `cede play`: the page, served and written, and opened in a browser where there is one.

mod chromium;

use chromium::{browser, open};
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

const MOST_BYTES: u64 = 1_000_000;

fn cede(arguments: &[&str]) -> assert_cmd::assert::Assert {
    assert_cmd::Command::new(env!("CARGO_BIN_EXE_cede"))
        .args(arguments)
        .assert()
}

fn written() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    cede(&["play", "--out", folder.path().to_str().unwrap()]).success();
    folder
}

fn names(folder: &Path) -> BTreeSet<String> {
    std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect()
}

/// A server that ends with the test.
struct Served {
    child: Child,
    address: String,
}

impl Served {
    fn start(options: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_cede"))
            .arg("play")
            .args(options)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        output.read_line(&mut line).unwrap();
        let address = line.split(' ').next().unwrap();
        let address = address
            .strip_prefix("http://")
            .unwrap()
            .trim_end_matches('/');
        Self {
            address: address.to_owned(),
            child,
        }
    }

    fn get(&self, path: &str) -> Vec<u8> {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        write!(
            stream,
            "GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n",
            self.address
        )
        .unwrap();
        let mut response = Vec::new();
        stream.read_to_end(&mut response).unwrap();
        response
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn the_folder_is_the_one_in_docs_and_small() {
    let folder = written();
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/play");
    assert_eq!(names(folder.path()), names(&page));
    let mut bytes = 0;
    for name in names(&page) {
        let text = std::fs::read(page.join(&name)).unwrap();
        assert_eq!(
            std::fs::read(folder.path().join(&name)).unwrap(),
            text,
            "{name}"
        );
        bytes += text.len() as u64;
    }
    assert!(bytes <= MOST_BYTES, "{bytes}");
}

#[test]
fn what_the_page_refers_to_is_beside_it() {
    let folder = written();
    let page = std::fs::read_to_string(folder.path().join("index.html")).unwrap();
    let files = names(folder.path());
    let mut scripts = 0;
    for part in page.split("src=\"").skip(1) {
        let name = part.split('"').next().unwrap();
        assert!(files.contains(name), "{name}");
        scripts += 1;
    }
    assert_eq!(scripts + 2, files.len(), "a script, the page or the style");
    for name in &files {
        let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
        for reference in [
            "http:",
            "https:",
            "url(",
            "@import",
            "fetch(",
            "XMLHttpRequest",
        ] {
            assert!(!text.contains(reference), "{name}: {reference}");
        }
    }
}

#[test]
fn it_is_served_at_a_free_port_of_this_machine() {
    let served = Served::start(&[]);
    assert!(
        served.address.starts_with("127.0.0.1:"),
        "{}",
        served.address
    );
    let page = String::from_utf8(served.get("/")).unwrap();
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n"), "{page}");
    assert!(
        page.contains("text/html") && page.ends_with("</html>\n"),
        "{page}"
    );
    let script = served.get("/module.js");
    let text = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/play/module.js"));
    assert!(script.ends_with(&text.unwrap()));
    assert!(served.get("/none").starts_with(b"HTTP/1.1 404"));
    assert!(served.get("/../Cargo.toml").starts_with(b"HTTP/1.1 404"));

    let port = served.address.rsplit(':').next().unwrap();
    let taken = cede(&["play", "--no-open", "--port", port]).code(3);
    let said = String::from_utf8(taken.get_output().stderr.clone()).unwrap();
    assert!(
        said.contains("cannot serve at port") && said.contains("leave out --port"),
        "{said}"
    );
}

#[cfg(unix)]
#[test]
fn a_signal_ends_it_with_code_4() {
    let mut served = Served::start(&["--no-open"]);
    let sent = Command::new("kill")
        .args(["-INT", &served.child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
    assert_eq!(served.child.wait().unwrap().code(), Some(4));
}

#[test]
fn options_that_would_be_ignored_are_refused() {
    for option in [&["--port", "8000"][..], &["--no-open"]] {
        cede(&[&["play", "--out", "nowhere"], option].concat()).code(2);
    }
    cede(&["play", "--port", "70000"]).code(2);
}

/// The element that begins with `begin`.
fn part<'p>(page: &'p str, begin: &str, end: &str) -> &'p str {
    let from = page.find(begin).unwrap_or_else(|| panic!("no {begin}"));
    let length = page[from..].find(end).unwrap_or_else(|| panic!("no {end}"));
    &page[from..from + length]
}

/// The page in `folder`, at a moment at which the shield has acted.
fn playground(folder: &Path) -> String {
    format!("file://{}/index.html#site=ring&at=3", folder.display())
}

#[test]
fn the_page_drives_from_the_disk_without_an_error() {
    let Some(browser) = browser() else { return };
    let folder = written();
    let dom = open(&browser, &playground(folder.path()));
    let root = part(&dom, "<html", ">");
    assert!(
        root.contains("data-status=\"ready\"") && !root.contains("data-error"),
        "{root}"
    );
    assert!(part(&dom, "<ol id=\"log\"", "</ol>").contains("data-tone=\"shielded\""));

    // A test that cannot fail says nothing: without its controller the page tells it.
    std::fs::write(folder.path().join("module.js"), "const CEDE_MODULE = \"\";").unwrap();
    let dom = open(&browser, &playground(folder.path()));
    assert!(part(&dom, "<html", ">").contains("data-error"));
}
