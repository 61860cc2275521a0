"""edges.py MODEL CAMERAS VIEW [DEGREES]: what holding slopes near the picture costs, against rays.

3D-GS holds the two slopes of a Gaussian's place near the picture, each by itself, which turns the ellipses of those
beyond its edge; gsplat's pull request 977 keeps their axes, and only the sizes of the held ones. Truth here is the ray:
exp(-q/2) at the point of it that is nearest to the Gaussian's middle by the Gaussian's own measure. Nothing has a
low-pass, so that the projection alone differs. The view is widened to DEGREES (100), 96 px across.
"""
import sys

import binosplat
import numpy as np

import twin


def kept_axes(held, free):
    """gsplat's pull request 977: the sizes of the held ellipse along the axes of the free one."""
    def parts(c):
        middle = 0.5 * (c[:, 0, 0] + c[:, 1, 1])
        return middle, np.hypot(0.5 * (c[:, 0, 0] - c[:, 1, 1]), c[:, 0, 1])
    middle_held, gap_held = parts(held)
    middle_free, gap_free = parts(free)
    share = np.divide(gap_held, gap_free, out=np.ones_like(gap_held), where=gap_free > 0)
    return share[:, None, None] * free + (middle_held - share * middle_free)[:, None, None] * np.eye(2)


def rays(model, camera, part=lambda i: np.s_[:, :]):
    """q of each Gaussian along the rays of a part of the picture, or of all, as a function of its number."""
    y, x = np.mgrid[0:camera.height, 0:camera.width]
    way = np.stack([(x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, np.ones(x.shape)], axis=-1)
    way = way @ np.asarray(camera.rotation, float).T
    inverse = np.swapaxes(twin.turns(model.quats.astype(float)), 1, 2) / model.scales.astype(float)[:, :, None]
    away = np.einsum("nij,nj->ni", inverse, model.means.astype(float) - np.asarray(camera.position, float))

    def q(i):
        d = way[part(i)] @ inverse[i].T
        along = d @ away[i]
        least = away[i] @ away[i] - along * along / np.maximum(np.einsum("...j,...j->...", d, d), 1e-300)
        return part(i), np.where(along > 0, least, np.inf)

    return q


def ellipses(mean, covariance, camera):
    """The part of the picture that a Gaussian can reach, and q there, as a function of its number."""
    conic = np.linalg.inv(covariance)
    reach = np.sqrt(2 * np.log(255) * np.stack([covariance[:, 0, 0], covariance[:, 1, 1]], axis=1)) + 1
    size = np.array([camera.width, camera.height])
    low = np.clip(np.floor(mean - reach), 0, size).astype(int)
    high = np.clip(np.ceil(mean + reach) + 1, 0, size).astype(int)

    def part(i):
        return np.s_[low[i, 1]:high[i, 1], low[i, 0]:high[i, 0]]

    def q(i):
        dx = np.arange(low[i, 0], high[i, 0])[None, :] - mean[i, 0]
        dy = np.arange(low[i, 1], high[i, 1])[:, None] - mean[i, 1]
        return part(i), conic[i, 0, 0] * dx * dx + 2 * conic[i, 0, 1] * dx * dy + conic[i, 1, 1] * dy * dy

    q.part = part
    return q


def blend(distance, model, colour, order, shape):
    picture, passing = np.zeros((*shape, 3)), np.ones(shape)
    for i in order:
        part, q = distance(i)
        alpha = np.minimum(0.99, model.opacities[i] * np.exp(-0.5 * q))
        weight = passing[part] * np.where(alpha >= twin.TAU, alpha, 0)
        picture[part] += weight[..., None] * colour[i]
        passing[part] -= weight
    return picture


def main(model_file, camera_file, view, degrees="100"):
    model = binosplat.load_model(model_file)
    seen = binosplat.load_cameras(camera_file, model_file)[view]
    camera = binosplat.Camera(96, 96, 48 / np.tan(np.radians(float(degrees) / 2)), position=seen.position,
                              rotation=seen.rotation)
    mean, depth, free, colour = twin.project(model, camera, kernel=1e-9, margin=1e9)
    held = twin.project(model, camera, kernel=1e-9)[2]
    beyond = np.abs(mean - 47.5).max(axis=1) > 48 * 1.3
    drawn = np.flatnonzero((depth > 0.2) & (model.opacities >= twin.TAU))
    order = drawn[np.argsort(depth[drawn], kind="stable")]
    shape = (camera.height, camera.width)
    exact = rays(model, camera)
    held_q, free_q = ellipses(mean, held, camera), ellipses(mean, free, camera)
    kept_q = ellipses(mean, kept_axes(held, free), camera)
    inner = ellipses(mean, free, camera)  # within the limits nothing is held, and all three are this
    truth = blend(lambda i: exact(i) if beyond[i] else inner(i), model, colour, order, shape)
    print(f"{view} at {degrees} degrees: slopes are held of {beyond[drawn].mean():.0%} of {len(drawn)} Gaussians")
    rim = np.ones(shape, bool)
    rim[12:-12, 12:-12] = False
    for name, q in (("held, as 3D-GS", held_q), ("axes kept", kept_q), ("not held", free_q),
                    ("left out", lambda i: (np.s_[:0, :0], np.zeros((0, 0))) if beyond[i] else inner(i))):
        picture = blend(q, model, colour, order, shape)
        print(f"{name}: {twin.psnr(picture, truth):.1f} dB, {twin.psnr(picture[rim], truth[rim]):.1f} dB in the outer "
              f"eighth on each side", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
