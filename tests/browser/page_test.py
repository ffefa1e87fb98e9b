#!/usr/bin/env python3
"""The web page in a real browser, with a real farm. Usage: page_test.py PROGRAMS SCENES"""
import hashlib
import os
import re
import shutil
import subprocess
import sys

from farm import Farm, await_that, start_browser
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

HOSTILE_NAME = "<img src=x onerror=document.title='owned'> \"'&"


def find(browser, selector):
    return browser.find_element(By.CSS_SELECTOR, selector)


def text_of(browser, selector):
    return find(browser, selector).text


def pixel_in_file(path, x, y, channels="R,G,B"):
    """Channels of a pixel of an EXR file: red, green and blue."""
    out = subprocess.run(["oiiotool", path, "--ch", channels, "--cut", f"1x1+{x}+{y}", "--printstats"], check=True,
                         capture_output=True, text=True).stdout
    return [float(word) for word in re.search(r"Stats Avg: ([-+.\de ]+?) ?\(", out).group(1).split()]


def canvas_digest(browser):
    return browser.execute_script("return document.querySelector('.picture').toDataURL().length + ':' + "
                                  "document.querySelector('.viewer').dataset.samplesDone")


def check_list(browser, farm, job):
    """The list shows the job by its name, as text, and a picture of it."""
    browser.get(farm.plain)
    row = await_that("the job in the list", lambda: find(browser, f"a[href='#/jobs/{job}']"))
    await_that("its name", lambda: row.text == HOSTILE_NAME)
    assert not browser.find_elements(By.CSS_SELECTOR, "img[src='x']")
    assert "owned" not in browser.title
    await_that("its small picture", lambda: browser.execute_script(
        "const i = document.querySelector('.c-picture img'); return i.complete && i.naturalWidth > 0"))
    small = lambda: browser.execute_script("""
        const image = document.querySelector('.c-picture img'), canvas = document.createElement('canvas');
        if (!image.complete || image.naturalWidth === 0) return null;
        const context = canvas.getContext('2d');
        context.drawImage(image, 0, 0, 80, 45);
        return [...context.getImageData(0, 0, 80, 45).data].join();
        """)
    before = await_that("its pixels", small)
    await_that("a newer small picture", lambda: small() not in (None, before))
    search = find(browser, "input[type=search]")
    search.send_keys("no such job")
    await_that("an empty list", lambda: text_of(browser, ".tools .soft") == "0 jobs")
    search.clear()
    search.send_keys(str(job), Keys.ENTER)
    await_that("one job", lambda: text_of(browser, ".tools .soft") == "1 job")
    find(browser, f"a[href='#/jobs/{job}']").click()


def check_picture_changes(browser):
    await_that("samples", lambda: int(find(browser, ".viewer").get_attribute("data-samples-done") or 0) > 0)
    before = canvas_digest(browser)
    await_that("a picture that changes", lambda: canvas_digest(browser) != before)


def check_control(browser, farm, job):
    priority = find(browser, "#priority")
    priority.clear()
    priority.send_keys("7")
    find(browser, "#set-priority").click()
    await_that("the priority", lambda: farm.status(job)["priority"] == 7)
    find(browser, "#pause").click()
    await_that("a pause", lambda: farm.status(job)["state"] == "paused")
    await_that("its display", lambda: text_of(browser, ".job-head .state") == "paused")
    find(browser, "#resume").click()
    await_that("the end of the pause", lambda: farm.status(job)["state"] != "paused")


def check_values(browser, farm, job):
    """Pixels under the cursor have the values of the file, and downloads are the file."""
    await_that("the end of the job", lambda: farm.status(job)["state"] == "finished")
    browser.get(f"{farm.plain}#/jobs/{job}")
    await_that("its download", lambda: f"/jobs/{job}/" in find(browser, "#exr").get_attribute("href"))
    await_that("the finished picture", lambda: find(browser, ".viewer").get_attribute("data-finished") == "true")
    path = f"{farm.folder}/fetched.exr"
    farm.tessera("fetch", str(job), "-o", path)
    find(browser, ".stage").send_keys(*[Keys.ARROW_RIGHT] * 20, *[Keys.ARROW_DOWN] * 11)
    value = find(browser, "#pixel-value")
    x, y = int(value.get_attribute("data-x")), int(value.get_attribute("data-y"))
    assert (x, y) != (0, 0)
    shown = [float(value.get_attribute(f"data-{c}")) for c in "rgb"]
    expected = pixel_in_file(path, x, y)
    assert all(abs(a - b) <= 1e-6 + 1e-5 * abs(b) for a, b in zip(shown, expected)), (shown, expected)
    find(browser, "#exr").click()
    download = f"{farm.folder}/job-{job}.exr"
    await_that("the download", lambda: os.path.exists(download))
    digests = [hashlib.sha256(open(name, "rb").read()).hexdigest() for name in (path, download)]
    assert digests[0] == digests[1]
    for curve in ("agx", "srgb", "false"):
        before = canvas_digest(browser)
        find(browser, f"#curve option[value={curve}]").click()
        await_that(f"the tone curve {curve}", lambda: canvas_digest(browser) != before)


def choose(browser, selector, value):
    find(browser, f"{selector} option[value='{value}']").click()


def shown_values(browser, count):
    value = find(browser, "#pixel-value")
    return [float(value.get_attribute(f"data-{c}")) for c in "rgb"[:count]]


def check_curve_of_compared_layer(browser):
    """A layer looks the same alone and beside a layer that has another curve."""
    viewer = find(browser, ".viewer")
    color_of = lambda canvas: browser.execute_async_script("""
        const done = arguments[1], canvas = document.querySelector(arguments[0]);
        const read = () => done(canvas.width === 96 ? [...canvas.getContext('2d').getImageData(48, 27, 1, 1).data].join() : '');
        requestAnimationFrame(() => requestAnimationFrame(read));
        """, canvas)
    choose(browser, "#layer", "albedo")
    await_that("the albedo", lambda: viewer.get_attribute("data-layer") == "albedo")
    alone = color_of(".picture:not(.other)")
    choose(browser, "#layer", "depth")
    await_that("the depth", lambda: viewer.get_attribute("data-layer") == "depth")
    choose(browser, "#compare", "layer albedo")
    await_that("the same colour", lambda: color_of(".picture.other") == alone)
    assert color_of(".picture:not(.other)") != alone
    choose(browser, "#compare", "")


def check_layers(browser, farm, scenes):
    """Layers have the values of the file, light groups are mixed, and two pictures are compared."""
    job = farm.submit(f"{scenes}/box.pbrt", "--spp", "16", "--resolution", "96x54", "--aov", "albedo,depth,variance",
                      "--light-group", "key=area", "--light-group", "sky=infinite")
    await_that("the end of the job", lambda: farm.status(job)["state"] == "finished")
    path = f"{farm.folder}/layers.exr"
    farm.tessera("fetch", str(job), "-o", path)
    browser.get(f"{farm.plain}#/jobs/{job}")
    viewer = lambda: find(browser, ".viewer")
    await_that("the finished picture", lambda: viewer().get_attribute("data-finished") == "true"
               and f"/jobs/{job}/" in find(browser, "#exr").get_attribute("href"))
    find(browser, ".stage").send_keys(*[Keys.ARROW_RIGHT] * 30, *[Keys.ARROW_DOWN] * 20)
    for layer, channels in (("albedo", "albedo.R,albedo.G,albedo.B"), ("depth", "depth.Z"), ("light_key", "light_key.R,light_key.G,light_key.B")):
        choose(browser, "#layer", layer)
        await_that(f"the layer {layer}", lambda: viewer().get_attribute("data-layer") == layer)
        find(browser, ".stage").send_keys(Keys.ARROW_RIGHT, Keys.ARROW_LEFT)
        value = find(browser, "#pixel-value")
        x, y = int(value.get_attribute("data-x")), int(value.get_attribute("data-y"))
        expected = pixel_in_file(path, x, y, channels)
        shown = shown_values(browser, len(expected))
        assert all(abs(a - b) <= 1e-6 + 1e-3 * abs(b) for a, b in zip(shown, expected)), (layer, shown, expected)
    check_curve_of_compared_layer(browser)
    choose(browser, "#layer", "~samples")
    await_that("samples per pixel", lambda: viewer().get_attribute("data-layer") == "~samples")
    find(browser, ".stage").send_keys(Keys.ARROW_RIGHT)
    assert shown_values(browser, 1) == [16]
    choose(browser, "#layer", "~noise")
    await_that("the noise", lambda: viewer().get_attribute("data-layer") == "~noise")
    find(browser, ".stage").send_keys(Keys.ARROW_RIGHT)
    assert 0 <= shown_values(browser, 1)[0] < 1
    choose(browser, "#layer", "~lights")
    await_that("the light groups", lambda: viewer().get_attribute("data-layer") == "~lights")
    before = canvas_digest(browser)
    browser.execute_script("const g = document.querySelector('.gain'); g.value = 0.25; g.dispatchEvent(new Event('input'))")
    await_that("another mixture", lambda: canvas_digest(browser) != before)
    words = text_of(browser, "#relight").split()
    assert words[:-1] == ["tessera", "relight", f"job-{job}.exr", "-o", f"job-{job}-relit.exr", "--gain"], words
    assert words[-1].endswith("=0.25"), words
    find(browser, "#keep").click()
    await_that("the line between two pictures", lambda: find(browser, ".wipe-line").is_displayed())
    choose(browser, "#compare", "layer albedo")
    await_that("the other picture", lambda: browser.execute_script(
        "const c = document.querySelector('.picture.other'); return c.width === 96 && "
        "c.getContext('2d').getImageData(48, 27, 1, 1).data[3] === 255"))
    choose(browser, "#compare", "")
    assert not find(browser, ".wipe-line").is_displayed()
    log = await_that("the log", lambda: text_of(browser, ".log"))
    assert "submitted by local" in log and "finished" in log, log


def check_sequence(browser, farm, scenes):
    """The frames of a sequence are in a strip, and play."""
    job = farm.submit(f"{scenes}/box.pbrt", "--spp", "1", "--resolution", "64x36", "--frames", "1-3")
    await_that("the end of the sequence", lambda: farm.status(job)["state"] == "finished")
    browser.get(f"{farm.plain}#/jobs/{job}")
    await_that("the strip", lambda: len(browser.find_elements(By.CSS_SELECTOR, ".cell.finished")) == 3)
    find(browser, "#play").click()
    seen = set()

    def all_played():
        seen.add(browser.execute_script("const s = document.querySelector('.screen'); "
                                        "return !s.hidden && s.width === 64 && s.dataset.frame"))
        return {"0", "1", "2"} <= seen

    await_that("all frames", all_played)
    find(browser, "#play").click()
    browser.find_elements(By.CSS_SELECTOR, ".cell")[2].click()
    await_that("the third frame", lambda: browser.current_url.endswith(f"#/jobs/{job}/2"))
    await_that("its mark", lambda: find(browser, ".cell[aria-current]").text == "3")


def check_extend_and_cancel(browser, farm, job):
    spp = find(browser, "#spp")
    spp.clear()
    spp.send_keys("100000")
    find(browser, "#extend").click()
    await_that("more samples", lambda: farm.status(job)["state"] in ("running", "waiting"))
    await_that("the button", lambda: find(browser, "#cancel").is_displayed())
    find(browser, "#cancel").click()
    browser.switch_to.alert.accept()
    await_that("the end", lambda: farm.status(job)["state"] == "cancelled")


def check_viewer(browser, farm, job):
    """Somebody with the role viewer logs in, sees the picture, and is refused changes."""
    address = farm.encrypted.removeprefix("https://").rstrip("/")
    token = farm.tessera("token", "--role", "viewer", "--name", "vic", "--address", address,
                         program="tessera-coordinator").split()[-1]
    browser.get(farm.encrypted)
    await_that("the form", lambda: find(browser, "#token")).send_keys(token, Keys.ENTER)
    await_that("the login", lambda: "vic (viewer)" in text_of(browser, "#who"))
    browser.get(f"{farm.encrypted}#/jobs/{job}")
    await_that("the job", lambda: text_of(browser, ".job-head .state") == "cancelled")
    assert not find(browser, "#cancel").is_displayed() and not find(browser, "#pause").is_displayed()
    status = browser.execute_async_script("""
        const done = arguments[1];
        fetch('/api/v1/me').then((r) => r.json()).then((me) => fetch(`/api/v1/jobs/${arguments[0]}/priority`, {
          method: 'POST', body: '{"priority": 3}',
          headers: {'Content-Type': 'application/json', 'X-Tessera-Proof': me.proof}})).then((r) => done(r.status));
        """, job)
    assert status == 403, status
    assert not find(browser, "#submit-link").is_displayed()
    refused = browser.execute_async_script("""
        const done = arguments[0], digest = 'a'.repeat(64);
        const send = (me, path, method, body) => fetch(`/api/v1/${path}`, {method, body,
          headers: {'Content-Type': 'application/json', 'X-Tessera-Proof': me.proof}}).then((r) => r.status);
        fetch('/api/v1/me').then((r) => r.json()).then(async (me) => done([
          await send(me, 'blobs/missing', 'POST', JSON.stringify({digests: [digest]})),
          await send(me, `blobs/${digest}`, 'PUT', 'x'),
          await send(me, 'jobs', 'POST', JSON.stringify({package: digest, scene_file: 'a.pbrt'}))]));
        """)
    assert refused == [403, 403, 403], refused
    assert farm.status(job)["priority"] != 3
    find(browser, "#who button").click()
    await_that("the form again", lambda: find(browser, "#token"))


def check_submit(browser, farm, scenes):
    """A chosen folder becomes the job that tessera submit makes of it, and what is there is not sent again."""
    folder = f"{farm.folder}/upload/shot"
    os.makedirs(f"{folder}/scene files/.hidden")
    os.makedirs(f"{folder}/maps")
    for name in ("box.pbrt", "box-walls.pbrt"):
        shutil.copy(f"{scenes}/{name}", f"{folder}/scene files/{name}")
    with open(f"{folder}/scene files/box.pbrt", "a") as scene:
        scene.write('\nAttributeBegin\nTexture "map" "spectrum" "imagemap" "string filename" "../maps/map \u00fc.pfm"\nAttributeEnd\n')
    with open(f"{folder}/maps/map \u00fc.pfm", "wb") as image:
        image.write(b"PF\n400 400\n-1.0\n" + b"\x00\x00\x00\x3f" * 480000)
    open(f"{folder}/scene files/second.pbrt", "w").write("no scene\n")
    open(f"{folder}/scene files/.hidden/secret", "w").write("not sent\n")
    browser.get(f"{farm.plain}#/jobs")
    find(browser, "body").send_keys("s")
    await_that("the form", lambda: find(browser, "#choose-folder").is_displayed())
    browser.execute_script("document.getElementById('folder').classList.remove('hidden')")
    find(browser, "#folder").send_keys(folder)
    await_that("the scene files", lambda: len(browser.find_elements(By.CSS_SELECTOR, "#scene option")) == 3)
    assert "4 files" in text_of(browser, "#found"), text_of(browser, "#found")
    assert find(browser, "#scene").get_attribute("value") == "scene files/box.pbrt"
    for field, value in (("name", "from the page"), ("priority", "3"), ("spp", "8"), ("width", "96"), ("height", "54"),
                         ("noise", "0.05"), ("layers", "normal, albedo"), ("frames", "1-2")):
        find(browser, f"#{field}").send_keys(Keys.CONTROL + "a" + Keys.NULL, value)
    find(browser, "#denoise").click()
    find(browser, "#name").send_keys(Keys.ENTER)
    await_that("the job", lambda: "#/jobs/" in browser.current_url and browser.current_url.rsplit("/", 1)[1].isdigit())
    job = int(browser.current_url.rsplit("/", 1)[1])
    await_that("its end", lambda: farm.status(job)["state"] == "finished")
    status = farm.status(job)
    assert (status["name"], status["priority"], status["frames_total"]) == ("from the page", 3, 2), status
    await_that("its picture", lambda: find(browser, ".viewer").get_attribute("data-finished") == "true")
    twin = farm.submit(f"{folder}/scene files/box.pbrt", "--spp", "8", "--resolution", "96x54", "--noise-threshold", "0.05",
                       "--aov", "albedo,normal", "--frames", "1-2", "--denoise")
    await_that("the end of its twin", lambda: farm.status(twin)["state"] == "finished")
    digests = []
    for number in (job, twin):
        for frame in (1, 2):
            path = f"{farm.folder}/same-{number}-{frame}.exr"
            farm.tessera("fetch", str(number), "--frame", str(frame), "-o", path)
            digests.append(hashlib.sha256(open(path, "rb").read()).hexdigest())
    assert digests[:2] == digests[2:], digests
    # The same folder again: nothing is sent. A scene that is wrong names its place.
    browser.get(f"{farm.plain}#/submit")
    await_that("an empty form", lambda: not find(browser, "#start").is_displayed())
    browser.execute_script("document.getElementById('folder').classList.remove('hidden')")
    find(browser, "#folder").send_keys(folder)
    await_that("the scene files again", lambda: find(browser, "#start").is_displayed())
    choose(browser, "#scene", "scene files/second.pbrt")
    browser.execute_script("window.texts = []; new MutationObserver(() => window.texts.push("
                           "document.getElementById('doing').textContent)).observe("
                           "document.getElementById('doing'), {childList: true, characterData: true, subtree: true})")
    find(browser, "#start").click()
    await_that("the job", lambda: "#/jobs/" in browser.current_url)
    bad = int(browser.current_url.rsplit("/", 1)[1])
    texts = browser.execute_script("return window.texts")
    assert any(re.match(r"Uploaded [01] of 5 files", each) for each in texts), texts
    await_that("the reason", lambda: "second.pbrt:1:1" in farm.status(bad)["reason"])
    await_that("the state on the page", lambda: "second.pbrt:1:1" in text_of(browser, "main"))
    assert text_of(browser, ".job-head .state") in ("preparing", "failed")
    assert "preparing" in farm.tessera("status", str(bad)) or "failed" in farm.tessera("status", str(bad))
    if farm.status(bad)["state"] == "preparing":
        find(browser, "#cancel").click()
        browser.switch_to.alert.accept()
        await_that("the end", lambda: farm.status(bad)["state"] in ("cancelled", "failed"))


def check_other_views(browser, farm):
    browser.get(f"{farm.plain}#/workers")
    await_that("the workers", lambda: "alpha" in text_of(browser, ".list") and "beta" in text_of(browser, ".list"))
    await_that("their memory", lambda: "MB" in text_of(browser, ".row.worker:not(.heads) .w-memory"))
    for button in browser.find_elements(By.CSS_SELECTOR, ".w-act button"):
        if "alpha" in button.get_attribute("aria-label"):
            button.click()
    await_that("a drain", lambda: "draining" in text_of(browser, ".list"))
    find(browser, "body").send_keys("f")
    await_that("the farm", lambda: "Alarms" in text_of(browser, "main") and "Samples/s" in text_of(browser, "main"))


def main():
    programs, scenes = sys.argv[1:]
    farm = Farm(programs)
    browser = None
    try:
        browser = start_browser(farm.folder)
        farm.start_worker(name="alpha")
        farm.start_worker(name="beta")
        # A job that does not end while the browser looks at it, however slow the machine is.
        endless = farm.submit(f"{scenes}/box.pbrt", "--spp", "1000000", "--resolution", "160x90", "--name", HOSTILE_NAME)
        check_list(browser, farm, endless)
        check_picture_changes(browser)
        check_control(browser, farm, endless)
        farm.tessera("cancel", str(endless))
        job = farm.submit(f"{scenes}/box.pbrt", "--spp", "64", "--resolution", "160x90")
        check_values(browser, farm, job)
        check_extend_and_cancel(browser, farm, job)
        check_layers(browser, farm, scenes)
        check_sequence(browser, farm, scenes)
        check_submit(browser, farm, scenes)
        check_other_views(browser, farm)
        severe = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"
                  and "thumbnail.png" not in entry["message"]]
        assert not severe, severe
        check_viewer(browser, farm, job)
    finally:
        if browser:
            browser.quit()
        farm.stop()


if __name__ == "__main__":
    main()
