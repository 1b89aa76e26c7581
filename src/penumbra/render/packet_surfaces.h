#pragma once

#include <optional>
#include <vector>

#include "penumbra/render/gloss_lanes.h"
#include "penumbra/render/packet_shading.h"

namespace penumbra {

/// What a packet of rays needs to know of a material.
struct PacketMaterial {
  enum class Kind {
    matt,   ///< Lambertian, or in two colours, with a constant mirror share or under a rough layer
    glass,  ///< a clear solid with smooth walls
    other,  ///< anything else: its lanes are shaded one by one
  };
  Kind kind = Kind::other;
  Rgb reflectance[2]{};    ///< Lambertian, of the first and the second colour; what the mirror leaves
  float checker_size = 0;  ///< m; 0: one colour
  Rgb mirror{0};
  std::optional<GlossLayer> gloss;  ///< on matt ones
  Rgb emission{0};
  bool double_sided = false;
  float ior = 1;          ///< of glass
  Rgb tint{0};            ///< of what glass lets through
  bool mirrors = false;   ///< matt, with a mirror share
  bool scatters = false;  ///< not black

  /// Whether a lane's point lies in a square of the second colour.
  [[nodiscard]] bool on_second_colour(const PointLanes& points, std::size_t lane) const;
};

/// Bends a lane's shading normal just so far that the eye sees its front, as frame_towards does.
void turn_towards_eye(const RayPacket& rays, std::size_t lane, PointLanes& points);

/// Gathers what the lanes of a packet hit from the scene, lane by lane: the part of shading that is all memory and no
/// arithmetic.
class PacketSurfaces {
 public:
  /// @param tracer whose vertices are read; it must outlive this.
  explicit PacketSurfaces(const RayTracer& tracer) : PacketSurfaces(tracer.scene(), &tracer) {}
  explicit PacketSurfaces(const Scene& scene) : PacketSurfaces(scene, nullptr) {}
  PacketSurfaces(const PacketSurfaces&) = delete;
  PacketSurfaces& operator=(const PacketSurfaces&) = delete;

  /// Whether everything in the scene rests and is matt, of one colour and without mirrors, so that no lane needs to be
  /// shaded by itself.
  [[nodiscard]] bool all_matt() const;

  /// Ask for what `gather` will read, of all lanes at once, since in large scenes memory is what it waits for: first
  /// which corners the triangles have, a while later the corners.
  void fetch_triangles(const HitPacket& hits, int used) const;
  void fetch_corners(const HitPacket& hits, int used) const;

  /// Puts a hit lane's triangle or shape beside the others; returns its material, or none when the lane has to be
  /// shaded by itself. @pre the lane hit something.
  [[nodiscard]] const PacketMaterial* gather(const HitPacket& hits, int lane, HitTriangles& triangles,
                                             HitShapes& shapes) const;

 private:
  /// An instance whose vertices need no turning, or how to turn them.
  struct Place {
    bool moves = false;
    bool as_is = true;
    bool mirrors = false;
    Mat4d to_world{1.0};
    Mat3d normals{1.0};
    const Mesh* mesh = nullptr;
    std::span<const Vec3f> corners;  ///< in the world, where the tracer has them
  };

  /// A sphere or a plane, as HitShapes has it.
  struct RoundOrFlat {
    const PacketMaterial* material = nullptr;  ///< none: another shape, or shaded by itself
    Vec3f centre{0}, normal{0};
    float radius = 0, flat = 0;
  };

  PacketSurfaces(const Scene& scene, const RayTracer* tracer);

  const Scene* scene_;
  std::vector<PacketMaterial> materials_;
  std::vector<Place> places_;  // by instance
  std::vector<RoundOrFlat> shapes_;
};

}  // namespace penumbra
