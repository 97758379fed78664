//! What makes quantities of the numbers of a converter.

use std::collections::HashMap;

use super::metadata::Property;
use crate::records::RecordError;

/// Most scales of a channel, and most coefficients of one.
const MAX: usize = 64;
/// The input of a scale that takes the recorded numbers.
const RAW: f64 = u32::MAX as f64;

/// The scales of a channel, in the order in which they are applied.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scales(Vec<Vec<f64>>);

impl Scales {
    /// Of the properties of a channel; `scaler` is the number of the scale that its device has applied already, by
    /// naming its numbers.
    ///
    /// # Errors
    /// [`RecordError::Tdms`] for other scales than linear and polynomial ones.
    pub fn new(
        properties: &HashMap<String, Property>,
        scaler: Option<u32>,
        channel: &str,
    ) -> Result<Self, RecordError> {
        let number = |name: &str| properties.get(name).and_then(Property::number);
        let text = |name: &str| properties.get(name).and_then(Property::text);
        let refuse = |message: String| Err(RecordError::Tdms { byte: 0, message });
        let count = number("NI_Number_Of_Scales").map_or(0, |count| count as usize);
        if count == 0 || text("NI_Scaling_Status") == Some("scaled") {
            return Ok(Self::default());
        }
        if count > MAX {
            return refuse(format!("the channel \"{channel}\" has {count} scales, at most {MAX} are read"));
        }
        // From the last one back to the numbers that were recorded.
        let (mut polynomials, mut own) = (Vec::new(), count as f64 - 1.0);
        while own != RAW && scaler.map(f64::from) != Some(own) {
            if polynomials.len() > MAX || own < 0.0 || own >= count as f64 {
                return refuse(format!("the scales of the channel \"{channel}\" go round in circles"));
            }
            let name = |what: &str| format!("NI_Scale[{own}]_{what}");
            let kind = text(&name("Scale_Type"));
            let missing = |what: &str| RecordError::Tdms {
                byte: 0,
                message: format!("the channel \"{channel}\" has a scale without its property \"{}\"", name(what)),
            };
            let needed = |what: &str| number(&name(what)).ok_or_else(|| missing(what));
            let source = match kind {
                Some("Linear") => {
                    polynomials.push(vec![needed("Linear_Y_Intercept")?, needed("Linear_Slope")?]);
                    number(&name("Linear_Input_Source"))
                }
                Some("Polynomial") => {
                    let terms = number(&name("Polynomial_Coefficients_Size")).map_or(4, |n| n as usize).min(MAX);
                    let term = |k: usize| needed(&format!("Polynomial_Coefficients[{k}]"));
                    polynomials.push((0..terms).map(term).collect::<Result<_, _>>()?);
                    number(&name("Polynomial_Input_Source"))
                }
                // The properties of a device may represent its raw numbers.
                None => Some(RAW),
                Some(other) => {
                    return refuse(format!(
                        "the channel \"{channel}\" has a scale of the kind \"{other}\"; linear and polynomial ones are \
                         read: export scaled values"
                    ));
                }
            };
            own = source.unwrap_or(RAW);
        }
        polynomials.reverse();
        Ok(Self(polynomials))
    }

    /// Makes quantities of recorded numbers.
    pub fn apply(&self, values: &mut [f64]) {
        for polynomial in &self.0 {
            let at = |x: f64| polynomial.iter().rev().fold(0.0, |sum, c| sum * x + c);
            values.iter_mut().for_each(|x| *x = at(*x));
        }
    }
}
