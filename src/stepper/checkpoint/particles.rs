//! The particles and their order in memory.

use std::io;

use super::codec::{In, Out};
use crate::error::RestoreError;
use crate::particles::Particles;
use crate::record::Record;
use crate::scalar::Scalar;
use crate::stepper::order::Order;

impl<T, const D: usize, S, P> Particles<T, D, S, P>
where
    T: Scalar,
    S: Record<T> + Copy + Default,
    P: Record<T> + Copy + Default,
{
    pub(super) fn save(&self, out: &mut Out<'_>) -> io::Result<()> {
        out.records(&self.initial_position)?;
        out.records(&self.position)?;
        out.records(&self.displacement)?;
        out.records(&self.velocity)?;
        out.records(&self.stress)?;
        out.numbers(&self.mass)?;
        out.numbers(&self.volume)?;
        out.records(&self.state)?;
        out.records(&self.phase)?;
        out.records(&self.domains.half_lengths)?;
        out.records(&self.domains.half_edges)
    }

    /// Their states take so many numbers each.
    pub(super) fn restore(&mut self, from: &mut In<'_>, numbers_each: usize) -> Result<(), RestoreError> {
        from.records("the initial position of particle", &mut self.initial_position)?;
        from.records("the position of particle", &mut self.position)?;
        from.records("the displacement of particle", &mut self.displacement)?;
        from.records("the velocity of particle", &mut self.velocity)?;
        from.records("the stress of particle", &mut self.stress)?;
        from.numbers(&mut self.mass)?;
        from.numbers(&mut self.volume)?;
        from.records("the state of particle", &mut self.state)?;
        from.records("the second phase of particle", &mut self.phase)?;
        from.records("the half lengths of particle", &mut self.domains.half_lengths)?;
        from.records("the half edges of particle", &mut self.domains.half_edges)?;
        Ok(self.validate_with(numbers_each)?)
    }
}

impl Order {
    pub(super) fn save(&self, out: &mut Out<'_>) -> io::Result<()> {
        out.count(self.numbers.len())?;
        out.indices(&self.numbers)?;
        out.count(self.crossings)?;
        out.flag(self.moved)
    }

    pub(super) fn load(&mut self, from: &mut In<'_>) -> Result<(), RestoreError> {
        from.expect("particles in the order of their cells", self.numbers.len())?;
        from.indices(&mut self.numbers)?;
        let mut seen = vec![false; self.numbers.len()];
        for (index, &number) in self.numbers.iter().enumerate() {
            match seen.get_mut(number as usize) {
                Some(seen) if !*seen => *seen = true,
                _ => {
                    let what = "the number of particle";
                    return Err(RestoreError::Invalid { what, index });
                }
            }
        }
        self.crossings = from.count()?;
        self.moved = from.flag()?;
        // Those without numbers of their own never move.
        if self.moved && self.numbers.is_empty() {
            let what = "the order of the particles";
            return Err(RestoreError::Invalid { what, index: 0 });
        }
        Ok(())
    }
}
