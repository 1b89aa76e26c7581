#include "penumbra/baking/light_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "penumbra/math/rng.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

constexpr int lanes = Outlook::lanes;
constexpr std::size_t groups_a_block = 16;
/// The change at which light stands still, of all light.
constexpr double stillness = 1e-4;
constexpr std::size_t most_passes = 2000;

float brightness(const Vec4f& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

LightCells::LightCells(const TexelRays& rays, const AtlasSpace& space, const StraightLight& straight,
                       std::span<const std::uint32_t> order, std::span<const float> direct, const Options& options,
                       const Progress& progress)
    : rays_(rays), space_(space), points_(rays.points()), straight_(straight), order_(order), options_(options) {
  divide(options.most_cells);
  paint(direct);
  trace(0);
  find_backs(progress);
}

void LightCells::divide(std::size_t most_cells) {
  // Texels along a Morton curve: squares of 2^n texels across are runs of it.
  const TexelMap& map = rays_.map();
  const auto w = static_cast<std::uint32_t>(map.texels().width);
  for (int level = 0;; ++level) {
    first_of_cell_.clear();
    std::array<std::uint32_t, 3> last{none, none, none};
    for (std::uint32_t k = 0; k < order_.size(); ++k) {
      const std::uint32_t chart = map.chart(order_[k]), pixel = map.texels().pixels[order_[k]];
      const Chart& c = map.atlas().charts[chart];
      const std::array<std::uint32_t, 3> square{chart, (pixel % w - static_cast<std::uint32_t>(c.x)) >> level,
                                                (pixel / w - static_cast<std::uint32_t>(c.y)) >> level};
      if (square != last) first_of_cell_.push_back(k);
      last = square;
    }
    if (first_of_cell_.size() <= most_cells || level == 8) break;
  }
  const auto count = static_cast<std::uint32_t>(first_of_cell_.size());
  first_of_cell_.push_back(static_cast<std::uint32_t>(order_.size()));
  cell_of_texel_.resize(order_.size());
  cell_of_row_.resize(count);
  for (std::uint32_t c = 0; c < count; ++c) {
    cell_of_row_[c] = c;
    for (const std::uint32_t t : texels_of(c)) cell_of_texel_[t] = c;
  }
  back_of_cell_.assign(count, none);
  black_slot_ = count;
}

void LightCells::paint(std::span<const float> direct) {
  constexpr std::size_t most_looked_at = 8;
  const std::size_t count = cell_of_row_.size();
  albedo_.resize(count), emission_.resize(count), back_emission_.resize(count), received_.resize(count);
  sky_.resize(count, 0);
  lit_.assign(count, 0), buried_.assign(count, 0);
  parallel_for(count, 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c) {
      const auto texels = texels_of(static_cast<std::uint32_t>(c));
      Vec4f light(0);
      for (const std::uint32_t t : texels) {
        light += Vec4f(direct[3 * t], direct[3 * t + 1], direct[3 * t + 2], 0);
      }
      received_[c] = light / static_cast<float>(texels.size());
      TexelPaint sum;
      const std::size_t step = (texels.size() + most_looked_at - 1) / most_looked_at;
      float looks = 0;
      bool shines = false;
      for (std::size_t k = 0; k < texels.size(); k += step, looks += 1) {
        const TexelPaint p = paint_of_texel(rays_.map(), space_, straight_.lamps(), texels[k]);
        sum.albedo += p.albedo, sum.matt += p.matt, sum.emission += p.emission, sum.back_emission += p.back_emission;
        shines = shines || straight_.lamps().of_triangle[rays_.map().texels().triangles[texels[k]]] != 0;
      }
      albedo_[c] = Vec4f(sum.albedo, sum.matt) / looks;
      emission_[c] = Vec4f(sum.emission / looks, 0);
      back_emission_[c] = Vec4f(sum.back_emission / looks, 0);
      lit_[c] = shines || brightness(received_[c] + emission_[c] + back_emission_[c]) > 0;
    }
  });
}

void LightCells::trace(std::size_t first_row) {
  const std::size_t count = rows() - first_row, groups = (count + lanes - 1) / lanes;
  const std::uint32_t k_rays = options_.rays;
  landed_.resize(rows() * k_rays);
  std::vector<std::vector<Weighted>> weighted(groups);
  parallel_for(groups, groups_a_block, [&](std::size_t first_group, std::size_t last_group) {
    RayPacket packet;
    Landing landings[lanes];
    for (std::size_t g = first_group; g < last_group; ++g) {
      const std::size_t begin = first_row + g * lanes, end = std::min(rows(), begin + lanes);
      Outlook outlook(hash_key(options_.seed, 1, begin));
      std::array<Vec4f, lanes> extra{};
      std::array<float, lanes> sky{};
      for (std::uint32_t k = 0; k < k_rays; ++k) {
        for (std::size_t r = begin; r < end; ++r) {
          const auto texels = texels_of(cell_of_row_[r]);
          if (k > 0 && texels.size() == 1) continue;
          const std::uint32_t texel = texels[k % texels.size()];
          Place place = points_[texel];
          if (r >= back_of_cell_.size()) place = place.reversed();
          outlook.set(static_cast<int>(r - begin), points_.lifted(place), place.shading, place.normal,
                      hash_key(options_.seed, 2, r));
        }
        outlook.rays(k, packet);
        rays_.trace(packet, hash_key(options_.seed, 3, begin, k), landings);
        for (std::size_t r = begin; r < end; ++r) {
          const Landing& l = landings[r - begin];
          std::uint32_t& landed = landed_[r * k_rays + k];
          landed = none;
          extra[r - begin] += Vec4f(l.extra, 0);
          if (l.side == Landing::nowhere) {
            sky[r - begin] += l.extra.x + l.extra.y + l.extra.z;
            continue;
          }
          const std::uint32_t side = 2 * cell_of_texel_[l.side / 2] + (l.side & 1U);
          if (l.is_plain) {
            landed = side;
          } else {
            weighted[g].push_back({static_cast<std::uint32_t>(r), side, l.weight});
          }
        }
      }
      for (std::size_t r = begin; r < end; ++r) {
        received_[r] += extra[r - begin] / static_cast<float>(k_rays);
        sky_[r] = sky[r - begin] / static_cast<float>(k_rays);
      }
      std::stable_sort(weighted[g].begin(), weighted[g].end(),
                       [](const Weighted& a, const Weighted& b) { return a.row < b.row; });
    }
  });
  for (const auto& some : weighted) weighted_.insert(weighted_.end(), some.begin(), some.end());
  rays_traced_ += count * k_rays;
}

void LightCells::find_backs(const Progress& progress) {
  const std::size_t fronts = cell_of_row_.size();
  std::vector<std::uint8_t> sees_light(fronts);
  for (std::size_t c = 0; c < fronts; ++c) {
    const auto texels = texels_of(static_cast<std::uint32_t>(c));
    const bool enclosed =
        std::all_of(texels.begin(), texels.end(), [&](std::uint32_t t) { return points_.is_enclosed(t); });
    sees_light[c] = !enclosed || lit_[c] != 0;
  }
  while (true) {
    const std::size_t before = rows();
    spread_light(sees_light);
    add_backs(sees_light);
    if (rows() == before) break;
    if (progress.stop_requested()) {
      partial_ = true;
      received_.resize(rows(), Vec4f(0));
      sky_.resize(rows(), 0);
      landed_.resize(rows() * options_.rays, none);
      break;
    }
    sees_light.resize(rows(), 1);
    received_.resize(rows(), Vec4f(0));
    sky_.resize(rows(), 0);
    light_backs(before);
    trace(before);
  }
  back_share_.assign(fronts, 0);
  for (std::size_t c = 0; c < fronts; ++c) {
    for (std::uint32_t k = 0; k < options_.rays; ++k) {
      const std::uint32_t side = landed_[c * options_.rays + k];
      if (side != none && (side & 1U) != 0) back_share_[c] += 1.0F / static_cast<float>(options_.rays);
    }
  }
  black_slot_ = static_cast<std::uint32_t>(rows());
  for (std::uint32_t& l : landed_) l = l == none ? black_slot_ : slot(l);
  for (Weighted& w : weighted_) w.side = slot(w.side);
  first_weighted_.assign(rows() + 1, 0);
  for (const Weighted& w : weighted_) ++first_weighted_[w.row + 1];
  for (std::size_t r = 0; r < rows(); ++r) first_weighted_[r + 1] += first_weighted_[r];
}

void LightCells::spread_light(std::vector<std::uint8_t>& sees_light) const {
  // Light comes to a row that meets something other than backs and fronts that no light comes to.
  std::vector<std::uint8_t> by_mirrors(rows(), 0);
  for (const Weighted& w : weighted_) by_mirrors[w.row] = 1;
  for (bool grew = true; grew;) {
    grew = false;
    for (std::size_t r = 0; r < back_of_cell_.size(); ++r) {
      if (sees_light[r] != 0) continue;
      bool lit = by_mirrors[r] != 0;
      for (std::uint32_t k = 0; k < options_.rays && !lit; ++k) {
        const std::uint32_t side = landed_[r * options_.rays + k];
        lit = side != none && ((side & 1U) != 0 ? back_of_cell_[side / 2] != none : sees_light[side / 2] != 0);
      }
      if (lit) sees_light[r] = 1, grew = true;
    }
  }
}

void LightCells::add_backs(const std::vector<std::uint8_t>& sees_light) {
  std::vector<std::uint8_t> met(back_of_cell_.size(), 0);
  for (std::size_t r = 0; r < rows(); ++r) {
    if (sees_light[r] == 0) continue;
    for (std::uint32_t k = 0; k < options_.rays; ++k) {
      const std::uint32_t side = landed_[r * options_.rays + k];
      if (side != none && (side & 1U) != 0) met[side / 2] = 1;
    }
  }
  for (const Weighted& w : weighted_) {
    if ((w.side & 1U) != 0) met[w.side / 2] = 1;
  }
  for (std::uint32_t c = 0; c < met.size(); ++c) {
    if (met[c] == 0 || back_of_cell_[c] != none) continue;
    back_of_cell_[c] = static_cast<std::uint32_t>(rows());
    cell_of_row_.push_back(c);
  }
}

void LightCells::light_backs(std::size_t first_row) {
  if (straight_.is_dark()) return;
  parallel_for(rows() - first_row, lanes, [&](std::size_t first, std::size_t last) {
    std::array<Place, lanes> places;
    std::array<Vec3d, lanes> light;
    double reach = 0;
    for (std::size_t k = first; k < last; ++k) {
      const auto texels = texels_of(cell_of_row_[first_row + k]);
      const std::uint32_t texel = texels[texels.size() / 2];
      places[k - first] = points_[texel].reversed();
      reach = std::max(reach, rays_.map().texels().footprint(texel));
    }
    straight_.at(std::span(places).first(last - first), reach, light);
    for (std::size_t k = first; k < last; ++k) received_[first_row + k] += Vec4f(Vec3f(light[k - first]), 0);
  });
}

Vec4f LightCells::gathered(std::size_t row) const {
  Vec4f sum(0);
  const std::uint32_t* landed = landed_.data() + row * options_.rays;
  for (std::uint32_t k = 0; k < options_.rays; ++k) sum += radiosity_[landed[k]];
  for (std::uint32_t k = first_weighted_[row]; k < first_weighted_[row + 1]; ++k) {
    sum += Vec4f(weighted_[k].weight, 0) * radiosity_[weighted_[k].side];
  }
  return received_[row] + sum / static_cast<float>(options_.rays);
}

LightCells::Side LightCells::side(std::size_t number) const {
  const std::uint32_t c = cell_of_row_[number];
  const bool back = number >= back_of_cell_.size(), black = back && options_.front_sides_only;
  Side side{.texels = texels_of(c), .back = back};
  if (!black) side.matt = albedo_[c].w;
  if (!black) side.albedo = Rgb(albedo_[c]), side.emission = Rgb(back ? back_emission_[c] : emission_[c]);
  side.irradiance = Rgb(irradiance_[number]);
  side.sky = sky_[number];
  return side;
}

void LightCells::solve(const Progress& progress) {
  constexpr std::size_t rows_a_block = 512;
  const std::size_t fronts = back_of_cell_.size(), count = rows();
  const auto leaving = [&](std::size_t r, const Vec4f& irradiance) {
    const std::uint32_t c = cell_of_row_[r];
    if (r >= fronts && options_.front_sides_only) return Vec4f(0);
    return (r < fronts ? emission_[c] : back_emission_[c]) + albedo_[c] * irradiance;
  };
  irradiance_ = received_;
  radiosity_.assign(count + 1, Vec4f(0));
  for (std::size_t r = 0; r < count; ++r) radiosity_[r] = leaving(r, received_[r]);
  std::vector<Vec4f> next(count + 1, Vec4f(0));
  struct Sums {
    double change = 0, all = 0;
  };
  std::vector<Sums> sums((count + rows_a_block - 1) / rows_a_block);
  double last_change = 0;
  while (residuals_.size() < most_passes && !progress.stop_requested()) {
    parallel_for(count, rows_a_block, [&](std::size_t first, std::size_t last) {
      Sums own;
      for (std::size_t r = first; r < last; ++r) {
        const Vec4f light = gathered(r), change = glm::abs(light - irradiance_[r]);
        own.change += change.x + change.y + change.z;
        own.all += light.x + light.y + light.z;
        irradiance_[r] = light;
        next[r] = leaving(r, light);
      }
      sums[first / rows_a_block] = own;
    });
    radiosity_.swap(next);
    Sums all;
    for (const Sums& s : sums) all.change += s.change, all.all += s.all;
    // What is still to come falls as a geometric series.
    const double ratio = last_change > 0 ? std::min(0.9999, all.change / last_change) : 0.9;
    const double to_come = all.change * ratio / (1 - ratio);
    residuals_.push_back(all.all > 0 ? all.change / all.all : 0);
    unshot_fraction_ = all.all > 0 ? to_come / all.all : 0;
    if (to_come <= stillness * all.all) break;
    last_change = all.change;
  }
  partial_ = partial_ || progress.stop_requested();
  find_buried();
}

void LightCells::find_buried() {
  double sum = 0;
  for (std::size_t c = 0; c < back_of_cell_.size(); ++c) sum += brightness(irradiance_[c]);
  const auto dark = static_cast<float>(1e-6 * sum / static_cast<double>(std::max<std::size_t>(1, buried_.size())));
  for (std::size_t c = 0; c < buried_.size(); ++c) {
    buried_[c] = back_share_[c] > 0.5F && brightness(irradiance_[c]) <= dark;
  }
}

}  // namespace penumbra
