#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "penumbra/io/spool_file.h"

namespace penumbra {

/// Entries of a sparse matrix that come in any order and leave row by row, with a bound on memory: beyond it they wait
/// on disk, in as many bands of rows as it takes to sort one at a time.
class TripletSpill {
 public:
  struct Triplet {
    std::uint32_t row = 0, column = 0;
    double value = 0;
  };

  /// @param beside a file in whose folder entries may wait. @param bytes of memory that entries may take.
  TripletSpill(const std::filesystem::path& beside, std::size_t rows, std::size_t bytes);

  void add(const Triplet& entry);
  /// Hands over every row in order, columns ascending, entries of the same place added up in the order of their coming.
  /// Empties the spill.
  void for_each_row(const std::function<void(std::size_t row, std::span<const std::uint32_t> columns,
                                             std::span<const double> values)>& visitor);
  [[nodiscard]] std::uint64_t bytes_on_disk() const;

 private:
  struct Band {
    std::vector<Triplet> waiting;
    std::vector<SpoolFile> disk;  // none or one
    std::uint64_t spilled = 0;
  };
  void spill();

  std::filesystem::path beside_;
  std::size_t rows_;
  std::size_t rows_a_band_;
  std::size_t most_waiting_;
  std::size_t waiting_ = 0;
  std::vector<Band> bands_;
};

}  // namespace penumbra
