//! Cross-crate tests live in `tests/`; the code of docs/extending.md is compiled and run as doctests of this crate.

/// The page on extensions.
#[cfg(doctest)]
#[doc = include_str!("../../docs/extending.md")]
struct Extending;
