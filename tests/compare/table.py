"""Prints the table of docs/comparison.md from the folders that tests/compare_cycles.sh wrote.
    python3 tests/compare/table.py FOLDER"""
import json
import os
import sys


def read(*parts):
    with open(os.path.join(*parts), encoding="utf-8") as file:
        return json.load(file)


def seconds(*parts):
    with open(os.path.join(*parts), encoding="utf-8") as file:
        return sum(float(word) for word in file.read().split())


def row(folder, name):
    here = os.path.join(folder, name)
    report, theirs = read(here, "ours-gi.json"), read(here, "cycles.json")
    limited, gi = read(here, "limited.json"), read(here, "gi.json")
    return " | ".join([
        f"| `{name}`", f"{report['scene']['triangles']:,}",
        f"{limited['flip']:.3f}", f"{limited['mean']:.1f}", "{:+.1f} {:+.1f} {:+.1f}".format(*limited["bias"]),
        f"{gi['flip']:.3f}", f"{gi['mean']:.1f}", "{:+.1f} {:+.1f} {:+.1f}".format(*gi["bias"]),
        f"{gi['mask'] * 1e2:.2f} %",
        f"{seconds(here, 'ours-limited.seconds'):.0f} / {theirs['seconds']['limited']:.0f}",
        f"{seconds(here, 'ours-gi.seconds'):.0f} / {theirs['seconds']['gi']:.0f} |"])


def main():
    folder = sys.argv[1]
    names = sorted(n for n in os.listdir(folder) if os.path.exists(os.path.join(folder, n, "gi.json")))
    print("| scene | triangles | limited: FLIP | mean | ours - Cycles, R G B | GI: FLIP | mean | ours - Cycles, R G B "
          "| hits apart | s, limited | s, GI |")
    print("|---|---:|---:|---:|---|---:|---:|---|---:|---|---|")
    for name in names:
        print(row(folder, name))
    print()
    for name in names:
        print(f"`{name}`:", " ".join(f"`{effect}`" for effect in read(folder, name, "ours-gi.json")["effects"]["run"]))


main()
