#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "penumbra/math/bands.h"
#include "penumbra/math/ray.h"
#include "penumbra/math/rng.h"
#include "penumbra/scene/scene.h"
#include "penumbra/tracing/shading/density_field.h"

namespace penumbra {

/// What a stretch of a ray travels in: the material of the closed surface around it (see Interior), or none for the
/// open air.
using Surroundings = std::optional<std::uint32_t>;

/// The participating media of a scene, along rays. Thread-safe; the scene must outlive it.
///
/// Coefficients given in red, green and blue become spectra as reflectances do (see uplift_basis): at every wavelength
/// between the least and the largest of the three, grey stays grey.
class Media {
 public:
  explicit Media(const Scene& scene);

  /// Nothing anywhere takes light away or scatters it.
  [[nodiscard]] bool none() const { return none_; }
  [[nodiscard]] const Medium& medium(std::uint32_t index) const { return scene_->media[index]; }
  /// Something scatters.
  [[nodiscard]] bool scatter() const { return scatter_; }

  /// Beer-Lambert: the share of light left along the interval (0, ray.t_max), 0..1 per band. Exact, also through
  /// grids.
  [[nodiscard]] Rgb transmittance(const Surroundings& around, const Ray& ray, const Bands& bands = {}) const;
  /// Optical depth of the same, >= 0, infinite allowed.
  [[nodiscard]] Vec3d optical_depth(const Surroundings& around, const Ray& ray, const Bands& bands = {}) const;

  struct Interval {
    double from = 0, to = 0;  ///< m along the ray; to may be infinite
  };
  /// The shortest interval of the ray outside of which nothing scatters.
  [[nodiscard]] std::optional<Interval> scattering_interval(const Surroundings& around, const Ray& ray) const;
  /// How one medium scatters at a point.
  struct Lobe {
    Rgb scattering{0};     ///< sigma_s there, 1/m
    double asymmetry = 0;  ///< g
  };
  struct Lobes {
    std::array<Lobe, most_media_in_air> lobe;
    std::size_t count = 0;
    [[nodiscard]] const Lobe* begin() const { return lobe.data(); }
    [[nodiscard]] const Lobe* end() const { return lobe.data() + count; }
  };
  /// The media that scatter at `point`.
  [[nodiscard]] Lobes lobes(const Surroundings& around, const Vec3d& point, const Bands& bands = {}) const;
  /// Sum of the media's extinction at `point`, 1/m.
  [[nodiscard]] Rgb extinction(const Surroundings& around, const Vec3d& point, const Bands& bands = {}) const;

  /// How light that is followed along a ray fares.
  struct Flight {
    Rgb weight{1.0F};          ///< what the throughput is to be multiplied by, scattering's albedo included
    bool collided = false;     ///< else it came to the end
    double distance = 0;       ///< m, of the collision
    std::uint32_t medium = 0;  ///< index into Scene::media
  };
  /// Follows light until it collides with a medium and is scattered, or comes to ray.t_max: distance sampling by delta
  /// tracking (Woodcock et al. 1965) below the majorant of each medium, unbiased in grids too. The band that decides is
  /// drawn in proportion to `throughput`, and the bands are joined by the balance heuristic over the exact densities
  /// (after Wilkie et al. 2014), so that the weight never exceeds the sum of the throughput over its largest band.
  /// @param u two uniform numbers: the band and the first step. @param rng for the steps that follow.
  [[nodiscard]] Flight fly(const Surroundings& around, const Ray& ray, const Rgb& throughput, const Vec2d& u,
                           CounterRng& rng, const Bands& bands = {}) const;

 private:
  // A medium where the ray is in it.
  struct Part {
    std::uint32_t medium;
    double from, to;
    Rgb extinction;  // at density 1, 1/m, in the ray's bands
  };
  struct Parts {
    std::array<Part, most_media_in_air> part;
    std::size_t count = 0;
    [[nodiscard]] const Part* begin() const { return part.data(); }
    [[nodiscard]] const Part* end() const { return part.data() + count; }
  };
  struct Contents {
    std::array<std::uint32_t, most_media_in_air> medium;
    std::size_t count = 0;
  };
  struct Strike {
    double distance;
    std::uint32_t medium;
  };

  [[nodiscard]] Contents contents(const Surroundings& around) const;
  [[nodiscard]] Parts parts(const Surroundings& around, const Ray& ray, const Bands& bands) const;
  [[nodiscard]] double density(std::uint32_t medium, const Vec3d& point) const;
  [[nodiscard]] double path_density(const Part& part, const Ray& ray, double to) const;
  [[nodiscard]] Vec3d optical_depth(const Parts& parts, const Ray& ray, double to) const;
  [[nodiscard]] std::optional<Strike> track(const Parts& parts, const Ray& ray, int band, double u,
                                            CounterRng& rng) const;
  [[nodiscard]] static bool is_grey(const Parts& parts);

  const Scene* scene_;
  std::vector<std::optional<DensityField>> fields_;  ///< by medium
  bool none_ = true;
  bool scatter_ = false;
};

}  // namespace penumbra
