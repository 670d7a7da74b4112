//! Checks of numbers that a user wrote: an error names the place, the field and what was expected.

use super::error::SceneError;
use crate::math::{self, Vec3};
use alloc::string::ToString;

/// All numbers are finite, or an error that names the field.
pub(super) fn finite(place: &str, field: &'static str, values: &[f32]) -> Result<(), SceneError> {
    if values.iter().all(|v| v.is_finite()) {
        Ok(())
    } else {
        Err(SceneError::NotFinite { place: place.to_string(), field })
    }
}

/// All numbers are finite and at least zero.
pub(super) fn not_negative(place: &str, field: &'static str, values: &[f32]) -> Result<(), SceneError> {
    finite(place, field, values)?;
    match values.iter().find(|v| **v < 0.0) {
        None => Ok(()),
        Some(&value) => out_of_range(place, field, value, "a number not below 0"),
    }
}

pub(super) fn out_of_range<T>(
    place: &str,
    field: &'static str,
    value: f32,
    expected: &'static str,
) -> Result<T, SceneError> {
    Err(SceneError::OutOfRange { place: place.to_string(), field, value, expected })
}

/// A unit vector along `v`, or an error that names the field.
pub(super) fn unit(place: &str, field: &'static str, v: [f32; 3]) -> Result<Vec3, SceneError> {
    finite(place, field, &v)?;
    let n = math::normalize_or(Vec3::from_array(v), Vec3::ZERO);
    if n == Vec3::ZERO { out_of_range(place, field, 0.0, "a direction of non-zero length") } else { Ok(n) }
}

/// A finite number above zero.
pub(super) fn positive(place: &str, field: &'static str, value: f32) -> Result<(), SceneError> {
    finite(place, field, &[value])?;
    if value > 0.0 { Ok(()) } else { out_of_range(place, field, value, "a number above 0") }
}
