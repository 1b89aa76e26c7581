#include "penumbra/radiosity/pipeline/refining_shooting.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "penumbra/math/bounds.h"
#include "penumbra/math/polygon.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/auto.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/meshing/adaptive_cells.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/face_cells.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/shadow_lines.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/radiosity/pipeline/patch_exchange.h"
#include "penumbra/radiosity/pipeline/receiving_elements.h"
#include "penumbra/radiosity/pipeline/shooting_patches.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "penumbra/radiosity/solvers/shooting.h"
#include "penumbra/radiosity/solvers/solver_course.h"

namespace penumbra {
namespace {

constexpr std::size_t elements_a_patch = 8;
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
  const int segments = MeshingOptions{}.shape_segments;
  MadePatchMesh made = make_element_faces(scene, PatchSides::both, segments);
  paint_elements(scene, segments, made.mesh);
  return made;
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

/// Each patch is a cell, or several where the lamps' shadow lines cross it.
AdaptiveCells cut_along_shadow_lines(const PatchMesh& faces, const ShootingPatches& patches,
                                     std::span<const ShadowLine> lines, double contrast, std::size_t most) {
  AdaptiveCells cells(patches.mesh, shortest_edge * scene_size(faces), contrast);
  std::vector<std::vector<std::uint32_t>> plates_of_face(faces.patch_count());
  std::vector<FaceCells> cut;
  for (std::uint32_t k = 0; k < cells.plates().size(); ++k) {
    const auto [front, back] = cells.plates()[k];
    const auto corners = patches.mesh.polygon(front);
    cut.emplace_back(std::vector<FaceCells::Cell>{{corners.begin(), corners.end()}});
    plates_of_face[patches.face_of[front]].push_back(k);
    if (back != AdaptiveCells::none) plates_of_face[patches.face_of[back]].push_back(k);
  }
  std::size_t count = cut.size();
  for (const ShadowLine& line : lines) {
    if (count >= most) break;
    for (const std::uint32_t k : plates_of_face[line.patch]) {
      count += cut[k].cut_along(line.ends[0], line.ends[1], faces.normals[line.patch], cells.least_size());
    }
  }
  for (std::uint32_t k = 0; k < cut.size(); ++k) {
    for (const FaceCells::Cell& corners : cut[k].cells()) cells.add(k, corners);
  }
  cells.mark();
  return cells;
}

}  // namespace

struct RefiningShooting::Impl {
  Impl(const Scene& the_scene, const RefiningShootingOptions& the_options, const Progress& the_progress);

  void refine_for_points();
  void weigh();
  [[nodiscard]] double share_sent() const;
  [[nodiscard]] std::size_t allowance() const;
  std::size_t shoot(std::size_t most);
  void send(std::uint32_t patch, const PatchRow& row);
  void refine();
  void look();
  void refine_cells(std::size_t most);
  void settle();
  void gather(const Progress& stop);
  void forget_rows();
  [[nodiscard]] std::vector<double> unshot_of_elements() const;
  [[nodiscard]] RadiositySolution take();

  const RefiningShootingOptions options;
  const Progress progress;
  const MadePatchMesh faces;
  LampIrradiance light;
  const std::vector<ShadowLine> lines;
  const ShootingPatches patches;
  std::shared_ptr<const OccluderPolygons> occluders;
  const std::size_t most_cells;
  AdaptiveCells cells;
  const std::size_t begun;
  ReceivingElements elements;
  bool refines = true, gathers = true;

  std::vector<double> sent;    // S, W/m^2, [patch * 3 + band]
  std::vector<double> unshot;  // W/m^2, [patch * 3 + band]; a little negative where textured elements were split
  std::vector<double> energy;  // unshot, W, per patch, signs aside
  std::vector<Lamp> pending;   // shooters whose light was not looked at yet
  std::unique_ptr<PatchExchange> exchange;  // all patches to all elements; none: the elements changed
  std::map<std::uint32_t, PatchRow> kept;
  std::size_t kept_factors = 0;
  double sent_power = 0, escaped = 0;             // W; sent: signs aside
  double unshot_power = 0, to_send = 0;           // W; unshot: signs aside, to_send: what balances
  double residual_bound = 0, largest_source = 0;  // W/m^2
  double mean_reflectance = 0;
};

RefiningShooting::Impl::Impl(const Scene& scene, const RefiningShootingOptions& the_options,
                             const Progress& the_progress)
    : options(the_options),
      progress(the_progress),
      faces(painted_faces(scene)),
      light(scene, faces.mesh),
      lines(by_importance(find_shadow_lines(light))),
      patches(make_shooting_patches(faces.mesh, lines, patch_size(faces.mesh, the_options),
                                    shortest_edge * scene_size(faces.mesh))),
      occluders(std::make_shared<const OccluderPolygons>(make_occluder_polygons(faces.mesh))),
      most_cells(the_options.element_count / 2),
      cells(cut_along_shadow_lines(faces.mesh, patches, lines, the_options.contrast, most_cells / 3)),
      begun(cells.cells().size()),
      elements(scene, patches.mesh, occluders, cells,
               {the_options.front_sides_only, the_options.factors, the_options.seed}, the_progress),
      sent(3 * patches.mesh.patch_count(), 0) {
  refine_for_points();
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
  if (cells.cells().size() < allowed) refine_cells(allowed);
}

/// What patches have still to send: the mean radiosity of their elements less what they have sent.
void RefiningShooting::Impl::weigh() {
  const RadiosityProblem& problem = elements.problem();
  const std::size_t count = patches.mesh.patch_count();
  unshot.assign(3 * count, 0);
  energy.assign(count, 0);
  std::vector<double> area(count, 0);
  double most_unshot[3] = {}, most_reflects[3] = {}, reflected = 0, all = 0, lit = 0, lit_area = 0;
  largest_source = 0;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const std::size_t p = elements.patch_of(e);
    area[p] += problem.areas[e];
    all += problem.areas[e];
    double most = 0, brightness = 0;
    for (std::size_t b = 0; b < 3; ++b) {
      const double rho = problem.reflectance[3 * e + b], received = elements.received()[3 * e + b];
      const double own = problem.irradiance.empty() ? 0 : problem.irradiance[3 * e + b];
      const double source = problem.emission[3 * e + b] + rho * own;
      unshot[3 * p + b] += problem.areas[e] * (source + rho * received);
      largest_source = std::max(largest_source, source);
      most_reflects[b] = std::max(most_reflects[b], rho);
      most = std::max(most, rho);
      brightness = std::max(brightness, own + received);
    }
    cells.note_brightness(brightness);
    if (brightness > 0) lit_area += problem.areas[e];
    lit += problem.areas[e] * brightness;
    reflected += problem.areas[e] * most;
  }
  if (lit_area > 0) cells.limit_standard(lit / lit_area);
  unshot_power = to_send = 0;
  for (std::size_t p = 0; p < count; ++p) {
    if (!(area[p] > 0)) continue;  // a sliver whose cells have no width that a double can hold
    for (std::size_t b = 0; b < 3; ++b) {
      double& value = unshot[3 * p + b];
      value = value / area[p] - sent[3 * p + b];
      most_unshot[b] = std::max(most_unshot[b], std::abs(value));
      energy[p] += area[p] * std::abs(value);
      to_send += area[p] * value;
    }
    unshot_power += energy[p];
  }
  residual_bound = 0;
  for (std::size_t b = 0; b < 3; ++b) residual_bound = std::max(residual_bound, most_unshot[b] * most_reflects[b]);
  mean_reflectance = std::min(most_reflective, reflected / all);
}

/// The share of all light that was sent, about.
double RefiningShooting::Impl::share_sent() const {
  const RadiosityProblem& problem = elements.problem();
  double done = sent_power;
  if (!problem.irradiance.empty()) done += power_of(problem, problem.irradiance);
  return done > 0 ? done / (done + unshot_power / (1 - mean_reflectance)) : 0;
}

/// It decides how many of the elements may be used by now.
std::size_t RefiningShooting::Impl::allowance() const {
  const double share = share_sent();
  if (share > 1 - settled) return std::max(begun, most_cells);
  return begun + static_cast<std::size_t>(share * static_cast<double>(std::max(begun, most_cells) - begun));
}

/// The brightest patches shoot; returns how many.
std::size_t RefiningShooting::Impl::shoot(std::size_t most) {
  if (!(unshot_power > 0)) return 0;
  if (!exchange) {
    std::vector<std::uint32_t> all(patches.mesh.patch_count());
    for (std::uint32_t p = 0; p < all.size(); ++p) all[p] = p;
    exchange = std::make_unique<PatchExchange>(
        patches.mesh, all, elements.mesh(), occluders, options.factors,
        refines ? clusters_surveyed_meanwhile : AutoFormFactors::Settings{}.surveyed_clusters);
  }
  const std::vector<std::uint32_t> shooters = choose_shooters(energy, std::min(options.at_once, most));
  std::vector<PatchRow> rows(shooters.size());
  parallel_for(shooters.size(), 1, [&](std::size_t k, std::size_t) {
    const auto known = kept.find(shooters[k]);
    rows[k] = known != kept.end() ? known->second : exchange->from_sender(shooters[k]);
  });
  for (std::size_t k = 0; k < shooters.size(); ++k) send(shooters[k], rows[k]);
  for (std::size_t k = 0; k < shooters.size(); ++k) {
    if (kept_factors + rows[k].patches.size() > most_kept || kept.contains(shooters[k])) continue;
    kept_factors += rows[k].patches.size();
    kept.emplace(shooters[k], std::move(rows[k]));
  }
  weigh();
  return shooters.size();
}

void RefiningShooting::Impl::send(std::uint32_t patch, const PatchRow& row) {
  const auto radiosity = std::span(unshot).subspan(3 * patch, 3);
  const double area = patches.mesh.areas[patch];
  Lamp lamp;
  lamp.patch = patches.face_of[patch];
  const auto corners = patches.mesh.polygon(patch);
  lamp.corners.assign(corners.begin(), corners.end());
  for (std::size_t b = 0; b < 3; ++b) {
    lamp.strength[static_cast<int>(b)] = std::max(0.0, radiosity[b]);
    sent[3 * patch + b] += radiosity[b];
    sent_power += area * std::abs(radiosity[b]);
    escaped += area * radiosity[b];
  }
  if (refines) pending.push_back(std::move(lamp));
  for (std::size_t n = 0; n < row.patches.size(); ++n) {
    escaped -= elements.receive(row.patches[n], row.exchanges[n], radiosity);
  }
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
  cells.measure(light, elements.brightened_cells(options.contrast * cells.standard()));
  elements.forget_arrivals();
  refine_cells(allowance());
}

/// Splits what asks for it, as the cells were measured, and makes elements of them.
void RefiningShooting::Impl::refine_cells(std::size_t most) {
  const std::size_t before = cells.cells().size();
  (void)cells.refine(light, most, progress);
  if (cells.cells().size() == before) return;
  elements.follow(cells, sent);
  forget_rows();
  weigh();
}

/// The rest of the elements goes to the largest cells; the mesh is now as it will be.
void RefiningShooting::Impl::settle() {
  refines = false;
  pending.clear();
  cells.mark();
  const std::size_t before = cells.cells().size();
  cells.split_largest(most_cells);
  if (cells.cells().size() > before) elements.follow(cells, sent);
  elements.light_again();
  forget_rows();
  weigh();
}

/// Elements gather from each other what patches have sent, each element its share of what its patch sent by how bright
/// it is.
void RefiningShooting::Impl::gather(const Progress& stop) {
  gathers = false;
  std::vector<double> of_elements = elements.radiosity();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (std::size_t b = 0; b < 3; ++b) {
      const std::size_t p = 3 * elements.patch_of(e) + b;
      const double mean = sent[p] + unshot[p];
      of_elements[3 * e + b] *= mean > 0 ? sent[p] / mean : 0;
    }
  }
  const double before = elements.received_power();
  if (!elements.gather(of_elements, stop)) return;
  escaped += before - elements.received_power();
  weigh();
}

void RefiningShooting::Impl::forget_rows() {
  exchange.reset();
  kept.clear();
  kept_factors = 0;
}

std::vector<double> RefiningShooting::Impl::unshot_of_elements() const {
  std::vector<double> all(3 * elements.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = unshot[3 * elements.patch_of(k / 3) + k % 3];
  return all;
}

RadiositySolution RefiningShooting::Impl::take() {
  const RadiosityProblem& problem = elements.problem();
  RadiositySolution solution;
  solution.radiosity = elements.radiosity();
  solution.irradiance = elements.irradiance();
  solution.energy.emitted = emitted_power(problem);
  solution.energy.absorbed = absorbed_power(problem, solution.irradiance);
  solution.energy.escaped = escaped + power_past_all(problem);
  solution.energy.unshot = to_send;
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

const PatchMesh& RefiningShooting::mesh() const { return impl_->elements.mesh(); }
const RadiosityProblem& RefiningShooting::problem() const { return impl_->elements.problem(); }
const std::vector<std::string>& RefiningShooting::warnings() const { return impl_->faces.warnings; }

RadiositySolution RefiningShooting::solve(const SolverOptions& options) {
  Impl& s = *impl_;
  SolverCourse course(options, 100000 + 10000 * s.patches.mesh.patch_count());
  while (course.goes_on()) {
    const double before = s.unshot_power;
    std::size_t shots = s.shoot(course.left());
    if (s.refines) s.refine();
    if (!s.refines && s.gathers && s.share_sent() > 1 - settled && s.elements.size() <= s.options.most_gathering) {
      s.gather(options.progress);
    }
    // What elements see better than patches did may be more light: the step ends when less is unshot than before it.
    while (s.unshot_power > 0 && s.unshot_power >= before && shots < course.left() &&
           !options.progress.stop_requested()) {
      shots += s.shoot(course.left() - shots);
    }
    const double emitted = emitted_power(s.elements.problem());
    const double unshot = emitted > 0 ? s.unshot_power / emitted : 0;
    course.note(std::max<std::size_t>(shots, 1), s.largest_source > 0 ? s.residual_bound / s.largest_source : 0, unshot,
                emitted > 0 ? 1 - unshot : 1, s.elements.radiosity(), s.unshot_of_elements());
  }
  RadiositySolution solution = s.take();
  course.record(solution);
  return solution;
}

}  // namespace penumbra
