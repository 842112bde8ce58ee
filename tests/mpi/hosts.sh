#!/bin/bash
# A wall on three machines, namespaces with networks, process numbers, shared memory and folders of their own: the same
# pixels as on one; a killed rank, a cut link, garbage on the port and another program on a host are told by name;
# nothing is left behind, whatever ended the run.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
# shellcheck source=tests/support/hosts.sh
. "$(dirname "$0")/../support/hosts.sh"
with_hosts "$@"
make_hosts wall2 wall3
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1
export HOME=$folder/head.home XDG_CACHE_HOME=$folder/head.home/cache TMPDIR=$folder/head.home GAZEWALL_AGENT=$agent
mkdir -p head.home
# The hosts' tiles stand between each other: rank i owns tile i all the same.
cat >site.yaml <<'Y'
version: 1
eye: [0, 0, 2500]
grid:
  columns: 4
  rows: 1
  tile: {width: 1000, height: 600, pixels: [40, 24]}
  bezel: {left: 4, right: 4, top: 4, bottom: 4}
hosts:
  - {name: wall2, tiles: [c1r0, c3r0]}
  - {name: wall3, tiles: [c2r0]}
Y
common=(--site site.yaml --scene sheet.obj --set octree_depth=5)

wall() { # NAME ARGUMENT...
    local name=$1
    shift
    timeout 300 "$program" wall "${common[@]}" --log debug --report "$name.json" "$@" >"$name.out" 2>"$name.log"
    local code=$?
    [ $code -eq "${wanted:-0}" ] || sed 's/^/# /' "$name.log" | tail -20
    is "$name: exit code" $code "${wanted:-0}"
}

start() { # NAME ARGUMENT...: without an end, until frame 3 is there
    local name=$1 turn
    shift
    timeout 300 "$program" wall "${common[@]}" --log debug --report "$name.json" --out "$name" "$@" >"$name.out" 2>"$name.log" &
    launcher=$!
    for turn in $(seq 900); do
        [ -s "$name/wall-0003.png" ] && return
        kill -0 $launcher 2>/dev/null || break
        sleep 0.1
    done
    sed 's/^/# /' "$name.log" | tail
    echo "# $name did not come to frame 3 in $((turn / 10)) s"
}

wait_for_line() { # FILE TEXT: until the text is in the file
    local turn
    for turn in $(seq 600); do
        grep -q "$2" "$1" && return
        sleep 0.1
    done
    echo "# '$2' did not come into $1 in $((turn / 10)) s"
}

rows() { # NAME COUNT: until so many frames more are drawn
    local turn wanted
    [ -e "$1/frames.csv" ] || return
    wanted=$(($(wc -l <"$1/frames.csv") + $2))
    for turn in $(seq 600); do
        [ "$(wc -l <"$1/frames.csv")" -ge $wanted ] && return
        sleep 0.1
    done
    echo "# $1 did not go on by $2 frames in $((turn / 10)) s"
}

processes() {
    pgrep -f "gazewall rank |orted |mpirun " | wc -l
}

nothing_is_left() { # NAME
    local turn
    for turn in $(seq 150); do
        [ "$(processes)" -eq 0 ] && break
        sleep 0.1
    done
    is "$1: no process is left after $((turn / 10)) s" "$(pgrep -af "gazewall rank |orted |mpirun " | cut -c 1-100)" ""
    is "$1: no session folder here" "$(find head.home -maxdepth 2 -name 'pid.*')" ""
    is "$1: no shared memory" "$(find /dev/shm -type f; on_host wall2 find /dev/shm -type f; on_host wall3 find /dev/shm -type f)" ""
}

# --- what would be started
dry=$("$program" wall "${common[@]}" --frames 2 --dry-run)
has "dry run: the tiles of a host, in their order" "$dry" "-host wall2 -np 1"
has "dry run: a network" "$dry" "self,vader,tcp"
has "dry run: of these machines only" "$dry" "btl_tcp_if_include 10.77.0.0/24"
has "dry run: the agent" "$dry" "plm_rsh_agent $agent"
is "dry run: neither secret nor line" "$(grep -c -e --link -e SECRET <<<"$dry")" 0

# --- the same pixels as on one machine; nothing is shared but what goes over the network
for host in wall2 wall3; do
    mkdir -p one
    on_host $host mount -t tmpfs tmpfs "$folder/one"
done
is "one machine" "$("$program" sim "${common[@]}" --frames 2 --report sim.json --quiet && echo drawn)" drawn
wall one --frames 2 --out one
is "three machines: the pixels of one" "$(json one.json '["image"]["hash"]')" "$(json sim.json '["image"]["hash"]')"
is "three machines: the command" "$(json one.json '["command"]' | cut -c 1-27)" "gazewall wall --site site.y"
is "pictures of all tiles in one place" "$(find one -name 'tile-*-000[01].png' | wc -l)" 8
is "and not in two" "$(on_host wall2 find "$folder/one" -type f | wc -l)" 0
for tile in 1 2 3; do
    has "tile c${tile}r0 is on its host" "$(cat one.log)" "rank $tile (tile c${tile}r0) is process"
done
has "by name" "$(grep 'rank 2 (tile c2r0)' one.log)" "on wall3"
is "each host keeps what it was sent" "$(find wall2.home wall3.home -name 'block-*.gwb' | wc -l)" 4
nothing_is_left "three machines"
# A profile that only this machine has comes with the command.
mkdir -p own
printf 'profile: mine\nabout: "it'"'"'s \\"mine\\""\nsettings:\n  tau: 3\n  samples: 2\n' >own/mine.yaml
for host in wall2 wall3; do
    on_host $host mount -t tmpfs tmpfs "$folder/own"
done
is "one machine with a profile" "$("$program" sim "${common[@]}" --frames 1 --profile own/mine.yaml --report sim.json --quiet && echo drawn)" drawn
wall profiled --frames 1 --profile own/mine.yaml
is "a profile that the hosts have not: the same pixels" "$(json profiled.json '["image"]["hash"]')" "$(json sim.json '["image"]["hash"]')"
is "which it changes" "$([ "$(json profiled.json '["image"]["hash"]')" = "$(json one.json '["image"]["hash"]')" ] || echo changed)" changed
is "and the report has it" "$(json profiled.json '["profile"]["name"]') $(json profiled.json '["profile"]["file"]')" "mine own/mine.yaml"
is "the command is the user's" "$(json profiled.json '["command"]' | grep -c profile-text)" 0

wall two --frames 1
has "the second time nothing is sent" "$(cat two.log)" "every machine has kept it"
sh -c "$dry" >dry.out 2>dry.log &
paste=$!
wait_for_line dry.out "look at\|error  "
has "the dry run's command draws by itself" "$(cat dry.out)" "frames   2"
kill $paste 2>/dev/null
wait $paste 2>/dev/null
pkill -f "^mpirun " # all processes that are seen here are this test's own
nothing_is_left "the dry run's command"

# --- garbage on the port, and a killed rank: the wall goes on, and Ctrl-C is its end
start killed
port=$(tr '\0' '\n' <"/proc/$(pgrep -f 'gazewall rank .*--link=tcp' | head -1)/cmdline" | sed -n 's/--link=tcp:10.77.0.1://p')
on_host wall3 bash -c "head -c 4000 /dev/urandom >/dev/tcp/10.77.0.1/$port; exec 3<>/dev/tcp/10.77.0.1/$port; echo 'GET / HTTP/1.0' >&3; sleep 0.5" 2>/dev/null
wait_for_line killed.log "was dropped"
has "garbage: it is told" "$(cat killed.log)" "a connection from 10.77.0.3 was dropped: what it sent is no message of a rank"
on_host wall3 pkill -KILL -f "gazewall rank"
wait_for_line killed.log "died on the way"
rows killed 4
kill -INT "$(pgrep -P $launcher -f gazewall)"
wait $launcher
is "killed: exit code" $? 130
has "killed: the launcher names it" "$(cat killed.log)" "(tile c2r0 on wall3, process"
is "killed: the report knows it" "$(json killed.json '["tiles"][2]["state"]') $(json killed.json '["tiles"][1]["state"]')" "lost live"
is "killed: the report is whole" "$(json killed.json '["ended"]')" interrupted
nothing_is_left "killed"

# --- live: a killed rank of another host is started again there, over the network and from its own cache
start again --live --frame-deadline 5 --death-deadline 60
on_host wall3 pkill -KILL -f "gazewall rank"
wait_for_line again.log "tile c2r0 keeps up again"
rows again 4
has "again: on its own host" "$(cat again.log)" "tile c2r0 is started again on wall3"
on_host wall3 sh -c "cat /proc/[0-9]*/cmdline" 2>/dev/null | tr '\0' '\n' >words
is "again: rank 0's door is on the wall's network" "$(grep -c -- '--rejoin=2:1:10.77.0.1:' words)" 1
is "again: the secret stands in no command line" \
    "$(cat /proc/[0-9]*/cmdline words 2>/dev/null | grep -c -f <(tr '\0' '\n' <"/proc/$(pgrep -o -f 'gazewall rank')/environ" |
        sed -n 's/^GAZEWALL_SECRET=//p'))" 0
kill -INT "$(pgrep -P $launcher -f gazewall)"
wait $launcher
is "again: exit code" $? 130
is "again: the report knows it" "$(json again.json '["tiles"][2]["returned"]') $(json again.json '["tiles"][2]["state"]')" "1 live"
nothing_is_left "again"

# --- a cut link
start cut --death-deadline 1
ip link set wall3 down
wait_for_line cut.log "tile c2r0 (rank 2) is lost"
rows cut 4
kill -INT "$(pgrep -P $launcher -f gazewall)"
wait $launcher
is "cut: exit code" $? 130
is "cut: the report knows it" "$(json cut.json '["tiles"][2]["state"]') $(json cut.json '["tiles"][3]["state"]')" "lost live"
ip link set wall3 up
for _ in $(seq 100); do # a port that nobody listens at is refused: the way is open again
    on_host wall3 timeout 0.2 bash -c ': >/dev/tcp/10.77.0.1/9' 2>&1 | grep -q refused && break
done
nothing_is_left "cut"

# --- what is killed: the launcher, mpirun, rank 0
start launcher
kill -KILL "$(pgrep -P $launcher -f gazewall)"
wait $launcher 2>/dev/null
nothing_is_left "launcher killed"
start mpirun
pkill -KILL -f "^mpirun "
wait $launcher
is "mpirun killed: exit code" $? 4
nothing_is_left "mpirun killed"
start first
pkill -KILL -f "^$program rank --verb=wall --link=gazewall"
wait $launcher
is "rank 0 killed: exit code" $? 4
has "rank 0 killed: it is told" "$(cat first.log)" "rank 0 (tile c0r0, process"
nothing_is_left "rank 0 killed"

# --- another program on one host
cp "$program" other
echo >>other
on_host wall3 mount --bind "$folder/other" "$program"
wanted=3 wall other --frames 1
has "another program: whose it is" "$(cat other.log)" "tile c2r0 on wall3"
has "another program: what to do" "$(cat other.log)" "install the same gazewall on both"
nothing_is_left "another program"

# --- a host that cannot be reached
echo wall3 >dead
wanted=3 wall unreachable --frames 1
has "unreachable: why" "$(cat unreachable.log)" "No route to host"
nothing_is_left "unreachable"
finish
