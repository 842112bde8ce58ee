#!/bin/bash
# A tile of a live wall that ends is started again: it comes back by TCP with scene and octree from the cache, and shows
# what an undisturbed tile shows. Strangers at rank 0's door disturb nobody; a tile that always dies is named and left for
# a while; one that lost its GL context comes back; nothing stays behind when the wall ends meanwhile.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1
cp sheet.obj model.obj # what a tile is drawn with when it comes back is not read from there
cp sheet.mtl model.mtl
sed -i 's/sheet.mtl/model.mtl/' model.obj

pid_of() { # LOG RANK: of its process started last
    sed -n "s/.*rank $2 (tile [^)]*) is process \([0-9]*\)\$/\1/p" "$1" | tail -1
}

# wait_for FILE TEXT [COUNT]: until so many lines have it; at most 120 s
wait_for() {
    for _ in $(seq 2400); do
        [ "$(grep -cF -- "$2" "$1" 2>/dev/null)" -ge "${3:-1}" ] && return
        sleep 0.05
    done
    echo "# '$2' did not come in $1"
}

rows() { # NAME COUNT: until so many frames more are drawn
    local wanted
    for _ in $(seq 1200); do
        [ -s "$1/frames.csv" ] && break
        sleep 0.05
    done
    wanted=$(($(wc -l <"$1/frames.csv") + $2))
    for _ in $(seq 1200); do
        [ "$(wc -l <"$1/frames.csv")" -ge $wanted ] && return
        sleep 0.05
    done
    echo "# $1 did not go on"
}

tile() { # REPORT NUMBER KEY
    json "$1" "['tiles'][$2]['$3']"
}

nothing_is_left() { # NAME
    for _ in $(seq 200); do
        pgrep -f -- "--report $1-$$.json" >/dev/null || break
        sleep 0.05
    done
    is "$1: no process is left" "$(pgrep -af -- "--report $1-$$.json" | cut -c 1-100)" ""
}

segments=$(find /dev/shm -name 'gazewall-*' -user "$(id -u)" 2>/dev/null | sort)

# --- a killed tile comes back; strangers, wrong secrets and doubles at the door meanwhile
wall=(--set octree_depth=5 --tiles 3x2 --size 96x64 --log debug)
timeout 300 "$program" sim --scene model.obj "${wall[@]}" --live --frames 100000 --frame-deadline 2 --death-deadline 60 \
    --set exposure=auto --out back --save-states states --report "back-$$.json" >back.out 2>back.log &
launcher=$!
wait_for back.log "tiles that are started again come in at"
rows back 20
rm model.obj model.mtl
kill -KILL "$(pid_of back.log 1)"
wait_for back.log "tile c1r0 (rank 1) takes part again"
door=$(sed -n 's/.*tiles that are started again come in at //p' back.log)
head -c 3000 /dev/urandom >"/dev/tcp/${door%:*}/${door##*:}"
wait_for back.log "was dropped at the gate: what it sent is no hello of a tile"
exec 9<>"/dev/tcp/${door%:*}/${door##*:}" # half open until the end of the run
stranger() { # SECRET
    GAZEWALL_SECRET=$1 timeout 60 "$program" rank --verb=sim --rejoin="1:9:$door" --scene sheet.obj "${wall[@]}" 2>&1
}
is "another secret: no answer" "$(stranger "${door//[^0]/0}00000000000000000000000000000000" | tail -1)" \
    "gazewall rank: rank 0 does not let this tile in: the line to it broke"
secret=$(tr '\0' '\n' <"/proc/$(pid_of back.log 2)/environ" | sed -n 's/^GAZEWALL_SECRET=//p')
has "a tile that is still here: it is told" "$(stranger "$secret")" "does not let this tile in: its tile is still here"
is "the secret stands in no command line" "$(cat /proc/[0-9]*/cmdline 2>/dev/null | grep -c -f <(echo "$secret"))" 0
wait_for back.log "tile c1r0 keeps up again"
rows back 10
kill -INT $launcher
wait $launcher
is "it comes back: exit code of the interruption" $? 130
exec 9>&-
is "it comes back: lost and returned once, live in the end" \
    "$(tile "back-$$.json" 1 lost) $(tile "back-$$.json" 1 returned) $(tile "back-$$.json" 1 state)" "1 1 live"
is "the others lost nothing" "$(json "back-$$.json" " and sum(t['lost'] + t['returned'] for t in d['tiles'] if t['rank'] != 1)")" 0
is "connections at the door were counted" "$(($(json "back-$$.json" "['gate']['dropped_connections']") >= 3))" 1
took=$(tile "back-$$.json" 1 rejoin_ms)
is "from its start to its first frame: $took ms" $((took > 0 && took < 60000)) 1
nothing_is_left back
is "exposure was decided of every frame but the first, whoever was there" \
    "$(python3 -c 'import csv
print(*sorted({float(row["exposure"]) != 0 for row in list(csv.DictReader(open("back/frames.csv")))[1:]}))')" True
# Undisturbed: the same states, in lock-step.
timeout 300 "$program" sim --scene sheet.obj "${wall[@]}" --states states --out calm --quiet >calm.log 2>&1
is "undisturbed: exit code" $? 0
read -r different shown < <(differing 'tile-*-[0-9]*.png' back calm)
is "what all tiles show is what they show undisturbed ($shown pictures)" "$different $((shown > 150))" "0 1"
last=$(find calm -name 'wall-[0-9]*.png' | sort | tail -1)
same_file "the last frame is whole" "back/$(basename "$last")" "$last"
exists "and says so" "back/tile-c1r0-$(basename "$last" | sed 's/wall-//')"

# --- the site changes while one tile is stopped and another is not there: both have it before they show anything again
site() { # SHIFT: three tiles of 800 x 600 mm, that many mm lower
    local tile left top=$((300 - $1)) bottom=$((-300 - $1))
    printf 'version: 1\neye: [0, 0, 2000]\ntiles:\n'
    for tile in 0 1 2; do
        left=$((tile * 800))
        printf '  - name: t%d\n    pixels: [160, 120]\n    place: [%d, 0]\n' $tile $((tile * 160))
        printf '    corners: [[%d, %d, 0], [%d, %d, 0], [%d, %d, 0]]\n' $left $top $((left + 800)) $top $left $bottom
    done
}
site 0 >wall.yaml
timeout 300 "$program" sim --site wall.yaml --pattern grid --live --frames 1000000 --frame-deadline 1 --death-deadline 100 \
    --log debug --out moved --report "moved-$$.json" >moved.out 2>moved.log &
launcher=$!
wait_for moved.log "tiles that are started again come in at"
rows moved 5
kill -STOP "$(pid_of moved.log 1)"
rows moved 3
again=$(grep -c "tile t1 keeps up again" moved.log)
site 137 >wall.new
mv wall.new wall.yaml
kill -KILL "$(pid_of moved.log 2)"
wait_for moved.log "on: tile 't2': corners moved"
kill -CONT "$(pid_of moved.log 1)"
wait_for moved.log "tile t1 keeps up again" $((again + 1))
wait_for moved.log "tile t2 (rank 2) takes part again"
wait_for moved.log "tile t2 keeps up again" $(($(grep -c "tile t2 (rank 2) is late" moved.log) + 1))
rm wall.yaml
wait_for moved.log "wall.yaml: there is no such file any more; the wall goes on as it was"
kill -INT $launcher
wait $launcher
site 137 >still.yaml
timeout 300 "$program" sim --site still.yaml --pattern grid --out still --quiet >still.log 2>&1
last=$(find moved -name 'wall-[0-9]*.png' ! -name '*incomplete*' | sort | tail -1)
frame=${last##*-}
for which in 0 1 2; do
    same_file "the site changed: tile t$which shows the new one" "moved/tile-t$which-$frame" still/tile-t$which.png
done
is "the site changed: one was late, one came back" \
    "$(tile "moved-$$.json" 1 lost) $(tile "moved-$$.json" 2 returned) $(json "moved-$$.json" "['site_reloads']")" "0 1 1"
is "the file that is gone is told once" "$(grep -c "no such file any more" moved.log)" 1
nothing_is_left moved

# --- one dies whenever it draws, one loses its context: the first is named and left for a while, the second comes back
timeout 300 "$program" sim --scene sheet.obj "${wall[@]}" --live --frames 1000000 --restarts 2 --frame-deadline 2 \
    --report "dies-$$.json" --tile-fault die:1@10 --tile-fault context:3@20 >dies.out 2>dies.log &
launcher=$!
wait_for dies.log "tile c1r0 was started again 2 times within a minute"
wait_for dies.log "tile c0r1 keeps up again"
kill -INT $launcher
wait $launcher
is "it always dies: it was started twice" "$(grep -c "tile c1r0 is started again" dies.log) $(tile "dies-$$.json" 1 state)" \
    "2 lost"
has "its context was lost: by name" "$(grep "tile c0r1 (rank 3) is lost" dies.log)" "the GL context was lost"
is "its context was lost: it came back" "$(tile "dies-$$.json" 3 lost) $(tile "dies-$$.json" 3 returned)" "1 1"
nothing_is_left dies

# --- the wall ends while a tile comes back
endings() { # NAME WHAT: ends it when c1r0 has been started again and has not spoken yet
    timeout 300 "$program" sim --scene sheet.obj "${wall[@]}" --live --frames 1000000 --report "$1-$$.json" >"$1.out" 2>"$1.log" &
    launcher=$!
    wait_for "$1.log" "tiles that are started again come in at"
    wait_for "$1.log" "frame "
    kill -KILL "$(pid_of "$1.log" 1)"
    wait_for "$1.log" "tile c1r0 is started again"
    case $2 in
    interrupt)
        kill -INT $launcher
        sleep 0.5
        kill -INT $launcher 2>/dev/null
        ;;
    launcher) kill -KILL "$(pgrep -P $launcher -f gazewall)" ;;
    rank) kill -KILL "$(pid_of "$1.log" 0)" ;;
    esac
    wait $launcher 2>/dev/null
    nothing_is_left "$1"
}
endings interrupted interrupt
endings orphaned launcher
endings headless rank
is "no shared memory is left" "$(find /dev/shm -name 'gazewall-*' -user "$(id -u)" 2>/dev/null | sort)" "$segments"
expect "restarts without --live" 2 "--restarts goes with --live" sim --scene sheet.obj --restarts 2
finish
