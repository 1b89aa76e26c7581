#pragma once

#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace penumbra::bench {

/// What the command line asks for.
struct Arguments {
  std::string json;
  std::string only;     ///< one section's name; empty: all
  std::string program;  ///< path of penumbra, beside this program
  bool quick = false;
};

/// Time that a piece of work took, s.
struct Cost {
  double wall = 0;
  double cpu = 0;  ///< of all threads; on a busy machine the steadier of the two
};

/// @param who RUSAGE_SELF, or RUSAGE_CHILDREN for programs that the work starts and waits for.
template <class Work>
Cost cost_of(int who, const Work& work) {
  const auto cpu = [&] {
    rusage use{};
    getrusage(who, &use);
    return static_cast<double>(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
  };
  const double cpu_before = cpu();
  const auto began = std::chrono::steady_clock::now();
  work();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), cpu() - cpu_before};
}

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Rays per second of the whole renderer against a bare loop over Embree's single rays.
nlohmann::json compare_ray_rates(const Arguments& arguments);
/// Whitted's still life in this program and in POV-Ray, file to PNG.
nlohmann::json compare_with_povray(const Arguments& arguments);
/// The Cornell box: noise and time of `path` and `two-pass`, against Blender's Cycles where it is installed.
nlohmann::json compare_cornell_box(const Arguments& arguments);

}  // namespace penumbra::bench
