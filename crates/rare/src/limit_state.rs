//! The seam: what fails where in standard normal space.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::Error;
use crate::vector::{norm, unit};

/// A mode of failure at a point.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Mode {
    /// Margin by which the mode fails: above zero it fails, below it does not. Any unit, continuous in u where the mode exists.
    pub margin: f64,
    /// Growth rate of the mode, 1/s; of what is no vibration any number that tells one mode from another at the same point, as `omega`.
    pub growth: f64,
    /// Angular frequency of the mode, rad/s.
    pub omega: f64,
}

impl Mode {
    /// The mode of the largest margin, the last of several such modes; where margins are NaN a mode with such a margin; `None` without modes.
    pub fn worst(modes: impl IntoIterator<Item = Self>) -> Option<Self> {
        let order = |a: &Self, b: &Self| a.margin.is_nan().cmp(&b.margin.is_nan()).then(a.margin.total_cmp(&b.margin));
        modes.into_iter().max_by(order)
    }
}

/// A system of d independent standard normal inputs u that fails where one of its modes has a margin above zero.
pub trait LimitState: Sync {
    /// Error of an evaluation, and of a search ([`Error`](crate::Error) becomes it).
    type Error: From<crate::Error> + Send;

    /// Number d of inputs, >= 1.
    fn dimensions(&self) -> usize;

    /// The modes at `u`, of length d, in any order: at least the mode of the largest margin.
    ///
    /// # Errors
    /// A point that cannot be evaluated.
    fn modes(&self, u: &[f64]) -> Result<Vec<Mode>, Self::Error>;

    /// The modes at several points, in their order. A system that evaluates several at once for less overrides it.
    ///
    /// # Errors
    /// As [`LimitState::modes`].
    fn modes_of_all(&self, points: &[Vec<f64>]) -> Result<Vec<Vec<Mode>>, Self::Error> {
        points.iter().map(|u| self.modes(u)).collect()
    }

    /// The gradient, length d, of the margin of a mode that [`LimitState::modes`] found at `u`.
    ///
    /// # Errors
    /// As [`LimitState::modes`].
    fn gradient(&self, u: &[f64], mode: &Mode) -> Result<Vec<f64>, Self::Error>;

    /// Ranges of the only input of a system, in standard deviations, in all of which it is proven that nothing fails. Default: none is.
    fn proven(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }
}

/// Points evaluated together; chosen: full lanes.
pub(crate) const AT_ONCE: usize = 16;

/// Questions to a limit state: answered at once by [`Counted`], in step with other searches by [`InStep`].
pub(crate) trait Asked: Sync {
    /// End of a search without a result.
    type Error: From<Error>;

    fn dimensions(&self) -> usize;

    /// The mode of the largest margin.
    fn worst(&self, u: &[f64]) -> Result<Mode, Self::Error>;

    /// The mode of the largest margin at each point.
    fn worst_of_all(&self, points: &[Vec<f64>]) -> Result<Vec<Mode>, Self::Error>;

    /// The gradient of the margin of a mode.
    fn gradient(&self, u: &[f64], mode: &Mode) -> Result<Vec<f64>, Self::Error>;

    /// The direction in which the margin of a mode grows fastest, of length 1, and how fast; `None` where the margin has no such direction.
    fn steepest(&self, u: &[f64], mode: &Mode) -> Result<Option<(Vec<f64>, f64)>, Self::Error> {
        if !mode.margin.is_finite() {
            return Ok(None);
        }
        let gradient = self.gradient(u, mode)?;
        let slope = norm(&gradient);
        Ok(unit(gradient).map(|direction| (direction, slope)))
    }
}

/// A limit state whose evaluations are counted.
pub(crate) struct Counted<'a, L> {
    of: &'a L,
    evaluations: AtomicU64,
}

/// A limit state that knows the answers that a search has had so far: what it lacks is asked for together with what others lack.
pub(crate) struct InStep<'a, L> {
    of: &'a L,
    answers: &'a Mutex<Answers>,
}

/// End of a search in step without a result.
#[derive(Debug)]
pub(crate) enum Ended<E> {
    /// An answer is not there yet: the search begins anew once it is.
    Open,
    /// An error.
    Failed(E),
}

impl<E: From<Error>> From<Error> for Ended<E> {
    fn from(error: Error) -> Self {
        Self::Failed(error.into())
    }
}

/// Answers that a search has had so far, by the bits of what was asked, and the points that it asks for next.
#[derive(Default)]
struct Answers {
    worst: HashMap<Vec<u64>, Mode>,
    gradients: HashMap<Vec<u64>, Vec<f64>>,
    open: Vec<Vec<f64>>,
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

impl<'a, L: LimitState> Counted<'a, L> {
    pub fn new(of: &'a L) -> Self {
        Self { of, evaluations: AtomicU64::new(0) }
    }

    pub fn evaluations(&self) -> u64 {
        self.evaluations.load(Ordering::Relaxed)
    }

    pub fn proven(&self) -> Vec<[f64; 2]> {
        self.of.proven()
    }

    /// Results of several searches. They go on in step, and the points that they ask for are evaluated together: a search is begun anew, with the
    /// answers that it has had, whenever one is there that it lacked. So each must ask the same whenever it gets the same answers.
    ///
    /// # Errors
    /// Those of the limit state and of the searches.
    pub fn in_step<J: Sync, T: Send>(
        &self,
        searches: &[J],
        search: impl Fn(&InStep<'_, L>, &J) -> Result<T, Ended<L::Error>> + Sync,
    ) -> Result<Vec<T>, L::Error> {
        let known: Vec<Mutex<Answers>> = searches.iter().map(|_| Mutex::default()).collect();
        let mut found: Vec<Option<T>> = searches.iter().map(|_| None).collect();
        loop {
            let open = found.par_iter_mut().zip(searches).zip(&known).filter(|((found, _), _)| found.is_none());
            open.try_for_each(|((found, of_search), answers)| {
                match search(&InStep { of: self.of, answers }, of_search) {
                    Err(Ended::Failed(error)) => Err(error),
                    answer => {
                        *found = answer.ok();
                        Ok(())
                    }
                }
            })?;
            let asked: Vec<(usize, Vec<f64>)> = known
                .iter()
                .enumerate()
                .flat_map(|(at, known)| std::mem::take(&mut held(known).open).into_iter().map(move |u| (at, u)))
                .collect();
            if asked.is_empty() {
                return Ok(found.into_iter().flatten().collect());
            }
            let points: Vec<Vec<f64>> = asked.iter().map(|(_, u)| u.clone()).collect();
            let worst =
                points.par_chunks(AT_ONCE).map(|points| self.worst_of_all(points)).collect::<Result<Vec<_>, _>>()?;
            for ((at, u), worst) in asked.iter().zip(worst.into_iter().flatten()) {
                held(&known[*at]).worst.insert(bits(u), worst);
            }
        }
    }
}

impl<L: LimitState> Asked for Counted<'_, L> {
    type Error = L::Error;

    fn dimensions(&self) -> usize {
        self.of.dimensions()
    }

    fn worst(&self, u: &[f64]) -> Result<Mode, L::Error> {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        Ok(worst(self.of.modes(u)?)?)
    }

    fn worst_of_all(&self, points: &[Vec<f64>]) -> Result<Vec<Mode>, L::Error> {
        self.evaluations.fetch_add(points.len() as u64, Ordering::Relaxed);
        let worst = self.of.modes_of_all(points)?.into_iter().map(worst).collect::<Result<_, Error>>()?;
        Ok(worst)
    }

    fn gradient(&self, u: &[f64], mode: &Mode) -> Result<Vec<f64>, L::Error> {
        self.of.gradient(u, mode)
    }
}

impl<L: LimitState> Asked for InStep<'_, L> {
    type Error = Ended<L::Error>;

    fn dimensions(&self) -> usize {
        self.of.dimensions()
    }

    fn worst(&self, u: &[f64]) -> Result<Mode, Self::Error> {
        Ok(self.worst_of_all(&[u.to_vec()])?[0])
    }

    fn worst_of_all(&self, points: &[Vec<f64>]) -> Result<Vec<Mode>, Self::Error> {
        let mut answers = held(self.answers);
        let is_known = |u: &&Vec<f64>| answers.worst.contains_key(&bits(u));
        answers.open = points.iter().filter(|u| !is_known(u)).cloned().collect();
        points.iter().map(|u| answers.worst.get(&bits(u)).copied()).collect::<Option<_>>().ok_or(Ended::Open)
    }

    fn gradient(&self, u: &[f64], mode: &Mode) -> Result<Vec<f64>, Self::Error> {
        let asked = bits(&[u, &[mode.growth, mode.omega]].concat());
        let known = held(self.answers).gradients.get(&asked).cloned();
        match known {
            Some(gradient) => Ok(gradient),
            None => {
                let gradient = self.of.gradient(u, mode).map_err(Ended::Failed)?;
                held(self.answers).gradients.insert(asked, gradient.clone());
                Ok(gradient)
            }
        }
    }
}

fn held(answers: &Mutex<Answers>) -> std::sync::MutexGuard<'_, Answers> {
    answers.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The mode of the largest margin; without modes a mode that is infinitely far from failure.
fn worst(modes: Vec<Mode>) -> Result<Mode, Error> {
    match Mode::worst(modes) {
        Some(mode) if mode.margin.is_nan() => Err(Error::NoMargin { omega: mode.omega }),
        Some(mode) => Ok(mode),
        None => Ok(Mode { margin: f64::NEG_INFINITY, growth: f64::NEG_INFINITY, omega: 0.0 }),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// Ends of a bisection, and the steepest direction there.
    type Found = (f64, f64, Option<(Vec<f64>, f64)>);

    /// Failure beyond a straight line, which keeps how many points it was asked for at once.
    struct Beyond(Mutex<Vec<usize>>);

    impl LimitState for Beyond {
        type Error = Error;

        fn dimensions(&self) -> usize {
            2
        }

        fn modes(&self, u: &[f64]) -> Result<Vec<Mode>, Error> {
            Ok(self.modes_of_all(&[u.to_vec()])?.remove(0))
        }

        fn modes_of_all(&self, points: &[Vec<f64>]) -> Result<Vec<Vec<Mode>>, Error> {
            self.0.lock().unwrap().push(points.len());
            Ok(points
                .iter()
                .map(|u| vec![Mode { margin: u[0] + 0.1 * u[1] - 3.0, growth: u[0], omega: 1.0 }])
                .collect())
        }

        fn gradient(&self, _: &[f64], _: &Mode) -> Result<Vec<f64>, Error> {
            Ok(vec![1.0, 0.1])
        }
    }

    #[test]
    fn searches_in_step_find_what_they_find_alone_from_fewer_calls() {
        // A bisection on a ray, of as many points as the ray says, and the gradient at its end.
        fn search<A: Asked>(of: &A, ray: &(usize, Vec<f64>)) -> Result<Found, A::Error> {
            let (mut low, mut high) = (0.0, 10.0);
            for _ in 0..ray.0 {
                let middle = 0.5 * (low + high);
                let fails = of.worst(&[middle * ray.1[0], middle * ray.1[1]])?.margin > 0.0;
                if fails { high = middle } else { low = middle }
            }
            let mode = of.worst_of_all(&[vec![high, low]])?[0];
            Ok((low, high, of.steepest(&[high, low], &mode)?))
        }
        let rays: Vec<(usize, Vec<f64>)> = (0..5).map(|at| (at + 3, vec![1.0, 0.3 * at as f64])).collect();
        let [one, other] = [(); 2].map(|()| Beyond(Mutex::default()));
        let (alone, together) = (Counted::new(&one), Counted::new(&other));
        let expected: Vec<_> = rays.iter().map(|ray| search(&alone, ray).unwrap()).collect();
        assert_eq!(together.in_step(&rays, |of, ray| search(of, ray)).unwrap(), expected);
        assert_eq!(together.evaluations(), alone.evaluations());
        assert_eq!(*other.0.lock().unwrap(), [5, 5, 5, 5, 4, 3, 2, 1]);
    }

    #[test]
    fn the_error_of_a_search_in_step_is_its_own() {
        let state = Beyond(Mutex::default());
        let search = |of: &InStep<'_, Beyond>, at: &usize| {
            of.worst(&[*at as f64, 0.0])?;
            if *at == 1 { Err(Error::NoMargin { omega: 7.0 }.into()) } else { Ok(()) }
        };
        let found = Counted::new(&state).in_step(&[0, 1, 2], search);
        assert!(matches!(found, Err(Error::NoMargin { omega: 7.0 })), "{found:?}");
    }
}
