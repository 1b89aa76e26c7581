#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "penumbra/math/bands.h"
#include "penumbra/tracing/hit.h"
#include "penumbra/tracing/shading/environment_map.h"
#include "penumbra/tracing/shading/lamp_points.h"
#include "penumbra/tracing/shading/light_tree.h"

namespace penumbra {

/// Light that may arrive at a point from one direction, before anything in between is looked at.
struct LightSample {
  Vec3d direction{0};  ///< unit, from the point to the light
  Rgb radiance{0};     ///< W/(m^2 sr); for a light without a body, irradiance W/m^2 on a surface that faces it
  double pdf = 0;      ///< 1/sr, of choosing this direction; 0 for a light without a body
  Ray shadow_ray;      ///< what must be free for the light to arrive
  const EmissionSpectrum* spectrum = nullptr;  ///< of a lamp that has one: `radiance` is its colour

  /// What the incoming light counts for, to be multiplied by f |cos|.
  [[nodiscard]] Rgb weight() const { return pdf > 0 ? radiance / static_cast<float>(pdf) : radiance; }
  /// The same in a sample's bands.
  [[nodiscard]] Rgb weight(const Bands& bands) const;
};

/// All lights of a scene, for shadow rays: punctual lights, emissive objects (each a light of its own) and the
/// environment.
///
/// One light chosen for all is chosen by a LightTree over triangles, shapes and punctual lights, according to what it
/// may bring to the point; far lights and the environment are chosen by power. When the light is given, points on its
/// mesh are chosen in proportion to emitted power. Spheres are sampled by the cone they fill (Shirley, Wang & Zimmerman
/// 1996). Infinite planes that emit, and ambient light, are not in it.
class LightSampler {
 public:
  enum class Kind { punctual, mesh, shape, environment };
  /// The middle of a flat lamp, where a single shadow ray meets it.
  struct Middle {
    Vec3d position{0};
    Vec3d normal{0, -1, 0};  ///< unit, of the emitting side
    double area = 0;         ///< m^2, of the whole lamp
    Rgb radiance{0};         ///< mean, W/(m^2 sr)
    bool both_sides = false;
  };
  struct Source {
    Kind kind;
    std::uint32_t index;                   ///< light, or object
    double power;                          ///< W, for the choice among lights
    std::vector<std::uint32_t> triangles;  ///< of a mesh: those that emit
    std::vector<double> cdf;               ///< over `triangles`, from 0 to 1
    std::optional<Middle> middle;          ///< of a flat mesh of few triangles and even radiance, or a disk
  };

  /// The scene must outlive the sampler.
  explicit LightSampler(const Scene& scene);

  [[nodiscard]] std::size_t light_count() const { return lights_.size(); }
  [[nodiscard]] const Source& light(std::size_t number) const { return lights_[number]; }

  /// The middle of a light's bounds, world; none for what has no place: far lights and the environment.
  [[nodiscard]] std::optional<Vec3d> place(std::size_t light) const { return places_[light]; }
  /// The spectrum of a lamp that has one (of a mesh: of its first shining triangle); else null.
  [[nodiscard]] const EmissionSpectrum* spectrum(std::size_t light) const;

  /// A direction towards one light; none when it cannot light the point at all.
  /// @param facing unit normal of the side to be lit: an environment without a picture is then sampled by the cosine
  /// with it. Zero: from all sides alike.
  [[nodiscard]] std::optional<LightSample> sample_light(std::size_t light, const SurfacePoint& from, const Vec2d& u,
                                                        const Vec3d& facing = Vec3d(0)) const;

  /// The direction towards the middle of a light: sharp shadows without noise, as when lights were points. None when it
  /// cannot light the point, or has no middle (`has_middle`).
  [[nodiscard]] std::optional<LightSample> sample_middle(std::size_t light, const SurfacePoint& from) const;
  /// Whether `sample_middle` can stand for a light: punctual ones, disks, spheres and flat meshes of few triangles.
  [[nodiscard]] bool has_middle(std::size_t light) const;

  /// A point of a lamp, of a mesh's in proportion to emitted power; none for lights without a body.
  [[nodiscard]] std::optional<LampPoint> sample_point(std::size_t light, Vec2d u) const;

  /// A direction towards a light chosen among all, as above; the pdf and the weight include the choice.
  [[nodiscard]] std::optional<LightSample> sample(const SurfacePoint& from, double u_light, const Vec2d& u,
                                                  const Vec3d& facing = Vec3d(0)) const;

  /// The density (1/sr) with which `sample` would choose the direction from `from` to the point `light` of an emissive
  /// object.
  [[nodiscard]] double pdf(const Vec3d& from, const SurfacePoint& light, const Vec3d& facing = Vec3d(0)) const;
  /// The density (1/sr) with which `sample` would choose a direction that leaves the scene.
  [[nodiscard]] double environment_pdf(const Vec3d& direction, const Vec3d& facing = Vec3d(0)) const;

  [[nodiscard]] const EnvironmentMap& environment() const { return environment_; }
  /// What is seen where nothing stands: the environment and the disks of far lights. @param direction unit.
  [[nodiscard]] Rgb seen_in_sky(const Vec3d& direction) const;
  /// Sum of the ambient lights' radiance.
  [[nodiscard]] Rgb ambient() const { return ambient_; }

 private:
  void add_punctual();
  void add_mesh(std::uint32_t object);
  void add_shape(std::uint32_t object);
  void add_environment();
  [[nodiscard]] std::optional<Middle> flat_middle(const Source& source) const;
  void make_choice();
  [[nodiscard]] LightTree::Emitter emitter(const Source& source, std::size_t part) const;

  [[nodiscard]] std::optional<LightSample> sample_punctual(const Source& source, const SurfacePoint& from,
                                                           const Vec2d& u) const;
  [[nodiscard]] std::optional<LightSample> sample_lamp(std::size_t light, const SurfacePoint& from,
                                                       const Vec2d& u) const;
  [[nodiscard]] std::optional<LightSample> sample_triangle_of(const Source& source, std::size_t part, double chance,
                                                              const SurfacePoint& from, const Vec2d& u) const;
  [[nodiscard]] std::optional<LightSample> sample_shape(const Source& source, const SurfacePoint& from,
                                                        const Vec2d& u) const;
  [[nodiscard]] std::optional<LightSample> sample_environment(const SurfacePoint& from, const Vec2d& u,
                                                              const Vec3d& facing) const;
  [[nodiscard]] bool by_cosine(const Vec3d& facing) const;
  [[nodiscard]] std::optional<LightSample> towards(const SurfacePoint& from, const SurfacePoint& light,
                                                   double area_pdf) const;
  [[nodiscard]] double shape_pdf(const ShapeObject& object, const Vec3d& from, const SurfacePoint& light) const;

  const Scene* scene_;
  EnvironmentMap environment_;
  Rgb ambient_{0};
  double scene_radius_ = 1;
  std::vector<Source> lights_;
  std::vector<std::uint32_t> light_of_object_;  ///< into lights_, or none

  // Among which lights one is chosen: those at a place, as parts of them, and those without.
  struct Part {
    std::uint32_t light;   ///< into lights_
    std::uint32_t number;  ///< of a mesh: into its triangles
  };
  LightTree tree_;
  std::vector<std::optional<Vec3d>> places_;                  ///< by light
  std::vector<Part> parts_;                                   ///< the tree's emitters
  std::vector<std::vector<std::uint32_t>> part_of_triangle_;  ///< by light: of each triangle of the mesh
  std::vector<std::uint32_t> part_of_light_;                  ///< of what is no mesh
  std::vector<std::uint32_t> far_;                            ///< lights without a place
  std::vector<double> far_cdf_;                               ///< chances of theirs, from 0 to far_chance_
  double far_chance_ = 0;
};

/// The share of a punctual light that is left at a distance (m): KHR_lights_punctual's smooth fall to 0 at the range.
[[nodiscard]] double range_window(double distance, double range);

/// The share of a spot's intensity in a direction (unit, away from it): KHR_lights_punctual's squared ramp of the
/// angle's cosine between outer and inner angle.
[[nodiscard]] double spot_window(const SpotLight& spot, const Vec3d& from_light);

/// Whether an emissive point sends light towards `direction` (unit, away from it), by the rule of sides: from the
/// front, and from the back when its material is double-sided.
[[nodiscard]] bool emits_towards(const Material& material, const Vec3d& geometric_normal, const Vec3d& direction);

}  // namespace penumbra
