#include "factor_geometry.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "penumbra/file/file_error.h"
#include "penumbra/io/ply_reader.h"
#include "penumbra/io/scene_reader.h"
#include "penumbra/io/stl_reader.h"
#include "penumbra/io/vs3_reader.h"
#include "scene_options.h"

namespace penumbra::cli {
namespace {

constexpr int around_shapes = 48;  // sides of the polygons that stand for exact spheres, disks and cylinders

std::string extension_of(const std::string& source) {
  std::string extension = std::filesystem::path(source).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return source.starts_with("builtin:") ? "" : extension;
}

LoadedScene read_mesh_scene(const std::string& source, const ReadOptions& options) {
  const std::string extension = extension_of(source);
  if (extension == ".stl") return read_stl(source, options.unit);
  if (extension == ".ply") return read_ply(source, options.unit);
  return read_scene(source, options);
}

ReadOptions read_options(const FactorGeometryOptions& options) {
  return {.unit = options.unit, .allow_outside = options.allow_outside};
}

/// Gathers the polygons of all inputs into one model; where each came from is its place.
class ModelGatherer {
 public:
  ModelGatherer(const FactorGeometryOptions& options, std::vector<std::string>& warnings)
      : options_(options), warnings_(warnings) {}

  /// @param role of what would radiate. @param one_surface merges all of it into one row.
  void add(const std::string& source, PolygonRole role, bool one_surface) {
    const auto first = static_cast<std::uint32_t>(model_.polygons.size());
    if (extension_of(source) == ".vs3") {
      add_model(source);
    } else {
      add_scene(source, read_mesh_scene(source, read_options(options_)));
    }
    std::optional<std::uint32_t> head;
    for (std::uint32_t p = first; p < model_.polygons.size(); ++p) {
      ModelPolygon& polygon = model_.polygons[p];
      if (polygon.role != PolygonRole::radiates && polygon.role != PolygonRole::covers) continue;
      if (polygon.role == PolygonRole::radiates || role != PolygonRole::radiates) polygon.role = role;
      if (role != PolygonRole::radiates) {
        polygon.combines_with.reset();
      } else if (one_surface) {
        if (head) polygon.combines_with = head;
        if (!head) {
          head = p;
          polygon.combines_with.reset();
          polygon.name = std::filesystem::path(source).stem().string();
        }
      }
    }
  }

  [[nodiscard]] const PolygonModel& model() const { return model_; }

 private:
  void add_model(const std::string& source) {
    LoadedPolygonModel loaded = read_vs3(source, options_.unit);
    warnings_.insert(warnings_.end(), loaded.warnings.begin(), loaded.warnings.end());
    const auto first_vertex = static_cast<std::uint32_t>(model_.vertices.size());
    const auto first_polygon = static_cast<std::uint32_t>(model_.polygons.size());
    model_.vertices.insert(model_.vertices.end(), loaded.model.vertices.begin(), loaded.model.vertices.end());
    for (ModelPolygon& polygon : loaded.model.polygons) {
      for (std::uint32_t& c : polygon.corners) c += first_vertex;
      if (polygon.base) *polygon.base += first_polygon;
      if (polygon.combines_with) *polygon.combines_with += first_polygon;
      polygon.place = fmt::format("{}: {}", source, polygon.place);
      model_.polygons.push_back(std::move(polygon));
    }
  }

  void add_scene(const std::string& source, LoadedScene loaded) {
    warnings_.insert(warnings_.end(), loaded.warnings.begin(), loaded.warnings.end());
    const Scene& scene = loaded.scene;
    require_room_for_faces(scene, source);
    if (!scene.shapes.empty()) {
      throw FileError(source, "", "holds exact shapes beside polygons; factors takes it alone, as one MESH");
    }
    std::map<std::uint32_t, std::uint32_t> head_of_material;
    for (std::size_t object = 0; object < scene.instances.size(); ++object) {
      const Instance& instance = scene.instances[object];
      const Mesh& mesh = scene.meshes[instance.mesh];
      const auto first_vertex = static_cast<std::uint32_t>(model_.vertices.size());
      const bool mirrored = glm::determinant(Mat3d(instance.to_world)) < 0;
      for (const Vec3d& p : mesh.positions) model_.vertices.emplace_back(instance.to_world * Vec4d(p, 1));
      std::optional<std::uint32_t> head_of_object;
      std::vector<std::uint32_t> material_of(mesh.face_count(), mesh.material_of(0));
      for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
        material_of[mesh.face_of_triangle.empty() ? t : mesh.face_of_triangle[t]] = mesh.material_of(t);
      }
      for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const auto self = static_cast<std::uint32_t>(model_.polygons.size());
        ModelPolygon polygon;
        for (const std::uint32_t c : mesh.face(f)) polygon.corners.push_back(first_vertex + c);
        if (mirrored) std::reverse(polygon.corners.begin(), polygon.corners.end());
        drop_repeated_corners(polygon.corners);
        polygon.name = mesh.face_count() == 1 ? instance.name : fmt::format("{}/{}", instance.name, f + 1);
        polygon.place = mesh.face_lines.empty() ? fmt::format("{}: object {}, face {}", source, instance.name, f + 1)
                                                : fmt::format("{}: line {}", source, mesh.face_lines[f]);
        if (options_.grouping == SurfaceGrouping::object) {
          if (head_of_object) polygon.combines_with = head_of_object;
          if (!head_of_object) {
            head_of_object = self;
            polygon.name = instance.name;
          }
        } else if (options_.grouping == SurfaceGrouping::material) {
          const auto [head, fresh] = head_of_material.emplace(material_of[f], self);
          if (!fresh) polygon.combines_with = head->second;
          if (fresh) polygon.name = scene.materials[material_of[f]].name;
        }
        model_.polygons.push_back(std::move(polygon));
      }
    }
  }

  void drop_repeated_corners(std::vector<std::uint32_t>& corners) const {
    for (std::size_t c = 0; c < corners.size() && corners.size() > 3;) {
      const std::uint32_t next = corners[(c + 1) % corners.size()];
      if (model_.vertices[corners[c]] == model_.vertices[next]) {
        corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(c));
      } else {
        ++c;
      }
    }
  }

  const FactorGeometryOptions& options_;
  std::vector<std::string>& warnings_;
  PolygonModel model_;
};

PatchMesh checked(MadePatchMesh made, std::vector<std::string>& warnings) {
  warnings.insert(warnings.end(), made.warnings.begin(), made.warnings.end());
  if (made.mesh.surface_count() == 0) throw std::invalid_argument("There is no surface that radiates.");
  return std::move(made.mesh);
}

// Built-in scenes may hold exact spheres and the like, which only the scene's own builder makes into polygons.
std::optional<PatchMesh> load_shapes(const FactorGeometryOptions& options, const PatchMeshOptions& patch_options,
                                     std::vector<std::string>& warnings) {
  if (options.is_pair() || options.meshes.size() != 1 || extension_of(options.meshes[0]) == ".vs3") return std::nullopt;
  if (!options.meshes[0].starts_with("builtin:")) return std::nullopt;
  const LoadedScene loaded = read_mesh_scene(options.meshes[0], read_options(options));
  if (loaded.scene.shapes.empty()) return std::nullopt;
  PatchMeshOptions with_shapes = patch_options;
  with_shapes.shape_segments = around_shapes;
  warnings.push_back(
      fmt::format("{}: exact shapes were made into polygons, {} sides around", options.meshes[0], around_shapes));
  return checked(make_patch_mesh(loaded.scene, with_shapes), warnings);
}

}  // namespace

PatchMesh load_factor_geometry(const FactorGeometryOptions& options, std::vector<std::string>& warnings) {
  PatchMeshOptions patch_options;
  patch_options.grouping = options.grouping;
  patch_options.sides = options.sides;
  if (auto mesh = load_shapes(options, patch_options, warnings)) return std::move(*mesh);

  ModelGatherer gatherer(options, warnings);
  if (options.is_pair()) {
    gatherer.add(options.from, PolygonRole::radiates, true);
    gatherer.add(options.to, PolygonRole::radiates, true);
    for (const std::string& source : options.blockers) gatherer.add(source, PolygonRole::obstructs, false);
  } else {
    for (const std::string& source : options.meshes) gatherer.add(source, PolygonRole::radiates, false);
  }
  const std::string& first = options.is_pair() ? options.from : options.meshes.front();
  try {
    return checked(make_patch_mesh(gatherer.model(), patch_options), warnings);
  } catch (const std::invalid_argument& e) {
    throw FileError(options.is_pair() || options.meshes.size() > 1 ? "factors" : first, "", e.what());
  }
}

}  // namespace penumbra::cli
