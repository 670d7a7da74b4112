//! A memory of one thing, for what sessions make on demand and the next job is likely to ask for again.

use std::sync::{Arc, Mutex, PoisonError};

/// What was made last, kept until something else is asked for.
#[derive(Debug)]
pub struct Kept<K, V>(Mutex<Option<(K, Arc<V>)>>);

impl<K: PartialEq + Clone, V> Kept<K, V> {
    /// What `key` stands for: what is kept, or what `make` makes of it.
    ///
    /// # Errors
    /// Those of `make`; what was kept before stays.
    pub fn get<E>(&self, key: &K, make: impl FnOnce() -> Result<V, E>) -> Result<Arc<V>, E> {
        // A panic elsewhere leaves nothing half-made here.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, value)) = &*kept
            && of == key
        {
            return Ok(value.clone());
        }
        let value = Arc::new(make()?);
        *kept = Some((key.clone(), value.clone()));
        Ok(value)
    }
}

impl<K, V> Default for Kept<K, V> {
    fn default() -> Self {
        Self(Mutex::new(None))
    }
}
