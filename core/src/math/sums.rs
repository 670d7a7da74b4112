//! Error-free sums and products, and sums that keep what rounding loses.

use super::bits::upper12;

/// a + b = sum + error, exactly: (sum, error). Six operations (Knuth 1969, 4.2.2 theorem B); exact unless the sum overflows.
#[inline(always)]
#[must_use]
pub fn two_sum(a: f32, b: f32) -> (f32, f32) {
    let sum = a + b;
    let b_in_sum = sum - a;
    (sum, (a - (sum - b_in_sum)) + (b - b_in_sum))
}

/// a * b = product + error, exactly: (product, error), for a product between 2^-100 and f32::MAX in magnitude.
///
/// As Dekker 1971, with the factors split by their bits (12 upper, 12 lower) so that no factor overflows; no fma.
/// Below 2^-100 the error loses bits (it would be subnormal); the product is always the rounded one.
#[inline(always)]
#[must_use]
pub fn two_prod(a: f32, b: f32) -> (f32, f32) {
    let product = a * b;
    let (a1, b1) = (upper12(a), upper12(b));
    let (a2, b2) = (a - a1, b - b1);
    (product, a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2))
}

/// A sum that also adds up what each addition loses (Neumaier 1974): its error is about one rounding of the result
/// plus n eps^2 times the sum of magnitudes, for n terms. `T` is f32 or f64.
///
/// The order of the terms still decides the last bit: keep it fixed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Compensated<T> {
    sum: T,
    lost: T,
}

macro_rules! compensated {
    ($float:ty) => {
        impl Compensated<$float> {
            /// An empty sum, starting at `value`.
            #[inline]
            #[must_use]
            pub const fn new(value: $float) -> Self {
                Self { sum: value, lost: 0.0 }
            }

            /// Adds one term. Once the sum is infinite or NaN it stays what plain addition would make of it.
            #[inline]
            pub fn add(&mut self, x: $float) {
                let total = self.sum + x;
                let lost =
                    if self.sum.abs() >= x.abs() { (self.sum - total) + x } else { (x - total) + self.sum };
                self.sum = total;
                self.lost += lost;
            }

            /// Adds another sum with what it lost.
            #[inline]
            pub fn merge(&mut self, other: Self) {
                self.add(other.sum);
                self.lost += other.lost;
            }

            /// The sum, rounded once.
            #[inline]
            #[must_use]
            pub fn value(self) -> $float {
                let value = self.sum + self.lost;
                // After an overflow the lost part is NaN; the infinity is the answer.
                if self.sum.is_finite() { value } else { self.sum }
            }
        }

        impl Extend<$float> for Compensated<$float> {
            fn extend<I: IntoIterator<Item = $float>>(&mut self, terms: I) {
                for x in terms {
                    self.add(x);
                }
            }
        }

        impl FromIterator<$float> for Compensated<$float> {
            fn from_iter<I: IntoIterator<Item = $float>>(terms: I) -> Self {
                let mut sum = Self::new(0.0);
                sum.extend(terms);
                sum
            }
        }
    };
}

compensated!(f32);
compensated!(f64);
