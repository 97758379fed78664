//! Records of a test: channels with quantity, unit, role and position, read from and written to files.
//!
//! ```text
//! file  →  RecordTable (numbers as recorded)  →  Record (channels in SI units)
//! ```
//!
//! | format | names of channels | sampling rate |
//! | --- | --- | --- |
//! | CSV, [`read_csv`] | header | time column |
//! | Universal File 58 and 58b, [`read_uff`] | header | header, or its abscissa |
//! | WAV, [`read_wav`] | none: in the order of the description | header |
//! | TDMS, [`read_tdms`] | header | header |
//! | NumPy, [`read_npy`] | none: in the order of the description | none |
//!
//! Readers take memory as numbers come, never as a header announces, and answer a malformed file with an error that
//! names the place.

mod channel;
mod common_time;
mod csv;
mod declared;
mod error;
mod file;
mod flag;
mod limits;
mod npy;
mod quantity;
mod record;
mod remark;
mod sample_rate;
mod table;
mod tdms;
mod time_axis;
mod uff;
mod uneven;
mod unit;
mod wav;

pub use channel::{Channel, Role};
pub use common_time::Start;
pub use csv::{TIME_COLUMN, read_csv, write_csv};
pub use declared::{Declared, DeclaredQuantity, UnitSystem};
pub use error::RecordError;
pub use file::{Recording, write_record};
pub use flag::Flag;
pub use npy::{read_npy, write_npy};
pub use quantity::Quantity;
pub use record::Record;
pub use remark::Remark;
pub use sample_rate::SampleRate;
pub use table::{Column, RecordTable};
pub use tdms::read_tdms;
pub use uff::{
    Abscissa, Axis, ByteOrder, Dataset58, Node, Ordinates, Precision, Storage, UffError, read_uff, read_uff58,
    write_uff, write_uff58,
};
pub use uneven::TimeAxis;
pub use wav::{read_wav, write_wav};
