//! The report, opened in a browser; skipped where there is none.

mod chromium;

use cede_controller::{Footprint, Point, Pose, UnitVector, Vector};
use cede_sim::judge::Judge;
use chromium::{browser, open};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The pages that the tests look at, each made once: without the shield, with it, with both, and of trainings.
static OFF: LazyLock<String> = LazyLock::new(|| report("off"));
static ON: LazyLock<String> = LazyLock::new(|| report("on"));
static BOTH: LazyLock<String> = LazyLock::new(|| report("both"));
static TRAINED: LazyLock<String> = LazyLock::new(trained);

fn report(shield: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("report.html");
    let mut evaluate = assert_cmd::Command::cargo_bin("cede").unwrap();
    let ended = evaluate
        .args(["evaluate", "--data", "synthetic", "--split", "test"])
        .args(["--driver", "replay,nearer-first", "--until", "cleared"])
        .args(["--shield", shield])
        .arg("--report")
        .arg(&page)
        .assert()
        .success();
    let told = String::from_utf8_lossy(&ended.get_output().stderr);
    let line = format!("report in {}\n", page.display());
    assert!(told.contains(&line), "{told}");
    std::fs::read_to_string(page).unwrap()
}

/// The report of trainings from two seeds.
fn trained() -> String {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "reproduce --data synthetic --encounters 60 --rows bc --seeds 2 --set bc.updates=20 --set bc.width=16";
    assert_cmd::Command::cargo_bin("cede")
        .unwrap()
        .args(arguments.split(' '))
        .arg("--out")
        .arg(folder.path())
        .assert()
        .success();
    std::fs::read_to_string(folder.path().join("report.html")).unwrap()
}

/// A page as a file of its own, for as long as this lives.
struct Opened {
    folder: tempfile::TempDir,
}

impl Opened {
    fn new(html: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("report.html"), html).unwrap();
        Self { folder }
    }

    fn url(&self) -> String {
        format!(
            "file://{}",
            self.folder.path().join("report.html").display()
        )
    }
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
    let dom = open(&browser, &Opened::new(&OFF).url());
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
    let page = Opened::new(&ON);
    let dom = open(&browser, &page.url());
    let root = part(&dom, "<html", ">");
    assert!(!root.contains("data-error"), "{root}");
    let section = |id: &str| part(&dom, &format!("<section id=\"{id}\""), "</section>");
    let marked = |case: usize| {
        let dom = open(&browser, &format!("{}#case={case}", page.url()));
        part(&dom, "<section id=\"replay\"", "</section>").contains("s: shielded: ")
    };
    assert!((0..8).any(marked), "no mark");
    assert!(section("shield").contains(" steps</span>"), "no reasons");
    assert_eq!(section("sweep").matches("class=\"named\"").count(), 4);
}

/// The page with a script at its end, as the browser leaves it.
fn open_with(browser: &Path, html: &str, script: &str) -> String {
    let script = format!(
        "<pre id=\"told\"></pre><script>{}</script></body>",
        script.replace("</", "<\\/")
    );
    let tried = Opened::new(&html.replace("</body>", &script));
    let dom = open(browser, &tried.url());
    part(&dom, "<pre id=\"told\">", "</pre>").replace("<pre id=\"told\">", "")
}

/// What ends as the text of the page's `told`, from a script that calls `tell`.
const TELL: &str =
    "const tell = (what) => { document.getElementById('told').textContent = what; };";

#[test]
fn the_worst_moments_open_their_replay() {
    let Some(browser) = browser() else { return };
    let dom = open(&browser, &Opened::new(&OFF).url());
    let gallery = part(&dom, "<section id=\"gallery\"", "</section>");
    assert!(
        gallery.contains("Face-offs") || gallery.contains("Near misses"),
        "{gallery}"
    );
    let told = open_with(
        &browser,
        &OFF,
        &format!(
            "{TELL}
        const link = document.querySelector('#moments a');
        link.click();
        const at = (id) => document.getElementById(id);
        setTimeout(() => tell([
            report.cases[at('case').value].name === link.textContent,
            link.nextSibling.textContent.startsWith(at('driver').value + ': '),
            Number(at('time').value) >= linked().time,
        ].join()), 300);
    "
        ),
    );
    assert_eq!(told, "true,true,true");
}

#[test]
fn a_report_on_trainings_tells_its_seed_and_opens_with_what_was_trained() {
    let Some(browser) = browser() else { return };
    let page = &TRAINED;
    let told = open_with(
        &browser,
        page,
        &format!(
            "{TELL}
        const at = (id) => document.getElementById(id);
        tell([
            at('summary').firstChild.textContent.includes('seed 0 alone'),
            at('driver').value,
            at('chart-legend').textContent.includes(`six of ${{at('driver').length}} drivers shown`),
        ].join());
    "
        ),
    );
    assert_eq!(told, "true,bc,true");
}

#[test]
fn margins_show_only_what_has_values() {
    let Some(browser) = browser() else { return };
    let page = &TRAINED;
    let script = "
        const at = (id) => document.getElementById(id);
        const margins = [at('pet').parentElement.hidden, at('distribution-legend').textContent.includes('recorded')];
        const [lone, row] = [at('ttc').parentElement, at('ttc').closest('.row')].map((e) => e.clientWidth);
        tell([...margins, 2 * lone < row].join());";
    let told = open_with(&browser, page, &format!("{TELL} {script}"));
    assert_eq!(told, "true,false,true", "episodes until the first arrival");
    let told = open_with(&browser, &OFF, &format!("{TELL} {script}"));
    assert_eq!(told, "false,true,true", "episodes until both have left");
}

#[test]
fn every_trained_row_is_shown_before_those_behind_a_shield_and_baselines() {
    let Some(browser) = browser() else { return };
    let page = &OFF;
    let script = "
        const shields = ['', ' + shield (all-way stop)', ' + shield (worst case)'];
        const rows = ['idm', 'bc', 'sacer-v', 'sacer-svo', 'apg'].flatMap((row) => shields.map((shield) => ({ driver: row + shield })));
        tell(few(rows).map(({ driver }) => driver).join());";
    let told = open_with(&browser, page, &format!("{TELL} {script}"));
    let behind = "bc + shield (all-way stop),bc + shield (worst case)";
    assert_eq!(told, format!("bc,{behind},sacer-v,sacer-svo,apg"));
}

#[test]
fn the_papers_rows_stand_below_those_of_its_protocol() {
    let Some(browser) = browser() else { return };
    let page = &BOTH;
    let script = "
        const drawn = (row) => {
            const host = document.createElement('div');
            const published = { driver: 'paper: BC', split: 'test', priority_accuracy: 0.6471, episode_length_error: 0.5759, collisions: 0 };
            const rows = report.rows.map((r) => ({ ...r, ...row }));
            summary(host, { ...report, rows, paper: [published] });
            return [...host.querySelectorAll('tr.paper td')].map((cell) => cell.textContent).join('|');
        };
        tell(drawn({ until: 'conflict' }) + ';' + drawn({ until: 'cleared' }));";
    let told = open_with(&browser, page, &format!("{TELL} {script}"));
    assert_eq!(told, "paper: BC|64.7 %|0.576|0|||||;");
}

#[test]
fn a_chart_is_saved_with_its_colours() {
    let Some(browser) = browser() else { return };
    let page = &OFF;
    let script = format!(
        "{TELL}
        const files = [];
        const make = URL.createObjectURL;
        URL.createObjectURL = (blob) => {{ files.push(blob); return make.call(URL, blob); }};
        const buttons = document.getElementById('st-left').closest('figure').querySelectorAll('.save button');
        (async () => {{
            for (const button of [...buttons, document.querySelector('.scene .save button')]) await button.onclick();
            const chart = await files[0].text();
            const kinds = files.map((file) => file.type);
            tell([kinds.join(), chart.includes('var('), /stroke:rgb/.test(chart), files.every((f) => f.size > 1000)].join(' '));
        }})();"
    );
    // The browser's time runs on while an image is decoded: on a busy machine it may be over first.
    let mut attempts = (0..5).map(|_| open_with(&browser, page, &script));
    let told = attempts.find(|told| !told.is_empty()).unwrap_or_default();
    let kinds = "image/svg+xml,image/svg+xml,image/png,image/png";
    assert_eq!(told, format!("{kinds} false true true"));
}

/// axe-core: the file in `AXE`, or as `.ci/run` installs it.
fn axe() -> Option<String> {
    let installed = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../.build/axe/node_modules/axe-core/axe.min.js");
    let path = std::env::var_os("AXE").map_or(installed, PathBuf::from);
    let script = std::fs::read_to_string(path).ok();
    if script.is_none() {
        cede_tests::skip("axe-core (AXE, or npm install --prefix .build/axe axe-core@4)");
    }
    script
}

#[test]
fn the_page_is_accessible() {
    let (Some(browser), Some(axe)) = (browser(), axe()) else {
        return;
    };
    let page = &BOTH;
    let audit = |before: &str| {
        let rules = "['wcag2a', 'wcag2aa', 'wcag21aa', 'best-practice']";
        let script = format!("{TELL} {before} {axe};
            axe.run({{ runOnly: {rules} }}).then(({{ violations, passes }}) =>
                tell(`${{passes.length > 20}} ${{violations.map((v) => v.id + ': ' + v.nodes[0].target).join('; ')}}`));");
        open_with(&browser, page, &script)
    };
    assert_eq!(audit("").trim(), "true");
    assert_eq!(
        audit("document.documentElement.style.colorScheme = 'dark';").trim(),
        "true"
    );
    let broken = audit("document.getElementById('case').parentElement.firstChild.remove();");
    assert!(broken.contains("select-name"), "{broken}");
}

#[test]
fn a_broken_script_is_noticed() {
    let Some(browser) = browser() else { return };
    let broken = OFF.replacen("tables(document", "tablez(document", 1);
    assert_ne!(*OFF, broken);
    let dom = open(&browser, &Opened::new(&broken).url());
    let root = part(&dom, "<html", ">");
    assert!(
        root.contains("data-error") && !root.contains("data-status"),
        "{root}"
    );
}

#[test]
fn the_page_needs_no_network() {
    for reference in [
        "src=\"http",
        "href=\"http",
        "url(http",
        "@import",
        "fetch(",
        "XMLHttpRequest",
    ] {
        assert!(!OFF.contains(reference), "{reference}");
    }
}

fn numbers(values: &Value) -> Vec<f32> {
    let values = values.as_array().unwrap().iter();
    values.map(|value| value.as_f64().unwrap() as f32).collect()
}

/// Where a drawn vehicle is, at `step` and between steps: as the page's `pose` and `sample` have it.
fn drawn(route: &Value, s: &Value, step: f32) -> Option<Pose> {
    let s = numbers(s);
    let (below, above) = (step.floor() as usize, step.ceil() as usize);
    let mut left = s.get(below)? + step.fract() * (s.get(above)? - s[below]);
    let points: Vec<[f32; 2]> = route
        .as_array()
        .unwrap()
        .iter()
        .map(|p| numbers(p).try_into().unwrap())
        .collect();
    for (i, pair) in points.windows(2).enumerate() {
        let ([ax, ay], [bx, by]) = (pair[0], pair[1]);
        let length = (bx - ax).hypot(by - ay);
        if left <= length || i + 2 == points.len() {
            let f = left / length;
            let position = Point::new(ax + f * (bx - ax), ay + f * (by - ay));
            let direction = UnitVector::new_normalize(Vector::new(bx - ax, by - ay));
            return Some(Pose {
                position,
                direction,
            });
        }
        left -= length;
    }
    None
}

/// Whether two vehicles that the replay of `drive` draws touch, by rapier2d; the two judged ones among each other where
/// `judged` says so. `left_out` are the places of those that are not drawn.
fn touch(case: &Value, drive: &Value, left_out: &[usize], judged: bool) -> bool {
    let around = case["around"].as_array().unwrap();
    let size = |vehicle: &Value| numbers(&vehicle["size"]);
    let sizes = around.iter().map(|vehicle| Footprint {
        length: size(vehicle)[0],
        width: size(vehicle)[1],
    });
    let mut judge = Judge::new(
        &[Footprint::PAPER; 2]
            .into_iter()
            .chain(sizes)
            .collect::<Vec<_>>(),
    );
    let steps = drive["s"][0].as_array().unwrap().len();
    (0..2 * steps - 1)
        .map(|half| 0.5 * half as f32)
        .any(|step| {
            let own = (0..2).map(|i| drawn(&case["vehicles"][i]["route"], &drive["s"][i], step));
            let others = around.iter().enumerate().map(|(i, vehicle)| {
                let since = step - vehicle["appears"].as_f64().unwrap() as f32;
                let shown = since >= 0.0 && !left_out.contains(&i);
                shown
                    .then(|| drawn(&vehicle["route"], &vehicle["s"], since))
                    .flatten()
            });
            let poses: Vec<Option<Pose>> = own.chain(others).collect();
            judge
                .touching(&poses)
                .any(|(a, b)| a < 2 && (judged || b >= 2))
        })
}

#[test]
fn no_replay_of_the_demo_shows_a_car_that_drives_through_another() {
    let folder = tempfile::tempdir().unwrap();
    let mut demo = assert_cmd::Command::cargo_bin("cede").unwrap();
    demo.current_dir(folder.path()).assert().success();
    let html = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    let begin = "<script id=\"data\" type=\"application/json\">";
    let json = part(&html, begin, "</script>").trim_start_matches(begin);
    let page: Value = serde_json::from_str(json).unwrap();
    let (mut shielded, mut met) = (0, false);
    for case in page["cases"].as_array().unwrap() {
        for drive in case["drives"].as_array().unwrap() {
            let driver = drive["driver"].as_str().unwrap();
            let behind = driver.contains("+ shield");
            let left_out: Vec<usize> = numbers(&drive["left_out"])
                .iter()
                .map(|&i| i as usize)
                .collect();
            assert!(
                !touch(case, drive, &left_out, behind),
                "{}: {driver}",
                case["name"]
            );
            shielded += usize::from(behind);
            met = met || touch(case, drive, &[], false);
        }
    }
    assert!(shielded > 0);
    assert!(
        met,
        "nobody was in the way of anybody: the check shows nothing"
    );
}
