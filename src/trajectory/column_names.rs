//! Names of columns in the words of all formats.

use std::collections::{HashMap, HashSet};

use super::table::ColumnKind;
use super::text::label;

/// Largest number of columns of an array or a property: more is an error of the writer, such as a transposed array.
pub(super) const MOST_COLUMNS: usize = 1000;

/// Names for columns that other programs name differently.
const KNOWN: [(&str, &[&str]); 8] = [
    ("x", &["X", "Position.X", "Position X", "Points:0", "Points_0", "pos_x", "position_x"]),
    ("y", &["Y", "Position.Y", "Position Y", "Points:1", "Points_1", "pos_y", "position_y"]),
    ("z", &["Z", "Position.Z", "Position Z", "Points:2", "Points_2", "pos_z", "position_z"]),
    ("vx", &["Velocity.X", "Velocity X", "vel_x", "velocity_x"]),
    ("vy", &["Velocity.Y", "Velocity Y", "vel_y", "velocity_y"]),
    ("vz", &["Velocity.Z", "Velocity Z", "vel_z", "velocity_z"]),
    ("id", &["Id", "ID", "Particle Identifier"]),
    ("element", &["Element", "species", "symbol", "symbols"]),
];

/// Returns the names of columns of a table: those of its header, in the words of this module, and each once.
pub(super) fn header_names(names: &[Vec<u8>]) -> Vec<String> {
    let given: Vec<String> = names.iter().map(|name| label(name)).collect();
    let present: HashSet<&str> = given.iter().map(String::as_str).collect();
    let mut uses = HashMap::<String, usize>::new();
    let names = given.iter().enumerate().map(|(index, name)| {
        let known =
            KNOWN.iter().find(|(known, others)| others.contains(&name.as_str()) && !present.contains(known));
        let name = match known {
            Some((known, _)) => (*known).to_owned(),
            None if name.is_empty() => index.to_string(),
            None => name.clone(),
        };
        // As pandas does.
        let count = uses.entry(name.clone()).or_insert(0);
        *count += 1;
        if *count > 1 { format!("{name}.{}", *count - 1) } else { name }
    });
    names.collect()
}

/// Returns the names of columns without a header: the first three with numbers are coordinates, and the others have their index.
pub(super) fn names_without_header(kinds: &[ColumnKind]) -> Vec<String> {
    let mut coordinates = ["x", "y", "z"].into_iter();
    let names = kinds.iter().enumerate().map(|(index, kind)| {
        let coordinate = if *kind == ColumnKind::Numbers { coordinates.next() } else { None };
        coordinate.map_or_else(|| index.to_string(), str::to_owned)
    });
    names.collect()
}

/// Returns the names of the columns of a property with so many values: `forces.x`, `forces.y`, `forces.z`, or `stress.1`, `stress.2` and
/// so on.
pub(super) fn property_names(name: &str, width: usize) -> Vec<String> {
    let fixed = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    match (name, width) {
        ("species" | "element" | "symbols" | "Species" | "Element", 1) => fixed(&["element"]),
        ("pos" | "positions" | "Pos" | "position", 3) => fixed(&["x", "y", "z"]),
        ("pos" | "positions" | "Pos" | "position", 2) => fixed(&["x", "y"]),
        ("velo" | "vel" | "velocity" | "velocities", 3) => fixed(&["vx", "vy", "vz"]),
        (name, 1) => fixed(&[name]),
        (name, 3) => ["x", "y", "z"].map(|axis| format!("{name}.{axis}")).to_vec(),
        (name, width) => (1..=width).map(|index| format!("{name}.{index}")).collect(),
    }
}
