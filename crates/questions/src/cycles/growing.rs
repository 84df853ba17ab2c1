//! The modes from which motions start.

use cea::{CountedSpectrum, EigenSolver, Mode, Modes, QrSolver, Verdict, Workspace, by_frequency, verdicts_beyond};
use num_complex::Complex;
use study::{ModeSource, Plan, Scene, UncertainBrake};

use crate::Error;

/// An unstable mode of a scene.
#[derive(Debug, Clone)]
pub(crate) struct GrowingMode {
    pub rank: usize,
    pub lambda: Complex<f64>,
    pub shape: Vec<Complex<f64>>,
}

impl GrowingMode {
    pub(super) fn rank_in_words(&self) -> String {
        self.rank.to_string()
    }
}

/// Unstable modes of a scene at its medians, in ascending frequency, and real eigenvalues that diverge, 1/s; of a reduced brake these are refused, as all that
/// grows outside of its band.
///
/// # Errors
/// [`Error::GrowsOutside`].
pub(super) fn growing_modes<B: UncertainBrake>(
    brake: &B,
    scene: &Scene,
) -> Result<(Vec<GrowingMode>, Vec<f64>), Error> {
    let system = brake.system(scene, &brake.median())?;
    let mut work = Workspace::default();
    let spectrum = QrSolver.eigenvalues(&system, &mut work).map_err(study::Error::from)?;
    if let Some(source) = brake.mode_source() {
        grows_in_band(brake.plan(), scene, brake.error_of_reduction(scene), &spectrum.eigenvalues)?;
        return Ok((in_band(brake, scene, source, &spectrum.eigenvalues)?, Vec::new()));
    }
    let modes = Modes::classify(&system, &spectrum, &mut work).map_err(study::Error::from)?;
    let threshold = &brake.plan().threshold;
    let verdicts =
        verdicts_beyond(threshold, &system, &modes.oscillatory, &spectrum, &mut work).map_err(study::Error::from)?;
    let is_real = |lambda: Complex<f64>| cea::real_count(lambda) > 0;
    let diverging = CountedSpectrum::of_some(threshold, &system, &spectrum, is_real, &mut work);
    let diverging = diverging.map_err(study::Error::from)?.divergence;
    let growing =
        modes.oscillatory.iter().enumerate().zip(verdicts).filter(|(_, verdict)| *verdict == Verdict::Unstable);
    let mode = |((index, &lambda), _): ((usize, &Complex<f64>), Verdict)| {
        let shape = Mode::at(&system, &[lambda], &mut work).map_err(study::Error::from)?.swap_remove(0).shape;
        Ok(GrowingMode { rank: modes.rank(index), lambda, shape: shape.iter().copied().collect() })
    };
    Ok((growing.map(mode).collect::<Result<_, Error>>()?, diverging))
}

/// Checks that a reduced brake whose eigenvalues have this relative error grows in its band alone: a motion in time has all of its spectrum, and its basis was made for
/// the band.
///
/// # Errors
/// [`Error::GrowsOutside`].
pub(crate) fn grows_in_band(plan: &Plan, scene: &Scene, error: f64, spectrum: &[Complex<f64>]) -> Result<(), Error> {
    match growth_outside(plan, error, spectrum) {
        None => Ok(()),
        Some(lambda) => Err(Error::GrowsOutside {
            scene: plan.describe(scene),
            hz: lambda.im / std::f64::consts::TAU,
            growth: lambda.re,
        }),
    }
}

/// Eigenvalue of a reduced brake that grows fastest of those outside its band.
pub(crate) fn growth_outside(plan: &Plan, error: f64, spectrum: &[Complex<f64>]) -> Option<Complex<f64>> {
    let grows_outside = |lambda: &Complex<f64>| {
        lambda.im >= 0.0 && plan.threshold.margin(*lambda) > error * lambda.norm() && !is_in_band(plan, *lambda)
    };
    spectrum.iter().copied().filter(grows_outside).max_by(|a, b| a.re.total_cmp(&b.re))
}

/// True of an eigenvalue in the band of a reduced brake that does not grow faster than it oscillates.
fn is_in_band(plan: &Plan, lambda: Complex<f64>) -> bool {
    let is_high_enough = plan.least_growth.is_none_or(|least| lambda.re >= least);
    let is_between = plan.band.is_none_or(|[from, to]| from <= lambda.im && lambda.im <= to);
    is_high_enough && is_between && lambda.re <= lambda.im
}

/// Unstable modes in the band of a reduced brake, which finds them itself. Their ranks are those among all modes that it has there.
fn in_band<B: UncertainBrake>(
    brake: &B,
    scene: &Scene,
    source: &dyn ModeSource,
    spectrum: &[Complex<f64>],
) -> Result<Vec<GrowingMode>, Error> {
    let plan = brake.plan();
    let at = brake.operating_point(scene, &brake.median())?;
    let found = source.band_modes(scene, &[at]).into_iter().next().transpose()?.unwrap_or_default();
    let mut all: Vec<Complex<f64>> = spectrum.iter().copied().filter(|lambda| is_in_band(plan, *lambda)).collect();
    all.sort_by(by_frequency);
    let unstable = found.iter().filter(|mode| mode.verdict(&plan.threshold) == Verdict::Unstable);
    let growing = unstable.filter_map(|mode| {
        let distance = |at: &usize| (all[*at] - mode.lambda).norm();
        let nearest = (0..all.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        Some(GrowingMode { rank: nearest + 1, lambda: mode.lambda, shape: mode.shape.iter().copied().collect() })
    });
    Ok(growing.collect())
}
