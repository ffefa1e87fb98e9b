#!/usr/bin/env python3
"""The messages that the guide explains are those of the programs. Usage: messages.py SOURCE_DIR

In client/guide/troubleshooting.md, code in the first cell of a table row is a message, in which `...` stands for what a program fills in.
Each part of it must be in a string of the sources.
"""
import pathlib
import re
import sys

PAGE = "client/guide/troubleshooting.md"
PART_LENGTH_MIN = 8
LITERALS = re.compile(r'"(?:\\.|[^"\\\n])*"(?:\s*"(?:\\.|[^"\\\n])*")*')


def strings(source_dir):
    """All strings of the programs, adjacent literals joined."""
    found = []
    for part in ("proto", "renderer", "coordinator", "worker", "client"):
        for path in sorted((source_dir / part).rglob("*")):
            if path.suffix in (".cpp", ".h"):
                for match in LITERALS.finditer(path.read_text(encoding="utf-8")):
                    pieces = re.findall(r'"((?:\\.|[^"\\\n])*)"', match.group())
                    found.append("".join(pieces).replace('\\"', '"').replace("\\n", "\n"))
    return found


def main():
    source_dir = pathlib.Path(sys.argv[1])
    corpus = "\0".join(strings(source_dir))
    missing = messages = 0
    for number, line in enumerate((source_dir / PAGE).read_text(encoding="utf-8").split("\n"), 1):
        cell = re.match(r"\| (.+?) \| ", line)
        for message in re.findall(r"`([^`]+)`", cell.group(1)) if cell else []:
            messages += 1
            for part in re.split(r"\.\.\.", message):
                part = part.strip(' :;,"')
                if len(part) >= PART_LENGTH_MIN and part not in corpus:
                    print(f"{PAGE}:{number}: no program prints \"{part}\"")
                    missing += 1
    print(f"{messages} messages, {missing} not found")
    return 1 if missing or not messages else 0


if __name__ == "__main__":
    sys.exit(main())
