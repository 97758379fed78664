use num_complex::Complex64;

/// Most harmonics that the adaptive detector can follow: a fixed number keeps its state free of allocation.
pub const MAX_HARMONICS: usize = 8;

/// `z, z², z³ …`
pub(crate) fn powers(z: Complex64) -> [Complex64; MAX_HARMONICS] {
    let (mut powers, mut power) = ([z; MAX_HARMONICS], z);
    for next in powers.iter_mut().skip(1) {
        power *= z;
        *next = power;
    }
    powers
}
