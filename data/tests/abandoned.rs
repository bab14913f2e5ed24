//! What is half-written when the program ends does not stay. A test file of its own: nothing can be written afterwards.

use cede_data::output;
use std::sync::mpsc;
use std::time::Duration;

#[test]
fn an_abandoned_file_is_deleted_and_none_follows() {
    let folder = tempfile::tempdir().unwrap();
    let files = || std::fs::read_dir(folder.path()).unwrap().count();
    let (begun, begins) = mpsc::channel();
    let (goes_on, go_on) = mpsc::channel();
    let (done, ends) = mpsc::channel();
    let path = folder.path().join("table.csv");
    std::thread::spawn(move || {
        let written = output::write(&path, |file| {
            file.write_all(b"half")?;
            begun.send(()).unwrap();
            go_on.recv().unwrap();
            file.write_all(b"whole")
        });
        done.send(written.is_ok()).unwrap();
    });
    begins.recv().unwrap();
    assert_eq!(files(), 1);
    output::abandon();
    assert_eq!(files(), 0);
    goes_on.send(()).unwrap();
    let waits = ends.recv_timeout(Duration::from_millis(200));
    assert_eq!(waits, Err(mpsc::RecvTimeoutError::Timeout));
    assert_eq!(files(), 0);
}
