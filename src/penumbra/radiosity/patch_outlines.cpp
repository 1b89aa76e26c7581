#include "penumbra/radiosity/patch_outlines.h"

#include <algorithm>

namespace penumbra {

PatchOutlines::PatchOutlines(const PatchMesh& mesh, double tolerance)
    : mesh_(mesh), welded_(weld_points(mesh.vertices, tolerance)) {
  const PointTree tree(mesh.vertices);
  for (std::size_t p = 0; p < mesh.patch_count(); ++p) {
    const auto corners = mesh.patch_corners(p);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t a = welded_[corners[k]], b = welded_[corners[(k + 1) % corners.size()]];
      if (a == b) continue;
      ring_.push_back(a);
      insert_between(tree, a, b, tolerance);
    }
    offsets_.push_back(static_cast<std::uint32_t>(ring_.size()));
  }
}

void PatchOutlines::insert_between(const PointTree& tree, std::uint32_t a, std::uint32_t b, double tolerance) {
  found_.clear();
  tree.on_segment(position(a), position(b), tolerance, found_);
  for (std::uint32_t& v : found_) v = welded_[v];
  const Vec3d along = position(b) - position(a);
  std::sort(found_.begin(), found_.end(), [&](std::uint32_t v, std::uint32_t w) {
    const double tv = dot(position(v), along), tw = dot(position(w), along);
    return tv != tw ? tv < tw : v < w;
  });
  found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
  for (const std::uint32_t v : found_) {
    if (v != a && v != b) ring_.push_back(v);
  }
}

}  // namespace penumbra
