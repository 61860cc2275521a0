"""Pictures as arrays: files, comparisons, and the example of docs/python.md."""

import json
import os
import re
from pathlib import Path

import numpy as np
import pytest

import binosplat


@pytest.fixture()
def pictures():
    random = np.random.default_rng(3)
    a = random.integers(0, 256, (24, 20, 3), dtype=np.uint8)
    b = np.clip(a + random.integers(-20, 21, a.shape), 0, 255).astype(np.uint8)
    return a, b


@pytest.mark.parametrize("ppd", [67, 30])
def test_compare_equals_program(pictures, program, tmp_path, ppd):
    a, b = pictures
    binosplat.save_png(tmp_path / "a.png", a)
    binosplat.save_png(tmp_path / "b.png", b)
    program("compare", tmp_path / "a.png", tmp_path / "b.png", "--ppd", ppd, "--json", tmp_path / "c.json")
    said = json.loads((tmp_path / "c.json").read_text())
    expected = (said["psnr_db"], said["ssim"], said["flip"], said["largest_error"]["value"])

    def found(a, b, **options):
        c = binosplat.compare(a, b, **options)
        return c.psnr, c.ssim, c.flip, c.largest_error

    assert found(a, b, ppd=ppd) == expected
    for name in ("float32", "float64", "uint16"):
        white = 65535 if name == "uint16" else 1
        as_type = [(np.float32(x) / 255 * white).astype(name) for x in (a, b)]
        assert found(*as_type, ppd=ppd) == expected, name
    row, column, channel = binosplat.compare(a, b).at
    assert (column, row) == (said["largest_error"]["x"], said["largest_error"]["y"])
    assert "red green blue".split()[channel] == said["largest_error"]["channel"]
    # Other pictures must give other values, as must another resolution (pixels per degree) for FLIP.
    assert found(a, b[::-1], ppd=ppd)[0] != expected[0]
    assert found(a, b, ppd=ppd + 20)[2] != expected[2]


def test_compares_equal_and_grey_pictures(pictures):
    a, _ = pictures
    same = binosplat.compare(a, a)
    assert same.psnr == np.inf and same.ssim == 1 and same.flip == 0 and same.largest_error == 0
    grey = a[..., 0]
    assert binosplat.compare(grey, np.dstack([grey] * 3)).psnr == np.inf
    assert binosplat.compare(grey[..., None], a).psnr < 30
    assert binosplat.compare(a[:, ::-1], a[:, ::-1].copy()).psnr == np.inf  # negative strides
    assert "psnr=inf" in repr(same)


def test_rejects_floats_up_to_255(pictures, tmp_path):
    a, b = pictures
    dark = np.zeros((24, 20, 3))
    dark[0, 0] = 7.0  # dark, but has the range of 8-bit values
    noisy = np.float32(b) + np.float32(0.25)
    for wrong in (np.float32(a), np.float64(b), dark, noisy):
        for use in (lambda x: binosplat.compare(a, x), lambda x: binosplat.save_png(tmp_path / "a.png", x),
                    binosplat.quantised):
            with pytest.raises(binosplat.InputError, match="floats have white 1, but these go up to"):
                use(wrong)
    assert not (tmp_path / "a.png").exists()
    overshooting = np.float32(a) / 255
    overshooting[:4] += 3  # values above white are allowed, as in a sunlit window
    assert binosplat.compare(overshooting, a).psnr < 20
    assert binosplat.quantised(np.eye(5)).max() == 1


def test_writes_png_only(pictures, tmp_path):
    for name in ("a.jpg", "a", "a.png.exr"):
        with pytest.raises(binosplat.InputError, match="the name must end in .png"):
            binosplat.save_png(tmp_path / name, pictures[0])
    binosplat.save_png(tmp_path / "A.PNG", pictures[0])
    assert [file.name for file in tmp_path.iterdir()] == ["A.PNG"]


@pytest.mark.parametrize("shape", [(), (5,), (24, 20, 2), (24, 20, 5), (2, 24, 20, 3), (0, 20, 3)])
def test_rejects_other_shapes(pictures, shape):
    with pytest.raises(binosplat.InputError):
        binosplat.compare(np.zeros(shape, np.float32), np.zeros(shape, np.float32))


def test_single_alpha_is_composited_over_black(pictures):
    a, b = pictures
    opaque = np.dstack([b, np.full(b.shape[:2], 255, np.uint8)])
    assert binosplat.compare(a, opaque).psnr == binosplat.compare(a, b).psnr
    clear = np.dstack([b, np.zeros(b.shape[:2], np.uint8)])
    assert binosplat.compare(a, clear).psnr == binosplat.compare(a, np.zeros_like(b)).psnr


def test_rejects_incomparable_pictures(pictures):
    a, b = pictures
    with pytest.raises(binosplat.InputError) as raised:
        binosplat.compare(a, b[:-1])
    assert "pictures of 20 x 24 and 20 x 23 px cannot be compared" in str(raised.value)
    with pytest.raises(binosplat.InputError):
        binosplat.compare(a, b, ppd=0)
    huge = np.broadcast_to(np.zeros(1, np.float32), (1 << 20, 1 << 20))  # a broadcast view, which takes no memory
    with pytest.raises(binosplat.InputError, match="is no picture"):
        binosplat.compare(huge, huge)


def test_compare_rejects_pictures_without_all_measures(pictures):
    a, b = (np.float32(picture) / 255 for picture in pictures)
    assert binosplat.compare(a[:11, :11], b[:11, :11]).ssim < 1
    with pytest.raises(binosplat.InputError, match="pictures of 20 x 10 px: SSIM needs 11 x 11 or more"):
        binosplat.compare(a[:10], b[:10])
    for value in (np.nan, np.inf):
        broken = b.copy()
        broken[3, 5, 1] = value
        with pytest.raises(binosplat.InputError, match="b: row 3, column 5 has a NaN or an infinity"):
            binosplat.compare(a, broken)


@pytest.mark.parametrize("wrong", ["complex64", "int64", "bool", "float16", "object", ">f4", "U3"])
def test_rejects_other_types(pictures, wrong):
    with pytest.raises(TypeError, match="arrays of float32"):
        binosplat.compare(np.zeros((4, 4)).astype(wrong), np.zeros((4, 4)))
    for no_array in (None, "a.png"):
        with pytest.raises(TypeError):
            binosplat.quantised(no_array)


def test_files_round_trip(pictures, tmp_path):
    a, _ = pictures
    binosplat.save_png(tmp_path / "a.png", a)
    assert np.array_equal(binosplat.load_image(tmp_path / "a.png"), np.float32(a) / np.float32(255))
    exact = np.float32([[0.3, 0.7], [-1, 2]])
    binosplat.save_png(tmp_path / "b.png", exact)
    assert np.array_equal(binosplat.load_image(tmp_path / "b.png"), binosplat.quantised(exact))
    binosplat.save_png(tmp_path / "b.png", exact, bits=16)
    assert not np.array_equal(binosplat.load_image(tmp_path / "b.png"), binosplat.quantised(exact))
    with pytest.raises(binosplat.InputError, match="bits 12"):
        binosplat.save_png(tmp_path / "b.png", exact, bits=12)
    (tmp_path / "broken.png").write_bytes((tmp_path / "a.png").read_bytes()[:100])
    for name in ("broken.png", "missing.png", ""):
        with pytest.raises(binosplat.InputError, match=re.escape(str(tmp_path))):
            binosplat.load_image(tmp_path / name)


def test_applies_exposures(scene, renderer, cameras, tmp_path):
    run = tmp_path / "run"
    ply = run / "point_cloud/iteration_7/point_cloud.ply"
    ply.parent.mkdir(parents=True)
    ply.write_bytes((scene / "model.ply").read_bytes())
    (run / "cameras.json").write_bytes((scene / "cameras.json").read_bytes())
    assert binosplat.find_exposures(ply) is None
    rows = [[0.8, 0.1, 0, 0.02], [0.05, 0.9, 0, 0], [0, 0.2, 0.7, 0.1]]
    (run / "exposure.json").write_text(json.dumps({"front.png": rows}))
    assert binosplat.find_exposures(ply) == run / "exposure.json"
    exposures = binosplat.load_exposures(run / "exposure.json")
    assert len(exposures) == 1 and exposures.source == str(run / "exposure.json")
    np.testing.assert_allclose(exposures.of("front"), rows, rtol=1e-6)
    np.testing.assert_array_equal(exposures.of("side"), np.eye(3, 4))

    drawn = renderer.draw(cameras["front"]).colour
    changed = binosplat.exposed(drawn, exposures.of("front"))
    matrix = np.asarray(rows, np.float32)
    np.testing.assert_allclose(changed, drawn @ matrix[:, :3] + matrix[:, 3], atol=1e-6)
    assert np.abs(changed - (drawn @ matrix[:, :3].T + matrix[:, 3])).max() > 0.01  # injected fault: transposed

    for wrong in (drawn[..., :1], np.dstack([drawn, drawn[..., 0]])):
        with pytest.raises(binosplat.InputError, match="an exposure is of RGB"):
            binosplat.exposed(wrong, rows)
    (run / "exposure.json").write_text('{"front.png": [[1]]}')
    with pytest.raises(binosplat.InputError, match="key 'front.png'"):
        binosplat.load_exposures(run / "exposure.json")


def test_documented_example_runs(scene, renderer, cameras, tmp_path, capsys, monkeypatch):
    text = Path(os.environ["BINOSPLAT_SOURCE_DIR"], "docs/python.md").read_text()
    example = re.search(r"```python\n# evaluate\.py.*?\n(.*?)```", text, re.S).group(1)
    assert len(example.splitlines()) == 10
    for name in ("model.ply", "cameras.json"):
        (tmp_path / name).write_bytes((scene / name).read_bytes())
    monkeypatch.setattr("sys.argv", ["evaluate.py", str(tmp_path / "model.ply")])
    (tmp_path / "images").mkdir()
    pixels = 72 * 48

    def said(wrong_pixels):
        """Returns what the example prints for two photos, of which 1 and `wrong_pixels` pixels are off by 51 of 255."""
        for name, count in (("front", 1), ("side", wrong_pixels)):
            photo = binosplat.quantised(renderer.draw(cameras[name]).colour)
            flat = photo.reshape(-1, 3)[:count]
            flat += np.where(flat > 0.5, -0.2, 0.2).astype(np.float32)
            binosplat.save_png(tmp_path / "images" / f"{name}.png", photo)
        exec(compile(example, "evaluate.py", "exec"), {})
        line = capsys.readouterr().out
        assert line.startswith("2 photos: [")
        return [float(number) for number in line[line.index("[") + 1:line.index("]")].split()]

    def psnr(count):
        return -10 * np.log10(0.2**2 * count / pixels)

    for count in (1, 100):
        mean = said(count)
        assert mean[0] == pytest.approx((psnr(1) + psnr(count)) / 2, abs=1e-3)
        assert 0.5 < mean[1] < 1 and 0 < mean[2] < 0.1
