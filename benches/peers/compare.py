#!/usr/bin/env python3
"""Renders scenes that lie in this folder with rayreel, POV-Ray and Embree (./embree, from embree.cpp), and prints a table of
how far their pictures agree and one of the rays they traced. Fails where a picture of rayreel's has a PSNR below 39 dB
against another's, or where it traced 0.01 % more or fewer rays of a kind.

usage: compare.py RAYREEL scene ...
needs: numpy, pillow

Where counting rules differ:
- POV-Ray counts mirrored rays at the depth limit too, although it does not trace them. With one level less, those it counts
  are those that it and the others trace with the full depth: they are counted in a second run.
- POV-Ray leaves out mirrored rays of little weight (adc_bailout): turned off, in both runs.
- At the depth limit POV-Ray takes black for what would be mirrored, the others take the background: the pictures differ.
"""
import json, os, re, subprocess, sys
import numpy as np
from PIL import Image

LEAST_PSNR = 39.0                # dB
MOST_DIFFERENCE = 0.01           # percent
KINDS = 'camera', 'shadow', 'reflection'
PICTURES = 'pictures'


def run(command):
    """What a program writes: its standard output, and its standard error."""
    try:
        process = subprocess.run(command, capture_output=True, text=True)
    except FileNotFoundError:
        sys.exit(f'{command[0]} is not installed')
    if process.returncode != 0:
        sys.exit(f'{" ".join(command)} failed:\n{process.stderr[-2000:]}')
    return process.stdout, process.stderr


def rayreel(program, scene):
    """A picture's file and its counts of rays."""
    command = [program, 'render', f'{scene}.ron', '--out', PICTURES, '--json', '--overwrite']
    if '--cutoff' in run([program, 'render', '--help'])[0]:
        command += ['--cutoff', '0']
    frame = json.loads(run(command)[0])['frames'][0]
    return frame['file'], frame['rays']


def embree(scene):
    picture = f'{PICTURES}/{scene}.embree.ppm'
    return picture, json.loads(run(['./embree', f'{scene}.nsc', picture])[0])


def povray(scene):
    picture, depth = f'{PICTURES}/{scene}.povray.png', depth_of(scene)
    report = trace_with_povray(scene, picture, depth)
    rays = {
        'camera': statistic(report, 'Rays') - statistic(report, 'Reflected Rays'),
        'shadow': statistic(report, 'Shadow Ray Tests'),
        'reflection': 0,
    }
    if statistic(report, 'Reflected Rays'):
        fewer = trace_with_povray(scene, f'{PICTURES}/{scene}.fewer_levels.png', depth - 1)
        rays['reflection'] = statistic(fewer, 'Reflected Rays')
    return picture, rays


def trace_with_povray(scene, picture, levels):
    width, height = size_of(scene)
    _, report = run(['povray', f'+I{scene}.pov', f'+O{picture}', '+FN', f'+W{width}', f'+H{height}', '-A', '-D', '-V',
                     'File_Gamma=1.0', 'Dither=off', f'Declare=Levels={levels}', 'Declare=Bailout=0'])
    return report


def statistic(report, name):
    """A line of POV-Ray's statistics; it leaves out what is 0."""
    found = re.search(rf'^{name}:\s+(\d+)', report, re.MULTILINE)
    return int(found[1]) if found else 0


def head_of(scene, word):
    with open(f'{scene}.nsc') as lines:
        return next([int(v) for v in line.split()[1:]] for line in lines if line.startswith(f'{word} '))


def size_of(scene):
    return head_of(scene, 'res')


def depth_of(scene):
    return head_of(scene, 'depth')[0]


def pixels(picture):
    return np.asarray(Image.open(picture).convert('RGB'), float)


def psnr(a, b):
    """Decibels, of bytes, over all channels."""
    error = np.mean((a - b) ** 2)
    return 10 * np.log10(255 ** 2 / error) if error else np.inf


def write_difference(a, b, picture):
    """Eight times the difference, on grey."""
    Image.fromarray(np.clip(128 + 8 * (a - b), 0, 255).astype(np.uint8)).save(picture)


def percent(own, other):
    """How many more rays are our own."""
    return 100 * (own - other) / other if other else 100.0 * (own != 0)


def compare_pictures(scene, pictures):
    """A line of the table, and is it good enough?"""
    own, pov, emb = (pixels(pictures[name]) for name in ('rayreel', 'povray', 'embree'))
    to_povray, to_embree, between = psnr(own, pov), psnr(own, emb), psnr(pov, emb)
    write_difference(own, pov, f'{PICTURES}/{scene}.less_povray.png')
    write_difference(own, emb, f'{PICTURES}/{scene}.less_embree.png')
    good = min(to_povray, to_embree) >= LEAST_PSNR
    return f'| {scene} | {to_povray:.1f} | {to_embree:.1f} | {between:.1f} | {verdict(good)} |', good


def compare_rays(scene, kind, counts):
    """The same, for one kind of ray."""
    own, pov, emb = (counts[name][kind] for name in ('rayreel', 'povray', 'embree'))
    to_povray, to_embree = percent(own, pov), percent(own, emb)
    good = max(abs(to_povray), abs(to_embree)) <= MOST_DIFFERENCE
    return f'| {scene} | {kind} | {own} | {pov} | {to_povray:+.4f} | {emb} | {to_embree:+.4f} | {verdict(good)} |', good


def verdict(good):
    return 'yes' if good else 'NO'


def main(program, scenes):
    os.makedirs(PICTURES, exist_ok=True)
    lines = {'pictures': [], 'rays': []}
    for scene in scenes:
        results = {'rayreel': rayreel(program, scene), 'povray': povray(scene), 'embree': embree(scene)}
        pictures = {name: picture for name, (picture, _) in results.items()}
        counts = {name: rays for name, (_, rays) in results.items()}
        lines['pictures'].append(compare_pictures(scene, pictures))
        lines['rays'] += [compare_rays(scene, kind, counts) for kind in KINDS if any(c[kind] for c in counts.values())]
    print(f'PSNR in dB; at least {LEAST_PSNR:g} is asked of rayreel.\n')
    print('| scene | rayreel, POV-Ray | rayreel, Embree | POV-Ray, Embree | good |\n|---|---|---|---|---|')
    print(*(line for line, _ in lines['pictures']), sep='\n')
    print(f'\nRays; at most {MOST_DIFFERENCE:g} % more or fewer are allowed.\n')
    print('| scene | rays | rayreel | POV-Ray | % | Embree | % | good |\n|---|---|---|---|---|---|---|---|')
    print(*(line for line, _ in lines['rays']), sep='\n')
    sys.exit(not all(good for table in lines.values() for _, good in table))


if __name__ == '__main__':
    main(sys.argv[1], sys.argv[2:])
