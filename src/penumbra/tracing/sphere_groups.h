#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "penumbra/scene/shape.h"

namespace penumbra {

/// Spheres in groups of neighbours, with what a test in single precision needs to pass those by that rays miss: first
/// whole groups, by balls around them, then the spheres of a group. It never loses one that is met.
struct SphereGroups {
  /// Of |o|^2 + |c|^2: what the test's rounding may amount to is below 2.5e-6 of it.
  static constexpr float slack = 4e-6F;

  /// What is known of sixteen spheres: one that the line origin + t direction, |direction| = 1, meets has
  ///   o.o (1 - slack) + o.m - (o.d - c.d)^2 <= reach,   m = -2 c.
  struct alignas(64) Sieve {
    static constexpr std::size_t size = 16;
    float centre_x[size], centre_y[size], centre_z[size];
    float minus_x[size], minus_y[size], minus_z[size];  // m
    float reach[size];                                  // r^2 - c.c + slack; the unused are never met
  };
  struct Entry {
    Sphere sphere;
    std::uint32_t object;
  };
  /// Neighbours: entries [first, first + count).
  struct Group {
    Sieve sieve;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  std::vector<Sieve> around;  ///< balls around the groups, sixteen each
  std::vector<Group> groups;
  std::vector<Entry> entries;

  /// Adds a sphere and arranges the groups anew. @param object its number in the scene.
  void add(const Sphere& sphere, std::uint32_t object);

 private:
  void split(std::uint32_t first, std::uint32_t last);
};

}  // namespace penumbra
