#!/usr/bin/env python3
"""Alabaster's reference against Mitsuba 3 (PyPI `mitsuba`, scalar_rgb, volpath) on the same scenes, size and number of threads.

    python3 -m venv venv && venv/bin/pip install mitsuba numpy
    venv/bin/python bench/against_mitsuba.py [--alabaster build/release/bin/alabaster] [--spp 64] [--size 160x120] [--threads 2]

For each scene both render `spp` samples a pixel with two seeds. Printed: processor seconds (user + system, all threads, start-up taken
out by a run at one sample), samples a second and processor second, the relative variance of one sample (half the mean square
difference of the two pictures over the object, times spp, over the squared mean), the difference of the two programs' means, and what
counts: processor time to equal error, the ratio of (seconds x variance).
"""
import argparse, base64, json, math, os, resource, struct, subprocess, sys, tempfile


def icosphere(subdivisions):
    t = (1 + 5 ** 0.5) / 2
    points = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t), (0, 1, -t), (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1)]
    unit = lambda p: tuple(c / math.sqrt(sum(x * x for x in p)) for c in p)
    points = [unit(p) for p in points]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
             (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        middles, finer = {}, []
        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append(unit([(x + y) / 2 for x, y in zip(points[a], points[b])]))
            return middles[key]
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return points, faces


BALL = icosphere(5)
LIGHT = ([(-2, 3, -2), (2, 3, -2), (2, 3, 2), (-2, 3, 2)], [(0, 1, 2), (0, 2, 3)])  # faces down
EYE, FOV = (0, 0, 4), 0.6
GRID = 24  # cells along each axis

# name: sigma_s, sigma_a (1/m; the ball's radius is 1 m), g, eta, radiance of the light, of the environment. In the grid they are
# multiplied by 0.2 to 1.8, cell by cell.
SCENES = {
    "glassy, 20 mfp": ([9.9, 9.9, 9.9], [0.1, 0.1, 0.1], 0.0, 1.5, 4.0, 0.5),
    "marble, 100 mfp": ([49.95, 49.95, 49.95], [0.05, 0.05, 0.05], 0.0, 1.5, 4.0, 0.5),
    "coloured, 100 mfp": ([41.0, 49.0, 56.0], [0.04, 0.08, 0.16], 0.0, 1.5, 4.0, 0.5),
    "matched, 20 mfp": ([9.9, 9.9, 9.9], [0.1, 0.1, 0.1], 0.0, 1.0, 4.0, 0.0),
    "grid, 100 mfp": ([49.95, 49.95, 49.95], [0.05, 0.05, 0.05], 0.0, 1.5, 4.0, 0.5),
    "forward, 100 mfp": ([49.5, 49.5, 49.5], [0.5, 0.5, 0.5], 0.8, 1.3, 4.0, 0.5),
}


def grid_values(name):
    """Of a wavy density about 1, x fastest, for the scenes that have one; else None."""
    if not name.startswith("grid"):
        return None
    wave = lambda i: math.sin(2 * math.pi * 3 * (i + 0.5) / GRID)
    return [1 + 0.8 * wave(x) * wave(y) * wave(z) for z in range(GRID) for y in range(GRID) for x in range(GRID)]


def write_vol(path, values):
    """Mitsuba's .vol, version 3, which both programs read."""
    with open(path, "wb") as f:
        f.write(b"VOL\3" + struct.pack("<5i6f", 1, GRID, GRID, GRID, 1, -1, -1, -1, 1, 1, 1) + struct.pack("<%df" % len(values), *values))


def medium(name, scene):
    sigma_s, sigma_a, g = scene[:3]
    if grid_values(name) is None:
        return {"type": "homogeneous", "sigma_s": sigma_s, "sigma_a": sigma_a, "g": g}
    return {"type": "grid", "g": g, "bbox_min": [-1] * 3, "bbox_max": [1] * 3, "filter": "trilinear",
            "sigma_t": {"vol": "density.vol", "scale": sigma_s[0] + sigma_a[0]}, "albedo": sigma_s[0] / (sigma_s[0] + sigma_a[0])}


def write_gltf(path, name):
    scene = SCENES[name]
    sigma_s, sigma_a, g, eta, light, environment = scene
    blob, views, accessors = b"", [], []
    def add(data, kind, component, count, extra):
        nonlocal blob
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind, **extra})
        blob += data
        return len(accessors) - 1
    def mesh(points, faces, material):
        extra = {"min": [min(p[k] for p in points) for k in range(3)], "max": [max(p[k] for p in points) for k in range(3)]}
        position = add(struct.pack("<%df" % (3 * len(points)), *[c for p in points for c in p]), "VEC3", 5126, len(points), extra)
        index = add(struct.pack("<%dI" % (3 * len(faces)), *[i for f in faces for i in f]), "SCALAR", 5125, 3 * len(faces), {})
        return {"primitives": [{"attributes": {"POSITION": position}, "indices": index, "material": material}]}
    meshes = [mesh(*BALL, 0), mesh(*LIGHT, 1)]
    json.dump({
        "asset": {"version": "2.0"}, "scene": 0,
        "scenes": [{"nodes": [0, 1, 2], "extras": {"environment": {"radiance": [environment] * 3}}}],
        "nodes": [{"mesh": 0, "name": "ball"}, {"mesh": 1, "name": "light"}, {"camera": 0, "translation": list(EYE), "name": "main"}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": FOV, "znear": 0.01}}],
        "materials": [{"name": "ball", "extensions": {"KHR_materials_ior": {"ior": eta}},
                       "extras": {"medium": medium(name, scene)}},
                      {"name": "light", "emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": light}}}],
        "extensionsUsed": ["KHR_materials_ior", "KHR_materials_emissive_strength"],
        "meshes": meshes, "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(blob), "uri": "data:application/octet-stream;base64," + base64.b64encode(blob).decode()}],
    }, open(path, "w"))


def write_ply(path, points, faces):
    with open(path, "w") as f:
        f.write("ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\nelement face %d\n"
                "property list uchar int vertex_indices\nend_header\n" % (len(points), len(faces)))
        f.writelines("%.9g %.9g %.9g\n" % tuple(p) for p in points)
        f.writelines("3 %d %d %d\n" % tuple(t) for t in faces)


def mitsuba_worker(folder, name, spp, width, height, threads, seed, out):
    """Runs in its own process, so that its processor time is all its own."""
    import mitsuba as mi
    mi.set_variant("scalar_rgb")
    mi.Thread.set_thread_count(threads) if hasattr(mi.Thread, "set_thread_count") else None
    sigma_s, sigma_a, g, eta, light, environment = SCENES[name]
    sigma_t = [s + a for s, a in zip(sigma_s, sigma_a)]
    rgb = lambda v: {"type": "rgb", "value": v}
    scene = {
        "type": "scene",
        "integrator": {"type": "volpathmis" if len(set(sigma_t)) > 1 else "volpath", "max_depth": -1, "rr_depth": 1000000},
        "sensor": {"type": "perspective", "fov": math.degrees(FOV), "fov_axis": "y", "to_world": mi.ScalarTransform4f().look_at(list(EYE), [0, 0, 0], [0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"},
                   "sampler": {"type": "independent", "sample_count": spp, "seed": seed}},
        "ball": {"type": "ply", "filename": os.path.join(folder, "ball.ply"), "face_normals": True,
                 "bsdf": {"type": "null"} if eta == 1 else {"type": "dielectric", "int_ior": eta, "ext_ior": 1.0},
                 "interior": {"type": "homogeneous", "scale": max(sigma_t), "sigma_t": rgb([t / max(sigma_t) for t in sigma_t]), "albedo": rgb([s / t for s, t in zip(sigma_s, sigma_t)]),
                              "phase": {"type": "hg", "g": g}}},
        "light": {"type": "ply", "filename": os.path.join(folder, "light.ply"), "face_normals": True,
                  "emitter": {"type": "area", "radiance": rgb([light] * 3)}},
    }
    if grid_values(name):
        scene["ball"]["interior"] = {"type": "heterogeneous", "scale": sigma_t[0], "phase": {"type": "hg", "g": g}, "albedo": sigma_s[0] / sigma_t[0],
                                     "sigma_t": {"type": "gridvolume", "filename": os.path.join(folder, "density.vol"), "wrap_mode": "clamp",
                                                 "to_world": mi.ScalarTransform4f().translate([-1, -1, -1]).scale([2, 2, 2])}}
    if environment > 0:
        scene["sky"] = {"type": "constant", "radiance": rgb([environment] * 3)}
    image = mi.render(mi.load_dict(scene), spp=spp, seed=seed)
    mi.Bitmap(image).write(out)


def processor_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--alabaster", default="build/release/bin/alabaster")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--size", default="160x120")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--scene", action="append", choices=list(SCENES))
    parser.add_argument("--json")
    parser.add_argument("--worker", nargs=4, help=argparse.SUPPRESS)
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    if args.worker:
        folder, name, seed, out = args.worker
        mitsuba_worker(folder, name, args.spp, width, height, args.threads, int(seed), out)
        return
    import numpy as np
    import mitsuba as mi
    mi.set_variant("scalar_rgb")
    def read(path):
        bitmap = mi.Bitmap(path)
        names = [field.name for field in bitmap.struct_()]
        return np.array(bitmap, dtype=np.float64)[:, :, [names.index(c) for c in "RGB"]]
    # The ball's pixels: the disc that its silhouette encloses, less a rim.
    y, x = np.mgrid[0:height, 0:width]
    scale = math.tan(FOV / 2)
    px, py = ((x + 0.5) / width * 2 - 1) * scale * width / height, (1 - (y + 0.5) / height * 2) * scale
    mask = np.hypot(px, py) < math.tan(math.asin(1 / EYE[2])) * 0.97
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        write_ply(os.path.join(folder, "ball.ply"), *BALL)
        write_ply(os.path.join(folder, "light.ply"), *LIGHT)
        for name in args.scene or SCENES:
            gltf = os.path.join(folder, "scene.gltf")
            write_gltf(gltf, name)
            if grid_values(name):
                write_vol(os.path.join(folder, "density.vol"), grid_values(name))
            row = {"scene": name}
            means = {}
            for program in ("alabaster", "mitsuba"):
                def run(spp, seed, out):
                    if program == "alabaster":
                        return processor_seconds([args.alabaster, "reference", gltf, "-o", out, "--spp", str(spp), "--size", args.size, "--seed", str(seed),
                                                  "--threads", str(args.threads)])
                    return processor_seconds([sys.executable, __file__, "--spp", str(spp), "--size", args.size, "--threads", str(args.threads),
                                              "--worker", folder, name, str(seed), out])
                out = [os.path.join(folder, "%s%d.exr" % (program, k)) for k in range(2)]
                start_up = run(1, 9, out[0])
                seconds = sum(run(args.spp, k, out[k]) for k in range(2)) / 2
                a, b = read(out[0])[mask], read(out[1])[mask]
                mean = (a + b).mean() / 2
                means[program] = mean
                work = max(seconds - start_up, 1e-9) * args.spp / max(1, args.spp - 1)
                row[program] = {"processor_seconds": work, "samples_per_second": args.spp * width * height / work,
                                "relative_variance_of_a_sample": float(((a - b) ** 2).mean() / 2 * args.spp / mean ** 2), "mean": float(mean)}
            ours, theirs = row["alabaster"], row["mitsuba"]
            row["speed"] = ours["samples_per_second"] / theirs["samples_per_second"]
            row["time_to_equal_error"] = row["speed"] * theirs["relative_variance_of_a_sample"] / ours["relative_variance_of_a_sample"]
            row["difference_of_means"] = means["alabaster"] / means["mitsuba"] - 1
            rows.append(row)
            print("%-20s samples/s: %9.0f and %9.0f (%.2f times)  variance of a sample: %.3f and %.3f  time to equal error: %.2f times less  means differ by %+.2f %%" %
                  (name, ours["samples_per_second"], theirs["samples_per_second"], row["speed"], ours["relative_variance_of_a_sample"],
                   theirs["relative_variance_of_a_sample"], row["time_to_equal_error"], 100 * row["difference_of_means"]), flush=True)
    if args.json:
        json.dump(rows, open(args.json, "w"), indent=1)


if __name__ == "__main__":
    main()
