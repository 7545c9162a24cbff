#!/usr/bin/env python3
"""Times tracing of scenes that lie in this folder, warm: rayreel in turns with Embree (./embree_speed, from embree_speed.cpp).

Each run renders six equal frames; the first one, which makes room in memory, does not count. Prints medians and shortest times of a
frame in milliseconds, and how many times as fast as Embree rayreel is, by both. Fails where a picture has a PSNR below 39 dB against
Embree's, or where 0.01 % more or fewer rays were traced.

usage: speed.py RUNS THREADS RAYREEL scene ...
needs: numpy
"""
import json, math, os, re, statistics, subprocess, sys
import numpy as np

FRAMES = 6
LEAST_PSNR = 39.0                # dB
MOST_DIFFERENCE = 0.01           # percent
PICTURES = 'speed'


def run(command):
    process = subprocess.run(command, capture_output=True, text=True)
    if process.returncode != 0:
        sys.exit(f'{" ".join(command)} failed:\n{process.stderr[-2000:]}')
    return json.loads(process.stdout)


def of_equal_frames(scene):
    """A copy of a scene with a timeline on which nothing happens."""
    with open(f'{scene}.ron') as text:
        head, rest = text.read().split('Scene(', 1)
    copy = f'{PICTURES}/{scene}.ron'
    with open(copy, 'w') as text:
        text.write(f'{head}Scene(timeline: (fps: 1, duration: {FRAMES}),{rest}')
    return copy


def rayreel(program, copy, threads):
    """Seconds of the warm frames, counts of rays, and the last picture."""
    report = run([program, 'render', copy, '--threads', threads, '--json', '--format', 'ppm', '--out', PICTURES, '--cutoff', '0',
                  '--overwrite'])
    frames = report['frames']
    return [frame['seconds']['trace'] for frame in frames[1:]], frames[-1]['rays'], frames[-1]['file']


def embree(scene, packet, threads):
    picture = f'{PICTURES}/{scene}.embree_{packet}.ppm'
    report = run(['./embree_speed', f'{scene}.nsc', packet, threads, str(FRAMES), picture])
    return report['frames'][1:], report['rays'], picture


def pixels(picture):
    with open(picture, 'rb') as file:
        data = file.read()
    width, height = (int(number) for number in re.match(rb'P6\s(?:#.*\s)*(\d+) (\d+)', data).groups())
    return np.frombuffer(data[-3 * width * height:], np.uint8).astype(float)


def psnr(one, other):
    error = np.mean((pixels(one) - pixels(other)) ** 2)
    return 10 * math.log10(255 ** 2 / error) if error else math.inf


def complaints(scene, own, other):
    """What differs too much from Embree's rays and picture."""
    (_, own_rays, own_picture), (_, rays, picture) = own, other
    found = [f'{scene}: {own_rays[kind]} {kind} rays, Embree {count}' for kind, count in rays.items()
             if abs(own_rays[kind] - count) > MOST_DIFFERENCE / 100 * max(count, 1)]
    likeness = psnr(own_picture, picture)
    return found + ([f'{scene}: PSNR {likeness:.1f} dB'] if likeness < LEAST_PSNR else [])


def main(runs, threads, program, scenes):
    os.makedirs(PICTURES, exist_ok=True)
    wrong = []
    print(f'Milliseconds a frame, median (shortest), {threads} threads\n')
    print('| scene | Embree, single rays | Embree, packets | rayreel | single / rayreel | packets / rayreel |')
    print('|---|---|---|---|---|---|')
    for scene in scenes:
        copy, seconds = of_equal_frames(scene), {'rayreel': [], 1: [], 16: []}
        for _ in range(int(runs)):
            results = {'rayreel': rayreel(program, copy, threads), 1: embree(scene, '1', threads), 16: embree(scene, '16', threads)}
            for name, (frames, _, _) in results.items():
                seconds[name] += frames
        wrong += complaints(scene, results['rayreel'], results[16])
        median = {name: 1000 * statistics.median(frames) for name, frames in seconds.items()}
        least = {name: 1000 * min(frames) for name, frames in seconds.items()}
        times = ' | '.join(f'{median[name]:.1f} ({least[name]:.1f})' for name in (1, 16, 'rayreel'))
        ratios = ' | '.join(f'{median[name] / median["rayreel"]:.2f} ({least[name] / least["rayreel"]:.2f})' for name in (1, 16))
        print(f'| {scene} | {times} | {ratios} |', flush=True)
    sys.exit('\n'.join(wrong) or 0)


if __name__ == '__main__':
    main(*sys.argv[1:4], sys.argv[4:])
