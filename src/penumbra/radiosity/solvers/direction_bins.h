#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// A hemisphere about +z cut into bins of equal projected solid angle pi / size() (sr): rings of equal sin^2 of the
/// polar angle, sectors of equal azimuth. A mirror maps each bin exactly onto the one across.
class DirectionBins {
 public:
  /// @param polar rings, 1 or more. @param azimuth sectors, even, 2 or more. Throws std::invalid_argument otherwise.
  DirectionBins(int polar, int azimuth);

  [[nodiscard]] std::size_t size() const { return polar_ * azimuth_; }
  /// Integral of the cosine over one bin, sr.
  [[nodiscard]] double projected_solid_angle() const { return std::numbers::pi / static_cast<double>(size()); }
  /// The bin of a local direction with z >= 0.
  [[nodiscard]] std::size_t index(const Vec3d& local) const;
  /// A unit direction in a bin; uniform (u, v) in [0, 1)^2 give directions of density cos / projected_solid_angle().
  [[nodiscard]] Vec3d direction(std::size_t bin, double u, double v) const;
  /// The bin into which a mirror in the plane z = 0 sends light that comes from directions of `bin`.
  [[nodiscard]] std::size_t mirrored(std::size_t bin) const;

 private:
  std::size_t polar_, azimuth_;
};

/// How light arriving in one bin is spread over the leaving ones by a glossy lobe cos^exponent about the mirror
/// direction (Phong 1975), [leaving * size + arriving], made symmetric and with rows and columns that sum to 1: it is
/// reciprocal and neither makes nor loses light. @param exponent 0 or more.
[[nodiscard]] std::vector<double> glossy_lobe(const DirectionBins& bins, double exponent);

}  // namespace penumbra
