//! Sides of its kinks on which a motion is in a piece, and what changes where it goes over to another one.

use crate::Error;
use crate::contact::Sliding;
use crate::path::Path;
use crate::stick::{Stuck, TURNED};

impl Path<'_> {
    /// Which contacts are closed in the piece.
    pub fn all_closed(&self) -> Vec<bool> {
        (0..self.sliding.len()).map(|contact| self.is_closed(contact)).collect()
    }

    /// Takes the sides of what slides and of what is held back, and the contacts that stick.
    pub fn take_sides(&mut self) {
        for (contact, sliding) in self.sliding.iter().enumerate().filter(|(_, sliding)| **sliding != Sliding::Smooth) {
            let is_forwards = *sliding == Sliding::Forwards;
            self.sides[4 * contact + 1..4 * contact + 4].copy_from_slice(&[true, is_forwards, true]);
            // What just begins to slide is not said to turn by a rounding.
            let speed = self.system.contacts()[contact].speed;
            self.kinks[4 * contact + 2].1 = speed * (1.0 + if is_forwards { TURNED } else { -TURNED });
        }
        self.stuck = Stuck::new(self.system, &self.sliding);
    }

    /// True of a kink that the piece may come to.
    pub fn is_active(&self, kink: usize) -> bool {
        match self.sliding.get(kink / 4) {
            None => true,
            // Friction without a jump has no kink where a contact begins to count as stuck.
            Some(Sliding::Smooth) => kink.is_multiple_of(2),
            Some(sliding) => match kink % 4 {
                0 => true,
                2 => *sliding != Sliding::Stuck && self.is_closed(kink / 4),
                _ => *sliding == Sliding::Stuck,
            },
        }
    }

    /// Goes over to the other side of a kink.
    pub fn cross(&mut self, kink: usize) -> Result<(), Error> {
        self.sides[kink] = !self.sides[kink];
        let contact = kink / 4;
        if self.sliding.get(contact).is_none_or(|sliding| *sliding == Sliding::Smooth) {
            return Ok(());
        }
        let (system, was_stuck) = (self.system, self.sliding[contact] == Sliding::Stuck);
        match kink % 4 {
            0 if was_stuck || self.is_closed(contact) => {
                self.sliding[contact] = Sliding::of(system.contacts()[contact].slip(&self.x[system.order()..]));
            }
            0 => return Ok(()),
            1 => self.sliding[contact] = Sliding::Forwards,
            3 => self.sliding[contact] = Sliding::Backwards,
            _ => {
                let is_closed = self.all_closed();
                let mut rates = [vec![0.0; system.dimension()], vec![0.0; system.dimension()]];
                system.rate_of(&self.x, &is_closed, &self.sliding, &mut rates[0], |_, _| ());
                let is_open = |at: &usize| *at == contact || self.sliding[*at] == Sliding::Stuck;
                let open: Vec<usize> = (0..is_closed.len()).filter(is_open).collect();
                system.settle(&self.x, &is_closed, &mut self.sliding, &open)?;
                if let Some(stuck) = Stuck::new(system, &self.sliding) {
                    stuck.stop(system, &mut self.x);
                }
                system.rate_of(&self.x, &is_closed, &self.sliding, &mut rates[1], |_, _| ());
                self.jump = Some((is_closed.len() + contact, rates));
            }
        }
        self.take_sides();
        Ok(())
    }

    /// True of a contact that is closed in the piece.
    pub fn is_closed(&self, contact: usize) -> bool {
        self.sides[4 * contact]
    }

    /// Phase of a contact in the piece: whether it is closed, and how it slides.
    pub fn phase(&self, contact: usize) -> (bool, Sliding) {
        let sliding = match self.sliding[contact] {
            Sliding::Smooth => Sliding::of(if self.sides[4 * contact + 2] { 1.0 } else { -1.0 }),
            sliding => sliding,
        };
        (self.is_closed(contact), sliding)
    }
}
