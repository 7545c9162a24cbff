//! Faults of the frames of a sequence.

use std::fmt;
use std::mem::discriminant;

use crate::components::Name;
use crate::engine::Engine;
use crate::systems::Fault;

/// A [`Fault`] in one or more frames.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceFault {
    /// The fault in the first of these frames.
    pub fault: Fault,
    /// The name of the entity, or its id.
    pub entity: String,
    /// The index of the first frame with the fault.
    pub frame: u32,
    /// The number of frames with the fault.
    pub frames: usize,
}

impl SequenceFault {
    /// Adds the faults for which `is_wanted` holds, at the engine's current moment, to a list of at most `most` faults. Returns the others
    /// that the list has no room for.
    pub fn collect(
        list: &mut Vec<Self>,
        most: usize,
        engine: &Engine,
        frame: u32,
        is_wanted: impl Fn(&Fault) -> bool,
    ) -> Vec<Fault> {
        let mut others = Vec::new();
        for fault in engine.faults().into_iter().filter(is_wanted) {
            let is_known = |known: &&mut Self| {
                known.fault.entity == fault.entity
                    && discriminant(&known.fault.cause) == discriminant(&fault.cause)
            };
            if let Some(known) = list.iter_mut().find(is_known) {
                known.frames += 1;
            } else if list.len() < most {
                let name = engine.world().get::<&Name>(fault.entity);
                let entity = name
                    .map_or_else(|_| format!("entity {:?}", fault.entity), |name| format!("{:?}", name.0));
                list.push(Self { fault, entity, frame, frames: 1 });
            } else {
                others.push(fault);
            }
        }
        others
    }

    /// Removes the faults that do not [count](Self::counts).
    pub(super) fn remove_passing(list: &mut Vec<Self>, frames: usize) {
        list.retain(|found| found.counts(frames));
    }

    /// Returns whether this is a fault of a sequence of `frames` frames: a fault that [may pass](Fault::may_pass) must be in all of them.
    #[must_use]
    pub fn counts(&self, frames: usize) -> bool {
        !self.fault.may_pass() || self.frames == frames
    }

    /// Returns the frames with the fault as text, as `frame 3 and 5 more`, where `first` names the first of them.
    #[must_use]
    pub fn moments(&self, first: &str) -> String {
        match self.frames {
            0 | 1 => first.to_owned(),
            2 => format!("{first} and one more"),
            frames => format!("{first} and {} more", frames - 1),
        }
    }
}

impl fmt::Display for SequenceFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fault, entity, frame, .. } = self;
        let moments = self.moments(&format!("frame {frame}"));
        write!(formatter, "{moments}: {entity} {fault}; {}", fault.remedy())
    }
}
