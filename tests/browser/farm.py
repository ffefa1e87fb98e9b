"""A farm of real processes, and a browser that looks at it."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

SKIPPED = 77
PATIENCE_S = 240


def skip(reason):
    print(f"SKIPPED: {reason}")
    sys.exit(SKIPPED)


try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError:
    skip("python3-selenium is not installed")


def await_that(what, condition):
    """Waits until a condition holds, and returns what it returns."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        try:
            value = condition()
        except Exception as error:  # elements that are being replaced
            value, what = None, f"{what} ({type(error).__name__})"
        if value:
            return value
        if time.monotonic() > deadline:
            raise AssertionError(f"{what} did not come true in {PATIENCE_S} s")
        time.sleep(0.2)


class Farm:
    def __init__(self, programs):
        self.programs = programs
        self.folder = tempfile.mkdtemp(prefix="tessera-browser-")
        self.socket = f"unix:{self.folder}/socket"
        self.processes = []
        log = open(f"{self.folder}/coordinator.log", "w")
        self.start([f"{programs}/tessera-coordinator", "--listen", self.socket, "--http", "127.0.0.1:0", "--https",
                    "127.0.0.1:0", "--data-dir", f"{self.folder}/data"], log)
        self.plain = await_that("the page", lambda: self.address("http"))
        self.encrypted = await_that("the encrypted page", lambda: self.address("https"))

    def address(self, scheme):
        with open(f"{self.folder}/coordinator.log") as log:
            found = re.search(rf"page at ({scheme}://\S+)", log.read())
        return found and found.group(1)

    def start(self, command, output=subprocess.DEVNULL):
        environment = dict(os.environ, XDG_CACHE_HOME=f"{self.folder}/cache")
        self.processes.append(subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, env=environment))

    def start_worker(self, threads=1, name="worker"):
        self.start([f"{self.programs}/tessera-worker", "--coordinator", self.socket, "--threads", str(threads), "--name",
                    name])

    def tessera(self, *arguments, program="tessera"):
        command = [f"{self.programs}/{program}", *arguments, "--coordinator", self.socket]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(f"{' '.join(command)}: {done.stderr}")
        return done.stdout.strip()

    def submit(self, scene, *options):
        return int(self.tessera("submit", scene, *options))

    def status(self, job):
        return json.loads(self.tessera("status", str(job), "--json"))

    def stop(self):
        for process in reversed(self.processes):
            process.terminate()
        for process in self.processes:
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()
        shutil.rmtree(self.folder, ignore_errors=True)


def start_browser(folder, width=1280, height=900, dark=False):
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not chromium or not driver:
        skip("chromium or chromium-driver is not installed")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     "--ignore-certificate-errors", f"--user-data-dir={folder}/profile{width}{dark}",
                     f"--window-size={width},{height}", "--hide-scrollbars"):
        options.add_argument(argument)
    options.add_experimental_option("prefs", {"download.default_directory": folder})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(service=Service(driver), options=options)
    browser.set_script_timeout(60)
    if dark:
        set_dark(browser, True)
    return browser


def set_dark(browser, is_dark):
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
        "features": [{"name": "prefers-color-scheme", "value": "dark" if is_dark else "light"}]})


def set_phone(browser, width=390, height=844):
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": height, "deviceScaleFactor": 2, "mobile": True})
