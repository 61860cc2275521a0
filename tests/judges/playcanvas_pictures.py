"""playcanvas_pictures.py CHECKOUT: compares pictures with splat-transform's golden renders of the same scenes.

splat-transform's alpha is sigma (exp(-q/2) - exp(-4.5)), so its Gaussians end at three standard deviations. With this
alpha, reference.py must equal the golden picture within 8-bit rounding. With ours, it must equal binosplat's exact
picture.
"""
import sys

import binosplat
import numpy as np
from PIL import Image

import reference

FLOOR = np.exp(-4.5)
CASES = {"tiny": (20, 1.0, 0.1, (0, 5, -8), (320, 240)), "mid": (220, 0.3, 0.05, (0, 10, -15), (640, 360))}


def grid(count, spacing, scale):
    """Returns the scene of test/fixtures/generator.mjs: a floor of equal round Gaussians."""
    gz, gx = np.divmod(np.arange(count * count), count)
    place = np.stack([(gx - count / 2) * spacing, 0 * gx, (gz - count / 2) * spacing], axis=1)
    colour = np.stack([(gx + 1) / (count + 1), (gz + 1) / (count + 1), np.full(gx.shape, 0.5)], axis=1)
    n = len(place)
    return binosplat.Model(place.astype(np.float32), np.tile(np.float32([0, 0, 0, 1]), (n, 1)),
                           np.full((n, 3), scale, np.float32), np.full(n, 0.9, np.float32),
                           ((colour - 0.5) / 0.28209479177387814).astype(np.float32)[:, None, :])


def looking(position, size):
    """Returns splat-transform's camera: it looks at the origin, y is up, the vertical field of view is 60 degrees."""
    forward = -np.array(position, float) / np.linalg.norm(position)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward], axis=1)
    return binosplat.Camera(size[0], size[1], 0.5 * size[1] / np.tan(np.radians(30)), position=position,
                            rotation=rotation)


def main(checkout):
    for name, (count, spacing, scale, position, size) in CASES.items():
        model, camera = grid(count, spacing, scale), looking(position, size)
        golden = np.asarray(Image.open(f"{checkout}/test/fixtures/golden-render/{name}.webp"))[..., :3] / 255
        plain, floored = reference.render(model, camera), np.clip(reference.render(model, camera, floor=FLOOR), 0, 1)
        ours = binosplat.Renderer(model).draw(camera, near_plane=0.2).colour
        off = np.abs(np.round(floored * 255) - np.round(golden * 255))
        without = reference.psnr(np.clip(plain, 0, 1), golden)
        reference.tell(f"{name}: their picture against the reference with their alpha "
                       f"{reference.psnr(floored, golden):.1f} dB, "
                       f"{np.mean(off > 0):.2%} of the bytes off, by {off.max():.0f} at most; "
                       f"without the floor {without:.1f} dB; "
                       f"our exact picture against the reference {reference.psnr(ours, plain):.1f} dB",
                       off.max() <= 1 and np.mean(off > 0) < 0.001 and without < 50
                       and reference.psnr(ours, plain) > 100)


if __name__ == "__main__":
    main(sys.argv[1])
