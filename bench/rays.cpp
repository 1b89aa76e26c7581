// How close does the whole renderer come to a bare loop over Embree's single rays?
//
// On atrium?triangles=1000000 at 1 sample a pixel: `appel` (primary rays, one shadow ray to each light, shading, film)
// against rtcIntersect1 over the same primary rays and rtcOccluded1 over the same shadow rays, in the order of the
// renderer's tiles, in a hierarchy with the renderer's flags (robust) and in one with Embree's defaults. 1 thread and
// all threads, medians of several runs in turn.
//
//   bench_rays [--json FILE] [--quick] [--triangles N] [--size WxH]

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/camera_rays.h"
#include "penumbra/render/render.h"
#include "penumbra/scene/builtin_scenes.h"
#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/light_sampling.h"

namespace {

using namespace penumbra;

struct Arguments {
  std::string json;
  int triangles = 1000000;
  int width = 1920, height = 1080;
  int runs = 7;
};

Arguments parse(int count, char** words) {
  Arguments a;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--json" && i + 1 < count) a.json = words[++i];
    if (word == "--triangles" && i + 1 < count) a.triangles = std::stoi(words[++i]);
    if (word == "--size" && i + 1 < count) std::sscanf(words[++i], "%dx%d", &a.width, &a.height);
    if (word == "--quick") a.runs = 3;
  }
  return a;
}

double seconds_of(const auto& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
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

// The primary rays in the order of the renderer's tiles and blocks, and the shadow rays that follow from them.
struct RaySet {
  std::vector<RTCRay> primary, shadow;
};

RaySet collect_rays(const RayTracer& tracer, const Camera& camera, const Arguments& a) {
  RaySet set;
  const CameraRays camera_rays(camera, a.width, a.height, FilterKind::box, 1);
  const LightSampler lights(tracer.scene());
  const auto visit = [&](int x, int y) {
    PixelSampler sampler(0, x, y, 0);
    const Ray ray = camera_rays.ray(x, y, sampler).ray;
    set.primary.push_back(embree_ray(ray));
    const auto hit = tracer.nearest(ray);
    if (!hit) return;
    const SurfacePoint point = tracer.surface_point(ray, *hit);
    for (std::size_t l = 0; l < lights.light_count(); ++l) {
      const auto s =
          lights.has_middle(l) ? lights.sample_middle(l, point) : lights.sample_light(l, point, sampler.next_2d());
      const Vec3d& n = point.geometric_normal;
      if (!s || dot(n, s->direction) * dot(n, -ray.direction) <= 0) continue;
      set.shadow.push_back(embree_ray(s->shadow_ray));
    }
  };
  for (int ty = 0; ty < a.height; ty += 32) {
    for (int tx = 0; tx < a.width; tx += 32) {
      for (int by = ty; by < std::min(a.height, ty + 32); by += 4) {
        for (int bx = tx; bx < std::min(a.width, tx + 32); bx += 4) {
          for (int k = 0; k < 16; ++k) {
            if (bx + k % 4 < a.width && by + k / 4 < a.height) visit(bx + k % 4, by + k / 4);
          }
        }
      }
    }
  }
  return set;
}

std::size_t trace_bare(RTCScene world, const RaySet& set) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  parallel_for(set.primary.size(), 4096, [&](std::size_t first, std::size_t last) {
    RTCIntersectContext own = context;
    for (std::size_t i = first; i < last; ++i) {
      RTCRayHit query{set.primary[i], {}};
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(world, &own, &query);
    }
  });
  parallel_for(set.shadow.size(), 4096, [&](std::size_t first, std::size_t last) {
    RTCIntersectContext own = context;
    for (std::size_t i = first; i < last; ++i) {
      RTCRay query = set.shadow[i];
      rtcOccluded1(world, &own, &query);
    }
  });
  return set.primary.size() + set.shadow.size();
}

}  // namespace

int main(int count, char** words) {
  const Arguments a = parse(count, words);
  const Scene scene = make_builtin_scene("atrium?triangles=" + std::to_string(a.triangles));
  const RayTracer tracer(scene);
  const Camera& camera = scene.cameras.at(0);
  const RaySet set = collect_rays(tracer, camera, a);
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene robust = bare_scene(device, scene, RTC_SCENE_FLAG_ROBUST);
  RTCScene fast = bare_scene(device, scene, RTC_SCENE_FLAG_NONE);

  RenderOptions options;
  options.integrator = IntegratorKind::appel;
  options.width = a.width;
  options.height = a.height;
  options.samples_per_pixel = 1;

  nlohmann::json report{{"triangles", tracer.triangle_count()},
                        {"size", {a.width, a.height}},
                        {"primary_rays", set.primary.size()},
                        {"shadow_rays", set.shadow.size()},
                        {"runs", a.runs}};
  fmt::print("atrium, {} triangles, {} x {}, {} primary and {} shadow rays\n", tracer.triangle_count(), a.width,
             a.height, set.primary.size(), set.shadow.size());
  fmt::print("{:>8} {:>22} {:>22} {:>18} {:>16} {:>16}\n", "threads", "bare robust Mray/s", "bare default Mray/s",
             "renderer Mray/s", "ratio (robust)", "ratio (default)");
  const ThreadLimit everything(0);
  std::vector<int> thread_counts{1};
  if (thread_count() > 1) thread_counts.push_back(thread_count());
  for (const int threads : thread_counts) {
    const ThreadLimit limit(threads);
    std::vector<double> bare_rate, fast_rate, whole_rate, ratio, fast_ratio;
    for (int run = -1; run < a.runs; ++run) {  // the first warms up
      std::size_t bare_rays = 0;
      std::uint64_t whole_rays = 0;
      const double bare = seconds_of([&] { bare_rays = trace_bare(robust, set); });
      const double plain = seconds_of([&] { trace_bare(fast, set); });
      const double whole = seconds_of([&] { whole_rays = render(tracer, camera, options).rays.total(); });
      if (run < 0) continue;
      bare_rate.push_back(1e-6 * static_cast<double>(bare_rays) / bare);
      fast_rate.push_back(1e-6 * static_cast<double>(bare_rays) / plain);
      whole_rate.push_back(1e-6 * static_cast<double>(whole_rays) / whole);
      ratio.push_back(whole_rate.back() / bare_rate.back());
      fast_ratio.push_back(whole_rate.back() / fast_rate.back());
    }
    fmt::print("{:>8} {:>22.2f} {:>22.2f} {:>18.2f} {:>16.2f} {:>16.2f}\n", threads, median(bare_rate),
               median(fast_rate), median(whole_rate), median(ratio), median(fast_ratio));
    report["results"].push_back({{"threads", threads},
                                 {"bare_robust_mrays_per_s", median(bare_rate)},
                                 {"bare_default_mrays_per_s", median(fast_rate)},
                                 {"renderer_mrays_per_s", median(whole_rate)},
                                 {"ratio_robust", median(ratio)},
                                 {"ratio_default", median(fast_ratio)}});
  }
  rtcReleaseScene(robust);
  rtcReleaseScene(fast);
  rtcReleaseDevice(device);
  if (!a.json.empty()) std::ofstream(a.json) << report.dump(2) << '\n';
  return 0;
}
