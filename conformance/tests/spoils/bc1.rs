//! Wrong `bc1`.

use super::Mutant;

pub(crate) const MUTANTS: &[Mutant] = &[];
