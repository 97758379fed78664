mod appropriation;
mod detached;
mod doubled;
mod forced;
mod mode;
mod phase_resonance;
mod touching;

pub use appropriation::{Appropriation, appropriation};
pub use detached::{detached_response, lies_on};
pub(crate) use forced::{WINDOW, scales};
pub use forced::{branching_responses, force_response, frequency_response, response_from_other_end};
pub use mode::{conservative_mode, damped_mode};
pub use phase_resonance::phase_resonance;
