use super::Factor;
use crate::kernel;

/// Rows of a factor whose unknowns are fixed at zero, without changing the factor.
///
/// With `V = L⁻¹ E` of the unit vectors of those rows, `λ = L⁻ᵀ (y − V (Vᵀ V)⁻¹ Vᵀ y)` vanishes there.
#[derive(Debug, Default)]
pub(super) struct Suppression {
    rows: Vec<Suppressed>,
    spare: Vec<Vec<f64>>,
    /// Factor of `Vᵀ V`.
    gram: Factor,
    products: Vec<f64>,
}

#[derive(Debug)]
struct Suppressed {
    position: usize,
    /// `L⁻¹ e`, zero before `position`.
    image: Vec<f64>,
    /// Products with the previous images and with itself: a row of `Vᵀ V`.
    products: Vec<f64>,
}

impl Suppression {
    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub(super) fn contains(&self, position: usize) -> bool {
        self.rows.iter().any(|s| s.position == position)
    }

    /// Releases all rows.
    pub(super) fn clear(&mut self) {
        self.spare.extend(self.rows.drain(..).map(|s| s.image));
        self.gram.clear();
    }

    /// Releases the rows at the positions chosen.
    pub(super) fn release(&mut self, chosen: impl Fn(usize) -> bool) {
        let before = self.rows.len();
        for k in (0..before).rev() {
            if chosen(self.rows[k].position) {
                self.spare.push(self.rows.remove(k).image);
                self.rows[k..].iter_mut().for_each(|later| {
                    later.products.remove(k);
                });
            }
        }
        if self.rows.len() < before {
            self.refactor();
        }
    }

    /// Fixes one more row at zero.
    pub(super) fn add(&mut self, factor: &Factor, position: usize) {
        let mut image = self.spare.pop().unwrap_or_default();
        image.clear();
        image.resize(position, 0.0);
        image.push(factor.row(position).1);
        extend_image(factor, &mut image, position);
        let product = |s: &Suppressed| {
            let start = s.position.max(position);
            kernel::dot(&s.image[start..], &image[start..])
        };
        let mut products: Vec<f64> = self.rows.iter().map(product).collect();
        products.push(kernel::dot(&image[position..], &image[position..]));
        self.gram.append_row(&products);
        self.rows.push(Suppressed { position, image, products });
    }

    /// Registers the rows added to the factor from `first` on.
    pub(super) fn extend(&mut self, factor: &Factor, first: usize) {
        for k in 0..self.rows.len() {
            let (before, rest) = self.rows.split_at_mut(k);
            let Suppressed { position, image, products } = &mut rest[0];
            extend_image(factor, image, *position);
            let tail = &image[first..];
            for (product, other) in products.iter_mut().zip(before.iter()) {
                *product += kernel::dot(&other.image[first..], tail);
            }
            products[k] += kernel::dot(tail, tail);
        }
        self.refactor();
    }

    fn refactor(&mut self) {
        self.gram.clear();
        self.rows.iter().for_each(|s| self.gram.append_row(&s.products));
    }

    /// `x ← L⁻ᵀ (x − V (Vᵀ V)⁻¹ Vᵀ x)`.
    pub(super) fn substitute_backward(&mut self, factor: &Factor, x: &mut [f64]) {
        if !self.rows.is_empty() {
            let product = |s: &Suppressed| kernel::dot(&s.image[s.position..], &x[s.position..]);
            self.products.clear();
            self.products.extend(self.rows.iter().map(product));
            self.gram.solve(&mut self.products);
            for (s, product) in self.rows.iter().zip(&self.products) {
                kernel::axpy(-product, &s.image[s.position..], &mut x[s.position..]);
            }
        }
        factor.backward(x);
        self.rows.iter().for_each(|s| x[s.position] = 0.0);
    }
}

/// Extends `L⁻¹ e` over the added rows.
fn extend_image(factor: &Factor, image: &mut Vec<f64>, position: usize) {
    for i in image.len()..factor.len() {
        let (row, inverse) = factor.row(i);
        image.push(-kernel::dot(&row[position..], &image[position..]) * inverse);
    }
}
