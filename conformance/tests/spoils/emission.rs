//! Wrong `emission`.

use super::Mutant;

pub(crate) const MUTANTS: &[Mutant] = &[];
