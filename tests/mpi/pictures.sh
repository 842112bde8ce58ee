#!/bin/bash
# Pictures of a wall: patterns, frame codes and overlay over them, side-cars that remake them, videos.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1
wall=(--tiles 3x1 --bezel 10 --size 360x120)
scene=(--scene sheet.obj --set octree_depth=6 --quiet)

sim() { # NAME ARGUMENT...: into folder NAME
    local name=$1
    shift
    timeout 300 "$program" sim --out "$name" --report "$name/report.json" "$@" >"$name.log" 2>&1
    local code=$?
    is "sim $name ends well" $code 0
    [ $code -eq 0 ] || sed 's/^/# /' "$name.log"
}

hash_of() { # FILE.json
    json "$1" '["image"]["hash"]'
}

# --- patterns: neither scene nor octree; frame codes by a verb of their own
sim grid --pattern grid "${wall[@]}" --frames 2 --frame-codes
is "a pattern has no scene" "$(json grid/report.json '["scene"]')" None
is "and no octree" "$(json grid/report.json '["octree"]')" None
expect "all tiles show frame 0" 0 "all 3 tiles show the same frame" codes --tiles 3x1 --size 360x120 grid/wall-0000.png
has "by name and number" "$("$program" codes --tiles 3x1 --size 360x120 grid/wall-0001.png)" "c2r0             frame 1"
sim plain --pattern grid "${wall[@]}" --frames 2
is "codes are not in the tiles' own pixels" "$(hash_of grid/report.json)" "$(hash_of plain/report.json)"
is "but in the picture" "$(cmp -s grid/wall.png plain/wall.png || echo differ)" differ
expect "a picture without codes" 1 "0 of 3 tiles could be read" codes --tiles 3x1 --size 360x120 plain/wall.png
expect "a pattern that is none" 2 "did you mean grid" sim --pattern gird
expect "a pattern is no scene" 2 "leave out --scene" sim --pattern grid --scene sheet.obj

# --- overlay: over what is written, not over what is hashed
sim bare "${wall[@]}" "${scene[@]}" --frames 2 --gaze 150,60
sim overlay "${wall[@]}" "${scene[@]}" --frames 2 --gaze 150,60 --overlay
is "the overlay changes no pixel of its own" "$(hash_of overlay/report.json)" "$(hash_of bare/report.json)"
is "the picture shows it" "$(cmp -s overlay/wall.png bare/wall.png || echo differ)" differ
is "so does the tile's" "$(cmp -s overlay/tile-c1r0.png bare/tile-c1r0.png || echo differ)" differ
is "the side-car tells" "$(json overlay/wall.json '["image"]["overlay"]')" True

# --- side-cars
is "a side-car has the hash" "$(hash_of bare/wall-0001.json)" "$(hash_of bare/report.json)"
sim remade --remake bare/wall-0000.json --quiet
same_file "a picture made again" remade/wall.png bare/wall-0000.png
same_file "with bezels, too" remade/wall-bezels.png bare/wall-bezels-0000.png
sim stereo --tiles 2x1 --size 120x60 "${scene[@]}" --stereo anaglyph --eye-distance 70
sim again --remake stereo/wall.json --quiet
same_file "and with two eyes" again/wall.png stereo/wall.png
sim pattern --remake plain/wall.json --quiet
same_file "and of a pattern" pattern/wall.png plain/wall.png
sed -i 's/^v 2 1 -1$/v 2 1 -2/' sheet.obj
expect "a scene that has changed" 2 "is not the one that the picture was made from" sim --remake bare/wall-0000.json --out changed
expect "what the file decides" 2 "leave out --set tau" sim --remake bare/wall-0000.json --tau 2
expect "no side-car" 2 "is no side-car of a picture" sim --remake bare/report.json

# --- video
if command -v ffmpeg >/dev/null && command -v ffprobe >/dev/null; then
    sim video --pattern grid "${wall[@]}" --frames 5 --fps 10 --frame-codes --video video.mp4
    has "a video of five frames" "$(ffprobe -v error -show_entries stream=codec_name,width,height,nb_frames -of csv video.mp4 2>&1)" "h264,360,120,5"
    ffmpeg -v error -i video.mp4 -vf 'select=eq(n\,3)' -frames:v 1 -update 1 frame-3.png </dev/null
    expect "its frame 3 shows frame 3" 0 "c0r0             frame 3" codes --tiles 3x1 --size 360x120 frame-3.png
else
    echo "ok $((number += 1)) - a video # SKIP ffmpeg is not installed"
fi
expect "a video's pace without a video" 2 "give --video" sim --pattern grid --fps 20
expect "a budget for a pattern" 2 "leave out --budget" sim --pattern grid --budget-rays 1000
expect "a name that is no video's" 2 "ends in .mp4" sim --pattern grid --video film.txt
mkdir -p programs
for needed in mpirun orted sh env; do
    ln -sf "$(command -v $needed)" programs/ 2>/dev/null
done
errors=$(timeout 120 env "PATH=$folder/programs" "$program" sim --pattern grid --video none.mp4 2>&1)
is "without ffmpeg: exit code" $? 3
has "without ffmpeg: the fix" "$errors" "apt-get install ffmpeg"
# One that gives up in the middle, in its own words.
printf '#!/bin/sh\nhead -c 300000 >/dev/null\necho "no space left in the test" >&2\nexit 1\n' >programs/ffmpeg
chmod +x programs/ffmpeg
errors=$(PATH=$folder/programs:$PATH timeout 120 "$program" sim --pattern grid "${wall[@]}" --frames 4 --video broken.mp4 2>&1)
is "ffmpeg gives up: exit code" $? 5
has "ffmpeg gives up: its words" "$errors" "no space left in the test"
# A disk that is full when the index is written: the real one mentions it and exits with 0 unless it is told otherwise.
printf '#!/bin/sh\ncat >/dev/null\necho "Error writing trailer" >&2\ncase " $* " in *" -xerror "*) exit 1 ;; esac\n' >programs/ffmpeg
errors=$(PATH=$folder/programs:$PATH timeout 120 "$program" sim --pattern grid "${wall[@]}" --frames 2 --video full.mp4 2>&1)
is "no room for a video's index: exit code" $? 5
has "no room for a video's index: its words" "$errors" "Error writing trailer"
is "no half file, none of its own" "$(find . -maxdepth 1 -name '*.mp4' ! -name video.mp4 -o -maxdepth 1 -name '.*part' | wc -l)" 0
finish
