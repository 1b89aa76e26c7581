#include "penumbra/radiosity/form_factors/occluder_polygons.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

#include "penumbra/math/polygon_pieces.h"
#include "penumbra/math/rng.h"
#include "penumbra/radiosity/patch_outlines.h"

namespace penumbra {
namespace {

using Ring = std::vector<std::uint32_t>;  // into PatchMesh::vertices

constexpr double relative_motion = 1e-8;     // of an occluder's size
constexpr double coplanar_tolerance = 1e-9;  // of the mesh's size
constexpr std::size_t most_hull_planes = 16;

std::uint64_t edge_key(std::uint32_t from, std::uint32_t to) { return (std::uint64_t{from} << 32) | to; }

std::vector<Vec3d> positions_of(const PatchMesh& mesh, const Ring& ring) {
  std::vector<Vec3d> polygon;
  for (std::uint32_t v : ring) polygon.push_back(mesh.vertices[v]);
  return polygon;
}

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

/// Groups of patches that are joined edge to edge, back on front, in one oriented plane.
std::vector<std::vector<std::uint32_t>> coplanar_regions(const PatchMesh& mesh, const PatchOutlines& outlines,
                                                         double tolerance) {
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> patches_at;
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    const auto ring = outlines.ring(p);
    for (std::size_t c = 0; c < ring.size(); ++c)
      patches_at[edge_key(ring[c], ring[(c + 1) % ring.size()])].push_back(p);
  }
  std::vector<std::uint32_t> parent(mesh.patch_count());
  std::iota(parent.begin(), parent.end(), 0U);
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    const auto ring = outlines.ring(p);
    for (std::size_t c = 0; c < ring.size(); ++c) {
      const auto twin = patches_at.find(edge_key(ring[(c + 1) % ring.size()], ring[c]));
      if (twin == patches_at.end()) continue;
      for (std::uint32_t q : twin->second) {
        if (q >= p) continue;
        const std::uint32_t root = find_root(parent, q);  // judged against the region's first patch, so that
        const Plane3 plane{mesh.normals[root], dot(mesh.normals[root], mesh.centroids[root])};  // curves do not creep
        if (dot(mesh.normals[p], plane.normal) < 0.999999) continue;
        const auto polygon = mesh.polygon(p);
        if (std::all_of(polygon.begin(), polygon.end(),
                        [&](const Vec3d& v) { return std::abs(plane.distance(v)) <= tolerance; })) {
          const std::uint32_t own = find_root(parent, p);
          if (own == p || own == root)
            parent[std::max(own, root)] = std::min(own, root);
          else {  // p already joined another region: join them when that region's first patch is coplanar too
            const auto first = mesh.polygon(own);
            if (std::all_of(first.begin(), first.end(),
                            [&](const Vec3d& v) { return std::abs(plane.distance(v)) <= tolerance; }))
              parent[std::max(own, root)] = std::min(own, root);
          }
        }
      }
    }
  }
  std::vector<std::vector<std::uint32_t>> regions;
  std::vector<std::uint32_t> region_of(mesh.patch_count(), 0xFFFFFFFFU);
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    const std::uint32_t root = find_root(parent, p);
    if (region_of[root] == 0xFFFFFFFFU) {
      region_of[root] = static_cast<std::uint32_t>(regions.size());
      regions.emplace_back();
    }
    regions[region_of[root]].push_back(p);
  }
  return regions;
}

/// The outline of a region when it is a single loop without a corner passed twice; empty otherwise.
Ring single_outline(const PatchOutlines& outlines, const std::vector<std::uint32_t>& region) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::uint32_t p : region) {
    const auto ring = outlines.ring(p);
    for (std::size_t c = 0; c < ring.size(); ++c) {
      const std::uint32_t a = ring[c], b = ring[(c + 1) % ring.size()];
      const auto twin = edges.find({b, a});
      if (twin != edges.end()) {
        edges.erase(twin);
      } else if (!edges.emplace(std::pair{a, b}, 1).second) {
        return {};
      }
    }
  }
  std::unordered_map<std::uint32_t, std::uint32_t> next;
  for (const auto& [edge, count] : edges)
    if (!next.emplace(edge.first, edge.second).second) return {};
  if (next.empty()) return {};
  Ring outline;
  const std::uint32_t start = edges.begin()->first.first;
  for (std::uint32_t v = start;;) {
    outline.push_back(v);
    const auto found = next.find(v);
    if (found == next.end()) return {};
    v = found->second;
    if (v == start) break;
    if (outline.size() > next.size()) return {};
  }
  return outline.size() == next.size() ? outline : Ring{};
}

/// Without the corners that lie on the straight line between their neighbours.
Ring without_straight_corners(const PatchMesh& mesh, Ring ring) {
  for (std::size_t c = 0; c < ring.size() && ring.size() > 3;) {
    const Vec3d& before = mesh.vertices[ring[(c + ring.size() - 1) % ring.size()]];
    const Vec3d& here = mesh.vertices[ring[c]];
    const Vec3d& after = mesh.vertices[ring[(c + 1) % ring.size()]];
    const Vec3d a = here - before, b = after - here;
    if (length(cross(a, b)) <= 1e-9 * length(a) * length(b) && dot(a, b) > 0) {
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(c));
      c = c > 0 ? c - 1 : 0;
    } else {
      ++c;
    }
  }
  return ring;
}

/// Joins two rings along the edge a-b of `left` (b-a of `right`) and drops straight corners.
Ring joined(const PatchMesh& mesh, const Ring& left, const Ring& right, std::uint32_t a, std::uint32_t b) {
  Ring out;
  const auto rotate_to = [](const Ring& ring, std::uint32_t first) {
    Ring r = ring;
    std::rotate(r.begin(), std::find(r.begin(), r.end(), first), r.end());
    return r;
  };
  const Ring l = rotate_to(left, b);   // b ... a
  const Ring r = rotate_to(right, a);  // a ... b
  out.assign(l.begin(), l.end());
  out.insert(out.end(), r.begin() + 1, r.end() - 1);
  return without_straight_corners(mesh, out);
}

/// Joins neighbours of a region across whole shared edges as long as the result is convex: for regions with holes.
std::vector<Ring> greedily_joined(const PatchMesh& mesh, const std::vector<std::uint32_t>& region) {
  std::vector<Ring> rings;
  for (std::uint32_t p : region) {
    const auto ring = mesh.patch_corners(p);
    rings.push_back(without_straight_corners(mesh, Ring(ring.begin(), ring.end())));
  }
  for (bool changed = true; changed;) {
    changed = false;
    std::unordered_map<std::uint64_t, std::size_t> ring_at;
    for (std::size_t k = 0; k < rings.size(); ++k)
      for (std::size_t c = 0; c < rings[k].size(); ++c)
        ring_at[edge_key(rings[k][c], rings[k][(c + 1) % rings[k].size()])] = k;
    std::vector<bool> touched(rings.size(), false);
    for (std::size_t k = 0; k < rings.size(); ++k) {
      for (std::size_t c = 0; c < rings[k].size() && !touched[k]; ++c) {
        const std::uint32_t a = rings[k][c], b = rings[k][(c + 1) % rings[k].size()];
        const auto twin = ring_at.find(edge_key(b, a));
        if (twin == ring_at.end() || twin->second == k || touched[twin->second]) continue;
        Ring both = joined(mesh, rings[k], rings[twin->second], a, b);
        if (!is_convex(positions_of(mesh, both))) continue;
        touched[k] = touched[twin->second] = true;
        rings[k] = std::move(both);
        rings[twin->second].clear();
        changed = true;
      }
    }
    std::erase_if(rings, [](const Ring& r) { return r.empty(); });
  }
  return rings;
}

std::vector<Ring> convex_rings(const PatchMesh& mesh, const PatchOutlines& outlines,
                               const std::vector<std::uint32_t>& region) {
  if (region.size() > 1) {
    const Ring outline = without_straight_corners(mesh, single_outline(outlines, region));
    if (outline.size() >= 3) {
      std::vector<Ring> rings;
      for (const auto& piece : convex_pieces(positions_of(mesh, outline))) {
        Ring& ring = rings.emplace_back();
        for (std::uint32_t c : piece) ring.push_back(outline[c]);
      }
      if (rings.size() <= region.size()) return rings;
    }
    return greedily_joined(mesh, region);
  }
  const auto ring = mesh.patch_corners(region.front());
  return {without_straight_corners(mesh, Ring(ring.begin(), ring.end()))};
}

/// Whether the whole mesh lies on one side of the plane: then no segment between patches crosses it.
bool on_convex_hull(const PatchMesh& mesh, const Plane3& plane, double tolerance) {
  bool front = false, back = false;
  for (const Vec3d& v : mesh.vertices) {
    const double d = plane.distance(v);
    front |= d > tolerance;
    back |= d < -tolerance;
    if (front && back) return false;
  }
  return true;
}

/// Rings of mesh vertices as polygons that share vertices and edges.
class OccluderBuilder {
 public:
  explicit OccluderBuilder(const PatchMesh& mesh) : mesh_(mesh) {}

  void add(const Ring& ring) { rings_.push_back(ring); }

  [[nodiscard]] OccluderPolygons finish() {
    place_vertices();
    for (std::size_t k = 0; k < rings_.size(); ++k) append(static_cast<std::uint32_t>(k));
    for (OccluderPolygons::Edge& e : out_.edges) {
      if (!e.simple || e.left == OccluderPolygons::none || e.right == OccluderPolygons::none) continue;
      const Plane3 &p = out_.planes[e.left], &q = out_.planes[e.right];
      e.flat = length_squared(p.normal - q.normal) <= 1e-18 &&
               std::abs(p.offset - q.offset) <= std::min(out_.slack[e.left], out_.slack[e.right]);
    }
    return std::move(out_);
  }

 private:
  void place_vertices() {
    std::map<std::uint32_t, double> smallest;  // per mesh vertex: the size of its smallest polygon
    for (const Ring& ring : rings_) {
      const double size = polygon_size(positions_of(mesh_, ring));
      for (std::uint32_t v : ring) {
        const auto [at, fresh] = smallest.emplace(v, size);
        if (!fresh) at->second = std::min(at->second, size);
      }
    }
    for (const auto& [v, size] : smallest) {
      vertex_of_[v] = static_cast<std::uint32_t>(out_.vertices.size());
      CounterRng random(hash_key(v, 0x0CC1UL));
      const Vec3d motion = Vec3d(random.next(), random.next(), random.next()) - 0.5;
      out_.vertices.push_back(mesh_.vertices[v] + 2 * relative_motion * size * motion);
    }
  }

  void append(std::uint32_t k) {
    const Ring& ring = rings_[k];
    const std::vector<Vec3d> still = positions_of(mesh_, ring);
    Bounds bounds;
    for (std::size_t c = 0; c < ring.size(); ++c) {
      const std::uint32_t v = vertex_of_.at(ring[c]);
      out_.corner_vertices.push_back(v);
      out_.corners.push_back(out_.vertices[v]);
      out_.corner_edges.push_back(edge(k, v, vertex_of_.at(ring[(c + 1) % ring.size()])));
      bounds.grow(out_.vertices[v]);
    }
    out_.corner_offsets.push_back(static_cast<std::uint32_t>(out_.corners.size()));
    out_.planes.push_back(polygon_plane(still));
    out_.bounds.push_back(bounds);
    out_.slack.push_back(4 * relative_motion * polygon_size(still));
  }

  std::uint32_t edge(std::uint32_t k, std::uint32_t from, std::uint32_t to) {
    const auto key = edge_key(std::min(from, to), std::max(from, to));
    const auto [at, fresh] = edge_of_.emplace(key, static_cast<std::uint32_t>(out_.edges.size()));
    if (fresh) out_.edges.push_back({std::min(from, to), std::max(from, to)});
    auto& e = out_.edges[at->second];
    std::uint32_t& side = from < to ? e.left : e.right;
    e.simple = e.simple && side == OccluderPolygons::none;
    side = k;
    return at->second;
  }

  const PatchMesh& mesh_;
  std::vector<Ring> rings_;
  std::unordered_map<std::uint32_t, std::uint32_t> vertex_of_;
  std::unordered_map<std::uint64_t, std::uint32_t> edge_of_;
  OccluderPolygons out_;
};

}  // namespace

OccluderPolygons make_occluder_polygons(const PatchMesh& mesh, bool merge) {
  Bounds all;
  for (const Vec3d& v : mesh.vertices) all.grow(v);
  const double tolerance = coplanar_tolerance * all.diagonal();

  const PatchOutlines outlines(mesh, tolerance);
  std::vector<std::vector<std::uint32_t>> regions;
  if (merge) {
    regions = coplanar_regions(mesh, outlines, tolerance);
  } else {
    for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) regions.push_back({p});
  }
  OccluderBuilder builder(mesh);
  std::map<Ring, bool> seen;
  std::vector<std::uint32_t> first_patch;  // of each occluder's region
  std::vector<Plane3> hull_planes;
  for (const auto& region : regions) {
    const std::uint32_t p = region.front();
    const Plane3 plane{mesh.normals[p], dot(mesh.normals[p], mesh.centroids[p])};
    if (on_convex_hull(mesh, plane, tolerance)) {
      const bool known = std::any_of(hull_planes.begin(), hull_planes.end(), [&](const Plane3& q) {
        return length(q.normal - plane.normal) < 1e-9 && std::abs(q.offset - plane.offset) <= tolerance;
      });
      if (!known && hull_planes.size() < most_hull_planes) hull_planes.push_back(plane);
      continue;
    }
    for (const Ring& ring : convex_rings(mesh, outlines, region)) {
      Ring key = ring;
      std::sort(key.begin(), key.end());
      if (!seen.emplace(key, true).second) continue;  // the other side of a plate
      if (!(polygon_area(positions_of(mesh, ring)) > 0)) continue;
      builder.add(ring);
      first_patch.push_back(p);
    }
  }
  OccluderPolygons out = builder.finish();
  out.bodies = find_convex_bodies(mesh, outlines, hull_planes, tolerance);
  for (std::uint32_t p : first_patch) out.body.push_back(out.bodies.body_of[p]);
  return out;
}

}  // namespace penumbra
