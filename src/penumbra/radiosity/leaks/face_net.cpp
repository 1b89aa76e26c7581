#include "penumbra/radiosity/leaks/face_net.h"

#include <algorithm>
#include <functional>
#include <unordered_map>
#include <utility>

#include "penumbra/math/polygon.h"
#include "penumbra/math/transform.h"

namespace penumbra {
namespace {

struct PositionHash {
  std::size_t operator()(const Vec3d& p) const {
    std::size_t h = 0;
    for (int k = 0; k < 3; ++k) h = h * 0x9e3779b97f4a7c15ULL + std::hash<double>{}(p[k]);
    return h ^ h >> 29U;
  }
};

/// Numbers for positions; equal positions have one number.
class Welder {
 public:
  explicit Welder(std::vector<Vec3d>& vertices) : vertices_(vertices) {}
  std::uint32_t number(const Vec3d& p) {
    const Vec3d q = p + Vec3d(0.0);  // -0 and 0 are one place
    const auto [found, fresh] = numbers_.try_emplace(q, static_cast<std::uint32_t>(vertices_.size()));
    if (fresh) vertices_.push_back(q);
    return found->second;
  }

 private:
  std::vector<Vec3d>& vertices_;
  std::unordered_map<Vec3d, std::uint32_t, PositionHash> numbers_;
};

void remove_repeated(std::vector<std::uint32_t>& ring) {
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
}

void add_instance(const Scene& scene, std::uint32_t object, Welder& welder, FaceNet& net) {
  const Instance& instance = scene.instances[object];
  const Mesh& mesh = scene.meshes[instance.mesh];
  const bool mirrored = is_mirroring(instance.to_world);
  std::vector<std::uint32_t> number;
  number.reserve(mesh.positions.size());
  for (const Vec3d& p : mesh.positions) number.push_back(welder.number(transform_point(instance.to_world, p)));
  const auto first_face = static_cast<std::uint32_t>(net.rings.size());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    std::vector<std::uint32_t> ring;
    for (const std::uint32_t v : mesh.face(f)) ring.push_back(number[v]);
    if (mirrored) std::reverse(ring.begin(), ring.end());
    remove_repeated(ring);
    net.rings.push_back(std::move(ring));
    net.object_of.push_back(object);
    net.number_in_object.push_back(f);
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Mesh::Triangle& corners = mesh.triangles[t];
    net.triangles.push_back({number[corners[0]], number[corners[1]], number[corners[2]]});
    net.face_of_triangle.push_back(first_face + (mesh.face_offsets.empty() ? t : mesh.face_of_triangle[t]));
  }
}

void find_edges(FaceNet& net) {
  std::unordered_map<std::uint64_t, std::uint32_t> edge_of;
  for (std::uint32_t f = 0; f < net.rings.size(); ++f) {
    const std::vector<std::uint32_t>& ring = net.rings[f];
    if (ring.size() < 3) continue;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const std::uint32_t a = ring[k], b = ring[(k + 1) % ring.size()];
      const std::uint64_t key = std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
      const auto [found, fresh] = edge_of.try_emplace(key, static_cast<std::uint32_t>(net.edges.size()));
      if (fresh) net.edges.push_back({a, b, {}, {}});
      FaceNet::Edge& edge = net.edges[found->second];
      edge.faces.push_back(f);
      edge.along.push_back(edge.from == a);
    }
  }
}

}  // namespace

std::vector<Vec3d> FaceNet::polygon(std::uint32_t face) const {
  std::vector<Vec3d> corners;
  for (const std::uint32_t v : rings[face]) corners.push_back(vertices[v]);
  return corners;
}

FaceNet make_face_net(const Scene& scene) {
  FaceNet net;
  Welder welder(net.vertices);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) add_instance(scene, i, welder, net);
  for (std::uint32_t f = 0; f < net.rings.size(); ++f) {
    const std::vector<Vec3d> corners = net.polygon(f);
    net.normals.push_back(corners.size() < 3 ? Vec3d(0) : polygon_normal(corners));
  }
  find_edges(net);
  return net;
}

}  // namespace penumbra
