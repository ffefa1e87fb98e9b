#!/usr/bin/env python3
"""The reference of commands in the guide, made of the help of the programs. Usage: reference.py BIN_DIR SOURCE_DIR [--write]

Without --write, compares client/guide/commands.md with what the programs print, and exits with 1 if they differ.
Above the line MARK the page is written by hand.
"""
import difflib
import pathlib
import re
import subprocess
import sys

PAGE = "client/guide/commands.md"
COLUMN = 30  # of the descriptions in a help text
MARK = "<!-- What follows is written by tests/client/guide/reference.py --write. -->"

# Options that these commands have in common, with the same help, are described once.
GROUPS = [
    ("Options of rendering", ["render", "submit", "info"]),
    ("Options of picture files", ["render", "fetch", "denoise", "relight"]),
    ("Options of connections", ["jobs", "status", "submit", "fetch", "workers"]),
]
PROGRAMS = [("tessera-coordinator", []), ("tessera-coordinator", ["init"]), ("tessera-coordinator", ["token"]), ("tessera-worker", [])]


class Command:
    """A command as its help describes it."""

    def __init__(self, bin_dir, program, words):
        self.name = " ".join([program, *words])
        text = subprocess.run([str(bin_dir / program), *words, "--help"], capture_output=True, text=True, check=True).stdout
        lines = text.split("\n")
        self.summary, self.usage = lines[0], lines[1].removeprefix("Usage: ")
        self.arguments, self.options, self.subcommands, self.examples = [], [], [], []
        parts = {"Positionals:": self.arguments, "Options:": self.options, "Subcommands:": self.subcommands}
        part = None
        for line in lines[2:]:
            is_entry = re.match(r"  \S", line)
            if line.endswith(":") and not line.startswith(" "):
                part = line
            elif part == "Examples:":
                self.examples += [line.strip()] if line.strip() else []
            elif part in parts and re.match(r"\s{12,}\S", line):
                head, help_text = parts[part][-1]
                parts[part][-1] = (head, f"{help_text} {line.strip()}".strip())
            elif part in parts and is_entry:
                has_text = len(line) > COLUMN and line[COLUMN - 1] == " " and line[COLUMN:] != "..."
                parts[part].append((line[:COLUMN].strip(), line[COLUMN:].strip()) if has_text else (line.strip(), ""))
        self.options = [option for option in self.options if not option[0].startswith(("-h,--help", "--version"))]


def row(entry):
    head, text = entry
    head = re.sub(r" (REQUIRED|\.\.\.)(?= |$)", "", head).replace("|", "\\|")
    needed = " REQUIRED" in entry[0] and head.startswith("-")
    repeated = " ..." in entry[0]
    text = text.replace("|", "\\|") + ("; required" if needed else "")
    if repeated and "may be repeated" not in text:
        text += "; may be repeated"
    return f"| `{head}` | {text} |"


def table(entries):
    return ["| | |", "|---|---|", *map(row, entries), ""] if entries else []


def anchor(title):
    return title.lower().replace(" ", "-")


def command_text(command, groups):
    lines = [f"### {command.name}", "", f"{command.summary.rstrip('.')}.", "", "```text", command.usage, "```", ""]
    rest, shared = command.options, []
    for title, entries in groups:
        if all(entry in rest for entry in entries):
            rest = [entry for entry in rest if entry not in entries]
            shared.append(f"[{title.lower()}](#{anchor(title)})")
    lines += table(command.arguments + rest)
    if shared:
        lines += ["Also: " + ", ".join(shared) + ".", ""]
    pairs = zip(command.examples[::2], command.examples[1::2])
    lines += [f"- {what.removeprefix('# ')}: `{line}`" for what, line in pairs]
    return lines + [""] if command.examples else lines


def reference(bin_dir):
    """The generated part of the page."""
    listed = Command(bin_dir, "tessera", [])
    commands = {name: Command(bin_dir, "tessera", [name]) for name, _ in listed.subcommands}
    groups = []
    for title, names in GROUPS:
        common = [entry for entry in commands[names[0]].options if all(entry in commands[name].options for name in names)]
        taken = [entry for _, entries in groups for entry in entries]
        groups.append((title, [entry for entry in common if entry not in taken and entry[0] != "--json"]))
    lines = ["## All commands", "", "| | |", "|---|---|"]
    lines += [f"| [`tessera {name}`](#tessera-{name}) | {text} |" for name, text in listed.subcommands]
    programs = [Command(bin_dir, program, words) for program, words in PROGRAMS]
    lines += [f"| [`{each.name}`](#{anchor(each.name)}) | {each.summary.rstrip('.')} |" for each in programs]
    lines += ["", "## Options of several commands", ""]
    for title, entries in groups:
        lines += [f"### {title}", "", *table(entries)]
    lines += ["## Commands of tessera", ""]
    for command in commands.values():
        lines += command_text(command, groups)
    lines += ["## Coordinator and worker", ""]
    for command in programs:
        lines += command_text(command, [])
    return "\n".join(lines).rstrip() + "\n"


def main():
    bin_dir, source_dir = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    page = source_dir / PAGE
    text = page.read_text(encoding="utf-8")
    if MARK not in text:
        print(f"{PAGE}: the line is missing: {MARK}")
        return 1
    expected = text[:text.index(MARK)] + MARK + "\n\n" + reference(bin_dir)
    if "--write" in sys.argv[3:]:
        page.write_text(expected, encoding="utf-8")
        return 0
    if text == expected:
        return 0
    print("\n".join(difflib.unified_diff(text.split("\n"), expected.split("\n"), PAGE, "the help of the programs", lineterm="", n=1)))
    print(f"{PAGE} differs from the help. Run: tests/client/guide/reference.py BIN_DIR SOURCE_DIR --write")
    return 1


if __name__ == "__main__":
    sys.exit(main())
