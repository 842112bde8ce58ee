#!/bin/bash
# The wall goes on: a killed and a stopped tile cost the others one deadline; the report names them; frames without them
# say so in their names; a loss before the first frame ends the run.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1

pid_of() { # LOG RANK
    sed -n "s/.*rank $2 (tile [^)]*) is process \([0-9]*\)\$/\1/p" "$1"
}

wait_for() { # FILE
    local turn
    for turn in $(seq 600); do
        [ -s "$1" ] && return
        sleep 0.1
    done
    echo "# $1 did not come in $((turn / 10)) s"
}

# run NAME SIGNAL...: a wall of 3 tiles; rank 2 is sent the signal after frame 2
run() {
    local name=$1 signal=$2
    timeout 300 "$program" sim --scene sheet.obj --set octree_depth=5 --tiles 3x1 --size 96x32 --frames 80 --death-deadline 1 \
        --log debug --out "$name" --report "$name.json" >"$name.out" 2>"$name.log" &
    local launcher=$!
    wait_for "$name/wall-0002.png"
    local victim
    victim=$(pid_of "$name.log" 2)
    [ -n "$victim" ] && kill "-$signal" "$victim"
    wait $launcher
    is "$name: exit code" $? 1
    is "$name: the report knows it" "$(json "$name.json" '["tiles"][2]["state"]') $(json "$name.json" '["tiles"][1]["state"]')" "lost live"
    is "$name: all frames were drawn" "$(json "$name.json" '["frames"]')" 80
    has "$name: it is told by name" "$(cat "$name.log")" "tile c2r0 (rank 2) is lost since frame"
    has "$name: the summary says so" "$(cat "$name.out")" "NOT ALL OF THEM TO THE END"
    local lost
    lost=$(json "$name.json" '["tiles"][2]["lost_frame"]')
    is "$name: frames before are whole" "$(find "$name" -name 'wall-[0-9]*.png' ! -name '*incomplete*' | wc -l)" "$lost"
    is "$name: frames after say so" "$(find "$name" -name 'wall-[0-9]*-incomplete.png' | wc -l)" $((80 - lost))
    is "$name: the last one has no plain name" "$(ls "$name/wall.png" 2>/dev/null)" ""
    exists "$name: but a name that says so" "$name/wall-incomplete.png"
    is "$name: the row of the last frame counts it" "$(tail -1 "$name/frames.csv" | awk -F, '{ print $NF }')" 1
    sleep 0.5
    is "$name: no process is left" "$(pgrep -f -- "--out $name" | wc -l)" 0
}

# --- rank 0 hangs: nobody but the launcher can notice, and it takes its time: what comes of it is seen at the end
timeout 300 "$program" sim --scene sheet.obj --set octree_depth=5 --tiles 2x1 --size 96x32 --frames 100000 --death-deadline 1 --log debug --out hang >hang.out 2>hang.log &
hanging=$!
wait_for hang/wall-0002.png
kill -STOP "$(pid_of hang.log 0)"

run killed KILL
run stopped STOP

# --- before the first frame: a model big enough that killing rank 1 meets it while loading
timeout 300 "$program" sim --tiles 3x1 --size 96x32 --log debug >early.out 2>early.log &
launcher=$!
for _ in $(seq 300); do
    victim=$(pid_of early.log 1)
    [ -n "$victim" ] && break
    sleep 0.05
done
kill -KILL "$victim"
wait $launcher
is "early: exit code" $? 4
has "early: it is told by name" "$(cat early.log)" "rank 1 (tile c1r0, process $victim) died before the first frame"

# --- rank 0
timeout 300 "$program" sim --scene sheet.obj --set octree_depth=5 --tiles 2x1 --size 96x32 --frames 2000 --log debug --out first >first.out 2>first.log &
launcher=$!
wait_for first/wall-0002.png
kill -KILL "$(pid_of first.log 0)"
wait $launcher
is "rank 0: exit code" $? 4
has "rank 0: it is told by name" "$(cat first.log)" "rank 0 (tile c0r0"
sleep 0.5
exists "rank 0: the other tile shows a notice, not a frozen frame" first/tile-c1r0-notice.png
is "rank 0: no process is left" "$(pgrep -f -- "--out first" | wc -l)" 0

# --- mpirun is killed: the launcher removes what it leaves
timeout 300 "$program" sim --scene sheet.obj --set octree_depth=5 --tiles 2x1 --size 96x32 --frames 2000 --log debug --out orphans >orphans.out 2>orphans.log &
launcher=$!
wait_for orphans/wall-0002.png
victim=$(pgrep -f -- "^mpirun .*--out orphans")
is "mpirun killed: it has a session folder" "$(find "${TMPDIR:-/tmp}" -maxdepth 2 -path "*/ompi.*/pid.$victim" 2>/dev/null | wc -l)" 1
mapfile -t segments < <(grep -o '/dev/shm/vader_segment[^ ]*' "/proc/$(pid_of orphans.log 1)/maps" | sort -u)
is "mpirun killed: it has segments of shared memory" $((${#segments[@]} > 0)) 1
kill -KILL "$victim"
wait $launcher
is "mpirun killed: exit code" $? 4
is "mpirun killed: no process is left" "$(pgrep -f -- "--out orphans" | wc -l)" 0
is "mpirun killed: no session folder" "$(find "${TMPDIR:-/tmp}" -maxdepth 2 -path "*/ompi.*/pid.$victim" 2>/dev/null | wc -l)" 0
is "mpirun killed: the segments are gone" "$(ls "${segments[@]}" 2>/dev/null)" ""

# --- a tile that cannot write its pictures: the run ends with that error
mkdir -p full/tile-c1r0-0000.png
timeout 300 "$program" sim --scene sheet.obj --set octree_depth=5 --tiles 2x1 --size 96x32 --out full >full.out 2>full.log
is "a tile cannot write: exit code" $? 5
has "a tile cannot write: it is told by name" "$(cat full.log)" "tile c1r0: "

# --- the load deadline
timeout 300 "$program" sim --tiles 2x1 --size 96x32 --load-deadline 1 --set octree_depth=12 >slow.out 2>slow.log
is "too slow: exit code" $? 4
has "too slow: it says what to raise" "$(cat slow.log)" "raise --load-deadline"

# --- no mpirun, and one that gives up
mkdir -p tools
PATH=$folder/tools /usr/bin/env "$program" sim --scene sheet.obj --quiet >none.out 2>none.log
is "no mpirun: exit code" $? 3
has "no mpirun: it says what to install" "$(cat none.log)" "install openmpi-bin"
printf '#!/bin/sh\necho "not enough slots available"\nexit 1\n' >tools/mpirun
chmod +x tools/mpirun
PATH=$folder/tools:$PATH "$program" sim --scene sheet.obj --quiet >weak.out 2>weak.log
is "mpirun gives up: exit code" $? 3
has "mpirun gives up: its words are shown" "$(cat weak.log)" "not enough slots available"
# --- rank 0 has hung all the while
wait $hanging
is "rank 0 hangs: exit code" $? 4
has "rank 0 hangs: it is told by name" "$(cat hang.log)" "rank 0 (tile c0r0) hangs"
exists "rank 0 hangs: the other tile shows a notice" hang/tile-c1r0-notice.png
is "rank 0 hangs: no process is left" "$(pgrep -f -- "--out hang" | wc -l)" 0
finish
