use std::process::ExitCode;

/// How a command ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// All was done.
    Done,
    /// The computation ended early, or has no answer; its results are written, and the reason is reported.
    EndedEarly,
    /// The scene or the call is wrong; nothing is written.
    Wrong,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        match status {
            Status::Done => Self::from(0),
            Status::EndedEarly => Self::from(1),
            Status::Wrong => Self::from(2),
        }
    }
}
