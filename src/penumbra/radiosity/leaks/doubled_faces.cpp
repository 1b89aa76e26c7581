#include "penumbra/radiosity/leaks/doubled_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "penumbra/math/polygon.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

constexpr double least_shared = 1e-5;  // of the smaller triangle's area
constexpr std::size_t triangles_a_task = 512;

using Triangle = TriangleTree::Triangle;

Vec3d twice_area_vector(const Triangle& t) { return cross(t[1] - t[0], t[2] - t[0]); }

/// What two triangles of one plane share; empty when they do not lie in one plane or look different ways.
std::vector<Vec3d> shared_part(const Triangle& a, const Triangle& b, double touching) {
  const Vec3d na = twice_area_vector(a), nb = twice_area_vector(b);
  const double la = length(na), lb = length(nb);
  if (!(la > 0 && lb > 0) || dot(na, nb) < 0.999 * la * lb) return {};
  const Vec3d n = na / la;
  for (const Vec3d& p : b) {
    if (std::abs(dot(n, p - a[0])) > touching) return {};
  }
  for (const Vec3d& p : a) {
    if (std::abs(dot(nb / lb, p - b[0])) > touching) return {};
  }
  std::vector<Vec3d> part(b.begin(), b.end()), next;
  for (std::size_t k = 0; k < 3 && !part.empty(); ++k) {
    const Vec3d edge = a[(k + 1) % 3] - a[k];
    const Vec3d in = normalize(cross(n, edge));
    clip_polygon(part, {in, dot(in, a[k])}, 0, next);
    part.swap(next);
  }
  if (part.size() < 3 || 2 * polygon_area(part) < least_shared * std::min(la, lb)) return {};
  return part;
}

bool same_ring(std::vector<std::uint32_t> a, std::vector<std::uint32_t> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  return a == b;
}

}  // namespace

std::vector<DoubledFaces> find_doubled_faces(const FaceNet& net, const TriangleTree& tree, double touching) {
  struct Shared {
    std::uint32_t a, b;
    Vec3d place;
    double area;
  };
  const std::size_t tasks = (tree.size() + triangles_a_task - 1) / triangles_a_task;
  std::vector<std::vector<Shared>> found(tasks);
  parallel_for(tree.size(), triangles_a_task, [&](std::size_t first, std::size_t last) {
    std::vector<Shared>& mine = found[first / triangles_a_task];
    for (std::size_t t = first; t < last; ++t) {
      const Triangle& a = tree.triangle(static_cast<std::uint32_t>(t));
      Bounds box;
      for (const Vec3d& p : a) {
        box.grow(p - Vec3d(touching));
        box.grow(p + Vec3d(touching));
      }
      tree.overlapping(box, [&](std::uint32_t other) {
        const std::uint32_t f = net.face_of_triangle[t], g = net.face_of_triangle[other];
        if (other <= t || f == g) return;
        const std::vector<Vec3d> part = shared_part(a, tree.triangle(other), touching);
        if (part.empty()) return;
        mine.push_back({std::min(f, g), std::max(f, g), polygon_centroid(part), polygon_area(part)});
      });
    }
  });
  std::map<std::pair<std::uint32_t, std::uint32_t>, DoubledFaces> pairs;
  for (const auto& task : found) {
    for (const Shared& s : task) {
      DoubledFaces& d = pairs[{s.a, s.b}];
      d.first = s.a;
      d.second = s.b;
      d.place += s.area * s.place;
      d.area += s.area;
    }
  }
  std::vector<DoubledFaces> result;
  for (auto& [faces, d] : pairs) {
    d.place /= d.area;
    d.equal = same_ring(net.rings[d.first], net.rings[d.second]);
    result.push_back(d);
  }
  return result;
}

}  // namespace penumbra
