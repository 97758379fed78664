//! HTTP on the loopback interface: takes requests apart, and hands each to a thread of its own.

use std::io::{self, Read};
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::thread;

use tiny_http::{Header, Method, Request, Response, Server};

use super::answer::{Answer, Asked, Explorer};

/// Longest body that is read: values of sliders.
const LONGEST: u64 = 64 * 1024;

/// A server that listens on this machine only.
pub struct Loopback {
    server: Server,
    port: u16,
}

impl Loopback {
    /// Listens on a port of this machine; 0 is one that is free.
    ///
    /// # Errors
    /// If there is no such port.
    pub fn bind(port: u16) -> io::Result<Self> {
        let server = Server::http(SocketAddr::from((Ipv4Addr::LOCALHOST, port))).map_err(io::Error::other)?;
        let address = server.server_addr().to_ip().ok_or_else(|| io::Error::other("the server has no address"))?;
        Ok(Self { server, port: address.port() })
    }

    /// The port on which it listens.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// Answers until [`Loopback::end`].
    pub fn serve(&self, explorer: &Arc<Explorer>) {
        for request in self.server.incoming_requests() {
            let explorer = Arc::clone(explorer);
            thread::spawn(move || answer(&explorer, request));
        }
    }

    /// Ends it.
    pub fn end(&self) {
        self.server.unblock();
    }
}

fn answer(explorer: &Explorer, mut request: Request) {
    let header = |request: &Request, name: &'static str| {
        let found = request.headers().iter().find(|header| header.field.equiv(name));
        found.map(|header| header.value.as_str().to_owned())
    };
    let mut body = String::new();
    let is_read = request.as_reader().take(LONGEST + 1).read_to_string(&mut body).is_ok();
    let asked = Asked {
        is_post: *request.method() == Method::Post,
        is_get: *request.method() == Method::Get,
        path: request.url().to_owned(),
        host: header(&request, "Host"),
        origin: header(&request, "Origin"),
        body: (is_read && body.len() as u64 <= LONGEST).then_some(body),
    };
    let Answer { status, kind, text } = explorer.answer(&asked);
    let policy = nlmodes::report::explore::POLICY;
    let headers = [
        ("Content-Type", kind),
        ("Content-Security-Policy", policy),
        ("Cache-Control", "no-store"),
        ("X-Content-Type-Options", "nosniff"),
        ("Referrer-Policy", "no-referrer"),
    ];
    let mut response = Response::from_string(text).with_status_code(status);
    for header in headers.iter().filter_map(|(name, value)| Header::from_bytes(*name, *value).ok()) {
        response.add_header(header);
    }
    // The client may have disconnected.
    drop(request.respond(response));
}
