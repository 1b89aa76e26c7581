#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/baking/straight_light.h"
#include "penumbra/baking/texel_paint.h"
#include "penumbra/parallel/progress.h"

namespace penumbra {

/// The diffuse light of a scene on the cells of its atlas: radiosity by rays that are traced once.
///
/// A cell is a texel, or 2 x 2, 4 x 4 ... texels of a chart where there are too many. Each looks over its hemisphere
/// by the same number of rays and keeps which cell each meets; then light is passed along them until nothing changes.
/// Backs that rays meet have cells too, found as the rays find them, black where backs are. Cells that meet nothing but
/// backs that no light comes to lie inside solid matter: they are dark, and the backs around them stay out.
class LightCells {
 public:
  struct Options {
    std::uint32_t rays = 64;          ///< a cell
    std::size_t most_cells = 400000;  ///< fronts
    bool front_sides_only = false;
    std::uint64_t seed = 0;
  };

  /// @param order texels_in_blocks(). @param direct straight light of each texel, [texel * 3 + band], W/m^2. All but
  /// `direct` must outlive this.
  LightCells(const TexelRays& rays, const AtlasSpace& space, const StraightLight& straight,
             std::span<const std::uint32_t> order, std::span<const float> direct, const Options& options,
             const Progress& progress);

  /// Passes light on until it changes by less than a ten-thousandth.
  void solve(const Progress& progress);

  /// After each pass, the light that changed as a share of all light.
  [[nodiscard]] std::span<const double> residuals() const { return residuals_; }
  /// The light that was still to come when solve() ended, estimated, as a share of all light.
  [[nodiscard]] double unshot_fraction() const { return unshot_fraction_; }

  /// What leaves the side of a texel that a ray landed on, W/m^2; black where no light was sought.
  [[nodiscard]] const Vec4f& radiosity(std::uint32_t side) const {
    return radiosity_[slot((side & 1U) + 2 * cell_of_texel_[side / 2])];
  }
  [[nodiscard]] bool is_buried(std::uint32_t texel) const { return buried_[cell_of_texel_[texel]] != 0; }
  /// Mean irradiance of the cell that a texel is in, W/m^2.
  [[nodiscard]] Rgb irradiance(std::uint32_t texel) const { return Rgb(irradiance_[cell_of_texel_[texel]]); }
  [[nodiscard]] std::size_t cell_count() const { return back_of_cell_.size(); }

  /// A side of a cell on which light was sought.
  struct Side {
    std::span<const std::uint32_t> texels;
    bool back = false;
    Rgb albedo{0.0F}, emission{0.0F}, irradiance{0.0F};  ///< W/m^2; emission without that of straight lamps
    float matt = 1;  ///< the share of the surface that passes no light on by mirror, metal or glass
    float sky = 0;   ///< the part of the irradiance that comes from the environment, summed over bands
  };
  [[nodiscard]] std::size_t side_count() const { return rows(); }
  [[nodiscard]] Side side(std::size_t number) const;
  [[nodiscard]] std::size_t rays_traced() const { return rays_traced_; }
  [[nodiscard]] bool is_partial() const { return partial_; }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  struct Weighted {
    std::uint32_t row, side;
    Rgb weight;
  };

  void divide(std::size_t most_cells);
  void paint(std::span<const float> direct);
  void trace(std::size_t first_row);
  void find_backs(const Progress& progress);
  void spread_light(std::vector<std::uint8_t>& sees_light) const;
  void add_backs(const std::vector<std::uint8_t>& sees_light);
  void light_backs(std::size_t first_row);
  void find_buried();
  [[nodiscard]] Vec4f gathered(std::size_t row) const;
  /// Where in the arrays a side of a cell (twice its number, plus 1 for the back) stands; the last slot is black.
  [[nodiscard]] std::uint32_t slot(std::uint32_t side) const {
    if ((side & 1U) == 0) return side / 2;
    const std::uint32_t back = back_of_cell_[side / 2];
    return back == none ? black_slot_ : back;
  }
  [[nodiscard]] std::span<const std::uint32_t> texels_of(std::uint32_t cell) const {
    return order_.subspan(first_of_cell_[cell], first_of_cell_[cell + 1] - first_of_cell_[cell]);
  }
  [[nodiscard]] std::size_t rows() const { return cell_of_row_.size(); }

  const TexelRays& rays_;
  const AtlasSpace& space_;
  const SamplePoints& points_;
  const StraightLight& straight_;
  std::span<const std::uint32_t> order_;
  Options options_;
  std::vector<std::uint32_t> first_of_cell_;  // into order_
  std::vector<std::uint32_t> cell_of_texel_;
  std::vector<std::uint32_t> back_of_cell_;  // row
  std::vector<std::uint32_t> cell_of_row_;   // fronts, then backs
  std::uint32_t black_slot_ = 0;
  std::vector<std::uint8_t> lit_;                         // by cell: straight light or emission
  std::vector<std::uint8_t> buried_;                      // by cell
  std::vector<float> back_share_;                         // by cell: of its rays
  std::vector<Vec4f> albedo_, emission_, back_emission_;  // by cell; the albedo's w is the matt share
  std::vector<Vec4f> received_;                           // by row: straight light and what rays picked up
  std::vector<float> sky_;                                // by row: of that, from the environment, over all bands
  std::vector<std::uint32_t> landed_;                     // by row and ray: side of a cell, then slot
  std::vector<Weighted> weighted_;                        // by row
  std::vector<std::uint32_t> first_weighted_;             // of each row
  std::vector<Vec4f> radiosity_, irradiance_;             // by slot
  std::vector<double> residuals_;
  double unshot_fraction_ = 0;
  std::size_t rays_traced_ = 0;
  bool partial_ = false;
};

}  // namespace penumbra
