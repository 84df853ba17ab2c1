//! The contacts of a case for the motion after the onset: with load, speed and spring.

use std::sync::Arc;

use cycle::{SlidingContact, Smoothed};
use friction::AmontonsCoulomb;
use linsys::{Channel, ChannelGain};

use super::{GainExpressions, MatricesCase};
use crate::check::{Check, field};
use crate::{CaseError, Expression};

impl MatricesCase {
    /// The contacts of `channels`, which are the channels of the case with a set of constraints, with their gains at values of the parameters. A contact
    /// sticks below `stick` of its speed.
    ///
    /// # Errors
    /// A contact without load or speed, or with a reading and no stiffness; one whose law is known by its slope alone; a viscoelastic term.
    pub fn sliding_contacts(
        &self,
        channels: &[Channel],
        gains: &[ChannelGain],
        values: &[f64],
        stick: f64,
    ) -> Result<Vec<SlidingContact>, CaseError> {
        if let Some(branch) = self.branches.first() {
            let allowed = "terms that do not relax: the motion after the onset is followed without their states";
            return Err(Check::new(&self.header.path).value(&branch.field, "given", allowed));
        }
        let contacts = channels.iter().zip(gains).zip(&self.gains);
        contacts.map(|((channel, gain), given)| self.sliding_contact(channel, gain, given, values, stick)).collect()
    }

    fn sliding_contact(
        &self,
        channel: &Channel,
        gain: &ChannelGain,
        given: &GainExpressions,
        values: &[f64],
        stick: f64,
    ) -> Result<SlidingContact, CaseError> {
        let check = Check::new(&self.header.path);
        let of = |key: &str| field("contacts", &channel.name, key);
        let slope = Some(("slope", gain.slope)).filter(|(_, slope)| *slope != 0.0);
        if let Some((key, value)) = slope.or(gain.lag.map(|lag| ("lag.force", lag.force))) {
            let allowed = "mu alone: a slope or lag is the tangent of a law that the case does not give, and its motion needs the law";
            return Err(check.value(&of(key), value, allowed));
        }
        let law = AmontonsCoulomb::new(gain.mu)
            .map_err(|_| check.value(&of("mu"), gain.mu, "a number >= 0, so that friction acts against the sliding"))?;
        let number = |key: &str, expression: &Option<Expression>, why: &str| -> Result<f64, CaseError> {
            let Some(expression) = expression else { return Err(check.value(&of(key), "missing", why)) };
            let value = expression.value(values).map_err(check.expression(&of(key)))?;
            if value > 0.0 { Ok(value) } else { Err(check.value(&of(key), value, "a number > 0")) }
        };
        let load = number("load", &given.load, "the normal force in steady sliding, N, at which the contact opens")?;
        let speed = number("speed", &given.speed, "the speed of steady sliding, m/s, at which the contact sticks")?;
        let stiffness = match channel.reading.is_empty() {
            true => 0.0,
            false => number(
                "stiffness",
                &given.stiffness,
                "the spring of the contact, N/m, by which an open one pushes no more",
            )?,
        };
        Ok(SlidingContact {
            name: channel.name.clone(),
            family: channel.family.clone(),
            // Friction acts against the force of the channel.
            sliding: channel.force.iter().map(|&(dof, value)| (dof, -value)).collect(),
            normal: channel.reading.iter().map(|&(dof, value)| (dof, value / stiffness)).collect(),
            stiffness,
            load,
            speed,
            friction: Arc::new(Smoothed { law, stick_speed: stick * speed }),
        })
    }
}
