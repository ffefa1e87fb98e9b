#!/usr/bin/env python3
"""Holds the tree against the rules that the compiler does not check. Usage: check_house.py SOURCE_DIR

Prints one line per broken rule, as file:line: what, and exits 1 if there is any.
"""
import pathlib
import re
import sys

FUNCTION_LINES_MAX = 70
FILE_LINES_MAX = 400
CODE = (".h", ".cpp")
BOXES = ("proto", "coordinator", "worker", "renderer", "client", "tests")

# What the sources of a folder must not mention, and why.
FORBIDDEN = [
    (r"^coordinator/core/", r"\b(system_clock|steady_clock|high_resolution_clock|std::chrono::\w+_clock|time\(nullptr\))",
     "the core has no clock: time comes in with events"),
    (r"^coordinator/core/", r"\b(std::thread|std::mutex|std::condition_variable|random_device)\b|#include <grpc|#include <thread>",
     "the core is a pure state machine: no thread, lock, network or random device"),
    (r"^coordinator/", r"#include [<\"]embree|rtcore", "the coordinator knows no ray tracing"),
    (r"^(renderer|proto/[^w]\w*\.|client/(?!coordinator/)|worker/core)", r"#include <grpc", "gRPC stays in proto/wire and the programs' shells"),
    (r"^renderer/", r"#include \"(proto|coordinator|worker|client)/", "the renderer does not depend on the farm"),
    (r"^renderer/(integrator|light|bxdf|material|texture|shape|sampler|filter|camera|accelerator|math|color)/",
     r"\b(system_clock|high_resolution_clock)\b", "no wall clock in the renderer"),
    (r"^(proto|coordinator|worker|renderer|client)/", r"(?<![\w:.>])(std::)?s?rand\(|random_shuffle", "no rand(): numbers come from the sampler"),
    (r"^(proto|coordinator|worker|renderer|client)/", r"\bunordered_(map|set)\b.*\bfor\b", "unordered iteration reaches a result"),
    (r"", r"-ffast-math|-march=native|-Ofast", "value-changing or machine-dependent optimisation"),
    (r"^(proto|coordinator|worker|renderer|client)/", r"sleep_for|sleep_until|\busleep\(|[^\w]sleep\(", "a sleep in place of a condition"),
]


def code_only(text):
    """The text with comments and string contents blanked, line numbers kept."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match.group(0))
    pattern = r'//[^\n]*|/\*.*?\*/|R"\w*\(.*?\)\w*"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\''
    return re.sub(pattern, lambda m: m.group(0) if m.group(0).startswith('"') and "include" in line_of(text, m.start())
                  else blank(m), text, flags=re.S)


def line_of(text, position):
    start = text.rfind("\n", 0, position) + 1
    end = text.find("\n", position)
    return text[start:end if end >= 0 else len(text)]


def functions(code):
    """(line, length) of every brace block that follows a parameter list, outside other functions."""
    stack = []
    inside = 0
    for match in re.finditer(r"[{}]", code):
        if match.group() == "{":
            before = code[max(0, match.start() - 400):match.start()].rstrip()
            is_function = inside == 0 and re.search(
                r"\)\s*(const|noexcept|override|final|mutable|->\s*[\w:<>,\s&*]+|\s)*$|\)\s*:\s[^;{}]*[\w>)}]$", before) is not None
            stack.append((match.start(), is_function))
            inside += is_function
        elif stack:
            start, is_function = stack.pop()
            inside -= is_function
            if is_function:
                first = code.count("\n", 0, start) + 1
                yield first, code.count("\n", 0, match.start()) + 2 - first


def check_file(root, path, problems):
    name = path.relative_to(root).as_posix()
    text = path.read_text(encoding="utf-8")
    code = code_only(text)
    lines = text.count("\n")
    if lines > FILE_LINES_MAX and not name.endswith("_data.cpp"):
        problems.append(f"{name}:1: {lines} lines, more than {FILE_LINES_MAX}: split it by idea")
    for where, pattern, why in FORBIDDEN:
        if not re.search(where, name) or name.startswith("tests/architecture"):
            continue
        for match in re.finditer(pattern, code):
            problems.append(f"{name}:{code.count(chr(10), 0, match.start()) + 1}: {why}: {match.group().strip()}")
    for line, length in functions(code):
        if length > FUNCTION_LINES_MAX:
            problems.append(f"{name}:{line}: a function of {length} lines, more than {FUNCTION_LINES_MAX}")
    if path.suffix == ".h" and "#pragma once" not in text:
        problems.append(f"{name}:1: a header without #pragma once")


def check_includes(root, path, problems):
    """An include in quotes is the path of a header in the repository, or of a header generated from proto/."""
    name = path.relative_to(root).as_posix()
    for number, line in enumerate(path.read_text(encoding="utf-8").split("\n"), 1):
        match = re.match(r'\s*#include "([^"]+)"', line)
        if not match:
            continue
        header = match.group(1)
        generated = re.fullmatch(r"(proto/\w+)(\.grpc)?\.pb\.h", header)
        exists = (root / (generated.group(1) + ".proto")).is_file() if generated else (root / header).is_file()
        if not exists:
            problems.append(f"{name}:{number}: \"{header}\" is not a path in the repository")


def check_tests_registered(root, problems):
    """Every folder with tests is named in tests/CMakeLists.txt, so that ctest knows them."""
    listed = (root / "tests/CMakeLists.txt").read_text(encoding="utf-8")
    for path in sorted((root / "tests").rglob("*.cpp")):
        if "TEST(" not in path.read_text(encoding="utf-8") and "TEST_" not in path.read_text(encoding="utf-8"):
            continue
        folder = path.parent.relative_to(root / "tests").as_posix()
        box = folder.removeprefix("renderer/")
        if not re.search(rf"tessera_test\({folder}[ )]", listed) and not (
                folder.startswith("renderer/") and re.search(rf"\b{re.escape(box)}\b", listed)):
            problems.append(f"tests/{folder}: holds tests that tests/CMakeLists.txt does not build")


def check_top_level(root, problems):
    allowed = {"proto", "coordinator", "worker", "renderer", "client", "deploy", "tests", "build"}
    for path in root.iterdir():
        if path.is_dir() and not path.name.startswith(".") and path.name not in allowed:
            problems.append(f"{path.name}/: a top-level folder that is not in the plan of the house")


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    problems = []
    for box in BOXES:
        for path in sorted((root / box).rglob("*")):
            if path.suffix in CODE:
                check_file(root, path, problems)
                check_includes(root, path, problems)
    check_tests_registered(root, problems)
    check_top_level(root, problems)
    print("\n".join(problems))
    print(f"{len(problems)} broken rules")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
