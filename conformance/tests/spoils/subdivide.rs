//! Wrong `subdivide`.

use super::Mutant;

pub(crate) const MUTANTS: &[Mutant] = &[];
