#!/usr/bin/env python3
"""Writes the malformed glTF files of this folder: each is a valid triangle with one thing wrong, named for it.

tests/io/gltf_malformed_test.cpp says which place each error must name. Run in this folder after a change.
"""
import base64
import copy
import json
import struct

POSITIONS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
INDICES = struct.pack("<3H", 0, 1, 2)
DATA = POSITIONS + INDICES


def data_uri(data):
    return "data:application/octet-stream;base64," + base64.b64encode(data).decode()


def triangle(data=DATA):
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 6},
        ],
        "buffers": [{"byteLength": len(data), "uri": data_uri(data)}],
    }


def text(name, content):
    with open(name + ".gltf", "wb") as out:
        out.write(content if isinstance(content, bytes) else content.encode())


def bad(name, change, data=DATA):
    scene = triangle(data)
    change(scene)
    text(name, json.dumps(scene, separators=(",", ":")) + "\n")


def binary(name, chunks=None, version=2, magic=b"glTF", length=None, keep=None):
    if chunks is None:
        scene = triangle()
        del scene["buffers"][0]["uri"]
        body = json.dumps(scene).encode()
        body += b" " * (-len(body) % 4)
        chunks = [(len(body), b"JSON", body), (len(DATA) + 2, b"BIN\0", DATA + b"\0\0")]
    content = b"".join(struct.pack("<I4s", size, kind) + body for size, kind, body in chunks)
    whole = magic + struct.pack("<II", version, 12 + len(content) if length is None else length) + content
    with open(name + ".glb", "wb") as out:
        out.write(whole[:keep])


def accessor(i, **members):
    return lambda s: s["accessors"][i].update(members)


def view(i, **members):
    return lambda s: s["bufferViews"][i].update(members)


def node(**members):
    return lambda s: s["nodes"][0].update(members)


def primitive(**members):
    return lambda s: s["meshes"][0]["primitives"][0].update(members)


def member(key, value):
    return lambda s: s.update({key: value})


def uri(value):
    return lambda s: s["buffers"][0].update({"uri": value})


def nodes(*listed, roots=(0,)):
    def change(s):
        s["nodes"] = list(listed)
        s["scenes"][0]["nodes"] = list(roots)
    return change


def light(**members):
    def change(s):
        s["extensions"] = {"KHR_lights_punctual": {"lights": [members]}}
        s["nodes"][0]["extensions"] = {"KHR_lights_punctual": {"light": 0}}
    return change


def camera(**members):
    def change(s):
        s["cameras"] = [members]
        s["nodes"][0]["camera"] = 0
    return change


def material(**members):
    def change(s):
        s["materials"] = [members]
        s["meshes"][0]["primitives"][0]["material"] = 0
    return change


def draco(data, attributes):
    def change(s):
        s["buffers"].append({"byteLength": len(data), "uri": data_uri(data)})
        s["bufferViews"].append({"buffer": 1, "byteLength": len(data)})
        s["meshes"][0]["primitives"][0]["extensions"] = {
            "KHR_draco_mesh_compression": {"bufferView": 2, "attributes": attributes}}
    return change


def sparse(count, indices):
    def change(s):
        packed = struct.pack(f"<{len(indices)}H", *indices)
        values = struct.pack("<3f", 1, 1, 1) * len(indices)
        s["buffers"].append({"byteLength": len(packed + values), "uri": data_uri(packed + values)})
        s["bufferViews"] += [{"buffer": 1, "byteLength": len(packed)},
                             {"buffer": 1, "byteOffset": len(packed), "byteLength": len(values)}]
        s["accessors"][0]["sparse"] = {"count": count, "indices": {"bufferView": 2, "componentType": 5123},
                                       "values": {"bufferView": 3}}
    return change


def drop(path):
    def change(s):
        at = s
        for key in path[:-1]:
            at = at[key]
        del at[path[-1]]
    return change


# The container.
binary("cut_in_header", keep=10)
binary("cut_in_chunk", keep=300)
binary("wrong_magic", magic=b"gltf")
binary("version_1", version=1)
binary("length_4g", length=0xFFFFFFFF)
binary("chunk_4g", chunks=[(0xFFFFFFF0, b"JSON", b"{}  ")])
binary("first_chunk_binary", chunks=[(4, b"BIN\0", b"\0\0\0\0")])
binary("no_chunk", chunks=[])
body = json.dumps({**triangle(), "buffers": [{"byteLength": 42}]}).encode()
binary("no_binary_chunk", chunks=[(len(body), b"JSON", body)])

# The text.
text("empty", "")
text("not_json", "solid nonsense\n")
text("cut_json", json.dumps(triangle())[:200])
text("bad_utf8", b'{"asset":{"version":"2.0","generator":"\xff\xfe"}}')
text("number_overflow", '{"asset":{"version":"2.0"},"scene":1e999}')
text("nested_arrays", "[" * 20000)
text("nested_objects", '{"a":' * 20000)
text("root_is_array", "[1, 2, 3]")
text("no_asset", "{}")
bad("version_3", member("asset", {"version": "3.0"}))
bad("min_version", member("asset", {"version": "2.0", "minVersion": "2.1"}))
bad("required_extension", member("extensionsRequired", ["KHR_texture_transform", "ACME_teapots"]))

# Types.
bad("nodes_is_object", member("nodes", {}))
bad("meshes_is_number", member("meshes", 3))
bad("node_is_string", member("nodes", ["mesh"]))
bad("name_is_number", node(name=7))
bad("translation_short", node(translation=[1, 2]))
bad("translation_text", node(translation=[1, 2, "3"]))
bad("mesh_negative", node(mesh=-1))
bad("mesh_fraction", node(mesh=0.5))

# Buffers.
bad("missing_bin", uri("not_there.bin"))
bad("bin_is_folder", uri("."))
bad("uri_absolute", uri("/etc/passwd"))
bad("uri_parent", uri("../secret.bin"))
bad("uri_parent_inside", uri("a/../../secret.bin"))
bad("uri_parent_encoded", uri("%2e%2e/secret.bin"))
bad("uri_http", uri("http://example.com/a.bin"))
bad("uri_file", uri("file:///etc/passwd"))
bad("uri_drive", uri("C:\\\\a.bin"))
bad("uri_nul", uri("a%00.bin"))
bad("base64_wrong_character", uri("data:;base64,AA*A"))
bad("base64_cut", uri("data:;base64,AAAAA"))
bad("data_uri_without_comma", uri("data:"))
bad("buffer_longer_than_data", lambda s: s["buffers"][0].update(byteLength=4000000000))
bad("buffer_without_length", drop(["buffers", 0, "byteLength"]))
bad("view_names_no_buffer", view(0, buffer=1))
bad("view_beyond_buffer", view(1, byteLength=7))
bad("view_offset_overflows", view(1, byteOffset=2**53, byteLength=2**53))
bad("view_length_negative", view(0, byteLength=-1))
bad("stride_too_small", view(0, byteStride=4))
bad("stride_huge", view(0, byteStride=2**40))

# Accessors.
bad("accessor_count_one_too_many", accessor(0, count=4))
bad("accessor_count_4g", accessor(0, count=4294967295))
bad("accessor_count_huge", accessor(0, count=2**53))
bad("accessor_count_negative", accessor(0, count=-3))
bad("accessor_count_text", accessor(0, count="3"))
bad("accessor_without_count", drop(["accessors", 0, "count"]))
bad("accessor_offset_beyond", accessor(0, byteOffset=2**53))
bad("accessor_component_type", accessor(0, componentType=5124))
bad("accessor_type", accessor(0, type="VEC5"))
bad("accessor_matrix", accessor(0, type="MAT3"))
bad("accessor_zeros_4g", lambda s: (s["accessors"][0].update(count=4294967295), s["accessors"][0].pop("bufferView")))
bad("accessor_names_no_view", accessor(0, bufferView=2))
bad("sparse_beyond_accessor", sparse(1, [3]))
bad("sparse_count_4g", sparse(4294967295, [0]))
bad("sparse_count_beyond_view", sparse(3, [0]))
bad("sparse_without_values", accessor(0, sparse={"count": 1}))

# Meshes.
bad("index_beyond_vertices", lambda s: None, POSITIONS + struct.pack("<3H", 0, 1, 3))
bad("index_all_bits", lambda s: None, POSITIONS + struct.pack("<3H", 0, 1, 0xFFFF))
bad("indices_are_floats", primitive(indices=0))
bad("indices_missing", primitive(indices=99))
bad("position_missing", primitive(attributes={"POSITION": 99}))
bad("position_scalar", primitive(attributes={"POSITION": 1}))
bad("position_nan", lambda s: None, struct.pack("<9f", 0, 0, 0, 1, float("nan"), 0, 0, 1, 0) + INDICES)
bad("position_infinite", lambda s: None, struct.pack("<9f", 0, 0, 0, float("inf"), 0, 0, 0, 1, 0) + INDICES)
bad("normal_too_few", lambda s: (s["accessors"].append({**s["accessors"][0], "count": 2}),
                                 s["meshes"][0]["primitives"][0]["attributes"].update(NORMAL=2)))
bad("attributes_is_array", primitive(attributes=[0]))
bad("attributes_missing", drop(["meshes", 0, "primitives", 0, "attributes"]))
bad("mode_9", primitive(mode=9))
bad("mesh_without_primitives", member("meshes", [{"primitives": []}]))
bad("mesh_missing", node(mesh=1))
bad("material_missing", primitive(material=0))
bad("draco_nonsense", draco(b"DRACO is a dragon, and no mesh at all", {"POSITION": 0}))
bad("draco_empty", draco(b"", {"POSITION": 0}))
bad("draco_claims_4g", draco(b"DRACO\x02\x02\x01\x01\0\0" + b"\0" + b"\xff\xff\xff\xff\x0f" * 2 + b"\0" * 20, {"POSITION": 0}))
bad("draco_sequential_claims_4g", draco(b"DRACO\x02\x02\x01\x00\0\0" + b"\xff\xff\xff\xff\x04" * 2 + b"\0" * 20, {"POSITION": 0}))

# Nodes.
bad("node_own_child", nodes({"mesh": 0, "children": [0]}))
bad("node_cycle", nodes({"mesh": 0}, {"children": [2]}, {"children": [1]}))
bad("node_cycle_below_scene", nodes({"children": [1]}, {"children": [0]}))
bad("node_two_parents", nodes({"children": [2]}, {"children": [2]}, {"mesh": 0}, roots=(0, 1)))
bad("node_child_missing", node(children=[5]))
bad("scene_root_is_child", nodes({"children": [1]}, {"mesh": 0}, roots=(0, 1)))
bad("scene_root_twice", nodes({"mesh": 0}, roots=(0, 0)))
bad("scene_root_missing", nodes({"mesh": 0}, roots=(1,)))
bad("scene_missing", member("scene", 4))
bad("matrix_short", node(matrix=[1, 0, 0, 0]))
bad("matrix_projective", node(matrix=[1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))
bad("rotation_zero", node(rotation=[0, 0, 0, 0]))
bad("transform_overflows", nodes({"scale": [1e300] * 3, "children": [1]}, {"scale": [1e300] * 3, "mesh": 0}))

# Materials, lights, cameras.
bad("texture_missing", material(pbrMetallicRoughness={"baseColorTexture": {"index": 0}}))
bad("texture_names_no_image", lambda s: (material(emissiveTexture={"index": 0})(s), s.update(textures=[{"source": 2}])))
bad("alpha_mode", material(alphaMode="GLASS"))
bad("base_colour_text", material(pbrMetallicRoughness={"baseColorFactor": "red"}))
bad("attenuation_distance", material(extensions={
    "KHR_materials_transmission": {"transmissionFactor": 1},
    "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0}}))
bad("light_missing", node(extensions={"KHR_lights_punctual": {"light": 0}}))
bad("light_type", light(type="lava"))
bad("light_negative", light(type="point", intensity=-5))
bad("spot_without_cone", light(type="spot"))
bad("spot_cone_inverted", light(type="spot", spot={"innerConeAngle": 1, "outerConeAngle": 0.5}))
bad("camera_type", camera(type="fisheye"))
bad("camera_fov", camera(type="perspective", perspective={"yfov": 0, "znear": 0.1}))
bad("camera_missing", node(camera=0))
