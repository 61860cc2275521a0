"""gsplat_torch.py CHECKOUT MODEL CAMERAS [NUMBERS]: compares with gsplat's plain torch code, in float64 on the CPU.

reference.py blends the splats that gsplat projects and colours. The result must equal binosplat's exact picture, first
of Gaussians around a wide view with an off-centre principal point, then of every fourth camera of MODEL at a quarter of
its resolution. NUMBERS is a file that gets gsplat's values of 12 Gaussians, for a test of the float64 reference.
"""
import importlib
import json
import sys
import types
from unittest import mock

import binosplat
import numpy as np
import torch

import reference


def load_gsplat(checkout):
    """Imports gsplat's plain torch modules without those that compile CUDA."""
    for name in ("gsplat", "gsplat.cuda"):
        sys.modules[name] = module = types.ModuleType(name)
        module.__path__ = [f"{checkout}/{name.replace('.', '/')}"]
    for name in ("_wrapper", "_torch_cameras"):
        sys.modules[f"gsplat.cuda.{name}"] = mock.MagicMock()
    return importlib.import_module("gsplat.cuda._torch_impl"), importlib.import_module("gsplat.cuda._math")


def project(gsplat, model, camera, antialiased=False):
    """Returns the same as reference.project, and the factor of each opacity from anti-aliasing."""
    impl, maths = gsplat
    of = lambda array: torch.tensor(np.asarray(array, np.float64))
    means, turn = of(model.means), of(camera.rotation).T
    view = torch.eye(4, dtype=torch.float64)
    view[:3, :3], view[:3, 3] = turn, -turn @ of(camera.position)
    lens = of([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]])
    covariances, _ = maths._quat_scale_to_covar_preci(of(model.quats), of(model.scales), compute_preci=False)
    _, mean, depth, conic, left = impl._fully_fused_projection(
        means, covariances, view[None], lens[None], camera.width, camera.height, calc_compensations=antialiased)
    colour = impl._spherical_harmonics(model.degree, means - of(camera.position), of(model.sh))
    a, b, c = conic[0].numpy().T
    covariance = np.linalg.inv(np.stack([a, b, b, c], axis=1).reshape(-1, 2, 2))
    splats = (mean[0].numpy() - 0.5, depth[0].numpy(), covariance, np.maximum(0, colour.numpy() + 0.5))
    return splats, left[0].numpy() if antialiased else np.ones(len(a))


def around(count):
    """Returns Gaussians of all shapes in and beside the view of a camera at the origin that looks along z."""
    draw = np.random.default_rng(7)
    z = draw.uniform(1, 6, count)
    means = np.stack([z * draw.uniform(-2.5, 2.5, count), z * draw.uniform(-1.8, 1.8, count), z], axis=1)
    return binosplat.Model(*[a.astype(np.float32) for a in (
        means, draw.normal(size=(count, 4)), np.exp(draw.uniform(-4.5, -1.2, (count, 3))),
        draw.uniform(0.1, 1, count), 0.3 * draw.normal(size=(count, 16, 3)))])


def against(gsplat, name, model, camera, antialiased=False):
    splats, left = project(gsplat, model, camera, antialiased)
    theirs = reference.blend(splats, model.opacities.astype(float) * left, camera, near=0.01)
    tagged = binosplat.Model(model.means, model.quats, model.scales, model.opacities, model.sh, antialiased=antialiased)
    ours = binosplat.Renderer(tagged).draw(camera, near_plane=0.01).colour
    reference.tell(f"{name}{', anti-aliased' if antialiased else ''}: {reference.psnr(ours, theirs):.1f} dB, "
                   f"{np.abs(ours - theirs).max():.1e} at most", reference.psnr(ours, theirs) > 90)


def write_numbers(gsplat, path):
    model = around(12)
    camera = binosplat.Camera(640, 480, 200, fy=210, cx=290, cy=260)
    splats, left = project(gsplat, model, camera, True)
    mean, depth, covariance, colour = (array.tolist() for array in splats)
    rows = [{"position": p, "quaternion": q, "scale": s, "opacity": o, "sh": h, "mean": m, "depth": d,
             "covariance": [c[0][0], c[0][1], c[1][1]], "colour": k, "antialiased": l}
            for p, q, s, o, h, m, d, c, k, l in zip(
                model.means.tolist(), model.quats.tolist(), model.scales.tolist(), model.opacities.tolist(),
                model.sh.tolist(), mean, depth, covariance, colour, left.tolist())]
    with open(path, "w") as file:
        json.dump({"width": 640, "height": 480, "fx": 200, "fy": 210, "cx": 290, "cy": 260, "gaussians": rows}, file)


def main(checkout, model_file, camera_file, numbers=None):
    gsplat = load_gsplat(checkout)
    wide = binosplat.Camera(320, 240, 100, fy=105, cx=145, cy=130)
    for antialiased in (False, True):
        against(gsplat, "2,000 Gaussians around 116 x 98 degrees", around(2000), wide, antialiased)
    model = binosplat.load_model(model_file)
    for camera in list(binosplat.load_cameras(camera_file, model_file))[::4]:
        small = binosplat.Camera(camera.width // 4, camera.height // 4, camera.fx / 4, fy=camera.fy / 4,
                                 cx=camera.cx / 4, cy=camera.cy / 4, position=camera.position, rotation=camera.rotation)
        against(gsplat, camera.name, model, small)
    if numbers:
        write_numbers(gsplat, numbers)


if __name__ == "__main__":
    main(*sys.argv[1:])
