#!/bin/bash
# Windows, on a display without a screen (Xvfb): the same pixels with and without them, by 1 to 8 ranks; what the screen
# shows is the wall, bit for bit; whoever flies is recorded and repeated; what is missing is told by name.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
support=$(realpath "$(dirname "$0")/../support")
cd "$folder" || exit 1
common=(--scene sheet.obj --set octree_depth=7 --quiet)
view=(--gaze "50,40")
width=168 height=96

# --- without a display
unset DISPLAY
expect "no display" 3 "DISPLAY is not set" sim "${common[@]}" --window
expect "two ways at once" 2 "exclude each other" sim --window --headless
expect "a window and none" 2 "exclude each other" sim --headless --tile-windows
expect "tiles on a GPU of their display" 2 "leave out --gpu" sim --tile-windows --gpu 0
expect "states and a pilot" 2 "leave out --input" sim --states x.json --input tour.txt
echo "0 prss W" >wrong.txt
expect "a file of input that is wrong" 2 "wrong.txt:1: unknown event 'prss'; expected press" sim "${common[@]}" --input wrong.txt
echo "0 press W" >endless.txt
expect "a file of input without an end" 2 "this would never end" sim "${common[@]}" --tiles 1x1 --size 16x16 --input endless.txt
DISPLAY=:32123 expect "a display that is not there" 3 "':32123'" sim "${common[@]}" --tile-windows

# --- one frame by render (one process) and by 2 to 8 ranks, without windows
sim() { # NAME ARGUMENT...: report NAME.json
    local name=$1
    shift
    timeout 300 "$program" sim "${common[@]}" --report "$name.json" "$@" >"$name.log" 2>&1
    local code=$?
    is "sim $name ends well" $code 0
    [ $code -eq 0 ] || sed 's/^/# /' "$name.log"
}
expect "render" 0 "" render "${common[@]}" --size ${width}x$height "${view[@]}" --out render.png --report render.json
wanted=$(json render.json '["image"]["hash"]')
same() { # NAME
    is "$1 has render's pixels" "$(json "$1.json" '["image"]["hash"]')" "$wanted"
}
for tiles in 2x1 3x1 2x2 5x1 3x2 1x7 4x2; do
    sim headless-$tiles --headless --tiles $tiles --size ${width}x$height "${view[@]}"
    same headless-$tiles
done

# --- a tour without a window: the frame states are those of the tour, whatever shows them
cat >tour.txt <<'T'
0 pointer 0.4 0.5
1 press W     # ahead
1 press right
3 release right
4 pointer 0.8 0.3
4 press B
5 press H
6 resize 500 300
9 close
T
sim tour --tiles 2x1 --size ${width}x$height --input tour.txt --save-states tour-states.json
is "the window's close ends the tour after its last frame" "$(json tour.json '["frames"]')" 10
sim again --tiles 1x2 --size ${width}x$height --states tour-states.json
is "what was flown is repeated" "$(json again.json '["image"]["hash"]')" "$(json tour.json '["image"]["hash"]')"
is "it was flown: ahead, by 2 m/s of the room, and turned" "$(python3 - <<'P'
import json, math
s = [json.loads(line) for line in open("tour-states.json")][1:]
apart = lambda a, b: math.dist(a["stand"], b["stand"]) * a["scene_scale"] / 1000
step = (s[9]["time"] - s[8]["time"]) * 1e-9
heading = lambda a: math.atan2(a["look_at"][0] - a["stand"][0], a["stand"][2] - a["look_at"][2])
print(s[0]["stand"] == s[0]["look_at"], abs(apart(s[2], s[3]) / step / 2 - 1) < 1e-3, 0.05 < heading(s[9]) < 0.07,
      s[0]["gazes"] != s[9]["gazes"])
P
)" "True True True True"

if ! command -v Xvfb >/dev/null; then
    number=$((number + 1))
    echo "ok $number # SKIP Xvfb is not installed: nothing was shown"
    finish
    exit
fi
Xvfb -displayfd 3 -screen 0 640x480x24 -nolisten tcp 3>display 2>xvfb.log &
server=$!
trap 'kill $server 2>/dev/null' EXIT
for _ in $(seq 100); do
    [ -s display ] && break
    sleep 0.1
done
DISPLAY=:$(cat display)
export DISPLAY

# --- the same pixels with windows
for tiles in 1x1 3x1; do
    sim tiles-$tiles --tile-windows --tiles $tiles --size ${width}x$height "${view[@]}"
    same tiles-$tiles
done
is "a window's context is asked to tell of resets as one without is" "$(json tiles-1x1.json '["device"]["resets_told"]')" \
    "$(json headless-2x1.json '["device"]["resets_told"]')"
sim wall --window --frames 1 --tiles 2x2 --size ${width}x$height "${view[@]}"
same wall
sim shown --window --tiles 2x1 --size ${width}x$height --input tour.txt --save-states shown-states.json
same_file "a window does not change what is flown" shown-states.json tour-states.json
is "nor what is drawn" "$(json shown.json '["image"]["hash"]')" "$(json tour.json '["image"]["hash"]')"

# --- monitors and their errors
site() { # MONITOR WIDTHxHEIGHT: a site of one tile
    echo "version: 1
grid:
  columns: 1
  rows: 1
  tile: {width: 640, height: 480, pixels: [${2%x*}, ${2#*x}]}
panel: {display: \"$DISPLAY\", monitor: $1}" >site.yaml
}
site scren 640x480
expect "a monitor that is not there" 3 "has no monitor 'scren'; did you mean 'screen'?" sim "${common[@]}" --site site.yaml --tile-windows
site screen 320x200
expect "a monitor in another mode" 3 "asked for 320x200 px on monitor screen, which shows 640x480 px" sim "${common[@]}" --site site.yaml --tile-windows
site screen 640x480
sim full --site site.yaml --tile-windows "${view[@]}"
sim full-headless --site site.yaml --headless "${view[@]}"
is "full-screen has the same pixels" "$(json full.json '["image"]["hash"]')" "$(json full-headless.json '["image"]["hash"]')"

# --- a window manager that knows better: what was asked for and what came, by name, and no wall of windows that do not fit
python3 -u "$support/stubborn_window_manager.py" >manager.log 2>&1 &
manager=$!
for _ in $(seq 100); do
    [ -s manager.log ] && break
    sleep 0.1
done
expect "a window manager that changes what is asked for" 3 \
    "c0r0: asked for a window of ${width}x$height px at 0,0, obtained 300x200 px at 20,20; a window manager" \
    sim "${common[@]}" --tile-windows --tiles 1x1 --size ${width}x$height "${view[@]}"
kill $manager
wait $manager 2>/dev/null

# --- swaps wait for the screen; its saver is held off, and whoever cannot says so: by a library in place of libXss
cat >saver.c <<'C'
#include <stdio.h>
int XScreenSaverQueryExtension(void *display, int *event, int *error) {
    *event = *error = 0;
    return display && ANSWER;
}
void XScreenSaverSuspend(void *display, int on) {
    FILE *file = fopen("saver.txt", "a");
    fprintf(file, "%d %d\n", display != 0, on);
    fclose(file);
}
C
asked() { # ANSWER: of the extension's query; into asked.log
    mkdir -p saver
    cc -shared -fPIC -DANSWER="$1" -o saver/libXss.so.1 saver.c
    LD_LIBRARY_PATH=$folder/saver${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} timeout 120 "$program" sim --scene sheet.obj --set octree_depth=7 \
        --log debug --tile-windows --tiles 1x1 --size ${width}x$height "${view[@]}" >asked.log 2>&1
}
asked 1
has "a window waits for its screen's refresh" "$(cat asked.log)" "c0r0: ${width}x$height px, swap interval 1"
is "the screen saver is suspended" "$(head -1 saver.txt)" "1 1"
is "without a word" "$(grep -c "screen saver" asked.log)" 0
asked 0
has "an X server that cannot: it is told, with what to do" "$(cat asked.log)" \
    "the screen saver stays on: the X server has no extension MIT-SCREEN-SAVER; switch it off by hand (xset s off -dpms)"

# --- what the screen shows, while it runs
gone() { # NAME: waits until no process of the run is left
    for _ in $(seq 100); do
        pgrep -f -- "--report $1.json" >/dev/null || break
        sleep 0.1
    done
    pgrep -cf -- "--report $1.json"
}
echo "100000 close" >wait.txt
if command -v ffmpeg >/dev/null; then
    # The embedded scene, built anew, so that there is something to wait for.
    XDG_CACHE_HOME=$folder/empty "$program" sim --quiet --tile-windows --tiles 2x1 --size ${width}x$height --frames 1 --report loading.json >loading.log 2>&1 &
    launcher=$!
    waits=""
    while kill -0 $launcher 2>/dev/null && [ "$waits" != 303840 ]; do
        waits=$(ffmpeg -loglevel error -f x11grab -draw_mouse 0 -video_size 2x2 -i "$DISPLAY+0,0" -frames:v 1 -f rawvideo -pix_fmt rgb24 - </dev/null | head -c 3 | od -An -tx1 | tr -d ' ')
    done
    is "while the scene is loaded, the windows say so" "$waits" 303840
    kill -INT $launcher 2>/dev/null
    wait $launcher
fi
if command -v ffmpeg >/dev/null; then
    sim bezels --tiles 2x2 --bezel 30 --size ${width}x$height "${view[@]}" --out bezels
    "$program" sim "${common[@]}" --tile-windows --tiles 2x2 --bezel 30 --size ${width}x$height "${view[@]}" --input wait.txt --report live.json >live.log 2>&1 &
    launcher=$!
    size=$(python3 -c 'import struct; print("%dx%d" % struct.unpack(">II", open("bezels/wall-bezels.png", "rb").read(24)[16:]))')
    ffmpeg -loglevel error -i bezels/wall-bezels.png -f rawvideo -pix_fmt rgb24 wanted.raw </dev/null
    # Between the tiles the desktop shows: bezels do not count.
    for _ in $(seq 60); do
        ffmpeg -loglevel error -y -f x11grab -draw_mouse 0 -video_size "$size" -i "$DISPLAY+0,0" -frames:v 1 -f rawvideo -pix_fmt rgb24 got.raw </dev/null
        different=$(python3 -c '
a, b = open("wanted.raw", "rb").read(), open("got.raw", "rb").read()
print(len(a) != len(b) or sum(a[i:i + 3] != b[i:i + 3] and a[i:i + 3] != bytes((24, 24, 26)) for i in range(0, len(a), 3)))')
        [ "$different" = 0 ] && break
        sleep 0.5
    done
    is "the tiles stand on the screen as they hang, bit for bit" "$different" 0
    kill -INT $launcher
    wait $launcher
    is "Ctrl-C ends windows" $? 130
    is "no process is left" "$(gone live)" 0
else
    number=$((number + 1))
    echo "ok $number # SKIP ffmpeg is not installed: nobody looked at the screen"
fi
finish
