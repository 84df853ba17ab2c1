//! A point of the boundary of stability over two parameters: the eigenvalue that crosses the threshold there, and its rates.

use cea::{CeaError, CertifiedError, Eigentriple, Threshold, Workspace};
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector, Vector2, vector};
use num_complex::Complex;
use study::UncertainBrake;

use super::divergence::{null_vectors, stiffness};
use super::double::Double;
use super::family::{DIFFERENCE, Part};
use crate::Error;

/// Largest fraction of the norms that `left^T C right` may be and count as no damping; chosen.
const UNDAMPED: f64 = 1e-10;

/// A point of a boundary curve.
#[derive(Debug, Clone)]
pub(super) struct CurvePoint {
    /// Coordinates x, y of the point, as fractions of the ranges.
    pub at: Vector2<f64>,
    crossing: Crossing,
    /// Rates d value / d x and d value / d y.
    pub rates: Vector2<Complex<f64>>,
    /// Margin beyond the threshold, rad/s, and its gradient by x and y.
    beyond: (f64, Vector2<f64>),
}

/// Kind of crossing of the threshold, with its vectors.
#[derive(Debug, Clone)]
pub(super) enum Crossing {
    /// An eigenvalue with its vectors.
    Flutter(Eigentriple),
    /// A real eigenvalue at zero, where the stiffness is singular, or at the growth rate above which growth counts, where Q is singular.
    Divergence(NullPair),
    /// Pair of eigenvalues that meet.
    Double(Double),
}

/// Kind of crossing at a point of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PointOf {
    Flutter,
    Divergence,
    Double,
}

/// The null vectors of a stiffness K that is singular or nearly so, and a measure of how far it is from that. With the vectors l and r
/// of a neighbour
///
/// ```text
/// [ K    l ] [ right ]   [ 0 ]       [ K^T  r ] [ left ]   [ 0 ]
/// [ r^T  0 ] [   g   ] = [ 1 ],      [ l^T  0 ] [  g   ] = [ 1 ]
/// ```
///
/// have the same g, which vanishes where det K does, and `dg = -left^T dK right` (Govaerts, Numerical Methods for Bifurcations of
/// Dynamical Equilibria, 2000, section 3.3). Next to there a real eigenvalue moves by `-left^T dK right / left^T C right` from zero, and
/// without damping its square by `-left^T dK right / left^T M right`: that says on which side one more of them is above zero. Where the
/// sign of `left^T C right` changes along the curve two real eigenvalues are zero at once, and another curve begins.
#[derive(Debug, Clone)]
pub(super) struct NullPair {
    /// Growth, `g` or `-g`: positive where one more real eigenvalue is beyond the threshold.
    growth: f64,
    right: DVector<f64>,
    left: DVector<f64>,
    /// Factor between g and the growth, 1 or -1; it does not change along a curve.
    sign: f64,
    /// Growth rate at which Q stands in the place of K, 1/s.
    at: f64,
    /// Size of the border: the size of K, but where K vanishes as a whole.
    size: f64,
}

impl NullPair {
    /// The null vectors of a singular stiffness, or of Q at the growth rate `at`, 1/s; `None` where there is more than one.
    fn of(system: &SecondOrder, at: f64) -> Option<Self> {
        let k = stiffness(system, at);
        let size = k.amax() + system.c.amax() + system.m.amax();
        let [right, left] = null_vectors(k, f64::INFINITY)?;
        Self { growth: 0.0, right, left, sign: 1.0, at, size }.of_neighbour(system)
    }

    /// The null vectors of a neighbour; `None` where the bordered matrix is singular, as K has another null vector.
    fn of_neighbour(&self, system: &SecondOrder) -> Option<Self> {
        let bordered = self.bordered(&stiffness(system, self.at));
        let n = self.right.len();
        let mut unit = DVector::zeros(n + 1);
        unit[n] = 1.0;
        let (right, left) = (bordered.clone().lu().solve(&unit)?, bordered.transpose().lu().solve(&unit)?);
        let g = right[n];
        let [right, left] = [right, left].map(|vector| vector.rows(0, n).into_owned());
        let derivative = system.dynamic_stiffness_derivative(Complex::from(self.at)).map(|entry| entry.re);
        let slope = left.dot(&(&derivative * &right));
        let is_damped = slope.abs() > UNDAMPED * derivative.norm() * left.norm() * right.norm();
        let sign = if is_damped { slope.signum() } else { left.dot(&(&system.m * &right)).signum() };
        Some(Self { growth: sign * g, right, left, sign, ..*self })
    }

    fn bordered(&self, k: &DMatrix<f64>) -> DMatrix<f64> {
        let (n, size) = (k.nrows(), self.size);
        let mut bordered = k.clone().resize(n + 1, n + 1, 0.0);
        bordered.view_mut((0, n), (n, 1)).copy_from(&(self.left.normalize() * size));
        bordered.view_mut((n, 0), (1, n)).copy_from(&(self.right.normalize() * size).transpose());
        bordered
    }

    /// Change of the growth from a change of K.
    fn rate(&self, change: &DMatrix<f64>) -> f64 {
        -self.sign * self.left.dot(&(change * &self.right))
    }
}

impl Crossing {
    /// The crossing of an eigenvalue of a system. `None` where K has more than one null vector.
    fn of(system: &SecondOrder, lambda: Complex<f64>, of: PointOf) -> Result<Option<Self>, Error> {
        Ok(match of {
            PointOf::Divergence => NullPair::of(system, lambda.re).map(Self::Divergence),
            PointOf::Flutter => Some(Self::Flutter(Eigentriple::new(system, lambda, &mut Workspace::default())?)),
            PointOf::Double => Double::near(system, lambda)?.map(Self::Double),
        })
    }

    /// The crossing of another system next to this one, corrected from `guess`, its value; of two eigenvalues the guess is their mean, and divergence needs
    /// none. `None` where it is not found.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn of_neighbour(&self, system: &SecondOrder, guess: Complex<f64>) -> Result<Option<Self>, Error> {
        Ok(match self {
            Self::Flutter(pair) => pair.of_neighbour(system, guess).map(Self::Flutter),
            Self::Divergence(pair) => pair.of_neighbour(system).map(Self::Divergence),
            Self::Double(_) => Double::near(system, guess)?.map(Self::Double),
        })
    }

    /// Value: the eigenvalue, rad/s; of divergence the growth that [`NullPair`] has in its place, without a unit, and of two eigenvalues
    /// their squared half distance.
    fn value(&self) -> Complex<f64> {
        match self {
            Self::Flutter(pair) => pair.lambda,
            Self::Divergence(pair) => Complex::from(pair.growth),
            Self::Double(double) => Complex::from(double.square),
        }
    }

    /// Rate of the value over a distance between two systems; the second number is the rate of the mean of two eigenvalues.
    fn rate(&self, systems: [&SecondOrder; 2], distance: f64) -> Result<[Complex<f64>; 2], Error> {
        Ok(match self {
            Self::Flutter(triple) => {
                let [below, above] = systems.map(|system| system.dynamic_stiffness(triple.lambda));
                [triple.rate_over(&(above - below), distance), Complex::default()]
            }
            Self::Divergence(pair) => {
                let [below, above] = systems.map(|system| stiffness(system, pair.at));
                [Complex::from(pair.rate(&((above - below) / distance))), Complex::default()]
            }
            Self::Double(double) => {
                let [below, above] = [Double::near(systems[0], double.mean)?, Double::near(systems[1], double.mean)?];
                let (Some(below), Some(above)) = (below, above) else { return Ok([Complex::from(f64::NAN); 2]) };
                [Complex::from((above.square - below.square) / distance), (above.mean - below.mean) / distance]
            }
        })
    }
}

impl CurvePoint {
    /// The point of a known change at an eigenvalue; `None` where K has more than one null vector, and where there is no such eigenvalue.
    ///
    /// # Errors
    /// Those of the brake and of the vectors.
    pub fn start<B: UncertainBrake>(
        part: &Part<'_, B>,
        at: Vector2<f64>,
        lambda: Complex<f64>,
        of: PointOf,
    ) -> Result<Option<Self>, Error> {
        let system = part.system(&[at.x, at.y])?;
        let there = if of == PointOf::Double { lambda } else { part.threshold().at_margin(0.0, lambda.im) };
        let crossing = match Crossing::of(&system, there, of) {
            Err(Error::Study(study::Error::Cea(CeaError::Certified(CertifiedError::NoEigenvector { .. })))) => None,
            crossing => crossing?,
        };
        crossing.map(|crossing| Self::new(part, at, crossing)).transpose()
    }

    fn new<B: UncertainBrake>(part: &Part<'_, B>, at: Vector2<f64>, mut crossing: Crossing) -> Result<Self, Error> {
        let mut rates = Vector2::from_element(Complex::default());
        let mut mean_rates = rates;
        for axis in 0..2 {
            let [mut below, mut above] = [at, at];
            below[axis] = (at[axis] - DIFFERENCE).max(0.0);
            above[axis] = (at[axis] + DIFFERENCE).min(1.0);
            let systems = [part.system(&[below.x, below.y])?, part.system(&[above.x, above.y])?];
            [rates[axis], mean_rates[axis]] = crossing.rate(systems.each_ref(), above[axis] - below[axis])?;
        }
        if let Crossing::Double(double) = &mut crossing {
            double.mean_rates = mean_rates;
        }
        let (threshold, value) = (part.threshold(), crossing.value());
        let beyond = match crossing {
            Crossing::Flutter(_) => (threshold.margin(value), rates.map(|rate| threshold.margin_rate(value, rate))),
            Crossing::Divergence(_) | Crossing::Double(_) => (value.re, rates.map(|rate| rate.re)),
        };
        Ok(Self { at, crossing, rates, beyond })
    }

    /// The crossing at another place, corrected from `guess`, its value; `None` where it is not found.
    ///
    /// # Errors
    /// Those of the brake.
    pub fn moved<B: UncertainBrake>(
        &self,
        part: &Part<'_, B>,
        at: Vector2<f64>,
        guess: Complex<f64>,
    ) -> Result<Option<Self>, Error> {
        let system = part.system(&[at.x, at.y])?;
        let guess = match &self.crossing {
            Crossing::Double(double) => {
                let by = at - self.at;
                double.mean + double.mean_rates.x * by.x + double.mean_rates.y * by.y
            }
            _ => guess,
        };
        let found = self.crossing.of_neighbour(&system, guess)?;
        found.map(|crossing| Self::new(part, at, crossing)).transpose()
    }

    /// Value: the eigenvalue, rad/s; of divergence a growth without a unit.
    pub fn value(&self) -> Complex<f64> {
        self.crossing.value()
    }

    /// Frequency Im lambda, rad/s; 0 of divergence.
    pub fn omega(&self) -> f64 {
        match &self.crossing {
            Crossing::Double(double) if double.mean.im.abs() <= double.mean.re.abs() => 0.0,
            Crossing::Double(double) => double.mean.im,
            other => other.value().im,
        }
    }

    /// Growth rate Re lambda, 1/s: of the mean of two eigenvalues that meet, else the growth rate of the threshold.
    pub fn real_part(&self, threshold: &Threshold) -> f64 {
        match &self.crossing {
            Crossing::Double(double) => double.mean.re,
            _ => threshold.at_margin(0.0, self.omega()).re,
        }
    }

    /// Kind of the crossing.
    pub fn of(&self) -> PointOf {
        match &self.crossing {
            Crossing::Flutter(_) => PointOf::Flutter,
            Crossing::Divergence(_) => PointOf::Divergence,
            Crossing::Double(_) => PointOf::Double,
        }
    }

    /// True if the point bounds anything: two real eigenvalues that meet below the threshold are overdamped modes, which are stable.
    pub fn is_boundary(&self, threshold: &Threshold) -> bool {
        let Crossing::Double(double) = &self.crossing else { return true };
        self.omega() > 0.0 || threshold.margin(Complex::from(double.mean.re)) > 0.0
    }

    /// Margin beyond the threshold, rad/s; of divergence without a unit.
    pub fn growth(&self) -> f64 {
        self.beyond.0
    }

    /// Gradient of the margin by x and y.
    pub fn gradient(&self) -> Vector2<f64> {
        self.beyond.1
    }

    /// Direction of the curve, of unit length, unstable on the right.
    pub fn tangent(&self) -> Vector2<f64> {
        let gradient = self.gradient();
        vector![-gradient.y, gradient.x].normalize()
    }

    /// Rate d omega along the curve.
    pub fn omega_rate(&self) -> f64 {
        let rates = match &self.crossing {
            Crossing::Double(double) if self.omega() > 0.0 => double.mean_rates,
            _ => self.rates,
        };
        rates.map(|rate| rate.im).dot(&self.tangent())
    }

    /// Change of the value to first order.
    pub fn change(&self, by: Vector2<f64>) -> Complex<f64> {
        self.rates.x * by.x + self.rates.y * by.y
    }

    /// Cosine `|x^H z|` of the unit shapes at two points: 1 for parallel ones.
    pub fn likeness(&self, other: &Self) -> f64 {
        match (&self.crossing, &other.crossing) {
            (Crossing::Flutter(here), Crossing::Flutter(there)) => here.likeness(there),
            (Crossing::Divergence(here), Crossing::Divergence(there)) => {
                let likeness = here.right.normalize().dot(&there.right.normalize()).abs();
                if here.sign == there.sign { likeness } else { 0.0 }
            }
            (Crossing::Double(_), Crossing::Double(_)) => 1.0,
            _ => 0.0,
        }
    }

    /// Distance of the curve of the full model, as a fraction of the ranges; `None` of a brake that is not reduced, and of divergence.
    ///
    /// # Errors
    /// Those of the brake.
    pub fn distance_from_whole<B: UncertainBrake>(&self, part: &Part<'_, B>) -> Result<Option<f64>, Error> {
        if self.of() != PointOf::Flutter {
            return Ok(None);
        }
        let found = part.whole_eigenvalue(&[self.at.x, self.at.y], self.value())?;
        Ok(found.map(|found| part.threshold().margin(found.lambda).abs() / self.gradient().norm()))
    }
}
