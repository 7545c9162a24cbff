//! Clouds of particles from data files.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use rayreel::components::{
    Ambient, Camera, Cloud, CloudBonds, CloudColors, CloudMember, CloudSource, FilmSettings, Material, Order,
    Shape, Transform, Visibility,
};
use rayreel::scene::Reader;
use rayreel::time::Timeline;
use rayreel::trace::{Bounds, ShapeId};
use rayreel::{Context, Engine, Film, Ray, Rgb, Scene, Time, World};

use super::named;

/// Three frames of four particles, which leave a cell of 10 units through its sides.
const DATA: &str = "4
Lattice=\"10 0 0 0 10 0 0 0 10\" Properties=species:S:1:pos:R:3:r:R:1:id:I:1:speed:R:1
O 1 1 1 0.5 7 0
H 3 1 1 0.25 8 1
H 5 1 1 0.25 9 2
C 9 1 1 1 10 3
4
Lattice=\"10 0 0 0 10 0 0 0 10\" Properties=species:S:1:pos:R:3:r:R:1:id:I:1:speed:R:1
H 3 3 1 0.25 8 2
O 1 1 3 0.75 7 1
H 5 1 1 0.25 9 2
C 1 1 1 1 10 3
4
Lattice=\"10 0 0 0 10 0 0 0 10\" Properties=species:S:1:pos:R:3:r:R:1:id:I:1:speed:R:1
O 1 1 5 1 7 0
H 3 5 1 0.25 8 1
H 5 1 1 0.25 9 2
C 3 1 1 1 10 3
";

/// Returns a scene with a cloud of these settings, in a folder with the data.
fn scene(cloud: &str) -> String {
    format!(
        "(
    timeline: (fps: 4, duration: 3), film: (width: 40, height: 24), ambient: (1, 1, 1), space: RightHanded,
    camera: (position: (5, 3, 20), target: (5, 3, 0), orthographic: 10), background: (10, 20, 30),
    materials: {{ \"clay\": (k_a: 1, k_d: 0.8, color: (255, 255, 255), specular: (k_s: 0.5, shininess: 20)) }},
    entities: [
        (name: \"first\", shape: Box(size: (1, 1, 1)), material: \"clay\", transform: (translation: (0, 5, 0))),
        (light: Point(intensity: (1, 1, 1)), transform: (translation: (2, 9, 9))),
    ],
    clouds: [(name: \"gas\", source: \"gas.extxyz\", {cloud})],
)"
    )
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("gas.extxyz"), DATA).unwrap();
    folder
}

fn load(folder: &Path, cloud: &str) -> Engine {
    let path = folder.join("scene.ron");
    fs::write(&path, scene(cloud)).unwrap();
    Engine::load(&path).unwrap()
}

fn at(engine: &mut Engine, seconds: &str) -> Cloud {
    engine.seek(seconds.parse().unwrap()).unwrap();
    let gas = named(engine, "gas");
    Cloud::clone(&engine.world().get::<&Cloud>(gas).unwrap())
}

#[test]
fn particles_have_their_places_sizes_and_colours() {
    let folder = folder();
    let settings = "scale_by: Column(\"r\"), color_by: Element, filter: \"element != 'C'\", frames: (fps: 1)";
    let mut engine = load(folder.path(), settings);
    let cloud = at(&mut engine, "0");
    assert_eq!(
        *cloud.positions,
        [DVec3::new(1.0, 1.0, 1.0), DVec3::new(3.0, 1.0, 1.0), DVec3::new(5.0, 1.0, 1.0)]
    );
    assert_eq!(**cloud.scales.as_ref().unwrap(), [0.5, 0.25, 0.25]);
    let transfer = engine.effective_settings().film.transfer;
    let color = |cloud: &Cloud, particle: usize| {
        let CloudColors { palette, indices } = cloud.colors.clone().unwrap();
        transfer.encode(palette[usize::from(indices[particle])])
    };
    // The colours of Jmol.
    assert_eq!([0, 1, 2].map(|particle| color(&cloud, particle)), [[255, 13, 13], [255; 3], [255; 3]]);
    // Frames are shown from their own time on; the order of rows and the number of particles may change.
    assert_eq!(at(&mut engine, "0.999").positions, cloud.positions);
    let next = at(&mut engine, "1");
    assert_eq!((next.positions[0], next.number(0)), (DVec3::new(3.0, 3.0, 1.0), 8));
    // Rays meet the shapes.
    let ray = Ray { origin: DVec3::new(1.0, 1.0, 20.0), direction: DVec3::NEG_Z };
    let hit = engine.cast(ray).unwrap();
    assert_eq!(
        (hit.entity, hit.member, hit.distance),
        (named(&engine, "gas"), Some(CloudMember::Particle(7)), 20.0 - 3.75)
    );
    assert_eq!(engine.prepared().unwrap().drawn().len(), 1 + 3);
    let found = engine.prepared().unwrap().cloud_member(ShapeId(1));
    assert_eq!(found, Some((CloudMember::Particle(8), Some("gas.extxyz, frame 1"))));
}

#[test]
fn values_between_frames_are_in_proportion() {
    let folder = folder();
    let settings = "scale_by: Column(\"r\"), color: (255, 0, 0), frames: (fps: 1, start: 0.5, between: Linear, end: Loop)";
    let mut engine = load(folder.path(), settings);
    let cloud = at(&mut engine, "0.75");
    // The last one takes the way through the side of the cell.
    let expected = [[1.0, 1.0, 1.5], [3.0, 1.5, 1.0], [5.0, 1.0, 1.0], [9.5, 1.0, 1.0]];
    assert_eq!(*cloud.positions, expected.map(DVec3::from_array));
    assert_eq!(**cloud.scales.as_ref().unwrap(), [0.5625, 0.25, 0.25, 1.0]);
    // Before the start, and after three frames, the cycle goes on.
    assert_eq!(at(&mut engine, "0.25").positions[0], DVec3::new(1.0, 1.0, 5.0));
    assert_eq!(*at(&mut engine, "3.75").positions, *cloud.positions);
}

/// Returns the film of a frame, of an engine that has shown nothing before.
fn alone(folder: &Path, cloud: &str, frame: u32) -> Film {
    load(folder, cloud).render_frame(frame).unwrap()
}

#[test]
fn frames_alone_equal_frames_of_the_sequence() {
    let folder = folder();
    for settings in [
        "scale_by: Column(\"r\"), color_by: Map(column: \"speed\"), material: \"clay\", frames: (fps: 2, between: Linear)",
        "scale_by: Covalent, color_by: Category(\"element\"), frames: (fps: 3, end: Loop), filter: \"index < 3\"",
    ] {
        let mut engine = load(folder.path(), settings);
        let mut films = Vec::new();
        for frame in (0..12).chain([5, 0, 11]) {
            let film = engine.render_frame(frame).unwrap();
            assert_eq!(film, alone(folder.path(), settings, frame), "{settings} {frame}");
            films.push(film);
        }
        assert!(films.iter().any(|film| *film != films[0]));
    }
}

#[test]
fn moving_particles_are_blurred_while_the_shutter_is_open() {
    let folder = folder();
    let path = folder.path().join("scene.ron");
    let text = scene("color_by: Element, frames: (fps: 1, between: Linear)")
        .replace("orthographic: 10", "orthographic: 10, shutter: 1")
        .replace("(\n    timeline", "(\n    sampling: (samples: 8), timeline");
    fs::write(&path, &text).unwrap();
    let blurred = Engine::load(&path).unwrap().render_frame(2).unwrap();
    fs::write(&path, text.replace("Linear", "Hold")).unwrap();
    let mut held = Engine::load(&path).unwrap();
    assert_ne!(held.render_frame(2).unwrap(), blurred);
    // Nothing moves between the frames of the file, until the last instants before the next one.
    fs::write(&path, text.replace("Linear", "Hold").replace(", shutter: 1", "")).unwrap();
    assert_eq!(Engine::load(&path).unwrap().render_frame(1).unwrap(), held.render_frame(1).unwrap());
}

/// Two frames of water, the second moved, turned and without one of its bonds, and a lone atom far away.
const WATER: &str = "4
water
O 0 0 0
H 0.96 0 0
H -0.24 0.93 0
C 8 0 0
4
water
O 1 1 0
H 1 1 0.96
H 1 -1.5 0
C 8 0 0
";

/// Loads a scene with water of these settings.
fn water(folder: &Path, cloud: &str) -> Engine {
    fs::write(folder.join("gas.extxyz"), WATER).unwrap();
    load(folder, cloud)
}

/// Returns a number of nine decimals, without what subtraction lost.
fn rounded(number: f64) -> f64 {
    (number * 1e9).round() / 1e9
}

/// Returns what a ray along -z meets first at these x and y, and the height of the hit above the plane z = 0.
fn below(engine: &Engine, x: f64, y: f64) -> Option<(Option<u64>, Option<[u64; 2]>, f64)> {
    let hit = engine.cast(Ray { origin: DVec3::new(x, y, 20.0), direction: DVec3::NEG_Z })?;
    let (particle, bond) = match hit.member? {
        CloudMember::Particle(number) => (Some(number), None),
        CloudMember::Bond(pair) => (None, Some(pair)),
    };
    Some((particle, bond, rounded(20.0 - hit.distance)))
}

#[test]
fn bonds_join_the_atoms_and_follow_them() {
    let folder = folder();
    let mut engine = water(
        folder.path(),
        "color_by: Element, shape: Sphere(radius: 0.1), bonds: (radius: 0.05), frames: (fps: 1)",
    );
    engine.seek(Time::ZERO).unwrap();
    // The rods are as thick as said, as long as the bonds, and have two colours.
    assert_eq!(below(&engine, 0.3, 0.0), Some((None, Some([0, 1]), 0.05)));
    assert_eq!(below(&engine, 0.3, 0.03).unwrap().2, 0.04);
    assert_eq!(below(&engine, 0.0, 0.0), Some((Some(0), None, 0.1)));
    assert_eq!(below(&engine, 0.3, 0.06), None);
    assert_eq!(below(&engine, 1.0, 0.0).unwrap().0, Some(1));
    assert_eq!(below(&engine, 2.0, 0.0), None);
    let transfer = engine.effective_settings().film.transfer;
    let color = |x: f64| {
        let prepared = engine.prepared().unwrap();
        let drawn = u32::try_from(prepared.drawn().len()).unwrap();
        let is_there = |slot: &ShapeId| {
            let Some(Bounds { min, max }) = prepared.scene().geometry().bounds(*slot) else { return false };
            (min.x..max.x).contains(&x) && min.y > -0.06 && max.y < 0.06
        };
        // After the box and the atoms.
        let slot = (5..drawn).map(ShapeId).find(is_there).unwrap();
        transfer.encode(prepared.member_color(slot).unwrap())
    };
    assert_eq!([color(0.1), color(0.479), color(0.481)], [[255, 13, 13], [255, 13, 13], [255; 3]]);
    // A box before them, four atoms, four halves.
    assert_eq!(engine.prepared().unwrap().drawn().len(), 1 + 4 + 4);
    engine.seek("1".parse().unwrap()).unwrap();
    assert_eq!(below(&engine, 0.3, 0.0), None);
    assert_eq!(below(&engine, 1.0, 0.0), None);
    assert_eq!(engine.prepared().unwrap().drawn().len(), 1 + 4 + 2);
    let along = Ray { origin: DVec3::new(20.0, 1.0, 0.3), direction: DVec3::NEG_X };
    let hit = engine.cast(along).unwrap();
    assert_eq!((hit.member, rounded(hit.distance)), (Some(CloudMember::Bond([0, 1])), 18.95));
    let found = engine.prepared().unwrap().cloud_member(ShapeId(5)).unwrap();
    assert_eq!((found.0.to_string(), found.1), ("0-1".to_owned(), Some("gas.extxyz, frame 1")));
}

#[test]
fn bonds_have_a_colour_of_their_own_or_none() {
    let folder = folder();
    let settings = "color_by: Element, shape: Sphere(radius: 0.1), bonds: (color: (0, 0, 255))";
    let mut engine = water(folder.path(), settings);
    engine.seek(Time::ZERO).unwrap();
    // One rod for each bond.
    let prepared = engine.prepared().unwrap();
    assert_eq!(prepared.drawn().len(), 1 + 4 + 2);
    let transfer = engine.effective_settings().film.transfer;
    assert_eq!(prepared.member_color(ShapeId(5)).map(|color| transfer.encode(color)), Some([0, 0, 255]));
    let material = |slot| prepared.scene().material(ShapeId(slot));
    assert!(material(5) == material(6) && material(5) != material(1));
    let mut plain = water(folder.path(), "material: \"clay\", shape: Sphere(radius: 0.1), bonds: ()");
    plain.seek(Time::ZERO).unwrap();
    let prepared = plain.prepared().unwrap();
    assert_eq!((prepared.drawn().len(), prepared.member_color(ShapeId(5))), (1 + 4 + 2, None));
    assert_eq!(prepared.scene().material(ShapeId(5)), prepared.scene().material(ShapeId(1)));
    assert_eq!(below(&plain, 0.3, 0.0).unwrap().2, 0.15);
}

#[test]
fn bonds_of_hidden_particles_are_not_drawn() {
    let folder = folder();
    let drawn = |settings: &str| {
        let mut engine = water(folder.path(), settings);
        engine.seek(Time::ZERO).unwrap();
        let prepared = engine.prepared().unwrap();
        let last = ShapeId(u32::try_from(prepared.drawn().len()).unwrap() - 1);
        (prepared.drawn().len() - 1, prepared.cloud_member(last).unwrap().0.to_string())
    };
    let look = "color: (255, 0, 0), shape: Sphere(radius: 0.1), bonds: ()";
    assert_eq!(drawn(look), (4 + 2, "0-2".to_owned()));
    assert_eq!(drawn(&format!("{look}, filter: \"index != 1\"")), (3 + 1, "0-2".to_owned()));
    assert_eq!(drawn(&format!("{look}, filter: \"element == 'H'\"")), (2, "2".to_owned()));
    // Column y is negative or 0 for all but one: particles without a size are not drawn, nor their bonds.
    assert_eq!(drawn(&format!("{look}, scale_by: Column(\"y\")")), (1, "2".to_owned()));
    // By distance alone, whatever the elements are.
    assert_eq!(drawn("color: (255, 0, 0), bonds: (distance: 1.6)"), (4 + 3, "1-2".to_owned()));
}

#[test]
fn bonds_are_those_of_the_file() {
    let folder = folder();
    let atom = |serial: u32, element: char, x: f64| {
        format!(
            "HETATM{serial:>5}  {element}   LIG A   1    {x:>8.3}{:>8.3}{:>8.3}  1.00  0.00           {element}\n",
            0.0, 0.0
        )
    };
    let atoms = [atom(1, 'C', 0.0), atom(2, 'C', 3.0), atom(3, 'O', 6.0), atom(4, 'H', 6.9)].concat();
    let drawn = |bonds: &str| {
        fs::write(folder.path().join("ligand.pdb"), format!("{atoms}{bonds}END\n")).unwrap();
        let settings = "color: (255, 0, 0), shape: Sphere(radius: 0.1), bonds: ()";
        let text = scene(settings).replace("gas.extxyz", "ligand.pdb");
        let path = folder.path().join("scene.ron");
        fs::write(&path, text).unwrap();
        let mut engine = Engine::load(&path).unwrap();
        engine.seek(Time::ZERO).unwrap();
        let prepared = engine.prepared().unwrap();
        let slots = 5..u32::try_from(prepared.drawn().len()).unwrap();
        slots.map(|slot| prepared.cloud_member(ShapeId(slot)).unwrap().0.to_string()).collect::<Vec<_>>()
    };
    // Bonds of at least half the atoms are all that there are; fewer are completed.
    assert_eq!(drawn("CONECT    1    2\nCONECT    2    3\n").len(), 2);
    assert_eq!(drawn("CONECT    1    2\n").len(), 2);
    assert_eq!(drawn("").len(), 1);
}

#[test]
fn a_style_stands_for_its_fields() {
    let folder = folder();
    for (style, fields) in [
        ("style: BallAndStick", "shape: Sphere(radius: 0.25), scale_by: VanDerWaals, bonds: (radius: 0.15)"),
        ("style: Licorice", "shape: Sphere(radius: 0.3), bonds: (radius: 0.3)"),
        (
            "style: Licorice, bonds: (distance: 1.6)",
            "shape: Sphere(radius: 0.3), bonds: (radius: 0.3, distance: 1.6)",
        ),
    ] {
        let film =
            |look: &str| water(folder.path(), &format!("{look}, color_by: Element")).render_frame(0).unwrap();
        assert_eq!(film(style), film(fields), "{style}");
        assert_ne!(film(style), film("scale_by: Covalent"));
    }
}

#[test]
fn frames_of_bonds_alone_equal_those_of_the_sequence_and_of_reloads() {
    let folder = folder();
    let path = folder.path().join("scene.ron");
    let mut reader = Reader::new();
    let mut engine: Option<Engine> = None;
    for settings in [
        "style: BallAndStick, color_by: Element, frames: (fps: 2, end: Loop)",
        "style: BallAndStick, color_by: Element, frames: (fps: 1, between: Linear)",
        "style: BallAndStick, color_by: Category(\"element\"), frames: (fps: 1, between: Linear)",
        "style: BallAndStick, color_by: Element, bonds: (color: (9, 9, 9)), frames: (fps: 1)",
        "style: BallAndStick, color_by: Element, bonds: (color: (99, 9, 9)), frames: (fps: 1)",
        "style: Licorice, color: (200, 10, 10), bonds: (distance: 2), frames: (fps: 1)",
        "style: Licorice, color: (200, 10, 10), transform: (scale: (1, 2, 1), rotation: Euler(0, 0, 30))",
    ] {
        let mut cold = water(folder.path(), settings);
        let scene = reader.load(&path).unwrap().0;
        match &mut engine {
            Some(engine) => engine.reload(scene),
            None => engine = Some(Engine::from_scene(scene)),
        }
        let engine = engine.as_mut().unwrap();
        for frame in [0, 3, 4, 5, 11, 0] {
            let film = cold.render_frame(frame).unwrap();
            assert_eq!(
                film,
                water(folder.path(), settings).render_frame(frame).unwrap(),
                "{settings} {frame}"
            );
            assert_eq!(film, engine.render_frame(frame).unwrap(), "{settings} {frame}");
        }
    }
}

#[test]
fn reloads_equal_cold_starts_and_read_no_file() {
    let folder = folder();
    let (path, data) = (folder.path().join("scene.ron"), folder.path().join("gas.extxyz"));
    let mut reader = Reader::new();
    let mut engine: Option<Engine> = None;
    let edits = [
        "color_by: Element",
        "color_by: Element, filter: \"x < 4\"",
        "color_by: Map(column: \"speed\", map: Turbo, range: (0, 2)), filter: \"x < 4\"",
        "color_by: Map(column: \"speed\", map: Magma, range: (0, 2)), filter: \"x < 4\"",
        "color: (200, 10, 10), scale_by: Column(\"r\"), shape: Box(size: (1, 2, 1))",
        "material: \"clay\", visible: false",
        "material: \"clay\", frames: (between: Linear, fps: 1)",
        "material: \"clay\", frames: (between: Linear, fps: 1), transform: (rotation: Euler(0, 0, 30), scale: (1, 2, 1))",
    ];
    let modified = fs::metadata(&data).unwrap().modified().unwrap();
    let mut unreadable = false;
    for edit in edits {
        fs::write(&path, scene(edit)).unwrap();
        fs::write(&data, DATA).unwrap();
        let cold = Engine::load(&path).unwrap().render_frame(3).unwrap();
        if unreadable {
            // Of the same length and time, but not a number: whoever reads it fails.
            fs::write(&data, DATA.replace('1', "?")).unwrap();
        }
        fs::File::options().write(true).open(&data).unwrap().set_modified(modified).unwrap();
        let (scene, _) = reader.load(&path).unwrap();
        match &mut engine {
            Some(engine) => engine.reload(scene),
            None => engine = Some(Engine::from_scene(scene)),
        }
        let engine = engine.as_mut().unwrap();
        assert_eq!(engine.render_frame(3).unwrap(), cold, "{edit}");
        // The frames that the last edits show.
        engine.render_frame(4).unwrap();
        unreadable = true;
        if edit.starts_with("material: \"clay\", visible") {
            unreadable = false;
        }
    }
}

#[test]
fn changed_files_are_read_again() {
    let folder = folder();
    let path = folder.path().join("scene.ron");
    fs::write(&path, scene("color: (255, 0, 0)")).unwrap();
    let mut reader = Reader::new();
    let (scene, _) = reader.load(&path).unwrap();
    assert!(scene.files.contains(&folder.path().join("gas.extxyz")));
    let mut engine = Engine::from_scene(scene);
    let before = engine.render_frame(0).unwrap();
    fs::write(folder.path().join("gas.extxyz"), DATA.replace("O 1 1 1", "O 1 3.5 1")).unwrap();
    engine.reload(reader.load(&path).unwrap().0);
    let after = engine.render_frame(0).unwrap();
    assert_ne!(before, after);
    assert_eq!(after, Engine::load(&path).unwrap().render_frame(0).unwrap());
}

#[test]
fn files_that_grow_are_followed() {
    let folder = folder();
    let (path, data) = (folder.path().join("scene.ron"), folder.path().join("gas.extxyz"));
    let (start, _) = DATA.match_indices("4\n").nth(2).map(|(start, _)| DATA.split_at(start)).unwrap();
    fs::write(&path, scene("color: (255, 0, 0), frames: (fps: 4)")).unwrap();
    fs::write(&data, start).unwrap();
    let mut reader = Reader::new();
    let mut engine = Engine::from_scene(reader.load(&path).unwrap().0);
    let before = engine.render_frame(9).unwrap();
    // Within the next frame, after its last line without the line end, and whole.
    for length in [start.len() + 20, DATA.len() - 1, DATA.len()] {
        fs::write(&data, &DATA[..length]).unwrap();
        engine.reload(reader.load(&path).unwrap().0);
        let film = engine.render_frame(9).unwrap();
        assert_eq!(film, Engine::load(&path).unwrap().render_frame(9).unwrap(), "{length}");
        assert_eq!(film == before, length < DATA.len() - 1, "{length}");
    }
}

#[test]
fn cells_have_edges_and_images() {
    let folder = folder();
    let edges = |settings: &str| {
        let mut engine = load(folder.path(), &format!("color: (255, 0, 0), {settings}"));
        engine.seek(Time::ZERO).unwrap();
        engine
    };
    let engine = edges("style: Cell, bonds: (radius: 0.5)");
    assert_eq!(below(&engine, 5.0, 10.0), Some((None, Some([6, 7]), 10.5)));
    assert_eq!(below(&engine, 10.3, 10.0).unwrap().0, Some(7));
    assert_eq!(below(&engine, 5.0, 8.0), None);
    assert_eq!(rounded(below(&edges("style: Cell"), 5.0, 10.0).unwrap().2), 10.025);
    let engine = edges("shape: Sphere(radius: 0.5), images: (2, 1, 1), filter: \"element == 'O'\"");
    assert_eq!(below(&engine, 1.0, 1.0), Some((Some(7), None, 1.5)));
    assert_eq!(below(&engine, 11.0, 1.0), Some((Some(7), None, 1.5)));
    assert_eq!([(21.0, 1.0), (1.0, 11.0)].map(|(x, y)| below(&engine, x, y)), [None; 2]);
}

#[test]
fn molecules_in_left_handed_space_are_warned_of() {
    let folder = folder();
    let warnings = |space: &str| {
        let text = scene("color: (255, 0, 0)").replace("space: RightHanded,", space);
        fs::write(folder.path().join("scene.ron"), text).unwrap();
        let warnings = Scene::load(&folder.path().join("scene.ron")).unwrap().warnings;
        warnings.into_iter().map(|warning| (warning.name, warning.message)).collect::<Vec<_>>()
    };
    let message = "molecules in left-handed space: each is shown as its mirror image".to_owned();
    assert_eq!(warnings(""), [("left-handed", message)]);
    assert_eq!(warnings("space: LeftHanded,"), []);
    assert_eq!(warnings("space: RightHanded,"), []);
    fs::write(folder.path().join("gas.extxyz"), DATA.replace("species:S", "kind:S")).unwrap();
    assert_eq!(warnings(""), []);
}

#[test]
fn only_moving_particles_are_prepared_again() {
    let folder = folder();
    let animate = "animate: [(target: \"camera\", channel: Position, track: Keys([(0, (5, 3, 20)), (3, (6, 3, 20))]))],\n)";
    let text = scene("color_by: Element, frames: (fps: 1)");
    let path = folder.path().join("scene.ron");
    fs::write(&path, text.strip_suffix(')').unwrap().to_owned() + animate).unwrap();
    let mut engine = Engine::load(&path).unwrap();
    let builds: Vec<u32> = (0..9)
        .map(|frame| {
            engine.render_frame(frame).unwrap();
            engine.report().bvh_builds
        })
        .collect();
    // Frames of the file begin with frames 0, 4 and 8 of the film; the camera moves all the time.
    assert_eq!(builds, [1, 0, 0, 0, 1, 0, 0, 0, 1]);
}

/// Returns a world with a box, a cloud and another box, in this order.
fn world(cloud: Cloud, shape: Shape, transform: Transform) -> World {
    let mut world = World::new();
    let clay = Material::matte(Rgb::new(0.9, 0.5, 0.2));
    let cube = Shape::Box { size: DVec3::ONE };
    world.spawn((cube, clay, Transform::at(-1.0, 0.0, 0.0), Order(0)));
    world.spawn((shape, clay, transform, cloud, Order(1)));
    world.spawn((cube, clay, Transform::at(3.0, 0.0, 0.0), Order(2)));
    world.spawn((Camera::looking_at(DVec3::new(0.0, 1.0, -9.0), DVec3::ZERO),));
    world.spawn((FilmSettings::new(48, 32), Ambient(Rgb::splat(0.3))));
    world.spawn((rayreel::components::Light::point(Rgb::ONE), Transform::at(3.0, 8.0, -8.0)));
    world
}

fn cloud() -> Cloud {
    let positions =
        (0..9).map(|index| DVec3::new(f64::from(index) * 0.7 - 3.0, f64::from(index % 3), 0.1)).collect();
    let scales = (0..9).map(|index| 0.2 + f64::from(index) / 16.0).collect();
    let colors = CloudColors {
        palette: Arc::new(vec![Rgb::X, Rgb::Y, Rgb::new(0.2, 0.3, 0.9)]),
        indices: Arc::new((0..9).map(|index| index % 3).collect()),
    };
    Cloud {
        positions: Arc::new(positions),
        scales: Some(Arc::new(scales)),
        colors: Some(colors),
        ..Cloud::default()
    }
}

#[test]
fn a_cloud_looks_like_an_entity_for_each_particle() {
    let turned = Transform {
        rotation: glam::DQuat::from_rotation_z(0.5),
        scale: DVec3::new(1.0, 1.5, 1.0),
        ..Transform::at(0.0, 0.5, 0.0)
    };
    for shape in [Shape::Sphere { radius: 0.6 }, Shape::Box { size: DVec3::splat(0.9) }] {
        for transform in [Transform::IDENTITY, Transform::at(0.1, 0.2, 0.3), turned] {
            let mut many = world(Cloud::default(), shape, transform);
            let cloud = cloud();
            let parent = many.spawn((transform,));
            let colors = cloud.colors.clone().unwrap();
            for (particle, (position, scale)) in
                cloud.positions.iter().zip(&**cloud.scales.as_ref().unwrap()).enumerate()
            {
                let color = colors.palette[usize::from(colors.indices[particle])];
                let own =
                    Transform { translation: *position, scale: DVec3::splat(*scale), ..Transform::IDENTITY };
                many.spawn((
                    shape,
                    Material::matte(color),
                    own,
                    rayreel::components::Parent(parent),
                    Order(1),
                ));
            }
            let film = Engine::new(many).render_frame(0).unwrap();
            assert_eq!(
                Engine::new(world(cloud, shape, transform)).render_frame(0).unwrap(),
                film,
                "{shape:?}"
            );
        }
    }
}

#[test]
fn a_bond_looks_like_cylinders_between_its_particles() {
    let turned = Transform {
        rotation: glam::DQuat::from_rotation_z(0.5),
        scale: DVec3::new(1.0, 1.5, 1.0),
        ..Transform::at(0.0, 0.5, 0.0)
    };
    let pairs = [[0_u32, 1], [7, 4], [3, 3], [2, 90]];
    for (color, transform) in [(None, Transform::IDENTITY), (Some(Rgb::X), turned), (None, turned)] {
        let bonds = CloudBonds { pairs: Arc::new(pairs.to_vec()), radius: 0.125, color };
        let plain = Cloud { scales: None, ..cloud() };
        let shape = Shape::Sphere { radius: 0.25 };
        let mut many = world(plain.clone(), shape, transform);
        let parent = many.spawn((transform,));
        let colors = plain.colors.clone().unwrap();
        // A pair of one particle, and one with a particle that there is not, have no bond.
        for [one, other] in &pairs[..2] {
            let [from, to] = [one, other].map(|particle| plain.positions[*particle as usize]);
            let of = |particle: &u32| colors.palette[usize::from(colors.indices[*particle as usize])];
            let middle = from.midpoint(to);
            let rods = match color {
                Some(color) => vec![(from, to, color)],
                None => vec![(from, middle, of(one)), (middle, to, of(other))],
            };
            for (from, to, color) in rods {
                let rod = Shape::Cylinder { radius: 0.125, from, to };
                let parent = rayreel::components::Parent(parent);
                many.spawn((rod, Material::matte(color), Transform::IDENTITY, parent, Order(1)));
            }
        }
        let bonded = Cloud { bonds: Some(bonds), ..plain };
        let mut engine = Engine::new(world(bonded, shape, transform));
        let film = engine.render_frame(0).unwrap();
        assert_eq!(film, Engine::new(many).render_frame(0).unwrap(), "{color:?}");
        // The box after the cloud is in the slot after its bonds.
        let prepared = engine.prepared().unwrap();
        let rods = if color.is_none() { 4 } else { 2 };
        let members: Vec<Option<String>> = (9..=10 + rods)
            .map(|slot| prepared.cloud_member(ShapeId(slot)).map(|(member, _)| member.to_string()))
            .collect();
        let halves = rods as usize / 2;
        let names = [
            vec![Some("8".to_owned())],
            vec![Some("0-1".to_owned()); halves],
            vec![Some("7-4".to_owned()); halves],
            vec![None],
        ];
        assert_eq!(members, names.concat());
        assert!(engine.faults().is_empty());
    }
}

#[test]
fn systems_move_and_colour_bonds() {
    let bonds = CloudBonds { pairs: Arc::new(vec![[0, 4], [4, 8]]), radius: 0.2, color: None };
    let bonded = Cloud { bonds: Some(bonds), ..cloud() };
    let world = world(bonded, Shape::Sphere { radius: 0.3 }, Transform::IDENTITY);
    let gas = world.query::<(rayreel::Entity, &Cloud)>().iter().next().unwrap().0;
    let edits: [fn(&mut Cloud); 5] = [
        |cloud| Arc::make_mut(&mut cloud.positions)[4].y += 0.5,
        |cloud| cloud.bonds.as_mut().unwrap().color = Some(Rgb::Y),
        |cloud| cloud.bonds.as_mut().unwrap().color = Some(Rgb::Z),
        |cloud| cloud.bonds.as_mut().unwrap().radius = 0.1,
        |cloud| cloud.bonds = None,
    ];
    let mut engine = Engine::new(world);
    let mut before = engine.render_frame(0).unwrap();
    for (index, edit) in edits.into_iter().enumerate() {
        edit(&mut engine.world_mut().get::<&mut Cloud>(gas).unwrap());
        let film = engine.render_frame(0).unwrap();
        assert_ne!(film, before, "{index}");
        let mut cold = self::world(cloud(), Shape::Sphere { radius: 0.3 }, Transform::IDENTITY);
        let gas_of_cold = cold.query::<(rayreel::Entity, &Cloud)>().iter().next().unwrap().0;
        let same = Cloud::clone(&engine.world().get::<&Cloud>(gas).unwrap());
        cold.insert_one(gas_of_cold, same).unwrap();
        assert_eq!(film, Engine::new(cold).render_frame(0).unwrap(), "{index}");
        before = film;
    }
    let bonds = CloudBonds { pairs: Arc::new(vec![[0, 4]]), radius: -1.0, color: None };
    engine.world_mut().get::<&mut Cloud>(gas).unwrap().bonds = Some(bonds);
    assert_eq!(engine.render_frame(0).unwrap(), before);
    assert_eq!(
        engine.faults().iter().map(ToString::to_string).collect::<Vec<_>>(),
        ["is drawn in part: its radius of bonds is -1"]
    );
}

#[test]
fn systems_move_and_hide_particles() {
    let world = world(cloud(), Shape::Sphere { radius: 0.5 }, Transform::IDENTITY);
    let gas = world.query::<(rayreel::Entity, &Cloud)>().iter().next().unwrap().0;
    let mut engine = Engine::new(world);
    engine.timeline = Timeline::new(4, 2.0);
    engine.add_system(move |context: &mut Context<'_>| {
        let seconds = context.time.seconds();
        let mut cloud = context.world.get::<&mut Cloud>(gas).unwrap();
        Arc::make_mut(&mut cloud.positions)[4].y += seconds;
        if seconds > 1.0 {
            Arc::make_mut(cloud.scales.as_mut().unwrap())[0] = f64::NAN;
        }
        drop(cloud);
        context.changes.mark_shape(gas);
    });
    let films: Vec<Film> = (0..8).map(|frame| engine.render_frame(frame).unwrap()).collect();
    assert!(films.windows(2).all(|pair| pair[0] != pair[1]));
    let faults = engine.faults();
    assert_eq!(
        faults.iter().map(ToString::to_string).collect::<Vec<_>>(),
        ["is drawn in part: 1 of its 9 particles have no finite position, or no scale above 0"]
    );
    // The slots of the others are still those of their particles.
    let prepared = engine.prepared().unwrap();
    assert_eq!(
        [1, 2, 8].map(|slot| prepared.cloud_member(ShapeId(slot)).map(|(number, _)| number)),
        [1, 2, 8].map(|number| Some(CloudMember::Particle(number)))
    );
    assert_eq!((prepared.cloud_member(ShapeId(0)), prepared.cloud_member(ShapeId(9))), (None, None));
    for frame in [3, 0, 7] {
        assert_eq!(engine.render_frame(frame).unwrap(), films[frame as usize], "{frame}");
    }
    engine.world_mut().insert_one(gas, Visibility::NONE).unwrap();
    assert_ne!(engine.render_frame(0).unwrap(), films[0]);
    assert_eq!(engine.prepared().unwrap().drawn().len(), 2);
}

#[test]
fn later_frames_report_their_errors() {
    let folder = folder();
    let data = DATA.replace("C 1 1 1", "Qq 1 1 1");
    fs::write(folder.path().join("gas.extxyz"), data).unwrap();
    let mut engine = load(folder.path(), "color_by: Element, frames: (fps: 1)");
    engine.seek(Time::ZERO).unwrap();
    let error = engine.seek("1.5".parse().unwrap()).unwrap_err().to_string();
    assert!(
        error.contains("scene.ron:9: the cloud \"gas\" at t = 1.5: ")
            && error.contains("no chemical element \"Qq\""),
        "{error}"
    );
    // Other moments are shown as before.
    engine.seek("2".parse().unwrap()).unwrap();
    let _ = engine.world().query::<&CloudSource>().iter().count();
}

#[test]
fn clouds_are_included_with_their_names_and_transforms() {
    let folder = folder();
    fs::write(folder.path().join("part.ron"), scene("material: \"clay\"")).unwrap();
    let text = "(include: [(file: \"part.ron\", name: \"box\", transform: (translation: (0, 2, 0)))], space: RightHanded,
        camera: (position: (5, 3, 20), target: (5, 3, 0)),
        animate: [(target: \"box/gas\", channel: Color, track: Keys([(0, (255, 0, 0)), (2, (0, 0, 255))]))])";
    let path = folder.path().join("scene.ron");
    fs::write(&path, text).unwrap();
    let (scene, sources) = Scene::load_with_sources(&path).unwrap();
    let mut engine = Engine::from_scene(scene);
    engine.seek("1".parse().unwrap()).unwrap();
    let gas = named(&engine, "box/gas");
    let hit = engine.cast(Ray { origin: DVec3::new(5.0, 3.0, 20.0), direction: DVec3::NEG_Z }).unwrap();
    assert_eq!((hit.entity, hit.distance), (gas, 18.0));
    let order = engine.world().get::<&Order>(gas).unwrap().0;
    let line = sources.entities(&[usize::try_from(order).unwrap()]).next().unwrap().to_string();
    assert!(line.ends_with("part.ron:9"), "{line}");
    let blended = engine.prepared().unwrap().scene().material(ShapeId(1)).diffuse;
    assert!(blended.x > 0.0 && blended.z > 0.0);
}

#[test]
fn cameras_and_entities_follow_particles() {
    let folder = folder();
    let text =
        scene("color_by: Element, frames: (fps: 1, between: Linear), transform: (translation: (0, 1, 0))");
    let text = text
        .replace(
            "camera: (position: (5, 3, 20), target: (5, 3, 0)",
            "camera: (position: (5, 3, 20), look_at: \"gas/8\"",
        )
        .replace(
            "entities: [",
            "entities: [(name: \"rider\", parent: \"gas/7\", transform: (translation: (0, 0, 2))),",
        );
    let path = folder.path().join("scene.ron");
    fs::write(&path, &text).unwrap();
    let mut engine = Engine::load(&path).unwrap();
    for (seconds, z) in [("0", 1.0), ("0.5", 2.0), ("1.25", 3.5)] {
        engine.seek(seconds.parse().unwrap()).unwrap();
        let rider = named(&engine, "rider");
        let placed =
            engine.world().get::<&rayreel::components::WorldTransform>(rider).unwrap().affine.translation;
        assert_eq!(placed, DVec3::new(1.0, 2.0, z + 2.0));
    }
    let view = engine.prepared().unwrap().camera().axes()[2];
    let expected = (DVec3::new(3.0, 4.5, 1.0) - DVec3::new(5.0, 3.0, 20.0)).normalize();
    assert!((view - expected).length() < 1e-12, "{view}");
    fs::write(&path, text.replace("gas/8", "gas/8x")).unwrap();
    assert!(Scene::load(&path).err().unwrap().to_string().contains("there is no entity \"gas/8x\""));
    fs::write(&path, text.replace("gas/8", "gas/88")).unwrap();
    let error = Engine::load(&path).unwrap().seek(Time::ZERO).unwrap_err().to_string();
    assert!(error.contains("there is no particle 88"), "{error}");
}
