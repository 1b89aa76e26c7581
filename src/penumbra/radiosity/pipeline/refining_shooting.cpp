#include "penumbra/radiosity/pipeline/refining_shooting.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "penumbra/math/bounds.h"
#include "penumbra/math/polygon.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/direct_irradiance.h"
#include "penumbra/radiosity/form_factors/auto.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/meshing/adaptive_cells.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/face_cells.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/polygon_division.h"
#include "penumbra/radiosity/meshing/shadow_lines.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/radiosity/pipeline/patch_exchange.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "penumbra/radiosity/solvers/shooting.h"
#include "penumbra/radiosity/solvers/solver_course.h"

namespace penumbra {
namespace {

constexpr std::size_t elements_a_patch = 8;
constexpr int shape_segments = 32;
/// Of the scene's size.
constexpr double shortest_edge = 1.0 / 2000;
/// Elements are looked at when there is room for this share more of them.
constexpr double least_growth = 1.0 / 32;
/// When no more than this share of all light is still to come, elements are not refined any further.
constexpr double settled = 0.02;
/// Factors that are kept, since patches shoot several times (12 bytes each).
constexpr std::size_t most_kept = 4000000;
/// While elements change a rough survey will do: see AutoFormFactors.
constexpr std::size_t clusters_surveyed_meanwhile = 4;
/// Reflectances above are taken for this where the light still to come is guessed.
constexpr double most_reflective = 0.9;

/// The input polygons, with what their textures reflect and emit on average.
MadePatchMesh painted_faces(const Scene& scene) {
  MadePatchMesh made = make_element_faces(scene, PatchSides::both, shape_segments);
  paint_elements(scene, shape_segments, made.mesh);
  return made;
}

/// The faces cut into cells, also along lines where light jumps, so that what lies under a box is no part of what
/// shines beside it; a cell's back follows its front.
PatchMesh make_patches(const PatchMesh& faces, std::span<const ShadowLine> lines, double size, double least_size,
                       std::vector<std::uint32_t>& face_of) {
  const AdaptiveCells plates(faces, 1, 0);
  std::vector<FaceCells> cells;
  for (const AdaptiveCells::Plate& plate : plates.plates()) {
    std::vector<FaceCells::Cell> of_plate;
    divide_polygon(faces.polygon(plate.front), size,
                   [&](std::span<const Vec3d> cell) { of_plate.emplace_back(cell.begin(), cell.end()); });
    cells.emplace_back(std::move(of_plate));
  }
  for (const ShadowLine& line : lines) {
    if (line.degree > 0) continue;
    cells[plates.plate_of(line.patch)].cut_along(line.ends[0], line.ends[1], faces.normals[line.patch], least_size);
  }
  ElementBuilder builder(faces);
  std::vector<Vec3d> turned;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto [front, back] = plates.plates()[k];
    for (const FaceCells::Cell& cell : cells[k].cells()) {
      builder.add(front, cell);
      face_of.push_back(front);
      if (back == AdaptiveCells::none) continue;
      turned.assign(cell.rbegin(), cell.rend());
      builder.add(back, turned);
      face_of.push_back(back);
    }
  }
  return std::move(builder).finish();
}

double scene_size(const PatchMesh& faces) {
  Bounds all;
  for (const Vec3d& v : faces.vertices) all.grow(v);
  return faces.vertices.empty() ? 1 : length(all.upper - all.lower);
}

double patch_size(const PatchMesh& faces, const RefiningShootingOptions& options) {
  if (options.element_size > 0) return options.element_size;
  return size_for_count(faces, std::max<std::size_t>(1, options.element_count / elements_a_patch));
}

}  // namespace

struct RefiningShooting::Impl {
  Impl(const Scene& the_scene, const RefiningShootingOptions& the_options, const Progress& the_progress);

  void cut_along_shadow_lines();
  void refine_for_points();
  void take_elements(AdaptiveCells::Elements made);
  void receive_what_was_sent(const std::vector<std::uint32_t>& fresh, const PatchMesh& children);
  void settle();
  void weigh();
  void shoot(const std::vector<std::uint32_t>& shooters);
  void refine();
  void look();
  void refine_elements(std::size_t most);
  [[nodiscard]] std::vector<std::uint32_t> brightened_cells() const;
  [[nodiscard]] std::size_t allowance() const;
  [[nodiscard]] std::vector<double> irradiance() const;
  [[nodiscard]] std::vector<double> radiosity() const;
  [[nodiscard]] std::vector<double> unshot_of_elements() const;
  [[nodiscard]] RadiositySolution take();

  const Scene& scene;
  RefiningShootingOptions options;
  Progress progress;
  MadePatchMesh faces;
  LampIrradiance light;
  std::vector<ShadowLine> lines;
  std::vector<std::uint32_t> face_of;  // of each patch
  PatchMesh patches;
  std::shared_ptr<const OccluderPolygons> occluders;
  AdaptiveCells cells;
  std::size_t begun = 0, most_cells = 0;

  PatchMesh elements;
  RadiosityProblem problem;
  std::vector<std::uint32_t> parent, cell_of;  // of each element: patch and cell
  std::vector<double> received;                // from patches, W/m^2, [element * 3 + band]
  std::vector<double> arrived;                 // of it since elements were looked at last, per element, largest band
  bool refines = true;

  std::vector<double> sent;    // S, W/m^2, [patch * 3 + band]
  std::vector<double> unshot;  // W/m^2, [patch * 3 + band]; may be a little negative where elements were split
  std::vector<double> energy;  // unshot, W, per patch
  std::vector<Lamp> pending;   // shooters whose light was not looked at yet
  std::unique_ptr<PatchExchange> exchange;  // all patches to all elements; none: the elements changed
  std::map<std::uint32_t, PatchRow> kept;
  std::size_t kept_factors = 0;
  double sent_power = 0, unshot_power = 0, escaped = 0;  // W
  double residual_bound = 0, largest_source = 0;         // W/m^2
  double mean_reflectance = 0;
};

RefiningShooting::Impl::Impl(const Scene& the_scene, const RefiningShootingOptions& the_options,
                             const Progress& the_progress)
    : scene(the_scene),
      options(the_options),
      progress(the_progress),
      faces(painted_faces(the_scene)),
      light(the_scene, faces.mesh),
      lines(by_importance(find_shadow_lines(light))),
      patches(make_patches(faces.mesh, lines, patch_size(faces.mesh, the_options),
                           shortest_edge * scene_size(faces.mesh), face_of)),
      occluders(std::make_shared<const OccluderPolygons>(make_occluder_polygons(faces.mesh))),
      cells(patches, shortest_edge * scene_size(faces.mesh), the_options.contrast),
      most_cells(the_options.element_count / 2) {
  cut_along_shadow_lines();
  begun = cells.cells().size();
  sent.assign(3 * patches.patch_count(), 0);
  cells.mark();
  take_elements(cells.elements());
  refine_for_points();
}

/// Each patch is a cell, or several where the lamps' shadow lines cross it.
void RefiningShooting::Impl::cut_along_shadow_lines() {
  std::vector<std::vector<std::uint32_t>> plates_of_face(faces.mesh.patch_count());
  std::vector<FaceCells> cut;
  for (std::uint32_t k = 0; k < cells.plates().size(); ++k) {
    const auto [front, back] = cells.plates()[k];
    const auto corners = patches.polygon(front);
    cut.emplace_back(std::vector<FaceCells::Cell>{{corners.begin(), corners.end()}});
    plates_of_face[face_of[front]].push_back(k);
    if (back != AdaptiveCells::none) plates_of_face[face_of[back]].push_back(k);
  }
  std::size_t count = cut.size();
  for (const ShadowLine& line : lines) {
    if (count >= most_cells / 3) break;
    for (const std::uint32_t k : plates_of_face[line.patch]) {
      count += cut[k].cut_along(line.ends[0], line.ends[1], faces.mesh.normals[line.patch], cells.least_size());
    }
  }
  for (std::uint32_t k = 0; k < cut.size(); ++k) {
    for (const FaceCells::Cell& corners : cut[k].cells()) cells.add(k, corners);
  }
}

/// Points and far lights have shone before the first shot.
void RefiningShooting::Impl::refine_for_points() {
  weigh();
  std::vector<Lamp> points;
  for (const Lamp& lamp : light.lamps()) {
    if (lamp.kind != Lamp::Kind::patch) points.push_back(lamp);
  }
  if (points.empty()) return;
  light.set_lamps(std::move(points));
  cells.mark();
  cells.measure(light);
  // What they light may be the lamp of all the rest, which should not find the elements gone.
  const std::size_t allowed = begun + (allowance() - begun) / 2;
  if (cells.cells().size() < allowed) refine_elements(allowed);
}

/// Splits what asks for it, as the cells were measured, and makes elements of them.
void RefiningShooting::Impl::refine_elements(std::size_t most) {
  const std::size_t before = cells.cells().size();
  (void)cells.refine(light, most, progress);
  if (cells.cells().size() > before) {
    take_elements(cells.elements());
    weigh();
  }
}

/// Elements of cells that were not cut keep what they know; the others are painted and lit.
void RefiningShooting::Impl::take_elements(AdaptiveCells::Elements made) {
  std::vector<std::uint32_t> of_origin(cells.cells().size(), 0);
  for (const AdaptiveCell& c : cells.cells()) ++of_origin[c.origin];
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> old;  // by patch and cell
  for (std::uint32_t e = 0; e < cell_of.size(); ++e) old[{parent[e], cell_of[e]}] = e;

  RadiosityProblem next = make_radiosity_problem(made.mesh);
  const bool lit = !problem.irradiance.empty();
  if (lit) next.irradiance.assign(next.emission.size(), 0);
  next.light_power = problem.light_power;
  std::vector<double> next_received(next.emission.size(), 0), next_arrived(next.element_count(), 0);
  std::vector<std::uint32_t> fresh;
  ElementBuilder children(patches);
  double lost = 0;  // power received by those that are no more, W
  for (std::uint32_t k = 0; k < made.parent.size(); ++k) {
    const std::uint32_t origin = cells.cells()[made.cell[k]].origin;
    const auto found = old.find({made.parent[k], origin});
    if (found == old.end() || of_origin[origin] > 1) {
      fresh.push_back(k);
      children.add(made.parent[k], made.mesh.polygon(k));
    }
    if (found == old.end()) continue;
    const std::uint32_t e = found->second;
    const bool same = of_origin[origin] == 1;
    if (!same && made.cell[k] != origin) continue;  // the first half stands for the whole it came from
    for (std::size_t b = 0; b < 3; ++b) {
      if (same) {
        next.reflectance[3 * k + b] = problem.reflectance[3 * e + b];
        next.emission[3 * k + b] = problem.emission[3 * e + b];
        next_received[3 * k + b] = received[3 * e + b];
        if (lit) next.irradiance[3 * k + b] = problem.irradiance[3 * e + b];
      } else {
        lost += problem.areas[e] * received[3 * e + b];
      }
    }
    if (same) next_arrived[k] = arrived[e];
  }

  const PatchMesh painted = [&] {
    PatchMesh mesh = std::move(children).finish();
    if (mesh.patch_count() > 0) paint_elements(scene, shape_segments, mesh);
    return mesh;
  }();
  const bool first = cell_of.empty();
  DirectIrradiance direct;
  if (first || lit) direct = direct_irradiance(scene, painted, {.seed = options.seed, .progress = progress});
  if (first) next.light_power = std::move(direct.light_power);
  if (first && !direct.irradiance.empty()) next.irradiance.assign(next.emission.size(), 0);
  for (std::size_t n = 0; n < fresh.size(); ++n) {
    const std::uint32_t k = fresh[n];
    const bool black = options.front_sides_only && made.mesh.surfaces[k].back;
    for (std::size_t b = 0; b < 3; ++b) {
      next.reflectance[3 * k + b] = black ? 0 : painted.reflectance[3 * n + b];
      next.emission[3 * k + b] = black ? 0 : painted.emission[3 * n + b];
      if (!direct.irradiance.empty()) next.irradiance[3 * k + b] = direct.irradiance[3 * n + b];
    }
  }
  elements = std::move(made.mesh);
  elements.reflectance = next.reflectance;
  elements.emission = next.emission;
  problem = std::move(next);
  parent = std::move(made.parent);
  cell_of = std::move(made.cell);
  received = std::move(next_received);
  arrived = std::move(next_arrived);
  escaped += lost;
  receive_what_was_sent(fresh, painted);
  exchange.reset();
  kept.clear();
  kept_factors = 0;
}

/// New elements gather from all patches what they have sent until now.
void RefiningShooting::Impl::receive_what_was_sent(const std::vector<std::uint32_t>& fresh, const PatchMesh& children) {
  std::vector<std::uint32_t> senders;
  for (std::uint32_t p = 0; p < patches.patch_count(); ++p) {
    if (sent[3 * p] != 0 || sent[3 * p + 1] != 0 || sent[3 * p + 2] != 0) senders.push_back(p);
  }
  if (senders.empty() || fresh.empty()) return;
  const PatchExchange between(patches, senders, children, occluders, options.factors, clusters_surveyed_meanwhile);
  parallel_for(fresh.size(), 8, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) {
      const PatchRow row = between.from_element(n);
      for (std::size_t k = 0; k < row.patches.size(); ++k) {
        const double factor = row.exchanges[k] / problem.areas[fresh[n]];
        for (std::size_t b = 0; b < 3; ++b)
          received[3 * fresh[n] + b] += factor * sent[3 * senders[row.patches[k]] + b];
      }
    }
  });
  for (const std::uint32_t k : fresh) {
    for (std::size_t b = 0; b < 3; ++b) escaped -= problem.areas[k] * received[3 * k + b];
  }
}

/// What patches have still to send.
void RefiningShooting::Impl::weigh() {
  const std::size_t count = patches.patch_count();
  unshot.assign(3 * count, 0);
  energy.assign(count, 0);
  std::vector<double> area(count, 0);
  double most_unshot[3] = {}, most_reflects[3] = {}, reflected = 0, all = 0, lit = 0, lit_area = 0;
  largest_source = 0;
  for (std::size_t e = 0; e < parent.size(); ++e) {
    area[parent[e]] += problem.areas[e];
    all += problem.areas[e];
    double most = 0, brightness = 0;
    for (std::size_t b = 0; b < 3; ++b) {
      const double rho = problem.reflectance[3 * e + b];
      const double own = problem.irradiance.empty() ? 0 : problem.irradiance[3 * e + b];
      const double source = problem.emission[3 * e + b] + rho * own;
      unshot[3 * parent[e] + b] += problem.areas[e] * (source + rho * received[3 * e + b]);
      largest_source = std::max(largest_source, source);
      most_reflects[b] = std::max(most_reflects[b], rho);
      most = std::max(most, rho);
      brightness = std::max(brightness, own + received[3 * e + b]);
    }
    cells.note_brightness(brightness);
    if (brightness > 0) lit_area += problem.areas[e];
    lit += problem.areas[e] * brightness;
    reflected += problem.areas[e] * most;
  }
  if (lit_area > 0) cells.limit_standard(lit / lit_area);
  unshot_power = 0;
  for (std::size_t p = 0; p < count; ++p) {
    for (std::size_t b = 0; b < 3; ++b) {
      double& value = unshot[3 * p + b];
      value = value / area[p] - sent[3 * p + b];
      most_unshot[b] = std::max(most_unshot[b], std::abs(value));
      energy[p] += area[p] * std::abs(value);
      unshot_power += area[p] * value;
    }
  }
  residual_bound = 0;
  for (std::size_t b = 0; b < 3; ++b) residual_bound = std::max(residual_bound, most_unshot[b] * most_reflects[b]);
  mean_reflectance = std::min(most_reflective, reflected / all);
}

/// The share of all light that was sent decides how many of the elements may be used by now.
std::size_t RefiningShooting::Impl::allowance() const {
  double done = sent_power;
  if (!problem.irradiance.empty()) done += power_of(problem, problem.irradiance);
  const double to_come = std::max(0.0, unshot_power) / (1 - mean_reflectance);
  if (!(done > 0)) return begun;
  const double share = done / (done + to_come);
  if (share > 1 - settled) return std::max(begun, most_cells);
  return begun + static_cast<std::size_t>(share * static_cast<double>(std::max(begun, most_cells) - begun));
}

void RefiningShooting::Impl::shoot(const std::vector<std::uint32_t>& shooters) {
  if (!exchange) {
    std::vector<std::uint32_t> all(patches.patch_count());
    for (std::uint32_t p = 0; p < all.size(); ++p) all[p] = p;
    exchange = std::make_unique<PatchExchange>(
        patches, all, elements, occluders, options.factors,
        refines ? clusters_surveyed_meanwhile : AutoFormFactors::Settings{}.surveyed_clusters);
  }
  std::vector<PatchRow> rows(shooters.size());
  parallel_for(shooters.size(), 1, [&](std::size_t k, std::size_t) {
    const auto known = kept.find(shooters[k]);
    rows[k] = known != kept.end() ? known->second : exchange->from_sender(shooters[k]);
  });
  for (std::size_t k = 0; k < shooters.size(); ++k) {
    const std::uint32_t p = shooters[k];
    Lamp lamp;
    lamp.patch = face_of[p];
    const auto corners = patches.polygon(p);
    lamp.corners.assign(corners.begin(), corners.end());
    for (std::size_t b = 0; b < 3; ++b) {
      const double radiosity = unshot[3 * p + b];
      lamp.strength[static_cast<int>(b)] = std::max(0.0, radiosity);
      sent[3 * p + b] += radiosity;
      sent_power += patches.areas[p] * std::abs(radiosity);
      escaped += patches.areas[p] * radiosity;
    }
    if (refines) pending.push_back(std::move(lamp));
    const PatchRow& row = rows[k];
    for (std::size_t n = 0; n < row.patches.size(); ++n) {
      const std::uint32_t e = row.patches[n];
      double most = 0;
      for (std::size_t b = 0; b < 3; ++b) {
        const double arrives = row.exchanges[n] * unshot[3 * p + b];
        received[3 * e + b] += arrives / problem.areas[e];
        escaped -= arrives;
        most = std::max(most, arrives);
      }
      arrived[e] += most / problem.areas[e];
    }
  }
  for (std::size_t k = 0; k < shooters.size(); ++k) {
    if (kept_factors + rows[k].patches.size() > most_kept || kept.contains(shooters[k])) continue;
    kept_factors += rows[k].patches.size();
    kept.emplace(shooters[k], std::move(rows[k]));
  }
  weigh();
}

/// Cells of elements that received enough to be worth a look.
std::vector<std::uint32_t> RefiningShooting::Impl::brightened_cells() const {
  const double enough = options.contrast * cells.standard();
  std::vector<std::uint32_t> which;
  for (std::size_t e = 0; e < arrived.size(); ++e) {
    if (arrived[e] > enough) which.push_back(cell_of[e]);
  }
  std::sort(which.begin(), which.end());
  which.erase(std::unique(which.begin(), which.end()), which.end());
  return which;
}

/// Looks at the light of the brightest that shot since the last look, when that may lead to enough new elements.
void RefiningShooting::Impl::refine() {
  const std::size_t allowed = allowance();
  const bool last = allowed >= most_cells;
  const auto count = static_cast<double>(cells.cells().size());
  if (last || static_cast<double>(allowed) >= (1 + least_growth) * count) look();
  if (last || cells.cells().size() >= most_cells) settle();
}

void RefiningShooting::Impl::look() {
  const auto power = [](const Lamp& lamp) {
    return polygon_area(lamp.corners) * std::max({lamp.strength.x, lamp.strength.y, lamp.strength.z});
  };
  std::stable_sort(pending.begin(), pending.end(), [&](const Lamp& a, const Lamp& b) { return power(a) > power(b); });
  if (pending.size() > options.at_once) pending.resize(options.at_once);
  light.set_lamps(std::exchange(pending, {}));
  cells.mark();
  cells.measure(light, brightened_cells());
  std::fill(arrived.begin(), arrived.end(), 0.0);
  refine_elements(allowance());
}

/// The rest of the elements goes to the largest cells; the mesh is now as it will be.
void RefiningShooting::Impl::settle() {
  refines = false;
  pending.clear();
  cells.mark();
  const std::size_t before = cells.cells().size();
  cells.split_largest(most_cells);
  if (cells.cells().size() > before) take_elements(cells.elements());
  if (!problem.irradiance.empty()) {
    DirectIrradiance direct = direct_irradiance(scene, elements, {.seed = options.seed, .progress = progress});
    problem.irradiance = std::move(direct.irradiance);
    problem.light_power = std::move(direct.light_power);
  }
  exchange.reset();
  kept.clear();
  kept_factors = 0;
  weigh();
}

std::vector<double> RefiningShooting::Impl::irradiance() const {
  std::vector<double> all = received;
  for (std::size_t k = 0; k < problem.irradiance.size(); ++k) all[k] += problem.irradiance[k];
  return all;
}

std::vector<double> RefiningShooting::Impl::radiosity() const {
  std::vector<double> all = irradiance();
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = problem.emission[k] + problem.reflectance[k] * all[k];
  return all;
}

std::vector<double> RefiningShooting::Impl::unshot_of_elements() const {
  std::vector<double> all(received.size());
  for (std::size_t e = 0; e < parent.size(); ++e) {
    for (std::size_t b = 0; b < 3; ++b) all[3 * e + b] = unshot[3 * parent[e] + b];
  }
  return all;
}

RadiositySolution RefiningShooting::Impl::take() {
  RadiositySolution solution;
  solution.radiosity = radiosity();
  solution.irradiance = irradiance();
  solution.energy.emitted = emitted_power(problem);
  solution.energy.absorbed = absorbed_power(problem, solution.irradiance);
  solution.energy.escaped = escaped + power_past_all(problem);
  solution.energy.unshot = unshot_power;
  solution.unshot_fraction = solution.energy.emitted > 0 ? unshot_power / solution.energy.emitted : 0;
  const double most = *std::max_element(problem.reflectance.begin(), problem.reflectance.end());
  if (most < 1) solution.error_bound = residual_bound / (1 - most);
  return solution;
}

RefiningShooting::RefiningShooting(const Scene& scene, const RefiningShootingOptions& options,
                                   const Progress& progress) {
  if (options.element_count < 1 || !(options.contrast >= 0) || !(options.element_size >= 0) || options.at_once == 0) {
    throw std::invalid_argument(
        "Adaptive elements need a count of at least 1, sizes and a contrast of 0 or more, and a patch that shoots.");
  }
  impl_ = std::make_unique<Impl>(scene, options, progress);
}

RefiningShooting::~RefiningShooting() = default;

const PatchMesh& RefiningShooting::mesh() const { return impl_->elements; }
const RadiosityProblem& RefiningShooting::problem() const { return impl_->problem; }
const std::vector<std::string>& RefiningShooting::warnings() const { return impl_->faces.warnings; }

RadiositySolution RefiningShooting::solve(const SolverOptions& options) {
  Impl& s = *impl_;
  SolverCourse course(options, 100000 + 10000 * s.patches.patch_count());
  while (course.goes_on()) {
    std::vector<std::uint32_t> shooters;
    if (s.unshot_power > 0) shooters = choose_shooters(s.energy, std::min(s.options.at_once, course.left()));
    s.shoot(shooters);
    if (s.refines) s.refine();
    const double emitted = emitted_power(s.problem);
    course.note(std::max<std::size_t>(shooters.size(), 1),
                s.largest_source > 0 ? s.residual_bound / s.largest_source : 0,
                emitted > 0 ? s.unshot_power / emitted : 0, emitted > 0 ? 1 - s.unshot_power / emitted : 1,
                s.radiosity(), s.unshot_of_elements());
  }
  RadiositySolution solution = s.take();
  course.record(solution);
  return solution;
}

}  // namespace penumbra
