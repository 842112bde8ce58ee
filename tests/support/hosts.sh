# Several machines on one, sourced by tests after tap.sh: network namespaces on a bridge, each with a host name, process
# numbers, shared memory and a home of its own, and an agent that starts programs there in place of ssh. Everything is
# made inside namespaces of the test itself, so nothing of it is left when the test ends, however that happens.
# shellcheck shell=bash disable=SC2154

# with_hosts: runs this script again inside, as root there; where that is not possible all tests are skipped by name.
with_hosts() {
    [ -n "${GW_HOSTS_INSIDE:-}" ] && return
    local tool isolate=(unshare --mount --net --uts --ipc --pid --fork --kill-child --mount-proc)
    for tool in ip unshare nsenter; do
        command -v $tool >/dev/null || skip_all "there is no $tool"
    done
    [ "$(id -u)" -eq 0 ] || isolate+=(--user --map-root-user)
    "${isolate[@]}" ip link add gw-probe type veth peer name gw-other 2>/dev/null ||
        skip_all "namespaces of networks cannot be made here"
    GW_HOSTS_INSIDE=1 exec "${isolate[@]}" bash "$0" "$@"
}

skip_all() {
    echo "1..0 # SKIP $1"
    exit 0
}

# make_hosts NAME...: this machine is "head", 10.77.0.1; the others follow, 10.77.0.2 and up. $agent starts programs.
make_hosts() {
    local name address=1
    mount --make-rprivate /
    mount -t tmpfs tmpfs /dev/shm
    hostname head
    ip link set lo up
    ip link add wall type bridge
    ip addr add 10.77.0.1/24 dev wall
    ip link set wall up
    printf '127.0.0.1 localhost\n10.77.0.1 head\n' >"$folder/hosts"
    for name in "$@"; do
        address=$((address + 1))
        make_host "$name" 10.77.0.$address
        printf '10.77.0.%s %s\n' $address "$name" >>"$folder/hosts"
    done
    mount --bind "$folder/hosts" /etc/hosts
    agent=$folder/agent
    cat >"$agent" <<AGENT
#!/bin/bash
host=\$1
shift
grep -q "^\$host\\$" "$folder/dead" 2>/dev/null && { echo "ssh: connect to host \$host port 22: No route to host" >&2; exit 255; }
exec nsenter --target "\$(cat "$folder/\$host.pid")" --net --uts --ipc --mount --pid env HOME="$folder/\$host.home" \\
    XDG_CACHE_HOME="$folder/\$host.home/cache" TMPDIR="$folder/\$host.home" sh -c "\$*"
AGENT
    chmod +x "$agent"
}

make_host() { # NAME ADDRESS
    local process
    mkdir -p "$folder/$1.home"
    unshare --net --uts --ipc --mount --pid --fork --kill-child --mount-proc sleep 3600 >/dev/null 2>&1 &
    # The namespaces are those of unshare's child.
    until process=$(pgrep -P $!) && [ -n "$process" ]; do sleep 0.02; done
    echo "$process" >"$folder/$1.pid"
    ip link add "$1" type veth peer name eth0 netns "$process"
    ip link set "$1" master wall
    ip link set "$1" up
    nsenter --target "$process" --net --uts --mount sh -c "hostname $1; mount -t tmpfs tmpfs /dev/shm; ip link set lo up
        ip addr add $2/24 dev eth0; ip link set eth0 up"
}

on_host() { # NAME COMMAND...: as root there, the arguments as they are
    local name=$1
    shift
    nsenter --target "$(cat "$folder/$name.pid")" --net --uts --ipc --mount --pid "$@"
}
