#!/usr/bin/env python3
"""Renders scenes of cylinders and capsules with rayreel, POV-Ray and Tachyon, and prints a table of the pixels that differ.

A scene has turned, thick and thin rods, rods along the rays of the camera and nearly so, rods that stand on a floor, end in a wall or
end flush with spheres, spheres, two planes and a point light with shadows; no highlights, one sample per pixel. A quarter of the rods are
written with a height, a rotation and a scale, the others with their ends. The turned rods are other ones in each scene.

Two pixels differ if a channel differs by more than 2 levels. A pixel that differs is an edge pixel if each channel lies within 2 levels of
the range of the 3x3 pixels around it in the other picture: both show the same shapes, and the border between two of them lies a pixel
farther. Fails where a pixel that differs is none, or where more than three of them touch.

usage: rods.py SCENES RAYREEL      (pictures and differences stay in the folder `rods`)
needs: povray, tachyon, numpy, pillow

What differs: Tachyon rounds light down to bytes, the others to the nearest. Its pixels lie half a pixel to the right and up, which the
bounds of its camera take back. Its cylinders are open, and get rings of inner radius 0 as ends. It reads single precision: all numbers of
the scene are rounded to it. POV-Ray's cylinders have ends, and its capsules are open cylinders with a sphere at each end.
"""
import math, os, subprocess, sys
import numpy as np
from PIL import Image

WIDTH, HEIGHT, PITCH = 1280, 720, 1 / 1024       # pixels, and their distance on a screen at distance 1
EYE, VIEW = np.array((0.0, 3.0, -9.0)), np.array((0.0, -2.0, 9.0))
LIGHT, SHARE = (-5.0, 8.0, -6.0), 0.8125
AMBIENT, DIFFUSE = 0.15625, 0.75
BACKGROUND = (60, 90, 150)
PALETTE = [(230, 77, 64), (77, 204, 89), (77, 115, 242), (242, 217, 77), (204, 102, 204), (77, 204, 204), (242, 153, 64),
           (191, 184, 168), (170, 175, 190)]
FLOOR, WALL, WALL_AT = 7, 8, 6.0
FOLDER = 'rods'
LEVELS = 2
LARGEST_CLUSTER = 3


def single(values):
    """Numbers that single precision holds."""
    return np.asarray(values, np.float32).astype(float)


def unit(vector):
    return np.asarray(vector, float) / np.linalg.norm(vector)


class Rods:
    def __init__(self, seed):
        self.rods = []                            # (is a capsule, from, to, radius, material, (fields of the shape, of the entity))
        self.spheres = []                         # (centre, radius, material)
        self.random = np.random.default_rng(seed)

    def add(self, start, end, radius, capsule=None):
        start, end, radius = single(start), single(end), float(single(radius))
        capsule = len(self.rods) % 2 == 1 if capsule is None else capsule
        written = f'radius: {number(radius)}, from: ({numbers(start)}), to: ({numbers(end)})'
        self.rods.append((capsule, start, end, radius, len(self.rods) % 7, (written, '')))

    def add_turned(self, center, angles, length, radius, scale):
        """A rod that is turned about x, then y, and scaled."""
        center, angles = single(center), np.round(angles)
        x, y = np.radians(angles)
        axis = np.array((math.sin(x) * math.sin(y), math.cos(x), math.sin(x) * math.cos(y)))
        half = axis * length / 2
        written = f'radius: {number(radius / scale)}, height: {number(length / scale)}'
        turn = f', rotation: Euler({numbers(angles)}, 0), scale: {number(scale)}'
        transform = f', transform: (translation: ({numbers(center)}){turn})'
        self.rods.append((len(self.rods) % 2 == 1, center - half, center + half, radius, len(self.rods) % 7, (written, transform)))

    def ball(self, center, radius):
        self.spheres.append((single(center), float(single(radius)), len(self.spheres) * 3 % 7))


def scene(seed):
    made = Rods(seed)
    uniform = made.random.uniform
    for index in range(24):                       # turned, thick and thin
        center = (uniform(-4, 4), uniform(1.2, 3.4), uniform(-1, 4.5))
        length, radius = uniform(0.4, 1.8), math.exp(uniform(math.log(0.015), math.log(0.3)))
        if index % 3 < 2:
            made.add_turned(center, uniform(-180, 180, 2), length, radius, (0.5, 1.0, 2.0)[index % 9 // 3])
        else:
            way = unit(made.random.normal(size=3)) * length / 2
            made.add(center - way, center + way, radius)
    for index in range(6):                        # about a pixel wide, across the picture
        made.add((-4.5, 0.4 + 0.5 * index, 1 + 0.6 * index), (4.5, 3.6 - 0.6 * index, 2.5), (0.004, 0.0055, 0.008)[index % 3])
    for index in range(12):                       # along the rays of the camera, the last six nearly so
        ray = unit((index % 6 * 0.17 - 0.43, (-0.12, 0.02)[index // 6] - 0.03 * (index % 3), 1))
        off = np.array((0.01, 0.014, 0)) * (index // 6) * (-1) ** index
        made.add(EYE + ray * 6, EYE + ray * 8.5 + off * 2.5, 0.06 + 0.03 * (index % 4))
    for index in range(8):                        # on the floor: standing and half sunk
        place = np.array((index * 0.95 - 3.3, 0, -2.2 + 0.3 * (index % 3)))
        made.add(place, place + (0.1 * (index % 3 - 1) * (index % 2), 0.35 + 0.1 * (index % 4), 0), 0.08 + 0.03 * (index % 3))
    for index in range(4):                        # lying
        radius = 0.06 + 0.04 * index
        start = np.array((index * 1.7 - 3.0, radius, -3.2))
        made.add(start, start + (0.9, 0, 0.5 - 0.4 * index), radius)
    for index in range(4):                        # in the wall
        place = np.array((index * 1.9 - 2.8, 1.6 + 0.5 * (index % 2), WALL_AT))
        made.add(place, place - (0.4 * (index % 3 - 1), 0.2, 1.2), 0.15 + 0.05 * index)
    for index in range(6):                        # flush with spheres: as wide as both, in them, and touching one
        start, end = np.array((index * 1.3 - 3.6, 0.9, -1.4)), np.array((index * 1.3 - 3.2, 1.3, -0.9))
        radius = 0.12
        made.add(start, end, radius, capsule=False)
        if index % 3 < 2:
            made.ball(start, radius * (1, 1.75)[index % 3])
            made.ball(end, radius * (1, 1.75)[index % 3])
        else:
            made.ball(end + unit(end - start) * 0.25, 0.25)
    for index in range(6):
        made.ball((index * 1.5 - 3.7, 0.35, 2.6), 0.35)
    return made


def number(value):
    return f'{value:.17g}'


def numbers(values, separator=', '):
    return separator.join(number(value) for value in values)


def linear(color):
    return [channel / 255 for channel in color]


def ron(made):
    lines = [f'Scene(\n    film: (width: {WIDTH}, height: {HEIGHT}, transfer: Classic),\n    quality: (depth: 1),',
             f'    camera: (position: ({numbers(EYE)}), view: ({numbers(VIEW)}),'
             f' screen: (distance: 1, width: {number((WIDTH - 1) * PITCH)}, height: {number((HEIGHT - 1) * PITCH)})),',
             f'    ambient: (1, 1, 1),\n    background: ({numbers(BACKGROUND)}),\n    materials: {{']
    lines += [f'        "m{index}": (k_a: {AMBIENT}, k_d: {DIFFUSE}, color: ({numbers(color)})),' for index, color in enumerate(PALETTE)]
    lines += ['    },\n    entities: [', f'        (shape: Plane(normal: (0, 1, 0)), material: "m{FLOOR}"),',
              f'        (shape: Plane(normal: (0, 0, -1)), material: "m{WALL}", transform: (translation: (0, 0, {number(WALL_AT)}))),',
              f'        (light: Point(intensity: ({numbers([SHARE] * 3)})), transform: (translation: ({numbers(LIGHT)}))),']
    for capsule, _, _, _, material, (written, transform) in made.rods:
        lines.append(f'        (shape: {"Capsule" if capsule else "Cylinder"}({written}), material: "m{material}"{transform}),')
    for center, radius, material in made.spheres:
        lines.append(f'        (shape: Sphere(radius: {number(radius)}), material: "m{material}",'
                     f' transform: (translation: ({numbers(center)}))),')
    return '\n'.join([*lines, '    ],\n)\n'])


def axes():
    """The camera's view, right and up, of unit length."""
    view = unit(VIEW)
    right = unit(np.cross((0, 1, 0), view))
    return view, right, np.cross(view, right)


def povray(made):
    vector = lambda values: f'<{numbers(values)}>'
    view, right, up = axes()
    lines = ['#version 3.7;', 'global_settings { assumed_gamma 1.0 ambient_light rgb 1 max_trace_level 1 }',
             f'background {{ rgb {vector(linear(BACKGROUND))} }}',
             f'camera {{ location {vector(EYE)} direction {vector(view)} right {vector(right * WIDTH * PITCH)} up {vector(up * HEIGHT * PITCH)} }}',
             f'light_source {{ {vector(LIGHT)} rgb {SHARE} }}']
    lines += [f'#declare M{index} = texture {{ pigment {{ rgb {vector(linear(color))} }} finish {{ ambient {AMBIENT} diffuse {DIFFUSE} }} }}'
              for index, color in enumerate(PALETTE)]
    lines += [f'plane {{ y, 0 texture {{ M{FLOOR} }} }}', f'plane {{ -z, {-WALL_AT} texture {{ M{WALL} }} }}']
    for capsule, start, end, radius, material, _ in made.rods:
        a, b, r = vector(start), vector(end), number(radius)
        if capsule:
            lines.append(f'union {{ cylinder {{ {a}, {b}, {r} open }} sphere {{ {a}, {r} }} sphere {{ {b}, {r} }} texture {{ M{material} }} }}')
        else:
            lines.append(f'cylinder {{ {a}, {b}, {r} texture {{ M{material} }} }}')
    lines += [f'sphere {{ {vector(center)}, {number(radius)} texture {{ M{material} }} }}' for center, radius, material in made.spheres]
    return '\n'.join(lines) + '\n'


def tachyon(made):
    plain = lambda values: numbers(values, ' ')
    # Pixels are 1 to WIDTH, and 1 to HEIGHT from below, times their distance from the left and the lower border.
    left, bottom = -WIDTH / 2 * PITCH - PITCH / 2, -HEIGHT / 2 * PITCH - PITCH / 2
    lines = ['BEGIN_SCENE', f'  RESOLUTION {WIDTH} {HEIGHT}', 'CAMERA', f'  ZOOM 1\n  ASPECTRATIO 1\n  ANTIALIASING 0\n  RAYDEPTH 1',
             f'  CENTER {plain(EYE)}', f'  VIEWDIR {plain(VIEW)}', '  UPDIR 0 1 0',
             f'  FRUSTUM {left} {left + WIDTH * PITCH} {bottom} {bottom + HEIGHT * PITCH}', 'END_CAMERA',
             f'BACKGROUND {plain(linear(BACKGROUND))}', f'LIGHT CENTER {plain(LIGHT)} RAD 0.002 COLOR {plain([SHARE] * 3)}']
    lines += [f'TEXDEF t{index} AMBIENT {AMBIENT} DIFFUSE {DIFFUSE} SPECULAR 0 OPACITY 1 COLOR {plain(linear(color))} TEXFUNC 0'
              for index, color in enumerate(PALETTE)]
    lines += [f'PLANE CENTER 0 0 0 NORMAL 0 1 0 t{FLOOR}', f'PLANE CENTER 0 0 {number(WALL_AT)} NORMAL 0 0 -1 t{WALL}']
    for capsule, start, end, radius, material, _ in made.rods:
        lines.append(f'FCYLINDER BASE {plain(start)} APEX {plain(end)} RAD {number(radius)} t{material}')
        for at in start, end:
            if capsule:
                lines.append(f'SPHERE CENTER {plain(at)} RAD {number(radius)} t{material}')
            else:
                lines.append(f'RING CENTER {plain(at)} NORMAL {plain(unit(end - start))} INNER 0 OUTER {number(radius)} t{material}')
    lines += [f'SPHERE CENTER {plain(center)} RAD {number(radius)} t{material}' for center, radius, material in made.spheres]
    return '\n'.join([*lines, 'END_SCENE', ''])


def run(command):
    process = subprocess.run(command, capture_output=True, text=True)
    if process.returncode != 0:
        sys.exit(f'{" ".join(command)} failed:\n{process.stderr[-2000:]}')


def render(program, made, name):
    """The picture of each renderer."""
    at = f'{FOLDER}/{name}'
    for ending, text in (('ron', ron(made)), ('pov', povray(made)), ('dat', tachyon(made))):
        with open(f'{at}.{ending}', 'w') as file:
            file.write(text)
    run([program, 'render', f'{at}.ron', '--threads', '1', '--cutoff', '0', '--overwrite', '--out', FOLDER, '--name', f'{name}.rayreel'])
    run(['povray', f'+I{at}.pov', f'+O{at}.povray.png', '+FN', f'+W{WIDTH}', f'+H{HEIGHT}', '-A', '-D', '+WT1', 'File_Gamma=1.0',
         'Dither=off'])
    run(['tachyon', f'{at}.dat', '-numthreads', '1', '-format', 'PPM', '-o', f'{at}.tachyon.ppm'])
    return {other: pixels(f'{at}.{other}.{"ppm" if other == "tachyon" else "png"}') for other in ('rayreel', 'povray', 'tachyon')}


def pixels(picture):
    return np.asarray(Image.open(picture).convert('RGB'), int)


def around(picture, extreme):
    """The least or the greatest of 3x3 pixels, by channel."""
    rows, columns = picture.shape[:2]
    padded = np.pad(picture, ((1, 1), (1, 1), (0, 0)), mode='edge')
    return extreme.reduce([padded[y:y + rows, x:x + columns] for y in range(3) for x in range(3)])


def clusters(marked):
    """The sizes of groups of marked pixels that touch, also at corners."""
    left, sizes = set(zip(*np.nonzero(marked))), []
    while left:
        group, size = [left.pop()], 0
        while group:
            y, x = group.pop()
            size += 1
            near = {(y + j, x + i) for j in (-1, 0, 1) for i in (-1, 0, 1)} & left
            left -= near
            group += near
        sizes.append(size)
    return sizes or [0]


def compare(one, other):
    """The pixels that differ, and those of them that are no edge pixels."""
    differ = (abs(one - other) > LEVELS).any(axis=2)
    in_range = (one >= around(other, np.minimum) - LEVELS) & (one <= around(other, np.maximum) + LEVELS)
    return differ, differ & ~in_range.all(axis=2)


def at_edges(picture):
    """The number of pixels of which a channel differs by more than 8 levels within the 3x3 pixels around."""
    return (around(picture, np.maximum) - around(picture, np.minimum) > 8).any(axis=2).sum()


def psnr(one, other):
    error = np.mean((one - other) ** 2.0)
    return 10 * math.log10(255 ** 2 / error) if error else math.inf


def main(count, program):
    os.makedirs(FOLDER, exist_ok=True)
    pairs = ('rayreel', 'povray'), ('rayreel', 'tachyon'), ('povray', 'tachyon')
    found = {pair: [] for pair in pairs}
    total, edges = 0, 0
    for seed in range(int(count)):
        made = scene(seed)
        pictures = render(program, made, f'rods_{seed}')
        total, edges = total + WIDTH * HEIGHT, edges + at_edges(pictures['rayreel'])
        for one, other in pairs:
            differ, bad = compare(pictures[one], pictures[other])
            difference = pictures[one] - pictures[other]
            elsewhere = abs(difference)[~differ].max()
            found[one, other].append((differ.sum(), bad.sum(), max(clusters(differ)), elsewhere, psnr(pictures[one], pictures[other])))
            Image.fromarray(np.clip(128 + 8 * difference, 0, 255).astype(np.uint8)).save(f'{FOLDER}/rods_{seed}.{one}_less_{other}.png')
    capsules = sum(rod[0] for rod in made.rods)
    print(f'Each of {count} scenes: {len(made.rods) - capsules} cylinders, {capsules} capsules, {len(made.spheres)} spheres, 2 planes.'
          f' {total} pixels in all, {edges} of them at edges.\n')
    print('| pictures | differing pixels | no edge pixels | largest cluster | greatest difference elsewhere | least PSNR, dB |')
    print('|---|---|---|---|---|---|')
    wrong = []
    for pair, rows in found.items():
        differ, bad, largest, elsewhere, likeness = zip(*rows)
        print(f'| {", ".join(pair)} | {sum(differ)} | {sum(bad)} | {max(largest)} | {max(elsewhere)} | {min(likeness):.1f} |')
        if 'rayreel' in pair and (sum(bad) or max(largest) > LARGEST_CLUSTER):
            wrong.append(f'{", ".join(pair)}: {sum(bad)} pixels differ that are no edge pixels, {max(largest)} differing pixels touch')
    sys.exit('\n'.join(wrong) or 0)


if __name__ == '__main__':
    main(*sys.argv[1:])
