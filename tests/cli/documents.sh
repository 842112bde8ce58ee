#!/bin/bash
# The documents against the program: every command they show has a verb, options, settings and shipped files that exist,
# and every link between them leads somewhere.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
readonly checker=$folder/check.py

cat >"$checker" <<'P'
import glob, os, re, subprocess, sys

program, documents = sys.argv[1], sys.argv[2:]
helps = {}

def run(*words):
    return subprocess.run([program, *words], capture_output=True, text=True, timeout=60).stdout

def options(verb):
    if verb not in helps:
        helps[verb] = set(re.findall(r"--([a-z][a-z0-9-]*)", run(verb, "--help"))) | {"help"}
    return helps[verb]

verbs = set(re.findall(r"^  ([a-z]+) ", run("--help"), re.M))
settings = set(re.findall(r"^([a-z_]+)=", run("settings"), re.M))
seen = 0

def anchor(title):
    return re.sub(r"[^\w\- ]", "", re.sub(r"`|\*", "", title).strip().lower()).replace(" ", "-")

def say(document, text):
    print(f"{document}: {text}")

def command(document, text):
    global seen
    words = text.split()
    verb = words[0]
    if verb not in verbs:
        return say(document, f"'{verb}' is no verb, in: gazewall {text}")
    seen += 1
    before = ""
    for word in words[1:]:
        if word.startswith("--"):
            if word[2:].split("=")[0] not in options(verb):
                say(document, f"{verb} has no option {word}, in: gazewall {text}")
        elif before == "--set" and word.split("=")[0] not in settings:
            say(document, f"'{word}' is no setting, in: gazewall {text}")
        elif word.startswith("configs/") and not os.path.exists(word):
            say(document, f"there is no {word}, in: gazewall {text}")
        before = word

def commands(text):
    for block in re.findall(r"^```[^\n]*\n(.*?)^```", text, re.S | re.M):
        for line in block.replace("\\\n", " ").split("\n"):
            found = re.match(r"\s*(?:\$ )?(?:out/)?gazewall ([a-z]+(?: [^#|>&;]*)?)(?:[#|>&;].*)?$", line)
            if found and not re.match(r"\s*gazewall [a-z]+:", line):
                yield found.group(1)
    prose = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    for shown in re.findall(r"`(?:out/)?gazewall ([a-z][^`]*)`", prose):
        yield re.split(r"[#|>&;]", shown.replace("\n", " "))[0]

titles = {}
for document in documents:
    text = open(document).read()
    for shown in commands(text):
        command(document, shown)
    prose = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    for target in re.findall(r"\]\(([^)\s]+)\)", prose):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, part = target.partition("#")
        path = os.path.normpath(os.path.join(os.path.dirname(document), name)) if name else document
        if not os.path.exists(path):
            say(document, f"there is no {path}, linked as {target}")
        elif part and path.endswith(".md"):
            if path not in titles:
                titles[path] = {anchor(t) for t in re.findall(r"^#+ (.*)$", open(path).read(), re.M)}
            if part not in titles[path]:
                say(document, f"{path} has no heading #{part}")
if seen < 3:
    say("documents", f"only {seen} commands were found")
P

mapfile -t documents < <(ls README.md docs/*.md)
is "commands and links of the documents hold" "$(python3 -I -S "$checker" "$program" "${documents[@]}" 2>&1)" ""

# The checker itself: each of these must be found.
cat >"$folder/wrong.md" <<'M'
# One
`gazewall fly --tiles 2x2`, `gazewall sim --tails 2x2`, `gazewall render --set tauu=1`, `gazewall check configs/none.yaml`
[gone](gone.md), [nowhere](#two)
```
gazewall replay --nope file   # with a word
```
M
found=$(python3 -I -S "$checker" "$program" "$folder/wrong.md" 2>&1)
for part in "'fly' is no verb" "no option --tails" "'tauu=1' is no setting" "no configs/none.yaml" "gone.md, linked" \
    "no heading #two" "no option --nope"; do
    has "a document with a fault is found: $part" "$found" "$part"
done
finish
