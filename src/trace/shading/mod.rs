//! Light transport at surfaces and in media: the physics shared by the stages and the reference path.

mod area_light_samples;
mod context;
mod contribution;
mod dielectric;
mod direct;
mod direct_packet;
mod facing_normals;
mod filter;
mod handover;
mod light_sample_packet;
mod medium_stack;
mod passage_packet;
mod path_packet;
mod refraction_packet;
mod scratch;
mod secondary;
mod secondary_packet;
mod terms;
mod terms_packet;
#[cfg(test)]
mod tests;
mod transmission;

pub(crate) use area_light_samples::AreaLightSamples;
pub(crate) use context::RenderContext;
pub(crate) use contribution::{ErrorBudget, RadianceBound, most_radiance};
pub(crate) use direct::{LightSample, SampleId, ShadingPoint, ShadowRay, light_terms};
pub use direct::{LightTerms, Unlit};
pub(crate) use direct_packet::sample_light_lanes;
pub(crate) use handover::handed_over;
pub(crate) use light_sample_packet::{LightSamplePacket, ShadingPacket};
pub(crate) use medium_stack::MediumStack;
pub(crate) use passage_packet::{Absorbers, PassageLanes, transmittances};
pub(crate) use path_packet::PathPacket;
pub(crate) use scratch::LightScratch;
pub(crate) use secondary::{
    LARGEST_TREE, PathState, SecondaryRays, TreeRay, secondary_rays, secondary_rays_and_terms,
};
pub use secondary::{RefractionTerms, SecondaryTerms};
pub(crate) use secondary_packet::{BranchPacket, branch_lanes};
pub(crate) use terms::{ambient, clamped, emission};
pub(crate) use transmission::{filtered_along, filtered_and_absorbed, visibility};
