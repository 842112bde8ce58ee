#!/bin/bash
# Broken files and command lines, each with its exit code and its one sentence. Table-driven: see the table at the end.
# A row makes its file with a function below (or none), runs the binary, and wants: the code, exactly one line on
# standard error that begins with "gazewall", the fragment in that line, nothing on standard output, and no import child
# left behind.
set -u
cd "$(dirname "$0")/../.." || exit 1
gazewall=${GAZEWALL:-$PWD/out/gazewall}
data=$PWD/tests/data
folder=${GW_TEST_FOLDER:-$(mktemp -d)}/broken
mkdir -p "$folder"
cd "$folder" || exit 1

# --- makers: each writes the file named by its first argument into the present folder ---
nothing() { :; }
empty() { : >"$1"; }
folder_named() { mkdir -p "$1"; }
text() { printf '%b' "$2" >"$1"; }
cut_to() { head -c "$3" "$data/$2" >"$1"; }
with() { sed "$3" "$data/$2" >"$1"; }         # a changed text model
fifo() { rm -f "$1" && mkfifo "$1"; }
packed_cut() { gzip -9 <"$data/tetra.ply" | head -c 100 >"$1"; }
packed_garbage() { printf 'this is not gzip' >"$1"; }
bomb() { # 64 MiB of zeros in 64 KiB, many times over
    head -c 67108864 /dev/zero | gzip -9 >member
    for _ in $(seq 20); do cat member; done >"$1"
    rm member
}
obj_with() { # NAME MTL: a box that uses it, and the MTL
    cp "$data/box.obj" "$1"
    printf '%b' "$2" >box.mtl
    cp "$data/mask.png" .
}
obj_picture() { # NAME BYTES: the box with a cut picture
    obj_with "$1" 'newmtl wood\nmap_Kd checker.png\n'
    head -c "$2" "$data/checker.png" >checker.png
}
stl_nan() { # every coordinate is not a number
    { printf '%-80s' stl; printf '\1\0\0\0'; for _ in $(seq 12); do printf '\0\0\300\177'; done; printf '\0\0'; } >"$1"
}
glb_length() { # NAME: the header promises more than there is
    { printf 'glTF\2\0\0\0\377\377\0\0'; tail -c +13 "$data/poster.glb"; } >"$1"
}
glb_chunk() { { head -c 12 "$data/poster.glb"; printf '\377\377\377\177JSON'; tail -c +21 "$data/poster.glb"; } >"$1"; }
glb_version() { { printf 'glTF\1\0\0\0'; tail -c +9 "$data/poster.glb"; } >"$1"; }
scene_of() { printf 'version: 1\nmodels:\n  - file: %s\n' "$2" >"$1"; }

printf '%s/' "$folder" >pattern # in a file, so that the search does not find itself
number=0
failures=0
result() { # OK NAME WHY
    number=$((number + 1))
    if [ "$1" = 1 ]; then
        echo "ok $number - $2"
    else
        echo "not ok $number - $2"
        printf '# %s\n' "$3"
        failures=$((failures + 1))
    fi
}

# check CODE FRAGMENT ARGUMENT...
check() {
    local want=$1 fragment=$2 name code lines
    shift 2
    name="$* -> $want: $fragment"
    timeout -k 5 100 "$gazewall" "$@" >stdout 2>stderr </dev/null
    code=$?
    lines=$(wc -l <stderr)
    if [ "$code" -ne "$want" ]; then
        result 0 "$name" "exit code $code: $(head -c 400 stderr)"
    elif [ "$lines" -ne 1 ] || ! grep -q '^gazewall' stderr; then
        result 0 "$name" "not one line of gazewall's: $(head -c 400 stderr)"
    elif ! grep -qF -- "$fragment" stderr; then
        result 0 "$name" "it said: $(cat stderr)"
    elif [ -s stdout ]; then
        result 0 "$name" "standard output: $(head -c 200 stdout)"
    elif grep -qszFf pattern /proc/[0-9]*/cmdline; then
        result 0 "$name" "an import child is left behind"
    else
        result 1 "$name"
    fi
}

# file NAME FRAGMENT MAKER ARGUMENT...: the maker gets NAME first.
file() {
    local name=$1 fragment=$2 maker=$3
    shift 3
    "$maker" "$name" "$@"
    check 2 "$fragment" inspect --quiet "$folder/$name"
}

# --- the table ---
# name             fragment                                       maker         its arguments
file absent.ply    'cannot be opened: No such file'               nothing
file folder.ply    'this is a folder'                             folder_named
file pipe.ply      'not a regular file'                           fifo
file empty.ply     'the file is empty'                            empty
file empty.obj     'the file is empty'                            empty
file empty.gltf    'the file is empty'                            empty
file model.xyz     'known are .gltf, .glb, .obj'                  text          'anything'
file model         'the format is not known by this name'         text          'anything'
file model.glb.gz  'the format is not known by this name'         text          'anything'
file no.ply        "does not begin with 'ply'"                    text          'solid\n'
file header.ply    "'end_header' is missing"                      cut_to        tetra_binary.ply 120
file header60.ply  "'end_header' is missing"                      cut_to        tetra_binary.ply 60
file body.ply      "rows are promised, it ends in row 2"          cut_to        tetra_binary.ply 235
file vertex.ply    "4 'vertex' rows are promised"                 cut_to        tetra_binary.ply 190
file ascii.ply     '8 rows are promised, 5 are there'             cut_to        tetra.ply 310
file type.ply      'unknown property type'                        with          tetra.ply 's/float x/quad x/'
file huge.ply      'broken or one too many element'               with          tetra.ply 's/vertex 4/vertex 99999999999/'
file points.ply    'nothing is left to draw'                      with          tetra.ply 's/face 4/face 0/; /^3 /d'
file flat.ply      '4 with a repeated vertex'                     with          tetra.ply 's/^\([0-9]\) [0-9] [0-9]/\1 0 0/; s/^3 0 0/3 1 2/'
file cut.ply.gz    'compressed data is cut short'                 packed_cut
file bad.ply.gz    'compressed data is broken'                    packed_garbage
file bomb.ply.gz   'expands to more than the limit'               bomb
file cut.stl       'its header promises 4 triangles'              cut_to        tetra.stl 200
file tiny.stl      'less than a header'                           cut_to        tetra.stl 30
file ascii.stl     "'endsolid' is missing"                        text          'solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n'
file nan.stl       '1 with a position that is not finite'         stl_nan
file no.off        "does not begin with 'OFF'"                    text          'PLY\n1 2 3\n'
file counts.off    'its counts are missing'                       text          'OFF\nfour\n'
file cut.off       'rows are promised'                            cut_to        tetra.off 50
file wide.obj      'holds zero bytes'                             text          'v\0000 0 0 1\n'
file index.obj     'it cannot be read'                            text          'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n'
file points.obj    'points and lines'                             text          'v 0 0 0\nv 1 0 0\nv 0 1 0\np 1\np 2\nl 1 2\n'
file picture.obj   "material 'wood'"                              obj_with      'newmtl wood\nmap_Kd not_there.png\n'
file picture2.obj  'not_there.png'                                obj_with      'newmtl wood\nmap_Kd not_there.png\n'
file climb.obj     'more than one folder up'                      obj_with      'newmtl wood\nmap_Kd ../../secret.png\n'
file root.obj      "absolute path '/secret.png'"                  obj_with      'newmtl wood\nmap_Kd /secret.png\n'
file corrupt.obj   'checker.png'                                  obj_picture   60
file nopng.obj     'checker.png'                                  obj_picture   4
file no.gltf       "neither with '{' nor with 'glTF'"             text          'hello\n'
file syntax.gltf   'the glTF text is broken at line 2'            text          '{\n"asset" "version"}'
file old.gltf      "glTF version '1.0' is not supported"          text          '{"asset":{"version":"1.0"}}'
file bin.gltf      "gone.bin' is missing"                         with          poster.gltf 's|"uri": "[^"]*"|"uri": "gone.bin"|'
file short.gltf    'is cut'                                       with          poster.gltf 's|"byteLength": 232|"byteLength": 23200|'
file view.gltf     'bufferView 0 ends at byte'                    with          poster.gltf '0,/"byteLength": 48/s//"byteLength": 4800/'
file count.gltf    'accessor 3 needs 600'                         with          poster.gltf 's|"count": 6,|"count": 600,|'
file mesh.gltf     "'mesh' is 7"                                  with          poster.gltf '0,/"mesh": 0/s//"mesh": 7/'
file access.gltf   "'indices' is 44"                              with          poster.gltf 's/"indices": 3/"indices": 44/'
file circle.gltf   'in a circle'                                  with          poster.gltf 's/"name": "left",/"name": "left", "children": [0],/'
file req.gltf      "requires the glTF extension 'EXT_from_nowhere', which is unknown" with poster.gltf 's/"extensionsUsed"/"extensionsRequired": ["EXT_from_nowhere"], &/'
file draco.gltf    'KHR_draco_mesh_compression'                   with          poster.gltf 's/"extensionsUsed"/"extensionsRequired": ["KHR_draco_mesh_compression"], &/'
file cut.glb       'the .glb file is cut'                         cut_to        poster.glb 2000
file head.glb      'less than a header'                           cut_to        poster.glb 8
file length.glb    'its header promises 65535 bytes'              glb_length
file chunk.glb     'chunk 0 promises'                             glb_chunk
file version.glb   'glTF version 1 is not supported'              glb_version
file syntax.yaml   'syntax.yaml:2'                                text          'version: 1\n}{\n'
file key.yaml      "models"                                       text          'version: 1\nmodles: []\n'
file model.yaml    'absent.obj: the file cannot be opened'        scene_of      absent.obj
file cut.yaml      "'end_header' is missing"                      scene_of      header.ply
file nested.yaml   'scenes cannot contain scenes'                 scene_of      cut.yaml

# exit code, fragment, command line
while IFS='|' read -r code fragment arguments; do
    [ -n "$code" ] || continue
    read -ra words <<<"$arguments"
    check "$code" "$fragment" "${words[@]}"
done <<'COMMANDS'
2|unknown verb 'inspectt'; did you mean 'inspect'?|inspectt
2|unknown option '--bogus'|inspect --bogus
2|did you mean 'tau'?|render --quiet --set tua=1
2|tau|render --quiet --set tau=-1
2|tau|render --quiet --tau many
2|--size '0x10'|render --quiet --size 0x10
2|--size|render --quiet --size big
2|absent.ply|render --quiet --scene absent.ply --size 16x16
2|--tiles 'axb'|sim --quiet --tiles axb
2|absent.vrpn|sim --quiet --track absent.vrpn --frames 1
COMMANDS

[ -n "${GW_TEST_FOLDER:-}" ] || rm -rf "$(dirname "$folder")"
echo "1..$number"
[ $failures -eq 0 ]
