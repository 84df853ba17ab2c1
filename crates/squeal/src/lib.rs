//! Placeholder of the layout; replaced by the first real commit of this crate.
pub mod figures;
