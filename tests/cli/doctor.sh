#!/bin/bash
# gazewall doctor on one machine: wrong sites, names that do not resolve, hosts without an ssh server, displays that are
# not there, and trackers: each its own message. What several hosts need is in tests/mpi/doctor_hosts.sh.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
cd "$folder" || exit 1

site() { # NAME LINE...: a site file of one tile with further lines
    local name=$1
    shift
    printf 'version: 1\ngrid: {columns: 1, rows: 1, tile: {width: 1000, height: 600, pixels: [40, 24]}}\n' >"$name.yaml"
    printf '%s\n' "$@" >>"$name.yaml"
}

expect "no site" 2 "name a site file" doctor
expect "two sites" 2 "one site at a time" doctor a.yaml b.yaml
expect "a site that is not there" 2 "nowhere.yaml" doctor nowhere.yaml
site odd 'hots: []'
expect "a site that is wrong" 2 "hosts" doctor odd.yaml

site good
expect "this machine" 0 "knows --enable-recovery" doctor good.yaml
has "its first GPU" "$("$program" doctor good.yaml)" "first GPU: "
has "the sum" "$("$program" doctor good.yaml)" " 0 wrong"

findings() { # NAME CODE TEXT SITE ARGUMENT...: exit code, and a part of the one wrong finding
    local name=$1 code=$2 text=$3 output got
    shift 3
    output=$(timeout 120 "$program" doctor "$@" 2>&1)
    got=$?
    [ $got -eq "$code" ] && grep '^WRONG' <<<"$output" | grep -qF -- "$text"
    verdict "$name" $? <<<"exit $got, wanted $code and \"$text\" in: $output"
}

site name 'panel: {host: no-such-host.invalid}'
findings "a name that does not resolve" 2 "its name does not resolve" name.yaml
site closed 'panel: {host: 127.9.9.9}'
findings "an agent that is not there" 3 "is no command here" closed.yaml --agent "$folder/nowhere"
printf '#!/bin/sh\necho "Permission denied (publickey)." >&2\nexit 255\n' >denied
printf '#!/bin/sh\nshift\nexec sh -c "/nowhere/gazewall examine"\n' >absent
printf '#!/bin/sh\nshift\necho "Welcome to the lab"\nexec sh -c "$*"\n' >chatty
chmod +x denied absent chatty
findings "an agent that may not" 3 "Permission denied (publickey)." closed.yaml --agent "$folder/denied"
findings "no program there" 3 "install the same gazewall there" closed.yaml --agent "$folder/absent"
expect "an agent that chats" 0 "'$folder/chatty' starts programs there" doctor closed.yaml --agent "$folder/chatty"
site display 'panel: {display: ":4077"}'
findings "a display that is not there" 3 "tile c0r0 on display :4077" display.yaml
site gpu 'panel: {gpu: 15}'
findings "a GPU that is not there" 3 "GPU 15" gpu.yaml

# --- trackers: all at once, for each is listened to for some seconds
# A server that says what it is told to; with a VRPN greeting it goes on as one with the device Tracker0.
cat >server.py <<'P'
import socket, struct, sys, time
server = socket.create_server(("127.0.0.1", 0))
print(server.getsockname()[1], flush=True)
def message(kind, sender, payload):
    now = time.time()
    head = struct.pack(">6i", 24 + len(payload), int(now), int(now % 1 * 1e6), sender, kind, 0)
    return head + payload + bytes(-len(payload) % 8)
def name(text):
    return struct.pack(">i", len(text) + 1) + text + b"\0"
while True:
    client, _ = server.accept()
    try:
        client.sendall(sys.argv[1].encode().decode("unicode_escape").encode("latin-1"))
        if not sys.argv[1].startswith("vrpn: ver. 07"):
            time.sleep(0.5)
            continue
        client.sendall(message(-1, 0, name(b"Tracker0")) + message(-2, 0, name(b"vrpn_Tracker Pos_Quat")))
        while True:
            client.sendall(message(0, 0, struct.pack(">2i7d", 2, 0, 0, 0, 1, 0, 0, 0, 1)))
            time.sleep(0.02)
    except OSError:
        pass
P
# Datagrams with that text to a port that it finds free.
cat >sender.py <<'P'
import socket, sys, time
found = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
found.bind(("127.0.0.1", 0))
to = found.getsockname()
found.close()
print(to[1], flush=True)
out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
while True:
    for turn in range(1200 if sys.argv[1] else 0):
        out.sendto((sys.argv[1] % turn).encode().decode("unicode_escape").encode(), to)
        time.sleep(0.05)
    time.sleep(1)
P

started=() names=() codes=() texts=() peers=()
tracker() { # NAME CODE TEXT SOURCE [SCRIPT TEXT]: PORT in the source is the one that the script prints
    local number=${#names[@]} source=$4 turn
    names+=("$1") codes+=("$2") texts+=("$3")
    if [ $# -gt 4 ]; then
        python3 "$5.py" "$6" >"port$number" &
        peers+=($!)
        for turn in $(seq 200); do
            [ -s "port$number" ] && break
            sleep 0.05
        done
        [ -s "port$number" ] || echo "# no peer after $((turn / 20)) s"
        source=${source/PORT/$(cat "port$number")}
    fi
    site "tracker$number" "tracker: \"$source\""
    (
        timeout 120 "$program" doctor "tracker$number.yaml" >"tracker$number.out" 2>&1
        echo $? >"tracker$number.code"
    ) &
    started+=($!)
}

seven='vrpn: ver. 07.38  0\0\0\0\0\0'
tracker "a VRPN server" 0 "speaks VRPN 07.38, reports sensors 2: the first after " Tracker0@127.0.0.1:PORT server "$seven"
tracker "its clock" 0 "its clock and the way differ" vrpn:Tracker0@localhost:PORT server "$seven"
tracker "an older one of its version" 0 "speaks VRPN 07.30" Tracker0@tcp://127.0.0.1:PORT server "${seven/38/30}"
tracker "a server without that device" 2 "has no such device; it has: Tracker0" Wand@127.0.0.1:PORT server "$seven"
tracker "one of another version" 3 "speaks version 08.00, not 07" Tracker0@127.0.0.1:PORT server "${seven/07.38/08.00}"
tracker "another server" 3 "another program listens there" Tracker0@127.0.0.1:PORT server 'SSH-2.0-OpenSSH_9.2p1 Debian-2\r\n'
tracker "one that says little" 3 "gave no VRPN greeting" Tracker0@127.0.0.1:PORT server vrpn
tracker "nobody" 3 "is closed: start the VRPN server" Tracker0@127.0.0.1:9
tracker "nobody who would call back" 3 "by TCP (vrpn: instead of vrpn+udp:) firewalls are kinder" vrpn+udp:Tracker0@127.0.0.1:9
tracker "a server's name that does not resolve" 2 "the host's name does not resolve" Tracker0@no-such-host.invalid
tracker "neither file nor server" 2 "neither a file nor a tracking source" somewhere
tracker "a port that no datagram comes to" 3 "no datagram in 4 s at 0.0.0.0:" dtrack:PORT sender ''
tracker "a port that something else comes to" 3 "is another protocol" gaze:PORT sender 'hello %d'
tracker "a port that frames come to" 0 "reports sensors 4" dtrack:PORT sender 'fr %d\r\n6d 1 [4 1.0][1 2 3][1 0 0 0 1 0 0 0 1]\r\n'
wait "${started[@]}"
kill "${peers[@]}"
wait "${peers[@]}" 2>/dev/null
for i in "${!names[@]}"; do
    [ "$(cat "tracker$i.code")" -eq "${codes[i]}" ] && grep '  tracker  ' "tracker$i.out" | grep -qF -- "${texts[i]}"
    verdict "${names[i]}" $? <<<"exit $(cat "tracker$i.code"), wanted ${codes[i]} and \"${texts[i]}\" in: $(cat "tracker$i.out")"
done
finish
