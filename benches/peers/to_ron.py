#!/usr/bin/env python3
"""A neutral scene (.nsc, from generate.py) as a rayreel scene, with every shape written out.

usage: to_ron.py IN.nsc OUT.ron

Space there is z-up with right = up x view, which is rayreel's own rule, so that coordinates stay as they are. The peers
put pixel centres half a pitch inside the screen's edge; rayreel puts the outermost ones on it: width and height take the
factor (n-1)/n.
"""
import sys


def numbers(values):
    return '(' + ', '.join(values) + ')'


def main(source, target):
    materials, lights, shapes = [], [], []
    for line in open(source):
        kind, *v = line.split()
        if kind == 'res': width, height = int(v[0]), int(v[1])
        elif kind == 'depth': depth = v[0]
        elif kind == 'bg': background = v
        elif kind == 'camera': eye, view, up, zoom = v[0:3], v[3:6], v[6:9], float(v[9])
        elif kind == 'light': lights.append((v[:3], v[3:6]))
        elif kind == 'mat': materials.append(v)
        else: shapes.append((kind, v))
    byte = lambda channels: numbers([repr(float(c) * 255) for c in channels])
    with open(target, 'w') as out:
        w, h = width / height / zoom * (width - 1) / width, 1 / zoom * (height - 1) / height
        out.write(f'Scene(\n    film: (width: {width}, height: {height}, transfer: Classic),\n    quality: (depth: {depth}),\n'
                  f'    camera: (position: {numbers(eye)}, view: {numbers(view)}, up: {numbers(up)},'
                  f' screen: (distance: 1, width: {w!r}, height: {h!r})),\n'
                  f'    ambient: (1, 1, 1),\n    background: {byte(background)},\n    materials: {{\n')
        for i, m in enumerate(materials):
            mirror = f', reflective: (k_r: {m[5]})' if float(m[5]) else ''
            out.write(f'        "m{i}": (k_a: {m[3]}, k_d: {m[4]}, color: {byte(m[:3])}{mirror}),\n')
        out.write('    },\n    entities: [\n')
        for kind, v in shapes:
            f = [float(x) for x in v]
            if kind == 'plane':
                n, d, m = f[:3], f[3], v[4]
                out.write(f'        (shape: Plane(normal: {numbers(v[:3])}), material: "m{m}",'
                          f' transform: (translation: {numbers([repr(c * d) for c in n])})),\n')
            elif kind == 'sphere':
                out.write(f'        (shape: Sphere(radius: {v[3]}), material: "m{v[4]}",'
                          f' transform: (translation: {numbers(v[:3])})),\n')
            else:
                low, high = f[:3], f[3:6]
                size = numbers([repr(b - a) for a, b in zip(low, high)])
                middle = numbers([repr((a + b) / 2) for a, b in zip(low, high)])
                out.write(f'        (shape: Box(size: {size}), material: "m{v[6]}", transform: (translation: {middle})),\n')
        for place, color in lights:
            out.write(f'        (light: Point(intensity: {numbers(color)}), transform: (translation: {numbers(place)})),\n')
        out.write('    ],\n)\n')


if __name__ == '__main__':
    main(*sys.argv[1:])
