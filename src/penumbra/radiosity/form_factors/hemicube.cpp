#include "penumbra/radiosity/form_factors/hemicube.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "penumbra/math/polygon.h"
#include "penumbra/math/rng.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/bsp_tree.h"

namespace penumbra {
namespace {

constexpr int most_resolution = 4096;
// Depths that agree to this are equal: the two sides of a plate.
constexpr double equal_depth = 1e-9;
// A polygon whose plane passes the eye this near (of its size) is seen from the edge.
constexpr double edge_on = 1e-12;

// A face looks along w; u runs along its rows, v across them (upwards on the sides).
Vec3d to_face(std::size_t face, const Vec3d& p) {
  switch (face) {
    case 0:
      return p;
    case 1:
      return {p.y, p.z, p.x};
    case 2:
      return {-p.x, p.z, p.y};
    case 3:
      return {-p.y, p.z, -p.x};
    default:
      return {p.x, p.z, -p.y};
  }
}
Vec3d from_face(std::size_t face, const Vec3d& q) {
  switch (face) {
    case 0:
      return q;
    case 1:
      return {q.z, q.x, q.y};
    case 2:
      return {-q.x, q.z, q.y};
    case 3:
      return {-q.z, -q.x, q.y};
    default:
      return {q.x, -q.z, q.y};
  }
}

double middle(int pixel, int resolution) { return (2 * pixel + 1) / static_cast<double>(resolution) - 1; }
double middle_up(int row, int resolution) { return (2 * row + 1) / static_cast<double>(resolution); }
int rows_of(std::size_t face, int resolution) { return face == 0 ? resolution : resolution / 2; }
double row_middle(std::size_t face, int row, int resolution) {
  return face == 0 ? middle(row, resolution) : middle_up(row, resolution);
}

// The hemicubes of a method are turned by this about the normal, rad: straight ones look exactly through the corners of
// regular scenes, where rounding may leave a pixel to none of the polygons that meet there, and light passes through.
constexpr double generic_angle = 0.0217;

// A pixel exactly on an edge belongs to the polygon for which this holds of the inward normal: never to both that share
// it.
bool keeps_rim(const Vec3d& inward) {
  const double first = inward.x != 0 ? inward.x : (inward.y != 0 ? inward.y : inward.z);
  return first > 0;
}

bool outside_face(std::span<const Vec3d> corners, std::size_t face) {
  bool behind = true, left = true, right = true, above = true, below = true;
  for (const Vec3d& p : corners) {
    const Vec3d q = to_face(face, p);
    behind = behind && q.z <= 0;
    left = left && q.x < -q.z;
    right = right && q.x > q.z;
    above = above && q.y > q.z;
    below = below && (face == 0 ? q.y < -q.z : q.y < 0);
  }
  return behind || left || right || above || below;
}

// The rows that the polygon may touch: all when a corner lies behind the face's eye plane.
std::pair<int, int> row_range(std::span<const Vec3d> corners, std::size_t face, int resolution) {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  const int rows = rows_of(face, resolution);
  for (const Vec3d& p : corners) {
    const Vec3d q = to_face(face, p);
    if (!(q.z > 1e-9 * std::abs(q.y))) return {0, rows};
    lower = std::min(lower, q.y / q.z);
    upper = std::max(upper, q.y / q.z);
  }
  const double scale = 0.5 * resolution;
  const double shift = face == 0 ? 1 : 0;
  return {static_cast<int>(std::clamp((lower + shift) * scale - 2, 0.0, static_cast<double>(rows))),
          static_cast<int>(std::clamp((upper + shift) * scale + 2, 0.0, static_cast<double>(rows)))};
}

// What one row's edges leave of it, wider by a pixel for rounding.
std::pair<int, int> column_range(std::span<const HemicubeEdge> edges, double v, int resolution) {
  double lower = -1, upper = 1;
  for (const HemicubeEdge& e : edges) {
    const double rest = e.inward.y * v + e.inward.z;
    if (e.inward.x > 0) {
      lower = std::max(lower, -rest / e.inward.x);
    } else if (e.inward.x < 0) {
      upper = std::min(upper, -rest / e.inward.x);
    } else if (rest < 0) {
      return {0, 0};
    }
  }
  if (!(lower <= upper)) return {0, 0};
  const double scale = 0.5 * resolution;
  return {std::max(0, static_cast<int>((lower + 1) * scale) - 1),
          std::min(resolution, static_cast<int>((upper + 1) * scale) + 2)};
}

bool inside_all(std::span<const HemicubeEdge> edges, const Vec3d& d) {
  return std::all_of(edges.begin(), edges.end(), [&](const HemicubeEdge& e) {
    const double value = e.inward.x * d.x + e.inward.y * d.y + e.inward.z;
    return value > 0 || (value == 0 && e.keeps_rim);
  });
}

Frame turned(const Vec3d& normal, double angle) {
  const Frame straight(normal);
  Frame frame = straight;
  frame.tangent = std::cos(angle) * straight.tangent + std::sin(angle) * straight.bitangent;
  frame.bitangent = std::cos(angle) * straight.bitangent - std::sin(angle) * straight.tangent;
  return frame;
}

double radius_of(const PatchMesh& mesh, std::uint32_t patch) {
  double r2 = 0;
  for (const Vec3d& v : mesh.polygon(patch)) r2 = std::max(r2, length_squared(v - mesh.centroids[patch]));
  return std::sqrt(r2);
}

bool has_corner_in_front(const PatchMesh& mesh, std::uint32_t of, std::uint32_t other) {
  const Vec3d& n = mesh.normals[of];
  const Vec3d& c = mesh.centroids[of];
  const auto polygon = mesh.polygon(other);
  return std::any_of(polygon.begin(), polygon.end(), [&](const Vec3d& v) { return dot(n, v - c) > 0; });
}

}  // namespace

HemicubeDeltas::HemicubeDeltas(int n) : resolution(n) {
  if (n < 2 || n > most_resolution || n % 2 != 0) {
    throw std::invalid_argument("the hemicube's resolution should be an even number from 2 to " +
                                std::to_string(most_resolution) + ", but is " + std::to_string(n));
  }
  const double area = 4.0 / (static_cast<double>(n) * n);
  const auto delta = [&](double cosine, double u, double v) {
    const double r2 = u * u + v * v + 1;
    return cosine * area / (std::numbers::pi * r2 * r2);
  };
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) top.push_back(delta(1, middle(column, n), middle(row, n)));
  }
  for (int row = 0; row < n / 2; ++row) {
    const double z = middle_up(row, n);
    for (int column = 0; column < n; ++column) side.push_back(delta(z, middle(column, n), z));
  }
}

Hemicube::Hemicube(std::shared_ptr<const HemicubeDeltas> deltas) : deltas_(std::move(deltas)) {
  for (std::size_t face = 0; face < 5; ++face) {
    items_[face].resize((face == 0 ? deltas_->top : deltas_->side).size());
    nearness_[face].resize(items_[face].size());
  }
  place(Vec3d(0), Frame());
}

void Hemicube::place(const Vec3d& eye, const Frame& frame) {
  eye_ = eye;
  frame_ = frame;
  for (std::size_t face = 0; face < 5; ++face) {
    std::fill(items_[face].begin(), items_[face].end(), nothing);
    std::fill(nearness_[face].begin(), nearness_[face].end(), 0.0);
  }
}

// Homogeneous rasterisation (Olano & Greer 1997): inside are the directions on the inner side of every plane through
// the eye and an edge, so nothing needs to be clipped. `paint(face, pixel, nearness, faces_eye)`.
template <class Paint>
void Hemicube::rasterise(std::span<const Vec3d> polygon, const Paint& paint) {
  local_.clear();
  double size2 = 0;
  bool above_horizon = false;
  for (const Vec3d& corner : polygon) {
    local_.push_back(frame_.to_local(corner - eye_));
    size2 = std::max(size2, length_squared(local_.back()));
    above_horizon = above_horizon || local_.back().z > 0;
  }
  if (!above_horizon) return;
  const Vec3d plane = newell_vector(local_);
  const double offset = dot(plane, local_[0]);
  if (!(std::abs(offset) > edge_on * length(plane) * std::sqrt(size2))) return;
  const bool faces_eye = offset < 0;
  const double turn = faces_eye ? -1 : 1;

  const int n = deltas_->resolution;
  for (std::size_t face = 0; face < 5; ++face) {
    if (outside_face(local_, face)) continue;
    edges_.clear();
    for (std::size_t k = 0; k < local_.size(); ++k) {
      const Vec3d inward = turn * cross(local_[k], local_[(k + 1) % local_.size()]);
      edges_.push_back({to_face(face, inward), keeps_rim(inward)});
    }
    const Vec3d slope = to_face(face, plane) / offset;
    const auto [first_row, last_row] = row_range(local_, face, n);
    for (int row = first_row; row < last_row; ++row) {
      const double v = row_middle(face, row, n);
      const auto [first, last] = column_range(edges_, v, n);
      for (int column = first; column < last; ++column) {
        const Vec3d d(middle(column, n), v, 1);
        const double nearness = dot(slope, d);
        if (nearness > 0 && inside_all(edges_, d)) {
          paint(face, static_cast<std::size_t>(row * n + column), nearness, faces_eye);
        }
      }
    }
  }
}

void Hemicube::draw(std::span<const Vec3d> polygon, std::uint32_t item) {
  rasterise(polygon, [&](std::size_t face, std::size_t pixel, double nearness, bool faces_eye) {
    const double now = nearness_[face][pixel];
    const bool nearer = nearness > now * (1 + equal_depth);
    const bool front_of_the_same_plate =
        faces_eye && items_[face][pixel] == nothing && nearness >= now * (1 - equal_depth);
    if (nearer || front_of_the_same_plate) this->paint(face, pixel, faces_eye ? item : nothing, nearness);
  });
}

void Hemicube::draw_behind(std::span<const Vec3d> polygon, std::uint32_t item) {
  rasterise(polygon, [&](std::size_t face, std::size_t pixel, double nearness, bool faces_eye) {
    if (nearness_[face][pixel] == 0) this->paint(face, pixel, faces_eye ? item : nothing, nearness);
  });
}

double Hemicube::cover(std::span<const Vec3d> polygon) {
  double sum = 0;
  rasterise(polygon, [&](std::size_t face, std::size_t pixel, double, bool) {
    sum += face == 0 ? deltas_->top[pixel] : deltas_->side[pixel];
  });
  return sum;
}

void Hemicube::cast(const PatchTracer& tracer, std::uint32_t from) {
  const Vec3d origin = tracer.leave_patch(from, eye_, frame_.normal).origin;
  const int n = deltas_->resolution;
  RayPacket rays{};
  std::uint32_t met[RayPacket::size];
  for (std::size_t face = 0; face < 5; ++face) {
    for (int row = 0; row < rows_of(face, n); ++row) {
      for (int first = 0; first < n; first += RayPacket::size) {
        for (int lane = 0; lane < RayPacket::size; ++lane) {
          const int column = std::min(first + lane, n - 1);
          const Vec3d d = frame_.to_world(from_face(face, {middle(column, n), row_middle(face, row, n), 1}));
          rays.origin_x[lane] = static_cast<float>(origin.x);
          rays.origin_y[lane] = static_cast<float>(origin.y);
          rays.origin_z[lane] = static_cast<float>(origin.z);
          rays.direction_x[lane] = static_cast<float>(d.x);
          rays.direction_y[lane] = static_cast<float>(d.y);
          rays.direction_z[lane] = static_cast<float>(d.z);
          rays.t_min[lane] = 0;
          rays.t_max[lane] = std::numeric_limits<float>::infinity();
          rays.active[lane] = first + lane < n ? -1 : 0;
        }
        tracer.first_front(rays, met);
        for (int lane = 0; lane < RayPacket::size && first + lane < n; ++lane) {
          items_[face][static_cast<std::size_t>(row * n + first + lane)] = met[lane];
        }
      }
    }
  }
}

std::vector<HemicubeSight> Hemicube::sights(std::size_t item_count) const {
  std::vector<HemicubeSight> of_item(item_count);
  for (std::size_t face = 0; face < 5; ++face) {
    const std::vector<double>& delta = face == 0 ? deltas_->top : deltas_->side;
    for (std::size_t pixel = 0; pixel < items_[face].size(); ++pixel) {
      const std::uint32_t item = items_[face][pixel];
      if (item == nothing) continue;
      of_item[item].patch = item;
      of_item[item].factor += delta[pixel];
      ++of_item[item].pixels;
    }
  }
  std::erase_if(of_item, [](const HemicubeSight& s) { return s.pixels == 0; });
  return of_item;
}

std::vector<double> hemicube_factors(const PatchMesh& mesh, const Vec3d& eye, const Frame& frame, int resolution) {
  Hemicube hemicube(std::make_shared<HemicubeDeltas>(resolution));
  hemicube.place(eye, frame);
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    hemicube.draw(mesh.polygon(p), p < mesh.radiating_count ? p : Hemicube::nothing);
  }
  std::vector<double> factors(mesh.patch_count(), 0.0);
  for (const HemicubeSight& sight : hemicube.sights(mesh.patch_count())) factors[sight.patch] = sight.factor;
  return factors;
}

namespace {

class HemicubeMethod final : public FormFactorMethod {
 public:
  HemicubeMethod(const PatchMesh& mesh, const HemicubeOptions& options)
      : mesh_(mesh), options_(options), deltas_(std::make_shared<HemicubeDeltas>(options.resolution)) {
    if (!(options.exact_within >= 0)) throw std::invalid_argument("the hemicube's exact range should not be negative");
    for (std::uint32_t p = 0; p < mesh.radiating_count; ++p) radii_.push_back(radius_of(mesh, p));
    if (options.visibility == HemicubeVisibility::bsp_tree) tree_.emplace(mesh, options.seed);
    if (options.visibility == HemicubeVisibility::rays) tracer_.emplace(mesh);
    rows_a_block_ = std::clamp<std::size_t>(100000 / std::max<std::size_t>(mesh.radiating_count, 1), 1, 16);
  }

  [[nodiscard]] std::string_view name() const override { return "hemicube"; }
  [[nodiscard]] std::size_t block_count() const override {
    return (mesh_.radiating_count + rows_a_block_ - 1) / rows_a_block_;
  }
  [[nodiscard]] FactorBlock block(std::size_t index) const override {
    FactorBlock block;
    Hemicube hemicube(deltas_);
    ExchangeAreaScratch scratch;
    const std::size_t last = std::min(mesh_.radiating_count, (index + 1) * rows_a_block_);
    for (std::size_t i = index * rows_a_block_; i < last; ++i) {
      const auto patch = static_cast<std::uint32_t>(i);
      look_from(patch, hemicube);
      // Row i gives half of each of its pairs; the other half comes from row j.
      visit_row(patch, hemicube, scratch, [&](std::uint32_t j, double exchange, double error) {
        block.pairs.push_back(
            {std::min(patch, j), std::max(patch, j), 0.5 * exchange, static_cast<float>(0.5 * error)});
      });
    }
    return block;
  }
  [[nodiscard]] bool computes_rows() const override { return true; }
  [[nodiscard]] PatchRow row(std::uint32_t patch) const override {
    Hemicube hemicube(deltas_);
    ExchangeAreaScratch scratch;
    look_from(patch, hemicube);
    std::vector<std::pair<std::uint32_t, double>> found;
    visit_row(patch, hemicube, scratch,
              [&](std::uint32_t j, double exchange, double) { found.emplace_back(j, exchange); });
    std::sort(found.begin(), found.end());
    PatchRow row;
    for (const auto& [j, exchange] : found) {
      row.patches.push_back(j);
      row.exchanges.push_back(exchange);
    }
    return row;
  }

 private:
  void look_from(std::uint32_t i, Hemicube& hemicube) const {
    CounterRng random(hash_key(options_.seed, i));
    const double angle = options_.rotate ? 0.5 * std::numbers::pi * random.next() : generic_angle;
    hemicube.place(mesh_.centroids[i], turned(mesh_.normals[i], angle));
    if (tracer_) {
      hemicube.cast(*tracer_, i);
    } else if (tree_) {
      const Plane3 horizon{mesh_.normals[i], dot(mesh_.normals[i], mesh_.centroids[i])};
      tree_->front_to_back(mesh_.centroids[i], horizon, [&](const BspTree::Fragment& f) {
        if (f.patch != i) hemicube.draw_behind(f.polygon, item_of(f.patch));
      });
    } else {
      for (std::uint32_t p = 0; p < mesh_.patch_count(); ++p) {
        if (p != i) hemicube.draw(mesh_.polygon(p), item_of(p));
      }
    }
  }

  [[nodiscard]] std::uint32_t item_of(std::uint32_t patch) const {
    return patch < mesh_.radiating_count ? patch : Hemicube::nothing;
  }

  [[nodiscard]] bool takes_exact(std::uint32_t i, std::uint32_t j) const {
    const double reach = options_.exact_within * (radii_[i] + radii_[j]);
    return length_squared(mesh_.centroids[j] - mesh_.centroids[i]) < reach * reach;
  }

  // What the hemicube at patch i saw, each partner once: `visit(j, exchange, error)`.
  template <class Visit>
  void visit_row(std::uint32_t i, Hemicube& hemicube, ExchangeAreaScratch& scratch, const Visit& visit) const {
    const auto sights = hemicube.sights(mesh_.radiating_count);
    const auto add = [&](std::uint32_t j, double exchange, double error) {
      if (exchange > 0 && i != j) visit(j, exchange, error);
    };
    for (const HemicubeSight& sight : sights) {
      if (sight.patch == i || takes_exact(i, sight.patch)) continue;
      add(sight.patch, mesh_.areas[i] * sight.factor, mesh_.areas[i] * far_error(i, sight));
    }
    if (options_.exact_within <= 0) return;
    auto seen = sights.begin();
    for (std::uint32_t j = 0; j < mesh_.radiating_count; ++j) {
      while (seen != sights.end() && seen->patch < j) ++seen;
      if (j == i || !takes_exact(i, j) || !has_corner_in_front(mesh_, i, j) || !has_corner_in_front(mesh_, j, i))
        continue;
      const bool sighted = seen != sights.end() && seen->patch == j;
      const double share = visible_share(i, j, sighted ? seen->factor : 0.0, hemicube);
      if (share <= 0) continue;
      const double whole = exchange_area(mesh_.polygon(i), mesh_.polygon(j), scratch);
      add(j, share * whole, std::min(share, 1 - share) * whole);
    }
  }

  // The part of a near patch's pixels that nothing covers; a patch too small for a pixel is seen or not.
  [[nodiscard]] double visible_share(std::uint32_t i, std::uint32_t j, double seen, Hemicube& hemicube) const {
    const double alone = hemicube.cover(mesh_.polygon(j));
    if (alone > 0) return std::min(1.0, seen / alone);
    return centres_see_each_other(i, j) ? 1.0 : 0.0;
  }

  [[nodiscard]] bool centres_see_each_other(std::uint32_t i, std::uint32_t j) const {
    const Vec3d &from = mesh_.centroids[i], &to = mesh_.centroids[j];
    if (!(dot(mesh_.normals[i], to - from) > 0) || !(dot(mesh_.normals[j], from - to) > 0)) return false;
    const double slack = 1e-9 * length(to - from);
    for (std::uint32_t k = 0; k < mesh_.patch_count(); ++k) {
      const double a = dot(mesh_.normals[k], from - mesh_.centroids[k]);
      const double b = dot(mesh_.normals[k], to - mesh_.centroids[k]);
      if (std::abs(a) <= slack || std::abs(b) <= slack || (a > 0) == (b > 0)) continue;
      if (convex_contains(mesh_.polygon(k), from + a / (a - b) * (to - from))) return false;
    }
    return true;
  }

  // Pixels wrongly given to one side of the outline, and the one point that stands for patch i.
  [[nodiscard]] double far_error(std::uint32_t i, const HemicubeSight& sight) const {
    const double pixel = sight.factor / sight.pixels;
    const double r2 = length_squared(mesh_.centroids[sight.patch] - mesh_.centroids[i]);
    const double one_point = radii_[i] * radii_[i] / std::max(r2, radii_[i] * radii_[i]);
    return pixel * std::sqrt(static_cast<double>(sight.pixels)) + sight.factor * one_point;
  }

  const PatchMesh& mesh_;
  HemicubeOptions options_;
  std::shared_ptr<const HemicubeDeltas> deltas_;
  std::vector<double> radii_;
  std::optional<BspTree> tree_;
  std::optional<PatchTracer> tracer_;
  std::size_t rows_a_block_ = 1;
};

}  // namespace

std::unique_ptr<FormFactorMethod> make_hemicube(const PatchMesh& mesh, const HemicubeOptions& options) {
  return std::make_unique<HemicubeMethod>(mesh, options);
}

}  // namespace penumbra
