//! Formats of data files, and their names.

use std::path::Path;

/// A format of data files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Rows of values, separated by commas, semicolons, tabs or blanks, with or without a header.
    Csv,
    /// XYZ and extended XYZ.
    Xyz,
    /// Text dumps of LAMMPS.
    Lammps,
    /// Protein Data Bank.
    Pdb,
    /// One array of NumPy.
    Npy,
    /// Arrays of NumPy by name.
    Npz,
    /// Compressed trajectories of GROMACS.
    Xtc,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 7] =
        [Self::Csv, Self::Xyz, Self::Lammps, Self::Pdb, Self::Npy, Self::Npz, Self::Xtc];

    /// Returns the ends of the names of such files.
    #[must_use]
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Csv => &["csv", "tsv", "tab"],
            Self::Xyz => &["xyz", "extxyz", "exyz"],
            Self::Lammps => &["dump", "lammpstrj", "lammpsdump"],
            Self::Pdb => &["pdb", "ent"],
            Self::Npy => &["npy"],
            Self::Npz => &["npz"],
            Self::Xtc => &["xtc"],
        }
    }

    /// Returns the format of a file by its name, in which `.gz` or `.zst` may follow; upper and lower case are the same.
    #[must_use]
    pub fn of_name(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        let compressed = [".gz", ".zst", ".zstd"].iter().find_map(|end| name.strip_suffix(end));
        let name = compressed.unwrap_or(&name);
        let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
        // LAMMPS's own examples are named `dump.melt`.
        let dump = (stem == "dump" || stem.starts_with("dump.")).then_some(Self::Lammps);
        Self::ALL.into_iter().find(|format| format.extensions().contains(&extension)).or(dump)
    }
}
