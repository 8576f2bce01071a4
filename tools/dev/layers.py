#!/usr/bin/env python3
"""The layers of src/: its folders, lowest first. Checks that dependencies point down.

    tools/dev/layers.py --archive build/release/libsphfsi.a     check includes, calls and cycles

An include, or a call that the linker resolves, may lead to a lower folder or stay in its own.
Within a folder no chain of them may come back to the file where it started. A header may not
declare what another file of its folder defines (`struct x;`, `extern`) where an include would close
such a chain.
"""
import argparse
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

LAYERS = ("base expr particles case geometry fluid rigid solid implicit beam coupling time output "
          "check app").split()
LIBC = set("assert ctype errno fcntl fenv float getopt inttypes limits locale math signal stdarg "
           "stdbool stddef stdint stdio stdlib string sys/auxv time unistd".split())
INCLUDE = re.compile(r'\s*#\s*include\s+(["<])([^">]+)[">]')
DECLARATION = re.compile(r"^(?:extern\b.*|struct (\w+)|enum (\w+));")
DEFINITION = re.compile(r"^(?:struct|enum) (\w+) \{")


def layer(name):
    """Index of the folder of `folder/file`, None where it is none of them."""
    folder = name.split("/")[0]
    return LAYERS.index(folder) if folder in LAYERS else None


def sources(root):
    """{`folder/file`: lines} of all files of src/."""
    return {str(path.relative_to(root / "src")): path.read_text(encoding="utf-8").splitlines()
            for path in sorted((root / "src").rglob("*")) if path.suffix in (".c", ".h", ".def")}


def includes(files):
    """Yields (file, line, included, in_quotes)."""
    for name, lines in files.items():
        for number, line in enumerate(lines, 1):
            match = INCLUDE.match(line)
            if match:
                yield name, number, match[2], match[1] == '"'


def include_findings(files):
    for name, number, target, quoted in includes(files):
        if name == "app/main.c" and target != "sphfsi.h" and (quoted or target[:-2] not in LIBC):
            yield name, number, f"main.c may include sphfsi.h and the C library, not {target}"
        elif not quoted or target in ("sphfsi.h", "unity.h"):
            continue
        elif layer(target) is None or target not in files:
            yield name, number, f"includes {target}, which is no file of a folder of src/"
        elif layer(target) > layer(name):
            yield name, number, f"includes {target} of a higher layer"


def hidden(files):
    """Edges that a forward declaration hides: (file, line, file that defines the type)."""
    home = {}
    for name, lines in files.items():
        for line in lines:
            match = DEFINITION.match(line)
            if match and name.endswith(".h"):
                home.setdefault(match[1], name)
    for name, lines in files.items():
        for number, line in enumerate(lines, 1):
            match = DECLARATION.match(line)
            target = match and home.get(match[1] or match[2])
            if target and target != name:
                yield name, number, target


def calls(objects):
    """{file: {file that it calls: [symbols]}} from what object files define and leave undefined."""
    home, needs = {}, defaultdict(set)
    for path in sorted(objects.rglob("*.o")):
        name = str(path.relative_to(objects).with_suffix(".c"))
        table = subprocess.run(["nm", path], capture_output=True, text=True, check=True).stdout
        for line in table.splitlines():
            kind, symbol = line.split()[-2:]
            if kind == "U":
                needs[name].add(symbol)
            elif kind in "TDBRC":
                home[symbol] = name
    found = defaultdict(lambda: defaultdict(list))
    for name, symbols in needs.items():
        for symbol in sorted(symbols):
            if home.get(symbol, name) != name:
                found[name][home[symbol]].append(symbol)
    return found


def cycles(edges):
    """Groups of files that reach each other (Tarjan 1972)."""
    index, low, stack, groups = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(edges.get(node, ())):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            group = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(group) > 1:
                groups.append(sorted(group))

    sys.setrecursionlimit(10000)
    for node in sorted(edges):
        if node not in index:
            visit(node)
    return groups


def findings(root, build=None):
    """Yields (path, line, text); `build` is the folder that holds src/**/*.o, None: calls are not
    checked."""
    files = sources(root)
    edges = defaultdict(set)
    place = root / "src"
    for name in files:
        if layer(name) is None:
            yield place / name, 0, "is in none of the folders of src/"
    for name, number, text in include_findings(files):
        yield place / name, number, text
    for name, _, target, quoted in includes(files):
        if quoted and target in files:
            edges[name].add(target)
    for name, number, target in hidden(files):
        if layer(target) > layer(name):
            yield place / name, number, f"declares what {target} of a higher layer defines"
        edges[name].add(target)
    objects = build / "src" if build else None
    if objects and objects.is_dir() and shutil.which("nm"):
        for name, targets in calls(objects).items():
            for target, symbols in targets.items():
                if name not in files or target not in files:
                    continue  # an object of a file that is gone
                if layer(target) > layer(name):
                    yield place / name, 0, f"calls {symbols[0]} of {target}, a higher layer"
                edges[name].add(target)
    else:
        print("calls between layers not checked: no object files or no nm here")
    for group in cycles(edges):
        yield place / group[0], 0, "depends on itself through " + ", ".join(group[1:])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], epilog=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--archive", type=Path, help="library beside whose objects calls are "
                                                     "looked up")
    args = parser.parse_args()
    root = Path(__file__).resolve().parents[2]
    found = list(findings(root, args.archive and args.archive.resolve().parent))
    for path, line, text in found:
        print(f"{path.relative_to(root)}:{line}: {text}" if line else f"{path.relative_to(root)}: "
                                                                      f"{text}")
    print(f"layers: {len(found)} findings")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
