//! Judges every route on a problem: routes of this project, whose verdicts use error bounds, and routes of libraries.

use cea::{CeaError, Verdict, Workspace, certified, verdict};
use num_complex::Complex;

use crate::library_baselines::judge_libraries;
use crate::problem::{ReferenceProblem, RouteOutcome, structural_eigenvalues};

/// Name of the route of a study in reports.
pub(crate) const STANDARD: &str = "QrSolver + verdict";
/// Name of the route for any dense problem in reports.
pub(crate) const GENERAL: &str = "general + certify";

type Verdicts = Result<Vec<(Complex<f64>, Verdict)>, CeaError>;

impl ReferenceProblem {
    /// The results of both routes of this project and of the libraries.
    pub fn judge(&self) -> Vec<RouteOutcome> {
        let mut outcomes = vec![self.outcome(STANDARD, self.standard()), self.outcome(GENERAL, self.general())];
        outcomes.extend(judge_libraries(self));
        outcomes
    }

    fn outcome(&self, route: &'static str, found: Verdicts) -> RouteOutcome {
        match found {
            Ok(found) => RouteOutcome::Judged(self.compare(route, &found)),
            Err(error) => RouteOutcome::Refused { case: self.name.clone(), route, reason: error.to_string() },
        }
    }

    /// The eigenvalues with verdicts as in a study.
    fn standard(&self) -> Verdicts {
        let mut work = Workspace::default();
        let (lambdas, spectrum) = structural_eigenvalues(&self.system)?;
        lambdas.into_iter().map(|l| Ok((l, verdict(&self.system, l, &spectrum, &mut work)?))).collect()
    }

    fn general(&self) -> Verdicts {
        let mut counters = certified::Counters::default();
        let spectrum = certified::solve(&self.system, &mut counters)?;
        let certified = certified::certify(&self.system, &spectrum, &mut counters)?;
        Ok(certified.eigenvalues.iter().map(|c| (c.lambda, c.verdict)).collect())
    }
}
