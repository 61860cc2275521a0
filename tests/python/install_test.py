"""The installed module can be imported after its folder is moved."""

import os
import subprocess
import sys

CODE = """
import sys, binosplat
renderer = binosplat.Renderer(binosplat.load_model(sys.argv[1]), backend="surfaceless")
assert renderer.draw(binosplat.load_cameras(sys.argv[2])[0]).colour.any()
print(binosplat.__file__)
"""


def test_installed_module_draws(scene, tmp_path):
    install = [os.environ["BINOSPLAT_CMAKE"], "--install", os.environ["BINOSPLAT_BUILD_DIR"], "--component"]
    subprocess.run([*install, "python", "--prefix", tmp_path / "first"], check=True, capture_output=True)
    (tmp_path / "first").rename(tmp_path / "prefix")
    (module,) = (tmp_path / "prefix").rglob("binosplat/__init__.py")
    assert {file.suffix for file in module.parent.iterdir()} == {".py", ".so", ".typed"}
    environment = {**os.environ, "PYTHONPATH": str(module.parent.parent)}
    command = [sys.executable, "-c", CODE, scene / "model.ply", scene]
    ended = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.strip() == str(module)
