//! Validation of the settings of clouds. Their files are checked when they are opened, and the rest as entities.

use super::{At, Problems, check};
use crate::scene::document::{
    BondsDocument, CloudDocument, ColorByDocument, FramesDocument, SceneDocument, ShapeDocument,
    StyleDocument,
};
use crate::time::{FrameRate, Time};

/// Maximum number of cells along an edge that show particles.
const MOST_IMAGES: u64 = 100;

pub(super) fn validate(document: &SceneDocument, scene: &At<'_>, problems: &mut Problems) {
    let list = scene.field("clouds");
    for (index, cloud) in document.clouds.iter().enumerate() {
        let at = list.index(index);
        look(cloud, &at, problems);
        style(cloud, &at, problems);
        let images = at.field("images");
        let is_wrong = |(_, count): &(usize, &u64)| !(1..=MOST_IMAGES).contains(*count);
        for (index, _) in cloud.images.iter().enumerate().filter(is_wrong) {
            let message = format!("cells are counted from 1 to {MOST_IMAGES}");
            problems.add(&images.index(index), message, "out of range", "write (2, 2, 1) for four cells");
        }
        if let Some(document) = &cloud.bonds {
            bonds(document, &at.field("bonds"), problems);
        }
        frames(&cloud.frames, &at.field("frames"), problems);
    }
}

fn look(cloud: &CloudDocument, at: &At<'_>, problems: &mut Problems) {
    if !matches!(cloud.shape, None | Some(ShapeDocument::Sphere { .. } | ShapeDocument::Box { .. })) {
        let help = "write `Sphere(radius: 1)` or `Box(size: (1, 1, 1))`";
        problems.add(&at.field("shape"), "particles are spheres or boxes", "another shape", help);
    }
    if cloud.color.is_some() && cloud.color_by.is_some() {
        let message = "the cloud has both `color` and `color_by`";
        problems.add(&at.field("color"), message, "one too many", "keep one of the two");
    }
    if let Some(ColorByDocument::Map { range: Some((least, greatest)), .. }) = cloud.color_by {
        let color_by = at.field("color_by");
        let range = color_by.field("range");
        let is_good = [least, greatest]
            .into_iter()
            .zip(0..)
            .all(|(end, index)| check::number(end, &range.index(index), problems));
        if is_good && least == greatest {
            let help = "write the numbers of the first and the last colour, as (0, 3)";
            problems.add(&range, "a range of a single number", "empty", help);
        }
    }
}

/// Checks that a style and the fields that it stands for are not both written.
fn style(cloud: &CloudDocument, at: &At<'_>, problems: &mut Problems) {
    let Some(style) = cloud.style else { return };
    let bonds = at.field("bonds");
    let (name, fields) = match style {
        StyleDocument::Cell => return cell(cloud, at, problems),
        StyleDocument::BallAndStick => {
            ("BallAndStick", "`shape: Sphere(radius: 0.25), scale_by: VanDerWaals, bonds: (radius: 0.15)`")
        }
        StyleDocument::Licorice => ("Licorice", "`shape: Sphere(radius: 0.3), bonds: (radius: 0.3)`"),
    };
    let written = [
        (cloud.shape.is_some(), at.field("shape"), "shape"),
        (cloud.scale_by.is_some(), at.field("scale_by"), "scale_by"),
        (cloud.bonds.as_ref().is_some_and(|bonds| bonds.radius.is_some()), bonds.field("radius"), "radius"),
    ];
    for (_, field, what) in written.iter().filter(|(is_written, ..)| *is_written) {
        let message = format!("the cloud has both `{what}` and a style that sets it");
        let help = format!("keep one of the two: `style: {name}` stands for {fields}");
        problems.add(field, message, "one too many", help);
    }
}

/// Checks that the edges of a cell have no settings of particles.
fn cell(cloud: &CloudDocument, at: &At<'_>, problems: &mut Problems) {
    let bonds = at.field("bonds");
    let has = |has: fn(&BondsDocument) -> bool| cloud.bonds.as_ref().is_some_and(has);
    let written = [
        (cloud.shape.is_some(), at.field("shape"), "shape"),
        (cloud.scale_by.is_some(), at.field("scale_by"), "scale_by"),
        (cloud.color_by.is_some(), at.field("color_by"), "color_by"),
        (cloud.filter.is_some(), at.field("filter"), "filter"),
        (cloud.images != [1; 3], at.field("images"), "images"),
        (has(|bonds| bonds.color.is_some()), bonds.field("color"), "bonds.color"),
        (has(|bonds| bonds.distance.is_some()), bonds.field("distance"), "bonds.distance"),
    ];
    for (_, field, what) in written.iter().filter(|(is_written, ..)| *is_written) {
        let message = format!("the edges of a cell have no `{what}`");
        let help = "remove it, or write it in another cloud of the same file, which shows the particles";
        problems.add(field, message, "of particles only", help);
    }
}

fn bonds(bonds: &BondsDocument, at: &At<'_>, problems: &mut Problems) {
    if let Some(radius) = bonds.radius {
        check::size(radius, "radius", &at.field("radius"), problems);
    }
    if let Some(color) = bonds.color {
        check::color(color.0, &at.field("color"), problems);
    }
    if let Some(distance) = bonds.distance {
        check::size(distance, "distance", &at.field("distance"), problems);
    }
}

fn frames(frames: &FramesDocument, at: &At<'_>, problems: &mut Problems) {
    let start = at.field("start");
    if check::number(frames.start, &start, problems) && start_time(frames.start).is_none() {
        let message = "the start of the frames is beyond a million seconds";
        problems.add(&start, message, "out of range", "write seconds, as 1.5");
    }
    if frame_rate(frames).is_none() {
        let message =
            format!("frames per second are written with numbers from 1 to {}", FrameRate::LARGEST_PART);
        let help = "write a whole number, as 24, or a ratio, as (30000, 1001)";
        problems.add(&at.field("fps"), message, "out of range", help);
    }
}

/// Returns the magnitude of a start, rounded to nanoseconds.
pub(in crate::scene) fn start_time(start: f64) -> Option<Time> {
    const LARGEST: f64 = 1e6;
    (start.abs() <= LARGEST).then(|| format!("{:.9}", start.abs()).parse().ok()).flatten()
}

/// Returns the frames per second of a data file.
pub(in crate::scene) fn frame_rate(frames: &FramesDocument) -> Option<FrameRate> {
    let part = |value: u64| u32::try_from(value).ok();
    FrameRate::new(part(frames.fps.numerator)?, part(frames.fps.denominator)?)
}
