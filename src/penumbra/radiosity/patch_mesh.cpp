#include "penumbra/radiosity/patch_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "penumbra/math/polygon.h"
#include "penumbra/math/polygon_pieces.h"
#include "penumbra/math/transform.h"
#include "penumbra/radiosity/patch_mesh_builder.h"
#include "penumbra/radiosity/shape_polygons.h"
#include "penumbra/scene/object_label.h"

namespace penumbra {
namespace {

/// Faces of a scene are numbered object by object: where each object's begin, and the total at the end.
class SceneFaces {
 public:
  void begin_object() { first_.push_back(count_); }
  std::uint32_t next() { return count_++; }
  /// The object of a face and the face's number within it.
  [[nodiscard]] std::pair<std::size_t, std::uint32_t> locate(std::uint32_t face) const {
    const auto after = std::upper_bound(first_.begin(), first_.end(), face);
    return {static_cast<std::size_t>(after - first_.begin()) - 1, face - *(after - 1)};
  }

 private:
  std::vector<std::uint32_t> first_;
  std::uint32_t count_ = 0;
};

PatchPaint paint_of(const Material& material) {
  PatchPaint paint;
  for (int b = 0; b < 3; ++b) {
    paint.reflectance.push_back(double{material.base_colour[b]} * (1 - double{material.metallic}) *
                                (1 - double{material.transmission}));
    paint.emission.push_back(std::numbers::pi * double{material.emission[b]});
  }
  paint.back_emission = material.double_sided ? paint.emission : std::vector<double>(3, 0.0);
  return paint;
}

/// The material of each face: that of its first triangle.
std::vector<std::uint32_t> face_materials(const Mesh& mesh) {
  std::vector<std::uint32_t> materials(mesh.face_count(), mesh.materials.empty() ? 0 : mesh.materials[0]);
  if (mesh.materials.size() < 2) return materials;
  for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
    materials[mesh.face_offsets.empty() ? t : mesh.face_of_triangle[t]] = mesh.materials[t];
  }
  return materials;
}

/// Walks a scene's faces and hands them to a builder, making rows as the grouping asks.
class SceneCollector {
 public:
  SceneCollector(const Scene& scene, const PatchMeshOptions& options)
      : scene_(scene), options_(options), builder_(3, options, [this](std::uint32_t face) { return place_of(face); }) {
    for (const Material& material : scene.materials) builder_.add_paint(paint_of(material));
  }

  MadePatchMesh collect() {
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) add_instance(i);
    for (std::size_t i = 0; i < scene_.shapes.size(); ++i) add_shape(i);
    return builder_.finish();
  }

 private:
  [[nodiscard]] std::string place_of(std::uint32_t face) const {
    const auto [object, within] = faces_.locate(face);
    return fmt::format("Face {} of \"{}\"", within + 1, object_label(scene_, object));
  }

  void add_instance(std::size_t object) {
    faces_.begin_object();
    const Instance& instance = scene_.instances[object];
    const Mesh& mesh = scene_.meshes[instance.mesh];
    const bool mirrored = is_mirroring(instance.to_world);
    const std::vector<std::uint32_t> materials = face_materials(mesh);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      std::vector<Vec3d> polygon;
      for (const std::uint32_t v : mesh.face(f)) {
        polygon.push_back(transform_point(instance.to_world, mesh.positions[v]));
      }
      if (mirrored) std::reverse(polygon.begin(), polygon.end());
      add_face(std::move(polygon), object, materials[f], mesh.face_count() > 1);
    }
  }

  void add_shape(std::size_t index) {
    faces_.begin_object();
    const ShapeObject& shape = scene_.shapes[index];
    const std::size_t object = scene_.instances.size() + index;
    const std::string label = object_label(scene_, object);
    if (std::holds_alternative<Plane>(shape.shape)) {
      throw std::invalid_argument(
          fmt::format("\"{}\" is a plane without end, which has no area: give it as a polygon.", label));
    }
    if (options_.shape_segments == 0) {
      throw std::invalid_argument(
          fmt::format("\"{}\" is an exact round shape, and form factors need polygons: give it as a mesh.", label));
    }
    for (std::vector<Vec3d>& polygon : shape_polygons(shape.shape, options_.shape_segments)) {
      add_face(std::move(polygon), object, shape.material, true);
    }
  }

  void add_face(std::vector<Vec3d> polygon, std::size_t object, std::uint32_t material, bool one_of_many) {
    const std::uint32_t face = faces_.next();
    builder_.add_face(std::move(polygon), face, surface_for(face, object, material, one_of_many), material);
  }

  std::uint32_t surface_for(std::uint32_t face, std::size_t object, std::uint32_t material, bool one_of_many) {
    const auto object_number = static_cast<std::uint32_t>(object);
    if (options_.grouping == SurfaceGrouping::face) {
      const std::string label = object_label(scene_, object);
      const std::uint32_t within = faces_.locate(face).second;
      return builder_.add_surface(
          {one_of_many ? fmt::format("{}.{}", label, within + 1) : label, face, object_number, false, 0});
    }
    const bool by_object = options_.grouping == SurfaceGrouping::object;
    const auto [at, is_new] = surface_of_group_.try_emplace(by_object ? object_number : material, 0);
    if (is_new) {
      std::string name = by_object ? object_label(scene_, object) : scene_.materials[material].name;
      if (name.empty()) name = fmt::format("material {}", material + 1);
      at->second = builder_.add_surface({std::move(name), face, object_number, false, 0});
    }
    return at->second;
  }

  const Scene& scene_;
  const PatchMeshOptions& options_;
  SceneFaces faces_;
  PatchMeshBuilder builder_;
  std::map<std::uint32_t, std::uint32_t> surface_of_group_;  // by object or material
};

std::string model_place(const ModelPolygon& polygon, std::uint32_t index) {
  const std::string name = polygon.name.empty() ? std::to_string(index + 1) : fmt::format("\"{}\"", polygon.name);
  return polygon.place.empty() ? fmt::format("Surface {}", name) : fmt::format("Surface {} ({})", name, polygon.place);
}

std::vector<Vec3d> model_outline(const PolygonModel& model, std::uint32_t index) {
  std::vector<Vec3d> outline;
  for (const std::uint32_t v : model.polygons[index].corners) {
    if (v >= model.vertices.size()) {
      throw std::invalid_argument(fmt::format("{} uses vertex {}, but there are {} of them.",
                                              model_place(model.polygons[index], index), v + 1, model.vertices.size()));
    }
    const Vec3d& p = model.vertices[v];
    if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) {
      throw std::invalid_argument(fmt::format("{} has a corner (vertex {}) that is not a finite number.",
                                              model_place(model.polygons[index], index), v + 1));
    }
    outline.push_back(p);
  }
  return outline;
}

bool has_row(const ModelPolygon& polygon) {
  return polygon.role == PolygonRole::radiates || polygon.role == PolygonRole::covers;
}

/// The polygon whose row takes this one: the end of its chain of combinations.
std::uint32_t combined_into(const PolygonModel& model, std::uint32_t index) {
  std::uint32_t at = index;
  for (std::size_t step = 0; step <= model.polygons.size(); ++step) {
    const ModelPolygon& polygon = model.polygons[at];
    if (!polygon.combines_with || *polygon.combines_with == at) {
      if (has_row(polygon)) return at;
      throw std::invalid_argument(fmt::format("{} is combined with {}, which does not radiate.",
                                              model_place(model.polygons[index], index), model_place(polygon, at)));
    }
    if (*polygon.combines_with >= model.polygons.size()) {
      throw std::invalid_argument(fmt::format("{} is combined with surface {}, but there are {} of them.",
                                              model_place(polygon, at), *polygon.combines_with + 1,
                                              model.polygons.size()));
    }
    at = *polygon.combines_with;
  }
  throw std::invalid_argument(fmt::format("{} is combined in a circle: let one of them stand for itself.",
                                          model_place(model.polygons[index], index)));
}

/// Refuses a covering polygon that has nothing to cover, looks away from it or reaches beyond it (View3D's rules).
void check_cover(const PolygonModel& model, std::uint32_t index) {
  const ModelPolygon& polygon = model.polygons[index];
  if (!polygon.base || model.polygons[*polygon.base].role != PolygonRole::radiates) {
    throw std::invalid_argument(fmt::format("{} covers nothing that radiates: its base should be a radiating surface.",
                                            model_place(polygon, index)));
  }
  const std::string base_place = model_place(model.polygons[*polygon.base], *polygon.base);
  const std::vector<Vec3d> outline = model_outline(model, index), base = model_outline(model, *polygon.base);
  const Vec3d normal = polygon_normal(base);
  if (dot(polygon_normal(outline), normal) > 0) {
    throw std::invalid_argument(fmt::format("{} should face its base, {}: reverse the order of its corners.",
                                            model_place(polygon, index), base_place));
  }
  if (!is_convex(base)) return;
  const double tolerance = 1e-6 * polygon_size(base);
  for (std::size_t k = 0; k < base.size(); ++k) {
    const Vec3d inward = cross(normal, base[(k + 1) % base.size()] - base[k]);
    for (const Vec3d& p : outline) {
      if (dot(inward, p - base[k]) < -tolerance * length(inward)) {
        throw std::invalid_argument(
            fmt::format("{} reaches beyond its base, {}.", model_place(polygon, index), base_place));
      }
    }
  }
}

/// For each polygon the outlines of those that lie on it.
std::vector<std::vector<std::vector<Vec3d>>> model_holes(const PolygonModel& model) {
  std::vector<std::vector<std::vector<Vec3d>>> holes(model.polygons.size());
  for (std::uint32_t i = 0; i < model.polygons.size(); ++i) {
    const ModelPolygon& polygon = model.polygons[i];
    if (!polygon.base) continue;
    if (*polygon.base >= model.polygons.size() || *polygon.base == i) {
      throw std::invalid_argument(fmt::format("{} lies on surface {}, which is not another surface of the model.",
                                              model_place(polygon, i), *polygon.base + 1));
    }
    const std::vector<Vec3d> outline = model_outline(model, i);
    const std::vector<Vec3d> base = model_outline(model, *polygon.base);
    const Plane3 plane = polygon_plane(base);
    const double tolerance = 1e-6 * polygon_size(base);
    for (const Vec3d& p : outline) {
      if (std::abs(plane.distance(p)) > tolerance) {
        throw std::invalid_argument(fmt::format("{} does not lie in the plane of its base, {}.",
                                                model_place(polygon, i),
                                                model_place(model.polygons[*polygon.base], *polygon.base)));
      }
    }
    for (const auto& ring : convex_pieces(outline)) {
      std::vector<Vec3d> piece;
      for (const std::uint32_t v : ring) piece.push_back(outline[v]);
      holes[*polygon.base].push_back(std::move(piece));
    }
  }
  return holes;
}

}  // namespace

std::uint32_t add_patch(PatchMesh& mesh, std::span<const std::uint32_t> corners, std::uint32_t surface,
                        std::uint32_t face) {
  for (const std::uint32_t v : corners) {
    mesh.corners.push_back(v);
    mesh.corner_positions.push_back(mesh.vertices[v]);
  }
  mesh.corner_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  const auto polygon = std::span<const Vec3d>(mesh.corner_positions).last(corners.size());
  mesh.areas.push_back(polygon_area(polygon));
  mesh.centroids.push_back(polygon_centroid(polygon));
  mesh.normals.push_back(polygon_normal(polygon));
  mesh.surface_of.push_back(surface);
  mesh.face_of.push_back(face);
  if (surface != PatchMesh::no_surface) {
    mesh.surfaces[surface].area += mesh.areas.back();
    ++mesh.radiating_count;
  }
  return static_cast<std::uint32_t>(mesh.areas.size() - 1);
}

MadePatchMesh make_patch_mesh(const Scene& scene, const PatchMeshOptions& options) {
  return SceneCollector(scene, options).collect();
}

MadePatchMesh make_patch_mesh(const PolygonModel& model, const PatchMeshOptions& options) {
  PatchMeshBuilder builder(1, options, [&](std::uint32_t face) { return model_place(model.polygons[face], face); });
  const auto count = static_cast<std::uint32_t>(model.polygons.size());
  std::vector<std::uint32_t> row(count, PatchMesh::no_surface), paint(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const ModelPolygon& polygon = model.polygons[i];
    paint[i] = builder.add_paint({{polygon.reflectance}, {0.0}, {0.0}});
    if (has_row(polygon) && combined_into(model, i) == i) {
      row[i] = builder.add_surface({polygon.name.empty() ? std::to_string(i + 1) : polygon.name, i, 0, false, 0});
    }
  }
  const auto holes = model_holes(model);
  const auto row_of = [&](std::uint32_t i) {
    return has_row(model.polygons[i]) ? row[combined_into(model, i)] : PatchMesh::no_surface;
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const ModelPolygon& polygon = model.polygons[i];
    if (polygon.role == PolygonRole::masks) continue;
    if (polygon.role == PolygonRole::covers) {
      check_cover(model, i);
      const std::uint32_t base = *polygon.base;
      builder.add_cover(model_outline(model, i), {i, row_of(i), paint[i]}, {base, row_of(base), paint[base]});
    } else {
      builder.add_face(model_outline(model, i), i, row_of(i), paint[i], holes[i]);
    }
  }
  return builder.finish();
}

}  // namespace penumbra
