// For each integrator the rays that it traces at one sample a pixel are collected by following the same steps with the
// same random numbers. The bare loop traces them with rtcIntersect1 and rtcOccluded1 in the order of the renderer's
// tiles and nothing else, in a hierarchy with the renderer's flags (robust, which costs Embree 20 to 25 %) and in one
// with Embree's defaults.

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <utility>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/camera_rays.h"
#include "penumbra/render/direct_light.h"
#include "penumbra/render/render.h"
#include "penumbra/scene/builtin_scenes.h"
#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/specular_tree.h"
#include "section.h"

namespace penumbra::bench {
namespace {

struct Query {
  RTCRay ray;
  bool shadow;
};

/// The queries of each tile, in the order of an integrator that follows one ray at a time.
using Queries = std::vector<std::vector<Query>>;

RTCRay embree_ray(const Ray& ray) {
  RTCRay r{};
  r.org_x = static_cast<float>(ray.origin.x), r.org_y = static_cast<float>(ray.origin.y),
  r.org_z = static_cast<float>(ray.origin.z);
  r.dir_x = static_cast<float>(ray.direction.x), r.dir_y = static_cast<float>(ray.direction.y),
  r.dir_z = static_cast<float>(ray.direction.z);
  r.tfar = static_cast<float>(ray.t_max);
  r.mask = 0xFFFFFFFFU;
  return r;
}

// Embree's hierarchy over all triangles of a scene whose instances stand as they are.
RTCScene bare_scene(RTCDevice device, const Scene& scene, RTCSceneFlags flags) {
  RTCScene world = rtcNewScene(device);
  rtcSetSceneFlags(world, flags);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    for (const Vec3d& p : mesh.positions) {
      const Vec3f f(transform_point(instance.to_world, p));
      *v++ = f.x, *v++ = f.y, *v++ = f.z;
    }
    void* t = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size());
    std::memcpy(t, mesh.triangles.data(), mesh.triangles.size() * 12);
    rtcCommitGeometry(g);
    rtcAttachGeometry(world, g);
    rtcReleaseGeometry(g);
  }
  rtcCommitScene(world);
  return world;
}

std::size_t trace_bare(RTCScene world, const Queries& tiles) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  std::size_t rays = 0;
  for (const auto& tile : tiles) rays += tile.size();
  parallel_for(tiles.size(), 1, [&](std::size_t tile, std::size_t) {
    RTCIntersectContext own = context;
    for (const Query& q : tiles[tile]) {
      if (q.shadow) {
        RTCRay ray = q.ray;
        rtcOccluded1(world, &own, &ray);
      } else {
        RTCRayHit query{q.ray, {}};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(world, &own, &query);
      }
    }
  });
  return rays;
}

/// Notes the rays of Whitted's recursion.
class Recorder final : public SpecularTree::Visitor {
 public:
  Recorder(const DirectLight& light, bool follows, PixelSampler& sampler, std::vector<Query>& queries)
      : light_(light), follows_(follows), sampler_(sampler), queries_(queries) {}

  Rgb surface(const SpecularTree::Node& node) override {
    queries_.push_back({embree_ray(node.ray), false});
    if (!node.bsdf.has_spread()) return Rgb(0);
    for (std::size_t l = 0; l < light_.lights().light_count(); ++l) {
      const auto met = light_.meet(node.point, node.bsdf, node.wo, followed_roughness, l, sampler_);
      if (met) queries_.push_back({embree_ray(met->shadow_ray), true});
    }
    return Rgb(0);
  }
  Rgb sky(const Ray& ray, const SpecularTree::Branch&) override {
    queries_.push_back({embree_ray(ray), false});
    return Rgb(0);
  }
  float followed(const Rgb& weight, int depth) override {
    return follows_ && depth < 16 && max_component(weight) >= RenderOptions{}.min_throughput ? 1 : 0;
  }
  void count(bool, int) override {}

 private:
  const DirectLight& light_;
  bool follows_;
  PixelSampler& sampler_;
  std::vector<Query>& queries_;
};

/// Notes the rays of one path: the steps of path.cpp without their arithmetic.
void record_path(const RayTracer& tracer, const LightSampler& lights, Ray ray, PixelSampler& sampler,
                 std::vector<Query>& queries) {
  Rgb throughput(1);
  for (int depth = 0;;) {
    queries.push_back({embree_ray(ray), false});
    const auto hit = tracer.nearest(ray);
    if (!hit) return;
    const SurfacePoint point = tracer.surface_point(ray, *hit);
    const Vec3d wo = -ray.direction;
    const SurfaceMaterial surface = surface_material(tracer.scene(), point);
    const Bsdf bsdf(surface, frame_towards(surface.shading, point.geometric_normal, wo), point.geometric_normal);
    if (bsdf.has_spread()) {
      const Vec3d& n = bsdf.shading_normal();
      const double u_light = sampler.next_1d();
      const auto s = lights.sample(point, u_light, sampler.next_2d(), dot(n, wo) < 0 ? -n : n);
      if (s && !is_black(bsdf.evaluate(wo, s->direction))) queries.push_back({embree_ray(s->shadow_ray), true});
    }
    const double u_lobe = sampler.next_1d();
    const auto s = bsdf.sample(wo, u_lobe, sampler.next_2d());
    if (!s) return;
    throughput *= s->weight;
    if (is_black(throughput)) return;
    if (++depth > 3) {
      const double survival = std::min(0.95, static_cast<double>(max_component(throughput)));
      if (sampler.next_1d() >= survival) return;
      throughput /= static_cast<float>(survival);
    }
    ray = leave(point, s->direction);
  }
}

Queries collect(const RayTracer& tracer, const Camera& camera, const RenderOptions& options) {
  constexpr int tile = 32, block = 4;
  const CameraRays camera_rays(camera, options.width, options.height, FilterKind::box, 1);
  const DirectLight light(tracer, true, true);
  const int columns = (options.width + tile - 1) / tile, rows = (options.height + tile - 1) / tile;
  Queries queries(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  parallel_for(queries.size(), 1, [&](std::size_t number, std::size_t) {
    const int x0 = static_cast<int>(number) % columns * tile, y0 = static_cast<int>(number) / columns * tile;
    for (int k = 0; k < tile * tile; ++k) {
      const int in_block = k % (block * block), of_tile = k / (block * block);
      const int x = x0 + of_tile % (tile / block) * block + in_block % block;
      const int y = y0 + of_tile / (tile / block) * block + in_block / block;
      if (x >= options.width || y >= options.height) continue;
      PixelSampler sampler(0, x, y, 0);
      const Ray ray = camera_rays.ray(x, y, sampler).ray;
      if (options.integrator == IntegratorKind::path) {
        record_path(tracer, light.lights(), ray, sampler, queries[number]);
        continue;
      }
      Recorder recorder(light, options.integrator == IntegratorKind::whitted, sampler, queries[number]);
      (void)SpecularTree(tracer, false).trace(ray, {.start = ray.origin}, recorder);
    }
  });
  return queries;
}

struct Case {
  const char* name;
  IntegratorKind integrator;
  int width, height;
  bool polished;  ///< floor and columns reflect a part of the light
};

nlohmann::json run_case(const Case& one, int triangles, int runs) {
  Scene scene = make_builtin_scene("atrium?triangles=" + std::to_string(triangles));
  for (Material& m : scene.materials) {
    if (one.polished && (m.name == "floor" || m.name == "marble")) m.mirror = Rgb(0.2F);
  }
  const RayTracer tracer(scene);
  const Camera& camera = scene.cameras.at(0);
  RenderOptions options;
  options.integrator = one.integrator;
  options.width = one.width;
  options.height = one.height;
  options.samples_per_pixel = 1;
  const Queries queries = collect(tracer, camera, options);
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene robust = bare_scene(device, scene, RTC_SCENE_FLAG_ROBUST);
  RTCScene plain = bare_scene(device, scene, RTC_SCENE_FLAG_NONE);

  nlohmann::json report{{"name", one.name}, {"size", {one.width, one.height}}, {"triangles", tracer.triangle_count()}};
  const ThreadLimit everything(0);
  std::vector<int> thread_counts{1};
  if (thread_count() > 1) thread_counts.push_back(thread_count());
  for (const int threads : thread_counts) {
    const ThreadLimit limit(threads);
    std::vector<double> bare_rate, whole_rate, ratio, cpu_ratio, default_ratio;
    double bare_rays = 0, whole_rays = 0;
    for (int run = -1; run < runs; ++run) {  // the first warms up
      const Cost bare = cost_of(RUSAGE_SELF, [&] { bare_rays = static_cast<double>(trace_bare(robust, queries)); });
      const Cost fast = cost_of(RUSAGE_SELF, [&] { trace_bare(plain, queries); });
      const Cost whole =
          cost_of(RUSAGE_SELF, [&] { whole_rays = static_cast<double>(render(tracer, camera, options).rays.total()); });
      if (run < 0) continue;
      bare_rate.push_back(1e-6 * bare_rays / bare.wall);
      whole_rate.push_back(1e-6 * whole_rays / whole.wall);
      const double more = whole_rays / bare_rays;
      ratio.push_back(more * bare.wall / whole.wall);
      cpu_ratio.push_back(more * bare.cpu / whole.cpu);
      default_ratio.push_back(more * fast.cpu / whole.cpu);
    }
    fmt::print("{:>18} {:>8} {:>12.0f} {:>12.0f} {:>12.2f} {:>12.2f} {:>8.2f} {:>8.2f} {:>12.2f}\n", one.name, threads,
               1e-3 * bare_rays, 1e-3 * whole_rays, median(bare_rate), median(whole_rate), median(ratio),
               median(cpu_ratio), median(default_ratio));
    report["results"].push_back({{"threads", threads},
                                 {"bare_rays", bare_rays},
                                 {"renderer_rays", whole_rays},
                                 {"bare_mrays_per_s", median(bare_rate)},
                                 {"renderer_mrays_per_s", median(whole_rate)},
                                 {"ratio", median(ratio)},
                                 {"ratio_cpu", median(cpu_ratio)},
                                 {"ratio_cpu_default_flags", median(default_ratio)}});
  }
  rtcReleaseScene(robust);
  rtcReleaseScene(plain);
  rtcReleaseDevice(device);
  return report;
}

}  // namespace

nlohmann::json compare_ray_rates(const Arguments& a) {
  fmt::print(
      "Rays per second, atrium of a million triangles, one sample a pixel: the renderer over Embree's bare loop\n");
  fmt::print("{:>18} {:>8} {:>12} {:>12} {:>12} {:>12} {:>8} {:>8} {:>12}\n", "integrator", "threads", "bare krays",
             "our krays", "bare Mray/s", "our Mray/s", "ratio", "by cpu", "default,cpu");
  const Case cases[] = {{"appel", IntegratorKind::appel, 1920, 1080, false},
                        {"whitted", IntegratorKind::whitted, 1920, 1080, false},
                        {"whitted, polished", IntegratorKind::whitted, 1920, 1080, true},
                        {"path", IntegratorKind::path, 480, 270, false}};
  nlohmann::json report = nlohmann::json::array();
  for (const Case& c : cases) report.push_back(run_case(c, 1000000, a.quick ? 1 : 5));
  return report;
}

}  // namespace penumbra::bench
