#!/usr/bin/env python3
"""Checks the rules of the source tree that the compiler does not check. Usage: check_tree.py SOURCE_DIR

Prints each violation as "file:line: what" and exits with code 1 if there is any.
"""
import pathlib
import re
import sys

FUNCTION_LINES_MAX = 70
FILE_LINES_MAX = 400
CODE = (".h", ".cpp")
PARTS = ("proto", "coordinator", "worker", "renderer", "client", "tests")
PROGRAMS = r"^(proto|coordinator|worker|renderer|client)/"

# Where gRPC and generated messages may be included: the code of both ends of a connection, and tests of it.
GRPC_FOLDERS = (r"^(proto/wire|client/(coordinator|doctor|live)|coordinator(/listener|/web)?|worker|"
                r"tests/(proto/wire|client/coordinator|coordinator(/listener|/web)?|worker|bench|end_to_end|chaos|fuzz))/[^/]*$")

# (files, pattern in the code outside comments and strings, message)
FORBIDDEN = [
    (r"^coordinator/core/", r"\b(system_clock|steady_clock|high_resolution_clock|std::chrono::\w+_clock|time\(nullptr\))",
     "the core must not read a clock; time is an argument of its events"),
    (r"^(coordinator/core/|worker/core/)",
     r"\b(std::thread|std::mutex|std::condition_variable|random_device)\b|#include <grpc|#include <thread>",
     "a core must not use threads, locks, the network or a random device"),
    (r"^coordinator/", r"#include [<\"]embree|rtcore", "the coordinator must not use the ray tracer"),
    (r"^renderer/", r"#include \"(proto|coordinator|worker|client)/", "the renderer must not depend on the farm"),
    (r"^renderer/(integrator|light|material|texture|shape|sampler|filter|camera|accelerator|math|color)/",
     r"\b(system_clock|high_resolution_clock)\b", "the renderer must not read the time of day"),
    (PROGRAMS, r"(?<![\w:.>])(std::)?s?rand\(|random_shuffle", "random numbers must come from the sampler"),
    (PROGRAMS, r"\bunordered_(map|set)\b.*\bfor\b", "the order of an unordered container must not reach a result"),
    (r"", r"-ffast-math|-march=native|-Ofast", "optimisations must not change values or depend on the machine"),
    (PROGRAMS, r"sleep_for|sleep_until|\busleep\(|[^\w]sleep\(", "wait for a condition instead of sleeping"),
    (r"^(?!renderer/util/dispatch\.h)", r"\bswitch\s*\([^;{]*\.index\(\)",
     "use Dispatch (renderer/util/dispatch.h) instead of a switch over the index of a variant"),
    (PROGRAMS, r"static_cast<(\w+::)*\w*Kind>\(\s*[a-z]\w*\s*\)",
     "look the kind up in a table instead of casting an index to it"),
]

# Words and phrases that are not plain technical English, with what to write instead. They are looked for in
# comments, strings and names; "at once" only in strings, because a comment may mean "at the same time".
PHRASES = [
    (r"\bNothing if\b", "write \"Returns nullopt if\" or \"Does nothing if\""),
    (r"\bso many\b(?! \w+ that)|\bso much\b(?! that| \w+ that)", "write \"n\", \"this many\" or \"that number\""),
    (r"\botherwise than\b", "write \"differs from\""),
    (r"(?i)\b(hungry|starved|starving)", "write \"idle\" or \"saturated\""),
    (r"(?i)\bcrew|Crew(?![a-z])", "write \"worker pool\" or \"threads\""),
    (r"(?i)\bcourier|Courier", "write \"sender\""),
    (r"(?i)\b(bury|buries|buried|graveyard)\b|\bBury", "write \"tombstone\" or \"delete\""),
    (r"(?i)\bcondemn|Condemn", "write \"fail\" or \"quarantine\""),
    (r"(?i)\b(disbelieve|enlist|delist)|Disbelieve|Enlist|Delist", "use the word of the field"),
    (r"(?i)\blast words\b|LastWords", "write \"last line\" or \"reason\""),
    (r"(?i)\bin whoever's hands\b|\bhelps? nobody\b|\bas far as one can (guess|tell)\b", "say it plainly"),
    (r"(?i)\b(damaged on (its|the) way|came damaged)\b", "write \"corrupt (SHA-256 mismatch)\""),
]
PHRASES_IN_STRINGS = [
    (r'\b(name|reason|text|notice|data_dir|workers|unit)=\\"\{',
     "write LogText(value): text from outside must not end a log field"),
    (r"(?i)\bat once\b", "write \"immediately\" or \"at the same time\""),
    (r"(?i)\bthan was said\b|\bgoes? first\b.*\bunused\b", "say it plainly"),
]


COMMENT_OR_STRING = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"\w*\(.*?\)\w*"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', flags=re.S)


def code_only(text):
    """The text with comments and string contents blanked, line numbers kept."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match.group(0))
    return COMMENT_OR_STRING.sub(
        lambda m: m.group(0) if m.group(0).startswith('"') and "include" in line_of(text, m.start()) else blank(m), text)


def strings_only(text):
    """The text with everything but string contents blanked, line numbers kept."""
    kept = re.sub(r"[^\n]", " ", text)
    for match in COMMENT_OR_STRING.finditer(text):
        if match.group(0).startswith(('"', "R")):
            kept = kept[:match.start()] + match.group(0) + kept[match.end():]
    return kept


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
        problems.append(f"{name}:1: {lines} lines, more than {FILE_LINES_MAX}; split the file by idea")
    for where, pattern, why in FORBIDDEN:
        if not re.search(where, name) or name.startswith("tests/architecture"):
            continue
        for match in re.finditer(pattern, code):
            problems.append(f"{name}:{code.count(chr(10), 0, match.start()) + 1}: {why}: {match.group().strip()}")
    if re.search(r'#include (<grpc|"proto/wire/|"proto/\w+\.(grpc\.)?pb\.h)', code) and not re.search(GRPC_FOLDERS, name):
        problems.append(f"{name}:1: gRPC and its messages belong in proto/wire and at both ends of a connection")
    for line, length in functions(code):
        if length > FUNCTION_LINES_MAX:
            problems.append(f"{name}:{line}: a function of {length} lines, more than {FUNCTION_LINES_MAX}; split it")
    if path.suffix == ".h" and "#pragma once" not in text:
        problems.append(f"{name}:1: a header without #pragma once")


def check_language(root, path, problems):
    """Comments, strings and names are plain technical English."""
    name = path.relative_to(root).as_posix()
    text = path.read_text(encoding="utf-8")
    # A phrase may be broken over two lines of a comment.
    joined = re.sub(r"\n(\s*//)", lambda m: " " * (len(m.group(0))), text)
    strings = strings_only(text)
    if re.search(PROGRAMS, name) and name != "proto/wire/channel.cpp":
        for match in re.finditer(r"; try again\"", strings):
            line = text.count("\n", 0, match.start()) + 1
            problems.append(f"{name}:{line}: answer TryAgain (proto/wire/channel.h): clients repeat only such calls")
    for source, phrases in ((joined, PHRASES), (strings, PHRASES_IN_STRINGS)):
        for pattern, advice in phrases:
            for match in re.finditer(pattern, source):
                line = text.count("\n", 0, match.start()) + 1
                problems.append(f"{name}:{line}: \"{match.group().strip()}\": {advice}")


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


def check_boxes_registered(root, problems):
    """Every folder with sources is a box of its own in the CMakeLists.txt of its part."""
    for part in PARTS:
        if part == "tests":
            continue
        listed = (root / part / "CMakeLists.txt").read_text(encoding="utf-8")
        folders = {path.parent for path in (root / part).rglob("*") if path.suffix in CODE}
        for folder in sorted(folders):
            box = folder.relative_to(root).as_posix()
            if not re.search(rf"tessera_box\({box}[\s)]", listed):
                problems.append(f"{box}: a folder with sources that {part}/CMakeLists.txt does not list as a box")


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
            problems.append(f"tests/{folder}: a folder with tests that tests/CMakeLists.txt does not build")


def anchors(page):
    """What a link may name after #, as GitHub makes it of headings."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), flags=re.M)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def check_links(root, page, problems):
    name = page.relative_to(root).as_posix()
    for number, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
        for target, anchor in re.findall(r"\]\(([^():#]*)(?:#([\w-]+))?\)", line):
            linked = page.parent / target if target else page
            if not linked.exists():
                problems.append(f"{name}:{number}: a link to {target}, which does not exist")
            elif anchor and anchor not in anchors(linked):
                problems.append(f"{name}:{number}: a link to {target}#{anchor}, but there is no such heading")


def check_guide(root, problems):
    """The documents name only paths that exist, their links lead somewhere, and README.md links every page of the guide."""
    parts = "|".join(PARTS + ("deploy",))
    pages = sorted((root / "client/guide").glob("*.md"))
    readme = (root / "README.md").read_text(encoding="utf-8")
    for page in pages:
        name = page.relative_to(root).as_posix()
        if f"]({name})" not in readme:
            problems.append(f"README.md:1: does not link {name}")
    for page in [*root.glob("*.md"), *pages]:
        name = page.relative_to(root).as_posix()
        check_links(root, page, problems)
        for number, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
            for path in re.findall(rf"`((?:{parts})/[\w./*]*)`", line):
                if "NAME" not in path and not list(root.glob(path.rstrip("/"))):
                    problems.append(f"{name}:{number}: {path} does not exist")


def check_release(root, problems):
    """The newest release in CHANGELOG.md is the one that the programs have."""
    named = re.search(r'kRelease = "([^"]+)"', (root / "renderer/util/release.h").read_text(encoding="utf-8")).group(1)
    newest = re.search(r"^## (\S+)", (root / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.M).group(1)
    if named != newest:
        problems.append(f"CHANGELOG.md:1: begins with {newest}, but renderer/util/release.h names {named}")


def check_top_level(root, problems):
    allowed = {"proto", "coordinator", "worker", "renderer", "client", "deploy", "tests", "build"}
    for path in root.iterdir():
        if path.is_dir() and not path.name.startswith(".") and path.name not in allowed:
            problems.append(f"{path.name}/: an unknown top-level folder; the map in CONTRIBUTING.md lists all")


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    problems = []
    for part in PARTS:
        for path in sorted((root / part).rglob("*")):
            if path.suffix in CODE:
                check_file(root, path, problems)
                check_includes(root, path, problems)
                check_language(root, path, problems)
    check_boxes_registered(root, problems)
    check_tests_registered(root, problems)
    check_guide(root, problems)
    check_release(root, problems)
    check_top_level(root, problems)
    print("\n".join(problems))
    print(f"{len(problems)} violations")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
