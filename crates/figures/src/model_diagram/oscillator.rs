//! An oscillator, from the side and from above.

use super::super::canvas::{Area, Canvas, Color, Label, Paint, TextAnchor};
use super::super::style::{VERMILLION, arrow};
use super::diagram::ModelDiagram;
use super::elements::{arc, dashpot, ground, spring, symbol};

/// Angles to the plane at which the inclined spring is drawn as it is, degrees; outside it would leave the drawing.
const DRAWN_THETA: [f64; 2] = [35.0, 90.0];

/// Draws an oscillator between foundation and plate, in the upright plane of its inclined spring, z upwards. Returns the y below.
pub(super) fn from_the_side(canvas: &mut Canvas, data: &ModelDiagram, area: Area) -> f64 {
    let heading = "(b) one oscillator, in the plane of its inclined spring";
    let mut top = area.y + 9.0;
    for (i, line) in canvas.fonts.wrap(heading, 9.0, true, area.width).into_iter().enumerate() {
        top = area.y + 9.0 + 11.0 * i as f64;
        canvas.text(Label::new(area.x, top, line).size(9.0).bold());
    }
    let foundation = top + 15.0;
    let (x, y) = (area.x + 0.5 * area.width, foundation + 84.0);
    ground(canvas, (area.x, foundation), area.width, -1.0);
    canvas.text(Label::new(area.right(), foundation + 10.0, "foundation").anchor(TextAnchor::End));

    let (half_width, half_height) = (22.0, 12.0);
    let mass = Area { x: x - half_width, y: y - half_height, width: 2.0 * half_width, height: 2.0 * half_height };
    canvas.rect(mass, Paint::fill(Color::LIGHT_GREY).outlined(Color::BLACK, 0.8));
    canvas.text(Label::new(x, y + 3.0, "m").bold().middle());

    // The spring runs up to the left; which way that is (c) shows.
    let theta = data.theta_degrees.clamp(DRAWN_THETA[0], DRAWN_THETA[1]);
    let foot = (x - 12.0, y - half_height);
    let run = (foot.1 - foundation) / theta.to_radians().tan();
    canvas.line((foot.0 - 40.0, foot.1), foot, Paint::stroke(Color::DARK_GREY, 0.6).dashed(2.0));
    spring(canvas, foot, (foot.0 - run, foundation), Color::BLACK);
    let half_turn = std::f64::consts::PI;
    arc(canvas, foot, 26.0, [half_turn, half_turn + theta.to_radians()]);
    let angle = format!("\u{3b8}\u{a0}=\u{a0}{}\u{b0}", degrees(data.theta_degrees));
    canvas.text(Label::new(foot.0 - 30.0, foot.1 - 8.0, angle).anchor(TextAnchor::End));
    if theta != data.theta_degrees {
        canvas.text(Label::new(area.x, foot.1 + 11.0, format!("drawn as {theta}\u{b0}")));
    }
    let middle = foot.0 - 0.5 * run;
    symbol(canvas, (middle + 8.0, foundation + 26.0), ["k", "a", ""], Color::BLACK);
    let right = (x + 12.0, y - half_height);
    dashpot(canvas, right, (right.0, foundation));
    symbol(canvas, (right.0 + 9.0, (right.1 + foundation) / 2.0 + 4.0), ["c", "z", ""], Color::BLACK);

    let plate = Area { x: area.x, y: y + half_height + 40.0, width: area.width, height: 18.0 };
    spring(canvas, (x, y + half_height), (x, plate.y), Color::BLACK);
    let beside = symbol(canvas, (x + 9.0, y + half_height + 23.0), ["k", "z", ""], Color::BLACK);
    canvas.text(Label::new(beside + 3.0, y + half_height + 23.0, ", in contact"));
    canvas.rect(plate, Paint::fill(Color::WHITE).outlined(Color::BLACK, 0.8));
    canvas.text(Label::new(plate.x + 5.0, plate.y + 12.0, "plate"));

    let floor = plate.bottom() + 34.0;
    spring(canvas, (x - 8.0, plate.bottom()), (x - 8.0, floor), Color::BLACK);
    dashpot(canvas, (x + 8.0, plate.bottom()), (x + 8.0, floor));
    let line = plate.bottom() + 21.0;
    let kp = canvas.fonts.width("k", 10.0, false) + canvas.fonts.width("x,y,z", 8.0, false);
    symbol(canvas, (x - 16.0 - kp, line), ["k", "x,y,z", "p"], Color::BLACK);
    symbol(canvas, (x + 17.0, line), ["c", "x,y,z", "p"], Color::BLACK);
    ground(canvas, (area.x, floor), area.width, 1.0);
    let axis = (area.x + 8.0, y + half_height + 34.0);
    arrow(canvas, axis, (axis.0, axis.1 - 22.0), Color::BLACK);
    canvas.text(Label::new(axis.0 + 5.0, axis.1 - 16.0, "z"));
    floor + 8.0
}

/// An angle without the digits that the way through radians adds.
fn degrees(angle: f64) -> f64 {
    (angle * 1e9).round() / 1e9
}

/// Draws an oscillator from above: the direction of its inclined spring, of sliding and of friction. Returns the y below.
pub(super) fn from_above(canvas: &mut Canvas, data: &ModelDiagram, area: Area) -> f64 {
    canvas.text(Label::new(area.x, area.y + 9.0, "(c) the same, from above").size(9.0).bold());
    let center = (area.x + if data.leans_with_sliding { 0.64 } else { 0.36 } * area.width, area.y + 38.0);
    let phi = data.phi_degrees.to_radians();
    let along = if data.leans_with_sliding { 1.0 } else { -1.0 };
    let direction = (along * phi.cos(), phi.sin());
    let at = |from: f64| (center.0 + from * direction.0, center.1 + from * direction.1);
    canvas.line((center.0 + 60.0 * along, center.1), center, Paint::stroke(Color::DARK_GREY, 0.6).dashed(2.0));
    spring(canvas, at(8.0), at(64.0), Color::BLACK);
    canvas.circle(at(64.0), 2.0, Paint::fill(Color::BLACK));
    let towards_x = if along > 0.0 { 0.0 } else { std::f64::consts::PI };
    arc(canvas, center, 30.0, [towards_x, direction.1.atan2(direction.0)]);
    let square = Area { x: center.0 - 9.0, y: center.1 - 9.0, width: 18.0, height: 18.0 };
    canvas.rect(square, Paint::fill(Color::LIGHT_GREY).outlined(Color::BLACK, 0.8));
    canvas.text(Label::new(center.0, center.1 + 3.0, "m").bold().middle());
    let angle = format!("\u{3c6}\u{a0}=\u{a0}{}\u{b0}", degrees(data.phi_degrees));
    let anchor = if along > 0.0 { TextAnchor::Start } else { TextAnchor::End };
    canvas.text(Label::new(center.0 + along * 36.0, center.1 + 14.0, angle).anchor(anchor));
    symbol(
        canvas,
        (at(50.0).0 - along * 14.0 - if along > 0.0 { 12.0 } else { 0.0 }, at(50.0).1),
        ["k", "a", ""],
        Color::BLACK,
    );
    let (from, anchor) = if along > 0.0 { (-8.0, TextAnchor::End) } else { (8.0, TextAnchor::Start) };
    canvas.text(Label::new(at(64.0).0 + from, at(64.0).1 + 6.0, "on the foundation").anchor(anchor));

    // Sliding and friction on the other side, x to the right as in (a).
    let x = if along > 0.0 { area.x + 8.0 } else { center.0 + 18.0 };
    arrow(canvas, (x, center.1), (x + 24.0, center.1), VERMILLION);
    canvas.text(Label::new(x + 28.0, center.1 + 3.0, "friction \u{3bc}N").color(VERMILLION));
    arrow(canvas, (x, center.1 + 18.0), (x + 24.0, center.1 + 18.0), Color::BLACK);
    canvas.text(Label::new(x + 28.0, center.1 + 21.0, "x, and v of the plate"));
    at(64.0).1.max(center.1 + 22.0) + 10.0
}
