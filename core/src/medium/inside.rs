//! Which media a point lies in.
//!
//! Every surface may name a medium behind it (its interior) and one in front (its exterior). A path that crosses from the front to the back leaves the exterior, if one is named, and enters the
//! interior; from the back to the front the other way round. Of the media that it is in, the one of the highest priority counts, and among equals the one entered last: of nested boundaries
//! the innermost. Boundaries that overlap without one being within the other need priorities, or the medium would depend on the way.

use crate::scene::{CompiledScene, MediumRecord};

/// Most media that a point can lie in at once; what is entered beyond that is not noticed.
pub const INSIDE_MAX: usize = 6;

/// The media that a point lies in, in the order in which they were entered: numbers of media, counted from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inside {
    entered: [u16; INSIDE_MAX],
    len: u16,
}

impl Inside {
    /// In no medium.
    pub const NOTHING: Self = Self { entered: [0; INSIDE_MAX], len: 0 };

    /// In a medium alone; `number` counts from 1, and 0 is none.
    pub fn of(number: u16) -> Self {
        let mut inside = Self::NOTHING;
        inside.enter(number);
        inside
    }

    /// The numbers, two to a word, the earlier one in the lower half; 0 behind the last.
    pub fn packed(&self) -> [u32; INSIDE_MAX / 2] {
        [0, 2, 4].map(|k| u32::from(self.entered[k]) | u32::from(self.entered[k + 1]) << 16)
    }

    /// Whether it is in none.
    #[inline(always)]
    pub fn is_nothing(&self) -> bool {
        self.len == 0
    }

    #[inline(always)]
    fn enter(&mut self, number: u16) {
        if number != 0 && (self.len as usize) < INSIDE_MAX {
            self.entered[self.len as usize] = number;
            self.len += 1;
        }
    }

    /// Forgets the medium where it was entered last; media that were never entered are not left.
    #[inline(always)]
    fn leave(&mut self, number: u16) {
        let len = self.len as usize;
        let Some(at) = self.entered[..len].iter().rposition(|e| *e == number) else { return };
        self.entered.copy_within(at + 1..len, at);
        self.entered[len - 1] = 0;
        self.len -= 1;
    }

    /// After crossing a surface with these media (see [`crate::scene::SurfaceRecord::media`]), to its back or to its front.
    #[inline(always)]
    #[must_use]
    pub fn across(mut self, media: u32, to_back: bool) -> Self {
        if media != 0 {
            let (interior, exterior) = (media as u16, (media >> 16) as u16);
            let (from, to) = if to_back { (exterior, interior) } else { (interior, exterior) };
            self.leave(from);
            self.enter(to);
        }
        self
    }

    /// The medium that counts.
    #[inline(always)]
    pub fn current<'a>(&self, scene: &'a CompiledScene) -> Option<&'a MediumRecord> {
        let mut best: Option<&MediumRecord> = None;
        for number in &self.entered[..self.len as usize] {
            if let Some(medium) = scene.media.get((*number as usize).wrapping_sub(1))
                && best.is_none_or(|b| medium.priority >= b.priority)
            {
                best = Some(medium);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Interior and exterior.
    fn media(interior: u16, exterior: u16) -> u32 {
        u32::from(interior) | u32::from(exterior) << 16
    }

    #[test]
    fn crossing_there_and_back_changes_nothing() {
        for start in [Inside::NOTHING, Inside::of(3), Inside::of(1).across(media(2, 0), true)] {
            for m in [0, media(1, 0), media(3, 0), media(0, 3), media(2, 3), media(3, 3)] {
                // What a start is not in cannot be left, and is there after the way back.
                let there = start.across(m, true);
                let back = there.across(m, false).across(m, true);
                assert_eq!(there, back, "{start:?} {m:#x}");
            }
        }
    }

    #[test]
    fn nested_media_come_back_when_the_inner_one_is_left() {
        let fog = Inside::NOTHING.across(media(1, 0), true);
        let glass = fog.across(media(2, 0), true);
        assert_eq!((glass.len, glass.entered[1]), (2, 2));
        assert_eq!(glass.across(media(2, 0), false), fog);
        // Leaving the outer one first leaves the inner one.
        assert_eq!(glass.across(media(1, 0), false), Inside::of(2));
        assert!(fog.across(media(1, 0), false).is_nothing());
    }

    #[test]
    fn more_than_can_be_held_is_not_noticed() {
        let mut inside = Inside::NOTHING;
        for number in 1..20 {
            inside = inside.across(media(number, 0), true);
        }
        assert_eq!(inside.len as usize, INSIDE_MAX);
        for number in (1..20).rev() {
            inside = inside.across(media(number, 0), false);
        }
        assert!(inside.is_nothing());
    }
}
