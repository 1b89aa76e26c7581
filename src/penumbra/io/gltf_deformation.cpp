#include "penumbra/io/gltf_deformation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

Vec3d vector_at(const GltfElements& elements, std::size_t i) {
  return {elements.value(i, 0), elements.value(i, 1), elements.value(i, 2)};
}

std::vector<Vec3d> vectors_of(const std::optional<GltfElements>& elements) {
  std::vector<Vec3d> all;
  if (!elements) return all;
  all.reserve(elements->count);
  for (std::size_t i = 0; i < elements->count; ++i) all.push_back(vector_at(*elements, i));
  return all;
}

// Displacements of one attribute, times the target's weight.
void add_target(const JsonPlace& target, const char* name, double weight, GltfAccessors& accessors,
                std::vector<Vec3d>& vertices) {
  const auto index = target.whole(name);
  if (!index || vertices.empty()) return;
  const GltfElements& change = accessors.elements(*index, target);
  if (change.count != vertices.size() || change.components != 3) {
    target.fail(
        fmt::format("its {} has {} elements of {} numbers, but the primitive has {} vertices; export the file again",
                    name, change.count, change.components, vertices.size()));
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] += weight * vector_at(change, i);
}

/// The matrix that a vertex moves by; the shares are made to sum to 1, as quantised ones do not quite.
class Blend {
 public:
  Blend(const std::vector<Mat4d>& joints, const DeformedAttributes& from, const JsonPlace& primitive)
      : joints_(joints), from_(from), primitive_(primitive) {}

  /// Nothing where no joint has a share.
  [[nodiscard]] std::optional<Mat4d> at(std::size_t vertex) const {
    Mat4d sum(0.0);
    double shares = 0;
    for (std::size_t set = 0; set < 2; ++set) {
      if (!from_.joints[set] || !from_.weights[set]) continue;
      for (int c = 0; c < 4; ++c) {
        const double share = from_.weights[set]->value(vertex, c);
        if (!(share > 0) || !std::isfinite(share)) continue;
        const std::uint32_t joint = from_.joints[set]->index(vertex, c);
        if (joint >= joints_.size()) {
          primitive_.fail(fmt::format("vertex {} hangs on joint {}, but its skin has {}; export the file again", vertex,
                                      joint, joints_.size()));
        }
        sum += share * joints_[joint];
        shares += share;
      }
    }
    return shares > 0 ? std::optional(sum / shares) : std::nullopt;
  }

 private:
  const std::vector<Mat4d>& joints_;
  const DeformedAttributes& from_;
  const JsonPlace& primitive_;
};

bool are_joints(const std::optional<GltfElements>& joints, const std::optional<GltfElements>& weights) {
  return joints && weights && joints->components == 4 && weights->components == 4 &&
         (joints->type == GltfComponent::uint8 || joints->type == GltfComponent::uint16);
}

std::vector<float> packed(const std::vector<Vec3d>& vectors) {
  std::vector<float> numbers;
  numbers.reserve(3 * vectors.size());
  for (const Vec3d& v : vectors) {
    for (int c = 0; c < 3; ++c) numbers.push_back(static_cast<float>(v[c]));
  }
  return numbers;
}

}  // namespace

bool GltfDeformation::morphs() const {
  return std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; });
}

std::vector<Mat4d> gltf_joints(GltfDocument& document, GltfAccessors& accessors, const std::vector<Mat4d>& to_world,
                               std::uint64_t index, const JsonPlace& user) {
  const JsonPlace skin = document.item("skins", "skin", index, user);
  const auto list = skin.list("joints");
  if (!list || list->size() == 0) skin.fail("has no joints; export the file again");
  document.count_work(list->size(), user);
  std::optional<GltfElements> inverse;
  if (const auto accessor = skin.whole("inverseBindMatrices")) inverse = accessors.elements(*accessor, skin);
  if (inverse && (inverse->components != 16 || inverse->count < list->size())) {
    skin.fail(fmt::format("its inverseBindMatrices are not {} 4 x 4 matrices; export the file again", list->size()));
  }
  std::vector<Mat4d> joints;
  for (std::size_t j = 0; j < list->size(); ++j) {
    const std::uint64_t node = list->whole_item(j);
    if (node >= to_world.size())
      skin.fail(fmt::format("names node {} as a joint, which is not there; export the file again", node));
    Mat4d bind(1.0);
    for (int k = 0; inverse && k < 16; ++k) bind[k / 4][k % 4] = inverse->value(j, k);
    joints.push_back(to_world[node] * bind);
  }
  return joints;
}

DeformedVertices deformed(const GltfDeformation& deformation, const DeformedAttributes& from, GltfDocument& document,
                          GltfAccessors& accessors, const JsonPlace& primitive) {
  document.count_work(from.position.count, primitive);
  std::vector<Vec3d> positions = vectors_of(from.position);
  std::vector<Vec3d> normals = vectors_of(from.normal);
  std::vector<Vec3d> tangents = vectors_of(from.tangent);
  const auto targets = primitive.list("targets");
  for (std::size_t t = 0; targets && t < std::min(targets->size(), deformation.weights.size()); ++t) {
    const double weight = deformation.weights[t];
    if (weight == 0) continue;
    document.count_work(positions.size(), primitive);
    const JsonPlace target = targets->item(t, primitive.place() + ", target");
    add_target(target, "POSITION", weight, accessors, positions);
    add_target(target, "NORMAL", weight, accessors, normals);
    add_target(target, "TANGENT", weight, accessors, tangents);
  }
  if (!deformation.joints.empty() && are_joints(from.joints[0], from.weights[0])) {
    const Blend blend(deformation.joints, from, primitive);
    std::size_t without = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const auto matrix = blend.at(i);
      if (!matrix) {
        ++without;
        continue;
      }
      positions[i] = transform_point(*matrix, positions[i]);
      if (!normals.empty()) normals[i] = normal_matrix(*matrix) * normals[i];
      if (!tangents.empty()) tangents[i] = transform_vector(*matrix, tangents[i]);
    }
    document.warnings().count("vertices that hang on no joint stay where they are", primitive.place(), without);
  } else if (!deformation.joints.empty()) {
    document.warnings().count("a skinned mesh without JOINTS_0 and WEIGHTS_0 stays as it is", primitive.place());
  }
  DeformedVertices made{packed(positions), packed(normals), {}};
  for (std::size_t i = 0; i < tangents.size(); ++i) {
    for (int c = 0; c < 3; ++c) made.tangents.push_back(static_cast<float>(tangents[i][c]));
    made.tangents.push_back(static_cast<float>(from.tangent->value(i, 3)));
  }
  return made;
}

}  // namespace penumbra
