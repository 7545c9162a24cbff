//! Files of other programs, given as scenes.

use std::path::Path;

use crate::scene::Diagnostic;

/// The remedy for a scene, or a model, of another program.
const SCENE: &str = "write the scene in RON, the notation of rayreel: `rayreel new FILE.ron` writes a small one to start from";
/// The remedy for a program.
const PROGRAM: &str =
    "let the program write a scene in RON: `rayreel new FILE.ron` writes a small one to start from";
/// The remedy for data.
const DATA: &str = "`rayreel new --from DATA my.ron` writes a scene that shows the particles of the file, and `rayreel render my.ron` renders it";

/// The remedy for data that no scene can show.
const OTHER_DATA: &str = "convert it to a format that scenes show, such as extended XYZ, XTC, CSV or NPY: `rayreel new --from DATA my.ron` writes a scene for it";

/// Returns the diagnostic for a file that is not a scene, but known to be a file of another program by its extension.
pub(super) fn foreign_file(path: &Path) -> Option<Diagnostic> {
    let name = path.file_name()?.to_str()?.to_lowercase();
    // Data is often compressed.
    let name = [".gz", ".zst"].into_iter().find_map(|end| name.strip_suffix(end)).unwrap_or(&name);
    let (_, extension) = name.rsplit_once('.')?;
    let (what, help) = match extension {
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
        "xyz" | "extxyz" | "pdb" | "ent" | "dump" | "lammpstrj" | "xtc" => ("a trajectory", DATA),
        "cif" | "gro" | "trr" | "dcd" => ("a trajectory", OTHER_DATA),
        "csv" | "tsv" | "npy" | "npz" => ("a file of data", DATA),
        "json" => ("a file of data", OTHER_DATA),
        _ => return None,
    };
    let message = format!("`{}` is {what}, not a scene of rayreel", path.display());
    Some(Diagnostic::new(message, "", Some(help.to_owned()), None))
}
