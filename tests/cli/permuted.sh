#!/bin/bash
# The order of triangles and vertices in a file, and with which corner a triangle begins, change neither the octree nor a
# pixel: an OBJ with texture, cut-out and smooth normals made while reading, and a PLY with vertex colours.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
cp "$(dirname "$0")/../data/checker.png" "$(dirname "$0")/../data/mask.png" "$folder/"

# make_files SEED NAME: the scene as NAME.obj and NAME.ply, in its own order for seed 0.
make_files() {
    python3 - "$folder" "$@" <<'PYTHON'
import math, random, sys
folder, seed, name = sys.argv[1], int(sys.argv[2]), sys.argv[3]
shuffle = random.Random(seed)
points, faces = [], []  # a wavy sheet, a flat one that crosses it, some faces twice, some turned over
for sheet in range(2):
    first = len(points)
    for j in range(13):
        for i in range(13):
            x, y = i / 6 - 1, j / 6 - 1
            z = 0.3 * math.sin(3.1 * x + sheet) * math.cos(2.3 * y) if sheet == 0 else 0.2 * x + 0.1 * y
            points.append((x, y, z, i / 4, j / 4, (i * 19) % 256, (j * 17) % 256, (i * j * 7) % 256))
    for j in range(12):
        for i in range(12):
            a = first + 13 * j + i
            faces += [(a, a + 1, a + 14, sheet), (a, a + 14, a + 13, sheet)]
faces += [faces[i] for i in range(0, 200, 9)] + [(f[0], f[2], f[1], f[3]) for f in faces[3:200:11]]
place = list(range(len(points)))
if seed:
    shuffle.shuffle(place)
    shuffle.shuffle(faces)
    turns = [shuffle.randrange(3) for f in faces]
    faces = [tuple(f[(k + t) % 3] for k in range(3)) + (f[3],) for f, t in zip(faces, turns)]
order = sorted(range(len(points)), key=lambda p: place[p])
number = {p: i for i, p in enumerate(order)}
with open(f"{folder}/{name}.obj", "w") as out:
    print("mtllib two.mtl", file=out)
    for p in order:
        print("v %.6f %.6f %.6f" % points[p][:3], file=out)
    for p in order:
        print("vt %.6f %.6f" % points[p][3:5], file=out)
    for f in faces:
        print("usemtl", ("checked", "masked")[f[3]], file=out)
        print("f", *("%d/%d" % (number[p] + 1, number[p] + 1) for p in f[:3]), file=out)
with open(f"{folder}/{name}.ply", "w") as out:
    print("ply\nformat ascii 1.0\nelement vertex %d" % len(points), file=out)
    for axis in "xyz":
        print("property float", axis, file=out)
    for channel in ("red", "green", "blue"):
        print("property uchar", channel, file=out)
    print("element face %d\nproperty list uchar int vertex_indices\nend_header" % len(faces), file=out)
    for p in order:
        print("%.6f %.6f %.6f %d %d %d" % (points[p][:3] + points[p][5:]), file=out)
    for f in faces:
        print(3, *(number[p] for p in f[:3]), file=out)
PYTHON
}
printf 'newmtl checked\nKd 1 1 1\nmap_Kd checker.png\nnewmtl masked\nKd 0.9 0.7 0.5\nmap_Kd checker.png\nmap_d mask.png\n' >"$folder/two.mtl"

# draw NAME.EXTENSION: triangles inside the gaze, voxels and blends outside; then voxels alone.
draw() {
    timeout 120 "$program" render --quiet --cache none --scene "$folder/$1" --size 96x72 --gaze 30,36 --set gaze_half_width=6 \
        --out "$folder/$1.png" --report "$folder/$1.json" &&
        timeout 120 "$program" render --quiet --cache none --scene "$folder/$1" --size 96x72 --set geometry=voxels \
            --set octree_depth=5 --out "$folder/$1.voxels.png"
}

make_files 0 plain
for extension in obj ply; do
    draw "plain.$extension" >"$folder/log" 2>&1
    verdict "the $extension is drawn" $? <"$folder/log"
    is "its copies are known" "$(json "$folder/plain.$extension.json" '["scene"]["dropped"]["duplicate"]')" 23
done
has "the obj has textures and a cut-out" "$(json "$folder/plain.obj.json" '["effects"]["run"]')" "alpha"
has "the ply has vertex colours" "$(json "$folder/plain.ply.json" '["effects"]["run"]')" "vertex-colors"
for seed in 1 2; do
    make_files $seed other
    for extension in obj ply; do
        draw "other.$extension" >"$folder/log" 2>&1
        for hash in scene octree; do
            is "order $seed of the $extension: the same $hash" "$(json "$folder/other.$extension.json" "[\"$hash\"][\"hash\"]")" \
                "$(json "$folder/plain.$extension.json" "[\"$hash\"][\"hash\"]")"
        done
        same_file "order $seed of the $extension: the same pixels" "$folder/other.$extension.png" "$folder/plain.$extension.png"
        same_file "order $seed of the $extension: the same voxels" "$folder/other.$extension.voxels.png" \
            "$folder/plain.$extension.voxels.png"
    done
done
[ "$(cmp -l "$folder/plain.obj" "$folder/other.obj" 2>/dev/null | wc -l)" -gt 1000 ]
verdict "the files do differ" $? </dev/null
finish
