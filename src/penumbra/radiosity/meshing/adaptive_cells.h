#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// A cell of a patch and what interpolating irradiance between its corners misses.
struct AdaptiveCell {
  std::uint32_t plate = 0;
  std::vector<Vec3d> corners;  ///< oriented as the plate's front
  std::uint32_t origin = 0;    ///< the cell that it was cut from since the last mark()
  double error = 0;            ///< W/m^2, largest over middle and edges
  double brightest = 0;        ///< W/m^2
  std::size_t worst_edge = 0;  ///< whose middle departs most, or the longest where none does
  bool can_split = true;
};

/// Patches cut into cells where their irradiance from lamps demands it; front and back of a plate are cut alike.
///
/// A cell is judged by the irradiance (exact, LampIrradiance) in its middle and those of its edges against what its
/// corners' interpolate to, and halved in the direction that departs most; cells that are long for their width across
/// their length. Errors count in full where a cell is no brighter than the standard (at first the brightest point met),
/// and in proportion where it is. The same cells on any number of threads.
class AdaptiveCells {
 public:
  /// A front and, where both sides count, its back: patches.
  struct Plate {
    std::uint32_t front = 0;
    std::uint32_t back = none;
  };
  static constexpr std::uint32_t none = 0xffffffffU;

  /// @param patches where the patches of a back follow those of its front, in their order; must outlive this.
  /// @param least_size shortest edge allowed, m. @param contrast cells whose error is within this share of the
  /// standard are not split.
  AdaptiveCells(const PatchMesh& patches, double least_size, double contrast);

  [[nodiscard]] const std::vector<Plate>& plates() const { return plates_; }
  [[nodiscard]] std::uint32_t plate_of(std::uint32_t patch) const { return plate_of_[patch]; }
  [[nodiscard]] const std::vector<AdaptiveCell>& cells() const { return cells_; }
  [[nodiscard]] double least_size() const { return least_size_; }

  void add(std::uint32_t plate, std::vector<Vec3d> corners);

  /// Makes each cell its own origin, and forgets all errors.
  void mark();
  /// Light of this strength exists somewhere, W/m^2.
  void note_brightness(double irradiance);
  /// The standard is no more than this, W/m^2.
  void limit_standard(double irradiance) { most_standard_ = irradiance; }
  [[nodiscard]] double standard() const { return std::min(brightest_, most_standard_); }
  /// Looks at the irradiance of some cells.
  void measure(const LampIrradiance& light, std::span<const std::uint32_t> which);
  /// Looks at the irradiance of all cells.
  void measure(const LampIrradiance& light);

  /// Splits measured cells, worst first (square of the error times area), until there are `most` or none asks for it.
  /// Returns false when asked to stop.
  bool refine(const LampIrradiance& light, std::size_t most, const Progress& progress = {});
  /// Splits the largest cells until there are `most`.
  void split_largest(std::size_t most);

  /// The elements, each one patch and one surface in the order of the patches, with their patches' reflectance.
  struct Elements {
    PatchMesh mesh;
    std::vector<std::uint32_t> parent, cell;  ///< of each element: its patch and its cell
  };
  [[nodiscard]] Elements elements() const;

 private:
  void measure(AdaptiveCell& cell, const LampIrradiance& light) const;
  void choose_longest_edge(AdaptiveCell& cell) const;
  [[nodiscard]] double promise(const AdaptiveCell& cell) const;
  bool split(std::uint32_t cell);

  const PatchMesh& patches_;
  std::vector<Plate> plates_;
  std::vector<std::uint32_t> plate_of_;
  std::vector<AdaptiveCell> cells_;
  double brightest_ = 0;
  double most_standard_ = std::numeric_limits<double>::infinity();
  double least_size_ = 0;
  double contrast_ = 0;
};

}  // namespace penumbra
