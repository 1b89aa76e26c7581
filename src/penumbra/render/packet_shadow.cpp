#include "penumbra/render/packet_shadow.h"

namespace penumbra {
namespace {

constexpr int lanes = RayPacket::size;

// A light behind so many transparent surfaces counts as hidden, as in Shadow.
constexpr int most_surfaces = 64;

Ray lane_ray(const RayPacket& rays, int lane) {
  return {.origin = {rays.origin_x[lane], rays.origin_y[lane], rays.origin_z[lane]},
          .direction = {rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]},
          .t_min = rays.t_min[lane],
          .t_max = rays.t_max[lane],
          .time = static_cast<double>(rays.time[lane])};
}

}  // namespace

/// Rays on their way through glass, as far as they have come.
struct PacketShadow::Passage {
  RayPacket rest;
  int left = 0;  ///< active lanes

  void end(int lane) { rest.active[lane] = 0, --left; }
};

void PacketShadow::transmittance(RayPacket& rays, bool coherent, ColourLanes& passed) const {
  for (std::size_t i = 0; i < lanes; ++i) passed.set(i, Rgb(1));
  if (shadow_.is_binary()) {
    tracer_.occluded(rays, coherent);
    return;
  }
  Passage way{.rest = rays};
  tracer_.occluded(rays, coherent);
  for (int i = 0; i < lanes; ++i) {
    if (rays.active[i] != 0) way.rest.active[i] = 0;
    if (way.rest.active[i] != 0) ++way.left;
  }
  for (int crossed = 0; crossed < most_surfaces && way.left > 0; ++crossed) go_through(way, rays, passed);
}

// Each lane meets its next surface: it ends there, or goes on with less.
void PacketShadow::go_through(Passage& way, RayPacket& rays, ColourLanes& passed) const {
  HitPacket hits;
  HitTriangles triangles;
  HitShapes shapes;
  PointLanes points;
  std::array<const PacketMaterial*, lanes> glass{};
  bool any_shape = false, any_triangle = false;
  tracer_.nearest(way.rest, hits);
  for (int lane = 0; lane < lanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    if (way.rest.active[lane] == 0) continue;
    if (hits.object[lane] == HitPacket::no_hit) {
      rays.active[lane] = -1;
      way.end(lane);
      continue;
    }
    if (!shadow_.passes(hits, lane)) {
      way.end(lane);
      continue;
    }
    const PacketMaterial* const material = surfaces_.gather(hits, lane, triangles, shapes);
    if (material != nullptr && material->kind == PacketMaterial::Kind::glass) {
      glass[i] = material;
      (shapes.met[i] != 0 ? any_shape : any_triangle) = true;
      continue;
    }
    passed.set(i, passed.get(i) * shadow_.transmittance(lane_ray(way.rest, lane)));
    if (!is_black(passed.get(i))) rays.active[lane] = -1;
    way.end(lane);
  }
  if (!any_shape && !any_triangle) return;
  if (any_triangle) shade_points(way.rest, triangles, points);
  if (any_shape) {
    PointLanes on_shapes;
    shade_shapes(way.rest, shapes, on_shapes);
    any_triangle ? choose_points(shapes.met, on_shapes, points) : void(points = on_shapes);
  }
  Lanes ior, through;
  for (std::size_t i = 0; i < lanes; ++i) ior[i] = glass[i] != nullptr ? glass[i]->ior : 1.0F;
  pass_straight(points, ior, way.rest, through);
  for (int lane = 0; lane < lanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    if (glass[i] == nullptr) continue;
    passed.set(i, passed.get(i) * glass[i]->tint * through[i]);
    if (is_black(passed.get(i))) {
      way.end(lane);
    } else if (!(way.rest.t_max[lane] > 0)) {
      rays.active[lane] = -1;
      way.end(lane);
    }
  }
}

}  // namespace penumbra
