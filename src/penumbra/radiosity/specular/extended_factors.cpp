#include "penumbra/radiosity/specular/extended_factors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/specular/specular_paths.h"

namespace penumbra {
namespace {

/// Emitting elements that make up more of the area than this are no lamps: their light is found by those that see it.
constexpr double most_lamp_area = 0.1;
constexpr double most_rays_a_lamp = 4e6;
constexpr std::size_t elements_a_step = 256;

/// An entry of a row to be: the column, its value in either half.
struct Entry {
  std::uint32_t column;
  Vec3d halves[2]{Vec3d(0), Vec3d(0)};
};

bool emits(const PatchMesh& mesh, std::size_t element) {
  return mesh.emission[3 * element] > 0 || mesh.emission[3 * element + 1] > 0 || mesh.emission[3 * element + 2] > 0;
}

/// The landings of a caster by element, ascending.
std::vector<Entry> by_element(const SpecularLandings& found) {
  std::vector<Entry> entries;
  for (std::size_t half = 0; half < 2; ++half) {
    for (const auto& landing : found.halves[half].landings) {
      entries.push_back({landing.element});
      entries.back().halves[half] = Vec3d(landing.weight);
    }
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.column < b.column; });
  std::size_t last = 0;
  for (std::size_t k = 1; k < entries.size(); ++k) {
    if (entries[k].column == entries[last].column) {
      for (int half = 0; half < 2; ++half) entries[last].halves[half] += entries[k].halves[half];
    } else {
      entries[++last] = entries[k];
    }
  }
  if (!entries.empty()) entries.resize(last + 1);
  return entries;
}

class Builder {
 public:
  Builder(const Scene& scene, const PatchMesh& elements, const SpecularElements& specular, const FactorRowSource& rows,
          const ExtendedFactorOptions& options)
      : scene_(scene),
        elements_(elements),
        specular_(specular),
        options_(options),
        paths_(scene, elements, options.front_sides_only, options.seed) {
    find_sights(rows);
    choose_rays();
  }

  ExtendedFactors build() {
    const std::size_t n = elements_.surface_count();
    result_.transport.leaving.assign(3 * n, 0.0F);
    sky_.assign(3 * n, 0.0);
    std::vector<std::vector<Entry>> cast(n);
    for (std::size_t first = 0; first < n && !stopped(static_cast<double>(first) / static_cast<double>(n));
         first += elements_a_step) {
      cast_from(first, std::min(n, first + elements_a_step), cast);
    }
    assemble(cast);
    if (!result_.partial) shoot_lights();
    add_sky();
    return std::move(result_);
  }

 private:
  /// What each element that light can end on sees of specular ones, by reciprocity from their rows.
  void find_sights(const FactorRowSource& rows) {
    sights_.resize(elements_.surface_count());
    FactorRow row;
    for (std::uint32_t m = 0; m < elements_.surface_count(); ++m) {
      if (!specular_.specular[m]) continue;
      rows.read(m, row);
      for (std::size_t k = 0; k < row.columns.size(); ++k) {
        const std::uint32_t i = row.columns[k];
        const double factor = row.factors[k] * elements_.areas[m] / elements_.areas[i];
        if (!specular_.only_specular[i] && factor > 0) sights_[i].push_back({m, factor});
      }
    }
  }

  /// Lamps share as many rays as all others together send, by the power that they send to mirrors and glass.
  void choose_rays() {
    const std::size_t n = elements_.surface_count();
    rays_.assign(n, 0);
    lamps_.assign(n, false);
    double all = 0, lamps = 0, power = 0;
    std::size_t seeing = 0;
    std::vector<double> sent(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      if (sights_[i].empty()) continue;
      ++seeing;
      rays_[i] = options_.rays;
      all += elements_.areas[i];
      if (!emits(elements_, i)) continue;
      lamps += elements_.areas[i];
      const double e = elements_.emission[3 * i] + elements_.emission[3 * i + 1] + elements_.emission[3 * i + 2];
      for (const SpecularSight& s : sights_[i]) sent[i] += elements_.areas[i] * e * s.factor;
      power += sent[i];
    }
    budget_ = static_cast<double>(options_.rays) * static_cast<double>(seeing);
    if (!(lamps > 0) || lamps > most_lamp_area * all) return;
    for (std::size_t i = 0; i < n; ++i) {
      if (!(sent[i] > 0)) continue;
      lamps_[i] = true;
      rays_[i] =
          static_cast<int>(std::clamp(budget_ * sent[i] / power, static_cast<double>(options_.rays), most_rays_a_lamp));
    }
  }

  bool stopped(double done) {
    options_.progress.tell("mirrors and glass", done);
    result_.partial = result_.partial || options_.progress.stop_requested();
    return result_.partial;
  }

  void cast_from(std::size_t first, std::size_t last, std::vector<std::vector<Entry>>& cast) {
    std::vector<std::uint64_t> rays(last - first, 0);
    const Vec3d strength = light_strength(scene_, LightIrradiance::environment);
    parallel_for(last - first, 1, [&](std::size_t k, std::size_t) {
      const std::size_t i = first + k;
      const SpecularLandings found = paths_.cast(static_cast<std::uint32_t>(i), sights_[i], rays_[i]);
      cast[i] = by_element(found);
      for (int b = 0; b < 3; ++b) {
        const std::size_t at = 3 * i + static_cast<std::size_t>(b);
        result_.transport.leaving[at] = static_cast<float>(0.5 * (found.halves[0].left[b] + found.halves[1].left[b]));
        if (strength[b] > 0) sky_[at] = 0.5 * (found.halves[0].sky[b] + found.halves[1].sky[b]) / strength[b];
      }
      rays[k] = found.rays;
    });
    for (const std::uint64_t count : rays) result_.rays += count;
  }

  /// Rows as their elements see them; what lamps shot is turned round, A_i X_ij = A_j X_ji.
  void assemble(std::vector<std::vector<Entry>>& cast) {
    const std::size_t n = elements_.surface_count();
    std::vector<std::vector<Entry>> shot(n);
    for (std::uint32_t j = 0; j < n; ++j) {
      if (!lamps_[j]) continue;
      for (const Entry& e : cast[j]) {
        if (specular_.only_specular[e.column]) continue;
        const double turn = elements_.areas[j] / elements_.areas[e.column];
        shot[e.column].push_back({j, {turn * e.halves[0], turn * e.halves[1]}});
      }
    }
    SpecularTransport& t = result_.transport;
    for (std::uint32_t i = 0; i < n; ++i) {
      std::vector<Entry> row = std::move(shot[i]);
      for (const Entry& e : cast[i]) {
        if (!lamps_[e.column]) row.push_back(e);
      }
      std::sort(row.begin(), row.end(), [](const Entry& a, const Entry& b) { return a.column < b.column; });
      for (const Entry& e : row) {
        t.columns.push_back(e.column);
        for (int b = 0; b < 3; ++b) {
          t.values.push_back(static_cast<float>(0.5 * (e.halves[0][b] + e.halves[1][b])));
          t.deviations.push_back(static_cast<float>(0.5 * (e.halves[0][b] - e.halves[1][b])));
        }
      }
      t.offsets.push_back(t.columns.size());
      std::vector<Entry>().swap(cast[i]);
    }
  }

  void shoot_lights() {
    std::vector<std::uint32_t> targets;
    for (std::uint32_t m = 0; m < elements_.surface_count(); ++m) {
      if (specular_.specular[m]) targets.push_back(m);
    }
    const LightSampler& lights = paths_.lights();
    std::vector<std::size_t> punctual;
    for (std::size_t l = 0; l < lights.light_count(); ++l) {
      if (lights.light(l).kind == LightSampler::Kind::punctual) punctual.push_back(l);
    }
    const double each = std::clamp(budget_ / static_cast<double>(std::max<std::size_t>(1, punctual.size())),
                                   static_cast<double>(options_.rays), most_rays_a_lamp);
    std::vector<std::pair<LightIrradiance, std::uint64_t>> found(punctual.size());
    parallel_for(punctual.size(), 1, [&](std::size_t k, std::size_t) {
      const SpecularLandings shot = paths_.shoot(punctual[k], targets, static_cast<int>(each));
      found[k].first = {lights.light(punctual[k]).index, irradiance_by(shot), Vec3d(0)};
      found[k].second = shot.rays;
    });
    for (auto& [light, rays] : found) {
      if (!light.unit.empty()) result_.lights.push_back(std::move(light));
      result_.rays += rays;
    }
  }

  [[nodiscard]] std::vector<double> irradiance_by(const SpecularLandings& shot) const {
    std::vector<double> unit;
    for (const Entry& e : by_element(shot)) {
      unit.resize(3 * elements_.surface_count(), 0.0);
      for (int b = 0; b < 3; ++b) {
        unit[3 * e.column + static_cast<std::size_t>(b)] =
            0.5 * (e.halves[0][b] + e.halves[1][b]) / elements_.areas[e.column];
      }
    }
    return unit;
  }

  void add_sky() {
    if (std::all_of(sky_.begin(), sky_.end(), [](double h) { return h == 0; })) return;
    result_.lights.push_back({LightIrradiance::environment, std::move(sky_), Vec3d(0)});
  }

  const Scene& scene_;
  const PatchMesh& elements_;
  const SpecularElements& specular_;
  const ExtendedFactorOptions& options_;
  SpecularPaths paths_;
  std::vector<std::vector<SpecularSight>> sights_;  // by element
  std::vector<int> rays_;                           // by element
  std::vector<bool> lamps_;                         // by element: its light is shot
  std::vector<double> sky_;
  double budget_ = 0;
  ExtendedFactors result_;
};

}  // namespace

ExtendedFactors make_extended_factors(const Scene& scene, const PatchMesh& elements, const SpecularElements& specular,
                                      const FactorRowSource& rows, const ExtendedFactorOptions& options) {
  if (options.rays < 2) throw std::invalid_argument("extended form factors need 2 rays or more from each element");
  return Builder(scene, elements, specular, rows, options).build();
}

}  // namespace penumbra
