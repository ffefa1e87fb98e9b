#!/usr/bin/env python3
"""The page with 5,000 jobs and 1,000 workers. Prints its figures. Usage: large_farm_test.py PROGRAMS"""
import os
import subprocess
import sys
import tempfile

from farm import await_that, start_browser
from selenium.webdriver.common.by import By

# Generous, for loaded machines; the figures are printed.
PAINT_MAX_MS = 10_000
INTERACTION_MAX_MS = 2_000
HEAP_MAX_MB = 64
ROWS_MAX = 120


def timed(browser, script):
    """Milliseconds from an action to the paint after its effect."""
    return browser.execute_async_script("""
        const done = arguments[0], start = performance.now();
        (async () => { %s })().then(() => requestAnimationFrame(() => setTimeout(() => done(performance.now() - start))));
        """ % script)


def wait_for(condition):
    return "while (!(%s)) await new Promise((r) => setTimeout(r, 4));" % condition


def tab_mb(profile):
    """Resident memory of the process that renders the tab, and of it what it shares with no other process."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/cmdline") as command:
                words = command.read()
            if "--type=renderer" not in words or "--extension-process" in words or profile not in parents(pid):
                continue
            with open(f"/proc/{pid}/smaps_rollup") as file:
                sizes = dict(line.split()[:2] for line in file if line.split()[0].endswith(":"))
            found.append((int(sizes["Rss:"]) / 1e3, (int(sizes["Private_Clean:"]) + int(sizes["Private_Dirty:"])) / 1e3))
        except OSError:  # it has ended
            continue
    return max(found)


def parents(pid):
    """The command lines of the processes that started a process."""
    commands = ""
    while pid not in ("0", "1"):
        with open(f"/proc/{pid}/stat") as file:
            pid = file.read().rsplit(")", 1)[1].split()[1]
        with open(f"/proc/{pid}/cmdline") as command:
            commands += command.read()
    return commands


def main():
    farm = subprocess.Popen([f"{sys.argv[1]}/web_farm"], stdout=subprocess.PIPE, text=True)
    browser = None
    with tempfile.TemporaryDirectory(prefix="tessera-browser-") as folder:
        try:
            browser = start_browser(folder)
            address = farm.stdout.readline().strip()
            browser.get(address)
            await_that("the list", lambda: "5000 jobs" in browser.find_element(By.CSS_SELECTOR, ".tools .soft").text)
            paint = browser.execute_script(
                "return performance.getEntriesByName('first-contentful-paint')[0].startTime")
            rows = browser.execute_script(
                "return performance.getEntriesByType('resource').filter((e) => e.name.includes('/jobs?'))[0].responseEnd")
            figures = {
                "first paint": paint,
                "first rows": rows,
                "scroll to the middle": timed(browser, "scrollTo(0, 160000);" + wait_for(
                    "[...document.querySelectorAll('.row.job:not(.pending)')].some((r) => { const y = "
                    "r.getBoundingClientRect().top; return y > 0 && y < innerHeight; })")),
            }
            shown = len(browser.find_elements(By.CSS_SELECTOR, ".row.job:not(.heads)"))
            figures["search"] = timed(browser, "const s = document.querySelector('input[type=search]'); s.value = 'shot 001'; "
                                      "s.dispatchEvent(new Event('input'));" +
                                      wait_for("document.querySelector('.tools .soft').textContent === '7 jobs'"))
            browser.get(f"{address}#/workers")
            await_that("the workers", lambda: "1000 workers" in browser.find_element(By.CSS_SELECTOR, ".tools .soft").text)
            await_that("the matrix", lambda: browser.find_element(By.CSS_SELECTOR, ".matrix").size["height"] > 50)
            figures["change of the view"] = timed(browser, "location.hash = '#/jobs';" + wait_for(
                "document.querySelectorAll('.row.job:not(.pending):not(.heads)').length > 5"))
            browser.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
            heap_mb = browser.execute_script("return performance.memory.usedJSHeapSize") / 1e6
            for name, value in figures.items():
                print(f"{name}: {value:.0f} ms")
            resident, private = tab_mb(folder)
            print(f"rows that are elements: {shown}; JavaScript heap: {heap_mb:.1f} MB; "
                  f"process of the tab: {resident:.0f} MB resident, {private:.0f} MB of it its own")
            assert paint < PAINT_MAX_MS and rows < PAINT_MAX_MS
            assert all(value < INTERACTION_MAX_MS for value in list(figures.values())[2:]), figures
            assert 5 < shown < ROWS_MAX and heap_mb < HEAP_MAX_MB
        finally:
            if browser:
                browser.quit()
            farm.terminate()
            farm.wait()


if __name__ == "__main__":
    main()
