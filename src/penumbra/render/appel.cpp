#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "penumbra/render/direct_light.h"
#include "penumbra/render/first_surface.h"
#include "penumbra/render/integrator.h"
#include "penumbra/render/light_points.h"
#include "penumbra/render/packet_shading.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/render/shadow_scout.h"

namespace penumbra {
namespace {

constexpr int lanes = RayPacket::size;

// Whether radiance of a surface is its emission plus base colour / pi times irradiance, the same all over the material.
bool is_plain(const Material& m) {
  return m.metallic == 0 && m.specular == 0 && m.transmission == 0 && is_black(m.mirror) &&
         m.alpha_mode != AlphaMode::blend && !m.unlit && !m.base_colour_texture && !m.normal_texture &&
         !m.emission_texture && !m.checker_colour;
}

/// Appel 1968: a ray through each sub-pixel to the nearest surface, and from there one to each light.
///
/// Blocks of 4 x 4 pixels go as packets of 16 rays wherever surfaces are plain and matt and the lights allow it; any
/// other lane is shaded by itself. Both ways draw the same random numbers and differ by rounding alone.
class Appel final : public Integrator {
 public:
  Appel(const RayTracer& tracer, const CameraRays& camera, const RenderOptions& options)
      : tracer_(tracer),
        camera_(camera),
        seed_(options.seed),
        direct_(tracer, options),
        front_sides_only_(options.front_sides_only) {
    const Scene& scene = tracer.scene();
    for (const Material& m : scene.materials) plain_.push_back(is_plain(m) ? 1 : 0);
    for (const Instance& i : scene.instances) placed_as_is_.push_back(i.to_world == Mat4d(1.0) ? 1 : 0);
    if (direct_.is_selective()) {
      const SpecularTree tree(tracer, options.front_sides_only);
      direct_.send_more_at(scout_shadows(direct_, tree, camera, options, first_pass_));
    }
    if (auto lights = packet_lights(scene, direct_.lights(), options.samples_per_pixel == 1);
        lights && direct_.is_binary() && direct_.sends_one_ray_each()) {
      lights_ = std::move(*lights);
      packets_ = camera.is_pinhole();
      raster_ = {Vec3f(camera.eye()), Vec3f(camera.corner()), Vec3f(camera.step_x()), Vec3f(camera.step_y())};
    }
  }

  [[nodiscard]] RayCounts first_pass() const override { return first_pass_; }

  void render(const PixelBlock& block, Film& film, RayCounts& rays) const override {
    for (int sample = block.first_sample; sample < block.last_sample; ++sample) {
      packets_ && !film.has_layers() ? render_packet(block, sample, film, rays)
                                     : render_singly(block, sample, film, rays);
    }
  }

 private:
  struct alignas(64) Packet;

  void render_singly(const PixelBlock& block, int sample, Film& film, RayCounts& rays) const;
  void render_packet(const PixelBlock& block, int sample, Film& film, RayCounts& rays) const;
  [[nodiscard]] PixelEstimate shade(const Ray& ray, const std::optional<Hit>& hit, PixelSampler& sampler,
                                    RayCounts& rays) const;

  void aim(const PixelBlock& block, int sample, Packet& p) const;
  void gather(int lane, Packet& p) const;
  void light(Packet& p, RayCounts& rays) const;
  void draw_points(const PacketLight& light, Packet& p) const;

  const RayTracer& tracer_;
  CameraRays camera_;
  std::uint64_t seed_;
  DirectLight direct_;
  RayCounts first_pass_;
  bool front_sides_only_;
  std::vector<char> plain_;         // by material
  std::vector<char> placed_as_is_;  // by instance: its transform is the identity
  std::vector<PacketLight> lights_;
  RasterDirections raster_;
  bool packets_ = false;
};

// All that is known of sixteen rays.
struct alignas(64) Appel::Packet {
  RayPacket rays;
  HitPacket hits;
  HitTriangles triangles;
  PointLanes points;
  LightLanes on_light;
  RayPacket shadow;
  Lanes geometry;
  std::int32_t lit[lanes] = {};  // -1: plain and matt, to be lit with the packet
  int used = 0;
  Lanes x, y;  // raster positions
  float weight[lanes] = {};
  Rgb light_radiance[lanes];
  Rgb radiance[lanes];
  Rgb reflectance[lanes];
  const Material* material[lanes] = {};
  std::array<std::optional<PixelSampler>, lanes> samplers;
};

PixelEstimate Appel::shade(const Ray& ray, const std::optional<Hit>& hit, PixelSampler& sampler,
                           RayCounts& rays) const {
  PixelEstimate seen;
  if (!hit) {
    seen.radiance = direct_.lights().environment().radiance(ray.direction);
    note_miss(seen, seen.radiance);
    return seen;
  }
  const SurfacePoint point = tracer_.surface_point(ray, *hit);
  const Vec3d wo = -ray.direction;
  const Material& material = tracer_.scene().materials[point.material];
  if (front_sides_only_ && dot(point.geometric_normal, wo) < 0) return seen;
  const SurfaceMaterial surface = surface_material(tracer_.scene(), point);
  const Bsdf bsdf(surface, frame_towards(surface.shading, point.geometric_normal, wo), point.geometric_normal);
  if (material.unlit || emits_towards(material, point.geometric_normal, wo)) seen.radiance = surface.emission;
  seen.radiance += direct_.lights().ambient() * bsdf.diffuse_reflectance();
  if (bsdf.has_spread()) seen.radiance += direct_.reflected(point, bsdf, wo, 0, 0, sampler, rays);
  note_surface(seen, ray, point, surface, bsdf, seen.radiance);
  return seen;
}

void Appel::render_singly(const PixelBlock& block, int sample, Film& film, RayCounts& rays) const {
  for (int y = block.y0; y < block.y1; ++y) {
    for (int x = block.x0; x < block.x1; ++x) {
      PixelSampler sampler(seed_, x, y, sample);
      const auto [ray, weight] = camera_.ray(x, y, sampler);
      if (weight == 0) {
        film.add_nothing(x, y);
        continue;
      }
      const std::uint64_t before = rays.total();
      count(rays, RayPurpose::primary, 0);
      PixelEstimate seen = shade(ray, tracer_.nearest(ray), sampler, rays);
      seen.rays = static_cast<float>(rays.total() - before);
      film.add(x, y, seen, weight);
    }
  }
}

void Appel::render_packet(const PixelBlock& block, int sample, Film& film, RayCounts& rays) const {
  Packet p;
  aim(block, sample, p);
  count(rays, RayPurpose::primary, 0, static_cast<std::uint64_t>(p.used));
  tracer_.nearest(p.rays, p.hits);
  for (int lane = 0; lane < p.used; ++lane) gather(lane, p);
  shade_points(p.rays, p.triangles, p.points);
  light(p, rays);

  const int width = block.x1 - block.x0;
  for (int lane = 0; lane < p.used; ++lane) {
    const int x = block.x0 + lane % width;
    const int y = block.y0 + lane / width;
    PixelEstimate seen;
    seen.radiance = p.radiance[lane];
    if (p.lit[lane] == 0) {
      PixelSampler sampler(seed_, x, y, sample);
      const Ray ray = camera_.ray(x, y, sampler).ray;
      std::optional<Hit> hit;
      if (p.hits.object[lane] != HitPacket::no_hit) {
        hit = Hit{p.hits.t[lane], p.hits.object[lane], p.hits.primitive[lane], {p.hits.u[lane], p.hits.v[lane]}};
      }
      seen = shade(ray, hit, sampler, rays);
    }
    film.add(x, y, seen, p.weight[lane]);
  }
}

// The camera's rays, in single precision; unused lanes of a cut block sleep.
void Appel::aim(const PixelBlock& block, int sample, Packet& p) const {
  const int width = block.x1 - block.x0;
  p.used = width * (block.y1 - block.y0);
  for (int lane = 0; lane < lanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    p.rays.active[lane] = lane < p.used ? -1 : 0;
    p.lit[lane] = 0;
    const int x = block.x0 + std::min(lane, p.used - 1) % width;
    const int y = block.y0 + std::min(lane, p.used - 1) / width;
    PixelSampler& sampler = p.samplers[i].emplace(seed_, x, y, sample);
    p.weight[lane] = 1;
    Vec2d offset(0);
    if (!camera_.centred()) {
      const Filter::Position at = camera_.sub_pixel(sampler);
      offset = at.offset;
      p.weight[lane] = at.weight;
    }
    p.x[i] = static_cast<float>(x + 0.5 + offset.x);
    p.y[i] = static_cast<float>(y + 0.5 + offset.y);
  }
  aim_camera(raster_, p.x, p.y, p.rays);
}

// Takes a lane into the packet's shading when its surface is plain.
void Appel::gather(int lane, Packet& p) const {
  const Scene& scene = tracer_.scene();
  const std::uint32_t object = p.hits.object[lane];
  if (object == HitPacket::no_hit || object >= scene.instances.size()) return;
  const Instance& instance = scene.instances[object];
  const Mesh& mesh = scene.meshes[instance.mesh];
  const std::uint32_t primitive = p.hits.primitive[lane];
  const std::uint32_t material = mesh.material_of(primitive);
  // Interpolated normals are turned by the instance, which is the scalar way's business.
  if (plain_[material] == 0 || !mesh.colours.empty() || placed_as_is_[object] == 0) return;

  const auto i = static_cast<std::size_t>(lane);
  const Mesh::Triangle& corner = mesh.triangles[primitive];
  p.triangles.v0.set(lane, Vec3f(mesh.positions[corner[0]]));
  p.triangles.v1.set(lane, Vec3f(mesh.positions[corner[1]]));
  p.triangles.v2.set(lane, Vec3f(mesh.positions[corner[2]]));
  const float u = p.hits.u[lane];
  const float v = p.hits.v[lane];
  p.triangles.u[i] = u;
  p.triangles.v[i] = v;
  p.triangles.mirror[i] = 1;
  p.triangles.smooth[i] = mesh.normals.empty() ? 0.0F : 1.0F;
  if (!mesh.normals.empty()) {
    p.triangles.normal.set(
        lane, (1 - u - v) * mesh.normals[corner[0]] + u * mesh.normals[corner[1]] + v * mesh.normals[corner[2]]);
  }
  p.material[lane] = &scene.materials[material];
  p.lit[lane] = -1;
}

// One shadow ray from each lit lane to each light.
void Appel::light(Packet& p, RayCounts& rays) const {
  for (int lane = 0; lane < p.used; ++lane) {
    if (p.lit[lane] == 0) continue;
    const auto i = static_cast<std::size_t>(lane);
    const Material& m = *p.material[lane];
    const bool back = p.points.front[i] == 0;
    // A shading normal turned away from the eye is bent back by the scalar way; black backs are its business too.
    if (p.points.facing[i] <= 0 || (front_sides_only_ && back)) {
      p.lit[lane] = 0;
      continue;
    }
    p.reflectance[lane] = m.base_colour * std::numbers::inv_pi_v<float>;
    p.radiance[lane] = direct_.lights().ambient() * m.base_colour;
    if (m.emits() && (!back || m.double_sided)) p.radiance[lane] += m.emission;
    if (is_black(m.base_colour)) p.lit[lane] = 1;  // nothing to light; the radiance is whole
  }
  std::int32_t reflecting[lanes];
  for (int lane = 0; lane < lanes; ++lane) reflecting[lane] = lane < p.used && p.lit[lane] == -1 ? -1 : 0;
  for (const PacketLight& one : lights_) {
    draw_points(one, p);
    if (one.kind == PacketLight::Kind::area) {
      aim_at_area(p.points, p.on_light, reflecting, p.shadow, p.geometry);
    } else {
      aim_at_point(p.points, p.on_light, one.kind == PacketLight::Kind::far, one.inverse_square, one.range, reflecting,
                   p.shadow, p.geometry);
    }
    std::uint64_t cast = 0;
    for (const std::int32_t a : p.shadow.active) cast += a != 0 ? 1 : 0;
    if (cast == 0) continue;
    count(rays, RayPurpose::shadow, 0, cast);
    tracer_.occluded(p.shadow, one.at_middle || one.kind != PacketLight::Kind::area);
    for (int lane = 0; lane < p.used; ++lane) {
      if (p.shadow.active[lane] == 0) continue;
      p.radiance[lane] += p.reflectance[lane] * p.light_radiance[lane] * p.geometry[static_cast<std::size_t>(lane)];
    }
  }
}

void Appel::draw_points(const PacketLight& light, Packet& p) const {
  if (light.kind != PacketLight::Kind::area || light.at_middle) {
    const bool lamp = light.kind == PacketLight::Kind::area;
    for (int lane = 0; lane < lanes; ++lane) {
      const auto i = static_cast<std::size_t>(lane);
      p.on_light.position.set(lane, lamp ? light.triangles[0].v0 : light.position);
      p.on_light.normal.set(lane, lamp ? light.triangles[0].normal : Vec3f(0));
      p.on_light.inverse_density[i] = lamp ? light.triangles[0].inverse_density : 1;
      p.on_light.both_sides[i] = lamp && light.triangles[0].both_sides ? 1.0F : 0.0F;
      p.light_radiance[lane] = lamp ? light.triangles[0].radiance : light.strength;
      if (!lamp) (void)p.samplers[i]->next_2d();  // as the scalar way draws it
    }
    return;
  }
  for (int lane = 0; lane < lanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    const Vec2d u = p.samplers[i]->next_2d();
    float choice = static_cast<float>(u.x);
    const PacketLight::Triangle& t = light.choose(choice);
    const float root = std::sqrt(choice);  // uniform over a triangle, as sample_triangle
    const auto across = static_cast<float>(u.y);
    p.on_light.position.set(lane, t.v0 + (root * (1 - across)) * t.e1 + (root * across) * t.e2);
    p.on_light.normal.set(lane, t.normal);
    p.on_light.inverse_density[i] = t.inverse_density;
    p.on_light.both_sides[i] = t.both_sides ? 1.0F : 0.0F;
    p.light_radiance[lane] = t.radiance;
  }
}

}  // namespace

std::unique_ptr<Integrator> make_appel(const RayTracer& tracer, const CameraRays& camera,
                                       const RenderOptions& options) {
  return std::make_unique<Appel>(tracer, camera, options);
}

}  // namespace penumbra
