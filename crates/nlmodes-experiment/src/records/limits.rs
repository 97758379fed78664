//! Limits that keep a wrong header from taking all memory.

use std::io::Read;

use crate::records::RecordError;

/// Most bytes of a file.
pub const MAX_BYTES: u64 = 1 << 31;
/// Most channels of a file.
pub const MAX_CHANNELS: usize = 4096;

/// All bytes of a source, if they are not too many.
pub fn read_all(source: impl Read) -> Result<Vec<u8>, RecordError> {
    let mut bytes = Vec::new();
    source.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_BYTES { Err(RecordError::TooLarge { limit: MAX_BYTES }) } else { Ok(bytes) }
}
