//! Tests of the scenes in `tests/foreign_scenes/`, which are written in the habits of other programs: all mistakes are reported at once, and
//! the remedies lead to the scene in the file `*.mended.ron`.

use std::fs;

use rayreel::Scene;

use crate::{root, scenes_in};

#[test]
fn scenes_in_the_habits_of_other_programs_are_explained_at_once() {
    let all = scenes_in("tests/foreign_scenes");
    let (mended, foreign): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|path| path.to_string_lossy().ends_with(".mended.ron"));
    assert!(foreign.len() >= 10 && foreign.len() == mended.len());
    for (path, mended) in foreign.iter().zip(&mended) {
        let error = Scene::load(path).err().unwrap();
        assert!(error.mistakes().count() >= 5, "{error}");
        for mistake in error.mistakes() {
            assert!(mistake.diagnostic.help.is_some(), "{error}");
        }
        let message = error.to_string().replace(&format!("{}/", root().display()), "") + "\n";
        let expected = path.with_extension("message");
        if std::env::var_os("RAYREEL_BLESS").is_some() {
            fs::write(&expected, &message).unwrap();
        }
        assert_eq!(message, fs::read_to_string(&expected).unwrap_or_default(), "{}", path.display());
        assert!(Scene::load(mended).is_ok(), "{}", Scene::load(mended).err().unwrap());
    }
}

#[test]
fn files_of_other_programs_are_recognized() {
    let folder = tempfile::tempdir().unwrap();
    let given = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        Scene::load(&path).err().map(|error| error.to_string())
    };
    let message = |name: &str, content: &[u8]| given(name, content).unwrap();
    let pov = message("room.pov", b"#include \"colors.inc\"\ncamera { location <0, 2, -3> }\n");
    assert!(pov.contains("room.pov` is a scene of POV-Ray, not a scene of rayreel\n"), "{pov}");
    assert!(pov.contains("= help: `Coming from POV-Ray`, a chapter of the book"), "{pov}");
    assert!(message("room.blend", b"BLENDER\xff\xfe").contains("is a file of Blender"));
    assert!(
        message("a.GLTF", b"{ \"asset\": { \"version\": \"2.0\" } }").contains("is a model of triangles")
    );
    let xyz = message("water.xyz", b"3\nwater\nO 0 0 0\nH 0 0 1\nH 0 1 0\n");
    assert!(
        xyz.contains("is a trajectory") && xyz.contains("`rayreel new --from DATA my.ron` writes a scene"),
        "{xyz}"
    );
    let program = message("row.py", b"from manim import *\n\nclass Row(ThreeDScene):\n    pass\n");
    assert!(
        program.contains("row.py` is a program, not a scene") && program.contains("write a scene in RON")
    );
    assert!(message("run.dcd", b"\x54\x00\x00\x00CORD").contains("is a trajectory"));
    // What can be read is a scene, whatever its name.
    assert_eq!(given("scene.pov", b"(camera: (position: (0, 0, -5), target: (0, 0, 0)))"), None);
}
