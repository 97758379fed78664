//! A headless Chromium, through the WebDriver protocol that ChromeDriver speaks.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use tempfile::TempDir;

const FLAGS: [&str; 10] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    // Name resolution would fail.
    "--host-resolver-rules=MAP * ~NOTFOUND",
];
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// A page in its own browser.
pub struct Browser {
    driver: Child,
    session: String,
    _profile: TempDir,
}

impl Browser {
    /// Opens the page in a window of this size; `None`, with a message, where there is no Chromium with ChromeDriver.
    ///
    /// With the environment variable `NLMODES_REQUIRE_BROWSER` that is a failure.
    pub fn open(page: &Path, (width, height): (u32, u32), flags: &[&str]) -> Option<Self> {
        let found = found("chromedriver").then(|| BROWSERS.into_iter().find(|name| found(name))).flatten();
        let Some(name) = found else {
            assert!(std::env::var_os("NLMODES_REQUIRE_BROWSER").is_none(), "no Chromium with ChromeDriver on the path");
            println!("skipped: no Chromium with ChromeDriver on the path");
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        let (driver, port) = start();
        let own = [format!("--user-data-dir={}", profile.path().display()), format!("--window-size={width},{height}")];
        let arguments: Vec<&str> =
            FLAGS.into_iter().chain(own.iter().map(String::as_str)).chain(flags.to_vec()).collect();
        let options = json!({ "binary": path_of(name), "args": arguments });
        let logs = json!({ "browser": "ALL", "performance": "ALL" });
        let wanted = json!({ "browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": logs });
        let base = format!("http://127.0.0.1:{port}/session");
        let answer = post(&base, &json!({ "capabilities": { "alwaysMatch": wanted } }));
        let session = format!("{base}/{}", answer["sessionId"].as_str().expect("a session"));
        let browser = Self { driver, session, _profile: profile };
        browser.send("url", &json!({ "url": format!("file://{}", page.display()) }));
        Some(browser)
    }

    /// What the body of a function returns in the page.
    pub fn run(&self, script: &str) -> Value {
        self.send("execute/sync", &json!({ "script": script, "args": [] }))
    }

    pub fn text(&self, script: &str) -> String {
        self.run(script).as_str().unwrap_or_default().to_owned()
    }

    pub fn number(&self, script: &str) -> f64 {
        self.run(script).as_f64().unwrap_or(f64::NAN)
    }

    /// Moves the mouse to pixels of the window.
    pub fn point_at(&self, (x, y): (f64, f64)) {
        self.mouse(vec![move_to(x, y)]);
    }

    pub fn click(&self, (x, y): (f64, f64)) {
        self.mouse(vec![move_to(x, y), press(true), press(false)]);
    }

    pub fn double_click(&self, (x, y): (f64, f64)) {
        self.mouse(vec![move_to(x, y), press(true), press(false), press(true), press(false)]);
    }

    pub fn drag(&self, from: (f64, f64), to: (f64, f64)) {
        self.mouse(vec![move_to(from.0, from.1), press(true), move_to(to.0, to.1), press(false)]);
    }

    /// Turns the wheel by pixels, downwards positive.
    pub fn wheel(&self, (x, y): (f64, f64), by: i32) {
        let turn = json!({ "type": "scroll", "x": x as i64, "y": y as i64, "deltaX": 0, "deltaY": by });
        self.send("actions", &json!({ "actions": [{ "type": "wheel", "id": "wheel", "actions": [turn] }] }));
    }

    /// Presses keys one after another; special ones as in the WebDriver standard.
    pub fn keys(&self, keys: &str) {
        let strokes =
            keys.chars().flat_map(|key| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": key })));
        let actions: Vec<Value> = strokes.collect();
        self.send("actions", &json!({ "actions": [{ "type": "key", "id": "keys", "actions": actions }] }));
    }

    /// What the page wrote to the console: errors of scripts, refusals of the policy.
    pub fn console(&self) -> Vec<Value> {
        self.send("se/log", &json!({ "type": "browser" })).as_array().cloned().unwrap_or_default()
    }

    /// Every address requested by a document from a file, including itself; not those of the browser's own first page.
    pub fn requests(&self) -> Vec<String> {
        let log = self.send("se/log", &json!({ "type": "performance" }));
        let entries = log.as_array().expect("a log").iter();
        let messages = entries.filter_map(|entry| serde_json::from_str::<Value>(entry["message"].as_str()?).ok());
        let sent = messages.filter(|message| message["message"]["method"] == "Network.requestWillBeSent");
        let request = |message: Value| {
            let parameters = &message["message"]["params"];
            let is_own = parameters["documentURL"].as_str()?.starts_with("file:");
            is_own.then(|| parameters["request"]["url"].as_str().map(str::to_owned)).flatten()
        };
        sent.filter_map(request).collect()
    }

    fn mouse(&self, actions: Vec<Value>) {
        self.send("actions", &json!({ "actions": [{ "type": "pointer", "id": "mouse", "actions": actions }] }));
    }

    fn send(&self, command: &str, body: &Value) -> Value {
        post(&format!("{}/{command}", self.session), body)
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // The driver ends the browser when its session is deleted.
        let _ = ureq::delete(&self.session).call();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

fn start() -> (Child, u16) {
    let mut driver =
        Command::new("chromedriver").arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let lines = BufReader::new(driver.stdout.take().unwrap()).lines();
    let port = lines.map_while(Result::ok).find_map(|line| {
        let digits = line.rsplit_once("on port ")?.1.trim_end_matches('.').to_owned();
        line.contains("successfully").then(|| digits.parse().ok()).flatten()
    });
    (driver, port.expect("the port on which the driver listens"))
}

fn post(address: &str, body: &Value) -> Value {
    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
    let mut answer = agent.post(address).content_type("application/json").send(body.to_string()).unwrap();
    let answer: Value = serde_json::from_str(&answer.body_mut().read_to_string().unwrap()).unwrap();
    assert!(answer["value"]["error"].is_null(), "{address} {body}: {}", answer["value"]);
    answer["value"].clone()
}

fn move_to(x: f64, y: f64) -> Value {
    // The browser truncates fractions of pixels, an error of up to one pixel.
    let (x, y) = (x.round(), y.round());
    json!({ "type": "pointerMove", "duration": 0, "x": x, "y": y, "origin": "viewport" })
}

fn press(down: bool) -> Value {
    json!({ "type": if down { "pointerDown" } else { "pointerUp" }, "button": 0 })
}

fn found(name: &str) -> bool {
    path_of(name).is_some()
}

fn path_of(name: &str) -> Option<String> {
    let path = std::env::var_os("PATH")?;
    let file = std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file())?;
    Some(file.to_string_lossy().into_owned())
}
