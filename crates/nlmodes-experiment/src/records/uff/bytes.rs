//! Binary numbers.

use crate::records::uff::{ByteOrder, Precision};

/// Number of values by which the byte order is judged.
const JUDGED: usize = 1000;

/// Numbers that a measurement can give: zero, or a size between these.
const PLAUSIBLE: std::ops::Range<f64> = 1e-30..1e30;

/// Mean deviation in decades that no signal has; exponents by chance have 19 in single precision, 150 in double.
const MANY_DECADES: f64 = 6.0;

impl Precision {
    /// Bytes of a number.
    pub fn size(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Double => 8,
        }
    }
}

impl ByteOrder {
    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::Little => Self::Big,
            Self::Big => Self::Little,
        }
    }

    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Little => "little-endian",
            Self::Big => "big-endian",
        }
    }
}

/// The numbers in these bytes; a rest that is no whole number is left out.
pub fn decode(bytes: &[u8], precision: Precision, order: ByteOrder) -> Vec<f64> {
    match (precision, order) {
        (Precision::Single, ByteOrder::Little) => four(bytes, f32::from_le_bytes),
        (Precision::Single, ByteOrder::Big) => four(bytes, f32::from_be_bytes),
        (Precision::Double, ByteOrder::Little) => eight(bytes, f64::from_le_bytes),
        (Precision::Double, ByteOrder::Big) => eight(bytes, f64::from_be_bytes),
    }
}

fn four(bytes: &[u8], decode: fn([u8; 4]) -> f32) -> Vec<f64> {
    bytes.chunks_exact(4).map(|b| f64::from(decode([b[0], b[1], b[2], b[3]]))).collect()
}

fn eight(bytes: &[u8], decode: fn([u8; 8]) -> f64) -> Vec<f64> {
    bytes.chunks_exact(8).map(|b| decode([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]])).collect()
}

/// The bytes of numbers.
pub fn encode(numbers: impl IntoIterator<Item = f64>, precision: Precision, order: ByteOrder) -> Vec<u8> {
    let mut bytes = Vec::new();
    for x in numbers {
        match (precision, order) {
            (Precision::Single, ByteOrder::Little) => bytes.extend((x as f32).to_le_bytes()),
            (Precision::Single, ByteOrder::Big) => bytes.extend((x as f32).to_be_bytes()),
            (Precision::Double, ByteOrder::Little) => bytes.extend(x.to_le_bytes()),
            (Precision::Double, ByteOrder::Big) => bytes.extend(x.to_be_bytes()),
        }
    }
    bytes
}

/// Whether the bytes are numbers of a measurement in the other byte order, but not in this one: most have no plausible
/// size, or their sizes scatter over many more decades than those of a signal do.
pub fn is_swapped(bytes: &[u8], precision: Precision, order: ByteOrder) -> bool {
    let judged = &bytes[..bytes.len().min(JUDGED * precision.size())];
    let (here, there) = (decode(judged, precision, order), decode(judged, precision, order.other()));
    let implausible = plausible_share(&here) < 0.5 && plausible_share(&there) > 0.9;
    let scattered = scatter(&here) > MANY_DECADES && scatter(&here) > 4.0 * scatter(&there);
    implausible || scattered
}

fn plausible_share(numbers: &[f64]) -> f64 {
    let plausible = numbers.iter().filter(|x| **x == 0.0 || PLAUSIBLE.contains(&x.abs())).count();
    plausible as f64 / numbers.len().max(1) as f64
}

/// Mean deviation of the sizes, in decades.
fn scatter(numbers: &[f64]) -> f64 {
    let sizes = numbers.iter().filter(|x| **x != 0.0);
    let sizes: Vec<f64> = sizes.map(|x| if x.is_finite() { x.abs().log10() } else { f64::MAX_10_EXP.into() }).collect();
    let n = sizes.len().max(1) as f64;
    let mean = sizes.iter().sum::<f64>() / n;
    sizes.iter().map(|size| (size - mean).abs()).sum::<f64>() / n
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swapped_numbers_are_told_whatever_zeros_stand_among_them() {
        let signal = |zeros: usize| (0..400).map(move |j| if j % 5 < zeros { 0.0 } else { (0.1 * j as f64).sin() });
        for (precision, order) in [Precision::Single, Precision::Double]
            .into_iter()
            .flat_map(|p| [ByteOrder::Little, ByteOrder::Big].map(|order| (p, order)))
        {
            for zeros in 0..5 {
                let bytes = encode(signal(zeros), precision, order);
                assert!(is_swapped(&bytes, precision, order.other()), "{precision:?} {order:?} {zeros}");
                assert!(!is_swapped(&bytes, precision, order), "{precision:?} {order:?} {zeros}");
            }
            let zeros = encode(signal(5), precision, order);
            assert!(!is_swapped(&zeros, precision, order) && !is_swapped(&zeros, precision, order.other()));
        }
    }

    #[test]
    fn the_scatter_of_powers_of_ten_is_that_of_their_exponents() {
        assert!((scatter(&[1e-3, 1e3, -1e-1, 1e1, 0.0]) - 2.0).abs() < 1e-12);
        assert!((scatter(&[1e5; 7])).abs() < 1e-12 && scatter(&[]) == 0.0);
        assert!((plausible_share(&[0.0, 1.0, -1e-29, 1e31, f64::NAN]) - 0.6).abs() < 1e-12);
    }
}
