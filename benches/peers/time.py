#!/usr/bin/env python3
"""Times renderers on scenes that lie in this folder, in turns, and prints a table of medians.

usage: time.py RUNS RAYREEL scene ...
"""
import json, os, shutil, statistics, subprocess, sys, time


def run(command):
    """Seconds and peak memory in MB of one process."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f'{command} failed')
    return time.perf_counter() - start, usage.ru_maxrss / 1024, output


def main(runs, rayreel, scenes):
    commands = {
        'rayreel': lambda s: [rayreel, 'render', f'{s}.ron', '--out', 'out', '--threads', '2', '--json', '--overwrite'],
        'tachyon': lambda s: ['tachyon', f'{s}.dat', '-numthreads', '2', '-format', 'PPM', '-o', 'tachyon.ppm'],
        'povray': lambda s: ['povray', f'{s}.pov', '+W1280', '+H720', '+WT2', '-D', '+Opovray.png'],
    }
    commands = {name: command for name, command in commands.items() if name == 'rayreel' or shutil.which(name)}
    print('| scene | renderer | seconds | MB | rayreel by phase |')
    print('|---|---|---|---|---|')
    for scene in scenes:
        seconds, memory, phases = {n: [] for n in commands}, {}, []
        for _ in range(int(runs)):
            for name, command in commands.items():
                wall, peak, output = run(command(scene))
                seconds[name].append(wall)
                memory[name] = peak
                if name == 'rayreel':
                    report = json.loads(output)
                    frame = report['frames'][0]
                    phases.append({'load': report['load_seconds'], **frame['seconds']})
        for name in commands:
            detail = ''
            if name == 'rayreel':
                detail = ', '.join(f'{k} {statistics.median(p[k] for p in phases):.3f}' for k in phases[0])
            print(f'| {scene} | {name} | {statistics.median(seconds[name]):.3f} | {memory[name]:.0f} | {detail} |', flush=True)


if __name__ == '__main__':
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
