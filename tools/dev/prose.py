# SPDX-License-Identifier: MIT
"""Finds the sentences of documents, comments and messages that have more than 30 words.

A list item, a cell of a table, a heading and a comment end a sentence, as do a full stop, a
question mark and a colon before a blank. Code in back quotes counts as one word.
"""
import re

LIMIT = 30
END = re.compile(r"[.?!:][)\"']?\s+|\s\|\s*|\\n")
WORD = re.compile(r"[\w`].*")


def markdown(text):
    """(line, paragraph) of a document: without code blocks and formulas on lines of their own."""
    block, start, code = [], 0, False
    for number, line in enumerate(text.split("\n") + [""], 1):
        fence = line.lstrip().startswith("```")
        stop = fence or code or not line.strip() or line.startswith("    ") and not block
        if stop or re.match(r"\s*([-*#>|]|\d+\.)\s?", line):
            if block:
                yield start, " ".join(block)
            block = []
        code ^= fence
        if not stop:
            block, start = block + [line.strip()], start if block else number
    if block:
        yield start, " ".join(block)


def source(text):
    """(line, text) of comments and of strings that hold a sentence."""
    for m in re.finditer(r"/\*(.*?)\*/|//([^\n]*)|((?:\"(?:[^\"\\\n]|\\.)*\"\s*)+)", text, re.S):
        words = m[1] or m[2] or re.sub(r"\"\s*\"|^\"|\"\s*$", "", m[3])
        if m[1]:
            for paragraph in re.split(r"\n\s*\*?\s*\n|\n\s*\*?\s+(?=[-*] |\w+   )", words):
                yield text.count("\n", 0, m.start()) + 1, re.sub(r"\n\s*\* ?", " ", paragraph)
        else:
            yield text.count("\n", 0, m.start()) + 1, words


READERS = {".md": markdown, ".c": source, ".h": source, ".def": source}


def long_sentences(path):
    """(line, number of words, sentence)"""
    for line, paragraph in READERS[path.suffix](path.read_text(encoding="utf-8")):
        plain = re.sub(r"`[^`]*`", "`code`", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", paragraph))
        for sentence in END.split(plain):
            words = [w for w in sentence.split() if WORD.match(w)]
            if len(words) > LIMIT:
                yield line, len(words), " ".join(sentence.split())
