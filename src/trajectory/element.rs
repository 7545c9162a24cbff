//! Symbols of the chemical elements.

use super::snapshot::{Snapshot, Values};

/// Symbols by atomic number, from 1.
pub(super) const SYMBOLS: [&str; 118] = [
    "H", "He", "Li", "Be", "B", "C", "N", "O", "F", "Ne", "Na", "Mg", "Al", "Si", "P", "S", "Cl", "Ar", "K",
    "Ca", "Sc", "Ti", "V", "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn", "Ga", "Ge", "As", "Se", "Br", "Kr",
    "Rb", "Sr", "Y", "Zr", "Nb", "Mo", "Tc", "Ru", "Rh", "Pd", "Ag", "Cd", "In", "Sn", "Sb", "Te", "I", "Xe",
    "Cs", "Ba", "La", "Ce", "Pr", "Nd", "Pm", "Sm", "Eu", "Gd", "Tb", "Dy", "Ho", "Er", "Tm", "Yb", "Lu",
    "Hf", "Ta", "W", "Re", "Os", "Ir", "Pt", "Au", "Hg", "Tl", "Pb", "Bi", "Po", "At", "Rn", "Fr", "Ra",
    "Ac", "Th", "Pa", "U", "Np", "Pu", "Am", "Cm", "Bk", "Cf", "Es", "Fm", "Md", "No", "Lr", "Rf", "Db",
    "Sg", "Bh", "Hs", "Mt", "Ds", "Rg", "Cn", "Nh", "Fl", "Mc", "Lv", "Ts", "Og",
];

/// Returns the symbol that a text stands for in any case of its letters.
pub(super) fn symbol(text: &str) -> Option<&'static str> {
    SYMBOLS.into_iter().find(|symbol| symbol.eq_ignore_ascii_case(text))
}

/// Gives symbols in the column `element` their usual case; other texts stay as they are.
pub(super) fn normalize_elements(snapshot: &mut Snapshot) {
    for column in snapshot.columns.iter_mut().filter(|column| column.name == "element") {
        let Values::Labels { names, .. } = &mut column.values else { continue };
        for name in names {
            if let Some(symbol) = symbol(name) {
                symbol.clone_into(name);
            }
        }
    }
}

/// Residues of proteins, nucleic acids and water, whose elements have one letter.
const ORGANIC: [&str; 37] = [
    "ALA", "ARG", "ASN", "ASP", "CYS", "GLN", "GLU", "GLY", "HIS", "ILE", "LEU", "LYS", "MET", "PHE", "PRO",
    "SER", "THR", "TRP", "TYR", "VAL", "HSD", "HSE", "HID", "HIE", "HIP", "A", "C", "G", "U", "DA", "DC",
    "DG", "DT", "HOH", "WAT", "SOL", "TIP3",
];

/// Returns the element of an atom from its name in a PDB file, which has four columns: elements of one letter begin in the second.
pub(super) fn element_of_atom(name: &[u8; 4], residue: &str) -> &'static str {
    let letters = name.iter().filter(|byte| byte.is_ascii_alphabetic());
    let letters: String = letters.map(|byte| char::from(*byte)).collect();
    let first = |length: usize| letters.get(..length).and_then(symbol);
    // An ion is a residue of one atom, whose name is that of both: `CA` in the residue `CA` is calcium.
    let is_ion = residue.trim().eq_ignore_ascii_case(&String::from_utf8_lossy(name.trim_ascii()));
    // Names of four characters begin in the first column for lack of space; and some programs begin all names there.
    let is_full = !name[3].is_ascii_whitespace() && b"HCNOSP".contains(&name[0]);
    let may_have_two = name[0].is_ascii_alphabetic() && !is_full && !ORGANIC.contains(&residue.trim());
    let two = if may_have_two || is_ion { first(2) } else { None };
    two.or_else(|| first(1)).unwrap_or("")
}
