#!/usr/bin/env python3
"""Times whole processes on a scene for each effect: rayreel in turns with POV-Ray and, where it has the effect, Tachyon.

Each scene is written in every renderer's format from one description: balls and boxes on a floor, and what the effect takes.
Prints medians of the seconds, how many times as fast rayreel is, and how alike the pictures are. Fails where POV-Ray's picture has a
smaller PSNR than is said for the effect: where samples are drawn, pictures differ by their noise.

usage: effects.py RUNS RAYREEL [scene ...]
needs: povray, tachyon, numpy

What differs: POV-Ray's lens spreads its rays over a square. Its antialiasing takes nine samples wherever a pixel differs from its
neighbours at all. Tachyon does not bend light, nor do the clear balls that it is given.
"""
import math, os, shutil, statistics, subprocess, sys, time
import numpy as np

WIDTH, HEIGHT = 1280, 720
FOLDER = 'effects'
PALETTE = [(230, 77, 64), (77, 204, 89), (77, 115, 242), (242, 217, 77), (204, 102, 204), (77, 204, 204), (242, 153, 64)]
FLOOR = (191, 184, 168)
EYE, TARGET, FOV = (0.0, 3.0, -9.0), (0.0, 0.6, 0.0), 40.0


class Scene:
    """What all scenes have, and what an effect changes."""

    def __init__(self, least_psnr):
        self.least_psnr = least_psnr
        self.balls, self.boxes = objects()       # (x, y, z, radius, material), (x, y, z, half, material)
        self.lights = [('point', (-6, 8, -7), 0.7), ('point', (7, 6, -5), 0.5)]
        self.shiny = None                        # (k_s, shininess)
        self.glass = {}                          # by material: (ior, Fresnel)
        self.samples, self.lens, self.fog, self.checkered = 1, None, None, False
        self.tachyon = False


def objects():
    """Seven by five of them, by turns, in rows that recede."""
    numbers = np.random.default_rng(3)
    balls, boxes = [], []
    for index in range(35):
        x, z = index % 7 * 1.15 - 3.45 + numbers.uniform(-0.15, 0.15), index // 7 * 1.6 - 3 + numbers.uniform(-0.2, 0.2)
        size = numbers.uniform(0.3, 0.48)
        if index % 3 == 2:
            boxes.append((x, size, z, size, index % 7))
        else:
            balls.append((x, size, z, size, index % 7))
    return balls, boxes


def glass():
    """Balls of glass, with a bubble or a marble in each."""
    scene = Scene(40.0)
    scene.glass = {7: (1.5, True), 8: (1.0, False)}
    balls = []
    for index, (x, y, z, radius, material) in enumerate(scene.balls):
        balls.append((x, y, z, radius, 7))
        balls.append((x, y, z, radius * 0.5, 8 if index % 2 else material))
    scene.balls = balls
    return scene


def area_light():
    scene = Scene(44.0)
    scene.lights = [('area', (-4, 7, -4), 1.0)]
    return scene


def lens():
    scene = Scene(34.0)
    scene.samples, scene.lens = 64, (0.25, 9.0)
    return scene


def antialiasing():
    scene = Scene(46.0)
    scene.samples = 9
    return scene


def spots():
    scene = Scene(60.0)
    scene.lights = [('spot', (x, 6, z), 0.8) for x, z in ((-5, -5), (5, -5), (-4, 3), (4, 3))]
    scene.shiny = (0.6, 60.0)
    scene.tachyon = True
    return scene


def fog_and_checkers():
    scene = Scene(60.0)
    scene.fog, scene.checkered = ((180, 190, 205), 0.08), True
    return scene


def clear_balls():
    """Balls that light goes straight through."""
    scene = Scene(44.0)
    scene.glass = {material: (1.0, False) for material in range(7)}
    scene.boxes, scene.tachyon = [], True
    return scene


SCENES = {
    'glass': glass, 'area_light': area_light, 'lens': lens, 'antialiasing': antialiasing, 'spots': spots,
    'fog_and_checkers': fog_and_checkers, 'clear_balls': clear_balls,
}


def numbers(values):
    return ', '.join(f'{value:.9g}' for value in values)


def unit(values):
    length = math.sqrt(sum(value * value for value in values))
    return [value / length for value in values]


def linear(color):
    return [channel / 255 for channel in color]


def half_height():
    return math.tan(math.radians(FOV / 2))


def ron(scene):
    shiny = f', specular: (k_s: {scene.shiny[0]}, shininess: {scene.shiny[1]})' if scene.shiny else ''

    def material(index, color):
        if index not in scene.glass:
            return f'(k_a: 0.15, k_d: 0.75, color: ({numbers(color)}){shiny})'
        ior, fresnel = scene.glass[index]
        own = 'k_a: 0' if fresnel or index == 8 else f'k_a: 0.075, k_d: 0.375, color: ({numbers(color)})'
        share = 1.0 if fresnel or index == 8 else 0.5
        return f'({own}, refractive: (k_t: {share}, ior: {ior}, fresnel: {str(fresnel).lower()}))'

    colors = [*PALETTE, (255, 255, 255), (255, 255, 255)]
    lines = [f'        "m{index}": {material(index, color)},' for index, color in enumerate(colors)]
    squares = ', pattern: Checker(color: (60, 60, 70), size: 1)' if scene.checkered else ''
    lines.append(f'        "floor": (k_a: 0.15, k_d: 0.75, color: ({numbers(FLOOR)}){squares}{shiny}),')
    entities = ['        (shape: Plane(normal: (0, 1, 0)), material: "floor"),']
    for x, y, z, radius, index in scene.balls:
        entities.append(f'        (shape: Sphere(radius: {radius:.9g}), material: "m{index}",'
                        f' transform: (translation: ({numbers((x, y, z))}))),')
    for x, y, z, half, index in scene.boxes:
        size = numbers([2 * half] * 3)
        entities.append(f'        (shape: Box(size: ({size})), material: "m{index}", transform: (translation: ({numbers((x, y, z))}))),')
    for kind, place, share in scene.lights:
        intensity = f'intensity: ({numbers([share] * 3)})'
        if kind == 'area':
            light, turn = f'Area(shape: Rectangle(width: 2, height: 2), {intensity}, samples: 64)', ', rotation: Euler(90, 0, 0)'
        elif kind == 'spot':
            light, turn = f'Spot({intensity}, angle: 64, softness: 0.375)', f', rotation: {turn_to(place)}'
        else:
            light, turn = f'Point({intensity})', ''
        entities.append(f'        (light: {light}, transform: (translation: ({numbers(place)}){turn})),')
    lens = f', lens: (aperture: {scene.lens[0]}, focus: {scene.lens[1]})' if scene.lens else ''
    fog = f'    fog: (color: ({numbers(scene.fog[0])}), density: {scene.fog[1]}),\n' if scene.fog else ''
    sampling = f'    sampling: (samples: {scene.samples}),\n' if scene.samples > 1 else ''
    return (f'Scene(\n    film: (width: {WIDTH}, height: {HEIGHT}, transfer: Classic),\n    quality: (depth: 8),\n{sampling}'
            f'    camera: (position: ({numbers(EYE)}), target: ({numbers(TARGET)}), fov: {FOV}{lens}),\n'
            f'    ambient: (1, 1, 1),\n    background: (60, 90, 150),\n{fog}    materials: {{\n' + '\n'.join(lines)
            + '\n    },\n    entities: [\n' + '\n'.join(entities) + '\n    ],\n)\n')


def turn_to(place):
    """The rotation that takes +z to where a spot light shines: down, a little towards the middle."""
    x, y, z = unit([-value for value in place])
    return f'Euler({math.degrees(math.asin(-y)):.9g}, {math.degrees(math.atan2(x, z)):.9g}, 0)'


def povray(scene):
    vector = lambda values: f'<{numbers(values)}>'
    highlights = f' specular {scene.shiny[0]} roughness {1 / scene.shiny[1]:.9g}' if scene.shiny else ' specular 0'

    def texture(index, color):
        if index not in scene.glass:
            return f'texture {{ pigment {{ rgb {vector(linear(color))} }} finish {{ ambient 0.15 diffuse 0.75{highlights} }} }}'
        ior, fresnel = scene.glass[index]
        if fresnel or index == 8:
            mirror = ' reflection { 0, 1 fresnel on } conserve_energy' if fresnel else ''
            finish = f'finish {{ ambient 0 diffuse 0{mirror} }}'
            return f'texture {{ pigment {{ rgbt <1, 1, 1, 1> }} {finish} }} interior {{ ior {ior} }}'
        return (f'texture {{ pigment {{ rgbt {vector([*linear(color), 0.5])} }} finish {{ ambient 0.15 diffuse 0.75 }} }}'
                f' interior {{ ior {ior} }}')

    colors = [*PALETTE, (255, 255, 255), (255, 255, 255)]
    lines = ['#version 3.7;', 'global_settings { assumed_gamma 1.0 ambient_light rgb 1 max_trace_level 8 }',
             f'background {{ rgb {vector(linear((60, 90, 150)))} }}']
    view = unit([to - at for to, at in zip(TARGET, EYE)])
    blur = ''
    if scene.lens:
        focus = [at + scene.lens[1] * along for at, along in zip(EYE, view)]
        blur = f' aperture {scene.lens[0]} focal_point {vector(focus)} blur_samples 64 variance 0'
    lines.append(f'camera {{ location {vector(EYE)} up y right x*{WIDTH / HEIGHT:.9g}'
                 f' angle {math.degrees(2 * math.atan(half_height() * WIDTH / HEIGHT)):.9g} look_at {vector(TARGET)}{blur} }}')
    for kind, place, share in scene.lights:
        more = {'point': '', 'area': ' area_light x*2, z*2, 8, 8 jitter area_illumination on',
                'spot': ' spotlight radius 20 falloff 32 tightness 0 point_at <0, 0, 0>'}[kind]
        lines.append(f'light_source {{ {vector(place)} rgb {share}{more} }}')
    if scene.fog:
        lines.append(f'fog {{ fog_type 1 distance {1 / scene.fog[1]:.9g} color rgb {vector(linear(scene.fog[0]))} }}')
    floor = (f'checker rgb {vector(linear(FLOOR))} rgb {vector(linear((60, 60, 70)))}' if scene.checkered
             else f'rgb {vector(linear(FLOOR))}')
    lines.append(f'plane {{ y, 0 texture {{ pigment {{ {floor} }} finish {{ ambient 0.15 diffuse 0.75{highlights} }} }} }}')
    for x, y, z, radius, index in scene.balls:
        lines.append(f'sphere {{ {vector((x, y, z))}, {radius:.9g} {texture(index, colors[index])} }}')
    for x, y, z, half, index in scene.boxes:
        low, high = (x - half, y - half, z - half), (x + half, y + half, z + half)
        lines.append(f'box {{ {vector(low)}, {vector(high)} {texture(index, colors[index])} }}')
    return '\n'.join(lines) + '\n'


def tachyon(scene):
    plain = lambda values: ' '.join(f'{value:.9g}' for value in values)
    view = unit([to - at for to, at in zip(TARGET, EYE)])
    lines = ['BEGIN_SCENE', f'  RESOLUTION {WIDTH} {HEIGHT}', 'CAMERA', f'  ZOOM {1 / (2 * half_height()):.9g}',
             '  ASPECTRATIO 1.0', '  ANTIALIASING 0', '  RAYDEPTH 8', f'  CENTER {plain(EYE)}', f'  VIEWDIR {plain(view)}',
             '  UPDIR 0 1 0', 'END_CAMERA', f'BACKGROUND {plain(linear((60, 90, 150)))}']
    for kind, place, share in scene.lights:
        color = plain([share] * 3)
        if kind == 'spot':
            down = plain(unit([-value for value in place]))
            lines.append(f'SPOTLIGHT CENTER {plain(place)} RAD 0.002 DIRECTION {down} FALLOFF_START 20 FALLOFF_END 32 COLOR {color}')
        else:
            lines.append(f'LIGHT CENTER {plain(place)} RAD 0.002 COLOR {color}')
    phong = f' PHONG PLASTIC {scene.shiny[0]} PHONG_SIZE {scene.shiny[1]}' if scene.shiny else ''
    for index, color in enumerate([*PALETTE, FLOOR]):
        opacity = 0.5 if index in scene.glass else 1
        lines.append(f'TEXDEF t{index} AMBIENT 0.15 DIFFUSE 0.75 SPECULAR 0 OPACITY {opacity}{phong}'
                     f' COLOR {plain(linear(color))} TEXFUNC 0')
    lines.append('PLANE CENTER 0 0 0 NORMAL 0 1 0 t7')
    lines += [f'SPHERE CENTER {plain((x, y, z))} RAD {radius:.9g} t{index}' for x, y, z, radius, index in scene.balls]
    for x, y, z, half, index in scene.boxes:
        lines.append(f'BOX MIN {plain((x - half, y - half, z - half))} MAX {plain((x + half, y + half, z + half))} t{index}')
    return '\n'.join([*lines, 'END_SCENE', ''])


def commands(program, name, scene):
    """By renderer: how its picture is made, and where that is."""
    at = f'{FOLDER}/{name}'
    found = {'rayreel': ([program, 'render', f'{at}.ron', '--threads', '2', '--format', 'ppm', '--out', f'{at}.rayreel', '--overwrite'],
                         f'{at}.rayreel/{name}.0000.ppm')}
    smooth = ['+AM1', '+A0.0', '+R3', '-J'] if scene.samples == 9 else ['-A']
    found['povray'] = (['povray', f'+I{at}.pov', f'+O{at}.povray.ppm', '+FP', f'+W{WIDTH}', f'+H{HEIGHT}', '+WT2', '-D',
                        'File_Gamma=1.0', *smooth], f'{at}.povray.ppm')
    if scene.tachyon:
        found['tachyon'] = (['tachyon', f'{at}.dat', '-numthreads', '2', '-trans_max_surfaces', '16', '-format', 'PPM',
                             '-o', f'{at}.tachyon.ppm'], f'{at}.tachyon.ppm')
    return found


def seconds(command):
    start = time.perf_counter()
    process = subprocess.run(command, capture_output=True, text=True)
    if process.returncode != 0:
        sys.exit(f'{" ".join(command)} failed:\n{process.stderr[-2000:]}')
    return time.perf_counter() - start


def pixels(picture):
    with open(picture, 'rb') as file:
        data = file.read()
    return np.frombuffer(data[-3 * WIDTH * HEIGHT:], np.uint8).astype(float)


def psnr(one, other):
    error = np.mean((pixels(one) - pixels(other)) ** 2)
    return 10 * math.log10(255 ** 2 / error) if error else math.inf


def main(runs, program, names):
    os.makedirs(FOLDER, exist_ok=True)
    missing = [name for name in ('povray', 'tachyon') if not shutil.which(name)]
    if missing:
        sys.exit(f'not installed: {", ".join(missing)}')
    wrong = []
    print('| scene | POV-Ray, s | Tachyon, s | rayreel, s | POV-Ray / rayreel | Tachyon / rayreel | PSNR with POV-Ray, dB |')
    print('|---|---|---|---|---|---|---|')
    for name in names or SCENES:
        scene = SCENES[name]()
        for ending, text in (('ron', ron(scene)), ('pov', povray(scene)), ('dat', tachyon(scene))):
            with open(f'{FOLDER}/{name}.{ending}', 'w') as file:
                file.write(text)
        renderers = commands(program, name, scene)
        taken = {renderer: [] for renderer in renderers}
        for _ in range(int(runs)):
            for renderer, (command, _) in renderers.items():
                taken[renderer].append(seconds(command))
        median = {renderer: statistics.median(times) for renderer, times in taken.items()}
        likeness = psnr(renderers['rayreel'][1], renderers['povray'][1])
        if likeness < scene.least_psnr:
            wrong.append(f'{name}: PSNR {likeness:.1f} dB')
        cells = [f'{median[renderer]:.3f}' if renderer in median else '' for renderer in ('povray', 'tachyon', 'rayreel')]
        cells += [f'{median[renderer] / median["rayreel"]:.1f}' if renderer in median else '' for renderer in ('povray', 'tachyon')]
        print(f'| {name} | {" | ".join(cells)} | {likeness:.1f} |', flush=True)
    sys.exit('\n'.join(wrong) or 0)


if __name__ == '__main__':
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
