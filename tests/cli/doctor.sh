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

# --- trackers: a server of one connection says what it is told to
tracker() { # NAME CODE TEXT GREETING
    python3 - "$4" >port <<'P' &
import socket, sys, time
server = socket.create_server(("127.0.0.1", 0))
print(server.getsockname()[1], flush=True)
client, _ = server.accept()
client.sendall(sys.argv[1].encode().decode("unicode_escape").encode("latin-1"))
time.sleep(0.5)
P
    local server=$! turn
    for turn in $(seq 100); do
        [ -s port ] && break
        sleep 0.05
    done
    [ -s port ] || echo "# no server after $((turn / 20)) s"
    site tracker "tracker: Tracker0@127.0.0.1:$(cat port)"
    if [ "$2" -eq 0 ]; then
        expect "$1" 0 "$3" doctor tracker.yaml
    else
        findings "$1" "$2" "$3" tracker.yaml
    fi
    kill $server 2>/dev/null
    wait $server 2>/dev/null
}

tracker "a VRPN server" 0 "speaks VRPN 07.38" 'vrpn: ver. 07.38  0\0\0\0\0\0'
tracker "an older one of its version" 0 "speaks VRPN 07.30" 'vrpn: ver. 07.30  0\0\0\0\0\0'
tracker "one of another version" 3 "speaks VRPN 08.00, not 07" 'vrpn: ver. 08.00  0\0\0\0\0\0'
tracker "another server" 3 "another program listens there" 'SSH-2.0-OpenSSH_9.2p1 Debian-2\r\n'
tracker "one that says little" 3 "gave no VRPN greeting" 'vrpn'
site nobody "tracker: Tracker0@127.0.0.1:$(cat port)"
findings "nobody" 3 "is closed: start the VRPN server" nobody.yaml
site odd-tracker "tracker: somewhere"
findings "neither file nor server" 2 "neither a file nor a VRPN server" odd-tracker.yaml
finish
