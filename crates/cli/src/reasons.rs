//! Reasons why modes grow, in words and tables: the text of `squeal cea --why`.

use cea::{EQUAL_BUT_FOR_ROUNDING, Workspace, frequency_hz};
use num_complex::Complex;
use output::{hertz, significant};
use squeal::study::{Scene, UncertainBrake};
use squeal::why::{Balance, Contribution, Explainer, Influence, Why, least_damped};

use crate::Error;

/// Most influences that are listed; chosen: a screen. All are in JSON.
const MOST_INFLUENCES: usize = 16;
/// Most contacts and modes of the structure that are listed; chosen: a line.
const MOST_IN_A_LINE: usize = 6;
/// Most influences of values that are 0 that are listed; chosen: a line.
const MOST_OF_ZERO: usize = 3;
/// Least part of a mode of the structure that is listed; chosen: half of a digit shown.
const LEAST_PART: f64 = 0.0005;
/// Note on the columns of an answer, printed below the last one.
const NOTE: &str = "\nholds to: change of the value up to which that of the growth is linear to a tenth; in parentheses where 1 % is beyond \
     it\ngrowth of a family, contact, term or body: the part of the growth that the work of its forces makes; docs/why.md\nmass, \
     damping or stiffness of a term: that matrix alone; a parameter takes along all that depends on it, as the friction that a contact spring brings\n";

/// Words before answers that are of a system with dashpots.
const OF_DASHPOTS: &str = "\nreasons are of the system that has dashpots in the place of loss factors, where a mode grows by another rate than above: if one of \
     both rates is negative they do not say why the brake squeals\n";

/// Answers for modes of a scene.
#[derive(Default)]
pub(super) struct Whys {
    /// Answers, one for each mode.
    pub of_modes: Vec<Why>,
    /// Eigenvalue of the system of the answers for each eigenvalue of the brake that was asked for, in their order; NaN where the system has no such mode.
    pub counterparts: Vec<Complex<f64>>,
    /// The answers are of a system with dashpots in the place of loss factors.
    has_dashpots: bool,
    /// The modes surely are unstable; otherwise none is, and there is one answer, of the least damped.
    are_unstable: bool,
}

/// Reasons why the unstable modes of the first scene of a brake grow, or why the least damped one does not.
pub(super) fn first_scene<B: UncertainBrake>(brake: &B) -> Result<Whys, Error> {
    whys(brake, &brake.plan().scenes[0], None)
}

/// Reasons why the modes of a scene that surely are unstable grow, or why the least damped one does not; where eigenvalues are given, of these
/// alone: other modes of a reduction mean nothing.
pub(super) fn whys<B: UncertainBrake>(brake: &B, scene: &Scene, among: Option<&[Complex<f64>]>) -> Result<Whys, Error> {
    let mut work = Workspace::default();
    let explainer = Explainer::new(brake, scene, &mut work)?;
    let counterpart = |lambda: &Complex<f64>| explainer.counterpart(*lambda).unwrap_or(Complex::from(f64::NAN));
    let counterparts: Vec<Complex<f64>> = among.unwrap_or_default().iter().map(counterpart).collect();
    let is_wanted = |mode: &Complex<f64>| among.is_none() || counterparts.contains(mode);
    let [mut modes, mut all] = [explainer.unstable(&mut work)?, explainer.oscillating()];
    modes.retain(is_wanted);
    all.retain(is_wanted);
    let are_unstable = !modes.is_empty();
    if !are_unstable {
        modes.extend(least_damped(all));
    }
    let has_dashpots = brake.source_with_losses(scene).is_some();
    Ok(Whys { of_modes: explainer.why(&modes, &mut work)?, counterparts, has_dashpots, are_unstable })
}

/// True if an answer belongs to the mode with this eigenvalue.
pub(super) fn is_of(lambda: Complex<f64>, why: &Why) -> bool {
    (lambda - why.lambda).norm() <= EQUAL_BUT_FOR_ROUNDING * lambda.norm()
}

/// Place of the mode of an answer among the eigenvalues of the modes that are listed; of equal ones the first answer belongs to the first.
pub(super) fn place_of(lambdas: impl Iterator<Item = Complex<f64>>, all: &[Why], why: &Why) -> Option<usize> {
    let before = all.iter().take_while(|other| !std::ptr::eq(*other, why));
    let earlier = before.filter(|other| is_of(other.lambda, why)).count();
    lambdas.enumerate().filter(|(_, lambda)| is_of(*lambda, why)).nth(earlier).map(|(place, _)| place)
}

/// Answers, each under a heading with the name of its mode.
pub(super) fn reasons(whys: &Whys, name: impl Fn(&Why) -> String) -> String {
    let one = |why: &Why| {
        let (hz, growth) = (hertz(frequency_hz(why.lambda)), why.lambda.re);
        let heading = match whys.are_unstable {
            true => format!("Why mode{} grows: {hz} Hz, growth {growth:.4} 1/s", name(why)),
            false => {
                format!(
                    "No mode surely is unstable; mode{} is the least damped: {hz} Hz, growth {growth:.4} 1/s",
                    name(why)
                )
            }
        };
        format!("\n{heading}\n{}", text_of(why))
    };
    let text: String = whys.of_modes.iter().map(one).collect();
    match text.is_empty() {
        true => text,
        false if whys.has_dashpots => format!("{OF_DASHPOTS}{text}{NOTE}"),
        false => text + NOTE,
    }
}

/// Text of one answer, without its heading.
fn text_of(why: &Why) -> String {
    let mut text =
        format!("  the next eigenvalue is {:.4} rad/s away, condition number {:.1e}\n\n", why.nearest, why.condition);
    text += &match why.is_simple {
        true => influences(why),
        false => format!(
            "  no derivatives: within rounding it is equal to another eigenvalue, and {:.0e} of a derivative could be rounding\n\n",
            why.blur
        ),
    };
    text += &balance(why.lambda.re, &why.balance);
    let listed = match &why.no_structure_modes {
        Some(reason) => format!("none, {reason}"),
        None => {
            let shown = why.structure_modes.iter().take(MOST_IN_A_LINE).filter(|mode| mode.part >= LEAST_PART);
            let one = shown.map(|mode| format!("{} {} Hz", percent(mode.part), hertz(mode.frequency_hz)));
            one.collect::<Vec<_>>().join(", ")
        }
    };
    text + &format!("\n  of modes of the structure without damping and friction: {listed}\n")
}

/// The numbers that change a mode, by the change of its growth.
fn influences(why: &Why) -> String {
    let mut text = format!(
        "  {:<30}  {:>10} {:<6}  {:>13}  {:>10}  {:>12}\n",
        "1 % more of", "value", "", "growth 1/s ", "Hz", "holds to"
    );
    let (with_percent, zero): (Vec<&Influence>, Vec<_>) =
        why.influences.iter().partition(|influence| influence.growth_per_percent.is_some());
    for influence in with_percent.iter().take(MOST_INFLUENCES) {
        let Influence { name, unit, value, .. } = influence;
        let [growth, hz] =
            [influence.growth_per_percent, influence.frequency_hz_per_percent].map(Option::unwrap_or_default);
        // The unit, or the first word of what is no unit; empty for a number without unit.
        let unit = unit.split(' ').next().filter(|unit| *unit != "1").unwrap_or_default();
        let growth = match influence.holds_for_a_percent() {
            true => format!("{growth:+.4} "),
            false => format!("({growth:+.4})"),
        };
        let (value, reach) = (significant(*value, 4), reach(influence));
        text += &format!("  {name:<30}  {value:>10} {unit:<6}  {growth:>13}  {hz:>+10.4}  {reach:>12}\n");
    }
    let (all, shown) = (with_percent.len(), with_percent.len().min(MOST_INFLUENCES));
    text += &format!(
        "  {shown} of {all}, by the change of the growth; {:.0e} of a derivative could be rounding\n",
        why.blur
    );
    let by_unit = |of: &&Influence| format!("{} {:+.4} {} up to {}", of.name, of.growth, of.per_unit(), reach(of));
    let shown: Vec<String> = zero.iter().take(MOST_OF_ZERO).map(by_unit).collect();
    if !shown.is_empty() {
        let more =
            if zero.len() > shown.len() { format!(", and {} more", zero.len() - shown.len()) } else { String::new() };
        text += &format!("  of values that are 0, without a per cent: {}{more}\n", shown.join(", "));
    }
    if !why.names_parameters {
        text += "  the brake names no parameters: of contacts and terms alone\n";
    }
    if !why.not_varied.is_empty() {
        text += &format!("  not varied, at an end of what is allowed: {}\n", why.not_varied.join(", "));
    }
    text + "\n"
}

/// Balance of a mode as text: what feeds it, and where its energy is.
fn balance(growth: f64, balance: &Balance) -> String {
    let one = |part: &Contribution| format!("{} {:+.4}", part.name, part.growth);
    let families: Vec<String> = balance.families.iter().map(one).collect();
    let mut text =
        format!("  growth {growth:.4} 1/s = {}; off by {:.0e}\n", families.join(", "), balance.identity_residual);
    if balance.contacts.len() > 1 {
        let mut contacts: Vec<&Contribution> = balance.contacts.iter().collect();
        contacts.sort_by(|a, b| b.growth.abs().total_cmp(&a.growth.abs()));
        let shown: Vec<String> = contacts.iter().take(MOST_IN_A_LINE).map(|part| one(part)).collect();
        let rest = contacts.len() - shown.len();
        let more = if rest > 0 { format!(", and {rest} smaller") } else { String::new() };
        text += &format!("  by contact: {}{more}\n", shown.join(", "));
    }
    let line = |name: &str, kinetic: f64, strain: f64, growth: &[f64]| {
        let growth: String = growth.iter().map(|part| format!("  {part:>+12.4}")).collect();
        format!("  {name:<20}  {:>8}  {:>8}{growth}\n", percent(kinetic), percent(strain))
    };
    if balance.terms.len() > 1 {
        text += &format!("\n  {:<20}  {:>8}  {:>8}  {:>12}\n", "term", "kinetic", "strain", "growth 1/s");
        text.extend(balance.terms.iter().map(|term| line(&term.name, term.kinetic, term.strain, &[term.growth])));
    }
    if balance.bodies.len() > 1 {
        let heads: String = balance.families.iter().map(|family| format!("  {:>12}", family.name)).collect();
        text += &format!("\n  {:<20}  {:>8}  {:>8}{heads}\n", "body", "kinetic", "strain");
        text.extend(balance.bodies.iter().map(|body| line(&body.name, body.kinetic, body.strain, &body.growth)));
    }
    text
}

/// Largest change of the value over which the growth is linear to a tenth, in words, relative to the value where that is not 0.
fn reach(influence: &Influence) -> String {
    let to = influence.growth_holds_to;
    match (influence.value == 0.0, to.is_infinite()) {
        (_, true) => "any".into(),
        (true, false) => format!("+-{to:.1e}"),
        (false, false) => format!("+-{} %", significant(100.0 * to / influence.value.abs(), 4)),
    }
}

fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}
