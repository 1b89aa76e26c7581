#include "penumbra/radiosity/form_factors/contact_factors.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace penumbra {
namespace {

class ContactFactors final : public FormFactorMethod {
 public:
  ContactFactors(std::unique_ptr<FormFactorMethod> rest, const PatchMesh& mesh)
      : rest_(std::move(rest)), mesh_(mesh), partner_(mesh.radiating_count, none) {
    for (const auto& [a, b] : mesh.contacts) {
      partner_[a] = b;
      partner_[b] = a;
    }
  }

  [[nodiscard]] std::string_view name() const override { return rest_->name(); }
  [[nodiscard]] std::size_t block_count() const override { return rest_->block_count() + 1; }
  [[nodiscard]] double block_cost(std::size_t index) const override {
    return index < rest_->block_count() ? rest_->block_cost(index) : 0;
  }

  /// The last block holds the contacts.
  [[nodiscard]] FactorBlock block(std::size_t index) const override {
    if (index == rest_->block_count()) return contacts();
    FactorBlock block = rest_->block(index);
    std::erase_if(block.pairs, [&](const PairFactor& p) { return partner_[p.i] != none || partner_[p.j] != none; });
    std::erase_if(block.dropped, [&](const DroppedExchange& d) { return partner_[d.patch] != none; });
    return block;
  }

  [[nodiscard]] bool computes_rows() const override { return rest_->computes_rows(); }
  [[nodiscard]] PatchRow row(std::uint32_t patch) const override {
    if (partner_[patch] != none) return {{partner_[patch]}, {mesh_.areas[patch]}};
    const PatchRow all = rest_->row(patch);
    PatchRow kept;
    for (std::size_t k = 0; k < all.patches.size(); ++k) {
      if (partner_[all.patches[k]] != none) continue;
      kept.patches.push_back(all.patches[k]);
      kept.exchanges.push_back(all.exchanges[k]);
    }
    return kept;
  }

 private:
  static constexpr std::uint32_t none = PatchMesh::no_surface;

  [[nodiscard]] FactorBlock contacts() const {
    FactorBlock block;
    for (const auto& [a, b] : mesh_.contacts)
      block.pairs.push_back({std::min(a, b), std::max(a, b), mesh_.areas[a], 0});
    return block;
  }

  std::unique_ptr<FormFactorMethod> rest_;
  const PatchMesh& mesh_;
  std::vector<std::uint32_t> partner_;  // per radiating patch
};

}  // namespace

std::unique_ptr<FormFactorMethod> with_contacts(std::unique_ptr<FormFactorMethod> method, const PatchMesh& mesh) {
  if (mesh.contacts.empty()) return method;
  return std::make_unique<ContactFactors>(std::move(method), mesh);
}

}  // namespace penumbra
