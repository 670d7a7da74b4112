//! Wrong `linear_triangle`.

use super::Mutant;

pub(crate) const MUTANTS: &[Mutant] = &[];
