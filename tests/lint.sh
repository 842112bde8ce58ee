#!/bin/bash
# Static checks; changes nothing. `make lint` runs it with CC, FLAGS and the assemble tool:
#   CC=cc FLAGS='...' tests/lint.sh out/release/assemble [CHECK...]
# Checks: layout headers analysis rules shaders scripts (all when none is named). A tool that is not installed is an
# error: `make setup` installs them.
#
# Shaders are checked once per set of defines. Lines "// variants: A=1 B=2; C=1" in a .comp list the sets, separated by
# ";" (an empty one is allowed); without such a line the shader is checked as it stands.
set -u
cd "$(dirname "$0")/.." || exit 1

assemble=$1
shift
checks=${*:-layout headers analysis rules shaders scripts}
compiler=${CC:-cc}
problems=0

layers=(base tracking build render wall)
mapfile -t sources < <(find "${layers[@]}" tests shaders docs -name '*.c' | sort)
mapfile -t headers < <(find "${layers[@]}" tests -name '*.h' | sort)
mapfile -t shaders < <(find shaders -name '*.comp' -o -name '*.vert' -o -name '*.geom' -o -name '*.frag' -o -name '*.glsl' -o -name '*.h' | sort)
mapfile -t texts < <(find . \( -path ./.git -o -path ./out -o -name '*.png' -o -name '*.jpg' -o -name '*.vrpn' -o -name '*.gz' \) -prune -o -type f -print | sort)

need() {
    command -v "$1" >/dev/null && return
    echo "lint: $1 is not installed; make setup installs it"
    problems=$((problems + 1))
    return 1
}

# Names a broken rule once and shows the places.
report() {
    local rule=$1 places=$2
    [ -n "$places" ] || return 0
    echo "lint: $rule"
    printf '%s\n' "$places" | sed 's/^/    /' | head -n 40
    problems=$((problems + 1))
}

check_layout() {
    need clang-format || return
    report "layout differs from .clang-format; make format mends it" \
        "$(clang-format --dry-run -Werror "${sources[@]}" "${headers[@]}" 2>&1 | grep -E 'error:' | cut -d: -f1 | sort | uniq -c)"
}

check_headers() {
    local header out
    for header in "${headers[@]}"; do
        # shellcheck disable=SC2086  # flags are words
        out=$(printf '#include "%s"\nint gw_lint_unit;\n' "$header" | $compiler $FLAGS -Werror -fsyntax-only -x c - 2>&1)
        report "$header does not compile alone" "$out"
    done
}

check_analysis() {
    need cppcheck || return
    report "cppcheck" "$(cppcheck --quiet --std=c11 --enable=warning,performance,portability --inline-suppr -I. \
        -D_GNU_SOURCE -D__linux__ --library=tests/cppcheck.cfg --suppress=missingInclude \
        --suppress=missingIncludeSystem \
        --suppress=normalCheckLevelMaxBranches "${sources[@]}" 2>&1)"
}

guard_of() {
    echo "GW_$(echo "${1%.h}" | tr 'a-z/-' 'A-Z__')_H"
}

check_guards() {
    local header guard
    for header in "${headers[@]}"; do
        guard=$(guard_of "$header")
        grep -q "^#ifndef $guard\$" "$header" && grep -q "^#define $guard\$" "$header" || echo "$header: expected $guard"
    done
}

# The folders that a layer may include from.
check_layers() {
    local layer allowed
    while read -r layer allowed; do
        find "$layer" -name '*.[ch]' -exec grep -nHE '^#include "' {} + | grep -vE "\"($allowed)/"
    done <<'LAYERS'
base base
tracking base|tracking
build base|build|shaders/common
render base|build|render|shaders/common
LAYERS
}

# What lies at the top level and does not belong there, committed or not.
stray_entries() {
    find . -mindepth 1 -maxdepth 1 -printf '%f\n' | grep -vxE \
        'wall|render|build|tracking|shaders|configs|tests|base|docs|out|Makefile|README\.md|LICENSE|\.git|\.ci|\.gitignore|\.clang-format' |
        sort
}

# What reads from outside and is not in tests/fuzz/decoders.tsv, and what that list names and is not there.
check_decoders() {
    local list=tests/fuzz/decoders.tsv readers='gw_file_read\(|gw_yaml_(load|parse)\(|json_load|gzread|[^a-z_](f?gets|getline|s?scanf|fscanf|recv|recvfrom|recvmsg|read)\('
    local source reads fuzzer
    find "${layers[@]}" -name '*.c' -exec grep -lE "$readers" {} + | sort | while read -r source; do
        grep -q "^$source"$'\t' $list || echo "$source reads from outside and is not in $list"
    done
    while IFS=$'\t' read -r source reads fuzzer; do
        case $source in '#'*) continue ;; esac
        [ -f "$source" ] || echo "$list names $source, which is not there"
        case $fuzzer in
        '-: '?*) ;;
        *) [ -n "$reads" ] && [ -f "tests/fuzz/fuzz_$fuzzer.c" ] || echo "$list: $source has no fuzzer '$fuzzer' and no reason" ;;
        esac
    done <$list
}

check_rules() {
    local below_wall=(base tracking build render)
    report "unfinished work is marked" "$(grep -nHwE 'TO[D]O|FIX[M]E|X[X]X|HAC[K]' "${texts[@]}")"
    report "tabs or trailing blanks" "$(grep -nHP '\t|[ \t]+$' "${sources[@]}" "${headers[@]}" "${shaders[@]}")"
    report "the top level is fixed: code in its folders, what is made in out/" "$(stray_entries)"
    report "a path of one machine" "$(grep -nHE '/wor[k]/|/hom[e]/|/roo[t]/' "${texts[@]}")"
    report "only wall/ and the import child may print or end the program" \
        "$(find "${below_wall[@]}" -name '*.c' ! -name 'import_child*.c' -exec \
            grep -nHP '(?<![\w.>])(printf|puts|putchar|perror|exit|_exit|_Exit|abort|system)\s*\(|\b(stderr|stdout)\b' {} +)"
    report "a header's guard must be GW_FOLDER_FILE_H" "$(check_guards)"
    report "layers are one-way: base <- tracking, build <- render <- wall" "$(check_layers)"
    report "MPI belongs to wall/" "$(find "${below_wall[@]}" -name '*.[ch]' -exec grep -nHE '#include <mpi' {} +)"
    report "assimp belongs to the import child" \
        "$(find "${layers[@]}" -name '*.[ch]' ! -name 'import_*' -exec grep -nHE '#include <assimp' {} +)"
    report "limits are asked, not guessed from the driver's name" \
        "$(find "${layers[@]}" -name '*.[ch]' ! -name gl_device.c ! -name gl.h -exec grep -nHE '"(llvmpipe|NVIDIA|Mesa|AMD|Intel)' {} +)"
    report "a shader must not carry its own #version" "$(grep -nHE '^[ ]*#[ ]*version' "${shaders[@]}")"
    report "longer than 650 lines" \
        "$(wc -l "${sources[@]}" "${headers[@]}" "${shaders[@]}" | awk '$2 != "total" && $1 > 650')"
    report "what reads from outside has a fuzzer or a reason" "$(check_decoders)"
    report "a wildcard does not see this shader: they stand one folder deep" "$(find shaders -mindepth 3 -type f)"
}

check_shader() {
    local file=$1 name=${1#shaders/} defines=$2 out text
    text=$(mktemp "${TMPDIR:-/tmp}/gazewall-lint.XXXXXX")
    # shellcheck disable=SC2086  # defines are words
    if ! out=$("$assemble" shaders "$name" $defines 2>&1 >"$text"); then
        report "$file ($defines)" "$out"
    elif ! out=$(glslangValidator -S "${file##*.}" "$text"); then
        # shellcheck disable=SC2086
        report "$file ($defines)" "$(printf '%s\n' "$out" | "$assemble" --messages shaders "$name" $defines)"
    fi
    rm -f "$text"
}

check_shaders() {
    need glslangValidator || return
    local file set
    for file in "${shaders[@]}"; do
        case $file in *.glsl | *.h) continue ;; esac
        if ! grep -q '^// variants:' "$file"; then
            check_shader "$file" ""
            continue
        fi
        while read -r set; do
            check_shader "$file" "$set"
        done < <(sed -n 's|^// variants: *||p' "$file" | tr ';' '\n')
    done
}

check_scripts() {
    need shellcheck || return
    local scripts
    mapfile -t scripts < <(find tests .ci -name '*.sh' -o -path .ci/setup -o -path .ci/run)
    report "shellcheck" "$(shellcheck -x "${scripts[@]}" 2>&1)"
}

for check in $checks; do
    "check_$check"
done
if [ $problems -gt 0 ]; then
    echo "lint: $problems problems"
    exit 1
fi
echo "lint: clean"
