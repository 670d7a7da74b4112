//! Composition with a factor per row.

use super::super::lanes::value_or_zero;
use super::{LinearOperator, OperatorError, check_len};
use crate::math;

/// D F: an operator whose result is scaled row by row, such as R F with one albedo per patch for all channels. Tiled
/// operators compose the same way.
#[derive(Clone, Copy, Debug)]
pub struct Scaled<'a, O: ?Sized> {
    operator: &'a O,
    scale: &'a [f32],
}

impl<'a, O: LinearOperator + ?Sized> Scaled<'a, O> {
    /// diag(`scale`) `operator`.
    ///
    /// # Errors
    /// A wrong length, or a factor that is not finite (the error names it as row and column).
    pub fn try_new(operator: &'a O, scale: &'a [f32]) -> Result<Self, OperatorError> {
        check_len("scale", scale.len(), operator.len())?;
        match scale.iter().position(|s| !s.is_finite()) {
            Some(i) => Err(OperatorError::NotFinite { row: i, column: i, value: scale[i] }),
            None => Ok(Self { operator, scale }),
        }
    }
}

impl<O: LinearOperator + ?Sized> LinearOperator for Scaled<'_, O> {
    fn len(&self) -> usize {
        self.operator.len()
    }

    fn apply(&self, x: &[f32], y: &mut [f32]) -> Result<(), OperatorError> {
        self.operator.apply(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = value_or_zero(*y * s));
        Ok(())
    }

    fn apply_rgb(&self, x: &[[f32; 3]], y: &mut [[f32; 3]]) -> Result<(), OperatorError> {
        self.operator.apply_rgb(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = y.map(|y| value_or_zero(y * s)));
        Ok(())
    }

    fn apply_wide(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError> {
        self.operator.apply_wide(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = value_or_zero(*y * f64::from(*s)));
        Ok(())
    }

    fn apply_wide_rgb(&self, x: &[[f64; 3]], y: &mut [[f64; 3]]) -> Result<(), OperatorError> {
        self.operator.apply_wide_rgb(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = y.map(|y| value_or_zero(y * f64::from(*s))));
        Ok(())
    }

    fn apply_magnitudes(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError> {
        self.operator.apply_magnitudes(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = value_or_zero(*y * f64::from(math::abs(*s))));
        Ok(())
    }
}
