//! Sensitivity of an eigenvalue to the numbers of its system: derivatives from its right and left vector.
//!
//! ```text
//! Q x = 0,  y^H Q = 0        d lambda / d p = -y^H Q_p x / (y^H Q' x)
//! ```
//!
//! with `Q_p = d Q / d p` and `Q' = d Q / d lambda` at lambda (Lancaster, Numer. Math. 6, 1964, 377-387). This is exact for a simple
//! eigenvalue, and the first order of what a finite change of p does. How far it holds is told by two measures:
//!
//! - the second derivative, [`Expansion`]: at the change [`Rates::holds_to`] the second order is a tenth of the first. Next to a
//!   coalescence at p_0 eigenvalues are `m +- sqrt(s (p - p_0))`: derivatives grow without bound and hold to 0.4 of the distance
//!   from p_0, less and less;
//! - [`Separation`]: how far the next eigenvalue is, against the error by rounding that this one may have. Where two are equal within
//!   that there is no derivative of one of them, and [`Separation::is_simple`] says so.

mod eigentriple;
mod expansion;
mod perturbation;

pub use eigentriple::{Eigentriple, Separation};
pub use expansion::{Expansion, Rates};
pub use perturbation::Perturbation;
