//! HTTP on the loopback interface: takes requests apart, and hands each to a thread of its own.

use std::io::{self, Read};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::sync::Arc;
use std::thread;

use nlmodes_scene::memory;
use tiny_http::{Header, Method, Request, Response, Server};

use super::ExploreError;
use super::answer::{Answer, Asked, Explorer};

/// Longest body that is read: values of sliders.
const LONGEST: u64 = 64 * 1024;

/// A scene on a page of this machine.
pub struct Page {
    server: Server,
    explorer: Arc<Explorer>,
}

impl Page {
    /// Reads and checks the scene, with `overrides` as `--set` takes them, and takes a port of this machine; 0 is one
    /// that is free.
    ///
    /// # Errors
    /// [`ExploreError`] where the scene cannot be read or is not sound, and where the machine gives no such port.
    pub fn open(path: &Path, overrides: Vec<String>, port: u16) -> Result<Self, ExploreError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ExploreError::Unreadable { path: path.to_path_buf(), source })?;
        let mut files = nlmodes_scene::parse_each_method(&path.display().to_string(), &text, &overrides)?;
        memory::admit(&mut files, None)?;
        let first = files.first().ok_or_else(|| ExploreError::NoScene(path.to_path_buf()))?;
        let server = Server::http(SocketAddr::from((Ipv4Addr::LOCALHOST, port))).map_err(io::Error::other)?;
        let address = server.server_addr().to_ip().ok_or_else(|| io::Error::other("the server has no address"))?;
        let explorer = Explorer::new(path, text, overrides, first, address.port())?;
        Ok(Self { server, explorer: Arc::new(explorer) })
    }

    /// The address of the page, for a browser on this machine; requests without it are not answered.
    pub fn address(&self) -> String {
        self.explorer.address()
    }

    /// Answers, each request in a thread of its own, until [`Page::end`] or the end of the program.
    pub fn serve(&self) {
        for request in self.server.incoming_requests() {
            let explorer = Arc::clone(&self.explorer);
            thread::spawn(move || answer(&explorer, request));
        }
    }

    /// Makes [`Page::serve`] return; a request in progress is completed.
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
