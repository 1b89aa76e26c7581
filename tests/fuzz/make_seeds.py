#!/usr/bin/env python3
"""Writes the seeds that no other program exports: small glTF files, packed views of meshopt, and arrays of NumPy.

Run in this folder. Needs numpy and libmeshoptimizer (Debian's python3-numpy and libmeshoptimizer-dev).
"""
import base64
import ctypes
import io
import json
import pathlib
import struct

import numpy as np

MESHOPT = ctypes.CDLL("libmeshoptimizer.so")
SEEDS = pathlib.Path(__file__).parent / "seeds"

CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], np.float32)
CUBE = np.array([0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5],
                np.uint32)


def write(name, data):
    path = SEEDS / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


# --- meshopt -----------------------------------------------------------------------------------------------------------

def encoded(function, bound, elements, *sizes):
    """What an encoder of meshoptimizer makes of an array."""
    room = ctypes.create_string_buffer(bound)
    function.restype = ctypes.c_size_t
    data = np.ascontiguousarray(elements)
    size = function(room, ctypes.c_size_t(bound), data.ctypes.data_as(ctypes.c_void_p),
                    *[ctypes.c_size_t(s) for s in sizes])
    assert size > 0
    return room.raw[:size]


def packed_vertices(elements):
    stride = elements.itemsize * elements[0].size
    return encoded(MESHOPT.meshopt_encodeVertexBuffer, 4096, elements, len(elements), stride)


def packed_triangles(indices):
    return encoded(MESHOPT.meshopt_encodeIndexBuffer, 4096, indices, len(indices))


def packed_sequence(indices):
    return encoded(MESHOPT.meshopt_encodeIndexSequence, 4096, indices, len(indices))


def filtered(function, count, stride, bits, values):
    room = ctypes.create_string_buffer(count * stride)
    data = np.ascontiguousarray(values, np.float32)
    function(room, ctypes.c_size_t(count), ctypes.c_size_t(stride), ctypes.c_int(bits),
             data.ctypes.data_as(ctypes.c_void_p))
    return np.frombuffer(room.raw, np.uint8).reshape(count, stride)


def meshopt_seeds():
    def seed(name, mode, filtering, count, stride, data):
        write(f"meshopt/{name}", struct.pack("<BBHI", mode, filtering, stride, count) + data)

    normals = np.array([[0.6, 0, 0.8, 1], [0, -1, 0, 1], [1, 0, 0, 1], [0, 0, -1, 1]], np.float32)
    turns = np.array([[0, 0, 0, 1], [0.5, 0.5, 0.5, 0.5], [1, 0, 0, 0], [0, 0.6, 0.8, 0]], np.float32)
    seed("positions", 0, 0, 8, 12, packed_vertices(CORNERS))
    seed("octahedral", 0, 1, 4, 8, packed_vertices(filtered(MESHOPT.meshopt_encodeFilterOct, 4, 8, 16, normals)))
    seed("octahedral_bytes", 0, 1, 4, 4, packed_vertices(filtered(MESHOPT.meshopt_encodeFilterOct, 4, 4, 8, normals)))
    seed("quaternion", 0, 2, 4, 8, packed_vertices(filtered(MESHOPT.meshopt_encodeFilterQuat, 4, 8, 16, turns)))
    seed("exponential", 0, 3, 8, 12, packed_vertices(filtered(MESHOPT.meshopt_encodeFilterExp, 8, 12, 20, CORNERS)))
    seed("triangles", 1, 0, 36, 4, packed_triangles(CUBE))
    seed("triangles_short", 1, 0, 36, 2, packed_triangles(CUBE))
    seed("sequence", 2, 0, 8, 4, packed_sequence(np.array([5, 1, 0, 7, 7, 2, 100, 3], np.uint32)))


# --- glTF --------------------------------------------------------------------------------------------------------------

class Gltf:
    """A glTF with one buffer, inside a data URI."""

    def __init__(self):
        self.bytes = b""
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [],
                     "meshes": [], "accessors": [], "bufferViews": []}

    def add(self, name, item):
        self.json.setdefault(name, []).append(item)
        return len(self.json[name]) - 1

    def view(self, data):
        self.bytes += bytes(-len(self.bytes) % 4)
        self.bytes += data
        return self.add("bufferViews",
                        {"buffer": 0, "byteOffset": len(self.bytes) - len(data), "byteLength": len(data)})

    def accessor(self, values, kind, component, **more):
        dtype = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}[component]
        array = np.array(values, dtype)
        return self.add("accessors", {"bufferView": self.view(array.tobytes()), "componentType": component,
                                      "count": len(array), "type": kind, **more})

    def triangle(self, **attributes):
        return {"attributes": {"POSITION": self.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "VEC3", 5126), **attributes}}

    def write(self, name):
        data = "data:application/octet-stream;base64," + base64.b64encode(self.bytes).decode()
        self.json["buffers"] = [{"byteLength": len(self.bytes), "uri": data}]
        write(f"gltf/{name}.gltf", json.dumps(self.json).encode())


def sparse_gltf():
    g = Gltf()
    primitive = g.triangle()
    g.json["accessors"][0]["sparse"] = {
        "count": 2, "indices": {"bufferView": g.view(struct.pack("<2H", 0, 2)), "componentType": 5123},
        "values": {"bufferView": g.view(struct.pack("<6f", 0, 0, 1, 0, 2, 0))}}
    primitive["indices"] = g.accessor([0, 1, 2, 2, 1, 0], "SCALAR", 5121)
    g.add("meshes", {"primitives": [primitive, {**primitive, "mode": 5}, {**primitive, "mode": 6}]})
    g.add("nodes", {"mesh": 0, "rotation": [0, 0, 0.6, 0.8], "scale": [1, 2, 3]})
    g.write("sparse")


def moving_gltf():
    g = Gltf()
    primitive = g.triangle(JOINTS_0=g.accessor([[0, 1, 0, 0]] * 3, "VEC4", 5121),
                           WEIGHTS_0=g.accessor([[255, 0, 0, 0], [128, 127, 0, 0], [0, 255, 0, 0]], "VEC4", 5121,
                                                normalized=True))
    primitive["targets"] = [{"POSITION": g.accessor([[0, 0, 1]] * 3, "VEC3", 5126)}]
    g.add("meshes", {"primitives": [primitive], "weights": [0.5]})
    g.json["nodes"] = [{"mesh": 0, "skin": 0, "children": [1]}, {"children": [2]}, {"translation": [0, 1, 0]}]
    bind = g.accessor([np.eye(4).ravel(), np.eye(4).ravel()], "MAT4", 5126)
    g.add("skins", {"joints": [1, 2], "inverseBindMatrices": bind})
    times = g.accessor([0, 1], "SCALAR", 5126)
    samplers = [{"input": times, "output": g.accessor([[0, 0, 0, 1], [0, 0, 1, 0]], "VEC4", 5126)},
                {"input": times, "output": g.accessor([[0, 0, 0]] * 6, "VEC3", 5126), "interpolation": "CUBICSPLINE"},
                {"input": times, "output": g.accessor([0, 1], "SCALAR", 5126), "interpolation": "STEP"}]
    channels = [{"sampler": 0, "target": {"node": 2, "path": "rotation"}},
                {"sampler": 1, "target": {"node": 1, "path": "translation"}},
                {"sampler": 2, "target": {"node": 0, "path": "weights"}}]
    g.add("animations", {"channels": channels, "samplers": samplers})
    g.write("moving")


def packed_view(g, data, mode, count, stride):
    view = g.view(data)
    place = g.json["bufferViews"][view]
    place["extensions"] = {"EXT_meshopt_compression": {**place, "mode": mode, "count": count, "byteStride": stride}}
    place["byteLength"] = count * stride
    return view


def compressed_gltf():
    g = Gltf()
    g.json["extensionsUsed"] = ["EXT_meshopt_compression", "KHR_draco_mesh_compression"]
    positions = packed_view(g, packed_vertices(CORNERS), "ATTRIBUTES", 8, 12)
    triangles = packed_view(g, packed_triangles(CUBE), "TRIANGLES", 36, 4)
    draco = g.view((SEEDS / "draco/quad.drc").read_bytes())
    cube = {"attributes": {"POSITION": g.add("accessors", {"bufferView": positions, "componentType": 5126, "count": 8,
                                                           "type": "VEC3"})},
            "indices": g.add("accessors", {"bufferView": triangles, "componentType": 5125, "count": 36,
                                           "type": "SCALAR"})}
    quad = {"attributes": {"POSITION": g.add("accessors", {"componentType": 5126, "count": 4, "type": "VEC3"})},
            "indices": g.add("accessors", {"componentType": 5125, "count": 6, "type": "SCALAR"}),
            "extensions": {"KHR_draco_mesh_compression": {"bufferView": draco, "attributes": {"POSITION": 0}}}}
    g.add("meshes", {"primitives": [cube, quad]})
    g.add("nodes", {"mesh": 0})
    g.write("compressed")


def materials_gltf():
    g = Gltf()
    picture = g.view((SEEDS / "png/grey.png").read_bytes())
    g.add("images", {"bufferView": picture, "mimeType": "image/png"})
    g.add("samplers", {"wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9987})
    g.add("textures", {"source": 0, "sampler": 0})
    texture = {"index": 0, "texCoord": 0,
               "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1, "scale": [2, 2]}}}
    extensions = {"KHR_materials_emissive_strength": {"emissiveStrength": 2}, "KHR_materials_ior": {"ior": 1.4},
                  "KHR_materials_transmission": {"transmissionFactor": 0.5},
                  "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2,
                                           "attenuationColor": [0.5, 0.6, 0.7]},
                  "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 1, 1]},
                  "KHR_materials_dispersion": {"dispersion": 0.3}, "KHR_materials_clearcoat": {"clearcoatFactor": 1}}
    extras = {"mirror": [0.1, 0.1, 0.1], "checker": {"colour": [0, 0, 0], "size": 0.5},
              "sellmeier": {"b": [1.6, 0.25, 1.6], "c_um2": [0.012, 0.06, 147]},
              "medium": {"absorption": [1, 1, 1], "scattering": [0, 0, 0], "g": 0.5}}
    g.add("materials", {"name": "all", "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.7, 0.6, 0.5],
                                                                "metallicFactor": 0.2, "roughnessFactor": 0.3,
                                                                "baseColorTexture": texture},
                        "normalTexture": {"index": 0, "scale": 0.5}, "emissiveFactor": [1, 0, 0],
                        "alphaMode": "BLEND", "doubleSided": True, "extensions": extensions,
                        "extras": {"penumbra": extras, "mine": 1}})
    lamp = {"edges_nm": [400, 500, 600], "radiance": [1, 2]}
    dye = {"edges_nm": [400, 500, 600], "matrix": [0.1, 0, 0.5, 0.2]}
    g.add("materials", {"alphaMode": "MASK", "alphaCutoff": 0.4, "pbrMetallicRoughness": {"metallicFactor": 0},
                        "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
                        "extras": {"penumbra": {"fluorescence": dye, "emission_spectrum": lamp}}})
    g.add("materials", {"extensions": {"KHR_materials_unlit": {}},
                        "extras": {"penumbra": {"cauchy": {"a": 1.5, "b_um2": 0.004}}}})
    primitive = g.triangle(NORMAL=g.accessor([[0, 0, 1]] * 3, "VEC3", 5126),
                           TEXCOORD_0=g.accessor([[0, 0], [1, 0], [0, 1]], "VEC2", 5126),
                           COLOR_0=g.accessor([[255, 0, 0, 255]] * 3, "VEC4", 5121, normalized=True))
    g.add("meshes", {"primitives": [{**primitive, "material": m} for m in range(3)]})
    lights = [{"type": "point", "color": [1, 1, 1], "intensity": 3, "range": 9}, {"type": "directional"},
              {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}}]
    g.json["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    g.json["extensionsUsed"] = ["KHR_lights_punctual", *extensions]
    g.add("cameras", {"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.01}})
    g.add("cameras", {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9}})
    g.json["nodes"] = [{"mesh": 0, "children": [1, 2, 3]}, {"camera": 0, "translation": [0, 0, 3]}, {"camera": 1}]
    g.json["nodes"] += [{"extensions": {"KHR_lights_punctual": {"light": i}}} for i in range(3)]
    g.json["nodes"][0]["children"] = [1, 2, 3, 4, 5]
    density = g.view(np.ones(8, np.float32).tobytes())
    air = {"lower": [0, 0, 0], "upper": [1, 1, 1], "density": {"cells": [2, 2, 2], "bufferView": density}}
    g.json["scenes"][0]["extras"] = {"penumbra": {"environment": {"radiance": [1, 1, 1]}, "ambient": [0.1, 0.1, 0.1],
                                                  "media": [air]}}
    g.write("materials")


# --- NumPy -------------------------------------------------------------------------------------------------------------

def arrays(*values):
    """Arrays one after another, as the targets take them."""
    out = io.BytesIO()
    for value in values:
        np.lib.format.write_array(out, np.asarray(value), version=(1, 0))
    return out.getvalue()


def array_seeds():
    write("grid/smoke", arrays(np.linspace(0, 1, 8, dtype=np.float32).reshape(2, 2, 2), [[0.0, 0, 0], [1, 1, 1]],
                               [0.1, 0.2, 0.3], [1.0, 2, 3], 0.5))
    write("grid/bare", arrays(np.ones((1, 2, 1)), np.array([[0.0, 0, 0], [1, 1, 1]])))
    csr = [np.array(b"csr"), [2, 2], [0.25, 0.75, 0.5], np.array([0, 1, 0], np.int32), np.array([0, 2, 3], np.int32)]
    write("matrix/csr", arrays(*csr, [0], [0], [1.0, 2], ["floor", "lamp"], [False]))
    write("matrix/table.csv", b"# penumbra factors\ni,j,factor,from,to,area\n0,1,0.2,floor,\"a \"\"lamp\"\"\",1.5\n"
                              b"1,0,0.4,lamp,floor,0.75\n")
    number, three = [0.5], [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]
    write("solution/triangle", arrays(*[number] * 19, [0], ["floor"], ["front"], three, [0, 3], [0, 1, 2], True))


meshopt_seeds()
sparse_gltf()
moving_gltf()
compressed_gltf()
materials_gltf()
array_seeds()
