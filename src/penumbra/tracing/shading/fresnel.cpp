#include "penumbra/tracing/shading/fresnel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

double square(double x) { return x * x; }

/// Both interfaces' reflections of one polarisation summed as a geometric series; `t` is what one crossing leaves.
PlateShares sum_reflections(double r, double t) {
  const double echo = r * t * t;  // one way back through the plate, reflected at the far side
  const double series = 1 - r * echo;
  if (series <= 0) return {1, 0};  // grazing incidence: nothing enters
  return {r + square(1 - r) * echo / series, square(1 - r) * t / series};
}

}  // namespace

Polarised fresnel_dielectric(double cos_theta, double n_from, double n_to) {
  const double eta = n_to / n_from;
  const double cos_2 = square(eta) - 1 + square(cos_theta);  // (eta cos of refraction)^2
  if (cos_2 <= 0) return {1, 1};
  const double eta_cos_t = std::sqrt(cos_2);
  const double s = (cos_theta - eta_cos_t) / (cos_theta + eta_cos_t);
  const double p = (square(eta) * cos_theta - eta_cos_t) / (square(eta) * cos_theta + eta_cos_t);
  return {square(s), square(p)};
}

Polarised fresnel_conductor(double cos_theta, double eta, double k) {
  const double cos_2 = square(cos_theta);
  const double sin_2 = 1 - cos_2;
  const double t0 = square(eta) - square(k) - sin_2;
  const double sum = std::hypot(t0, 2 * eta * k);  // a^2 + b^2
  const double a = std::sqrt(std::max(0.0, (sum + t0) / 2));
  const double middle = 2 * a * cos_theta;
  const double s = (sum + cos_2 - middle) / (sum + cos_2 + middle);
  const double high = cos_2 * sum + square(sin_2);
  const double low = middle * sin_2;
  return {s, s * (high - low) / (high + low)};
}

double fresnel_schlick(double cos_theta, double f0, double f90) {
  const double x = std::clamp(1 - cos_theta, 0.0, 1.0);
  return f0 + (f90 - f0) * square(square(x)) * x;
}

double normal_reflectance(double n_from, double n_to) { return square((n_to - n_from) / (n_to + n_from)); }

double fresnel_diffuse_external(double n) {
  if (n - 1 < 1e-6) return 0;  // of the order of n - 1, and 0/0 in the closed form
  const double n2 = n * n;
  const double n4 = n2 * n2;
  return 0.5 + (n - 1) * (3 * n + 1) / (6 * square(n + 1)) +
         n2 * square(n2 - 1) / (square(n2 + 1) * (n2 + 1)) * std::log((n - 1) / (n + 1)) -
         2 * n * n2 * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
         8 * n4 * (n4 + 1) / ((n2 + 1) * square(n4 - 1)) * std::log(n);
}

double fresnel_diffuse_internal(double n) { return 1 - (1 - fresnel_diffuse_external(n)) / square(n); }

std::optional<Vec3d> refract(const Vec3d& w, const Vec3d& normal, double n_from, double n_to) {
  const double ratio = n_from / n_to;
  const double cos_from = glm::dot(w, normal);
  // Not 1 - cos^2: that loses the small sines of steep rays.
  const double sin_2_to = square(ratio) * length_squared(w - cos_from * normal);
  if (sin_2_to >= 1) return std::nullopt;
  const double cos_to = std::sqrt(1 - sin_2_to);
  return glm::normalize((ratio * cos_from - cos_to) * normal - ratio * w);
}

PlateShares fresnel_plate(double cos_theta, double n, double optical_depth) {
  const Polarised r = fresnel_dielectric(cos_theta, 1, n);
  const double cos_inside = std::sqrt(1 - (1 - square(cos_theta)) / square(n));
  const double crossing = std::exp(-optical_depth / std::max(cos_inside, std::numeric_limits<double>::min()));
  const PlateShares s = sum_reflections(r.s, crossing);
  const PlateShares p = sum_reflections(r.p, crossing);
  return {0.5 * (s.reflectance + p.reflectance), 0.5 * (s.transmittance + p.transmittance)};
}

double beer_lambert(double sigma, double distance) {
  if (sigma == 0 || distance == 0) return 1;  // infinity x 0 is meant to be 0
  return std::exp(-sigma * distance);
}

Vec3d attenuation_coefficient(const Rgb& colour, double attenuation_distance) {
  if (std::isinf(attenuation_distance)) return Vec3d(0);
  Vec3d sigma(0);
  for (int band = 0; band < 3; ++band) {
    const double left = std::clamp(static_cast<double>(colour[band]), 0.0, 1.0);
    if (left < 1) sigma[band] = -std::log(left) / attenuation_distance;
  }
  return sigma;
}

Rgb volume_transmittance(const Rgb& colour, double attenuation_distance, double distance) {
  const Vec3d sigma = attenuation_coefficient(colour, attenuation_distance);
  return Rgb(Vec3d(beer_lambert(sigma.x, distance), beer_lambert(sigma.y, distance), beer_lambert(sigma.z, distance)));
}

}  // namespace penumbra
