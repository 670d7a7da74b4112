//! Wrong `log_offset`.

use super::Mutant;

pub(crate) const MUTANTS: &[Mutant] = &[];
