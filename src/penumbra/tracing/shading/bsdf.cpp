#include "penumbra/tracing/shading/bsdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/math/sampling.h"
#include "penumbra/tracing/shading/fresnel.h"
#include "penumbra/tracing/shading/microfacet.h"
#include "penumbra/tracing/shading/specular_albedo.h"

namespace penumbra {
namespace {

using std::numbers::pi;

constexpr Vec3d up(0, 0, 1);

/// Cosines below this are on the horizon: the area seen is rounding, and densities would overflow.
constexpr double horizon = 1e-9;

Vec3d mirrored_through_surface(const Vec3d& w) { return {w.x, w.y, -w.z}; }

double mean(const Rgb& c) { return (static_cast<double>(c.x) + c.y + c.z) / 3; }

Rgb clamp_share(const Rgb& c) { return glm::clamp(c, 0.0F, 1.0F); }

}  // namespace

Bsdf::Bsdf(const SurfaceMaterial& material, const Frame& shading, const Vec3d& geometric_normal)
    : material_(material), frame_(shading), geometric_normal_(geometric_normal) {
  material_.base_colour = clamp_share(material_.base_colour);
  material_.specular_colour = glm::max(material_.specular_colour, Rgb(0));
  material_.mirror = clamp_share(material_.mirror);
  material_.roughness = std::clamp(material_.roughness, 0.0F, 1.0F);
  material_.specular = std::clamp(material_.specular, 0.0F, 1.0F);
  const double roughness = material_.roughness;
  alpha_ = roughness * roughness;
  ideal_ = alpha_ < ideal_alpha;

  metal_ = std::clamp(material_.metallic, 0.0F, 1.0F);
  const float transmission = std::clamp(material_.transmission, 0.0F, 1.0F);
  opaque_ = (1 - metal_) * (1 - transmission);
  transparent_ = (1 - metal_) * transmission;
  diffuse_colour_ = opaque_ * material_.base_colour;

  const auto f0 = static_cast<float>(material_.ior == 0 ? 1.0 : normal_reflectance(1, material_.ior));
  dielectric_f0_ = glm::min(f0 * material_.specular_colour, Rgb(1.0F)) * material_.specular;
  layer_f0_ = max_component(dielectric_f0_);
  hiding_ = std::max<double>(layer_f0_, material_.specular);
  open_mean_ = 1 - layer_albedo_mean(ideal_);
  has_specular_ = metal_ > 0 || transparent_ > 0 || material_.specular > 0;
  ideal_transmission_ = ideal_ || (!material_.thin_walled && !bends());

  // The table is of the plain interface: what a tint or a weight of the reflection loses is another matter.
  keeps_glass_ = transparent_ > 0 && !ideal_ && (material_.thin_walled || bends()) && material_.ior >= 1 &&
                 material_.specular == 1 && material_.specular_colour == Rgb(1);
  if (keeps_glass_ && !material_.thin_walled) glass_ = RoughGlass(material_.roughness, material_.ior);

  if (metal_ > 0 && !ideal_) {
    lost_mean_ = 1 - specular_albedo_mean(material_.roughness).of(1, 1);
    // The geometric series of Kulla & Conty 2017: each further bounce loses by the mean Fresnel term and is let out by
    // the mean albedo.
    const Rgb f = metal_mean_reflectance();
    const auto out = static_cast<float>(1 - lost_mean_);
    metal_again_ = metal_ * f * f * out / (Rgb(1) - f * (1 - out));
  }

  if (!is_black(material_.mirror)) {
    for (int band = 0; band < 3; ++band) {
      const float most = has_specular_ ? 1.0F : diffuse_colour_[band];
      remaining_[band] = most + material_.mirror[band] > 1 ? (1 - material_.mirror[band]) / most : 1.0F;
    }
  }
}

// Sides and frames

Vec3d Bsdf::to_side(const Vec3d& w, bool front) const {
  const Vec3d local = frame_.to_local(w);
  return front ? local : mirrored_through_surface(local);
}

Vec3d Bsdf::to_world(const Vec3d& local, bool front) const {
  return frame_.to_world(front ? local : mirrored_through_surface(local));
}

std::optional<Bsdf::Pair> Bsdf::pair_of(const Vec3d& wo, const Vec3d& wi) const {
  const double side_o = glm::dot(wo, geometric_normal_);
  const double side_i = glm::dot(wi, geometric_normal_);
  if (side_o == 0 || side_i == 0) return std::nullopt;
  const bool front = side_o > 0;
  Pair pair{to_side(wo, front), to_side(wi, front), front, front != (side_i > 0)};
  if (!(pair.wo.z > horizon) || !(pair.transmitted ? pair.wi.z < -horizon : pair.wi.z > horizon)) return std::nullopt;
  return pair;
}

/// An interface without contrast passes rays straight, whatever its roughness.
bool Bsdf::bends() const { return !material_.thin_walled && std::abs(material_.ior - 1) > 1e-4; }

double Bsdf::index_of(bool front) const { return front ? 1.0 : material_.ior; }

// Reflectances of the shares

Rgb Bsdf::metal_reflectance(double cos_theta) const {
  if (material_.conductor) {
    const ConductorIor& n = *material_.conductor;
    return {fresnel_conductor(cos_theta, n.eta.x, n.k.x).mean(), fresnel_conductor(cos_theta, n.eta.y, n.k.y).mean(),
            fresnel_conductor(cos_theta, n.eta.z, n.k.z).mean()};
  }
  const auto edge = static_cast<float>(fresnel_schlick(cos_theta, 0, 1));
  return material_.base_colour + (Rgb(1.0F) - material_.base_colour) * edge;
}

// 2 * integral of F(c) c dc: exact for Schlick's term; by Gauss and Legendre's rule of four points in c for a
// conductor.
Rgb Bsdf::metal_mean_reflectance() const {
  if (!material_.conductor) return material_.base_colour + (Rgb(1) - material_.base_colour) / 21.0F;
  constexpr double nodes[] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
  constexpr double weights[] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269};
  Rgb sum(0);
  for (int k = 0; k < 4; ++k) sum += static_cast<float>(2 * weights[k] * nodes[k]) * metal_reflectance(nodes[k]);
  return glm::min(sum, Rgb(1));
}

/// The share of light that leaves no facet at its first bounce, if none is absorbed.
double Bsdf::lost_once(double cos_theta) const {
  return std::max(0.0, 1 - specular_albedo(material_.roughness, cos_theta).of(1, 1));
}

Bsdf::Interface Bsdf::interface(double cos_theta, bool from_front) const {
  const double from = material_.thin_walled ? 1.0 : index_of(from_front);
  const double to = material_.thin_walled ? material_.ior : index_of(!from_front);
  const double fresnel = material_.ior == 0 ? 1.0 : fresnel_dielectric(cos_theta, from, to).mean();
  Rgb r(1.0F);  // total reflection, which no tint of the layer weakens
  if (fresnel < 1) {
    r = glm::min(static_cast<float>(fresnel) * material_.specular_colour, Rgb(1.0F)) * material_.specular;
  }
  if (material_.thin_walled) r = 2.0F * r / (Rgb(1.0F) + r);  // both faces and all that bounces between them
  return {r, (Rgb(1.0F) - r) * material_.base_colour};
}

Rgb Bsdf::specular_reflectance(double cos_theta, bool from_front) const {
  Rgb r(0);
  if (opaque_ > 0) {
    const auto edge = static_cast<float>(fresnel_schlick(cos_theta, 0, 1));
    r += opaque_ * (dielectric_f0_ + (Rgb(material_.specular) - dielectric_f0_) * edge);
  }
  if (metal_ > 0) r += metal_ * metal_reflectance(cos_theta);
  if (transparent_ > 0) r += transparent_ * interface(cos_theta, from_front).reflected;
  return r * remaining_;
}

double Bsdf::layer_albedo(double cos_theta, bool ideal_layer) const {
  if (material_.specular == 0) return 0;
  if (ideal_layer) return fresnel_schlick(cos_theta, layer_f0_, material_.specular);
  return specular_albedo(material_.roughness, cos_theta).of(layer_f0_, material_.specular);
}

double Bsdf::layer_albedo_mean(bool ideal_layer) const {
  if (material_.specular == 0) return 0;
  if (ideal_layer) return layer_f0_ + (material_.specular - layer_f0_) / 21;
  return specular_albedo_mean(material_.roughness).of(layer_f0_, material_.specular);
}

// Lobes with spread

Rgb Bsdf::diffuse(const Pair& pair, bool ideal_layer) const {
  const Rgb lambert = diffuse_colour_ * remaining_ / std::numbers::pi_v<float>;
  if (material_.specular == 0) return lambert;
  if (material_.ior == 0) return lambert * static_cast<float>(1 - hiding_);
  const double open = ideal_layer == ideal_ ? open_mean_ : 1 - layer_albedo_mean(ideal_layer);
  if (open < 1e-6) return Rgb(0);
  const double coupling =
      (1 - layer_albedo(pair.wo.z, ideal_layer)) * (1 - layer_albedo(pair.wi.z, ideal_layer)) / open;
  return lambert * static_cast<float>(coupling);
}

Rgb Bsdf::glossy(const Pair& pair) const {
  const Ggx ggx(alpha_);
  const Vec3d h = glm::normalize(pair.wo + pair.wi);
  const double spread = ggx.distribution(h) * ggx.masking_shadowing(pair.wo, pair.wi) / (4 * pair.wo.z * pair.wi.z);
  Rgb f = specular_reflectance(std::min(1.0, glm::dot(pair.wo, h)), pair.from_front) * static_cast<float>(spread);
  if (lost_mean_ > 0) {
    const double again = lost_once(pair.wo.z) * lost_once(pair.wi.z) / (pi * lost_mean_);
    f += metal_again_ * remaining_ * static_cast<float>(again);
  }
  return f;
}

Bsdf::Refraction Bsdf::refraction(const Pair& pair) const {
  Refraction r;
  const double from = index_of(pair.from_front);
  r.to = index_of(!pair.from_front);
  r.h = glm::normalize(from * pair.wo + r.to * pair.wi);
  if (r.h.z < 0) r.h = -r.h;
  r.cos_o = glm::dot(pair.wo, r.h);
  r.cos_i = glm::dot(pair.wi, r.h);
  r.stretch = from * r.cos_o + r.to * r.cos_i;
  r.possible = r.cos_o > 0 && r.cos_i < 0;
  return r;
}

Rgb Bsdf::rough_transmission(const Pair& pair) const {
  const Ggx ggx(alpha_);
  if (material_.thin_walled) {
    // The lobe of a rough reflection, turned over to the other side.
    const Vec3d wi = mirrored_through_surface(pair.wi);
    const Vec3d h = glm::normalize(pair.wo + wi);
    const double spread = ggx.distribution(h) * ggx.masking_shadowing(pair.wo, wi) / (4 * pair.wo.z * wi.z);
    return transmitted_weight(std::min(1.0, glm::dot(pair.wo, h)), pair.from_front) * static_cast<float>(spread);
  }
  const Refraction r = refraction(pair);
  if (!r.possible) return Rgb(0);
  // Walter et al. 2007, eq. 21, times (to/from)^2 as radiance is stored divided by the index squared.
  const double spread = std::abs(r.cos_o * r.cos_i / (pair.wo.z * pair.wi.z)) * r.to * r.to * ggx.distribution(r.h) *
                        ggx.masking(pair.wo) * ggx.masking(pair.wi) / (r.stretch * r.stretch);
  return transmitted_weight(std::min(1.0, r.cos_o), pair.from_front) * static_cast<float>(spread);
}

double Bsdf::lost_in_glass(bool outside, double cos_theta) const {
  return material_.thin_walled ? lost_once(cos_theta) : glass_.lost(outside, cos_theta);
}

// What the facets of the transparent share lose at first: matt on both sides, by what each direction loses.
Rgb Bsdf::scattered_again_in_glass(const Pair& pair) const {
  const bool outside_i = pair.from_front != pair.transmitted;
  const double mean_lost =
      material_.thin_walled ? 1 - specular_albedo_mean(material_.roughness).of(1, 1) : glass_.mean_lost(outside_i);
  if (!(mean_lost > 0)) return Rgb(0);
  const double lobe =
      lost_in_glass(pair.from_front, pair.wo.z) * lost_in_glass(outside_i, std::abs(pair.wi.z)) / (pi * mean_lost);
  const double share = share_reflected_again(pair.from_front);
  const Rgb part = pair.transmitted ? static_cast<float>((1 - share) * lobe) * material_.base_colour
                                    : Rgb(static_cast<float>(share * lobe));
  return transparent_ * remaining_ * part;
}

/// Of light scattered again in glass, the share that comes out on the side where it came from.
double Bsdf::share_reflected_again(bool outside) const {
  if (!material_.thin_walled) return glass_.reflected(outside);
  const double once = fresnel_diffuse_external(material_.ior);
  return 2 * once / (1 + once);  // both faces
}

Rgb Bsdf::evaluate_lobes(const Pair& pair, bool with_glossy, bool ideal_layer) const {
  Rgb f(0);
  if (!pair.transmitted) f = diffuse(pair, ideal_layer);
  if (!with_glossy) return f;
  if (!pair.transmitted && has_specular_) f += glossy(pair);
  if (pair.transmitted && transparent_ > 0 && !ideal_transmission_) f += rough_transmission(pair);
  if (keeps_glass_) f += scattered_again_in_glass(pair);
  return f;
}

Rgb Bsdf::evaluate(const Vec3d& wo, const Vec3d& wi) const {
  const std::optional<Pair> pair = pair_of(wo, wi);
  return pair ? evaluate_lobes(*pair, !ideal_, ideal_) : Rgb(0);
}

// Sampling

Bsdf::LobeChoice Bsdf::lobe_choice(const Vec3d& wo, bool from_front) const {
  LobeChoice choice;
  const Rgb specular = has_specular_ ? specular_reflectance(wo.z, from_front) : Rgb(0);
  const Rgb through = transparent_ > 0 ? transmitted_weight(wo.z, from_front) : Rgb(0);
  choice.mirror = mean(ideal_ ? material_.mirror + specular : material_.mirror);
  if (ideal_transmission_) choice.refraction = mean(through);
  if (has_specular_ && !ideal_) {
    // Microfacets reflect otherwise than the surface as a whole, which may reflect nothing: never 0.
    const double now = mean(ideal_transmission_ ? specular : specular + through);
    choice.facet = std::max(now, 0.05 * mean(remaining_));
  }
  const double below = material_.ior == 0 ? hiding_ : layer_albedo(wo.z, ideal_);
  choice.diffuse = mean(diffuse_colour_ * remaining_) * (1 - below);
  if (lost_mean_ > 0) choice.diffuse += mean(metal_again_ * remaining_) * lost_once(wo.z);
  if (keeps_glass_) {
    const double again = transparent_ * lost_in_glass(from_front, wo.z);
    const double share = share_reflected_again(from_front);
    choice.diffuse += again * share * mean(remaining_);
    choice.beyond = again * (1 - share) * mean(material_.base_colour * remaining_);
  }
  const double sum = choice.mirror + choice.refraction + choice.facet + choice.diffuse + choice.beyond;
  if (!(sum > 0)) return {};
  return {choice.mirror / sum, choice.refraction / sum, choice.facet / sum, choice.diffuse / sum, choice.beyond / sum};
}

/// The chance that a sampled microfacet, met at `cos_theta`, reflects rather than transmits.
double Bsdf::facet_reflects(double cos_theta, bool from_front) const {
  if (transparent_ == 0 || ideal_transmission_) return 1;
  const double reflected = mean(specular_reflectance(cos_theta, from_front));
  const double transmitted = mean(transmitted_weight(cos_theta, from_front));
  return reflected + transmitted > 0 ? reflected / (reflected + transmitted) : 1;
}

double Bsdf::pdf(const Pair& pair, const LobeChoice& choice) const {
  double density = (pair.transmitted ? choice.beyond : choice.diffuse) * std::abs(pair.wi.z) / pi;
  if (choice.facet == 0 || (pair.transmitted && ideal_transmission_)) return density;
  const Ggx ggx(alpha_);
  if (pair.transmitted && !material_.thin_walled) {
    const Refraction r = refraction(pair);
    if (!r.possible) return density;
    const double jacobian = r.to * r.to * -r.cos_i / (r.stretch * r.stretch);
    return density + choice.facet * (1 - facet_reflects(r.cos_o, pair.from_front)) *
                         ggx.visible_normal_pdf(pair.wo, r.h) * jacobian;
  }
  // A visible normal's density over the directions mirrored in it: the Jacobian is 1/(4 wo.h).
  const Vec3d h = glm::normalize(pair.wo + (pair.transmitted ? mirrored_through_surface(pair.wi) : pair.wi));
  const double mirrored = ggx.masking(pair.wo) * ggx.distribution(h) / (4 * pair.wo.z);
  const double reflects = facet_reflects(std::min(1.0, glm::dot(pair.wo, h)), pair.from_front);
  return density + choice.facet * (pair.transmitted ? 1 - reflects : reflects) * mirrored;
}

double Bsdf::pdf(const Vec3d& wo, const Vec3d& wi) const {
  const std::optional<Pair> pair = pair_of(wo, wi);
  return pair ? pdf(*pair, lobe_choice(pair->wo, pair->from_front)) : 0;
}

/// @param u_lobe uniform, decides whether the microfacet reflects.
std::optional<Vec3d> Bsdf::sample_facet(const Vec3d& wo, bool from_front, double u_lobe, const Vec2d& u) const {
  const Vec3d h = Ggx(alpha_).sample_visible_normal(wo, u);
  const Vec3d reflected = reflect(wo, h);
  if (u_lobe < facet_reflects(std::min(1.0, glm::dot(wo, h)), from_front)) {
    return reflected.z > 0 ? std::optional(reflected) : std::nullopt;
  }
  if (material_.thin_walled) return reflected.z > 0 ? std::optional(mirrored_through_surface(reflected)) : std::nullopt;
  const std::optional<Vec3d> refracted = refract(wo, h, index_of(from_front), index_of(!from_front));
  return refracted && refracted->z < 0 ? refracted : std::nullopt;
}

std::optional<BsdfSample> Bsdf::ideal_sample(const Vec3d& wo, const Vec3d& wi, bool transmitted,
                                             const Rgb& weight) const {
  const std::optional<Pair> pair = pair_of(wo, wi);
  if (!pair || pair->transmitted != transmitted) return std::nullopt;
  return BsdfSample{wi, weight, 0, true, transmitted};
}

std::optional<BsdfSample> Bsdf::sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const {
  const bool front = glm::dot(wo, geometric_normal_) > 0;
  const Vec3d local = to_side(wo, front);
  if (!(local.z > horizon)) return std::nullopt;
  const LobeChoice choice = lobe_choice(local, front);

  if (u_lobe < choice.mirror) {
    const Rgb reflected = material_.mirror + (ideal_ ? specular_reflectance(local.z, front) : Rgb(0));
    return ideal_sample(wo, to_world(reflect(local, up), front), false, reflected / static_cast<float>(choice.mirror));
  }
  u_lobe -= choice.mirror;
  if (u_lobe < choice.refraction) {
    const std::optional<Vec3d> beyond = ideal_transmission(local, front);
    if (!beyond) return std::nullopt;
    const Rgb through = transmitted_weight(local.z, front) / static_cast<float>(choice.refraction);
    return ideal_sample(wo, to_world(*beyond, front), true, through);
  }
  u_lobe -= choice.refraction;
  if (u_lobe < choice.facet) {
    const std::optional<Vec3d> wi = sample_facet(local, front, u_lobe / choice.facet, u);
    return wi ? spread_sample(wo, local, *wi, front, choice) : std::nullopt;
  }
  u_lobe -= choice.facet;
  const Vec3d matt = sample_cosine_hemisphere(u);
  if (choice.beyond > 0 && (u_lobe >= choice.diffuse || choice.diffuse == 0)) {
    return spread_sample(wo, local, mirrored_through_surface(matt), front, choice);
  }
  if (choice.diffuse == 0) return std::nullopt;
  return spread_sample(wo, local, matt, front, choice);
}

std::optional<BsdfSample> Bsdf::spread_sample(const Vec3d& wo, const Vec3d& local, const Vec3d& wi, bool front,
                                              const LobeChoice& choice) const {
  const Vec3d direction = to_world(wi, front);
  const std::optional<Pair> allowed = pair_of(wo, direction);
  if (!allowed || allowed->transmitted != (wi.z < 0)) return std::nullopt;
  const Pair pair{local, wi, front, wi.z < 0};
  if (choice.diffuse == 1 && material_.specular == 0) {  // Lambert: what is known needs no division
    return BsdfSample{direction, diffuse_colour_ * remaining_, wi.z / pi, false, false};
  }
  const double density = pdf(pair, choice);
  if (!(density > 0)) return std::nullopt;
  const Rgb weight = evaluate_lobes(pair, !ideal_, ideal_) * static_cast<float>(std::abs(wi.z) / density);
  return BsdfSample{direction, weight, density, false, pair.transmitted};
}

// Ideal rays

std::optional<Vec3d> Bsdf::ideal_transmission(const Vec3d& wo, bool from_front) const {
  if (!bends()) return -wo;
  return refract(wo, up, index_of(from_front), index_of(!from_front));
}

Rgb Bsdf::transmitted_weight(double cos_theta, bool from_front) const {
  return transparent_ * remaining_ * interface(cos_theta, from_front).transmitted;
}

SpecularSplit Bsdf::specular_split(const Vec3d& wo, double roughness_limit) const {
  SpecularSplit split;
  const bool front = glm::dot(wo, geometric_normal_) > 0;
  const Vec3d local = to_side(wo, front);
  if (!(local.z > horizon)) return split;
  const bool smooth = splits(roughness_limit);
  const Vec3d reflection = to_world(reflect(local, up), front);
  if (const std::optional<Pair> pair = pair_of(wo, reflection); pair && !pair->transmitted) {
    split.reflection_direction = reflection;
    split.reflected = material_.mirror;
    if (smooth && has_specular_) split.reflected += specular_reflectance(local.z, front);
  }
  if (transparent_ == 0 || !(smooth || ideal_transmission_)) return split;
  const std::optional<Vec3d> beyond = ideal_transmission(local, front);
  if (!beyond) return split;
  const Vec3d refraction = to_world(*beyond, front);
  if (const std::optional<Pair> pair = pair_of(wo, refraction); pair && pair->transmitted) {
    split.refraction_direction = refraction;
    split.refracted = transmitted_weight(local.z, front);
  }
  return split;
}

Rgb Bsdf::evaluate_unsplit(const Vec3d& wo, const Vec3d& wi, double roughness_limit) const {
  const std::optional<Pair> pair = pair_of(wo, wi);
  const bool smooth = splits(roughness_limit);
  return pair ? evaluate_lobes(*pair, !smooth, smooth) : Rgb(0);
}

Rgb Bsdf::diffuse_reflectance() const {
  if (material_.ior == 0) return diffuse_colour_ * remaining_ * static_cast<float>(1 - hiding_);
  return diffuse_colour_ * remaining_ * static_cast<float>(1 - layer_albedo(1, ideal_));
}

Rgb Bsdf::diffuse_albedo(const Vec3d& wo) const {
  const double cosine = std::min(1.0, std::abs(glm::dot(wo, frame_.normal)));
  const double below = material_.ior == 0 ? hiding_ : layer_albedo(cosine, ideal_);
  return diffuse_colour_ * remaining_ * static_cast<float>(1 - below);
}

Rgb Bsdf::share_of_base() const {
  return remaining_ * static_cast<float>(material_.ior == 0 ? 1 - hiding_ : open_mean_);
}

Bsdf Bsdf::without_base() const {
  Bsdf gloss = *this;
  gloss.diffuse_colour_ = Rgb(0);
  return gloss;
}

bool Bsdf::has_spread() const { return !is_black(diffuse_colour_) || (has_specular_ && !ideal_); }

}  // namespace penumbra
