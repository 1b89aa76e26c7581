#include "penumbra/radiosity/meshing/shading_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "penumbra/math/bounds.h"
#include "penumbra/math/frame.h"
#include "penumbra/radiosity/patch_outlines.h"

namespace penumbra {
namespace {

using Ring = std::vector<std::uint32_t>;

double mesh_size(const PatchMesh& mesh) {
  Bounds all;
  for (const Vec3d& v : mesh.vertices) all.grow(v);
  return mesh.vertices.empty() ? 0 : length(all.upper - all.lower);
}

/// Classes of corners that become one vertex.
class CornerClasses {
 public:
  explicit CornerClasses(std::size_t corners) : parent_(corners) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t find(std::uint32_t c) {
    while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
    return c;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t ra = find(a), rb = find(b);
    parent_[std::max(ra, rb)] = std::min(ra, rb);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// An element's use of an edge between two vertices.
struct EdgeUse {
  std::uint32_t low, high;  // vertices
  std::uint32_t element;
  std::uint32_t low_corner, high_corner;  // of the element
  bool forwards;                          // from low to high
};

std::vector<EdgeUse> edge_uses(const PatchOutlines& outlines, std::size_t elements) {
  std::vector<EdgeUse> uses;
  uses.reserve(outlines.corner_count());
  for (std::uint32_t e = 0; e < elements; ++e) {
    const auto ring = outlines.ring(e);
    for (std::uint32_t k = 0; k < ring.size(); ++k) {
      const std::uint32_t next = k + 1 == ring.size() ? 0 : k + 1;
      const std::uint32_t here = outlines.first_corner(e) + k, there = outlines.first_corner(e) + next;
      if (ring[k] < ring[next]) {
        uses.push_back({ring[k], ring[next], e, here, there, true});
      } else {
        uses.push_back({ring[next], ring[k], e, there, here, false});
      }
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.element) < std::tie(b.low, b.high, b.element);
  });
  return uses;
}

/// For each element a number that it shares with the element of its other side alone.
std::vector<std::uint32_t> plate_numbers(const PatchOutlines& outlines, std::size_t elements) {
  std::map<Ring, std::uint32_t> plate_with;
  std::vector<std::uint32_t> plates(elements);
  for (std::size_t e = 0; e < elements; ++e) {
    Ring sorted(outlines.ring(e).begin(), outlines.ring(e).end());
    std::sort(sorted.begin(), sorted.end());
    plates[e] = plate_with.try_emplace(std::move(sorted), static_cast<std::uint32_t>(plate_with.size())).first->second;
  }
  return plates;
}

/// Joins the corners of elements across each edge that just two plates have, where they pass smoothly.
void join_sheets(const PatchMesh& mesh, const PatchOutlines& outlines, double crease_angle, CornerClasses& classes) {
  const std::vector<EdgeUse> uses = edge_uses(outlines, mesh.patch_count());
  const std::vector<std::uint32_t> plates = plate_numbers(outlines, mesh.patch_count());
  const double least_cosine = std::cos(crease_angle);
  for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
    Ring here;
    for (last = first; last < uses.size() && uses[last].low == uses[first].low && uses[last].high == uses[first].high;
         ++last) {
      here.push_back(plates[uses[last].element]);
    }
    std::sort(here.begin(), here.end());
    here.erase(std::unique(here.begin(), here.end()), here.end());
    if (here.size() != 2) continue;
    for (std::size_t i = first; i < last; ++i) {
      for (std::size_t k = i + 1; k < last; ++k) {
        const EdgeUse &a = uses[i], &b = uses[k];
        if (a.forwards == b.forwards || plates[a.element] == plates[b.element]) continue;
        if (dot(mesh.normals[a.element], mesh.normals[b.element]) < least_cosine) continue;
        classes.join(a.low_corner, b.low_corner);
        classes.join(a.high_corner, b.high_corner);
      }
    }
  }
}

double angle_between(const Vec3d& a, const Vec3d& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

/// An element's part in the value of a vertex.
struct Share {
  std::uint32_t element;
  double weight;
};

/// Scales the weights so that what is linear in the plane about `normal` has its value at `vertex` reproduced: the
/// weighted least-squares fit of a plane, taken there. Left as they are where elements lie to one side only.
void reproduce_linear(const PatchMesh& mesh, const Vec3d& vertex, const Vec3d& normal, std::span<Share> shares) {
  const Frame frame(normal);
  double xx = 0, xy = 0, yy = 0, x = 0, y = 0;
  const auto offset = [&](const Share& s) {
    const Vec3d d = mesh.centroids[s.element] - vertex;
    return Vec2d(dot(d, frame.tangent), dot(d, frame.bitangent));
  };
  for (const Share& s : shares) {
    const Vec2d d = offset(s);
    xx += s.weight * d.x * d.x;
    xy += s.weight * d.x * d.y;
    yy += s.weight * d.y * d.y;
    x += s.weight * d.x;
    y += s.weight * d.y;
  }
  const double det = xx * yy - xy * xy;
  if (!(det > 1e-9 * (xx + yy) * (xx + yy))) return;
  const Vec2d slope((xy * y - yy * x) / det, (xy * x - xx * y) / det);
  double sum = 0;
  for (const Share& s : shares) {
    const double factor = 1 + dot(slope, offset(s));
    if (factor < 0.05) return;
    sum += s.weight * factor;
  }
  for (Share& s : shares) s.weight *= (1 + dot(slope, offset(s))) / sum;
}

class ShadingMeshBuilder {
 public:
  ShadingMeshBuilder(const PatchMesh& mesh, const ShadingMeshOptions& options)
      : mesh_(mesh), outlines_(mesh, options.weld_tolerance * mesh_size(mesh)), classes_(outlines_.corner_count()) {
    join_sheets(mesh, outlines_, options.crease_angle, classes_);
  }

  ShadingMesh build() {
    number_vertices();
    add_shares();
    for (std::uint32_t e = 0; e < mesh_.patch_count(); ++e) add_triangles(e);
    return std::move(out_);
  }

 private:
  void number_vertices() {
    constexpr std::uint32_t none = 0xffffffffU;
    vertex_of_corner_.assign(outlines_.corner_count(), none);
    for (std::uint32_t e = 0; e < mesh_.patch_count(); ++e) {
      const auto ring = outlines_.ring(e);
      for (std::uint32_t k = 0; k < ring.size(); ++k) {
        const std::uint32_t corner = outlines_.first_corner(e) + k, root = classes_.find(corner);
        if (vertex_of_corner_[root] == none) {
          vertex_of_corner_[root] = static_cast<std::uint32_t>(out_.positions.size());
          out_.positions.push_back(outlines_.position(ring[k]));
        }
        vertex_of_corner_[corner] = vertex_of_corner_[root];
      }
    }
  }

  void add_shares() {
    std::vector<std::vector<Share>> shares(out_.positions.size());
    for (std::uint32_t e = 0; e < mesh_.patch_count(); ++e) {
      const auto ring = outlines_.ring(e);
      const std::size_t n = ring.size();
      for (std::size_t k = 0; k < n; ++k) {
        const Vec3d here = outlines_.position(ring[k]);
        const double angle = angle_between(outlines_.position(ring[(k + 1) % n]) - here,
                                           outlines_.position(ring[(k + n - 1) % n]) - here);
        shares[vertex_of_corner_[outlines_.first_corner(e) + k]].push_back({e, std::max(angle, 1e-6)});
      }
    }
    for (std::size_t v = 0; v < shares.size(); ++v) {
      double sum = 0;
      Vec3d normal(0);
      for (const Share& s : shares[v]) {
        sum += s.weight;
        normal += s.weight * mesh_.normals[s.element];
      }
      for (Share& s : shares[v]) s.weight /= sum;
      out_.normals.push_back(normalize(normal));
      reproduce_linear(mesh_, out_.positions[v], out_.normals.back(), shares[v]);
      append(shares[v]);
    }
  }

  void append(std::span<const Share> shares) {
    for (const Share& s : shares) {
      out_.elements.push_back(s.element);
      out_.weights.push_back(s.weight);
    }
    out_.offsets.push_back(static_cast<std::uint32_t>(out_.elements.size()));
  }

  void add_triangles(std::uint32_t e) {
    const auto n = static_cast<std::uint32_t>(outlines_.ring(e).size());
    const auto vertex = [&](std::uint32_t k) { return vertex_of_corner_[outlines_.first_corner(e) + k % n]; };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      out_.triangles.push_back({a, b, c});
      out_.element_of_triangle.push_back(e);
    };
    if (n < 3) return;
    if (n == 3) {
      add(vertex(0), vertex(1), vertex(2));
      return;
    }
    if (n == 4 && mesh_.patch_corners(e).size() == 4) {
      // Along the shorter diagonal.
      const auto across = [&](std::uint32_t k) {
        return length_squared(out_.positions[vertex(k)] - out_.positions[vertex(k + 2)]);
      };
      const std::uint32_t k = across(1) < across(0) * (1 - 1e-9) ? 1 : 0;
      add(vertex(k), vertex(k + 1), vertex(k + 2));
      add(vertex(k), vertex(k + 2), vertex(k + 3));
      return;
    }
    const auto centre = static_cast<std::uint32_t>(out_.positions.size());
    out_.positions.push_back(mesh_.centroids[e]);
    out_.normals.push_back(mesh_.normals[e]);
    append(std::array{Share{e, 1}});
    for (std::uint32_t k = 0; k < n; ++k) add(centre, vertex(k), vertex(k + 1));
  }

  const PatchMesh& mesh_;
  PatchOutlines outlines_;
  CornerClasses classes_;
  std::vector<std::uint32_t> vertex_of_corner_;
  ShadingMesh out_;
};

}  // namespace

std::vector<double> ShadingMesh::at_vertices(std::span<const double> of_elements, std::size_t bands) const {
  std::vector<double> values(vertex_count() * bands, 0);
  for (std::size_t v = 0; v < vertex_count(); ++v) {
    for (std::uint32_t k = offsets[v]; k < offsets[v + 1]; ++k) {
      for (std::size_t b = 0; b < bands; ++b) {
        values[v * bands + b] += weights[k] * of_elements[elements[k] * bands + b];
      }
    }
  }
  return values;
}

ShadingMesh make_shading_mesh(const PatchMesh& elements, const ShadingMeshOptions& options) {
  return ShadingMeshBuilder(elements, options).build();
}

}  // namespace penumbra
