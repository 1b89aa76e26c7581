#include "penumbra/io/gltf_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>

namespace penumbra {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// Primitives of one mesh that share their vertices.
struct VertexGroup {
  JsonPlace place;  // of the first
  GltfPrimitive source;
  std::vector<std::uint32_t> materials;  // one a triangle
};

std::uint32_t layout_of(const GltfPrimitive& primitive) {
  std::uint32_t layout = 0;
  for (std::size_t a = 0; a < gltf_attribute_count; ++a) layout |= primitive.attributes[a] ? 1U << a : 0U;
  return layout;
}

Vec4f vector_of(const GltfElements& elements, std::size_t i) {
  Vec4f v(0, 0, 0, 1);
  for (int c = 0; c < elements.components; ++c) v[c] = static_cast<float>(elements.value(i, c));
  return v;
}

bool is_finite(const Vec4f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

/// The source vertices that `triangles` use, ascending; the triangles then count in them.
/// @param scratch `none` everywhere, before and after.
std::vector<std::uint32_t> used_vertices(std::vector<Mesh::Triangle>& triangles, std::size_t vertices,
                                         std::vector<std::uint32_t>& scratch) {
  if (scratch.size() < vertices) scratch.resize(vertices, none);
  std::vector<std::uint32_t> used;
  for (const auto& t : triangles) {
    for (const std::uint32_t corner : t) {
      if (scratch[corner] == none) used.push_back(corner);
      scratch[corner] = 0;
    }
  }
  std::sort(used.begin(), used.end());
  for (std::size_t i = 0; i < used.size(); ++i) scratch[used[i]] = static_cast<std::uint32_t>(i);
  for (auto& t : triangles) {
    for (std::uint32_t& corner : t) corner = scratch[corner];
  }
  for (const std::uint32_t vertex : used) scratch[vertex] = none;
  return used;
}

void append_positions(const VertexGroup& group, const std::vector<std::uint32_t>& used, Mesh& mesh) {
  const GltfElements& from = *group.source.attributes[position_attribute];
  for (const std::uint32_t i : used) {
    const Vec3d p(from.value(i, 0), from.value(i, 1), from.value(i, 2));
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      group.place.fail(
          fmt::format("the position of vertex {} (accessor {}) is not a finite number; export the file again", i,
                      group.source.vertex_source[position_attribute]));
    }
    mesh.positions.push_back(p);
  }
}

// Zero or broken normals are marked by zero; `mend_normals` sees to them when the triangles are known.
void append_normals(const VertexGroup& group, const std::vector<std::uint32_t>& used, Mesh& mesh) {
  const auto& from = group.source.attributes[normal_attribute];
  if (!from) return;
  for (const std::uint32_t i : used) {
    const Vec3d n(from->value(i, 0), from->value(i, 1), from->value(i, 2));
    const double size = length(n);
    mesh.normals.push_back(std::isfinite(size) && size > 1e-12 ? Vec3f(n / size) : Vec3f(0));
  }
}

void append_tangents(const VertexGroup& group, const std::vector<std::uint32_t>& used, Mesh& mesh,
                     std::size_t& broken) {
  const auto& from = group.source.attributes[tangent_attribute];
  if (!from) return;
  for (const std::uint32_t i : used) {
    const Vec4f t = vector_of(*from, i);
    const float size = glm::length(Vec3f(t));
    const bool good = is_finite(t) && size > 1e-6F && t.w != 0;
    if (!good) ++broken;
    mesh.tangents.push_back(good ? Vec4f(Vec3f(t) / size, t.w < 0 ? -1.0F : 1.0F) : Vec4f(1, 0, 0, 1));
  }
}

void append_uv_and_colours(const VertexGroup& group, const std::vector<std::uint32_t>& used, Mesh& mesh,
                           std::size_t& broken) {
  for (std::size_t set = 0; set < 2; ++set) {
    const auto& from = group.source.attributes[uv_0_attribute + set];
    if (!from) continue;
    for (const std::uint32_t i : used) {
      const Vec4f uv = vector_of(*from, i);
      const bool good = is_finite(uv);
      if (!good) ++broken;
      mesh.uv[set].push_back(good ? Vec2f(uv.x, uv.y) : Vec2f(0));
    }
  }
  if (const auto& from = group.source.attributes[colour_attribute]) {
    for (const std::uint32_t i : used) {
      const Vec4f colour = vector_of(*from, i);
      const bool good = is_finite(colour);
      if (!good) ++broken;
      mesh.colours.push_back(good ? glm::max(colour, Vec4f(0)) : Vec4f(1));
    }
  }
}

void append_group(VertexGroup& group, Mesh& mesh, std::vector<std::uint32_t>& scratch, WarningTally& warnings) {
  const std::size_t vertices = group.source.attributes[position_attribute]->count;
  const auto used = used_vertices(group.source.triangles, vertices, scratch);
  const std::size_t base = mesh.positions.size();
  if (base + used.size() >= none) group.place.fail("the mesh has more than 4294967294 vertices; split it");
  std::size_t broken = 0;
  append_positions(group, used, mesh);
  append_normals(group, used, mesh);
  append_tangents(group, used, mesh, broken);
  append_uv_and_colours(group, used, mesh, broken);
  warnings.count("vertex attributes that are no finite numbers or no directions were replaced by defaults",
                 group.place.place(), broken);
  for (const auto& t : group.source.triangles) {
    const auto shift = static_cast<std::uint32_t>(base);
    mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  }
  mesh.materials.insert(mesh.materials.end(), group.materials.begin(), group.materials.end());
}

// Triangles whose normal is lost in the rounding of their edges; no light can land on them.
std::size_t zero_area_triangles(const Mesh& mesh) {
  return static_cast<std::size_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const Vec3d a = mesh.positions[t[1]] - mesh.positions[t[0]];
    const Vec3d b = mesh.positions[t[2]] - mesh.positions[t[0]];
    const double longest = std::max({dot(a, a), dot(b, b), dot(b - a, b - a)});
    return !(length(cross(a, b)) > 1e-14 * longest);
  }));
}

// A vertex whose normal is none gets the mean of its triangles, by area.
void mend_normals(Mesh& mesh, const JsonPlace& place, WarningTally& warnings) {
  const auto is_zero = [](const Vec3f& n) { return n.x == 0 && n.y == 0 && n.z == 0; };
  const auto broken = static_cast<std::size_t>(std::count_if(mesh.normals.begin(), mesh.normals.end(), is_zero));
  if (broken == 0) return;
  warnings.count("vertex normals without a direction were replaced by those of their triangles", place.place(), broken);
  std::vector<Vec3d> mean(mesh.normals.size(), Vec3d(0));
  for (const auto& t : mesh.triangles) {
    const Vec3d normal =
        cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
    for (const std::uint32_t corner : t) mean[corner] += normal;
  }
  for (std::size_t i = 0; i < mean.size(); ++i) {
    if (!is_zero(mesh.normals[i])) continue;
    const double size = length(mean[i]);
    mesh.normals[i] = std::isfinite(size) && size > 0 ? Vec3f(mean[i] / size) : Vec3f(0, 1, 0);
  }
}

void finish(Mesh& mesh, const JsonPlace& place, WarningTally& warnings) {
  const bool one_material =
      std::adjacent_find(mesh.materials.begin(), mesh.materials.end(), std::not_equal_to<>()) == mesh.materials.end();
  if (one_material) mesh.materials.resize(1);
  mend_normals(mesh, place, warnings);
  warnings.count("zero-area triangles were kept but receive no light", place.place(), zero_area_triangles(mesh));
}

}  // namespace

// Primitives may share accessors, so a small file could ask for any number of triangles. An honest one holds a triangle
// in some 20 bytes, or in one when it is compressed.
void GltfMeshes::check_size(std::size_t more_triangles, const JsonPlace& place) const {
  const std::size_t most = (std::size_t{1} << 22) + 16 * document_->byte_count();
  if (triangles_read_ + more_triangles > most) {
    place.fail(
        fmt::format("the file's {} bytes cannot hold as many triangles as it asks for ({} so far); export it again",
                    document_->byte_count(), triangles_read_ + more_triangles));
  }
}

std::vector<Mesh> GltfMeshes::read(std::uint64_t index, const JsonPlace& user, const GltfDeformation& deformation) {
  const JsonPlace place = document_->item("meshes", "mesh", index, user);
  const auto primitives = place.list("primitives");
  if (!primitives || primitives->size() == 0) place.fail("has no primitives; export the file again");

  std::size_t declared = 0;
  for (std::size_t i = 0; i < primitives->size(); ++i) {
    declared += declared_triangles(*accessors_, primitives->item(i, place.place() + ", primitive"));
  }
  check_size(declared, place);

  std::vector<VertexGroup> groups;
  std::map<std::array<std::int64_t, gltf_attribute_count>, std::size_t> group_of_source;
  for (std::size_t i = 0; i < primitives->size(); ++i) {
    const JsonPlace primitive_place = primitives->item(i, place.place() + ", primitive");
    auto primitive = read_gltf_primitive(*document_, *accessors_, primitive_place, deformation);
    if (!primitive || primitive->triangles.empty()) continue;
    const std::size_t count = primitive->triangles.size();
    triangles_read_ += count;
    if (primitive->draco) check_size(0, primitive_place);
    const auto gltf_material = primitive_place.whole("material");
    const std::uint32_t material =
        material_of_(gltf_material ? static_cast<std::int64_t>(*gltf_material) : -1, primitive_place);
    const auto known = primitive->is_alone() ? group_of_source.end() : group_of_source.find(primitive->vertex_source);
    if (known == group_of_source.end()) {
      if (!primitive->is_alone()) group_of_source.emplace(primitive->vertex_source, groups.size());
      groups.push_back({primitive_place, std::move(*primitive), std::vector<std::uint32_t>(count, material)});
    } else {
      VertexGroup& group = groups[known->second];
      group.source.triangles.insert(group.source.triangles.end(), primitive->triangles.begin(),
                                    primitive->triangles.end());
      group.materials.insert(group.materials.end(), count, material);
    }
  }

  std::vector<Mesh> meshes;
  std::map<std::uint32_t, std::size_t> mesh_of_layout;
  for (VertexGroup& group : groups) {
    const auto [slot, is_new] = mesh_of_layout.emplace(layout_of(group.source), meshes.size());
    if (is_new) meshes.emplace_back().materials.clear();
    append_group(group, meshes[slot->second], new_vertex_, document_->warnings());
  }
  const std::string name = place.text("name").empty() ? place.place() : place.text("name");
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    meshes[i].name = meshes.size() == 1 ? name : fmt::format("{} (part {})", name, i + 1);
    meshes[i].extras = place.extras_without("penumbra");
    finish(meshes[i], place, document_->warnings());
  }
  return meshes;
}

}  // namespace penumbra
