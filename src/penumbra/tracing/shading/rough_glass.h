#pragma once

#include <array>

namespace penumbra {

/// The light that leaves no microfacet of a rough dielectric surface at its first meeting with one, and how it comes
/// out after all: the model of Kulla & Conty ("Revisiting Physically Based Shading at Imageworks", SIGGRAPH 2017
/// course) for interfaces, with shares that keep Helmholtz reciprocity across the interface.
///
/// Of light that leaves towards (or arrives from) a direction, the share lost(side, cos) is missing in the lobes of
/// Walter et al. 2007 with Smith's shadowing. It is given back as two matt lobes: the share reflected(side) of it on
/// the same side in proportion to lost() there, the rest on the other side in proportion to lost() there.
class RoughGlass {
 public:
  /// How many values describe one side.
  static constexpr int nodes = 20;

  /// Nothing is lost.
  RoughGlass() = default;
  /// @param roughness glTF's, 0..1; GGX width is its square, at least 0.001. @param ior of the inside, taken as at most
  /// 3; the outside has 1.
  RoughGlass(double roughness, double ior);

  /// 0..1. @param outside on which side the direction lies. @param cos_theta 0..1. Interpolated in a table; absolute
  /// error about 7e-4, below 1e-2 next to index 1.
  [[nodiscard]] double lost(bool outside, double cos_theta) const;
  /// Its mean over the hemisphere by projected solid angle, the exact integral of what is interpolated.
  [[nodiscard]] double mean_lost(bool outside) const { return sides_[outside ? 0 : 1].mean; }
  /// Share of what is given back that stays on the side, 0..1.
  [[nodiscard]] double reflected(bool outside) const { return sides_[outside ? 0 : 1].reflected; }

 private:
  struct Side {
    std::array<float, nodes> lost{};  // at the nodes of the cosine's coordinate
    double mean = 0;
    double reflected = 1;
  };
  double alpha_ = 1;
  std::array<Side, 2> sides_{};
};

}  // namespace penumbra
