#include "penumbra/radiosity/form_factors/near_origin.h"

#include <utility>

#include "penumbra/math/bounds.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {
namespace {

/// Meshes whose middle is further away than so many times their diagonal are moved.
constexpr double far_away = 100;

/// A method together with the mesh that it looks at.
class MethodOnMovedMesh final : public FormFactorMethod {
 public:
  MethodOnMovedMesh(PatchMesh mesh, const std::function<std::unique_ptr<FormFactorMethod>(const PatchMesh&)>& make)
      : mesh_(std::move(mesh)), method_(make(mesh_)) {}

  [[nodiscard]] std::string_view name() const override { return method_->name(); }
  [[nodiscard]] std::size_t block_count() const override { return method_->block_count(); }
  [[nodiscard]] FactorBlock block(std::size_t index) const override { return method_->block(index); }
  [[nodiscard]] double block_cost(std::size_t index) const override { return method_->block_cost(index); }
  [[nodiscard]] bool computes_rows() const override { return method_->computes_rows(); }
  [[nodiscard]] PatchRow row(std::uint32_t patch) const override { return method_->row(patch); }

 private:
  PatchMesh mesh_;
  std::unique_ptr<FormFactorMethod> method_;
};

PatchMesh moved(PatchMesh mesh, const Vec3d& by) {
  for (Vec3d& p : mesh.vertices) p += by;
  for (Vec3d& p : mesh.corner_positions) p += by;
  for (Vec3d& p : mesh.centroids) p += by;
  return mesh;
}

}  // namespace

std::unique_ptr<FormFactorMethod> make_near_origin(
    const PatchMesh& mesh, const std::function<std::unique_ptr<FormFactorMethod>(const PatchMesh&)>& make) {
  Bounds all;
  for (const Vec3d& v : mesh.vertices) all.grow(v);
  if (mesh.vertices.empty()) return make(mesh);
  const Vec3d middle = 0.5 * (all.lower + all.upper);
  if (length(middle) <= far_away * all.diagonal()) return make(mesh);
  return std::make_unique<MethodOnMovedMesh>(moved(mesh, -middle), make);
}

}  // namespace penumbra
