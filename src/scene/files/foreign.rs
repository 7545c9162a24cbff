//! Files of other programs, given as scenes.

use std::path::Path;

use crate::scene::Diagnostic;

/// The remedy for a scene, or a model, of another program.
const SCENE: &str = "write the scene in RON, the notation of rayreel: `rayreel new FILE.ron` writes a small one to start from";
/// The remedy for a program.
const PROGRAM: &str =
    "let the program write a scene in RON: `rayreel new FILE.ron` writes a small one to start from";
/// The remedy for data.
const DATA: &str = "let a script in the scene's list `spawn` make an entity of each line, or let a program write the entities";

/// Returns the diagnostic for a file that is not a scene, but known to be a file of another program by its extension.
pub(super) fn foreign_file(path: &Path) -> Option<Diagnostic> {
    let extension = path.extension()?.to_str()?.to_lowercase();
    let (what, help) = match extension.as_str() {
        "pov" | "inc" => (
            "a scene of POV-Ray",
            "`Coming from POV-Ray`, a chapter of the book, has what to write for each of its words; `rayreel new FILE.ron` writes a small scene to start from",
        ),
        "blend" => ("a file of Blender", SCENE),
        "gltf" | "glb" | "obj" | "fbx" | "stl" | "ply" | "dae" | "usd" | "usda" | "usdc" | "usdz" => {
            ("a model of triangles", SCENE)
        }
        "pbrt" => ("a scene of pbrt", SCENE),
        "py" | "tcl" | "vmd" | "lua" => ("a program", PROGRAM),
        "xyz" | "extxyz" | "pdb" | "cif" | "gro" | "dump" | "lammpstrj" | "xtc" | "trr" | "dcd" => {
            ("a trajectory", DATA)
        }
        "csv" | "tsv" | "npy" | "npz" | "json" => ("a file of data", DATA),
        _ => return None,
    };
    let message = format!("`{}` is {what}, not a scene of rayreel", path.display());
    Some(Diagnostic::new(message, "", Some(help.to_owned()), None))
}
