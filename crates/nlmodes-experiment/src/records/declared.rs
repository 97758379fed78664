//! The description of a column in the file, compared with that in the scene.

use std::fmt;

use crate::records::unit::{UnitWord, read};
use crate::records::{Channel, Quantity, RecordError, Remark};

/// Relative difference of factors that counts as the same unit.
const SAME_UNIT: f64 = 1e-3;
/// Factor within which a sensitivity corrects the calibration and does not change the unit.
const CALIBRATION: f64 = 2.0;

/// Quantity of a column according to the file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum DeclaredQuantity {
    /// Nothing, or a general one.
    #[default]
    Unknown,
    /// One that channels measure.
    Known(Quantity),
    /// One that channels do not measure, for instance a strain.
    Other(&'static str),
}

/// Units of all numbers of a file, as the number per SI unit.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitSystem {
    /// Its name in the file.
    pub name: String,
    /// Units of length in a metre.
    pub length: f64,
    /// Units of force in a newton.
    pub force: f64,
}

/// Description of a column in the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Declared {
    /// What is measured.
    pub quantity: DeclaredQuantity,
    /// Unit of the column; empty if none.
    pub unit: String,
    /// Units of the whole file.
    pub system: Option<UnitSystem>,
}

impl UnitSystem {
    /// Factor to SI of a quantity in these units.
    pub fn factor(&self, quantity: Quantity) -> Option<f64> {
        let factor = match quantity {
            Quantity::Displacement | Quantity::Velocity | Quantity::Acceleration => self.length.recip(),
            Quantity::Force => self.force.recip(),
            Quantity::Phase => 1.0,
        };
        (factor > 0.0 && factor.is_finite()).then_some(factor)
    }
}

impl fmt::Display for UnitSystem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "dataset 164, \"{}\": {} units of length in a metre, {} of force in a newton",
            self.name, self.length, self.force
        )
    }
}

impl Declared {
    /// Compares with the description of the channel. What a sensitivity may mean is a remark, anything else an error.
    ///
    /// # Errors
    /// [`RecordError::QuantityDisagrees`], [`RecordError::UnitDisagrees`].
    pub fn check(&self, channel: &Channel, remarks: &mut Vec<Remark>) -> Result<(), RecordError> {
        self.same_quantity(channel)?;
        let word = read(&self.unit);
        let system = self.system.as_ref().and_then(|system| Some((system, system.factor(channel.quantity)?)));
        match (word, system) {
            (Some(UnitWord::Voltage), _) if channel.sensitivity == 1.0 => Err(self.refuse(channel, self.label())),
            (Some(UnitWord::Voltage), _) | (None, None) => Ok(()),
            (Some(UnitWord::Known(quantity, factor)), system) => {
                if quantity != channel.quantity {
                    return Err(self.refuse(channel, self.label()));
                }
                if let Some((system, of)) = system.filter(|(_, of)| !is_same(*of, factor)) {
                    let header = format!("its unit is \"{}\" ({factor} of the SI), but {system} ({of})", self.unit);
                    remarks.push(Remark::HeaderDisagrees { channel: channel.name.clone(), header });
                }
                self.same_factor(channel, factor, self.label(), remarks)
            }
            (None, Some((system, factor))) => self.same_factor(channel, factor, system.to_string(), remarks),
        }
    }

    fn same_quantity(&self, channel: &Channel) -> Result<(), RecordError> {
        let found = match &self.quantity {
            DeclaredQuantity::Known(quantity) if *quantity != channel.quantity => quantity.name(),
            DeclaredQuantity::Other(name) => name,
            _ => return Ok(()),
        };
        let (channel, declared) = (channel.name.clone(), channel.quantity);
        Err(RecordError::QuantityDisagrees { channel, found, declared })
    }

    /// `factor` is that of the file.
    fn same_factor(
        &self,
        channel: &Channel,
        factor: f64,
        header: String,
        remarks: &mut Vec<Remark>,
    ) -> Result<(), RecordError> {
        let declared = channel.quantity.factor(&channel.unit).unwrap_or(f64::NAN) / channel.sensitivity;
        if is_same(declared, factor) {
            return Ok(());
        }
        if channel.sensitivity == 1.0 {
            return Err(self.refuse(channel, header));
        }
        if (declared / factor).ln().abs() > CALIBRATION.ln() {
            let header = format!(
                "{header}, which makes a number {factor:e} of the SI; unit and sensitivity of the scene make it \
                    {declared:e}"
            );
            remarks.push(Remark::HeaderDisagrees { channel: channel.name.clone(), header });
        }
        Ok(())
    }

    fn label(&self) -> String {
        format!("the unit \"{}\"", self.unit)
    }

    fn refuse(&self, channel: &Channel, header: String) -> RecordError {
        RecordError::UnitDisagrees {
            channel: channel.name.clone(),
            header,
            declared: channel.unit.clone(),
            quantity: channel.quantity,
        }
    }
}

fn is_same(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < SAME_UNIT
}
