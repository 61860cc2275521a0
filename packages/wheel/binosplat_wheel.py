"""Builds the wheel: what pip asks of a project (PEP 517), by CMake and scripts/bundle.sh.

The wheel has the module, the programs, the libraries that they need, and a command `binosplat` which starts the
program. It serves one version of Python, and Linux with this machine's glibc or a newer one.
"""

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

START = '''"""The command `binosplat`: the program, which lies beside this file."""

import os
import sys
from pathlib import Path


def main():
    program = Path(__file__).with_name("bin") / "binosplat"
    os.execv(program, [str(program), *sys.argv[1:]])


if __name__ == "__main__":
    main()
'''


def version():
    return re.search(r"project\(binosplat VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)


def tag():
    """The Python, and the glibc, that the wheel is for."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")
    machine = sysconfig.get_platform().rsplit("-", 1)[1]
    return f"{python}-{python}-manylinux_{glibc}_{machine}"


def metadata():
    project = (ROOT / "pyproject.toml").read_text()

    def value(key):
        return re.search(rf'^{key} = "(.*)"$', project, re.M).group(1)

    return (f"Metadata-Version: 2.1\nName: binosplat\nVersion: {version()}\nSummary: {value('description')}\n"
            f"License: MIT\nRequires-Python: {value('requires-python')}\nRequires-Dist: numpy\n"
            f"Description-Content-Type: text/markdown\n\n{(ROOT / 'README.md').read_text()}")


def tell(text):
    """Shows a line on the terminal, since pip keeps what a builder prints to itself (unless with -v)."""
    try:
        with open("/dev/tty", "w") as terminal:
            print(text, file=terminal)
    except OSError:
        print(text, flush=True)


def build(folder):
    """Builds with the Python that runs this, below build/wheel, and returns that folder."""
    name = f"wheel-{sys.version_info.major}.{sys.version_info.minor}"
    where = Path(os.environ.get("BINOSPLAT_WHEEL_BUILD", ROOT / "build" / name))
    options = ["-DBINOSPLAT_TESTS=OFF", "-DBINOSPLAT_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}",
               f"-DCMAKE_CXX_FLAGS=-ffile-prefix-map={ROOT}=."]
    cores = str(os.cpu_count())
    tell(f"binosplat: compiling in {where} on {cores} cores takes minutes; pip install -v shows each step")
    for command in (["cmake", "--preset", "release", "-B", str(where), "--log-level=NOTICE", *options],
                    ["cmake", "--build", str(where), "-j", cores],
                    ["cmake", "--install", str(where), "--prefix", str(folder), "--strip"]):
        try:
            subprocess.run(command, cwd=ROOT, check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            needed = " ".join(re.findall(r"^[a-z].*", (ROOT / "packages/build.txt").read_text(), re.M))
            raise SystemExit(f"{error}\nbinosplat is built by a compiler and these packages. On Debian:\n"
                             f"  apt install {needed} patchelf pybind11-dev python3-dev") from None


def package(folder):
    """The package that the wheel holds, and what is in it, from what CMake installed below a folder."""
    (module,) = folder.rglob("binosplat/__init__.py")
    package = module.parent
    shutil.copytree(folder / "bin", package / "bin")
    (package / "_program.py").write_text(START)
    files = [*sorted((package / "bin").iterdir()), *sorted(package.glob("*.so"))]
    bundled = subprocess.run([ROOT / "scripts/bundle.sh", package / "lib", *files], check=True, text=True,
                             stdout=subprocess.PIPE).stdout
    subprocess.run([ROOT / "scripts/licences.sh", package / "licences"], check=True, text=True, input=bundled)
    return package


def add(wheel, records, name, content, mode=0o644):
    when = time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", time.time())))[:6]
    info = zipfile.ZipInfo(name, max(when, (1980, 1, 1, 0, 0, 0)))
    info.external_attr = (0o100000 | mode) << 16
    info.compress_type = zipfile.ZIP_DEFLATED
    wheel.writestr(info, content)
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    records.append(f"{name},sha256={digest},{len(content)}")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    if not shutil.which("patchelf"):
        raise SystemExit("There is no patchelf, which the wheel takes its libraries along with (Debian: apt install patchelf)")
    name = f"binosplat-{version()}-{tag()}.whl"
    about = f"binosplat-{version()}.dist-info"
    with tempfile.TemporaryDirectory() as folder:
        build(Path(folder))
        content = package(Path(folder))
        whole = Path(wheel_directory, name)
        records = []
        with zipfile.ZipFile(whole.with_suffix(".part"), "w") as wheel:
            for path in sorted(path for path in content.rglob("*") if path.is_file()):
                mode = 0o755 if os.access(path, os.X_OK) else 0o644
                add(wheel, records, f"binosplat/{path.relative_to(content).as_posix()}", path.read_bytes(), mode)
            add(wheel, records, f"{about}/METADATA", metadata().encode())
            add(wheel, records, f"{about}/WHEEL",
                f"Wheel-Version: 1.0\nGenerator: binosplat\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode())
            add(wheel, records, f"{about}/entry_points.txt", b"[console_scripts]\nbinosplat = binosplat._program:main\n")
            record = "\n".join([*records, f"{about}/RECORD,,", ""])
            add(wheel, [], f"{about}/RECORD", record.encode())
        whole.with_suffix(".part").rename(whole)
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit("binosplat has no source distribution: clone the repository, and pip install it")


if __name__ == "__main__":
    print(Path(sys.argv[1], build_wheel(sys.argv[1])))
