"""What stands twice in src/: runs of equal lines, and functions of one name."""
import re
from collections import defaultdict

RUN = 8  # equal lines in a row that are too many
COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.S)
TEXT = re.compile(r'"(?:\\.|[^"\\\n])*"')
FUNCTION = re.compile(r"^(?!typedef|struct \w+ \{|#|[{} *])[^;={}]*?\b(\w+)\(", re.M)


def without_comments(text):
    """The same lines, with blanks for comments."""
    return COMMENT.sub(lambda hit: re.sub(r"[^\n]", " ", hit[0]), TEXT.sub(
        lambda hit: hit[0].replace("/*", "  ").replace("//", "  "), text))


def code_lines(text):
    """(number, line) of lines that count: no blanks, lone braces, comments and includes."""
    for number, line in enumerate(without_comments(text).split("\n"), 1):
        line = line.strip()
        if line.strip("{}; ") and not line.startswith("#include"):
            yield number, line


def equal_runs(files):
    """(file, line, other file, other line, count) of each run, at its beginning. `files`: {name:
    text}."""
    seen = defaultdict(list)
    rows = {name: list(code_lines(text)) for name, text in files.items()}
    for name, lines in rows.items():
        for k in range(len(lines) - RUN + 1):
            seen[tuple(line for _, line in lines[k:k + RUN])].append((name, k))
    pairs = {(a, b) for places in seen.values() for b in places[1:] for a in places[:1]}
    for (name, k), (other, j) in sorted(pairs):
        if ((name, k - 1), (other, j - 1)) in pairs:
            continue
        count = RUN
        while ((name, k + count - RUN + 1), (other, j + count - RUN + 1)) in pairs:
            count += 1
        yield name, rows[name][k][0], other, rows[other][j][0], count


def functions(text):
    """(line, name, whether it is static) of what a file defines; the body's brace stands alone."""
    lines = without_comments(text).split("\n")
    for number, line in enumerate(lines):
        if line != "{":
            continue
        first = number - 1
        while first > 0 and lines[first - 1].strip() and not re.match(r"[}#]", lines[first - 1]):
            first -= 1
        head = FUNCTION.search("\n".join(lines[first:number]))
        if head and not head[1].isupper():  # a macro names the others
            yield first + 1, head[1], "static" in "\n".join(lines[first:number]).split(head[1] +
                                                                                       "(")[0]


def same_names(files):
    """(file, line, name, other file): a static function's name is unique in its folder, that of a
    global one in the program."""
    seen = {}
    for name, text in files.items():
        for line, function, static in functions(text):
            key = (name.split("/")[0] if static else "", function)
            other = seen.setdefault(key, name)
            if other != name:
                yield name, line, function, other


def findings(files):
    """(file, line, what) of all of it."""
    for name, line, other, at, count in equal_runs(files):
        yield name, line, f"{count} lines equal those of {other}:{at}"
    for name, line, function, other in same_names(files):
        yield name, line, f"{function}() is the name of a function in {other}, too"
