mod damped_mode;
mod forced;
mod phase_resonance;

pub use damped_mode::damped_mode;
pub use forced::{force_response, frequency_response};
pub use phase_resonance::phase_resonance;
