#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/polygon.h"
#include "penumbra/math/vec.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// The radiating patches of a mesh in groups of up to sixteen that lie close together and face alike, stored side by
/// side for vector code. Slot `cluster * lanes + lane` holds one patch; unused lanes repeat the cluster's last patch.
struct PatchClusters {
  static constexpr std::size_t lanes = 16;
  static constexpr std::size_t rule_points = 4;

  struct Cluster {
    std::uint32_t count = 0;         ///< patches, 1..lanes
    std::uint32_t corner_count = 0;  ///< the most corners of one of its patches; the others repeat their last one
    std::size_t first_corner = 0;    ///< into corners
    std::array<Vec3d, 8> box;        ///< corners of an oriented box around it
    Bounds bounds;
    Plane3 plane;       ///< of its first patch
    bool flat = false;  ///< all its patches lie in `plane`
  };

  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> patch;  ///< per slot
  std::vector<double> area, radius;  ///< per slot; radius: of the sphere around the centroid, m
  std::vector<double> skew;          ///< per slot: third moment / radius^3, 0 for symmetric patches
  std::array<std::vector<double>, 3> centroid, normal;
  std::vector<double> offset;
  /// Four points of equal weight with the patch's first and second moments: exact for quadratics, and for cubics on
  /// symmetric patches.
  std::array<std::array<std::vector<double>, 3>, rule_points> rule;
  /// Nine points and the share of the area that each stands for: the 3 x 3 Gauss rule of a quadrilateral (exact for
  /// degree 5), the conical one of a triangle (degree 4). Weights are all zero for patches with more corners.
  static constexpr std::size_t fine_points = 9;
  std::array<std::array<std::vector<double>, 4>, fine_points> fine;  ///< x, y, z, weight
  std::vector<double> corners;                                       ///< cluster by cluster: [corner][x, y, z][lane]

  [[nodiscard]] std::size_t size() const { return clusters.size(); }
  [[nodiscard]] const double* corner(const Cluster& c, std::size_t k, std::size_t axis) const {
    return corners.data() + c.first_corner + (3 * k + axis) * lanes;
  }
};

[[nodiscard]] PatchClusters make_patch_clusters(const PatchMesh& mesh);

}  // namespace penumbra
