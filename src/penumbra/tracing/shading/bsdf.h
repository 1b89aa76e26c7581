#pragma once

#include <optional>

#include "penumbra/math/frame.h"
#include "penumbra/math/spectrum.h"
#include "penumbra/tracing/shading/rough_glass.h"
#include "penumbra/tracing/shading/surface_material.h"

namespace penumbra {

/// A direction chosen by a BSDF.
struct BsdfSample {
  Vec3d direction{0};  ///< unit, world, away from the surface
  Rgb weight{0};       ///< f |cos| / pdf: what the throughput is multiplied by
  double pdf = 0;      ///< 1/sr of solid angle; 0 for an ideal (delta) lobe
  bool ideal = false;  ///< mirror or refraction without spread: light sampling cannot find it
  bool transmitted = false;
};

/// The rays that Whitted's recursion follows from a hit, and their weights.
struct SpecularSplit {
  Rgb reflected{0};               ///< weight of the mirror ray, 0 when there is none
  Vec3d reflection_direction{0};  ///< unit
  Rgb refracted{0};               ///< weight of the refraction ray, 0 when there is none (or total reflection)
  Vec3d refraction_direction{0};  ///< unit
};

/// How light scatters at one point: built from a material evaluated there. Directions are unit, world space and point
/// away from the surface: `wo` to where light goes (the eye), `wi` to where it comes from.
/// Reciprocal (up to the eta^2 of refraction, which is left out: radiance is stored divided by eta^2) and never
/// reflects more than arrives.
///
/// The lobes, after glTF 2.0 with KHR_materials_{specular, ior, transmission}: three shares that sum to 1,
///   metal        metallic: GGX with Schlick's Fresnel term, or the exact one of a conductor; light that microfacets
///                scatter more than once comes out as a matt lobe (Kulla & Conty, "Revisiting Physically Based
///                Shading at Imageworks", SIGGRAPH 2017 course), so that a white metal loses nothing;
///   opaque       (1 - metallic)(1 - transmission): a Lambertian base under a GGX layer with Schlick's Fresnel term.
///   The
///                base gets what the layer leaves, in the reciprocal form (1 - E(wo))(1 - E(wi))/(1 - mean E) of
///                Kelemen & Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model", Eurographics 2001,
///                as glTF's own mix exceeds 1 near grazing;
///   transparent  (1 - metallic) transmission: a dielectric interface with exact Fresnel terms, tinted by the base
///                colour on the way through; solid (Walter et al. 2007) or a thin plate that does not bend rays;
/// and Whitted's constant mirror on top, which takes from the others only where the sum would exceed 1. GGX narrower
/// than `ideal_alpha` is an ideal mirror or refraction. Light that the facets of a transparent share scatter more than
/// once comes out as matt lobes on both sides, see RoughGlass, where its reflection is not tinted or weakened.
/// Directions must lie on the same side of both the shading and the geometric normal, else nothing passes.
class Bsdf {
 public:
  /// GGX widths (roughness squared) below this scatter so little that the lobe is taken as ideal.
  static constexpr double ideal_alpha = 1e-3;

  /// @param shading its normal is the shading normal; may lie on either side.
  /// @param geometric_normal unit, towards the front; tells front from back and inside from outside.
  Bsdf(const SurfaceMaterial& material, const Frame& shading, const Vec3d& geometric_normal);

  /// f(wo, wi), 1/sr, of all lobes with spread; 0 when no light can go that way.
  [[nodiscard]] Rgb evaluate(const Vec3d& wo, const Vec3d& wi) const;
  /// Density of `sample` over solid angle, 1/sr, of the lobes with spread.
  [[nodiscard]] double pdf(const Vec3d& wo, const Vec3d& wi) const;
  /// Chooses a lobe by `u_lobe` and a direction by `u`. None when the light is absorbed.
  [[nodiscard]] std::optional<BsdfSample> sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const;

  /// The mirror and refraction rays of lobes whose roughness is at most `roughness_limit`, taken as ideal.
  [[nodiscard]] SpecularSplit specular_split(const Vec3d& wo, double roughness_limit) const;
  /// f(wo, wi) of the lobes that `specular_split` leaves out.
  [[nodiscard]] Rgb evaluate_unsplit(const Vec3d& wo, const Vec3d& wi, double roughness_limit) const;

  /// Diffuse reflectance under normal incidence, 0..1: what ambient light is multiplied by, and the albedo layer.
  [[nodiscard]] Rgb diffuse_reflectance() const;
  /// Diffuse reflectance of light that comes from everywhere alike, towards `wo`: what irradiance is multiplied by.
  [[nodiscard]] Rgb diffuse_albedo(const Vec3d& wo) const;
  /// What mirror and layer leave to the Lambertian base, 0..1: the mean over all directions.
  [[nodiscard]] Rgb share_of_base() const;
  /// The same without its Lambertian base: the gloss alone.
  [[nodiscard]] Bsdf without_base() const;
  /// Unit; the |cos| of f |cos| is taken about it.
  [[nodiscard]] const Vec3d& shading_normal() const { return frame_.normal; }
  /// Whether all lobes with spread are one Lambertian base, whose f is the same for all pairs of directions.
  [[nodiscard]] bool is_lambertian() const { return !has_specular_ || (material_.specular == 0 && ideal_); }
  /// Whether any lobe has spread, so that shadow rays can bring light.
  [[nodiscard]] bool has_spread() const;

 private:
  /// What an interface does with light, of the transparent share.
  struct Interface {
    Rgb reflected{0};
    Rgb transmitted{0};  ///< tint included
  };
  /// A pair of directions in the shading frame, turned so that wo lies at z > 0.
  struct Pair {
    Vec3d wo{0};
    Vec3d wi{0};
    bool from_front = true;    ///< wo is on the geometric front: outside
    bool transmitted = false;  ///< wi is on the other side
  };
  /// The microfacet that refracts a pair of directions on different sides of a solid's surface.
  struct Refraction {
    Vec3d h{0};          ///< its normal, z > 0
    double to = 1;       ///< index on the side of wi
    double cos_o = 0;    ///< wo.h
    double cos_i = 0;    ///< wi.h, < 0
    double stretch = 0;  ///< from wo.h + to wi.h
    bool possible = false;
  };
  /// Probabilities with which `sample` chooses its lobes, sum 1 (or all 0).
  struct LobeChoice {
    double mirror = 0;      ///< every ideal reflection
    double refraction = 0;  ///< ideal transmission
    double facet = 0;       ///< a GGX microfacet, which then reflects or transmits
    double diffuse = 0;
    double beyond = 0;  ///< matt, on the other side
  };

  [[nodiscard]] std::optional<Pair> pair_of(const Vec3d& wo, const Vec3d& wi) const;
  [[nodiscard]] Vec3d to_side(const Vec3d& w, bool front) const;
  [[nodiscard]] Vec3d to_world(const Vec3d& local, bool front) const;
  [[nodiscard]] bool bends() const;
  [[nodiscard]] double index_of(bool front) const;

  [[nodiscard]] Rgb metal_reflectance(double cos_theta) const;
  [[nodiscard]] Interface interface(double cos_theta, bool from_front) const;
  [[nodiscard]] Rgb specular_reflectance(double cos_theta, bool from_front) const;
  [[nodiscard]] double layer_albedo(double cos_theta, bool ideal_layer) const;
  [[nodiscard]] double layer_albedo_mean(bool ideal_layer) const;

  [[nodiscard]] Rgb diffuse(const Pair& pair, bool ideal_layer) const;
  [[nodiscard]] Rgb glossy(const Pair& pair) const;
  [[nodiscard]] Rgb metal_mean_reflectance() const;
  [[nodiscard]] double lost_once(double cos_theta) const;
  [[nodiscard]] Refraction refraction(const Pair& pair) const;
  [[nodiscard]] Rgb rough_transmission(const Pair& pair) const;
  [[nodiscard]] double lost_in_glass(bool outside, double cos_theta) const;
  [[nodiscard]] double share_reflected_again(bool outside) const;
  [[nodiscard]] Rgb scattered_again_in_glass(const Pair& pair) const;
  [[nodiscard]] Rgb evaluate_lobes(const Pair& pair, bool with_glossy, bool ideal_layer) const;

  [[nodiscard]] LobeChoice lobe_choice(const Vec3d& wo, bool from_front) const;
  [[nodiscard]] double pdf(const Pair& pair, const LobeChoice& choice) const;
  [[nodiscard]] double facet_reflects(double cos_theta, bool from_front) const;
  [[nodiscard]] std::optional<Vec3d> sample_facet(const Vec3d& wo, bool from_front, double u_lobe,
                                                  const Vec2d& u) const;
  [[nodiscard]] std::optional<BsdfSample> spread_sample(const Vec3d& wo, const Vec3d& local, const Vec3d& wi,
                                                        bool front, const LobeChoice& choice) const;
  [[nodiscard]] std::optional<BsdfSample> ideal_sample(const Vec3d& wo, const Vec3d& wi, bool transmitted,
                                                       const Rgb& weight) const;
  [[nodiscard]] std::optional<Vec3d> ideal_transmission(const Vec3d& wo, bool from_front) const;
  [[nodiscard]] Rgb transmitted_weight(double cos_theta, bool from_front) const;
  /// Compared as float, so that a roughness of 0.1F is at most 0.1.
  [[nodiscard]] bool splits(double roughness_limit) const {
    return ideal_ || material_.roughness <= static_cast<float>(roughness_limit);
  }

  SurfaceMaterial material_;
  Frame frame_;
  Vec3d geometric_normal_;

  double alpha_ = 1;    ///< GGX width
  bool ideal_ = false;  ///< GGX lobes are ideal
  bool ideal_transmission_ = false;
  bool has_specular_ = false;  ///< any lobe but the Lambertian base and the mirror
  float metal_ = 0;            ///< the three shares
  float opaque_ = 0;
  float transparent_ = 0;
  Rgb remaining_{1.0F};       ///< what the mirror leaves to the other lobes
  Rgb dielectric_f0_{0};      ///< of the opaque share's layer; its f90 is `specular`
  double layer_f0_ = 0;       ///< the largest band of it
  double hiding_ = 0;         ///< share of the base that a layer of index 0, Fresnel term 1, hides at every angle
  double open_mean_ = 1;      ///< 1 - mean layer albedo
  Rgb metal_again_{0};        ///< of the light that leaves no metal facet at first, what comes out after all
  double lost_mean_ = 0;      ///< mean of lost_once over the hemisphere by projected solid angle
  Rgb diffuse_colour_{0};     ///< Lambertian base of the opaque share
  bool keeps_glass_ = false;  ///< light between the facets of the transparent share is given back
  RoughGlass glass_;          ///< of a solid; a thin plate's is lost_once()
};

}  // namespace penumbra
