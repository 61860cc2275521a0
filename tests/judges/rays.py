"""rays.py PROGRAM MODEL CAMERAS VIEW: how near binosplat comes to a trainer that looks along rays.

Such a trainer (3DGUT, gsplat's eval3d) has no low-pass in the picture. The twin draws the view at half its
size by rays; PROGRAM, binosplat, draws it by several low-passes and both projections.
"""
import subprocess
import sys
import tempfile

import binosplat
import numpy as np

import edges
import twin


def main(program, model_file, camera_file, view):
    model = binosplat.load_model(model_file)
    seen = binosplat.load_cameras(camera_file, model_file)[view]
    camera = binosplat.Camera(seen.width // 2, seen.height // 2, seen.fx / 2, fy=seen.fy / 2, cx=seen.cx / 2,
                              cy=seen.cy / 2, position=seen.position, rotation=seen.rotation)
    mean, depth, covariance, colour = twin.project(model, camera, kernel=0)
    part = edges.ellipses(mean, 2 * covariance + np.eye(2), camera).part  # twice as large as what a ray can see
    drawn = np.flatnonzero((depth > 0.2) & (model.opacities >= twin.TAU))
    order = drawn[np.argsort(depth[drawn], kind="stable")]
    truth = edges.blend(edges.rays(model, camera, part), model, colour, order, (camera.height, camera.width))
    with tempfile.TemporaryDirectory() as folder:
        for projection in ("affine", "tangent"):
            for kernel in ("0.3", "0.1", "0.01", "0.001"):
                subprocess.run([program, "render", model_file, "--cameras", camera_file, "--view", view, "--mono",
                                "--size", f"{camera.width}x{camera.height}", "--projection", projection,
                                "--kernel-px2", kernel, "-o", f"{folder}/ours.exr"], check=True, capture_output=True)
                ours = binosplat.load_image(f"{folder}/ours.exr")[..., :3]
                print(f"{view}, {projection}, low-pass {kernel} px^2: {twin.psnr(ours, truth):.1f} dB", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
