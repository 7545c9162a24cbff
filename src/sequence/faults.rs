//! Faults of the frames of a sequence.

use std::fmt;
use std::mem::discriminant;

use super::FrameRequest;
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
    /// Adds the faults at the engine's current moment to a list.
    pub(super) fn collect(list: &mut Vec<Self>, engine: &Engine, request: &FrameRequest) {
        for fault in engine.faults() {
            let is_known = |known: &&mut Self| {
                known.fault.entity == fault.entity
                    && discriminant(&known.fault.cause) == discriminant(&fault.cause)
            };
            if let Some(known) = list.iter_mut().find(is_known) {
                known.frames += 1;
                continue;
            }
            let name = engine.world().get::<&Name>(fault.entity);
            let entity =
                name.map_or_else(|_| format!("entity {:?}", fault.entity), |name| format!("{:?}", name.0));
            list.push(Self { fault, entity, frame: request.frame.unwrap_or_default(), frames: 1 });
        }
    }

    /// Removes the faults that [may pass](Fault::may_pass) and are not in all of this number of frames.
    pub(super) fn remove_passing(list: &mut Vec<Self>, frames: usize) {
        list.retain(|found| !found.fault.may_pass() || found.frames == frames);
    }
}

impl fmt::Display for SequenceFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fault, entity, frame, frames } = self;
        write!(formatter, "frame {frame}")?;
        if *frames > 1 {
            write!(formatter, " and {} more", frames - 1)?;
        }
        write!(formatter, ": {entity} {fault}; {}", fault.remedy())
    }
}
