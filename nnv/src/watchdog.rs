//! A limit of time for work that does not look at the clock itself, such as reading a file.

use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// Does the work on a thread of its own, and gives its result if it comes in time. Otherwise the
/// work goes on until the process ends. Panics where the work does.
pub fn within<T: Send + 'static>(
    limit: Duration,
    work: impl FnOnce() -> T + Send + 'static,
) -> Option<T> {
    let (sender, receiver) = mpsc::channel();
    let worker = thread::spawn(move || {
        // Nobody waits any more if the limit has passed.
        let _ = sender.send(work());
    });
    match receiver.recv_timeout(limit) {
        Ok(result) => Some(result),
        Err(mpsc::RecvTimeoutError::Timeout) => None,
        Err(mpsc::RecvTimeoutError::Disconnected) => match worker.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => None,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_work_is_not_waited_for() {
        assert_eq!(within(Duration::from_secs(60), || 7), Some(7));
        let endless = || loop {
            thread::park();
        };
        assert_eq!(within::<()>(Duration::from_millis(1), endless), None);
    }
}
