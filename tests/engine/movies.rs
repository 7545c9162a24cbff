//! Tests of movies that programs render.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::process::Command;

use glam::DVec3;
use image::AnimationDecoder;
use image::codecs::gif::GifDecoder;
use image::codecs::png::PngDecoder;

use rayreel::components::{Ambient, FilmSettings, Material, Shape, Transform};
use rayreel::output::{FrameFormat, Sequence, write_movie};
use rayreel::time::Timeline;
use rayreel::{Engine, EngineError, Rgb, Scene, World};

/// Returns an engine with a timeline of six frames of 9 x 5 pixels, on which a ball moves to the right.
fn moving_ball() -> Engine {
    let mut world = World::new();
    let ball = world.spawn((Shape::Sphere { radius: 1.0 }, Material::matte(Rgb::ONE), Transform::IDENTITY));
    world.spawn((FilmSettings::new(9, 5), Ambient(Rgb::ONE)));
    let mut engine = Engine::new(world);
    engine.timeline = Timeline::new(24, 0.25);
    engine.add_system(move |context| {
        let seconds = context.time.seconds();
        context.world.get::<&mut Transform>(ball).unwrap().translation = DVec3::X * 8.0 * seconds;
    });
    engine
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Returns the output bytes of the frames.
fn frames(engine: &mut Engine) -> Vec<Vec<u8>> {
    let transfer = engine.effective_settings().film.transfer;
    (0..6).map(|index| engine.render_frame(index).unwrap().encoded(transfer).bytes().to_vec()).collect()
}

pub(crate) fn animated_png(path: &Path) -> Vec<Vec<u8>> {
    let decoder = PngDecoder::new(BufReader::new(File::open(path).unwrap())).unwrap().apng().unwrap();
    let frames = decoder.into_frames().collect_frames().unwrap();
    let bytes = |frame: &image::Frame| {
        frame.buffer().pixels().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
    };
    frames.iter().map(bytes).collect()
}

#[test]
fn animations_hold_the_frames_of_the_timeline() {
    let folder = tempfile::tempdir().unwrap();
    let (mut engine, movies) = (moving_ball(), folder.path().join("new/folder"));
    let report = engine.render_movie(movies.join("ball.apng")).unwrap();
    assert_eq!((report.written, report.kept), (6, 0));
    let frames = frames(&mut engine);
    assert!(frames.windows(2).any(|pair| pair[0] != pair[1]), "nothing moves");
    assert_eq!(animated_png(&movies.join("ball.apng")), frames);

    engine.render_movie(movies.join("ball.GIF")).unwrap();
    let file = BufReader::new(File::open(movies.join("ball.GIF")).unwrap());
    let shown = GifDecoder::new(file).unwrap().into_frames().collect_frames().unwrap();
    let hundredths: u32 = shown.iter().map(|frame| frame.delay().numer_denom_ms().0 / 10).sum();
    assert_eq!((shown.len(), hundredths), (6, 25));
    // The movie of the frame files is the same, and replaces the first one.
    engine.render_to(folder.path().join("ball")).unwrap();
    let sequence = Sequence::new(folder.path().join("ball"), "ball", 5, FrameFormat::default());
    let files: Vec<_> = (0..6).map(|index| sequence.frame(index)).collect();
    let first = fs::read(movies.join("ball.GIF")).unwrap();
    fs::write(movies.join("ball.GIF"), "an old file").unwrap();
    let made =
        write_movie(&movies.join("ball.GIF"), &files, sequence.format(), engine.timeline.rate, &false.into());
    assert!(made.unwrap() && fs::read(movies.join("ball.GIF")).unwrap() == first);
    assert_eq!(names(&movies), ["ball.GIF", "ball.apng"]);
}

#[test]
fn movies_by_ffmpeg_have_all_frames_and_even_sides() {
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        println!("there is no ffmpeg: nothing was tried");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for name in ["ball.mp4", "ball.webm"] {
        let movie = folder.path().join(name);
        moving_ball().render_movie(&movie).unwrap();
        let mut ffmpeg = Command::new("ffmpeg");
        ffmpeg
            .args(["-loglevel", "error", "-i"])
            .arg(&movie)
            .args(["-f", "rawvideo", "-pix_fmt", "gray", "-"]);
        let output = ffmpeg.output().unwrap();
        assert_eq!(output.stdout.len(), 6 * 10 * 6, "{name}");
    }
    assert_eq!(names(folder.path()), ["ball.mp4", "ball.webm"]);
}

#[test]
fn movies_that_fail_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut engine = moving_ball();
    engine.add_system(|context| {
        let is_late = context.time.seconds() > 0.1;
        for film in context.world.query_mut::<&mut FilmSettings>() {
            film.width = if is_late { 4 } else { 9 };
        }
    });
    let error = engine.render_movie(folder.path().join("ball.gif")).unwrap_err();
    assert!(error.to_string().contains("one has 4x5 pixels, the first 9x5"), "{error}");
    assert_eq!(names(folder.path()), <[&str; 0]>::default());
}

#[test]
fn names_of_movies_and_folders_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let mut engine = moving_ball();
    let error = engine.render_movie(folder.path().join("none/ball.avi")).unwrap_err();
    assert!(
        error.to_string().ends_with(
            "ball.avi`: a movie ends in .mp4, .mov, .mkv or .webm, made by ffmpeg, or in .gif or .apng"
        ),
        "{error}"
    );
    let error = engine.render_to(folder.path().join("ball.mp4")).unwrap_err();
    assert!(error.to_string().contains("call `engine.render_movie`"), "{error}");
    assert_eq!(names(folder.path()), <[&str; 0]>::default());
    fs::create_dir(folder.path().join("ball.mp4")).unwrap();
    assert_eq!(engine.render_to(folder.path().join("ball.mp4")).unwrap().written, 6);
}

/// Checks the text that a program prints if its `main` returns an error.
#[test]
fn errors_returned_from_main_print_their_message_and_causes() {
    let text =
        "Scene(camera: (position: (0, 0, -5), target: (0, 0, 0)), entities: [(shape: Spere(radius: 1))])";
    let error = EngineError::from(Scene::from_text("ball.ron", text.to_owned()).err().unwrap());
    assert_eq!(format!("{error:?}"), error.to_string());
    assert!(format!("{error:?}").contains("--> ball.ron:1:"), "{error:?}");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let error = moving_ball().render_to(file.join("ball")).unwrap_err();
    let cause = std::error::Error::source(&error).unwrap();
    assert_eq!(
        format!("{error:?}"),
        format!("cannot make the folder `{}`: {cause}", file.join("ball").display())
    );
}
