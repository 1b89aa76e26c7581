#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "penumbra/parallel/progress.h"

namespace penumbra {

struct PatchMesh;

/// The exchange between two patches of a PatchMesh, stored once for both directions.
///
/// `exchange` is A_i F_ij = A_j F_ji (m^2): the area of i times the share of the power leaving a uniform Lambertian i
/// that arrives at j. So both rows are served and reciprocity holds by construction.
struct PairFactor {
  std::uint32_t i = 0;  ///< patch, i < j
  std::uint32_t j = 0;
  double exchange = 0;  ///< m^2, >= 0
  float error = 0;      ///< estimate of the absolute error of `exchange`, m^2
};

/// Exchange that a block left out because it is below what the tolerance resolves.
struct DroppedExchange {
  std::uint32_t patch = 0;
  double exchange = 0;  ///< m^2, an upper estimate of the sum over the partners left out
};

/// The pairs of one block, in an order that depends on the mesh and the options alone.
struct FactorBlock {
  std::vector<PairFactor> pairs;  ///< pairs that see nothing of each other are absent
  std::vector<DroppedExchange> dropped;
};

/// What one patch sends to all others, by ascending patch: exchanges A_i F_ij, m^2, > 0.
struct PatchRow {
  std::vector<std::uint32_t> patches;
  std::vector<double> exchanges;
};

/// What every method understands; a method says in its own header which of these it reads.
struct FormFactorOptions {
  /// For each patch i the sum over j of |error of F_ij|, dropped factors included, is at most this. Positive.
  double tolerance = 1e-4;
  std::uint64_t seed = 0;
  /// Rays a patch (`ray-cast`); 0 lets the method choose.
  int rays = 0;
  /// Pixels along the edge of the top face (`hemicube`); 0 lets the method choose.
  int resolution = 0;
  /// Leaves out the pairs within one surface (`auto`, `adaptive`): for the factor from one mesh to another.
  bool between_surfaces_only = false;
};

/// A way to compute the form factors of a mesh: it visits the unordered pairs of patches in sparse blocks.
///
/// Blocks are independent: threads and ranks may share them in any way, and each gives the same bits however they do.
/// A block holds at most some 10^5 pairs, so that a few at a time fit in memory. No pair of a patch with itself appears
/// (patches are planar: F_ii = 0). Where a pair appears in several blocks its exchanges and errors add up (a method
/// that works by rows gives each row its half).
///
/// The mesh must outlive the method and stay unchanged. All member functions are thread-safe.
class FormFactorMethod {
 public:
  virtual ~FormFactorMethod() = default;

  /// As on the command line: "auto", "hemicube", ...
  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual std::size_t block_count() const = 0;
  /// @pre index < block_count()
  [[nodiscard]] virtual FactorBlock block(std::size_t index) const = 0;
  /// Relative cost of a block, for progress; need not be exact.
  [[nodiscard]] virtual double block_cost(std::size_t /*index*/) const { return 1; }

  /// Whether the method computes single rows, in a time of the order of one row and O(patches) memory.
  [[nodiscard]] virtual bool computes_rows() const { return false; }
  /// The row of one patch, as seen from that patch alone: for methods that work by rows it is the patch's own estimate,
  /// which is not exactly reciprocal. Throws std::logic_error where the method computes no rows.
  /// @pre patch is a radiating patch of the mesh.
  [[nodiscard]] virtual PatchRow row(std::uint32_t patch) const;
};

/// Computes every block on all threads allowed and hands them to `visitor` in the order of their index, one at a time.
/// Returns false when `progress` asked to stop before the last; the blocks handed over until then are whole.
bool visit_factors(const FormFactorMethod& method, const std::function<void(const FactorBlock&)>& visitor,
                   const Progress& progress = {});

/// The methods that this build knows, in the order of the textbook.
[[nodiscard]] std::span<const std::string_view> form_factor_method_names();

/// Prepares a method for a mesh. Throws std::invalid_argument for an unknown name (naming the known ones) and for
/// an option out of range.
[[nodiscard]] std::unique_ptr<FormFactorMethod> make_form_factor_method(std::string_view name, const PatchMesh& mesh,
                                                                        const FormFactorOptions& options = {});

}  // namespace penumbra
