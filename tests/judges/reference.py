"""A third implementation of docs/method.md, in NumPy and float64, which can also draw with another program's alpha.

It has the affine projection and sorts by depth. It blends each Gaussian at every pixel that it can reach.
"""
import sys

import numpy as np

TAU = 1 / 255


def harmonics(directions):
    """Returns the spherical harmonics of unit vectors: (count, 3) to (count, 16)."""
    x, y, z = np.asarray(directions, float).T
    return np.stack([
        np.full_like(x, 0.28209479177387814),
        -0.4886025119029199 * y, 0.4886025119029199 * z, -0.4886025119029199 * x,
        1.0925484305920792 * x * y, -1.0925484305920792 * y * z,
        0.31539156525252005 * (2 * z * z - x * x - y * y),
        -1.0925484305920792 * x * z, 0.5462742152960396 * (x * x - y * y),
        -0.5900435899266435 * y * (3 * x * x - y * y), 2.890611442640554 * x * y * z,
        -0.4570457994644658 * y * (4 * z * z - x * x - y * y),
        0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * y * y),
        -0.4570457994644658 * x * (4 * z * z - x * x - y * y),
        1.445305721320277 * z * (x * x - y * y), -0.5900435899266435 * x * (x * x - 3 * y * y)], axis=1)


def turns(quats):
    """Returns the rotation matrices of quaternions w x y z."""
    w, x, y, z = np.moveaxis(quats / np.linalg.norm(quats, axis=-1, keepdims=True), -1, 0)
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                     2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=-1).reshape(-1, 3, 3)


def project(model, camera, kernel=0.3, margin=0.15):
    """Returns each Gaussian's mean (px, with pixel centres at integers), depth, 2D covariance and colour in a view."""
    turn = np.asarray(camera.rotation, float)
    away = model.means.astype(float) - np.asarray(camera.position, float)
    v = away @ turn
    x, y, z = v.T
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.stack([camera.fx * x / z + camera.cx - 0.5, camera.fy * y / z + camera.cy - 0.5], axis=1)
        slope_x = np.clip(x / z, -(camera.cx + margin * camera.width) / camera.fx,
                          (camera.width - camera.cx + margin * camera.width) / camera.fx)
        slope_y = np.clip(y / z, -(camera.cy + margin * camera.height) / camera.fy,
                          (camera.height - camera.cy + margin * camera.height) / camera.fy)
        zero = np.zeros_like(z)
        jacobian = np.stack([camera.fx / z, zero, -camera.fx * slope_x / z,
                             zero, camera.fy / z, -camera.fy * slope_y / z], axis=1).reshape(-1, 2, 3)
    axes = jacobian @ turn.T @ (turns(model.quats.astype(float)) * model.scales.astype(float)[:, None, :])
    covariance = axes @ np.swapaxes(axes, 1, 2) + kernel * np.eye(2)
    basis = harmonics(away / np.linalg.norm(away, axis=1, keepdims=True))[:, :model.sh.shape[1]]
    colour = np.maximum(0, 0.5 + np.einsum("nk,nkc->nc", basis, model.sh.astype(float)))
    return mean, z, covariance, colour


def blend(splats, opacities, camera, near=0.2, floor=0.0):
    """Returns the picture, (height, width, 3), over black. Alpha is sigma (exp(-q/2) - floor)."""
    mean, depth, covariance, colour = splats
    height, width = camera.height, camera.width
    picture, passing = np.zeros((height, width, 3)), np.ones((height, width))
    going = np.ones((height, width), bool)
    conic = np.linalg.inv(covariance)
    drawn = np.flatnonzero((depth > near) & (opacities >= TAU))
    for i in drawn[np.argsort(depth[drawn], kind="stable")]:
        reach = np.sqrt(2 * np.log(opacities[i] / TAU) * np.diag(covariance[i])) + 1
        low = np.maximum(np.ceil(mean[i] - reach), 0).astype(int)
        high = np.minimum(np.floor(mean[i] + reach), [width - 1, height - 1]).astype(int) + 1
        if (low >= high).any():
            continue
        part = np.s_[low[1]:high[1], low[0]:high[0]]
        dx = np.arange(low[0], high[0])[None, :] - mean[i, 0]
        dy = np.arange(low[1], high[1])[:, None] - mean[i, 1]
        q = conic[i, 0, 0] * dx * dx + 2 * conic[i, 0, 1] * dx * dy + conic[i, 1, 1] * dy * dy
        alpha = np.minimum(0.99, opacities[i] * np.maximum(0, np.exp(-0.5 * q) - floor))
        touched = going[part] & (q >= 0) & (alpha >= TAU)
        going[part] &= ~(touched & (passing[part] * (1 - alpha) < 1e-4))
        weight = np.where(touched & going[part], alpha, 0) * passing[part]
        picture[part] += weight[..., None] * colour[i]
        passing[part] -= weight
    return picture


def render(model, camera, near=0.2, floor=0.0):
    return blend(project(model, camera), model.opacities.astype(float), camera, near, floor)


def psnr(a, b):
    """Returns the PSNR of float pictures, in dB for a peak of 1."""
    error = np.mean((np.asarray(a, float) - np.asarray(b, float)) ** 2)
    return np.inf if error == 0 else -10 * np.log10(error)


def tell(text, holds):
    """Prints a result, and ends the script unless the result is as expected."""
    print(text, flush=True)
    if not holds:
        sys.exit("This is beyond what was found before: see README.md.")
