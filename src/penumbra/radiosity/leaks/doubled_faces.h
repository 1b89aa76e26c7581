#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/radiosity/leaks/face_net.h"
#include "penumbra/radiosity/leaks/triangle_tree.h"

namespace penumbra {

/// Two faces that lie in one plane over each other and look the same way.
struct DoubledFaces {
  std::uint32_t first = 0, second = 0;  ///< faces
  bool equal = false;                   ///< the same corners
  Vec3d place{0};                       ///< the middle of what they share, m
  double area = 0;                      ///< of what they share, m^2
};

/// In ascending order. A face and its reversed twin are a plate with two sides, not doubled.
/// @param touching planes this near are one, m.
[[nodiscard]] std::vector<DoubledFaces> find_doubled_faces(const FaceNet& net, const TriangleTree& tree,
                                                           double touching);

}  // namespace penumbra
