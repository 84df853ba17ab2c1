//! The samples of a brake: checks of medians, inputs with their coordinates, and the one parameter of a scene that has one.

use montecarlo::stream;

use super::first_of_each;
use super::same::{Difference, numbers, points_differ};
use crate::Error;
use crate::{Contradiction, DrawnInputs, Input, Scene, SingleParameter, UncertainBrake};

/// Rounding of a number of an operating point that is computed twice, as a fraction of it; chosen: less than that is no other formula.
const ROUNDING: f64 = 1e-9;
/// Rounding of the median of a distribution by its quantile function, as a fraction of a number; chosen: quantiles that are found by
/// iteration have fewer digits than sums.
const OF_QUANTILES: f64 = 1e-6;
/// Number of draws by which a scene with one parameter is checked; chosen: with fewer, a brake that is wrong somewhere passes; with more, every command waits
/// longer.
const DRAWS: u64 = 8;
/// Number of values of that parameter between which a draw is looked for, evenly in probability; chosen: section search finds it
/// between two of these.
const GRID: u32 = 64;
/// Largest distance of a draw that is on the curve of that parameter, in units of the range of each number; chosen: far
/// above what the search leaves and far below what a second parameter does.
const OFF_CURVE: f64 = 1e-3;
/// Coordinates at which an input is compared with that at one half; several, for a distribution that is constant over most of them.
const COORDINATES: [f64; 6] = [0.75, 0.25, 0.95, 0.05, 0.999, 0.001];

pub(super) fn check<B: UncertainBrake>(brake: &B) -> Result<(), Error> {
    medians(brake)?;
    let Some(drawn) = brake.drawn_inputs() else { return Ok(()) };
    for scene in first_of_each(&brake.plan().scenes, |scene| scene.key) {
        inputs(brake, drawn, scene)?;
        single_parameter(brake, drawn, scene)?;
    }
    Ok(())
}

/// Checks that the naming point of each configuration is the operating point of the medians in one of its scenes, if the plan says that it is.
fn medians<B: UncertainBrake>(brake: &B) -> Result<(), Error> {
    let (plan, median) = (brake.plan(), brake.median());
    if !plan.is_named_at_medians {
        return Ok(());
    }
    for (at, configuration) in plan.configurations.iter().enumerate() {
        let mut first = None;
        for scene in plan.scenes.iter().filter(|scene| scene.configuration == at) {
            let point = brake.operating_point(scene, &median)?;
            match points_differ(&configuration.brake.system, &configuration.naming_point, &point, ROUNDING) {
                None => {
                    first = None;
                    break;
                }
                Some(difference) => first = first.or(Some((scene, difference))),
            }
        }
        if let Some((scene, Difference { what, found, expected })) = first {
            let scene = plan.describe(scene);
            return Err(
                Contradiction::Medians { configuration: at, what, named: found, median: expected, scene }.into()
            );
        }
    }
    Ok(())
}

/// Checks that each input has a value, and that the values in samples by quantiles are functions of their coordinates.
fn inputs<B: UncertainBrake>(brake: &B, of: &dyn DrawnInputs<B::Sample>, scene: &Scene) -> Result<(), Error> {
    let (plan, median, inputs) = (brake.plan(), brake.median(), of.inputs(scene));
    let drawn = brake.draw(&mut stream(plan.seed, 0)).ok();
    for sample in [Some(&median), drawn.as_ref()].into_iter().flatten() {
        let values = of.input_values(scene, sample).len();
        if values != inputs.len() {
            return Err(Contradiction::InputValues { scene: plan.describe(scene), inputs: inputs.len(), values }.into());
        }
    }
    if inputs.is_empty() {
        return Ok(());
    }
    let middle = of.quantile_sample(scene, &|_| 0.5);
    if plan.source_file.is_none()
        && inputs.iter().all(|input| !input.is_correlated)
        && let (Ok(found), Ok(expected)) =
            (brake.operating_point(scene, &middle), brake.operating_point(scene, &median))
        && let Some(Difference { what, found, expected }) =
            points_differ(&plan.brake(scene).system, &found, &expected, OF_QUANTILES)
    {
        let (one, other) = ("quantile_sample() at one half".into(), "median()".into());
        return Err(Contradiction::Differ { scene: plan.describe(scene), one, other, what, found, expected }.into());
    }
    let middle = of.input_values(scene, &middle);
    // One with atoms may keep its value wherever its coordinate is.
    let smooth = inputs.iter().enumerate().filter(|(_, input)| !input.has_atoms);
    for (at, Input { name, coordinate, is_correlated, .. }) in smooth {
        let moved = |u: f64| {
            let sample = of.quantile_sample(scene, &|d| if d == *coordinate { u } else { 0.5 });
            Some(of.input_values(scene, &sample)).filter(|values| values.get(at) != middle.get(at))
        };
        let Some(values) = COORDINATES.into_iter().find_map(moved) else {
            let (scene, input) = (plan.describe(scene), name.clone());
            return Err(Contradiction::IdleCoordinate { scene, input, coordinate: *coordinate }.into());
        };
        let is_other = |(_, other): &(usize, &Input)| !other.is_correlated && other.coordinate != *coordinate;
        let mut others = inputs.iter().enumerate().filter(is_other);
        if let Some((_, input)) = others.find(|&(other, _)| !is_correlated && values.get(other) != middle.get(other)) {
            return Err(Contradiction::SharedCoordinate {
                scene: plan.describe(scene),
                input: input.name.clone(),
                coordinate: *coordinate,
                other: name.clone(),
            }
            .into());
        }
    }
    Ok(())
}

/// Checks that a scene that is said to have one parameter has it, and no other.
fn single_parameter<B: UncertainBrake>(brake: &B, of: &dyn DrawnInputs<B::Sample>, scene: &Scene) -> Result<(), Error> {
    let Some(single) = of.single_parameter(scene) else { return Ok(()) };
    let described = || brake.plan().describe(scene);
    let not_single = |found: String| Err(Contradiction::NotSingle { scene: described(), found }.into());
    let inputs = of.inputs(scene);
    if inputs.len() > 1 {
        let names: Vec<&str> = inputs.iter().map(|input| input.name.as_str()).collect();
        return not_single(format!("inputs() lists {}", names.join(", ")));
    }
    let sample = single.sample(single.distribution.median());
    let system = &brake.plan().brake(scene).system;
    let (found, expected) = (brake.operating_point(scene, &sample)?, brake.operating_point(scene, &brake.median())?);
    if let Some(Difference { what, found, expected }) = points_differ(system, &found, &expected, OF_QUANTILES) {
        let (one, other) = ("single_parameter() at the median".into(), "median()".into());
        return Err(Contradiction::Differ { scene: described(), one, other, what, found, expected }.into());
    }
    // Of a case file it is known which parameters its formulas hold; these may oscillate, so that no search finds a draw on the curve.
    if brake.plan().source_file.is_some() {
        return Ok(());
    }
    let curve = Curve::new(brake, scene, &single);
    let drawn = (0..DRAWS).filter_map(|index| {
        let sample = brake.draw(&mut stream(brake.plan().seed, index)).ok()?;
        let point = brake.operating_point(scene, &sample).ok()?;
        // The value of the one input says where on the curve a draw is.
        let same = of.input_values(scene, &sample).first().map(|&value| single.sample(value));
        let is_on_curve =
            same.and_then(|same| brake.operating_point(scene, &same).ok()).is_some_and(|same| same == point);
        let point = || numbers(system, &point).into_iter().map(|(_, number)| number).collect();
        (!is_on_curve).then(|| (index, point()))
    });
    let (draws, drawn): (Vec<u64>, Vec<Vec<f64>>) = drawn.unzip();
    match drawn.iter().position(|point| curve.distance(point, &drawn) > OFF_CURVE).map(|place| draws[place]) {
        None => Ok(()),
        Some(at) => not_single(format!("draw {at} has an operating point that single_parameter() has at no value")),
    }
}

/// The operating points of one parameter, over its probability.
struct Curve<'a> {
    at: Box<dyn Fn(f64) -> Option<Vec<f64>> + 'a>,
    grid: Vec<(f64, Vec<f64>)>,
}

impl<'a> Curve<'a> {
    fn new<B: UncertainBrake>(brake: &'a B, scene: &'a Scene, single: &'a SingleParameter<'_, B::Sample>) -> Self {
        let system = &brake.plan().brake(scene).system;
        let at = move |u: f64| {
            let sample = single.sample(single.distribution.quantile(u));
            let point = brake.operating_point(scene, &sample).ok()?;
            Some(numbers(system, &point).into_iter().map(|(_, number)| number).collect::<Vec<f64>>())
        };
        let places = (0..GRID).map(|place| (f64::from(place) + 0.5) / f64::from(GRID));
        let grid = places.filter_map(|u| Some((u, at(u)?))).collect();
        Self { at: Box::new(at), grid }
    }

    /// The distance of a point from the curve, in units of the range that each number has on the curve and in all points.
    fn distance(&self, point: &[f64], points: &[Vec<f64>]) -> f64 {
        let all = || self.grid.iter().map(|(_, numbers)| numbers).chain(points);
        let range = |place: usize| {
            let (least, most) = all()
                .filter_map(|numbers| numbers.get(place))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
            // What is constant but for rounding has no range.
            (most - least).max(ROUNDING * most.abs().max(least.abs()))
        };
        let ranges: Vec<f64> = (0..point.len()).map(range).collect();
        let distance = |numbers: &[f64]| {
            let each =
                numbers.iter().zip(point).zip(&ranges).filter(|((a, b), _)| a != b && !(a.is_nan() && b.is_nan()));
            each.map(|((a, b), range)| (a - b).abs() / range).fold(0.0, f64::max)
        };
        let at = |u: f64| (self.at)(u).map_or(f64::INFINITY, |numbers| distance(&numbers));
        let nearest = self.grid.iter().min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
        let Some((u, _)) = nearest else { return 0.0 };
        let step = 1.0 / f64::from(GRID);
        least((u - step).max(f64::MIN_POSITIVE), (u + step).min(1.0 - f64::EPSILON), at)
    }
}

/// The least value of a function between two places, found by golden sections.
fn least(mut from: f64, mut to: f64, value: impl Fn(f64) -> f64) -> f64 {
    const SECTION: f64 = 0.618_033_988_749_894_9;
    let mut least = value(from).min(value(to));
    for _ in 0..50 {
        let (a, b) = (to - SECTION * (to - from), from + SECTION * (to - from));
        let (at_a, at_b) = (value(a), value(b));
        least = least.min(at_a).min(at_b);
        if at_a < at_b { to = b } else { from = a }
    }
    least
}
