#include "penumbra/radiosity/pipeline/receiving_elements.h"

#include <algorithm>
#include <map>
#include <utility>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/direct_irradiance.h"
#include "penumbra/radiosity/form_factors/auto.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/radiosity/pipeline/patch_exchange.h"
#include "penumbra/radiosity/solvers/energy_balance.h"

namespace penumbra {
namespace {

constexpr std::uint32_t none = 0xffffffffU;
/// While elements change a rough survey will do: see AutoFormFactors.
constexpr std::size_t clusters_surveyed_meanwhile = 4;

}  // namespace

struct ReceivingElements::Fresh {
  std::vector<std::uint32_t> elements;
  std::vector<std::uint32_t> from;  ///< of each: the element it is a piece of, by its number before the cut
  PatchMesh mesh;                   ///< these elements alone
};

ReceivingElements::ReceivingElements(const Scene& scene, const PatchMesh& patches,
                                     std::shared_ptr<const OccluderPolygons> occluders, const AdaptiveCells& cells,
                                     const Options& options, const Progress& progress)
    : scene_(scene), patches_(patches), occluders_(std::move(occluders)), options_(options), progress_(progress) {
  follow(cells, {});
}

void ReceivingElements::follow(const AdaptiveCells& cells, std::span<const double> sent) {
  std::vector<std::uint32_t> pieces(cells.cells().size(), 0);  // of each cell's origin
  for (const AdaptiveCell& c : cells.cells()) ++pieces[c.origin];
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> old;  // by patch and cell
  for (std::uint32_t e = 0; e < size(); ++e) old[{parent_[e], cell_of_[e]}] = e;
  std::vector<double> old_power = std::move(received_);
  for (std::size_t k = 0; k < old_power.size(); ++k) old_power[k] *= problem_.areas[k / 3];

  AdaptiveCells::Elements made = cells.elements();
  RadiosityProblem before = std::exchange(problem_, make_radiosity_problem(made.mesh));
  problem_.light_power = before.light_power;
  if (!before.irradiance.empty()) problem_.irradiance.assign(problem_.emission.size(), 0);
  received_.assign(problem_.emission.size(), 0);
  std::vector<double> arrived(problem_.element_count(), 0);
  Fresh fresh;
  ElementBuilder pieces_cut(patches_);
  for (std::uint32_t k = 0; k < made.parent.size(); ++k) {
    const std::uint32_t origin = cells.cells()[made.cell[k]].origin;
    const auto found = old.find({made.parent[k], origin});
    const std::uint32_t e = found == old.end() ? none : found->second;
    if (e == none || pieces[origin] > 1) {
      fresh.elements.push_back(k);
      fresh.from.push_back(e);
      pieces_cut.add(made.parent[k], made.mesh.polygon(k));
      continue;
    }
    for (std::size_t b = 0; b < 3; ++b) {
      problem_.reflectance[3 * k + b] = before.reflectance[3 * e + b];
      problem_.emission[3 * k + b] = before.emission[3 * e + b];
      if (!before.irradiance.empty()) problem_.irradiance[3 * k + b] = before.irradiance[3 * e + b];
      received_[3 * k + b] = old_power[3 * e + b] / problem_.areas[k];
    }
    arrived[k] = arrived_[e];
  }
  fresh.mesh = std::move(pieces_cut).finish();
  mesh_ = std::move(made.mesh);
  parent_ = std::move(made.parent);
  cell_of_ = std::move(made.cell);
  arrived_ = std::move(arrived);
  if (fresh.elements.empty()) return;
  paint_and_light(fresh);
  share_out(fresh, old_power, sent);
}

/// What new elements reflect, emit and receive from lights that are no elements.
void ReceivingElements::paint_and_light(const Fresh& fresh) {
  PatchMesh painted = fresh.mesh;
  paint_elements(scene_, MeshingOptions{}.shape_segments, painted);
  DirectIrradiance direct;
  const bool first = fresh.from.front() == none;
  if (first || !problem_.irradiance.empty()) {
    direct = direct_irradiance(scene_, painted, {.seed = options_.seed, .progress = progress_});
  }
  if (first) {
    problem_.light_power = std::move(direct.light_power);
    if (!direct.irradiance.empty()) problem_.irradiance.assign(problem_.emission.size(), 0);
  }
  for (std::size_t n = 0; n < fresh.elements.size(); ++n) {
    const std::uint32_t k = fresh.elements[n];
    const bool black = options_.front_sides_only && mesh_.surfaces[k].back;
    for (std::size_t b = 0; b < 3; ++b) {
      problem_.reflectance[3 * k + b] = black ? 0 : painted.reflectance[3 * n + b];
      problem_.emission[3 * k + b] = black ? 0 : painted.emission[3 * n + b];
      if (!direct.irradiance.empty()) problem_.irradiance[3 * k + b] = direct.irradiance[3 * n + b];
    }
  }
  mesh_.reflectance = problem_.reflectance;
  mesh_.emission = problem_.emission;
}

/// The pieces of an element share what it had received as the patches' light falls on them; evenly where none does.
void ReceivingElements::share_out(const Fresh& fresh, std::span<const double> old_power, std::span<const double> sent) {
  if (old_power.empty()) return;
  gather_from_patches(fresh, sent);
  std::vector<double> found(old_power.size(), 0), area(old_power.size() / 3, 0);
  for (std::size_t n = 0; n < fresh.elements.size(); ++n) {
    const std::uint32_t k = fresh.elements[n], e = fresh.from[n];
    area[e] += problem_.areas[k];
    for (std::size_t b = 0; b < 3; ++b) found[3 * e + b] += problem_.areas[k] * received_[3 * k + b];
  }
  for (std::size_t n = 0; n < fresh.elements.size(); ++n) {
    const std::uint32_t k = fresh.elements[n], e = fresh.from[n];
    for (std::size_t b = 0; b < 3; ++b) {
      double& value = received_[3 * k + b];
      const double all = found[3 * e + b], had = old_power[3 * e + b];
      value = all > 0 ? value * (had / all) : had / area[e];
    }
  }
}

/// New elements gather from all patches what they have sent until now.
void ReceivingElements::gather_from_patches(const Fresh& fresh, std::span<const double> sent) {
  std::vector<std::uint32_t> senders;
  for (std::uint32_t p = 0; p < patches_.patch_count(); ++p) {
    if (sent[3 * p] != 0 || sent[3 * p + 1] != 0 || sent[3 * p + 2] != 0) senders.push_back(p);
  }
  if (senders.empty()) return;
  const PatchExchange between(patches_, senders, fresh.mesh, occluders_, options_.factors, clusters_surveyed_meanwhile);
  parallel_for(fresh.elements.size(), 8, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) {
      const std::uint32_t e = fresh.elements[n];
      const PatchRow row = between.from_element(n);
      for (std::size_t k = 0; k < row.patches.size(); ++k) {
        const double factor = row.exchanges[k] / problem_.areas[e];
        for (std::size_t b = 0; b < 3; ++b) received_[3 * e + b] += factor * sent[3 * senders[row.patches[k]] + b];
      }
    }
  });
}

void ReceivingElements::light_again() {
  if (problem_.irradiance.empty()) return;
  DirectIrradiance direct = direct_irradiance(scene_, mesh_, {.seed = options_.seed, .progress = progress_});
  problem_.irradiance = std::move(direct.irradiance);
  problem_.light_power = std::move(direct.light_power);
}

bool ReceivingElements::gather(std::span<const double> sent, const Progress& progress) {
  AutoFormFactors::Settings settings;
  settings.occluders = occluders_;
  const AutoFormFactors method(mesh_, options_.factors, settings);
  std::vector<double> power(received_.size(), 0);
  const auto add = [&](const FactorBlock& block) {
    for (const PairFactor& pair : block.pairs) {
      for (std::size_t b = 0; b < 3; ++b) {
        power[3 * pair.i + b] += pair.exchange * sent[3 * pair.j + b];
        power[3 * pair.j + b] += pair.exchange * sent[3 * pair.i + b];
      }
    }
  };
  if (!visit_factors(method, add, {.report = {}, .stop = progress.stop})) return false;
  // No more arrives than was sent, whatever the factors' errors.
  double arrives = 0, leaves = 0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    arrives += power[k];
    leaves += problem_.areas[k / 3] * sent[k];
  }
  const double share = arrives > leaves && arrives > 0 ? leaves / arrives : 1;
  for (std::size_t k = 0; k < power.size(); ++k) received_[k] = share * power[k] / problem_.areas[k / 3];
  return true;
}

double ReceivingElements::receive(std::uint32_t element, double exchange, std::span<const double> radiosity) {
  double most = 0, power = 0;
  for (std::size_t b = 0; b < 3; ++b) {
    const double arrives = exchange * radiosity[b];
    received_[3 * element + b] += arrives / problem_.areas[element];
    power += arrives;
    most = std::max(most, arrives);
  }
  arrived_[element] += most / problem_.areas[element];
  return power;
}

std::vector<std::uint32_t> ReceivingElements::brightened_cells(double enough) const {
  std::vector<std::uint32_t> which;
  for (std::size_t e = 0; e < arrived_.size(); ++e) {
    if (arrived_[e] > enough) which.push_back(cell_of_[e]);
  }
  std::sort(which.begin(), which.end());
  which.erase(std::unique(which.begin(), which.end()), which.end());
  return which;
}

std::vector<double> ReceivingElements::irradiance() const {
  std::vector<double> all = received_;
  for (std::size_t k = 0; k < problem_.irradiance.size(); ++k) all[k] += problem_.irradiance[k];
  return all;
}

std::vector<double> ReceivingElements::radiosity() const {
  std::vector<double> all = irradiance();
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = problem_.emission[k] + problem_.reflectance[k] * all[k];
  return all;
}

double ReceivingElements::received_power() const { return power_of(problem_, received_); }

}  // namespace penumbra
