//! Wrong `polynomial`.

use super::Mutant;

pub(crate) const MUTANTS: &[Mutant] = &[];
