#!/bin/bash
# The site file is changed a hundred times while frames are drawn: every frame is of one site on all tiles, what is
# wrong is told and changes nothing, and the last site is the one that holds.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
cd "$folder" || exit 1
readonly reloads=100

site() { # SHIFT: three tiles of 400 x 600 mm, that many mm lower, and the gamma of the first after it
    printf 'version: 1\neye: [0, 0, 2000]\ntiles:\n'
    local tile left top=$((300 - $1)) bottom=$((-300 - $1))
    for tile in 0 1 2; do
        left=$((tile * 400))
        printf '  - name: t%d\n    pixels: [80, 120]\n    place: [%d, 0]\n' $tile $((tile * 80))
        printf '    corners: [[%d, %d, 0], [%d, %d, 0], [%d, %d, 0]]\n' $left $top $((left + 400)) $top $left $bottom
    done
}

wait_for() { # TEXT COUNT: so many lines of the log have it, within two minutes
    for ((try = 0; try < 6000; try++)); do
        [ "$(grep -c -- "$1" sim.log)" -ge "$2" ] && return 0
        sleep 0.02
    done
    return 1
}

site 0 >wall.yaml
timeout 500 "$program" sim --site wall.yaml --pattern grid --frames 100000 --out pictures --report report.json \
    --log debug >sim.log 2>&1 &
running=$!
for ((try = 0; try < 3000; try++)); do
    [ -e pictures/wall-0001.png ] && break
    sleep 0.02
done
taken=0
for ((k = 1; k <= reloads; k++)); do
    site $((k * 37 % 1000)) >wall.new
    mv wall.new wall.yaml
    wait_for "on: tile 't2': corners moved" $k || break
    taken=$k
    if [ $k -eq 50 ]; then
        printf 'version: 1\ntiles: [' >wall.yaml
        wait_for "the wall goes on as it was: wall.yaml:" 1
        verdict "a wrong file is one line with its place" $? <sim.log
        site 0 | sed 's/80, 120/40, 60/' >wall.new
        mv wall.new wall.yaml
        wait_for "cannot be changed while frames are drawn" 1
        verdict "what needs a restart is told" $? <sim.log
    fi
done
is "every change was taken over" $taken $reloads
sleep 0.3
kill -INT $running
wait $running
is "it ran to its interruption" $? 130
is "the report counts them" "$(json report.json '["site_reloads"]')" $reloads
is "lines about what was wrong" "$(grep -c 'the wall goes on as it was' sim.log)" 2
python3 - pictures $reloads >mixed.log 2>&1 <<'P'
import glob, json, struct, sys, zlib

def rows(data):
    at, parts = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height = struct.unpack(">II", data[at + 8:at + 16])
        if kind == b"IDAT":
            parts += data[at + 8:at + 8 + size]
        at += size + 12
    data, before, out = zlib.decompress(parts), bytearray(width * 3), []
    for y in range(102):
        kind, line = data[y * (width * 3 + 1)], bytearray(data[y * (width * 3 + 1) + 1:(y + 1) * (width * 3 + 1)])
        if kind == 2:
            line = bytearray((a + b) & 255 for a, b in zip(line, before))
        elif kind:
            for i in range(width * 3):
                a = line[i - 3] if i >= 3 else 0
                b, c = before[i], before[i - 3] if i >= 3 else 0
                if kind == 4:
                    p = a + b - c
                    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                    guess = a if pa <= pb and pa <= pc else b if pb <= pc else c
                else:
                    guess = a if kind == 1 else (a + b) // 2
                line[i] = (line[i] + guess) & 255
        out.append(bytes(line))
        before = line
    return out

# Of each tile, what stands in those rows; equal files are looked at once.
seen = {}
def lines_of(path):
    data = open(path, "rb").read()
    if data not in seen:
        picture = rows(data)
        seen[data] = [[picture[y][(80 * t + 70) * 3:(80 * t + 70) * 3 + 3] for y in [*range(18, 34), *range(86, 102)]]
                      for t in range(3)]
    return seen[data]

# Level lines stand in the same rows on every tile: of a column beside names and marks, where no line is upright.
# The frame that the interruption ends may lack tiles, and says so in its name.
names = glob.glob(sys.argv[1] + "/wall-[0-9]*.png")
frames = sorted((name for name in names if "-incomplete" not in name), key=lambda name: int(name.split("-")[-1][:-4]))
assert len(names) - len(frames) <= 1, "incomplete frames"
step = max(1, len(frames) // 250)
shown, mixed = set(), 0
tops = [json.load(open(name[:-3] + "json"))["site"]["tiles"][0]["corner"][1] for name in frames]
changes = [i for i in range(1, len(frames)) if tops[i] != tops[i - 1]]
# Every frame about a change, and the others by samples.
for i in sorted(set(changes) | {c - 1 for c in changes} | set(range(0, len(frames), step))):
    lines = lines_of(frames[i])
    mixed += lines[0] != lines[1] or lines[0] != lines[2]
    shown.add((tops[i], tuple(lines[0])))
print("frames", len(frames), "changes", len(changes), "mixed", mixed)
assert len(changes) == int(sys.argv[2]), "changes that side-cars tell of"
assert mixed == 0, "mixed frames"
# One picture for one site: no tile goes on with an old one.
assert len({top for top, lines in shown}) == len(shown), "sites that look two ways"
assert len({lines for top, lines in shown}) > 15, "sites look different"
print("fine")
P
is "no frame is mixed" "$(tail -1 mixed.log)" fine
sed 's/^/# /' mixed.log
finish
