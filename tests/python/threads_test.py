"""A Renderer in other threads, next to another Renderer, after close(), without close(), and after fork()."""

import ctypes
import os
import re
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import binosplat


def in_threads(works):
    threads = [threading.Thread(target=work) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def test_any_thread_may_draw(renderer, cameras):
    expected = {name: renderer.draw(cameras[name]).colour for name in ("front", "side")}
    assert not np.array_equal(expected["front"], expected["side"])
    wrong = []

    def draw(name):
        for _ in range(3):
            if not np.array_equal(renderer.draw(cameras[name]).colour, expected[name]):
                wrong.append(name)

    in_threads([lambda name=name: draw(name) for name in ("front", "side") * 2])
    assert not wrong


def test_caller_thread_has_no_context(renderer, cameras):
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetCurrentContext.restype = ctypes.c_void_p
    renderer.draw(cameras["front"])
    assert not egl.eglGetCurrentContext()  # so a context that the caller had made current stays so


def test_errors_reach_calling_thread(renderer, cameras):
    raised = []

    def draw():
        try:
            renderer.draw(cameras["front"].resized(32000, 32000))
        except binosplat.OutOfMemory as error:
            raised.append(error)

    in_threads([draw])
    assert len(raised) == 1


def test_renderers_coexist(model, cameras):
    with binosplat.Renderer(model, backend="surfaceless") as a:
        with binosplat.Renderer(model, backend="surfaceless", precision="half") as b:
            one, other = a.draw(cameras["front"]), b.draw(cameras["front"])
            assert not np.array_equal(one.colour, other.colour)
            assert np.array_equal(a.draw(cameras["front"]).colour, one.colour)


def test_closed_renderer_raises(model, cameras):
    renderer = binosplat.Renderer(model, backend="surfaceless")
    picture = renderer.draw(cameras["front"])
    renderer.close()
    renderer.close()
    with pytest.raises(binosplat.InputError, match="this Renderer is closed"):
        renderer.draw(cameras["front"])
    assert picture.colour.any()  # The picture outlives the Renderer.


@pytest.mark.parametrize("options, words", [
    ({"backend": "vulkan"}, "backend: 'vulkan' is not one of auto, device, surfaceless, osmesa"),
    ({"backend": "surfaceless", "device": 0}, "device 0: backend surfaceless has none"),
    ({"device": -1}, "device -1: devices are numbered from 0"),
    ({"backend": "device", "device": 1000}, "device 1000: EGL offers"),
    ({"precision": "quarter"}, "precision: 'quarter' is not one of full, half"),
])
def test_rejects_unavailable_devices(model, options, words):
    with pytest.raises(binosplat.InputError, match=re.escape(words)):
        binosplat.Renderer(model, **options)


def ends_well(code, scene):
    """Runs Python code with the scene's model as its argument, and returns its standard error."""
    ended = subprocess.run([sys.executable, "-c", code, scene / "model.ply"], capture_output=True, text=True,
                           timeout=120)
    assert ended.returncode == 0, ended.stderr
    return ended.stderr


OPENED = """
import builtins, os, sys, binosplat
model = binosplat.load_model(sys.argv[1])
camera = binosplat.frame(model, 32, 24)
renderer = binosplat.Renderer(model, backend="surfaceless")
renderer.draw(camera)
"""


@pytest.mark.parametrize("how", ["", "builtins.kept = renderer", "del model", "raise SystemExit(0)"])
def test_exits_cleanly_with_open_renderer(scene, how):
    ends_well(OPENED + how, scene)


FORKED = OPENED + """
child = os.fork()
if child == 0:
    said = []
    for attempt in (lambda: renderer.draw(camera), lambda: binosplat.Renderer(model)):
        try:
            attempt()
        except binosplat.InputError as error:
            said.append("before this process was forked" in str(error))
    del renderer
    os._exit(0 if said == [True, True] else 1)
status = os.waitpid(child, 0)[1]
renderer.draw(camera)  # the parent's still works
sys.exit(os.WEXITSTATUS(status))
"""


def test_forked_process_raises(scene):
    ends_well(FORKED, scene)


DAEMON = OPENED + """
import atexit, threading, time
camera = binosplat.frame(model, 320, 240)
drawn = threading.Event()

def draw_for_ever():
    while True:
        renderer.draw(camera)
        drawn.set()

def load_for_ever():
    while True:
        binosplat.frame(binosplat.load_model(sys.argv[1]), 32, 24)
        drawn.set()

def look_for_ever():
    while True:
        binosplat.look_at((1, 2, 3), (0, 0, 0), 32, 24)
        binosplat.find_cameras(sys.argv[1])
        drawn.set()

def open_for_ever():
    while True:
        binosplat.Renderer(model, backend="surfaceless").draw(camera)
        drawn.set()

def start(work):
    for _ in range(2):
        threading.Thread(target=work, daemon=True).start()
    drawn.wait()
"""


@pytest.mark.parametrize("how", [
    "start(draw_for_ever); del renderer",
    "start(draw_for_ever); time.sleep(0.05)",
    "start(load_for_ever)",
    "start(look_for_ever); time.sleep(0.02)",
    "start(open_for_ever)",
    "atexit.register(renderer.draw, camera); start(draw_for_ever)",
    "start(draw_for_ever); raise SystemExit(0)",
])
def test_exits_cleanly_with_daemon_threads(scene, how):
    for _ in range(3 if os.environ.get("BINOSPLAT_LONG") == "1" else 1):
        assert "terminate" not in ends_well(DAEMON + how, scene)


LATE = OPENED + """
class Late:
    def __del__(self, renderer=renderer, camera=camera):
        renderer.draw(camera)

def views():
    try:
        while True:
            yield renderer.draw(camera)
    finally:
        renderer.draw(camera)

late = Late()
some = views()
next(some)
"""


@pytest.mark.parametrize("how", ["", "builtins.kept = late", "del renderer"])
def test_drawing_at_exit_does_not_crash(scene, how):
    ends_well(LATE + how, scene)


PARALLEL = """
import multiprocessing, sys, binosplat

def width_of(path):
    model = binosplat.load_model(path)
    camera = binosplat.frame(model, 32, 24)
    return binosplat.Renderer(model, backend="surfaceless").draw(camera).colour.shape[1]

if __name__ == "__main__":
    path, method = sys.argv[1:]
    opened = binosplat.Renderer(binosplat.load_model(path), backend="surfaceless")
    try:
        with multiprocessing.get_context(method).Pool(2) as pool:
            print(pool.map(width_of, [path] * 2))
    except binosplat.InputError as error:
        print(error)
"""


@pytest.mark.parametrize("method, said", [
    ("spawn", "[32, 32]"), ("forkserver", "[32, 32]"), ("fork", "multiprocessing's method 'spawn'")])
def test_works_in_process_pools(scene, tmp_path, method, said):
    if method == "fork" and "tsan" in os.environ.get("LD_PRELOAD", ""):
        pytest.skip("the thread sanitizer ends a forked process that makes threads")
    (tmp_path / "pool.py").write_text(PARALLEL)
    ended = subprocess.run([sys.executable, tmp_path / "pool.py", scene / "model.ply", method], capture_output=True,
                           text=True, timeout=120)
    assert ended.returncode == 0, ended.stderr
    assert said in ended.stdout


LONG = """
import sys, time, binosplat
camera = binosplat.Camera(2500, 2500, 2200)
renderer = binosplat.Renderer(binosplat.load_model(sys.argv[1]), backend="surfaceless")
def small():
    begin = time.monotonic()
    assert renderer.draw(camera.resized(60, 60)).colour.any()
    return time.monotonic() - begin
usual = min(small() for _ in range(6))  # the first one compiles, and others may wait for the CPU
print("begins", flush=True)
try:
    HOW
except KeyboardInterrupt:
    print("interrupted", flush=True)
    WHAT
"""


def interrupted(scene, how, what):
    """Runs LONG and interrupts it with SIGINT. Returns its exit code, and (standard output, standard error)."""
    code = LONG.replace("HOW", how).replace("WHAT", what)
    with subprocess.Popen([sys.executable, "-c", code, scene / "model.ply"], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True) as running:
        assert running.stdout.readline() == "begins\n"
        time.sleep(0.1)  # of at least 0.35 s
        running.send_signal(signal.SIGINT)
        said = running.communicate(timeout=120)
    return running.returncode, said


@pytest.mark.parametrize("how", ["renderer.draw(camera)", "list(renderer.draw_all([camera]))"])
def test_ctrl_c_ends_long_draw(scene, how):
    code, (said, errors) = interrupted(scene, how, "raise")
    assert code == -signal.SIGINT and "KeyboardInterrupt" in errors and said == "interrupted\n", errors
    # The next draw waits until the long one ends. As it takes long, the exception came before that end.
    code, (said, errors) = interrupted(scene, how, "print(small() > 5 * usual)")
    assert code == 0 and said == "interrupted\nTrue\n", (said, errors)
