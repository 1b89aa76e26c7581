#include "penumbra/io/triplet_spill.h"

#include <algorithm>

namespace penumbra {
namespace {

// A quarter of the bytes is for entries that wait; sorting a band takes the like again, and vectors grow by doubling.
constexpr std::size_t share_waiting = 4;
constexpr std::size_t fewest_waiting = 4096;
constexpr std::size_t most_bands = 256;

}  // namespace

TripletSpill::TripletSpill(const std::filesystem::path& beside, std::size_t rows, std::size_t bytes)
    : beside_(beside), rows_(rows), most_waiting_(std::max(fewest_waiting, bytes / sizeof(Triplet) / share_waiting)) {
  // Were the matrix full, a band of it would have to fit.
  const double full = static_cast<double>(rows) * static_cast<double>(rows);
  const auto needed = static_cast<std::size_t>(full / static_cast<double>(most_waiting_)) + 1;
  const std::size_t bands = std::clamp<std::size_t>(needed, 1, std::max<std::size_t>(1, std::min(most_bands, rows)));
  rows_a_band_ = std::max<std::size_t>(1, (rows + bands - 1) / bands);
  bands_.resize(std::max<std::size_t>(1, (rows + rows_a_band_ - 1) / rows_a_band_));
}

void TripletSpill::add(const Triplet& entry) {
  bands_[entry.row / rows_a_band_].waiting.push_back(entry);
  if (++waiting_ >= most_waiting_) spill();
}

void TripletSpill::spill() {
  for (Band& band : bands_) {
    if (band.waiting.empty()) continue;
    if (band.disk.empty()) band.disk.emplace_back(beside_);
    band.disk.front().write(std::as_bytes(std::span(band.waiting)));
    band.spilled += band.waiting.size();
    band.waiting.clear();
  }
  waiting_ = 0;
}

std::uint64_t TripletSpill::bytes_on_disk() const {
  std::uint64_t bytes = 0;
  for (const Band& band : bands_) bytes += band.spilled * sizeof(Triplet);
  return bytes;
}

void TripletSpill::for_each_row(
    const std::function<void(std::size_t, std::span<const std::uint32_t>, std::span<const double>)>& visitor) {
  std::vector<std::uint32_t> columns;
  std::vector<double> values;
  for (std::size_t b = 0; b < bands_.size(); ++b) {
    Band& band = bands_[b];
    std::vector<Triplet> entries(band.spilled);
    if (!band.disk.empty()) band.disk.front().read(0, std::as_writable_bytes(std::span(entries)));
    band.disk.clear();
    entries.insert(entries.end(), band.waiting.begin(), band.waiting.end());
    std::vector<Triplet>().swap(band.waiting);
    std::stable_sort(entries.begin(), entries.end(), [](const Triplet& x, const Triplet& y) {
      return x.row != y.row ? x.row < y.row : x.column < y.column;
    });
    std::size_t at = 0;
    const std::size_t last_row = std::min(rows_, (b + 1) * rows_a_band_);
    for (std::size_t row = b * rows_a_band_; row < last_row; ++row) {
      columns.clear();
      values.clear();
      for (; at < entries.size() && entries[at].row == row; ++at) {
        if (!columns.empty() && columns.back() == entries[at].column) {
          values.back() += entries[at].value;
        } else {
          columns.push_back(entries[at].column);
          values.push_back(entries[at].value);
        }
      }
      visitor(row, columns, values);
    }
    band.spilled = 0;
  }
  waiting_ = 0;
}

}  // namespace penumbra
