#!/usr/bin/env python3
"""Renders the first frame of a PDB file as balls and sticks with rayreel and Tachyon, compares the pictures, and times both.

Both show the same spheres, the same two cylinders per bond, a directional light with shadows and a sky. rayreel reads the PDB file;
Tachyon gets what this script reads from it: bonds of CONECT records, colours and a quarter of the van der Waals radii of the elements.
There are three pairs of pictures:

- sharp: one sample per pixel, ambient light without occlusion. Pixels differ by more than 2 levels at edges at most (see rods.py).
- occluded: one sample per pixel with 1024 rays to ambient light, which shapes at any distance occlude. The PSNR is at least 40 dB.
- film: 8 samples per pixel with 4 rays each. This is timed, whole processes in turns on two threads, also with ambient light
  that shapes farther than 10 angstroms do not occlude, which Tachyon does not have.

Then it looks at the chirality of the amino acids in rayreel's picture. Atoms are projected by a camera in a right-handed space, and
`rayreel probe` says which atom is seen there. Where the hydrogen at an alpha carbon is in front of it and the carbonyl carbon, the beta
carbon and the nitrogen are seen too, these three follow each other clockwise in L-amino acids, the only ones in proteins (the rule
"CORN"). Fails where they do not.

usage: molecule.py RUNS RAYREEL FILE.pdb      (pictures stay in the folder `molecule`)
needs: tachyon, numpy, pillow

What differs: Tachyon's space is left-handed, so that it gets all z with the other sign. It rounds light down to bytes, gives all pixels the
same directions to ambient light, and draws them evenly where rayreel draws them by their cosine to the normal.
"""
import json, math, os, statistics, subprocess, sys, time
import numpy as np
import rods
from rods import number, numbers

WIDTH, HEIGHT = 1280, 720
EYE, FOV = (0.0, 0.0, 110.0), 30.0               # looks along -z
LIGHT, INTENSITY = (-0.5, -0.8, -0.7), (0.45, 0.45, 0.42)
AMBIENT, K_A, K_D = 0.75, 0.3, 0.7
BOTTOM, TOP = (255, 255, 255), (225, 232, 240)
BOND = 0.15
ELEMENTS = {                                     # van der Waals radius in angstroms, colour
    'H': (1.2, (255, 255, 255)), 'C': (1.77, (144, 144, 144)), 'N': (1.66, (48, 80, 248)), 'O': (1.5, (255, 13, 13)),
    'P': (1.9, (255, 128, 0)), 'S': (1.89, (255, 255, 48)),
}
FOLDER = 'molecule'
EVERYWHERE, NEAR = 1000, 10                      # angstroms up to which shapes occlude ambient light
LEAST_PSNR = 40.0                                # dB
FACING = 0.5                                     # least cosine of the angle from the camera to the hydrogen
THREADS = '2'


class Atom:
    def __init__(self, line):
        self.serial, self.name = int(line[6:11]), line[12:16].strip()
        self.residue, self.residue_name = (line[21], line[22:27]), line[17:20].strip()
        self.place = np.array([float(line[start:start + 8]) for start in (30, 38, 46)])
        self.radius, self.color = ELEMENTS[line[76:78].strip()]
        self.radius *= 0.25


def read(path):
    """The atoms of the first frame, and the pairs of their indices that are bonded."""
    atoms, pairs, frames = [], set(), 0
    with open(path) as lines:
        for line in lines:
            if line.startswith(('ATOM', 'HETATM')) and not frames:
                atoms.append(Atom(line))
            frames += line.startswith('ENDMDL')
            if line.startswith('CONECT'):
                first, *others = [int(line[start:start + 5]) for start in range(6, min(len(line.rstrip()), 31), 5)]
                pairs |= {tuple(sorted((first, other))) for other in others if other != first}
    index = {atom.serial: at for at, atom in enumerate(atoms)}
    bonds = [(index[one], index[other]) for one, other in sorted(pairs)]
    if 2 * len(bonds) < len(atoms):
        sys.exit(f'{path} lists too few bonds')
    return atoms, bonds


def ron(source, samples, rays, distance):
    occlusion = f'    ambient_occlusion: (samples: {rays}, distance: {distance}),\n' if rays else ''
    return (f'Scene(\n    film: (width: {WIDTH}, height: {HEIGHT}, transfer: Classic),\n    sampling: (samples: {samples}),\n'
            f'    space: RightHanded,\n    camera: (position: ({numbers(EYE)}), view: (0, 0, -1), fov: {FOV}),\n'
            f'    ambient: ({numbers([AMBIENT] * 3)}),\n{occlusion}    background: (bottom: ({numbers(BOTTOM)}), top: ({numbers(TOP)})),\n'
            f'    clouds: [(name: "m", source: "{os.path.abspath(source)}", style: BallAndStick, color_by: Element)],\n'
            f'    entities: [(light: Directional(intensity: ({numbers(INTENSITY)}), direction: ({numbers(LIGHT)})))],\n)\n')


def tachyon(atoms, bonds, samples, rays):
    """Its scene. z has the other sign: its camera has up x view on its right."""
    plain = lambda values: numbers(values, ' ')
    mirrored = lambda place: plain((place[0], place[1], -place[2]))
    light = rods.unit(LIGHT)
    pitch = 2 * math.tan(math.radians(FOV / 2)) / HEIGHT
    left, bottom = -(WIDTH + 1) / 2 * pitch, -(HEIGHT + 1) / 2 * pitch
    lines = ['BEGIN_SCENE', f'  RESOLUTION {WIDTH} {HEIGHT}']
    if rays:
        share = number(AMBIENT * K_A / K_D)
        lines += ['SHADER_MODE FULL', f'  AMBIENT_OCCLUSION AMBIENT_COLOR {share} {share} {share} RESCALE_DIRECT 1 SAMPLES {rays}',
                  'END_SHADER_MODE']
    lines += ['CAMERA', f'  ZOOM 1\n  ASPECTRATIO 1\n  ANTIALIASING {samples - 1}\n  RAYDEPTH 1', f'  CENTER {mirrored(EYE)}',
              '  VIEWDIR 0 0 1\n  UPDIR 0 1 0', f'  FRUSTUM {left} {left + WIDTH * pitch} {bottom} {bottom + HEIGHT * pitch}', 'END_CAMERA',
              'BACKGROUND_GRADIENT SKY_SPHERE UPDIR 0 1 0 TOPVAL 1 BOTTOMVAL -1'
              f' TOPCOLOR {plain(rods.linear(TOP))} BOTTOMCOLOR {plain(rods.linear(BOTTOM))}',
              f'DIRECTIONAL_LIGHT DIRECTION {mirrored(light)} COLOR {plain(INTENSITY)}']
    ambient = 0 if rays else AMBIENT * K_A
    colors = sorted({atom.color for atom in atoms})
    lines += [f'TEXDEF t{index} AMBIENT {ambient} DIFFUSE {K_D} SPECULAR 0 OPACITY 1 COLOR {plain(rods.linear(color))} TEXFUNC 0'
              for index, color in enumerate(colors)]
    look = {color: f't{index}' for index, color in enumerate(colors)}
    lines += [f'SPHERE CENTER {mirrored(atom.place)} RAD {number(atom.radius)} {look[atom.color]}' for atom in atoms]
    for one, other in bonds:
        middle = (atoms[one].place + atoms[other].place) / 2
        lines += [f'FCYLINDER BASE {mirrored(atoms[end].place)} APEX {mirrored(middle)} RAD {BOND} {look[atoms[end].color]}'
                  for end in (one, other)]
    return '\n'.join([*lines, 'END_SCENE', ''])


def render_with_rayreel(program, name):
    start = time.perf_counter()
    rods.run([program, 'render', f'{FOLDER}/{name}.ron', '--threads', THREADS, '--format', 'ppm', '--overwrite', '--out', FOLDER,
              '--name', f'{name}.rayreel'])
    return time.perf_counter() - start


def render_with_tachyon(name):
    start = time.perf_counter()
    rods.run(['tachyon', f'{FOLDER}/{name}.dat', '-numthreads', THREADS, '-format', 'PPM', '-o', f'{FOLDER}/{name}.tachyon.ppm'])
    return time.perf_counter() - start


def write(name, text):
    with open(f'{FOLDER}/{name}', 'w') as file:
        file.write(text)


def both(name):
    return [rods.pixels(f'{FOLDER}/{name}.{renderer}.ppm') for renderer in ('rayreel', 'tachyon')]


def compare(program, atoms, bonds, source):
    """A table of how far the pictures agree, and what is wrong."""
    wrong = []
    print('| pictures | samples, rays of each | differing pixels | no edge pixels | largest cluster | PSNR, dB |\n|---|---|---|---|---|---|')
    for name, samples, rays in (('sharp', 1, 0), ('occluded', 1, 1024), ('film', 8, 4)):
        write(f'{name}.ron', ron(source, samples, rays, EVERYWHERE))
        write(f'{name}.dat', tachyon(atoms, bonds, samples, rays))
        render_with_rayreel(program, name)
        render_with_tachyon(name)
        one, other = both(name)
        differ, bad = rods.compare(one, other)
        # Tachyon rounds down: on average, half a level is missing.
        likeness = rods.psnr(one, other + 0.5)
        largest = max(rods.clusters(differ)) if name == 'sharp' else ''
        print(f'| {name} | {samples}, {rays} | {differ.sum()} | {bad.sum()} | {largest} | {likeness:.1f} |', flush=True)
        rods.Image.fromarray(np.clip(128 + 8 * (one - other), 0, 255).astype(np.uint8)).save(f'{FOLDER}/{name}.difference.png')
        if name == 'sharp' and (bad.any() or largest > rods.LARGEST_CLUSTER):
            wrong.append(f'sharp: {bad.sum()} pixels differ that are no edge pixels, {largest} differing pixels touch')
        if name == 'occluded' and likeness < LEAST_PSNR:
            wrong.append(f'occluded: PSNR {likeness:.1f} dB')
    return wrong


def measure(program, source, runs):
    """A table of times, in turns. The scenes of the film are there."""
    write('film_near.ron', ron(source, 8, 4, NEAR))
    taken = {'tachyon': [], 'film': [], 'film_near': []}
    for _ in range(runs):
        taken['tachyon'].append(render_with_tachyon('film'))
        for name in ('film', 'film_near'):
            taken[name].append(render_with_rayreel(program, name))
    median = {name: statistics.median(seconds) for name, seconds in taken.items()}
    print(f'\n| occluded by shapes | Tachyon, s | rayreel, s | Tachyon / rayreel |\n|---|---|---|---|')
    for name, words in (('film', 'at any distance'), ('film_near', f'within {NEAR} angstroms (Tachyon: any)')):
        print(f'| {words} | {median["tachyon"]:.3f} | {median[name]:.3f} | {median["tachyon"] / median[name]:.2f} |')


def column_and_row(place):
    """Where a camera in a right-handed space, with x to the right and y up, sees a point in front of it, along -z."""
    scale = HEIGHT / (2 * math.tan(math.radians(FOV / 2)))
    x, y, z = place - EYE
    return WIDTH / 2 + scale * x / -z - 0.5, HEIGHT / 2 - scale * y / -z - 0.5


def seen_at(program, place):
    """The serial number of the atom that rayreel shows where the camera sees a point."""
    column, row = (round(value) for value in column_and_row(place))
    report = subprocess.run([program, 'probe', f'{FOLDER}/sharp.ron', '--pixel', f'{column},{row}', '--json'], capture_output=True, check=True)
    surface = json.loads(report.stdout)['rays'][0].get('surface') or {}
    return surface.get('entity', {}).get('particle')


def chirality(program, atoms):
    """Counts amino acids whose atoms are seen in rayreel's picture, and those that are L."""
    residues = {}
    for atom in atoms:
        residues.setdefault(atom.residue, {})[atom.name] = atom
    asked, complete, left, in_space = 0, 0, 0, []
    for residue in residues.values():
        if not {'CA', 'HA', 'C', 'CB', 'N'} <= set(residue):
            continue
        center, hydrogen, *three = (residue[name].place for name in ('CA', 'HA', 'C', 'CB', 'N'))
        in_space.append(np.dot(np.cross(three[0] - center, three[1] - center), three[2] - center))
        if rods.unit(hydrogen - center) @ rods.unit(np.array(EYE) - center) < FACING:
            continue
        asked += 1
        front = [residue[name] for name in ('HA', 'C', 'CB', 'N')]
        if not all(seen_at(program, atom.place) == atom.serial for atom in front):
            continue
        complete += 1
        points = np.array([column_and_row(place) for place in three])
        (ax, ay), (bx, by) = points[1] - points[0], points[2] - points[0]
        left += ax * by - ay * bx > 0            # rows go down: clockwise
    print(f'\n{len(in_space)} amino acids, {sum(value > 0 for value in in_space)} of them L by their coordinates;'
          f' of {asked} that face the camera, {complete} are seen, {left} as L-amino acids')
    if not complete or left < complete:
        return [f'only {left} of {complete} amino acids that are seen where a right-handed camera sees them are L']
    return []


def main(runs, program, source):
    os.makedirs(FOLDER, exist_ok=True)
    atoms, bonds = read(source)
    print(f'{len(atoms)} atoms, {len(bonds)} bonds\n')
    wrong = compare(program, atoms, bonds, source)
    measure(program, source, int(runs))
    wrong += chirality(program, atoms)
    sys.exit('\n'.join(wrong) or 0)


if __name__ == '__main__':
    main(*sys.argv[1:])
