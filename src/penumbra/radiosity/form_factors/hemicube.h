#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "penumbra/math/frame.h"
#include "penumbra/math/vec.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/patch_tracer.h"

namespace penumbra {

/// Delta form factors of a hemicube (Cohen & Greenberg 1985): the share that leaves its centre through each pixel,
/// taken at the pixel's middle: dF = dA / (pi (x^2 + y^2 + 1)^2) on the top, z dA / (pi (y^2 + z^2 + 1)^2) on a side.
/// Their sum exceeds 1 by 0.54 / N^2.
struct HemicubeDeltas {
  int resolution = 0;        ///< N, pixels along the edge of the top; a side has N x N/2
  std::vector<double> top;   ///< [row * N + column], rows along y
  std::vector<double> side;  ///< [row * N + column], rows upwards from the horizon; the same for all four

  /// @param resolution even, 2 or more; throws std::invalid_argument otherwise.
  explicit HemicubeDeltas(int resolution);
};

/// How a hemicube finds out what each pixel sees.
enum class HemicubeVisibility {
  z_buffer,  ///< polygons rasterised in any order, the nearest kept by its depth
  bsp_tree,  ///< polygons rasterised from front to back in the exact order of a BSP tree (Fuchs, Kedem & Naylor 1980)
  rays,      ///< one ray through each pixel's middle
};

struct HemicubeOptions {
  int resolution = 128;  ///< pixels along the edge of the top, even, 2 to 4096
  HemicubeVisibility visibility = HemicubeVisibility::z_buffer;
  /// Turns each patch's hemicube about its normal by an angle of its own, which makes the pixels' aliasing differ from
  /// patch to patch instead of drawing the same pattern on all. Otherwise all are turned by the same small angle:
  /// straight ones look exactly through the corners of regular rooms, and light leaks there.
  bool rotate = false;
  /// Pairs whose centres are nearer than this many times the sum of their radii take the exact unoccluded factor times
  /// the share of their pixels that is not covered: there the centre stands badly for the whole patch and a pixel is
  /// coarse. 0 is the plain hemicube of 1985.
  double exact_within = 5;
  std::uint64_t seed = 0;  ///< of the rotation
};

/// What a hemicube saw of one patch.
struct HemicubeSight {
  std::uint32_t patch = 0;
  double factor = 0;         ///< sum of the delta form factors of the pixels that see the patch's front
  std::uint32_t pixels = 0;  ///< how many they are
};

/// The plane through the eye and an edge of a polygon, in a face's axes: directions inside have a positive product.
struct HemicubeEdge {
  Vec3d inward{0};
  bool keeps_rim = false;  ///< whether directions exactly on it are inside
};

/// An item buffer of five faces around a point.
class Hemicube {
 public:
  static constexpr std::uint32_t nothing = 0xFFFFFFFFU;

  explicit Hemicube(std::shared_ptr<const HemicubeDeltas> deltas);

  /// Forgets what was seen and stands at `eye` with the frame's normal upwards.
  void place(const Vec3d& eye, const Frame& frame);

  /// Draws a convex polygon where it is nearer than what was drawn before. `item` is written where its front faces the
  /// eye, `nothing` where its back does. Pixels whose middle lies on a shared edge belong to one side only.
  void draw(std::span<const Vec3d> polygon, std::uint32_t item);
  /// Draws it where nothing was drawn before: for polygons that come from front to back.
  void draw_behind(std::span<const Vec3d> polygon, std::uint32_t item);
  /// The sum of the delta form factors that the polygon covers by itself. Draws nothing.
  [[nodiscard]] double cover(std::span<const Vec3d> polygon);
  /// One ray through each pixel's middle from a point of patch `from`.
  void cast(const PatchTracer& tracer, std::uint32_t from);

  /// Every item seen, by ascending number, with its factor.
  [[nodiscard]] std::vector<HemicubeSight> sights(std::size_t item_count) const;
  [[nodiscard]] const HemicubeDeltas& deltas() const { return *deltas_; }
  /// What each pixel of a face sees: an item or `nothing`, laid out as the deltas. Face 0 is the top; 1 to 4 look along
  /// the frame's +x, +y, -x, -y, with rows upwards and columns along +y, -x, -y, +x.
  [[nodiscard]] std::span<const std::uint32_t> items(std::size_t face) const { return items_[face]; }

 private:
  template <class Paint>
  void rasterise(std::span<const Vec3d> polygon, const Paint& paint);
  void paint(std::size_t face, std::size_t pixel, std::uint32_t item, double nearness) {
    items_[face][pixel] = item;
    nearness_[face][pixel] = nearness;
  }

  std::shared_ptr<const HemicubeDeltas> deltas_;
  Vec3d eye_{0};
  Frame frame_;
  std::vector<std::uint32_t> items_[5];
  std::vector<double> nearness_[5];  ///< 1 / distance along the face's axis; 0 where nothing is
  std::vector<Vec3d> local_;         // scratch
  std::vector<HemicubeEdge> edges_;
};

/// The factors from an element at `eye` to all patches of a mesh, by the plain hemicube. Allocates.
[[nodiscard]] std::vector<double> hemicube_factors(const PatchMesh& mesh, const Vec3d& eye, const Frame& frame,
                                                   int resolution);

/// The hemicube as a method: one at the centre of each patch, each row giving half of its pairs' exchange.
///
/// Its error does not follow the tolerance: it has that of the one point that stands for the patch (of relative order
/// (size / distance)^2), of the pixels' size (about 1 / N times the outline of what is seen) and, in the exact near
/// pairs, of shadow edges, which the centre sees or does not see. The estimates given are rough, and do not know of
/// shadow edges that a centre does not see.
/// Throws std::invalid_argument for options out of range.
[[nodiscard]] std::unique_ptr<FormFactorMethod> make_hemicube(const PatchMesh& mesh, const HemicubeOptions& options);

}  // namespace penumbra
