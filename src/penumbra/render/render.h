#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "penumbra/image/image.h"
#include "penumbra/parallel/progress.h"
#include "penumbra/scene/camera.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

enum class IntegratorKind {
  appel,    ///< primary rays and shadow rays (Appel 1968)
  whitted,  ///< the recursion of Whitted 1979
  path,     ///< path tracing, the reference
  light,    ///< from the lights, see trace_light()
};

enum class FilterKind { box, tent, gaussian, mitchell, blackman_harris };

/// The largest width or height of a picture, pixels.
inline constexpr int max_render_side = 32768;

/// Which rectangle of the picture to draw, pixels, [x0, x1) x [y0, y1).
struct Region {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// The layers that a picture can carry beside its colour.
enum class Aov { albedo, normal, depth, position, object, direct, indirect, variance, rays };

struct RenderOptions {
  IntegratorKind integrator = IntegratorKind::whitted;
  int width = 800;
  int height = 600;
  int samples_per_pixel = 4;  ///< >= 1; with a noise target the most that a pixel gets
  /// Stop sampling where it is quiet: blocks of 4 x 4 pixels whose standard error, relative to their brightness (at
  /// least a hundredth of the picture's), has fallen to this get no more samples once they have 16; 0: all pixels get
  /// the same number.
  double noise = 0;
  /// Sample where the picture has edges: after a first few samples a pixel gets all only where its colour and that of a
  /// neighbour differ by more than this share of their sum (contrasted_pixels), and keeps the first few elsewhere; 0:
  /// all pixels get the same number. Not with `noise`, nor with paths, which are noisy everywhere.
  double contrast = 0;
  FilterKind filter = FilterKind::box;
  int max_depth = 0;  ///< longest path in segments after the primary ray; 0: 16 for whitted, no limit for path
  double min_throughput =
      1e-3;  ///< whitted ends a ray whose weight falls below this; path's Russian roulette starts there (unbiased)
  std::optional<Region> region;  ///< none: everything
  bool opaque_shadows = false;   ///< glass stops shadow rays in appel and whitted
  /// Path only: light that reaches a surface with spread by way of mirrors and glass. False leaves it out: much less
  /// noise, but darker (leave_caustics_out does the same to a solution).
  bool caustics = true;
  bool front_sides_only = false;  ///< backs are black and opaque
  /// Of appel and whitted: shadow rays that a sample sends to a lamp where the lamp's shadows may end; one elsewhere.
  /// Up to 1: one everywhere.
  int shadow_samples = 0;
  bool shadow_samples_everywhere = false;  ///< as many elsewhere, too: to compare with
  /// Of appel and whitted: light from flat lamps on matt surfaces by clipping the lamp, without noise, where few
  /// polygons stand in between.
  bool exact_shadows = false;
  /// Each sample carries three wavelengths in place of red, green and blue (`path` and `whitted`), see Bands.
  bool spectral = false;
  int final_gather = 0;  ///< two-pass: rays a sample that gather indirect light; 0: interpolated
  std::uint64_t seed = 0;
  double time_limit = 0;  ///< s, 0: none; the samples done by then are the picture
  std::vector<Aov> aovs;
};

/// Rays traced, by what they were for.
struct RayCounts {
  std::uint64_t primary = 0, shadow = 0, reflection = 0, refraction = 0, diffuse = 0;
  std::vector<std::uint64_t> by_depth;  ///< [0] is primary; shadow rays count at the depth of the hit they leave
  [[nodiscard]] std::uint64_t total() const { return primary + shadow + reflection + refraction + diffuse; }
};

/// What became of the particles that the lights sent out.
struct ParticleFates {
  static constexpr double pupil_radius = 0.002;  ///< m, of a person's eye by daylight
  std::uint64_t shot = 0;
  std::uint64_t met_eye = 0;  ///< came through the picture's frame into the pupil by themselves
  std::uint64_t seen = 0;     ///< met a surface that a ray to the eye then showed in the picture
};

struct RenderResult {
  Image image;  ///< scene-linear radiance R, G, B, then the layers asked for, named "layer.C"
  RayCounts rays;
  double mean_samples = 0;  ///< samples per pixel actually taken
  bool partial = false;     ///< stopped or out of time before all samples were done
  double seconds = 0;
  std::optional<ParticleFates> particles;  ///< when light was traced from the lights
};

/// Draws a picture. Bit-identical for any number of threads, given the same options (unless a time limit or a stop cuts
/// it). Throws std::invalid_argument for options out of range.
[[nodiscard]] RenderResult render(const RayTracer& tracer, const Camera& camera, const RenderOptions& options,
                                  const Progress& progress = {});

}  // namespace penumbra
