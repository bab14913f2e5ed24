//! Lines on the host's standard output, without `core::fmt`.

use crate::board::write;

/// Writes `text`, or `text: number`.
pub(crate) fn line(text: &str, number: Option<u32>) {
    write(text.as_bytes());
    if let Some(number) = number {
        write(b": ");
        let mut digits = [b'0'; 10];
        write(decimal(number, &mut digits));
    }
    write(b"\n");
}

fn decimal(mut number: u32, digits: &mut [u8; 10]) -> &[u8] {
    let mut length = 0;
    for digit in digits.iter_mut().rev() {
        *digit = b'0' + (number % 10) as u8;
        number /= 10;
        length += 1;
        if number == 0 {
            break;
        }
    }
    digits
        .last_chunk::<10>()
        .and_then(|d| d.get(10 - length..))
        .unwrap_or(b"?")
}
