#!/usr/bin/env python3
"""Fails when a file includes a room that stands above its own, or a sibling it may not know.

The house and its rules are in docs/architecture.md. Run from anywhere: tools/check_layers.py
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# room -> rooms it may include (its own is always allowed). Longest prefix of the path wins.
MAY_INCLUDE = {
    "math": [],
    "file": ["math"],
    "parallel": ["math"],
    "image": ["math", "file", "parallel"],
    "scene": ["math", "image"],
    "io": ["math", "file", "parallel", "image", "scene"],
    "tracing": ["math", "parallel", "image", "scene"],
    "tracing/shading": ["math", "parallel", "image", "scene", "tracing"],
    "radiosity": ["math", "parallel", "scene", "tracing", "tracing/shading"],
    "radiosity/form_factors": ["math", "parallel", "scene", "tracing", "radiosity"],
    "radiosity/leaks": ["math", "parallel", "scene"],
    "radiosity/solvers": ["math", "parallel", "scene", "tracing", "radiosity", "radiosity/form_factors"],
    "radiosity/meshing": ["math", "parallel", "image", "scene", "tracing", "tracing/shading", "radiosity",
                          "radiosity/form_factors", "radiosity/solvers"],
    "radiosity/specular": ["math", "parallel", "scene", "tracing", "tracing/shading", "radiosity",
                           "radiosity/form_factors", "radiosity/meshing", "radiosity/solvers"],
    "radiosity/pipeline": ["math", "parallel", "scene", "radiosity", "radiosity/form_factors", "radiosity/meshing",
                           "radiosity/solvers", "radiosity/specular"],
    "render": ["math", "parallel", "image", "scene", "tracing", "tracing/shading", "radiosity", "radiosity/meshing",
               "radiosity/solvers", "radiosity/pipeline"],
    "baking": ["math", "parallel", "image", "scene", "tracing", "tracing/shading", "radiosity", "radiosity/form_factors",
               "radiosity/meshing", "radiosity/solvers", "radiosity/pipeline"],
}
FOREIGN = {"embree3/": "tracing/ray_tracer", "draco/": "io/", "meshoptimizer.h": "io/meshopt_view",
           "openvdb/": "io/vdb_grid", "OpenEXR/": "image/", "webp/": "image/",
           "tbb/": "parallel/", "nlohmann/": "io/", "zlib.h": ("image/", "io/"), "stb_image": "image/"}
FORBIDDEN_NAMES = re.compile(r"(^|_)(util|utils|common|helper|helpers|manager|misc)($|_|\.)")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]', re.M)


def room_of(path):
    parts = path.split("/")
    for size in (2, 1):
        room = "/".join(parts[:size])
        if len(parts) > size and room in MAY_INCLUDE:
            return room
    return None


def findings():
    base = ROOT / "src" / "penumbra"
    for file in sorted([*base.rglob("*.h"), *base.rglob("*.cpp")]):
        name = file.relative_to(base).as_posix()
        room = room_of(name)
        if room is None:
            yield f"{name}: stands in no room that tools/check_layers.py knows"
            continue
        if FORBIDDEN_NAMES.search(file.stem):
            yield f"{name}: name the noun it holds instead"
        for target in INCLUDE.findall(file.read_text()):
            if target.startswith("penumbra/"):
                other = room_of(target[len("penumbra/"):])
                if other != room and other not in MAY_INCLUDE[room]:
                    yield f"{name}: includes {target}, but {room} may not know {other}"
            for prefix, home in FOREIGN.items():
                if target.startswith(prefix) and not name.startswith(home):
                    yield f"{name}: includes <{target}>, which belongs to {home}"
                if target.startswith(prefix) and name.endswith(".h"):
                    yield f"{name}: a foreign header in a header of ours: <{target}>"


if __name__ == "__main__":
    found = list(findings())
    print("\n".join(found) if found else "layers: every include points down")
    sys.exit(1 if found else 0)
