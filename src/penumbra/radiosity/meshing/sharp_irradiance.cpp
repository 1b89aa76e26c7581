#include "penumbra/radiosity/meshing/sharp_irradiance.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

/// How far inside its element a corner is looked at, in parts of the way to the middle.
constexpr double inset = 1e-3;
/// Elements that disagree by more than this share of the brightest have vertices of their own.
constexpr double jump = 0.02;
/// Rows of sample points in each triangle of an element, for its mean.
constexpr int rows = 2;

struct Direct {
  std::vector<Vec3d> of_elements;
  std::vector<Vec3d> of_corners;  // [triangle * 3 + corner]
};

/// Mean of the lamps' irradiance over an element, at the centres of similar triangles.
Vec3d mean_over(const LampIrradiance::View& view, std::span<const Vec3d> polygon) {
  Vec3d sum(0);
  double weight = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3d e1 = polygon[k - 1] - polygon[0], e2 = polygon[k] - polygon[0];
    const double area = length(cross(e1, e2));
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i + j < rows; ++i) {
        for (int between = 0; between < (i + j + 1 < rows ? 2 : 1); ++between) {
          const double third = between == 0 ? 1.0 / 3 : 2.0 / 3;
          sum += area * view.at(polygon[0] + ((i + third) / rows) * e1 + ((j + third) / rows) * e2);
          weight += area;
        }
      }
    }
  }
  return sum / weight;
}

std::vector<double> less(std::span<const double> irradiance, const std::vector<Vec3d>& direct) {
  std::vector<double> rest(irradiance.begin(), irradiance.end());
  for (std::size_t e = 0; e < direct.size(); ++e) {
    for (int b = 0; b < 3; ++b) rest[3 * e + static_cast<std::size_t>(b)] -= direct[e][b];
  }
  return rest;
}

Direct direct_light(const LampIrradiance& light, const PatchMesh& elements, const ShadingMesh& shading) {
  Direct direct;
  direct.of_elements.assign(elements.patch_count(), Vec3d(0));
  direct.of_corners.assign(3 * shading.triangles.size(), Vec3d(0));
  // Triangles are ordered by element.
  std::vector<std::size_t> first(elements.patch_count() + 1, 0);
  for (const std::uint32_t e : shading.element_of_triangle) ++first[e + 1];
  for (std::size_t e = 0; e < elements.patch_count(); ++e) first[e + 1] += first[e];
  parallel_for(elements.patch_count(), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<std::uint32_t, Vec3d>> known;
    for (std::size_t e = begin; e < end; ++e) {
      const LampIrradiance::View view = light.view(elements.polygon(e));
      if (!view.is_lit()) continue;
      direct.of_elements[e] = mean_over(view, elements.polygon(e));
      known.clear();
      for (std::size_t c = 3 * first[e]; c < 3 * first[e + 1]; ++c) {
        const std::uint32_t v = shading.triangles[c / 3][c % 3];
        auto at = std::find_if(known.begin(), known.end(), [&](const auto& entry) { return entry.first == v; });
        if (at == known.end()) {
          const Vec3d& p = shading.positions[v];
          known.emplace_back(v, view.at(p + inset * (elements.centroids[e] - p)));
          at = known.end() - 1;
        }
        direct.of_corners[c] = at->second;
      }
    }
  });
  return direct;
}

double departure(const Vec3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Gives the corners of each vertex to it or to copies of it, so that those of one agree.
class VertexSplitter {
 public:
  VertexSplitter(ShadingMesh mesh, const std::vector<Vec3d>& of_corners) : mesh_(std::move(mesh)) {
    double brightest = 0;
    for (const Vec3d& v : of_corners) brightest = std::max(brightest, departure(v));
    sums_.resize(mesh_.vertex_count());
    for (std::size_t c = 0; c < of_corners.size(); ++c) {
      std::uint32_t& v = mesh_.triangles[c / 3][c % 3];
      v = find(v, of_corners[c], jump * brightest);
      sums_[v].value += of_corners[c];
      sums_[v].count += 1;
    }
  }

  [[nodiscard]] Vec3d direct(std::size_t vertex) const {
    const Sum& s = sums_[vertex];
    return s.count > 0 ? s.value / s.count : Vec3d(0);
  }
  ShadingMesh take() { return std::move(mesh_); }

 private:
  struct Sum {
    Vec3d value{0};
    double count = 0;
    std::uint32_t next = 0;  // another vertex at the same place; 0: none
  };

  std::uint32_t find(std::uint32_t vertex, const Vec3d& value, double tolerance) {
    std::uint32_t at = vertex;
    while (sums_[at].count > 0 && departure(sums_[at].value / sums_[at].count - value) > tolerance) {
      if (sums_[at].next == 0) {
        const std::uint32_t copied = copy(vertex);
        sums_[at].next = copied;
        return copied;
      }
      at = sums_[at].next;
    }
    return at;
  }

  std::uint32_t copy(std::uint32_t vertex) {
    const Vec3d position = mesh_.positions[vertex], normal = mesh_.normals[vertex];
    mesh_.positions.push_back(position);
    mesh_.normals.push_back(normal);
    for (std::uint32_t k = mesh_.offsets[vertex]; k < mesh_.offsets[vertex + 1]; ++k) {
      const std::uint32_t element = mesh_.elements[k];
      const double weight = mesh_.weights[k];
      mesh_.elements.push_back(element);
      mesh_.weights.push_back(weight);
    }
    mesh_.offsets.push_back(static_cast<std::uint32_t>(mesh_.elements.size()));
    sums_.emplace_back();
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  ShadingMesh mesh_;
  std::vector<Sum> sums_;
};

}  // namespace

std::vector<double> without_lamps(const LampIrradiance& light, const PatchMesh& elements,
                                  std::span<const double> irradiance) {
  std::vector<Vec3d> direct(elements.patch_count(), Vec3d(0));
  parallel_for(elements.patch_count(), 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) {
      const LampIrradiance::View view = light.view(elements.polygon(e));
      if (view.is_lit()) direct[e] = mean_over(view, elements.polygon(e));
    }
  });
  return less(irradiance, direct);
}

SharpIrradiance sharp_irradiance(const LampIrradiance& light, const PatchMesh& elements, const ShadingMesh& shading,
                                 std::span<const double> irradiance) {
  assert(irradiance.size() == 3 * elements.patch_count());
  const Direct direct = direct_light(light, elements, shading);
  const std::vector<double> rest = less(irradiance, direct.of_elements);
  VertexSplitter splitter(shading, direct.of_corners);
  SharpIrradiance sharp;
  sharp.mesh = splitter.take();
  sharp.at_vertices = sharp.mesh.at_vertices(rest, 3);
  for (std::size_t v = 0; v < sharp.mesh.vertex_count(); ++v) {
    const Vec3d own = splitter.direct(v);
    for (int b = 0; b < 3; ++b) {
      double& value = sharp.at_vertices[3 * v + static_cast<std::size_t>(b)];
      value = std::max(0.0, value + own[b]);
    }
  }
  return sharp;
}

}  // namespace penumbra
