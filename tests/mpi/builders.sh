#!/bin/bash
# However many ranks build the octree, on however many machines, built or read from a cache: the same bytes.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1
common=(--scene "$folder/sheet.obj" --set octree_depth=7 --tiles 8x1 --size 160x40 --no-gaze)

sim() { # NAME ARGUMENT...: into NAME.json, what it says into NAME.log
    local name=$1
    shift
    timeout 300 "$program" sim "${common[@]}" --report "$name.json" "$@" >"$name.log" 2>&1
    local code=$?
    is "sim $name ends well" $code 0
    [ $code -eq 0 ] || sed 's/^/# /' "$name.log"
}

hash_of() { json "$1.json" '["octree"]["hash"]'; }
builders_of() { json "$1.json" '["build"]["partition"] + ":" + ",".join(str(p["rank"]) for p in d["build"]["parts"])'; }

# --- any number of builders
for count in 1 2 3 8; do
    sim "by-$count" --cache none --builders $count
done
wanted=$(hash_of by-1)
is "the hash has 32 digits" "${#wanted}" 32
for count in 2 3 8; do
    is "$count builders make the same octree" "$(hash_of "by-$count")" "$wanted"
    is "$count builders draw the same picture" "$(json "by-$count.json" '["image"]["hash"]')" "$(json by-1.json '["image"]["hash"]')"
done
is "one builds alone" "$(builders_of by-1)" "rank 0:0"
is "three build" "$(builders_of by-3)" "3 parts:0,1,2"
is "eight build" "$(builders_of by-8)" "8 parts:0,1,2,3,4,5,6,7"
is "each of three has work" "$(json by-3.json '["build"]["parts"][1]["overlap_tests"] > 0 and d["build"]["parts"][2]["overlap_tests"] > 0')" True

# --- one builder of every machine unless told otherwise
sim auto --cache none
is "one machine, one builder" "$(builders_of auto)" "rank 0:0"
sim machines --cache none --machines 3
is "three machines, three builders" "$(builders_of machines)" "3 parts:0,3,6"
is "three machines make the same octree" "$(hash_of machines)" "$wanted"

# --- a driver that differs, a builder that fails
sim foreign --cache none --builders 3 --builder-fault foreign:1
is "a rank with another driver builds nothing" "$(builders_of foreign)" "3 parts:0,2,3"
has "and is named" "$(cat foreign.log)" "rank 1 has another driver"
is "the octree is the same" "$(hash_of foreign)" "$wanted"
sim failing --cache none --builders 3 --builder-fault failing:2
is "rank 0 builds the part of a rank that cannot" "$(builders_of failing)" "3 parts:0,1,0"
has "and says so" "$(cat failing.log)" "rank 2 cannot build (a failure made on purpose): rank 0 builds its part"
is "the octree is the same again" "$(hash_of failing)" "$wanted"

# --- a memory budget that only all parts together exceed
half=$(json by-1.json '["octree"]["bytes"]["nodes"] / 2**21 + sum(d["octree"]["bytes"][k] for k in ("leaves", "references", "payload", "boxes")) / 2**21')
sim half-1 --cache none --builders 1 --set "octree_memory=$half"
sim half-3 --cache none --builders 3 --set "octree_memory=$half"
is "a budget stops some cells" "$(json half-1.json '["octree"]["statistics"]["stopped_budget"] > 0')" True
is "three builders keep the budget as one does" "$(hash_of half-3)" "$(hash_of half-1)"
has "rank 0 does it alone" "$(cat half-3.log)" "rank 0 builds it within that"

# --- cold and cached, on one machine and on two
sim cold --cache kept --machines 2
is "cold: built" "$(builders_of cold)" "2 parts:0,4"
is "rank 0's machine keeps the octree" "$(find kept -name 'octree-*.gwo' | wc -l)" 1
is "the other machine keeps scene and octree" "$(find kept -name 'block-*.gwb' | wc -l)" 2
sim cached --cache kept --machines 2
is "cached: nobody builds" "$(builders_of cached)" "cache:"
is "cached: the same octree" "$(hash_of cached)" "$wanted"
is "cached: nothing is sent" "$(grep -c "every machine has kept it" cached.log)" 2
for file in kept/block-*.gwb; do
    printf 'x' | dd of="$file" bs=1 seek=70 conv=notrunc 2>/dev/null
done
sim damaged --cache kept --machines 2
is "a damaged block is sent again" "$(grep -c "is refused: its checksum is wrong" damaged.log)" 2
is "the picture is the same" "$(json damaged.json '["image"]["hash"]')" "$(json by-1.json '["image"]["hash"]')"
sim mended --cache kept --machines 2
is "and kept anew" "$(grep -c "every machine has kept it" mended.log)" 2

# --- two launches at once, one folder
sim one --cache together &
sim two --cache together &
wait
is "two launches at once keep one octree" "$(find together -type f | wc -l)" 1
is "and both have it" "$(hash_of one)$(hash_of two)" "$wanted$wanted"

# --- the user's own cache folder, and its limit
XDG_CACHE_HOME=$folder/user sim default
is "by default octrees are kept in the user's cache" "$(find user/gazewall -name '*.gwo' | wc -l)" 1
expect "render finds what sim has kept" 0 "read from" render --scene "$folder/sheet.obj" --set octree_depth=7 --size 32x32 --cache "$folder/user/gazewall" --out r.png
expect "a cache needs a name" 2 "--cache has an empty name" sim --cache ""
expect "a limit of nothing" 2 "--cache-limit" sim --cache-limit 0
expect "an output without a name" 2 "--out has an empty name" inspect --out ""
expect "a report without a name" 2 "--report has an empty name" sim --report ""
expect "no builders" 2 "--builders" sim --builders 0
finish
