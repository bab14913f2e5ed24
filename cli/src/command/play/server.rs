//! As much of HTTP as one page needs, for this machine alone.

use super::Asset;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::thread;
use std::time::Duration;

/// Bytes of a request that are read.
const LONGEST: u64 = 8192;
/// How long a browser may take to ask, or to read.
const PATIENCE: Duration = Duration::from_secs(5);

pub(super) struct Server {
    listener: TcpListener,
    address: SocketAddr,
}

impl Server {
    /// Listens at `port` of this machine, or at a free one if it is 0.
    pub(super) fn bind(port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        let address = listener.local_addr()?;
        Ok(Self { listener, address })
    }

    /// What a browser is told to open.
    pub(super) fn address(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Answers until the program ends. A browser that goes away or talks nonsense is no reason to.
    pub(super) fn serve(&self, page: &'static [Asset]) {
        for stream in self.listener.incoming().flatten() {
            thread::spawn(move || answer(&stream, page));
        }
    }
}

fn answer(stream: &TcpStream, page: &[Asset]) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let request = first_line(stream)?;
    let (status, kind, body) = response(&request, page);
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-cache\r\n\
         X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        body.len()
    );
    let mut stream = stream;
    stream.write_all(head.as_bytes())?;
    if !request.starts_with("HEAD ") {
        stream.write_all(body.as_bytes())?;
    }
    Ok(())
}

/// The first line of a request, whose other lines are read so that the connection ends in order.
fn first_line(stream: &TcpStream) -> io::Result<String> {
    let mut lines = BufReader::new(stream.take(LONGEST)).lines();
    let first = lines.next().unwrap_or(Ok(String::new()))?;
    for line in lines {
        if line?.is_empty() {
            break;
        }
    }
    Ok(first)
}

/// Status, type and text of what is asked for by the first line of a request.
fn response<'p>(request: &str, page: &'p [Asset]) -> (&'static str, &'static str, &'p str) {
    let plain = "text/plain; charset=utf-8";
    let mut words = request.split(' ');
    if !matches!(words.next(), Some("GET" | "HEAD")) {
        return ("405 Method Not Allowed", plain, "only GET and HEAD\n");
    }
    let path = words.next().unwrap_or_default();
    let path = path.split(['?', '#']).next().unwrap_or_default();
    let name = path.strip_prefix('/').unwrap_or(path);
    let found = match name {
        "" => page.first(),
        name => page.iter().find(|asset| asset.name == name),
    };
    match found {
        Some(asset) => ("200 OK", asset.kind, asset.text),
        None => ("404 Not Found", plain, "no such file\n"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: [Asset; 2] = [
        Asset {
            name: "index.html",
            kind: "text/html",
            text: "page",
        },
        Asset {
            name: "a.js",
            kind: "text/javascript",
            text: "script",
        },
    ];

    #[test]
    fn files_are_found_by_name_and_nothing_else_is() {
        for (request, status, body) in [
            ("GET / HTTP/1.1", "200 OK", "page"),
            ("GET /index.html HTTP/1.1", "200 OK", "page"),
            ("GET /a.js?v=1 HTTP/1.1", "200 OK", "script"),
            ("HEAD /a.js HTTP/1.1", "200 OK", "script"),
            (
                "GET /../Cargo.toml HTTP/1.1",
                "404 Not Found",
                "no such file\n",
            ),
            ("GET /b.js HTTP/1.1", "404 Not Found", "no such file\n"),
            (
                "POST / HTTP/1.1",
                "405 Method Not Allowed",
                "only GET and HEAD\n",
            ),
            ("", "405 Method Not Allowed", "only GET and HEAD\n"),
        ] {
            let (said, _, text) = response(request, &PAGE);
            assert_eq!((said, text), (status, body), "{request}");
        }
    }
}
