#include "penumbra/radiosity/form_factors/convex_bodies.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace penumbra {
namespace {

constexpr std::uint32_t several = 0xfffffffeU;
constexpr std::size_t most_tests = 4'000'000;  // corners times planes of one body

std::uint64_t edge_key(std::uint32_t from, std::uint32_t to) { return (std::uint64_t{from} << 32) | to; }

/// The patch that has each directed edge, or `several`.
std::unordered_map<std::uint64_t, std::uint32_t> directed_edges(const PatchMesh& mesh, const PatchOutlines& outlines) {
  std::unordered_map<std::uint64_t, std::uint32_t> edges;
  edges.reserve(4 * mesh.patch_count());
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    const auto ring = outlines.ring(p);
    for (std::size_t c = 0; c < ring.size(); ++c) {
      const auto [at, fresh] = edges.emplace(edge_key(ring[c], ring[(c + 1) % ring.size()]), p);
      if (!fresh) at->second = several;
    }
  }
  return edges;
}

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

struct Candidate {
  std::vector<std::uint32_t> patches;
  bool closed = true;
};

/// The distinct planes of a candidate when all its corners are behind all of them; empty otherwise.
std::vector<Plane3> convex_planes(const PatchMesh& mesh, const Candidate& candidate, double tolerance) {
  std::vector<Plane3> planes;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t p : candidate.patches) {
    const Plane3 plane{mesh.normals[p], dot(mesh.normals[p], mesh.centroids[p])};
    const bool known = std::any_of(planes.begin(), planes.end(), [&](const Plane3& q) {
      return length_squared(q.normal - plane.normal) < 1e-18 && std::abs(q.offset - plane.offset) <= tolerance;
    });
    if (!known) planes.push_back(plane);
    const auto ring = mesh.patch_corners(p);
    corners.insert(corners.end(), ring.begin(), ring.end());
    if (planes.size() * candidate.patches.size() > most_tests) return {};
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  double deepest = 0;
  for (const Plane3& plane : planes) {
    for (std::uint32_t v : corners) {
      const double d = plane.distance(mesh.vertices[v]);
      if (d > tolerance) return {};
      deepest = std::min(deepest, d);
    }
  }
  return deepest < -tolerance ? planes : std::vector<Plane3>{};  // not a plate, which has no inside
}

}  // namespace

ConvexBodies find_convex_bodies(const PatchMesh& mesh, const PatchOutlines& outlines,
                                std::span<const Plane3> hull_planes, double tolerance) {
  const auto edges = directed_edges(mesh, outlines);
  const auto twin_of = [&](std::uint32_t p, std::uint32_t from, std::uint32_t to) {
    const auto own = edges.find(edge_key(from, to)), twin = edges.find(edge_key(to, from));
    if (own->second != p || twin == edges.end()) return several;
    return twin->second;
  };
  std::vector<std::uint32_t> parent(mesh.patch_count());
  std::iota(parent.begin(), parent.end(), 0U);
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    const Plane3 plane{mesh.normals[p], dot(mesh.normals[p], mesh.centroids[p])};
    const auto ring = outlines.ring(p);
    for (std::size_t c = 0; c < ring.size(); ++c) {
      const std::uint32_t q = twin_of(p, ring[c], ring[(c + 1) % ring.size()]);
      if (q >= p || plane.distance(mesh.centroids[q]) > tolerance) continue;
      parent[find_root(parent, p)] = find_root(parent, q);
    }
  }
  std::unordered_map<std::uint32_t, std::size_t> number;
  std::vector<Candidate> candidates;
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    const auto [at, fresh] = number.emplace(find_root(parent, p), candidates.size());
    if (fresh) candidates.emplace_back();
    candidates[at->second].patches.push_back(p);
  }
  const auto on_hull = [&](std::uint32_t a, std::uint32_t b) {
    return std::any_of(hull_planes.begin(), hull_planes.end(), [&](const Plane3& plane) {
      return std::abs(plane.distance(mesh.vertices[a])) <= tolerance &&
             std::abs(plane.distance(mesh.vertices[b])) <= tolerance;
    });
  };
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    Candidate& own = candidates[number[find_root(parent, p)]];
    const auto ring = outlines.ring(p);
    for (std::size_t c = 0; c < ring.size() && own.closed; ++c) {
      const std::uint32_t a = ring[c], b = ring[(c + 1) % ring.size()];
      const std::uint32_t q = twin_of(p, a, b);
      const bool inner = q != several && find_root(parent, q) == find_root(parent, p);
      own.closed = inner || on_hull(a, b);
    }
  }
  ConvexBodies bodies;
  bodies.body_of.assign(mesh.patch_count(), ConvexBodies::no_body);
  for (const Candidate& candidate : candidates) {
    if (!candidate.closed) continue;
    const auto planes = convex_planes(mesh, candidate, tolerance);
    if (planes.size() < 3) continue;
    for (std::uint32_t p : candidate.patches) bodies.body_of[p] = static_cast<std::uint32_t>(bodies.size());
    bodies.planes.insert(bodies.planes.end(), planes.begin(), planes.end());
    bodies.plane_offsets.push_back(static_cast<std::uint32_t>(bodies.planes.size()));
  }
  return bodies;
}

}  // namespace penumbra
