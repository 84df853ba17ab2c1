//! Census: the answer to what a stability analysis asks of a system, in one call.

use super::Threshold;
use super::judge::Judge;
use crate::{CeaError, EigenSolver, JudgedEigenvalue, QrSolver, Spectrum, Verdict, Workspace, real_count};
use certified::CertifiedEigenvalue;
use linsys::SecondOrder;

/// The eigenvalues of a system by what becomes of their motion. Conjugate pairs count once.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StabilityCensus {
    /// Modes that oscillate and grow (flutter), ascending in frequency.
    pub growing: Vec<JudgedEigenvalue>,
    /// Real eigenvalues above zero (divergence), ascending.
    pub divergent: Vec<JudgedEigenvalue>,
    /// Eigenvalues on the axis to within what rounding the matrices to doubles may move them by: undamped modes, rigid
    /// bodies, the onset itself.
    pub marginal: Vec<JudgedEigenvalue>,
    /// Eigenvalues of which the certified bounds cannot tell either.
    pub undecided: Vec<JudgedEigenvalue>,
    /// Number of eigenvalues that are left of the axis.
    pub damped: usize,
    /// True if all eigenvalues were found and bounded by [`certified`](crate::certified), because the fast route could not decide on one.
    pub is_certified: bool,
}

impl StabilityCensus {
    /// True if anything grows, with or without oscillation.
    #[must_use]
    pub fn is_unstable(&self) -> bool {
        !(self.growing.is_empty() && self.divergent.is_empty())
    }

    /// True if nothing is known to grow and something may.
    #[must_use]
    pub fn is_open(&self) -> bool {
        !self.is_unstable() && !self.undecided.is_empty()
    }

    fn enter(&mut self, judged: JudgedEigenvalue) {
        match judged.verdict {
            Verdict::Stable => self.damped += 1,
            Verdict::Unstable if real_count(judged.lambda) > 0 => self.divergent.push(judged),
            Verdict::Unstable => self.growing.push(judged),
            Verdict::Marginal { .. } => self.marginal.push(judged),
            Verdict::Undecided { .. } => self.undecided.push(judged),
        }
    }
}

/// Census of the eigenvalues of a system: how many grow, how many are damped, and of which this cannot be said.
///
/// The fast route comes first: [`QrSolver`], and for each eigenvalue that is not clearly left of the imaginary axis the
/// rule and the bound of [`verdict`](crate::verdict). Where this leaves an eigenvalue on the axis or undecided (undamped systems have all
/// eigenvalues there), or the route cannot solve the system at all (a singular M), the eigenvalues and bounds of [`certified::solve`] and
/// [`certified::certify`] take the place of all, some ten times slower, and are judged by the same rule.
///
/// ```
/// use cea::{Workspace, stability_census};
/// use linsys::SecondOrder;
/// use nalgebra::{DMatrix, dmatrix};
///
/// // Two undamped modes that friction couples: K = [3, -1 + 4 mu; -1, 5] flutters above mu = 0.5.
/// let with = |mu: f64| {
///     SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![3.0, -1.0 + 4.0 * mu; -1.0, 5.0])
/// };
/// let mut work = Workspace::default();
/// let below = stability_census(&with(0.4)?, &mut work)?;
/// assert!(!below.is_unstable() && !below.is_open());
/// assert_eq!((below.marginal.len(), below.is_certified), (2, true)); // neutral, and shown to be
///
/// let above = stability_census(&with(0.6)?, &mut work)?;
/// let growing = above.growing[0];
/// assert!(growing.lambda.re > 0.1 && growing.bound < 1e-14);
/// assert_eq!((above.damped, above.is_certified), (1, false)); // nothing was left open
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A malformed system, and errors of [`certified::solve`] and [`certified::certify`].
pub fn stability_census(system: &SecondOrder, work: &mut Workspace) -> Result<StabilityCensus, CeaError> {
    system.check()?;
    // What the fast route cannot do is no error: the general one may.
    let fast = QrSolver.eigenvalues(system, work).ok();
    match fast.as_ref().map(|spectrum| by_single_bounds(system, spectrum, work)) {
        Some(Ok(Some(census))) => Ok(census),
        _ => by_certificates(system, fast.map(|spectrum| spectrum.scale), work),
    }
}

/// Census by the fast route and single bounds; `None` as soon as one eigenvalue is left undecided.
fn by_single_bounds(
    system: &SecondOrder,
    spectrum: &Spectrum,
    work: &mut Workspace,
) -> Result<Option<StabilityCensus>, CeaError> {
    let (mut census, mut judge) = (StabilityCensus::default(), Judge::new(system, spectrum));
    for &lambda in spectrum.eigenvalues.iter().filter(|lambda| lambda.im >= 0.0) {
        if lambda.re < 0.0 && judge.is_clear(lambda, &Threshold::AXIS) {
            census.damped += 1;
            continue;
        }
        let verdict = judge.verdict(lambda, &Threshold::AXIS, work)?;
        if !matches!(verdict, Verdict::Stable | Verdict::Unstable) {
            return Ok(None);
        }
        census.enter(JudgedEigenvalue { verdict, ..judge.bounded(lambda, work)? });
    }
    Ok(Some(census))
}

/// Census of certified eigenvalues, judged by the scale of the fast route's spectrum, or by their own scale where the fast route has no spectrum.
fn by_certificates(
    system: &SecondOrder,
    scale: Option<f64>,
    work: &mut Workspace,
) -> Result<StabilityCensus, CeaError> {
    let spectrum = work.counting(|counters| certified::solve(system, counters))?;
    let certified = work.counting(|counters| certified::certify(system, &spectrum, counters))?;
    let all = certified.eigenvalues.clone();
    let spectrum = Spectrum {
        eigenvalues: all.iter().map(|found| found.lambda).collect(),
        scale: scale.unwrap_or(spectrum.scale),
    };
    let mut judge = Judge::with_certified(system, &spectrum, certified);
    let mut census = StabilityCensus { is_certified: true, ..StabilityCensus::default() };
    for CertifiedEigenvalue { lambda, bound, .. } in all.into_iter().filter(|found| found.lambda.im >= 0.0) {
        census.enter(JudgedEigenvalue { lambda, bound, verdict: judge.verdict(lambda, &Threshold::AXIS, work)? });
    }
    Ok(census)
}
