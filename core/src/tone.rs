//! Tone mapping for display: images are stored linear.
