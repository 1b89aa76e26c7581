#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "penumbra/math/transform.h"
#include "penumbra/scene/builtin_atrium_shell.h"
#include "penumbra/scene/builtin_parts.h"
#include "penumbra/scene/builtin_solids.h"

namespace penumbra {

namespace {

using std::numbers::pi;

/// The meshes beside the shell, each of one material (the skylight of two).
enum Part : std::uint32_t {
  columns,
  arches,
  mouldings,
  vault_ribs,
  inlay,
  red_cloth,
  blue_cloth,
  foliage,
  pots,
  iron,
  skylight,
  part_count
};

/// Copies of one solid.
struct Group {
  Part part;
  Solid solid;
  std::vector<Placement> placements{Placement{}};

  [[nodiscard]] std::size_t triangles() const {
    return placements.size() * std::visit([](const auto& s) { return s.triangles(); }, solid);
  }
};
using Groups = std::vector<Group>;

std::size_t count(const Groups& groups) {
  std::size_t n = 0;
  for (const Group& g : groups) n += g.triangles();
  return n;
}

/// The heights of a storey's parts, metres above the hall's floor.
struct Storey {
  double floor, shaft, shaft_height, springing, top;
};
constexpr Storey lower{.floor = 0, .shaft = 0.35, .shaft_height = 3.15, .springing = 3.7, .top = 5.35};
constexpr Storey upper{.floor = 5.7, .shaft = 5.95, .shaft_height = 2.4, .springing = 8.52, .top = 9.9};
constexpr double arch_radius = 1.1;

int at_least(int least, double wanted) { return std::max(least, static_cast<int>(wanted)); }

std::vector<Placement> around_court(double height) {
  std::vector<Placement> places;
  for (int i = 0; i <= hall::bays_x; ++i) {
    for (const double z : {-hall::court_z, hall::court_z}) {
      places.push_back({{-hall::court_x + i * hall::bay, height, z}});
    }
  }
  for (int j = 1; j < hall::bays_z; ++j) {
    for (const double x : {-hall::court_x, hall::court_x}) {
      places.push_back({{x, height, -hall::court_z + j * hall::bay}});
    }
  }
  return places;
}

/// The middle of each bay of the colonnade, the bay along x before it is turned.
std::vector<Placement> bays_of_court(double height) {
  std::vector<Placement> places;
  for (int i = 0; i < hall::bays_x; ++i) {
    for (const double z : {-hall::court_z, hall::court_z}) {
      places.push_back({{-hall::court_x + (i + 0.5) * hall::bay, height, z}});
    }
  }
  for (int j = 0; j < hall::bays_z; ++j) {
    for (const double x : {-hall::court_x, hall::court_x}) {
      places.push_back({{x, height, -hall::court_z + (j + 0.5) * hall::bay}, pi / 2});
    }
  }
  return places;
}

std::vector<Placement> corners_of_court() {
  return {{{hall::court_x, 0, hall::court_z}},
          {{hall::court_x, 0, -hall::court_z}},
          {{-hall::court_x, 0, -hall::court_z}},
          {{-hall::court_x, 0, hall::court_z}}};
}

/// Adds points so that none is further than `spacing` from the last.
std::vector<Vec2d> refined(const std::vector<Vec2d>& profile, double spacing) {
  std::vector<Vec2d> points{profile.front()};
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const Vec2d step = profile[i] - profile[i - 1];
    const int parts = at_least(1, std::ceil(glm::length(step) / spacing));
    for (int k = 1; k <= parts; ++k) points.push_back(profile[i - 1] + step * (1.0 * k / parts));
  }
  return points;
}

/// A column without plinth and abacus; its ends reach into them. @param q resolution, 1 plain.
LatheSolid column(double h, double q) {
  LatheSolid lathe;
  lathe.segments = at_least(4, 12 * q);
  if (q < 1.5) {
    lathe.profile = {{0.43, -0.02}, {0.33, 0.3}, {0.28, h - 0.35}, {0.41, h + 0.02}};
    return lathe;
  }
  const std::vector<Vec2d> keys{
      {0.42, -0.03},     {0.44, 0.02},      {0.45, 0.06},     {0.44, 0.10},      {0.385, 0.12},    {0.37, 0.16},
      {0.385, 0.19},     {0.40, 0.22},      {0.385, 0.25},    {0.345, 0.27},     {0.335, 0.33},    {0.33, h / 3},
      {0.31, 2 * h / 3}, {0.28, h - 0.45},  {0.28, h - 0.41}, {0.31, h - 0.395}, {0.32, h - 0.37}, {0.31, h - 0.345},
      {0.28, h - 0.33},  {0.285, h - 0.24}, {0.32, h - 0.13}, {0.39, h - 0.04},  {0.42, h},        {0.42, h + 0.03}};
  lathe.profile = refined(keys, 0.6 / q);
  constexpr int flutes = 20;
  if (lathe.segments >= 4 * flutes) {
    lathe.segments -= lathe.segments % flutes;  // so that the arrises between flutes stay sharp
    lathe.flutes = flutes;
    lathe.flute_depth = 0.028;
    lathe.flute_bottom = 0.36;
    lathe.flute_top = h - 0.47;
  }
  return lathe;
}

Groups colonnade(const Storey& s, double q) { return {{columns, column(s.shaft_height, q), around_court(s.shaft)}}; }

/// Plinths under the columns and abaci over them.
Groups column_blocks(const Storey& s) {
  return {{mouldings, BoxSolid{{-0.47, -0.05, -0.47}, {0.47, s.shaft - s.floor, 0.47}}, around_court(s.floor)},
          {mouldings, BoxSolid{{-0.48, 0, -0.48}, {0.48, s.springing - s.shaft - s.shaft_height, 0.48}},
           around_court(s.shaft + s.shaft_height)}};
}

Groups arcade(const Storey& s, double q) {
  const SpandrelSolid spandrel{.half_span = hall::bay / 2,
                               .radius = arch_radius,
                               .top = s.top - s.springing,
                               .half_thickness = 0.34,
                               .segments = at_least(4, 7 * q)};
  // The walls of two sides leave a notch where they meet.
  const BoxSolid corner{{-0.36, s.springing, -0.36}, {0.36, s.top, 0.36}};
  return {{arches, spandrel, bays_of_court(s.springing)}, {arches, corner, corners_of_court()}};
}

/// A raised band around each arch, and its keystone.
Groups archivolts(const Storey& s, double q) {
  const ArcSolid outer{
      .inner = arch_radius + 0.03, .outer = arch_radius + 0.22, .half_width = 0.38, .segments = at_least(6, 9 * q)};
  const ArcSolid inner{
      .inner = arch_radius - 0.05, .outer = arch_radius + 0.09, .half_width = 0.41, .segments = at_least(6, 9 * q)};
  const BoxSolid keystone{{-0.11, arch_radius - 0.1, -0.45}, {0.11, arch_radius + 0.26, 0.45}};
  return {{mouldings, outer, bays_of_court(s.springing)},
          {mouldings, inner, bays_of_court(s.springing)},
          {mouldings, keystone, bays_of_court(s.springing)}};
}

FrameSolid court_frame(std::vector<Vec2d> section) { return {std::move(section), hall::court_x, hall::court_z}; }

/// The gallery's floor, and the cornices over both arcades.
Groups cornices() {
  const double g = upper.floor, e = hall::eaves;
  return {{arches, court_frame({{0.1, g - 0.3}, {3.2, g - 0.3}, {3.2, g - 0.02}, {0.1, g - 0.02}})},
          {mouldings, court_frame({{0.44, g - 0.42},
                                   {0.44, g},
                                   {-0.66, g},
                                   {-0.66, g - 0.07},
                                   {-0.6, g - 0.11},
                                   {-0.53, g - 0.22},
                                   {-0.44, g - 0.27},
                                   {-0.44, g - 0.42}})},
          {mouldings, court_frame({{0.44, e - 0.3},
                                   {0.44, e + 0.22},
                                   {-0.72, e + 0.22},
                                   {-0.72, e + 0.13},
                                   {-0.64, e + 0.07},
                                   {-0.55, e - 0.07},
                                   {-0.44, e - 0.13},
                                   {-0.44, e - 0.3}})}};
}

Groups ribs(double q) {
  const double e = hall::eaves, r = hall::court_x;
  Group across{vault_ribs,
               ArcSolid{.inner = r - 0.28, .outer = r + 0.15, .half_width = 0.2, .segments = at_least(8, 14 * q)},
               {}};
  for (int k = 0; k <= hall::bays_z; ++k) across.placements.push_back({{0, e, -hall::court_z + k * hall::bay}});
  Groups groups{across};
  for (const double degrees : {18.0, 36.0, 54.0, 126.0, 144.0, 162.0}) {
    const double angle = degrees * pi / 180;
    groups.push_back({vault_ribs,
                      ArcSolid{.inner = r - 0.18,
                               .outer = r + 0.1,
                               .half_width = hall::outer_z + 0.1,
                               .begin = angle - 0.017,
                               .end = angle + 0.017,
                               .segments = 1},
                      {{{0, e, 0}}}});
  }
  return groups;
}

/// Dark tiles let into the court's floor, within two bands. They stand 3 mm proud.
Groups floor_pattern() {
  constexpr double tile = 1.5;
  Group tiles{inlay, BoxSolid{{-0.73, -0.04, -0.73}, {0.73, 0.003, 0.73}}, {}};
  for (int j = -6; j <= 6; ++j) {
    for (int i = -3; i <= 3; ++i) {
      if ((i + j) % 2 != 0 && !(i == 0 && j == -1)) tiles.placements.push_back({{tile * i, 0, tile * j}});
    }
  }
  const FrameSolid band{{{-0.5, -0.04}, {-0.4, -0.04}, {-0.4, 0.003}, {-0.5, 0.003}}, hall::court_x, hall::court_z};
  const FrameSolid outer{{{0.55, -0.04}, {0.85, -0.04}, {0.85, 0.003}, {0.55, 0.003}}, hall::court_x, hall::court_z};
  return {tiles, {inlay, band}, {inlay, outer}};
}

Groups banners(double q) {
  Groups groups;
  int index = 0;
  for (const double z : {-6.0, 0.0, 6.0}) {
    for (const double x : {-hall::court_x, hall::court_x}) {
      const ClothSolid cloth{.half_width = 0.68,
                             .height = 2.5,
                             .fold_depth = 0.09,
                             .phase = 1.7 * index,
                             .across = at_least(4, 9 * q),
                             .down = at_least(3, 5 * q)};
      groups.push_back({(index + index / 2) % 2 == 0 ? red_cloth : blue_cloth, cloth, {{{x, 4.62, z}, pi / 2}}});
      ++index;
    }
  }
  return groups;
}

/// A great urn in the middle and clipped trees in pots along the sides.
Groups garden(double q) {
  LatheSolid urn{.profile = refined({{0.62, -0.02},
                                     {0.62, 0.12},
                                     {0.5, 0.16},
                                     {0.3, 0.26},
                                     {0.2, 0.42},
                                     {0.17, 0.6},
                                     {0.22, 0.66},
                                     {0.2, 0.7},
                                     {0.3, 0.78},
                                     {0.52, 0.98},
                                     {0.66, 1.22},
                                     {0.7, 1.42},
                                     {0.66, 1.56},
                                     {0.6, 1.62},
                                     {0.66, 1.68},
                                     {0.78, 1.72},
                                     {0.8, 1.76},
                                     {0.72, 1.77},
                                     {0.6, 1.7}},
                                    1 / q + 0.01),
                 .segments = at_least(10, 16 * q)};
  if (urn.segments >= 128) {
    urn.segments -= urn.segments % 32;
    urn.flutes = 32;
    urn.flute_depth = 0.02;
    urn.flute_bottom = 0.8;
    urn.flute_top = 1.4;
  }
  LatheSolid pot{.profile = {{0.26, -0.02}, {0.36, 0.5}, {0.42, 0.52}, {0.42, 0.62}, {0.35, 0.63}, {0.33, 0.56}},
                 .segments = at_least(8, 10 * q)};
  pot.profile = refined(pot.profile, 2 / q + 0.01);
  const LatheSolid trunk{.profile = {{0.05, 0.5}, {0.04, 1.2}}, .segments = at_least(5, 3 * q)};
  LatheSolid crown{.profile = {}, .segments = at_least(8, 10 * q), .roughness = q > 2 ? 0.045 : 0.0};
  const int rings = at_least(5, 6 * q);
  for (int k = 0; k < rings; ++k) {
    const double angle = pi * (k + 0.5) / rings;
    crown.profile.emplace_back(0.58 * std::sin(angle), 1.5 - 0.58 * std::cos(angle));
  }
  std::vector<Placement> places;
  for (const double z : {-7.5, -1.5, 4.5}) {
    for (const double x : {-4.55, 4.55}) places.push_back({{x, 0, z}, 0.3 * z * x});
  }
  return {{columns, urn, {{{0, 0, -1.5}}}}, {pots, pot, places}, {pots, trunk, places}, {foliage, crown, places}};
}

/// Rails and balusters between the columns of the gallery.
Groups balustrade(double q) {
  const double g = upper.floor;
  LatheSolid baluster{.profile = {{0.075, -0.02}, {0.045, 0.2}, {0.085, 0.42}, {0.05, 0.66}, {0.07, 0.8}},
                      .segments = std::min(at_least(5, 2.5 * q), 64)};
  if (q > 3) {
    baluster.profile = refined({{0.08, -0.02},
                                {0.08, 0.1},
                                {0.05, 0.13},
                                {0.045, 0.17},
                                {0.06, 0.24},
                                {0.08, 0.3},
                                {0.085, 0.36},
                                {0.07, 0.44},
                                {0.05, 0.54},
                                {0.04, 0.62},
                                {0.045, 0.66},
                                {0.06, 0.68},
                                {0.06, 0.71},
                                {0.05, 0.73},
                                {0.075, 0.75},
                                {0.075, 0.8}},
                               1 / q);
  }
  constexpr int per_bay = 8;
  Group balusters{columns, baluster, {}};
  for (const Placement& bay : bays_of_court(g + 0.1)) {
    for (int k = 0; k < per_bay; ++k) {
      const double along = (hall::bay - 0.94) * ((k + 0.5) / per_bay - 0.5);
      balusters.placements.push_back({bay.offset + (bay.turn == 0 ? Vec3d(along, 0, 0) : Vec3d(0, 0, along))});
    }
  }
  return {balusters,
          {mouldings, court_frame({{-0.14, g - 0.02}, {0.14, g - 0.02}, {0.14, g + 0.12}, {-0.14, g + 0.12}})},
          {mouldings, court_frame({{-0.13, g + 0.86},
                                   {0.13, g + 0.86},
                                   {0.16, g + 0.9},
                                   {0.16, g + 0.97},
                                   {-0.16, g + 0.97},
                                   {-0.16, g + 0.9}})}};
}

constexpr double light_x = 1.5, light_z = 9, light_y = 15.4;

Groups skylight_box() {
  return {{skylight, BoxSolid{{-light_x, light_y, -light_z}, {light_x, light_y + 0.9, light_z}}}};
}

/// The skylight's frame and glazing bars.
Groups glazing() {
  const FrameSolid rim{
      {{-0.1, light_y - 0.18}, {0.2, light_y - 0.18}, {0.2, light_y + 0.7}, {-0.1, light_y + 0.7}}, light_x, light_z};
  Group bars{iron, BoxSolid{{-light_x, light_y - 0.1, -0.035}, {light_x, light_y + 0.05, 0.035}}, {}};
  for (int k = -5; k <= 5; ++k) bars.placements.push_back({{0, 0, 1.5 * k}});
  const BoxSolid purlin{{-0.045, light_y - 0.13, -light_z}, {0.045, light_y + 0.05, light_z}};
  return {{vault_ribs, rim}, bars, {iron, purlin, {{{-0.5, 0, 0}}, {{0.5, 0, 0}}}}};
}

/// Everything but the shell, the most important first; `stages` of them.
/// @param q resolution: triangles grow with its square.
Groups furnishing(double q, int stages) {
  const std::array<Groups (*)(double), 14> order{[](double) { return skylight_box(); },
                                                 [](double f) { return colonnade(lower, f); },
                                                 [](double) { return cornices(); },
                                                 [](double f) { return colonnade(upper, f); },
                                                 [](double f) { return arcade(lower, f); },
                                                 [](double f) { return arcade(upper, f); },
                                                 [](double) { return column_blocks(lower); },
                                                 [](double f) { return banners(f); },
                                                 [](double) { return floor_pattern(); },
                                                 [](double f) { return ribs(f); },
                                                 [](double) { return glazing(); },
                                                 [](double) { return column_blocks(upper); },
                                                 [](double f) { return garden(f); },
                                                 [](double f) {
                                                   Groups all = archivolts(lower, f), more = archivolts(upper, f),
                                                          rail = balustrade(f);
                                                   all.insert(all.end(), more.begin(), more.end());
                                                   all.insert(all.end(), rail.begin(), rail.end());
                                                   return all;
                                                 }};
  Groups groups;
  for (std::size_t i = 0; i < order.size() && static_cast<int>(i) < stages; ++i) {
    for (Group& g : order[i](q)) groups.push_back(std::move(g));
  }
  return groups;
}
constexpr int all_stages = 14;

/// As much as `triangles` leave room for beside the shell, which takes a seventh of a small hall and a third of a large
/// one: first what there is, then how fine.
Groups fitting_furnishing(std::size_t triangles) {
  constexpr std::size_t least_shell = 40;
  const double share = std::clamp(0.86 - 0.1 * std::log10(static_cast<double>(triangles) / 1e4), 0.66, 0.86);
  const auto room = static_cast<std::size_t>(share * static_cast<double>(triangles));
  constexpr double coarsest = 0.1;
  int stages = 1;
  while (stages < all_stages &&
         count(furnishing(coarsest, stages + 1)) <= std::min(room * 9 / 10, triangles - least_shell))
    ++stages;
  double low = coarsest, high = 200;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(low * high);
    (count(furnishing(middle, stages)) <= room ? low : high) = middle;
  }
  return furnishing(low, stages);
}

std::vector<Mesh> build(const Groups& groups) {
  std::vector<Mesh> meshes(part_count);
  std::array<std::size_t, part_count> triangles{};
  for (const Group& g : groups) triangles[g.part] += g.triangles();
  for (std::size_t p = 0; p < part_count; ++p) {
    meshes[p].triangles.reserve(triangles[p]);
    meshes[p].positions.reserve(triangles[p] / 2 + 1000);
  }
  for (const Group& g : groups) {
    const Piece piece = std::visit([](const auto& s) { return s.build(); }, g.solid);
    for (const Placement& place : g.placements) append(meshes[g.part], piece, place);
  }
  return meshes;
}

}  // namespace

Scene make_atrium(const BuiltinParameters& parameters) {
  const auto triangles = static_cast<std::size_t>(parameters["triangles"]);
  Scene scene;
  // In the order of Part, then the rest.
  scene.materials = {lambertian("marble", {0.80F, 0.76F, 0.69F}),
                     lambertian("limestone", {0.76F, 0.67F, 0.54F}),
                     lambertian("pale limestone", {0.80F, 0.73F, 0.62F}),
                     lambertian("plaster rib", {0.82F, 0.78F, 0.70F}),
                     lambertian("porphyry", {0.26F, 0.10F, 0.085F}),
                     lambertian("red cloth", {0.60F, 0.035F, 0.03F}),
                     lambertian("blue cloth", {0.04F, 0.10F, 0.46F}),
                     lambertian("foliage", {0.09F, 0.23F, 0.05F}),
                     lambertian("terracotta", {0.56F, 0.25F, 0.13F}),
                     lambertian("iron", {0.10F, 0.11F, 0.11F}),
                     lambertian("skylight", Rgb(0.0F), {12.0F, 11.7F, 11.4F})};
  const ShellMaterials shell{.floor = add_material(scene, lambertian("floor", {0.72F, 0.67F, 0.58F})),
                             .wall = add_material(scene, lambertian("ashlar", {0.72F, 0.58F, 0.42F})),
                             .vault = add_material(scene, lambertian("plaster", {0.66F, 0.72F, 0.74F}))};
  constexpr std::array<const char*, part_count> names{"columns", "arches",      "mouldings",    "vault ribs",
                                                      "inlay",   "red banners", "blue banners", "foliage",
                                                      "pots",    "iron",        "skylight"};

  const Groups groups = fitting_furnishing(triangles);
  add_object(scene, atrium_shell(triangles - count(groups), shell));
  std::vector<Mesh> meshes = build(groups);
  for (std::uint32_t p = 0; p < part_count; ++p) {
    if (meshes[p].triangles.empty()) continue;
    meshes[p].name = names[p];
    meshes[p].materials = {p};
    if (p == skylight) {  // only its lower face shines: the third of BoxSolid's six
      meshes[p].materials.assign(12, vault_ribs);
      meshes[p].materials[4] = meshes[p].materials[5] = skylight;
    }
    add_object(scene, std::move(meshes[p]));
  }
  scene.cameras = {{.name = "camera",
                    .to_world = look_at({0.9, 1.65, 10.3}, {-0.3, 4.9, -6}, {0, 1, 0}),
                    .lens = PerspectiveLens{64 * pi / 180}}};
  return scene;
}

}  // namespace penumbra
