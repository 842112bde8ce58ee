# TAP for shell scripts, sourced by them: counts, compares, cleans up. Each script ends with `finish`.
# shellcheck shell=bash
set -u
# shellcheck disable=SC2034  # the scripts use it
program=$(realpath "${GAZEWALL:-out/gazewall}")
folder=${GW_TEST_FOLDER:-$(mktemp -d)}
number=0

# verdict NAME STATUS: status 0 is ok; text on standard input says what was found otherwise.
verdict() {
    number=$((number + 1))
    if [ "$2" -eq 0 ]; then
        echo "ok $number - $1"
        cat >/dev/null
    else
        echo "not ok $number - $1"
        sed 's/^/# /'
    fi
}

is() { # NAME GOT WANTED
    [ "$2" = "$3" ]
    verdict "$1" $? <<<"got \"$2\", wanted \"$3\""
}

has() { # NAME TEXT PART
    [[ $2 == *"$3"* ]]
    verdict "$1" $? <<<"wanted \"$3\" in: $2"
}

same_file() { # NAME GOT WANTED
    cmp -s "$2" "$3"
    verdict "$1" $? <<<"$2 and $3 differ: $(cmp "$2" "$3" 2>&1)"
}

# differing PATTERN FOLDER FOLDER: how many files of the first folder that match differ from those of that name in the second,
# and how many there are.
differing() {
    python3 -I -S -c 'import glob, os, sys
files = glob.glob(os.path.join(sys.argv[2], sys.argv[1]))
def read(path):
    try:
        return open(path, "rb").read()
    except OSError:
        return None
print(sum(read(f) != read(os.path.join(sys.argv[3], os.path.basename(f))) for f in files), len(files))' "$@"
}

exists() { # NAME FILE
    [ -e "$2" ]
    verdict "$1" $? <<<"there is no $2; there is: $(find "$(dirname "$2")" -maxdepth 1 -type f 2>&1 | tr '\n' ' ')"
}

# expect NAME CODE TEXT ARGUMENT...: runs the program; its exit code, and a part of what it prints on either stream.
# An error must be one sentence on standard error that names the program.
expect() {
    local name=$1 code=$2 text=$3 output errors got
    shift 3
    errors=$(timeout 120 "$program" "$@" 2>&1 >"$folder/.standard-output" </dev/null)
    got=$?
    output="$errors
$(cat "$folder/.standard-output")"
    [ "$got" -eq "$code" ] && [[ $output == *"$text"* ]] && { [ "$code" -eq 0 ] || [[ $errors == gazewall* ]]; }
    verdict "$name" $? <<<"exit $got, wanted $code; wanted \"$text\" in: $output"
}

# json FILE EXPRESSION: a value of a report, by python's rules for what follows the document.
json() {
    python3 -c 'import json, sys
print(eval("d" + sys.argv[2], {"d": json.load(open(sys.argv[1]))}))' "$1" "$2" 2>&1
}

# A small scene: a wavy sheet of 800 triangles in two colours before a square of two.
make_scene() { # FILE.obj
    printf 'newmtl red\nKd 0.8 0.2 0.1\nnewmtl blue\nKd 0.1 0.3 0.9\n' >"${1%.obj}.mtl"
    awk -v library="$(basename "${1%.obj}").mtl" 'BEGIN {
        print "mtllib " library
        for (y = 0; y <= 20; y++)
            for (x = 0; x <= 20; x++)
                printf "v %.4f %.4f %.4f\n", x / 10 - 1, y / 20 - 0.5, 0.2 * sin(x * 1.3) * cos(y * 0.9)
        print "v -2 -1 -1\nv 2 -1 -1\nv 2 1 -1\nv -2 1 -1\nusemtl red"
        for (y = 0; y < 20; y++)
            for (x = 0; x < 20; x++) {
                a = y * 21 + x + 1
                printf "f %d %d %d\nf %d %d %d\n", a, a + 1, a + 22, a, a + 22, a + 21
            }
        print "usemtl blue\nf 442 443 444\nf 442 444 445"
    }' >"$1"
}

finish() {
    echo "1..$number"
    [ -n "${GW_TEST_FOLDER:-}" ] || rm -rf "$folder"
}
