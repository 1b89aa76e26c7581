#include "penumbra/radiosity/pipeline/patch_exchange.h"

#include <numeric>
#include <utility>
#include <vector>

#include "penumbra/radiosity/form_factors/auto.h"

namespace penumbra {

PatchExchange::PatchExchange(const PatchMesh& patches, std::span<const std::uint32_t> senders,
                             const PatchMesh& elements, const std::shared_ptr<const OccluderPolygons>& occluders,
                             FormFactorOptions options, std::size_t surveyed)
    : sender_count_(senders.size()) {
  mesh_.bands = 1;
  mesh_.surfaces.resize(2);
  mesh_.reflectance.resize(2);
  mesh_.emission.resize(2);
  for (const std::uint32_t p : senders) add(patches.polygon(p), 0);
  for (std::size_t e = 0; e < elements.patch_count(); ++e) add(elements.polygon(e), 1);
  mesh_.radiating_count = mesh_.patch_count();
  options.between_surfaces_only = true;
  AutoFormFactors::Settings settings;
  settings.occluders = occluders;
  settings.surveyed_clusters = surveyed;
  method_ = std::make_unique<AutoFormFactors>(mesh_, options, settings);
}

PatchRow PatchExchange::from_sender(std::size_t sender) const {
  PatchRow row = method_->row(static_cast<std::uint32_t>(sender));
  for (std::uint32_t& j : row.patches) j -= static_cast<std::uint32_t>(sender_count_);
  const double sent = std::accumulate(row.exchanges.begin(), row.exchanges.end(), 0.0);
  if (sent > mesh_.areas[sender]) {
    for (double& exchange : row.exchanges) exchange *= mesh_.areas[sender] / sent;
  }
  return row;
}

PatchRow PatchExchange::from_element(std::size_t element) const {
  return method_->row(static_cast<std::uint32_t>(sender_count_ + element));
}

void PatchExchange::add(std::span<const Vec3d> polygon, std::uint32_t surface) {
  std::vector<std::uint32_t> corners;
  for (const Vec3d& p : polygon) {
    corners.push_back(static_cast<std::uint32_t>(mesh_.vertices.size()));
    mesh_.vertices.push_back(p);
  }
  add_patch(mesh_, corners, surface, 0);
}

}  // namespace penumbra
