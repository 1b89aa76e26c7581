#include "penumbra/scene/builtin_atrium_shell.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "penumbra/math/rng.h"

namespace penumbra {

namespace {

using std::numbers::pi;
using Index = std::uint32_t;

/// How finely the shell is divided.
struct Division {
  double spacing = 1;                               ///< m, about the length of an edge
  int floor = 1, wall = 1, ceiling = 1, vault = 3;  ///< intervals across: each wall and ceiling counts twice
  int along = 1;                                    ///< intervals along the nave
  int rings = 1;                                    ///< of each end wall, around its middle

  explicit Division(double s) : spacing(s) {
    const auto intervals = [s](double length, int least) { return std::max(least, static_cast<int>(length / s)); };
    floor = intervals(2 * hall::outer_x, 1);
    wall = intervals(hall::eaves, 1);
    ceiling = intervals(hall::outer_x - hall::court_x, 1);
    vault = intervals(1.5 * pi * hall::court_x, 3);
    along = intervals(2 * hall::outer_z, 1);
    rings = intervals(hall::outer_x, 1);
  }

  [[nodiscard]] std::size_t around() const { return static_cast<std::size_t>(floor + 2 * wall + 2 * ceiling + vault); }
  [[nodiscard]] std::size_t triangles() const {
    return 2 * around() * static_cast<std::size_t>(along) + 2 * around() * static_cast<std::size_t>(2 * rings - 1);
  }
};

Division finest_division(std::size_t triangles) {
  double coarse = 30, fine = 1e-3;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(coarse * fine);
    (Division(middle).triangles() <= triangles ? coarse : fine) = middle;
  }
  Division best(coarse);
  assert(best.triangles() <= triangles);
  best.along += static_cast<int>((triangles - best.triangles()) / (2 * best.around()));
  return best;
}

struct SectionPoint {
  Vec2d at;                ///< (x, y)
  std::uint32_t material;  ///< of the strip that begins here
};

/// The hall cut across, counter-clockwise from the floor's left end.
std::vector<SectionPoint> cross_section(const Division& division, const ShellMaterials& materials) {
  std::vector<SectionPoint> section;
  const auto line = [&](const Vec2d& from, const Vec2d& to, int intervals, std::uint32_t material) {
    for (int i = 0; i < intervals; ++i) section.push_back({from + (to - from) * (1.0 * i / intervals), material});
  };
  const double x = hall::outer_x, y = hall::eaves, r = hall::court_x;
  line({-x, 0}, {x, 0}, division.floor, materials.floor);
  line({x, 0}, {x, y}, division.wall, materials.wall);
  line({x, y}, {r, y}, division.ceiling, materials.vault);
  for (int i = 0; i < division.vault; ++i) {
    const double angle = pi * i / division.vault;
    section.push_back({{r * std::cos(angle), y + r * std::sin(angle)}, materials.vault});
  }
  line({-r, y}, {-x, y}, division.ceiling, materials.vault);
  line({-x, y}, {-x, 0}, division.wall, materials.wall);
  return section;
}

/// Height of ashlar over its wall at (u, v) metres, 0 in the joints: courses of half a metre, each stone bulging a
/// little.
double ashlar(double u, double v, std::uint64_t wall) {
  constexpr double course_height = 0.5, stone_length = 0.9, relief = 0.03;
  const double course = std::floor(v / course_height);
  const double shifted = u / stone_length + 0.5 * std::fmod(std::abs(course), 2.0);
  const double stone = std::floor(shifted);
  CounterRng random(hash_key(wall, static_cast<std::int64_t>(course), static_cast<std::int64_t>(stone)));
  const double proud = 0.5 + 0.5 * random.next();
  const double lean_u = 0.5 * (random.next() - 0.5), lean_v = 0.5 * (random.next() - 0.5);
  const double a = 2 * (shifted - stone) - 1, b = 2 * (v / course_height - course) - 1;
  const double pillow = (1 - std::pow(a, 8)) * (1 - std::pow(b, 8));
  return relief * pillow * (proud + lean_u * a + lean_v * b);
}

class ShellBuilder {
 public:
  ShellBuilder(const Division& division, const ShellMaterials& materials)
      : division_(division), materials_(materials), section_(cross_section(division, materials)) {
    // Stones show once a stone is several triangles long.
    stone_share_ = std::clamp((0.3 - division.spacing) / 0.15, 0.0, 1.0);
    mesh_.name = "shell";
    mesh_.materials.clear();
    mesh_.positions.reserve(division.triangles());
    mesh_.triangles.reserve(division.triangles() + 64);
    mesh_.materials.reserve(division.triangles() + 64);
  }

  Mesh build(std::size_t triangles) {
    add_sides();
    add_end(0, -hall::outer_z, false);
    add_end(static_cast<Index>(division_.along) * around(), hall::outer_z, true);
    split_to(triangles);
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] Index around() const { return static_cast<Index>(section_.size()); }

  void add_triangle(Index a, Index b, Index c, std::uint32_t material) {
    mesh_.triangles.push_back({a, b, c});
    mesh_.materials.push_back(material);
  }

  void add_sides() {
    for (int k = 0; k <= division_.along; ++k) {
      const double z = hall::outer_z * (2.0 * k / division_.along - 1);
      const bool at_end = k == 0 || k == division_.along;
      for (const SectionPoint& p : section_) {
        double x = p.at.x;
        const bool on_wall = std::abs(x) == hall::outer_x && p.at.y > 0 && p.at.y < hall::eaves;
        if (on_wall && !at_end) x -= std::copysign(stone_share_ * ashlar(z, p.at.y, x > 0 ? 1 : 2), x);
        mesh_.positions.emplace_back(x, p.at.y, z);
      }
    }
    for (Index k = 0; k < static_cast<Index>(division_.along); ++k) {
      for (Index i = 0; i < around(); ++i) {
        const Index next = (i + 1) % around();
        const Index a = k * around() + i, b = a + around(), c = (k + 1) * around() + next, d = k * around() + next;
        add_triangle(a, b, c, section_[i].material);
        add_triangle(a, c, d, section_[i].material);
      }
    }
  }

  /// An end wall: rings that shrink from the section's outline, whose vertices begin at `outline`, to a point that sees
  /// all of it.
  void add_end(Index outline, double z, bool faces_minus_z) {
    const Vec2d middle(0, 8);
    const double inwards = faces_minus_z ? -1 : 1;
    const auto vertex = [&](const Vec2d& p) {
      const double relief = stone_share_ * ashlar(p.x, p.y, faces_minus_z ? 3 : 4);
      mesh_.positions.emplace_back(p.x, p.y, z + inwards * relief);
    };
    const auto triangle = [&](Index a, Index b, Index c) {
      faces_minus_z ? add_triangle(a, c, b, materials_.wall) : add_triangle(a, b, c, materials_.wall);
    };
    Index ring = outline;
    for (int j = 1; j < division_.rings; ++j) {
      const double t = 1.0 - 1.0 * j / division_.rings;
      const auto smaller = static_cast<Index>(mesh_.positions.size());
      for (const SectionPoint& p : section_) vertex(middle + t * (p.at - middle));
      for (Index i = 0; i < around(); ++i) {
        const Index next = (i + 1) % around();
        triangle(smaller + i, ring + i, ring + next);
        triangle(smaller + i, ring + next, smaller + next);
      }
      ring = smaller;
    }
    const auto centre = static_cast<Index>(mesh_.positions.size());
    vertex(middle);
    for (Index i = 0; i < around(); ++i) triangle(centre, ring + i, ring + (i + 1) % around());
  }

  /// Makes up the rest by dividing triangles, evenly spread, at their centroids: two more each.
  void split_to(std::size_t triangles) {
    const std::size_t before = mesh_.triangles.size();
    const std::size_t splits = (triangles - before) / 2;
    for (std::size_t s = 0; s < splits; ++s) {
      const std::size_t t = s * before / splits;
      const Mesh::Triangle old = mesh_.triangles[t];
      const auto centre = static_cast<Index>(mesh_.positions.size());
      mesh_.positions.push_back((mesh_.positions[old[0]] + mesh_.positions[old[1]] + mesh_.positions[old[2]]) / 3.0);
      mesh_.triangles[t] = {old[0], old[1], centre};
      const std::uint32_t material = mesh_.materials[t];
      add_triangle(old[1], old[2], centre, material);
      add_triangle(old[2], old[0], centre, material);
    }
  }

  Division division_;
  ShellMaterials materials_;
  std::vector<SectionPoint> section_;
  double stone_share_ = 0;
  Mesh mesh_;
};

}  // namespace

Mesh atrium_shell(std::size_t triangles, const ShellMaterials& materials) {
  return ShellBuilder(finest_division(triangles), materials).build(triangles);
}

}  // namespace penumbra
