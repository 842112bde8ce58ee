#!/bin/bash
# sim --serve: eyes and gazes of a wall that runs, read by VRPN clients by TCP and by datagrams; the doctor is the client.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1

ask() { # NAME SOURCE TEXT
    printf 'version: 1\ngrid: {columns: 1, rows: 1, tile: {width: 1000, height: 600, pixels: [40, 24]}}\ntracker: "%s"\n' "$2" >site.yaml
    expect "$1" 0 "$3" doctor site.yaml
}

"$program" sim --scene sheet.obj --set octree_depth=4 --tiles 2x1 --size 32x16 --frames 1000000 --step 0.01 --log info \
    --out pictures --serve vrpn:127.0.0.1:0 --report report.json >out 2>log &
wall=$!
for _ in $(seq 600); do
    [ -e pictures/wall-0001.png ] && break
    sleep 0.1
done
port=$(sed -n 's/.*serving VRPN device Tracker0 on port //p' log)
ask "by TCP" "Tracker0@127.0.0.1:$port" "reports sensors 0 1"
ask "by datagrams" "vrpn+udp:Tracker0@127.0.0.1:$port" "reports sensors 0 1"
kill -INT $wall
wait $wall
is "the wall ends well" $? 130
is "clients that came" "$(json report.json '["tracking"]["served"]["clients"]')" 2
is "none was slow, refused or talked nonsense" "$(json report.json '["tracking"]["served"]' |
    python3 -c 'import ast, sys
s = ast.literal_eval(sys.stdin.read())
print(s["slow"], s["refused"], s["malformed"], s["unreachable"], s["messages"] > 100)')" "0 0 0 0 True"

expect "another protocol" 2 "is no server" sim --serve opentrack:4242
finish
