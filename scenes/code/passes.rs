//! The passes of a frame as pictures: `cargo run --release --example passes` writes the frame, its depth, its normals, its albedo and the
//! outlines of its objects into the folder `out/passes`, or the folder that it is given.

use std::error::Error;
use std::fs;
use std::path::Path;

use rayreel::color::Transfer;
use rayreel::output::{FrameFormat, write};
use rayreel::trace::PassPixel;
use rayreel::{Engine, Film, RenderRequest, Rgb};

pub(crate) fn write_passes(engine: &mut Engine, frame: u32, folder: &Path) -> Result<(), Box<dyn Error>> {
    let time = engine.timeline.time_of(frame);
    let image = engine.render(RenderRequest { passes: true, ..RenderRequest::at(time) })?;
    let transfer = engine.effective_settings().film.transfer;
    let passes = image.passes.ok_or("passes were not requested")?;
    let picture = |color: &dyn Fn(&PassPixel) -> Rgb| {
        Film::from_pixels(passes.width(), passes.height(), passes.pixels().iter().map(color))
    };
    let nearest = passes.pixels().iter().map(|pixel| pixel.depth).fold(f32::INFINITY, f32::min);
    // Numbers of entities differ at outlines.
    let ids: Vec<u32> = passes.pixels().iter().map(|pixel| pixel.id).collect();
    let outlines = (0..ids.len()).map(|index| {
        let beneath = ids.get(index + passes.width() as usize).unwrap_or(&ids[index]);
        let right = ids.get(index + 1).unwrap_or(&ids[index]);
        if ids[index] == *beneath && ids[index] == *right { Rgb::ONE } else { Rgb::ZERO }
    });

    fs::create_dir_all(folder)?;
    for (name, film, transfer) in [
        ("frame.png", image.film, transfer),
        // Depth is infinite in the background, which is black therefore.
        ("depth.png", picture(&|pixel| Rgb::splat(nearest / pixel.depth)), Transfer::Classic),
        ("normal.png", picture(&|pixel| 0.5 * (Rgb::from(pixel.normal) + Rgb::ONE)), Transfer::Classic),
        ("albedo.png", picture(&|pixel| pixel.albedo), transfer),
        ("outlines.png", Film::from_pixels(passes.width(), passes.height(), outlines), Transfer::Classic),
    ] {
        write(&folder.join(name), &film, transfer, FrameFormat::default())?;
    }
    Ok(())
}

#[allow(clippy::print_stdout, reason = "a program prints where its pictures are")]
fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or("out/passes".to_owned());
    write_passes(&mut Engine::load("scenes/chess_morning.ron")?, 48, Path::new(&folder))?;
    println!("{folder}: frame.png, depth.png, normal.png, albedo.png, outlines.png");
    Ok(())
}
