#include "penumbra/tracing/ray_tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "penumbra/scene/texture_lookup.h"
#include "penumbra/tracing/opacity.h"
#include "penumbra/tracing/placed_mesh.h"
#include "penumbra/tracing/shape_intersection.h"
#include "penumbra/tracing/shape_list.h"

namespace penumbra {
namespace {

// Up to how many disks and cylinders are tried one by one rather than in the hierarchy.
constexpr std::size_t few_others = 8;

struct DeviceDeleter {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceDeleter>;
using Hierarchy = std::unique_ptr<RTCSceneTy, SceneDeleter>;

// What a user geometry's callbacks need to know.
struct ShapeEntry {
  Shape shape;
  Bounds bounds;
};
struct MaskEntry {
  const Scene* scene = nullptr;
  const Mesh* mesh = nullptr;
};

void shape_bounds_callback(const RTCBoundsFunctionArguments* args) {
  const auto* entry = static_cast<const ShapeEntry*>(args->geometryUserPtr);
  const auto down = [](double v) {
    return std::nextafter(static_cast<float>(v), -std::numeric_limits<float>::infinity());
  };
  const auto up = [](double v) {
    return std::nextafter(static_cast<float>(v), std::numeric_limits<float>::infinity());
  };
  const Bounds& b = entry->bounds;
  *args->bounds_o = {down(b.lower.x), down(b.lower.y), down(b.lower.z), 0,
                     up(b.upper.x),   up(b.upper.y),   up(b.upper.z),   0};
}

Ray lane_ray(RTCRayN* rays, unsigned n, unsigned i) {
  return {.origin = {RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i)},
          .direction = {RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i)},
          .t_min = RTCRayN_tnear(rays, n, i),
          .t_max = RTCRayN_tfar(rays, n, i),
          .time = RTCRayN_time(rays, n, i)};
}

std::optional<double> intersect_shape(const Shape& shape, const Ray& ray) {
  return std::visit([&](const auto& s) { return intersect(s, ray); }, shape);
}

void shape_intersect_callback(const RTCIntersectFunctionNArguments* args) {
  const auto* entry = static_cast<const ShapeEntry*>(args->geometryUserPtr);
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, args->N);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const Ray ray = lane_ray(rays, args->N, i);
    const auto t = intersect_shape(entry->shape, ray);
    if (!t) continue;
    const Vec3f n(shape_normal(entry->shape, ray.at(*t)));
    RTCRayN_tfar(rays, args->N, i) = static_cast<float>(*t);
    RTCHitN_Ng_x(hits, args->N, i) = n.x;
    RTCHitN_Ng_y(hits, args->N, i) = n.y;
    RTCHitN_Ng_z(hits, args->N, i) = n.z;
    RTCHitN_u(hits, args->N, i) = 0;
    RTCHitN_v(hits, args->N, i) = 0;
    RTCHitN_primID(hits, args->N, i) = 0;
    RTCHitN_geomID(hits, args->N, i) = args->geomID;
    RTCHitN_instID(hits, args->N, i, 0) = args->context->instID[0];
  }
}

void shape_occluded_callback(const RTCOccludedFunctionNArguments* args) {
  const auto* entry = static_cast<const ShapeEntry*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    if (intersect_shape(entry->shape, lane_ray(args->ray, args->N, i))) {
      RTCRayN_tfar(args->ray, args->N, i) = -std::numeric_limits<float>::infinity();
    }
  }
}

// Lets rays pass where an alpha mask is below its cutoff.
void mask_callback(const RTCFilterFunctionNArguments* args) {
  const auto* entry = static_cast<const MaskEntry*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const Vec2d b(RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i));
    if (!is_solid(*entry->scene, *entry->mesh, RTCHitN_primID(args->hit, args->N, i), b)) args->valid[i] = 0;
  }
}

bool has_mask(const Scene& scene, const Mesh& mesh) {
  return std::any_of(mesh.materials.begin(), mesh.materials.end(),
                     [&](std::uint32_t m) { return scene.materials[m].alpha_mode == AlphaMode::mask; });
}

// A row of the table that turns Embree's geometry numbers into ours.
struct Entry {
  std::uint32_t object = 0;
  bool turned = false;  ///< Embree's normals need turning to the world's front
};

}  // namespace

struct RayTracer::Impl {
  const Scene* scene = nullptr;
  Device device;
  std::vector<Hierarchy> meshes;  // for meshes with several instances
  Hierarchy world;                // none without triangles, when all shapes are in the list
  ShapeList list;
  std::vector<Entry> entries;  // by geometry number of `world`
  std::vector<std::unique_ptr<ShapeEntry>> shapes;
  std::vector<std::unique_ptr<MaskEntry>> masks;
  std::vector<PlacedMesh> placed;                      // by instance
  std::vector<std::span<const Vec3f>> world_vertices;  // by instance; the hierarchy's own
  Bounds bounds;
  bool native_packets = false;
  bool any_turned = false;
  bool any_motion = false;
  // Embree 3.13.5's coherent traversal of packets never ends in some hierarchies that hold both instances and user
  // geometry (rtcOccluded16; tests/tracing: RayPackets), so only plain triangles get it.
  bool only_triangles = true;
  std::string error;

  explicit Impl(const Scene& s) : scene(&s) {}

  void open_device() {
    device.reset(rtcNewDevice(nullptr));
    if (!device) throw std::runtime_error("the ray tracing kernels cannot start on this processor");
    rtcSetDeviceErrorFunction(device.get(), note_error, this);
    native_packets = rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
  }

  static void note_error(void* self, RTCError code, const char* text) {
    auto& note = static_cast<Impl*>(self)->error;
    if (note.empty()) note = code == RTC_ERROR_OUT_OF_MEMORY ? "out of memory" : text;
  }
  void throw_on_error() const {
    if (error == "out of memory") throw std::bad_alloc();
    if (!error.empty()) throw std::runtime_error("ray tracing kernels: " + error);
  }

  Hierarchy new_hierarchy() {
    Hierarchy h(rtcNewScene(device.get()));
    rtcSetSceneFlags(h.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(h.get(), RTC_BUILD_QUALITY_MEDIUM);
    return h;
  }

  void attach_triangles(RTCScene target, const Mesh& mesh, const Mat4d& to_space, std::uint32_t object);
  void attach_instances();
  [[nodiscard]] std::vector<std::size_t> list_shapes();
  void attach_instance(RTCScene of_mesh, const Instance& instance, std::uint32_t object);
  void attach_shapes(std::span<const std::size_t> numbers);
  void add_entry(unsigned geometry, std::uint32_t object, bool turned) {
    if (entries.size() <= geometry) entries.resize(geometry + 1);
    entries[geometry] = {object, turned};
    any_turned = any_turned || turned;
  }
  [[nodiscard]] RTCIntersectContext packet_context(bool coherent) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherent && only_triangles ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
  }
  void nearest(const RayPacket& rays, HitPacket& hits, bool coherent) const;
  void nearest_below(const RayPacket& rays, HitPacket& hits, bool coherent) const;
  void turn_normals(RTCHitN* found, const RayPacket& rays, HitPacket& hits) const;
  /// The mesh of an instance where it is at a time.
  [[nodiscard]] PlacedMesh placed_at(std::uint32_t object, double time) const {
    const Instance& instance = scene->instances[object];
    return {scene->meshes[instance.mesh], placement_at(instance.motion, time), true};
  }
  [[nodiscard]] bool moves(std::uint32_t object) const { return !scene->instances[object].motion.empty(); }
  [[nodiscard]] std::uint32_t object_of(unsigned geometry, unsigned instance) const {
    return entries[instance != RTC_INVALID_GEOMETRY_ID ? instance : geometry].object;
  }
};

void RayTracer::Impl::attach_triangles(RTCScene target, const Mesh& mesh, const Mat4d& to_space, std::uint32_t object) {
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.positions.size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  throw_on_error();
  const bool identity = to_space == Mat4d(1.0);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3f p(identity ? mesh.positions[i] : transform_point(to_space, mesh.positions[i]));
    std::memcpy(vertices + 3 * i, &p, sizeof p);
  }
  std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * sizeof(Mesh::Triangle));
  if (has_mask(*scene, mesh)) {
    masks.push_back(std::make_unique<MaskEntry>(MaskEntry{scene, &mesh}));
    rtcSetGeometryUserData(geometry, masks.back().get());
    rtcSetGeometryIntersectFilterFunction(geometry, mask_callback);
    rtcSetGeometryOccludedFilterFunction(geometry, mask_callback);
  }
  rtcCommitGeometry(geometry);
  const unsigned number = rtcAttachGeometry(target, geometry);
  if (target == world.get()) {
    add_entry(number, object, placed[object].mirrors());
    world_vertices[object] = {reinterpret_cast<const Vec3f*>(vertices), mesh.positions.size()};
  }
  rtcReleaseGeometry(geometry);
}

// A mesh with one instance at rest goes into the world's own hierarchy, which traces faster; another is built once.
void RayTracer::Impl::attach_instances() {
  std::vector<std::uint32_t> uses(scene->meshes.size(), 0);
  for (const Instance& i : scene->instances) ++uses[i.mesh];
  meshes.resize(scene->meshes.size());
  world_vertices.resize(scene->instances.size());
  for (std::uint32_t object = 0; object < scene->instances.size(); ++object) {
    const Instance& instance = scene->instances[object];
    const Mesh& mesh = scene->meshes[instance.mesh];
    const bool moving = moves(object);
    placed.emplace_back(mesh, instance.to_world, uses[instance.mesh] > 1 || moving);
    if (mesh.triangles.empty()) continue;
    any_motion = any_motion || moving;
    for (const Mat4d& to_world : moving ? instance.motion : Motion{instance.to_world}) {
      for (const Vec3d& p : mesh.positions) bounds.grow(transform_point(to_world, p));
    }
    if (uses[instance.mesh] == 1 && !moving) {
      attach_triangles(world.get(), mesh, instance.to_world, object);
      continue;
    }
    only_triangles = false;
    Hierarchy& own = meshes[instance.mesh];
    if (!own) {
      own = new_hierarchy();
      attach_triangles(own.get(), mesh, Mat4d(1.0), object);
      rtcCommitScene(own.get());
    }
    attach_instance(own.get(), instance, object);
  }
}

// The hierarchy's matrices change evenly from one step of time to the next, as `placement_at` has it.
void RayTracer::Impl::attach_instance(RTCScene of_mesh, const Instance& instance, std::uint32_t object) {
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, of_mesh);
  const std::size_t steps = std::max<std::size_t>(1, instance.motion.size());
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(steps));
  for (std::size_t step = 0; step < steps; ++step) {
    const glm::mat4 m(instance.motion.empty() ? instance.to_world : instance.motion[step]);
    rtcSetGeometryTransform(geometry, static_cast<unsigned>(step), RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &m[0][0]);
  }
  rtcCommitGeometry(geometry);
  add_entry(rtcAttachGeometry(world.get(), geometry), object, true);
  rtcReleaseGeometry(geometry);
}

// Shapes that are few go into the list, the rest into the hierarchy. Returns the numbers of those.
std::vector<std::size_t> RayTracer::Impl::list_shapes() {
  std::size_t spheres = 0, others = 0;
  for (const ShapeObject& s : scene->shapes) {
    if (std::holds_alternative<Plane>(s.shape)) continue;
    bounds.grow(shape_bounds(s.shape, 0));
    ++(std::holds_alternative<Sphere>(s.shape) ? spheres : others);
  }
  std::vector<std::size_t> rest;
  for (std::size_t i = 0; i < scene->shapes.size(); ++i) {
    const Shape& shape = scene->shapes[i].shape;
    const bool listed = std::holds_alternative<Plane>(shape) ||
                        (std::holds_alternative<Sphere>(shape) ? spheres <= ShapeList::longest : others <= few_others);
    if (listed) {
      list.add(shape, static_cast<std::uint32_t>(scene->instances.size() + i));
    } else {
      rest.push_back(i);
    }
  }
  return rest;
}

void RayTracer::Impl::attach_shapes(std::span<const std::size_t> numbers) {
  for (const std::size_t i : numbers) {
    const Shape& shape = scene->shapes[i].shape;
    only_triangles = false;
    shapes.push_back(std::make_unique<ShapeEntry>(ShapeEntry{shape, shape_bounds(shape, 0)}));
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryUserData(geometry, shapes.back().get());
    rtcSetGeometryBoundsFunction(geometry, shape_bounds_callback, nullptr);
    rtcSetGeometryIntersectFunction(geometry, shape_intersect_callback);
    rtcSetGeometryOccludedFunction(geometry, shape_occluded_callback);
    rtcCommitGeometry(geometry);
    add_entry(rtcAttachGeometry(world.get(), geometry), static_cast<std::uint32_t>(scene->instances.size() + i), false);
    rtcReleaseGeometry(geometry);
  }
}

RayTracer::RayTracer(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {
  const std::vector<std::size_t> rest = impl_->list_shapes();
  if (rest.empty() && scene.triangle_count() == 0) return;
  impl_->open_device();
  impl_->world = impl_->new_hierarchy();
  impl_->attach_instances();
  impl_->attach_shapes(rest);
  rtcCommitScene(impl_->world.get());
  impl_->throw_on_error();
}

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;

const Scene& RayTracer::scene() const { return *impl_->scene; }
Bounds RayTracer::bounds() const { return impl_->bounds; }
std::size_t RayTracer::triangle_count() const { return impl_->scene->triangle_count(); }

namespace {

RTCRay embree_ray(const Ray& ray) {
  RTCRay r{};
  r.org_x = static_cast<float>(ray.origin.x);
  r.org_y = static_cast<float>(ray.origin.y);
  r.org_z = static_cast<float>(ray.origin.z);
  r.dir_x = static_cast<float>(ray.direction.x);
  r.dir_y = static_cast<float>(ray.direction.y);
  r.dir_z = static_cast<float>(ray.direction.z);
  r.tnear = static_cast<float>(ray.t_min);
  r.tfar = static_cast<float>(ray.t_max);
  r.time = static_cast<float>(ray.time);
  r.mask = 0xFFFFFFFFU;
  return r;
}

}  // namespace

std::optional<Hit> RayTracer::nearest(const Ray& ray) const {
  std::optional<Hit> listed;
  if (!impl_->list.empty()) {
    if (const auto met = impl_->list.nearest(ray)) listed = Hit{.t = met->t, .object = met->object};
  }
  if (!impl_->world) return listed;
  RTCRayHit query{embree_ray(ray), {}};
  if (listed) query.ray.tfar = static_cast<float>(listed->t);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->world.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return listed;
  return Hit{.t = query.ray.tfar,
             .object = impl_->object_of(query.hit.geomID, query.hit.instID[0]),
             .primitive = query.hit.primID,
             .barycentric = {query.hit.u, query.hit.v}};
}

bool RayTracer::occluded(const Ray& ray) const {
  if (!impl_->list.empty() && impl_->list.occluded(ray)) return true;
  if (!impl_->world) return false;
  RTCRay query = embree_ray(ray);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->world.get(), &context, &query);
  return query.tfar < 0;
}

namespace {

void copy_rays(const RayPacket& rays, RTCRay16& out) {
  std::memcpy(out.org_x, rays.origin_x, sizeof out.org_x);
  std::memcpy(out.org_y, rays.origin_y, sizeof out.org_y);
  std::memcpy(out.org_z, rays.origin_z, sizeof out.org_z);
  std::memcpy(out.tnear, rays.t_min, sizeof out.tnear);
  std::memcpy(out.dir_x, rays.direction_x, sizeof out.dir_x);
  std::memcpy(out.dir_y, rays.direction_y, sizeof out.dir_y);
  std::memcpy(out.dir_z, rays.direction_z, sizeof out.dir_z);
  std::memcpy(out.tfar, rays.t_max, sizeof out.tfar);
  std::memcpy(out.time, rays.time, sizeof out.time);
  std::fill(std::begin(out.mask), std::end(out.mask), 0xFFFFFFFFU);
  std::fill(std::begin(out.id), std::end(out.id), 0U);
  std::fill(std::begin(out.flags), std::end(out.flags), 0U);
}

// Stream queries take no mask: a lane sleeps when its interval is empty.
void put_to_sleep(const RayPacket& rays, RTCRay16& out) {
  for (int i = 0; i < RayPacket::size; ++i) {
    if (rays.active[i] == 0) out.tnear[i] = std::numeric_limits<float>::infinity(), out.tfar[i] = -1;
  }
}

}  // namespace

// Embree knows normals in the space of the mesh it met, by the order of the corners.
void RayTracer::Impl::turn_normals(RTCHitN* found, const RayPacket& rays, HitPacket& hits) const {
  for (unsigned i = 0; i < RayPacket::size; ++i) {
    if (hits.object[i] == HitPacket::no_hit) continue;
    const unsigned instance = RTCHitN_instID(found, RayPacket::size, i, 0);
    const bool in_instance = instance != RTC_INVALID_GEOMETRY_ID;
    if (!entries[in_instance ? instance : RTCHitN_geomID(found, RayPacket::size, i)].turned) continue;
    const Vec3d n(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]);
    const std::uint32_t object = hits.object[i];
    const Vec3f front(!in_instance    ? -n
                      : moves(object) ? placed_at(object, static_cast<double>(rays.time[i])).front_normal(n)
                                      : placed[object].front_normal(n));
    hits.normal_x[i] = front.x;
    hits.normal_y[i] = front.y;
    hits.normal_z[i] = front.z;
  }
}

void RayTracer::nearest(const RayPacket& rays, HitPacket& hits, bool coherent) const {
  const bool has_list = !impl_->list.empty();
  if (has_list || !impl_->world) impl_->list.nearest(rays, hits);
  if (impl_->world) has_list ? impl_->nearest_below(rays, hits, coherent) : impl_->nearest(rays, hits, coherent);
}

void RayTracer::Impl::nearest(const RayPacket& rays, HitPacket& hits, bool coherent) const {
  RTCRayHit16 query;
  copy_rays(rays, query.ray);
  std::fill(std::begin(query.hit.geomID), std::end(query.hit.geomID), RTC_INVALID_GEOMETRY_ID);
  std::fill(std::begin(query.hit.instID[0]), std::end(query.hit.instID[0]), RTC_INVALID_GEOMETRY_ID);
  RTCIntersectContext context = packet_context(coherent);
  if (native_packets) {
    rtcIntersect16(rays.active, world.get(), &context, &query);
  } else {
    put_to_sleep(rays, query.ray);
    rtcIntersectNM(world.get(), &context, reinterpret_cast<RTCRayHitN*>(&query), RayPacket::size, 1, sizeof query);
  }
  std::memcpy(hits.t, query.ray.tfar, sizeof hits.t);
  std::memcpy(hits.normal_x, query.hit.Ng_x, sizeof hits.normal_x);
  std::memcpy(hits.normal_y, query.hit.Ng_y, sizeof hits.normal_y);
  std::memcpy(hits.normal_z, query.hit.Ng_z, sizeof hits.normal_z);
  std::memcpy(hits.u, query.hit.u, sizeof hits.u);
  std::memcpy(hits.v, query.hit.v, sizeof hits.v);
  std::memcpy(hits.primitive, query.hit.primID, sizeof hits.primitive);
  for (int i = 0; i < RayPacket::size; ++i) {
    const bool hit = rays.active[i] != 0 && query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    hits.object[i] = hit ? object_of(query.hit.geomID[i], query.hit.instID[0][i]) : HitPacket::no_hit;
  }
  if (any_turned) turn_normals(reinterpret_cast<RTCHitN*>(&query.hit), rays, hits);
}

// Takes what the hierarchy holds nearer than the hits so far.
void RayTracer::Impl::nearest_below(const RayPacket& rays, HitPacket& hits, bool coherent) const {
  RayPacket rest = rays;
  std::memcpy(rest.t_max, hits.t, sizeof rest.t_max);
  HitPacket found;
  nearest(rest, found, coherent);
  for (int i = 0; i < RayPacket::size; ++i) {
    if (found.object[i] == HitPacket::no_hit) continue;
    hits.t[i] = found.t[i];
    hits.normal_x[i] = found.normal_x[i];
    hits.normal_y[i] = found.normal_y[i];
    hits.normal_z[i] = found.normal_z[i];
    hits.u[i] = found.u[i];
    hits.v[i] = found.v[i];
    hits.object[i] = found.object[i];
    hits.primitive[i] = found.primitive[i];
  }
}

void RayTracer::occluded(RayPacket& rays, bool coherent) const {
  if (!impl_->list.empty()) impl_->list.occluded(rays);
  if (!impl_->world) return;
  RTCRay16 query;
  copy_rays(rays, query);
  RTCIntersectContext context = impl_->packet_context(coherent);
  if (impl_->native_packets) {
    rtcOccluded16(rays.active, impl_->world.get(), &context, &query);
  } else {
    put_to_sleep(rays, query);
    rtcOccludedNM(impl_->world.get(), &context, reinterpret_cast<RTCRayN*>(&query), RayPacket::size, 1, sizeof query);
  }
  // Embree sets tfar to minus infinity where something stands in the way.
  for (int i = 0; i < RayPacket::size; ++i) {
    if (query.tfar[i] == -std::numeric_limits<float>::infinity()) rays.active[i] = 0;
  }
}

SurfacePoint RayTracer::surface_point(const Ray& ray, const Hit& hit) const {
  const Scene& scene = *impl_->scene;
  SurfacePoint p;
  if (hit.object >= scene.instances.size()) {
    const ShapeObject& object = scene.shapes[hit.object - scene.instances.size()];
    const ShapePoint s = shape_point(object.shape, ray.at(hit.t), reads_textures(scene.materials[object.material]));
    p.position = s.position;
    p.geometric_normal = p.shading_normal = s.normal;
    p.tangent = s.tangent;
    p.bitangent = cross(s.normal, s.tangent);
    p.uv[0] = p.uv[1] = s.uv;
    p.material = object.material;
    const auto* ball = std::get_if<Sphere>(&object.shape);
    p.error = rounding_error(largest_component(p.position) + (ball ? ball->radius : 0.0));
  } else if (impl_->moves(hit.object)) {
    // The hierarchy has the time in single precision.
    const auto time = static_cast<double>(static_cast<float>(ray.time));
    p = impl_->placed_at(hit.object, time).point(hit.primitive, hit.barycentric);
  } else {
    p = impl_->placed[hit.object].point(hit.primitive, hit.barycentric);
  }
  p.object = hit.object;
  p.primitive = hit.primitive;
  p.time = ray.time;
  return p;
}

SurfaceChange RayTracer::surface_change(const SurfacePoint& point, const Vec3d& step) const {
  const Scene& scene = *impl_->scene;
  if (point.object >= scene.instances.size()) {
    return shape_change(scene.shapes[point.object - scene.instances.size()].shape, point.position, step);
  }
  if (impl_->moves(point.object)) {
    return impl_->placed_at(point.object, point.time).change(point.primitive, point.position, step);
  }
  return impl_->placed[point.object].change(point.primitive, point.position, step);
}

std::span<const Vec3f> RayTracer::world_vertices(std::uint32_t object) const {
  return object < impl_->world_vertices.size() ? impl_->world_vertices[object] : std::span<const Vec3f>();
}

bool RayTracer::has_motion() const { return impl_->any_motion; }

}  // namespace penumbra
