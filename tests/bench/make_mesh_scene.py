#!/usr/bin/env python3
"""Writes a scene of N triangles, to measure loading. Usage: make_mesh_scene.py FOLDER [--triangles N] [--form F]

Prints the path of the scene file. The triangles are a rough landscape below a camera, an area light and a sky.
Forms:
  ply     one binary PLY file
  text    numbers in the scene file
  meshes  one PLY file for each 1,000 triangles
Then: scene_bench --spp 1 --threads 1 --width 64 --height 48 --csv FILE FOLDER/scene.pbrt
"""
import argparse
import array
import math
import pathlib
import sys

TRIANGLES_OF_PIECE = 1000

HEAD = """LookAt 0 -1.4 0.9  0 0 0  0 0 1
Camera "perspective" "float fov" 45
Sampler "sobol" "integer pixelsamples" 1
Integrator "path" "integer maxdepth" 5
Film "rgb" "integer xresolution" 640 "integer yresolution" 480 "string filename" "mesh.exr"
WorldBegin
LightSource "infinite" "rgb L" [0.4 0.45 0.5]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [8 7 6]
  Translate 0 0 2
  Rotate 180 1 0 0
  Shape "disk" "float radius" 0.3
AttributeEnd
Material "diffuse" "rgb reflectance" [0.5 0.4 0.3]
"""


def height(x, y):
    return (0.06 * math.sin(9 * x) * math.cos(7 * y) + 0.02 * math.sin(41 * x + 3 * y) * math.sin(37 * y)
            + 0.004 * math.sin(211 * x) * math.cos(193 * y))


def patch(columns, rows, x0, x1):
    """Vertices and indices of a grid of 2 * columns * rows triangles over [x0, x1] x [-1, 1]."""
    points = array.array("f")
    for j in range(rows + 1):
        y = -1 + 2 * j / rows
        for i in range(columns + 1):
            x = x0 + (x1 - x0) * i / columns
            points.extend((x, y, height(x, y)))
    indices = array.array("i")
    for j in range(rows):
        row = j * (columns + 1)
        for i in range(row, row + columns):
            indices.extend((i, i + 1, i + columns + 2, i, i + columns + 2, i + columns + 1))
    return points, indices


def write_ply(path, points, indices):
    triangles = len(indices) // 3
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points) // 3}\n"
              "property float x\nproperty float y\nproperty float z\n"
              f"element face {triangles}\nproperty list uchar int vertex_indices\nend_header\n")
    faces = bytearray(13 * triangles)
    raw = indices.tobytes()
    faces[0::13] = b"\x03" * triangles
    for byte in range(12):
        faces[1 + byte::13] = raw[byte::12]
    path.write_bytes(header.encode() + points.tobytes() + bytes(faces))


def write_text(file, points, indices):
    file.write('Shape "trianglemesh"\n  "point3 P" [')
    for start in range(0, len(points), 3):
        file.write("%.6g %.6g %.6g\n" % tuple(points[start:start + 3]))
    file.write(']\n  "integer indices" [')
    for start in range(0, len(indices), 3):
        file.write("%d %d %d\n" % tuple(indices[start:start + 3]))
    file.write("]\n")


def main():
    parser = argparse.ArgumentParser(description="Write a scene of many triangles")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--triangles", type=int, default=3_500_000)
    parser.add_argument("--form", choices=("ply", "text", "meshes"), default="ply")
    options = parser.parse_args()
    if sys.byteorder != "little":
        parser.error("this machine is not little-endian")
    options.folder.mkdir(parents=True, exist_ok=True)
    scene = options.folder / "scene.pbrt"
    side = max(1, round(math.sqrt(options.triangles / 2)))
    with scene.open("w", encoding="ascii") as file:
        file.write(HEAD)
        if options.form == "meshes":
            pieces = max(1, round(options.triangles / TRIANGLES_OF_PIECE))
            for i in range(pieces):
                name = f"piece{i}.ply"
                x0, x1 = (-1 + 2 * k / pieces for k in (i, i + 1))
                write_ply(options.folder / name, *patch(1, TRIANGLES_OF_PIECE // 2, x0, x1))
                file.write(f'Shape "plymesh" "string filename" "{name}"\n')
        else:
            points, indices = patch(side, side, -1, 1)
            if options.form == "text":
                write_text(file, points, indices)
            else:
                write_ply(options.folder / "mesh.ply", points, indices)
                file.write('Shape "plymesh" "string filename" "mesh.ply"\n')
    print(scene)


if __name__ == "__main__":
    main()
