#include "penumbra/tracing/sphere_groups.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <span>

#include "penumbra/math/bounds.h"

namespace penumbra {
namespace {

constexpr std::uint32_t most_in_group = 8;

SphereGroups::Sieve unmet() {
  SphereGroups::Sieve sieve{};
  std::fill(std::begin(sieve.reach), std::end(sieve.reach), -std::numeric_limits<float>::infinity());
  return sieve;
}

void put(const Sphere& sphere, std::size_t i, SphereGroups::Sieve& sieve) {
  const Vec3f c(sphere.centre);
  sieve.centre_x[i] = c.x, sieve.centre_y[i] = c.y, sieve.centre_z[i] = c.z;
  sieve.minus_x[i] = -2 * c.x, sieve.minus_y[i] = -2 * c.y, sieve.minus_z[i] = -2 * c.z;
  const double c2 = dot(Vec3d(c), Vec3d(c));
  sieve.reach[i] =
      static_cast<float>(sphere.radius * sphere.radius * (1 + SphereGroups::slack) - c2 * (1 - SphereGroups::slack));
}

Sphere ball_around(std::span<const SphereGroups::Entry> spheres) {
  Bounds box;
  for (const auto& s : spheres) box.grow(s.sphere.centre);
  Sphere ball{0.5 * (box.lower + box.upper), 0};
  for (const auto& s : spheres) {
    ball.radius = std::max(ball.radius, length(s.sphere.centre - ball.centre) + s.sphere.radius);
  }
  ball.radius *= 1 + 1e-6;  // the sieve has its centre in single precision
  ball.radius += 1e-6 * length(ball.centre);
  return ball;
}

}  // namespace

void SphereGroups::add(const Sphere& sphere, std::uint32_t object) {
  entries.push_back({sphere, object});
  around.clear();
  groups.clear();
  split(0, static_cast<std::uint32_t>(entries.size()));
}

// Halves at the median along the longest side until a group is small enough.
void SphereGroups::split(std::uint32_t first, std::uint32_t last) {
  const auto members = std::span(entries).subspan(first, last - first);
  if (members.size() > most_in_group) {
    Bounds box;
    for (const Entry& s : members) box.grow(s.sphere.centre);
    const Vec3d side = box.upper - box.lower;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    std::sort(members.begin(), members.end(), [&](const Entry& a, const Entry& b) {
      const double u = a.sphere.centre[axis], v = b.sphere.centre[axis];
      return u != v ? u < v : a.object < b.object;
    });
    const std::uint32_t middle = first + (last - first) / 2;
    split(first, middle);
    split(middle, last);
    return;
  }
  const std::size_t number = groups.size();
  if (number % Sieve::size == 0) around.push_back(unmet());
  put(ball_around(members), number % Sieve::size, around.back());
  Group& group = groups.emplace_back(Group{unmet(), first, last - first});
  for (std::size_t i = 0; i < members.size(); ++i) put(members[i].sphere, i, group.sieve);
}

}  // namespace penumbra
