#include "penumbra/render/render_job.h"

#include <algorithm>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/ray_tally.h"

namespace penumbra {
namespace {

constexpr int tile_side = 32;                   // pixels; a task
constexpr int block_side = ActiveBlocks::side;  // pixels; a packet of rays
constexpr int blocks_a_tile = (tile_side / block_side) * (tile_side / block_side);
constexpr int most_samples_a_pass = 16;
constexpr int samples_before_rest = 16;  // of a pixel, before its noise is believed

// Samples are taken in passes over the whole picture, so that a render cut short is a whole, noisier picture. The
// passes double from one sample; they do not depend on time, so neither do the sums.
std::vector<int> pass_ends(int samples) {
  std::vector<int> ends;
  for (int done = 0; done < samples;) {
    done = std::min(samples, done + std::clamp(done, 1, most_samples_a_pass));
    ends.push_back(done);
  }
  return ends;
}

}  // namespace

RenderJob::RenderJob(const Integrator& integrator, const RenderOptions& options, const Progress& progress,
                     const char* stage, Clock::time_point began)
    : integrator_(integrator),
      options_(options),
      progress_(progress),
      stage_(stage),
      region_(options.region.value_or(Region{0, 0, options.width, options.height})),
      columns_((region_.x1 - region_.x0 + tile_side - 1) / tile_side),
      rows_((region_.y1 - region_.y0 + tile_side - 1) / tile_side),
      counts_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
      blocks_(region_, options.noise),
      all_blocks_(blocks_.block_count()),
      began_(began) {}

void RenderJob::restrict_to(std::vector<std::uint8_t> marks) {
  marks_ = std::move(marks);
  all_blocks_ = static_cast<std::size_t>(std::count(marks_.begin(), marks_.end(), 1));
}

std::uint64_t RenderJob::run(RenderResult& result) {
  const bool one_pass = !marks_.empty() || pass_ends(options_.samples_per_pixel).size() == 1;
  const std::uint64_t samples = one_pass ? run_once(result.image) : run_passes(result.image);
  result.partial = result.partial || cut_.load();
  for (const RayCounts& c : counts_) result.rays += c;
  return samples;
}

// One pass needs no sums from before: each tile is drawn on a film of its own and developed while it is in the
// processor's cache.
std::uint64_t RenderJob::run_once(Image& image) {
  if (marks_.empty()) image = Image(options_.width, options_.height, picture_channels(options_.aovs));
  std::atomic<std::uint64_t> samples{0};
  parallel_for(counts_.size(), 1, [&](std::size_t tile, std::size_t) {
    if (cut_short()) return;
    Film film(tile_area(tile), options_.aovs);
    tell(render_tile(tile, 0, options_.samples_per_pixel, film) * static_cast<std::size_t>(options_.samples_per_pixel));
    film.develop_into(image);
    samples += film.sample_count();
  });
  return samples;
}

std::uint64_t RenderJob::run_passes(Image& image) {
  Film film(options_.width, options_.height, options_.aovs, options_.noise > 0);
  pass_after_pass(film);
  image = film.develop();
  return film.sample_count();
}

void RenderJob::pass_after_pass(Film& film) {
  int first = 0;
  for (const int last : pass_ends(options_.samples_per_pixel)) {
    parallel_for(counts_.size(), 1, [&](std::size_t tile, std::size_t) {
      if (cut_short()) return;
      const std::size_t blocks = render_tile(tile, first, last, film);
      tell(blocks * static_cast<std::size_t>(last - first));
    });
    if (cut_.load()) return;
    first = last;
    if (options_.noise > 0 && last >= samples_before_rest) {
      const std::size_t active = blocks_.active_count();
      blocks_.update(film);
      // What rests will get no more.
      tell((active - blocks_.active_count()) * static_cast<std::size_t>(options_.samples_per_pixel - last));
      if (blocks_.active_count() == 0) break;
    }
  }
}

bool RenderJob::cut_short() {
  if (cut_.load(std::memory_order_relaxed)) return true;
  const bool late =
      options_.time_limit > 0 && std::chrono::duration<double>(Clock::now() - began_).count() > options_.time_limit;
  if (late || progress_.stop_requested()) cut_.store(true);
  return late || progress_.stop_requested();
}

Region RenderJob::tile_area(std::size_t tile) const {
  const int x0 = region_.x0 + static_cast<int>(tile) % columns_ * tile_side;
  const int y0 = region_.y0 + static_cast<int>(tile) / columns_ * tile_side;
  return {x0, y0, std::min(region_.x1, x0 + tile_side), std::min(region_.y1, y0 + tile_side)};
}

/// Returns the number of blocks, or marked pixels, that it drew.
std::size_t RenderJob::render_tile(std::size_t tile, int first, int last, Film& film) {
  const Region area = tile_area(tile);
  const auto blocks = marks_.empty() ? blocks_awake(area, first, last) : marked_pixels(area, first, last);
  if (!blocks.empty()) integrator_.render(blocks, film, counts_[tile]);
  return blocks.size();
}

std::vector<PixelBlock> RenderJob::blocks_awake(const Region& area, int first, int last) const {
  std::vector<PixelBlock> blocks;
  blocks.reserve(static_cast<std::size_t>(blocks_a_tile));
  for (int y = area.y0; y < area.y1; y += block_side) {
    for (int x = area.x0; x < area.x1; x += block_side) {
      if (!blocks_.is_active((x - region_.x0) / block_side, (y - region_.y0) / block_side)) continue;
      blocks.push_back({x, y, std::min(area.x1, x + block_side), std::min(area.y1, y + block_side), first, last});
    }
  }
  return blocks;
}

std::vector<PixelBlock> RenderJob::marked_pixels(const Region& area, int first, int last) const {
  std::vector<PixelBlock> pixels;
  const auto width = static_cast<std::size_t>(region_.x1 - region_.x0);
  for (int y = area.y0; y < area.y1; ++y) {
    const std::uint8_t* row = marks_.data() + static_cast<std::size_t>(y - region_.y0) * width;
    for (int x = area.x0; x < area.x1; ++x) {
      if (row[x - region_.x0] != 0) pixels.push_back({x, y, x + 1, y + 1, first, last});
    }
  }
  return pixels;
}

void RenderJob::tell(std::size_t block_samples) {
  if (!progress_.report) return;
  const double all = static_cast<double>(all_blocks_) * options_.samples_per_pixel;
  const std::scoped_lock lock(telling_);
  done_ += block_samples;
  progress_.tell(stage_, std::min(1.0, static_cast<double>(done_) / all));
}

}  // namespace penumbra
