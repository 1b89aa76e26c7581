#include "penumbra/radiosity/pipeline/spectral_radiosity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "penumbra/math/cie_colour.h"
#include "penumbra/math/uplift.h"

namespace penumbra {
namespace {

constexpr int points = 16;  // of a band, midpoint rule

// What red, green and blue are to a band, and it to them.
struct Band {
  Vec3d reflectance{0};  // of red, green and blue, as white light sees them
  Vec3d emission{0};     // W of 1 W of red, green and blue
  Vec3d colour{0};       // of 1 W of white light
};

Band band_between(double lower, double upper) {
  Band band;
  double white = 0;
  Vec3d plain(0), plain_colour(0);
  const double step = (upper - lower) / points;
  for (int k = 0; k < points; ++k) {
    const double nm = lower + (k + 0.5) * step;
    const double light = white_radiance(nm) * step;
    white += light;
    band.emission += light * uplift_basis(nm);
    band.colour += light * rec709_matching(nm);
    plain += uplift_basis(nm) / double{points};
    plain_colour += rec709_matching(nm) / double{points};
  }
  band.reflectance = white > 0 ? band.emission / white : plain;
  band.colour = white > 0 ? band.colour / white : plain_colour;
  return band;
}

std::vector<Band> bands_between(const std::vector<double>& edges) {
  std::vector<Band> bands;
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) bands.push_back(band_between(edges[b], edges[b + 1]));
  return bands;
}

std::vector<double> edges_of(const Scene& scene, double widest) {
  std::vector<double> wanted{shortest_visible, longest_visible};
  for (const Material& m : scene.materials) {
    if (m.fluorescence) wanted.insert(wanted.end(), m.fluorescence->edges.begin(), m.fluorescence->edges.end());
    if (m.emission_spectrum) {
      wanted.insert(wanted.end(), m.emission_spectrum->edges.begin(), m.emission_spectrum->edges.end());
    }
  }
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::vector<double> edges{wanted.front()};
  for (std::size_t k = 1; k < wanted.size(); ++k) {
    const double from = wanted[k - 1], width = wanted[k] - from;
    const int parts = std::max(1, static_cast<int>(std::ceil(width / widest - 1e-9)));
    for (int i = 1; i <= parts; ++i) edges.push_back(i == parts ? wanted[k] : from + width * i / parts);
  }
  return edges;
}

double middle(const std::vector<double>& edges, std::size_t band) { return (edges[band] + edges[band + 1]) / 2; }

// A dye's matrix over finer bands: what it radiates again is even within each of its own.
std::vector<double> matrix_over(const Fluorescence& dye, const std::vector<double>& edges) {
  const std::size_t bands = edges.size() - 1;
  std::vector<double> matrix(bands * bands, 0.0);
  for (std::size_t out = 0; out < bands; ++out) {
    const std::size_t dye_out = band_of(dye.edges, middle(edges, out));
    if (dye_out == dye.bands()) continue;
    const double share = (edges[out + 1] - edges[out]) / dye.width(dye_out);
    for (std::size_t in = 0; in < out; ++in) {
      const std::size_t dye_in = band_of(dye.edges, middle(edges, in));
      if (dye_in < dye_out) matrix[out * bands + in] = share * dye.at(dye_out, dye_in);
    }
  }
  return matrix;
}

/// The materials of a scene's faces, which surfaces name by their numbers over the whole scene.
class FaceMaterials {
 public:
  explicit FaceMaterials(const Scene& scene) : scene_(scene) {
    std::size_t faces = 0;
    for (const Instance& instance : scene.instances) {
      first_face_.push_back(faces);
      faces += scene.meshes[instance.mesh].face_count();
    }
    for (const Mesh& mesh : scene.meshes) materials_.push_back(of_faces(mesh));
  }

  [[nodiscard]] const Material& of(const PatchSurface& surface) const {
    if (surface.object >= scene_.instances.size()) {
      return scene_.materials[scene_.shapes[surface.object - scene_.instances.size()].material];
    }
    const auto& materials = materials_[scene_.instances[surface.object].mesh];
    return scene_.materials[materials[surface.face - first_face_[surface.object]]];
  }

 private:
  // A face's material is that of its first triangle.
  static std::vector<std::uint32_t> of_faces(const Mesh& mesh) {
    std::vector<std::uint32_t> materials(mesh.face_count());
    for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
      materials[mesh.face_offsets.empty() ? t : mesh.face_of_triangle[t]] = mesh.material_of(t);
    }
    return materials;
  }

  const Scene& scene_;
  std::vector<std::size_t> first_face_;                // by instance
  std::vector<std::vector<std::uint32_t>> materials_;  // by mesh
};

std::vector<double> spread(const std::vector<double>& rgb, const std::vector<Band>& bands, Vec3d Band::*part) {
  std::vector<double> values;
  values.reserve(rgb.size() / 3 * bands.size());
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    const Vec3d colour(rgb[i], rgb[i + 1], rgb[i + 2]);
    for (const Band& band : bands) values.push_back(std::max(0.0, dot(colour, band.*part)));
  }
  return values;
}

// Lamps with spectra and dyes, for which the colours only stand.
void set_spectra(const Scene& scene, const RadiositySetup& setup, SpectralProblem& made) {
  const FaceMaterials materials(scene);
  std::vector<std::uint32_t> matrix_of_material(scene.materials.size(), Reradiation::none);
  made.reradiation.matrix_of.assign(setup.mesh.surface_count(), Reradiation::none);
  for (std::size_t i = 0; i < setup.mesh.surface_count(); ++i) {
    const PatchSurface& surface = setup.mesh.surfaces[i];
    if (surface.back && setup.front_sides_only) continue;
    const Material& m = materials.of(surface);
    const auto number = static_cast<std::size_t>(&m - scene.materials.data());
    if (m.fluorescence && matrix_of_material[number] == Reradiation::none) {
      matrix_of_material[number] = static_cast<std::uint32_t>(made.reradiation.matrices.size());
      made.reradiation.matrices.push_back(matrix_over(*m.fluorescence, made.edges));
    }
    if (m.fluorescence) made.reradiation.matrix_of[i] = matrix_of_material[number];
    for (std::size_t b = 0; b < made.bands(); ++b) {
      const double nm = middle(made.edges, b);
      if (m.fluorescence && band_of(m.fluorescence->edges, nm) < m.fluorescence->bands()) {
        made.problem.reflectance[i * made.bands() + b] = m.fluorescence->reflectance(nm);
      }
      if (!m.emission_spectrum) continue;
      const bool shines = !surface.back || m.double_sided;
      made.problem.emission[i * made.bands() + b] =
          shines ? std::numbers::pi * m.emission_spectrum->at(nm) * (made.edges[b + 1] - made.edges[b]) : 0;
    }
  }
}

}  // namespace

SpectralProblem make_spectral_problem(const Scene& scene, const RadiositySetup& setup, double widest_band) {
  if (!(widest_band > 0)) throw std::invalid_argument("the widest band should be above 0 nm");
  if (setup.problem.specular || !setup.problem.specular_irradiance.empty()) {
    throw std::invalid_argument("light by way of mirrors and glass is followed in red, green and blue only");
  }
  SpectralProblem made;
  made.edges = edges_of(scene, widest_band);
  const std::vector<Band> bands = bands_between(made.edges);
  made.problem.bands = bands.size();
  made.problem.areas = setup.problem.areas;
  made.problem.reflectance = spread(setup.problem.reflectance, bands, &Band::reflectance);
  made.problem.emission = spread(setup.problem.emission, bands, &Band::emission);
  made.problem.irradiance = spread(setup.problem.irradiance, bands, &Band::emission);
  made.problem.light_power = spread(setup.problem.light_power, bands, &Band::emission);
  for (double& share : made.problem.reflectance) share = std::min(share, 1.0);  // rounding
  set_spectra(scene, setup, made);
  return made;
}

std::vector<double> to_rgb(const std::vector<double>& edges, const std::vector<double>& values) {
  const std::vector<Band> bands = bands_between(edges);
  std::vector<double> colours(values.size() / bands.size() * 3);
  for (std::size_t i = 0; i < values.size() / bands.size(); ++i) {
    Vec3d colour(0);
    for (std::size_t b = 0; b < bands.size(); ++b) colour += values[i * bands.size() + b] * bands[b].colour;
    for (std::size_t c = 0; c < 3; ++c) colours[3 * i + c] = colour[static_cast<int>(c)];
  }
  return colours;
}

SpectralRadiosity solve_spectral(const Scene& scene, const RadiositySetup& setup, const SolverOptions& options) {
  if (setup.row_method || setup.refining) {
    throw std::invalid_argument("bands of wavelength need a matrix of form factors; shooting keeps none here");
  }
  const SpectralProblem made = make_spectral_problem(scene, setup);
  SpectralRadiosity result;
  result.edges = made.edges;
  result.bands = solve_with_reradiation(setup.solver, made.problem, made.reradiation, setup.factors, options);
  result.bands.partial = result.bands.partial || setup.partial;
  result.rgb.solution = result.bands;
  result.rgb.solution.radiosity = to_rgb(made.edges, result.bands.radiosity);
  result.rgb.solution.irradiance = to_rgb(made.edges, result.bands.irradiance);
  return result;
}

}  // namespace penumbra
