#!/bin/bash
# gazewall doctor on three machines, which are namespaces: all well; a host that drops what it gets, one whose link is
# cut, one without MPI, with another program, from which there is no way back or none to another host: each its own message.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
# shellcheck source=tests/support/hosts.sh
. "$(dirname "$0")/../support/hosts.sh"
with_hosts "$@"
make_hosts wall2 wall3
cd "$folder" || exit 1
export GAZEWALL_AGENT=$agent

site() { # HOST ADDRESS
    cat >"$1.yaml" <<Y
version: 1
grid: {columns: 3, rows: 1, tile: {width: 1000, height: 600, pixels: [40, 24]}}
hosts:
  - {name: wall2, tiles: [c1r0]}
  - {name: $2, tiles: [c2r0]}
Y
}

site good wall3
output=$("$program" doctor good.yaml)
is "all is well: exit code" $? 0
for finding in "wall2         its name resolves to 10.77.0.2" "wall3         the same program, hash" "wall3         the same MPI" \
    "wall2         it reaches this machine at 10.77.0.1" "hosts         each reaches each other (6 ways)" "wall3         its clock is " "wall2         it is there (port 22 is closed"; do
    has "all is well: $finding" "$output" "good   $finding"
done
is "all is well: an ssh agent would need an ssh server" "$("$program" doctor good.yaml --agent ssh | grep -c '^WRONG.*runs no ssh server')" 2

findings() { # NAME CODE TEXT SITE [HOW MANY]
    local got
    output=$(timeout 120 "$program" doctor --quiet "$4.yaml" 2>&1)
    got=$?
    [ $got -eq "$2" ] && [ "$(grep -c '^WRONG' <<<"$output")" -eq "${5:-1}" ] && grep '^WRONG' <<<"$output" | grep -qF -- "$3"
    verdict "$1" $? <<<"exit $got, wanted $2 and \"$3\" in ${5:-1} wrong findings of: $output"
}

# An address behind which all packets vanish, and one that nobody has.
ip neigh add 10.77.0.9 lladdr 02:00:00:00:00:09 dev wall nud permanent
site filtered 10.77.0.9
findings "filtered" 3 "no answer from 10.77.0.9 in 3 s" filtered
site nobody 10.99.0.1
findings "no route" 3 "no way to 10.99.0.1: Network is unreachable" nobody
ip link set wall3 down
ip neigh flush dev wall 2>/dev/null
findings "a cut link" 3 "wall3" good
ip link set wall3 up
sleep 1

orted=$(readlink -f "$(command -v orted)")
touch no-program
on_host wall3 mount --bind "$folder/no-program" "$orted"
findings "no MPI" 3 "there is no 'orted' in its PATH" good
on_host wall3 umount "$orted"
on_host wall3 ip rule add ipproto tcp sport 1024-65534 dport 1024-65534 unreachable
findings "no way back" 3 "from there this machine is not reached at 10.77.0.1" good
on_host wall3 ip rule del ipproto tcp sport 1024-65534 dport 1024-65534 unreachable
on_host wall3 ip route add unreachable 10.77.0.2
findings "no way between two hosts" 3 "from there wall2 is not reached at 10.77.0.2" good 2 # one for either end
on_host wall3 ip route del unreachable 10.77.0.2
cp "$program" other
echo >>other
on_host wall3 mount --bind "$folder/other" "$program"
findings "another program" 3 "another program: the executable there has hash" good
finish
