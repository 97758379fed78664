//! A scene and the server of its page.

use std::path::Path;
use std::sync::Arc;

use nlmodes_scene::memory;

use super::ExploreError;
use super::answer::Explorer;
use super::server::Loopback;

/// A scene on a page of this machine.
pub struct Page {
    server: Loopback,
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
        let server = Loopback::bind(port)?;
        let explorer = Explorer::new(path, text, overrides, first, server.port())?;
        Ok(Self { server, explorer: Arc::new(explorer) })
    }

    /// The address of the page, for a browser on this machine; requests without it are not answered.
    pub fn address(&self) -> String {
        self.explorer.address()
    }

    /// Answers, each request in a thread of its own, until [`Page::end`] or the end of the program.
    pub fn serve(&self) {
        self.server.serve(&self.explorer);
    }

    /// Makes [`Page::serve`] return; a request in progress is completed.
    pub fn end(&self) {
        self.server.end();
    }
}
