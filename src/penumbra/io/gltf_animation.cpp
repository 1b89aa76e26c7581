#include "penumbra/io/gltf_animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "penumbra/io/gltf_choice.h"

namespace penumbra {
namespace {

Mat4d rotation_of(const std::array<double, 4>& q, const JsonPlace& place) {
  const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(size > 0) || !std::isfinite(size))
    place.fail("its rotation is no quaternion of length 1; export the file again");
  const double x = q[0] / size;
  const double y = q[1] / size;
  const double z = q[2] / size;
  const double w = q[3] / size;
  return {Vec4d(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0),
          Vec4d(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0),
          Vec4d(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0), Vec4d(0, 0, 0, 1)};
}

Mat4d matrix_of(const JsonPlace& place) {
  const auto m = place.numbers<16>("matrix", {});
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) {
    place.fail("its matrix is not affine (its last row must be 0 0 0 1); export the file again");
  }
  Mat4d matrix;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) matrix[column][row] = m[static_cast<std::size_t>(4 * column + row)];
  }
  return matrix;
}

// Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985; the shorter way.
std::vector<double> slerp(const double* a, const double* b, double share) {
  double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const double side = cosine < 0 ? -1 : 1;
  cosine = std::min(1.0, std::abs(cosine));
  const double angle = std::acos(cosine);
  const bool tiny = angle < 1e-6;
  const double wa = tiny ? 1 - share : std::sin((1 - share) * angle) / std::sin(angle);
  const double wb = side * (tiny ? share : std::sin(share * angle) / std::sin(angle));
  std::vector<double> q(4);
  for (std::size_t i = 0; i < 4; ++i) q[i] = wa * a[i] + wb * b[i];
  return q;
}

}  // namespace

GltfAnimation::GltfAnimation(GltfDocument& document, GltfAccessors& accessors,
                             const std::optional<std::string>& choice) {
  const auto index = chosen_gltf_item(document, "animations", "animation", choice);
  if (!index) return;
  const JsonPlace animation = document.item("animations", "animation", *index, document.root());
  const auto channels = animation.list("channels");
  if (!channels) return;
  for (std::size_t i = 0; i < channels->size(); ++i) {
    read_channel(document, accessors, animation, channels->item(i, animation.place() + ", channel"));
  }
}

void GltfAnimation::read_channel(GltfDocument& document, GltfAccessors& accessors, const JsonPlace& animation,
                                 const JsonPlace& channel) {
  const auto target = channel.object("target");
  if (!target) channel.fail("has no target; export the file again");
  const auto node = target->whole("node");
  const std::string name = target->text("path");
  const std::array<std::pair<std::string_view, std::size_t>, 4> paths{
      {{"translation", 3}, {"rotation", 4}, {"scale", 3}, {"weights", 0}}};
  const auto known = std::find_if(paths.begin(), paths.end(), [&](const auto& p) { return name == p.first; });
  if (!node || known == paths.end()) return;  // an extension's business

  const auto samplers = animation.list("samplers");
  const std::uint64_t index = channel.required_whole("sampler");
  if (!samplers || index >= samplers->size())
    channel.fail(fmt::format("names sampler {}, which is not there; export the file again", index));
  const JsonPlace sampler = samplers->item(static_cast<std::size_t>(index), animation.place() + ", sampler");
  const GltfElements times = accessors.elements(sampler.required_whole("input"), sampler);
  const GltfElements values = accessors.elements(sampler.required_whole("output"), sampler);
  Track track;
  const std::string way = sampler.text("interpolation");
  if (way == "STEP") track.interpolation = Interpolation::step;
  if (way == "CUBICSPLINE") track.interpolation = Interpolation::cubic;
  if (times.count == 0 || times.components != 1)
    sampler.fail("its times are no list of numbers; export the file again");
  const std::size_t parts = track.interpolation == Interpolation::cubic ? 3 : 1;
  const std::size_t numbers = values.count * static_cast<std::size_t>(values.components);
  track.width = numbers / times.count / parts;
  const bool fits = track.width > 0 && track.width * parts * times.count == numbers &&
                    (known->second == 0 || track.width == known->second);
  if (!fits) {
    sampler.fail(fmt::format("has {} numbers of {} for {} keys; export the file again", numbers, name, times.count));
  }
  document.count_work(times.count + numbers, sampler);
  for (std::size_t i = 0; i < times.count; ++i) {
    track.times.push_back(times.value(i, 0));
    if (!std::isfinite(track.times.back()) || (i > 0 && track.times[i] < track.times[i - 1])) {
      sampler.fail(fmt::format("its times do not increase (key {}); export the file again", i));
    }
  }
  for (std::size_t i = 0; i < values.count; ++i) {
    for (int c = 0; c < values.components; ++c) {
      track.values.push_back(values.value(i, c));
      if (!std::isfinite(track.values.back()))
        sampler.fail(fmt::format("key value {} is not a finite number; export the file again", i));
    }
  }
  tracks_[std::pair(static_cast<std::uint32_t>(*node), static_cast<Path>(known - paths.begin()))] = std::move(track);
}

std::vector<double> GltfAnimation::Track::at(double time, bool is_rotation) const {
  const std::size_t parts = interpolation == Interpolation::cubic ? 3 : 1;
  const auto key = [&](std::size_t k, std::size_t part) { return values.data() + (k * parts + part) * width; };
  const std::size_t middle = parts == 3 ? 1 : 0;
  const auto after = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  const std::size_t k = after == 0 ? 0 : after - 1;
  const double* here = key(k, middle);
  std::vector<double> value(here, here + width);
  if (after == 0 || after == times.size() || interpolation == Interpolation::step) return value;
  const double length = times[k + 1] - times[k];
  const double t = (time - times[k]) / length;
  const double* next = key(k + 1, middle);
  if (interpolation == Interpolation::linear) {
    if (is_rotation) return slerp(here, next, t);
    for (std::size_t i = 0; i < width; ++i) value[i] = (1 - t) * here[i] + t * next[i];
    return value;
  }
  // Cubic Hermite; tangents are per second.
  const double t2 = t * t;
  const double t3 = t2 * t;
  for (std::size_t i = 0; i < width; ++i) {
    value[i] = (2 * t3 - 3 * t2 + 1) * here[i] + length * (t3 - 2 * t2 + t) * key(k, 2)[i] +
               (3 * t2 - 2 * t3) * next[i] + length * (t3 - t2) * key(k + 1, 0)[i];
  }
  return value;
}

const GltfAnimation::Track* GltfAnimation::find(std::uint32_t node, Path path) const {
  const auto found = tracks_.find({node, path});
  return found == tracks_.end() ? nullptr : &found->second;
}

bool GltfAnimation::moves(std::uint32_t node) const {
  return find(node, Path::translation) != nullptr || find(node, Path::rotation) != nullptr ||
         find(node, Path::scale) != nullptr;
}

Mat4d GltfAnimation::to_parent(const JsonPlace& place, std::uint32_t node, std::optional<double> time) const {
  const bool moving = time && moves(node);
  if (place.has("matrix") && !moving) return matrix_of(place);
  auto t = place.numbers<3>("translation", {0, 0, 0});
  auto r = place.numbers<4>("rotation", {0, 0, 0, 1});
  auto s = place.numbers<3>("scale", {1, 1, 1});
  const auto play = [&](Path path, auto& value) {
    if (const Track* track = time ? find(node, path) : nullptr) {
      std::ranges::copy(track->at(*time, path == Path::rotation), value.begin());
    }
  };
  play(Path::translation, t);
  play(Path::rotation, r);
  play(Path::scale, s);
  Mat4d matrix = rotation_of(r, place);
  for (int i = 0; i < 3; ++i) matrix[i] *= s[static_cast<std::size_t>(i)];
  matrix[3] = Vec4d(t[0], t[1], t[2], 1);
  return matrix;
}

std::optional<std::vector<double>> GltfAnimation::weights(std::uint32_t node, std::optional<double> time) const {
  const Track* track = time ? find(node, Path::weights) : nullptr;
  return track != nullptr ? std::optional(track->at(*time, false)) : std::nullopt;
}

}  // namespace penumbra
