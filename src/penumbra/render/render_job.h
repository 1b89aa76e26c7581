#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/render/active_blocks.h"
#include "penumbra/render/integrator.h"

namespace penumbra {

/// The samples of one picture: tiles of every pass, shared by all threads.
class RenderJob {
 public:
  using Clock = std::chrono::steady_clock;

  /// All must outlive it. @param stage what progress calls the work. @param began from when the time limit counts.
  RenderJob(const Integrator& integrator, const RenderOptions& options, const Progress& progress, const char* stage,
            Clock::time_point began);

  /// Draws marked pixels only, over the picture that is there: one entry a pixel of the region, row by row.
  void restrict_to(std::vector<std::uint8_t> marks);

  /// Draws the picture, adds up the rays, and notes whether it was cut short. Returns the samples taken.
  std::uint64_t run(RenderResult& result);

 private:
  [[nodiscard]] std::uint64_t run_once(Image& image);
  [[nodiscard]] std::uint64_t run_passes(Image& image);
  void pass_after_pass(Film& film);
  bool cut_short();
  [[nodiscard]] Region tile_area(std::size_t tile) const;
  std::size_t render_tile(std::size_t tile, int first, int last, Film& film);
  [[nodiscard]] std::vector<PixelBlock> blocks_awake(const Region& area, int first, int last) const;
  [[nodiscard]] std::vector<PixelBlock> marked_pixels(const Region& area, int first, int last) const;
  void tell(std::size_t block_samples);

  const Integrator& integrator_;
  const RenderOptions& options_;
  const Progress& progress_;
  const char* stage_;
  Region region_;
  int columns_, rows_;
  std::vector<RayCounts> counts_;  // by tile
  ActiveBlocks blocks_;
  std::vector<std::uint8_t> marks_;  // of pixels; empty: all
  std::size_t all_blocks_;
  Clock::time_point began_;
  std::atomic<bool> cut_{false};
  std::mutex telling_;
  std::size_t done_ = 0;  // blocks x samples
};

}  // namespace penumbra
