#!/usr/bin/env python3
"""Runs the commands of a page of the guide as a reader would. Usage: run_page.py PAGE.md BIN_DIR SOURCE_DIR

All blocks of the language `sh` run in one bash, from the top of the page to its end, in an empty folder, with an empty home in which
`~/tessera` is the repository. The shell has a network and a process table of its own, so that the addresses of the guide are
free and nothing survives. A command that fails fails the page. What readers do not see:

  <!-- guide: not run: REASON -->   the next block is skipped; the reason is printed
  <!-- guide: exit 1 -->            the last command of the next block exits with this code
  <!-- guide: file PATH -->         the next block is the contents of this file
  <!-- guide: do COMMANDS -->       commands that run here: what the reader has done before, or does elsewhere
  <!-- guide: with PAGE#HEADING --> the blocks below this heading of another page, which run here

A block of the language `text` right below one that runs shows lines that it must print, in this order; `...` stands for any text.
The word TOKEN stands for the token that was printed last. Exit code 77: this machine has no namespaces.
"""
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

SECONDS_MAX = 800
NOT_RUN_MAX = 1  # blocks of a page that are skipped
SKIPPED = 77

# The network and the name of a machine that nobody else uses.
NAMESPACES = ["unshare", "--user", "--map-root-user", "--net", "--uts", "--pid", "--fork", "--mount-proc",
              "--kill-child=SIGKILL"]

# Prints the newest token once there is one.
TOKEN_SCRIPT = r"""#!/bin/bash
for attempt in $(seq 300); do
  token=$(grep -o 'tessera-A[A-Za-z0-9_-]*' "$GUIDE/printed" 2>/dev/null | tail -1)
  if [ -n "$token" ]; then echo "$token"; exit 0; fi
  sleep 0.1
done
echo "no token was printed" >&2
exit 1
"""

# Keeps what the coordinator prints, as a reader who copies the token does.
COORDINATOR_SCRIPT = r"""#!/bin/bash
if [ "${1:-}" = token ]; then
  printed=$("$GUIDE/bin/tessera-coordinator" "$@") || exit
  echo "$printed" | tee -a "$GUIDE/printed"
else
  exec "$GUIDE/bin/tessera-coordinator" "$@" > >(tee -a "$GUIDE/printed")
fi
"""

PROLOGUE = r"""
ip link set lo up && hostname localhost
cd "$HOME/work"
set -eEu -o pipefail
watch-commands() { trap 'echo "$page:$LINENO: this command failed" >&2' ERR; }
watch-commands
"""


ADDED = re.compile(r"<!-- guide: (do|with) (.+) -->")


class Block:
    def __init__(self, first, language):
        self.first = first  # the number of the line of the opening fence, from 1
        self.last = None  # that of the closing fence
        self.language = language
        self.lines = []
        self.remarks = {}  # verb -> rest
        self.output = None  # the block `text` that shows what it prints


def blocks_of(text):
    """The fenced blocks of a page with the remarks before each."""
    blocks, open_block, remarks = [], None, {}
    for number, line in enumerate(text.split("\n"), 1):
        fence = re.match(r"```(\w*)", line)
        if open_block is not None:
            if fence:
                open_block.last = number
                open_block = None
            else:
                open_block.lines.append(line)
        elif fence:
            open_block = Block(number, fence.group(1))
            open_block.remarks, remarks = remarks, {}
            if open_block.language == "text" and blocks and blocks[-1].last == number - 1:
                blocks[-1].output = open_block
            blocks.append(open_block)
            if open_block.language not in ("sh", "text") and "file" not in open_block.remarks:
                raise ValueError(f"line {number}: a block is `sh`, or `text` that a program prints, or a file (guide: file PATH)")
        else:
            remark = re.fullmatch(r"<!-- guide: (not run:|exit|file) (.+) -->", line)
            if remark:
                remarks[remark.group(1)] = remark.group(2)
            elif line.startswith("<!-- guide") and not ADDED.fullmatch(line):
                raise ValueError(f"line {number}: unknown remark: {line}")
    return blocks


def section(text, heading):
    """The part of a page below a heading, named as a link names it."""
    lines, is_in_block, is_below = [], False, False
    for line in text.split("\n"):
        if line.startswith("```"):
            is_in_block = not is_in_block
        elif line.startswith("#") and not is_in_block:
            name = re.sub(r"[^\w -]", "", line.lstrip("# ").lower()).replace(" ", "-")
            is_below = name == heading
        if is_below:
            lines.append(line)
    if not lines:
        raise ValueError(f"no heading {heading}")
    return "\n".join(lines)


def added_commands(verb, rest, folder):
    """What a remark adds where it stands."""
    if verb == "do":
        return [rest]
    page, heading = rest.split("#")
    blocks = blocks_of(section((folder / page).read_text(encoding="utf-8"), heading))
    return [line for block in blocks if block.language == "sh" for line in block.lines]


class Script:
    """A script for bash with each command at the number of the line that it has in the page."""

    def __init__(self, page):
        self.page = page
        self.text = page.read_text(encoding="utf-8")
        self.blocks = blocks_of(self.text)
        self.added = {}  # name of a file -> commands
        self.not_run = []  # (line, reason)
        self.count = 0
        self.lines = [""] * (self.text.count("\n") + 2)
        for index, block in enumerate(self.blocks):
            self.add(index, block)
        for number, line in enumerate(self.text.split("\n"), 1):
            remark = ADDED.fullmatch(line)
            if remark:
                name = f"added.{number}"
                self.added[name] = "\n".join(added_commands(*remark.groups(), page.parent)) + "\n"
                self.put(number, f'. "$GUIDE/{name}"')

    def add(self, index, block):
        reason = block.remarks.get("not run:")
        if reason and block.language == "sh":
            self.not_run.append((block.first, reason))
            return
        end = block.first + 1 + len(block.lines)
        if "file" in block.remarks:
            self.put(block.first, f'mkdir -p "$(dirname {block.remarks["file"]})"; cat > {block.remarks["file"]} <<\'END OF FILE\'')
            self.put_all(block.first + 1, block.lines)
            self.put(end, "END OF FILE")
        elif block.language == "sh":
            self.count += 1
            lines = [line.replace("TOKEN", "$(printed-token)") for line in block.lines]
            code = block.remarks.get("exit")
            self.put(block.first, f'echo {block.first} > "$GUIDE/at"; {{' + (" trap - ERR; set +e" if code else ""))
            self.put_all(block.first + 1, lines)
            check = f'code=$?; set -e; [ $code = {code} ] || {{ echo "exit code $code" >&2; exit 1; }}; watch-commands; ' if code else ""
            self.put(end, f'{check}}} >"$GUIDE/output.{index}" 2>&1')

    def put(self, number, line):
        self.lines[number - 1] = line

    def put_all(self, number, lines):
        for offset, line in enumerate(lines):
            self.put(number + offset, line)

    def bash(self):
        """What runs before the page, and the page."""
        return f"page={self.page.name}" + PROLOGUE, "\n".join(self.lines) + "\n"

    def missing_output(self, guide):
        """The lines of `text` blocks that were not printed, as (line of the page, text)."""
        missing = []
        for index, block in enumerate(self.blocks):
            if block.language != "sh" or block.output is None or "not run:" in block.remarks:
                continue
            printed = (guide / f"output.{index}").read_text(encoding="utf-8", errors="replace").replace("\r", "\n").split("\n")
            position = 0
            for offset, line in enumerate(block.output.lines, 1):
                pattern = ".*".join(re.escape(" ".join(part.split())) for part in line.split("..."))
                while position < len(printed) and not re.fullmatch(pattern, " ".join(printed[position].split())):
                    position += 1
                if position == len(printed):
                    missing.append((block.output.first + offset, line))
                    break
                position += 1
        return missing


def make_home(home, guide, bin_dir, source_dir):
    """A home with the repository, and the programs as a reader has them in the path."""
    for folder in (home / "work", home / "tessera/build/release", guide / "path", home / "run"):
        folder.mkdir(parents=True)
    (home / "run").chmod(0o700)
    for entry in source_dir.iterdir():
        if entry.name not in ("build", ".git"):
            (home / "tessera" / entry.name).symlink_to(entry)
    (guide / "bin").symlink_to(bin_dir)
    for name, text in (("printed-token", TOKEN_SCRIPT), ("tessera-coordinator", COORDINATOR_SCRIPT)):
        (guide / "path" / name).write_text(text)
        (guide / "path" / name).chmod(0o755)
    for name in ("tessera", "tessera-worker"):
        (guide / "path" / name).symlink_to(bin_dir / name)
    (home / "tessera/build/release/bin").symlink_to(guide / "path")


def environment(home, guide, bin_dir):
    of_sanitizers = {name: value for name, value in os.environ.items() if name.endswith("SAN_OPTIONS")}
    return of_sanitizers | {
        "HOME": str(home), "GUIDE": str(guide), "XDG_RUNTIME_DIR": str(home / "run"), "TMPDIR": str(guide),
        "PATH": f"{guide / 'path'}:{bin_dir}:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin",
        "LANG": "C.UTF-8", "USER": "reader", "TERM": "dumb",
        # Small pictures, unless a command names the size, and time for programs to start on a busy machine.
        "TESSERA_RESOLUTION": "96x54", "TESSERA_PATIENCE": "60",
    }


def run(script, scratch, bin_dir, source_dir):
    home, guide = scratch / "home", scratch / "guide"
    make_home(home, guide, bin_dir, source_dir)
    prologue, text = script.bash()
    (guide / "prologue").write_text(prologue)
    (guide / "script").write_text(text)
    for name, commands in script.added.items():
        (guide / name).write_text(commands)
    command = ["bash", "-c", f"set -m; . {guide}/prologue; . {guide}/script"]
    log = open(guide / "log", "wb")
    process = subprocess.Popen(NAMESPACES + command, env=environment(home, guide, bin_dir), stdin=subprocess.DEVNULL, stdout=log,
                               stderr=subprocess.STDOUT, cwd=home, start_new_session=True)
    try:
        code = process.wait(SECONDS_MAX)
    except subprocess.TimeoutExpired:
        code = f"none after {SECONDS_MAX} s, in the block at line {(guide / 'at').read_text().strip()}"
    process.send_signal(signal.SIGKILL)  # with all that the shell has started
    process.wait()
    outputs = sorted(guide.glob("output.*"), key=lambda path: int(path.suffix[1:]))
    return code, "".join(path.read_text(encoding="utf-8", errors="replace") for path in [*outputs, guide / "log"])


def main():
    page, bin_dir, source_dir = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    if subprocess.run(NAMESPACES + ["ip", "link", "set", "lo", "up"], capture_output=True, check=False).returncode != 0:
        print("skipped: this machine has no namespaces for a network of one's own")
        return SKIPPED
    script = Script(page)
    for line, reason in script.not_run:
        print(f"{page.name}:{line}: not run: {reason}")
    print(f"{page.name}: {script.count} blocks run")
    if len(script.not_run) > NOT_RUN_MAX:
        print(f"{page.name}: {len(script.not_run)} blocks are not run, more than {NOT_RUN_MAX}")
        return 1
    with tempfile.TemporaryDirectory(prefix="guide-") as scratch:
        code, log = run(script, pathlib.Path(scratch), bin_dir, source_dir)
        missing = script.missing_output(pathlib.Path(scratch) / "guide") if code == 0 else []
    if code != 0 or missing:
        print(log[-20000:])
    if code != 0:
        print(f"{page.name}: exit code {code}; the last lines above say where")
    for line, text in missing:
        print(f"{page.name}:{line}: not printed: {text}")
    return 1 if code != 0 or missing else 0


if __name__ == "__main__":
    sys.exit(main())
