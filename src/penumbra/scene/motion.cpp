#include "penumbra/scene/motion.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

double largest_entry(const Mat4d& m) {
  double largest = 0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) largest = std::max(largest, std::abs(m[column][row]));
  }
  return largest;
}

// How far the straight way between steps leads from the truth, at the middle and the quarters: a full turn from step to
// step would be back at the middle.
double deviation(const Motion& motion, const std::function<Mat4d(double)>& placement) {
  const auto segments = static_cast<double>(motion.size() - 1);
  double most = 0;
  for (std::size_t s = 0; s + 1 < motion.size(); ++s) {
    for (const double share : {0.25, 0.5, 0.7}) {
      const double time = (static_cast<double>(s) + share) / segments;
      const Mat4d truth = placement(time);
      most = std::max(most, largest_entry(placement_at(motion, time) - truth) / std::max(1e-300, largest_entry(truth)));
    }
  }
  return most;
}

}  // namespace

Mat4d placement_at(const Motion& motion, double time) {
  const auto segments = static_cast<double>(motion.size() - 1);
  const double at = std::clamp(time, 0.0, 1.0) * segments;
  const auto step = std::min(static_cast<std::size_t>(at), motion.size() - 2);
  const double share = at - static_cast<double>(step);
  return (1 - share) * motion[step] + share * motion[step + 1];
}

Motion sampled_motion(const std::function<Mat4d(double)>& placement, double tolerance) {
  Motion motion;
  for (std::size_t segments = 1; segments < most_motion_steps; segments *= 2) {
    motion.clear();
    for (std::size_t s = 0; s <= segments; ++s) {
      motion.push_back(placement(static_cast<double>(s) / static_cast<double>(segments)));
    }
    if (deviation(motion, placement) <= tolerance) break;
  }
  const bool rests = std::all_of(motion.begin(), motion.end(), [&](const Mat4d& m) { return m == motion.front(); });
  return rests ? Motion() : motion;
}

}  // namespace penumbra
