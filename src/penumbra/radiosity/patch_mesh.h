#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/scene/polygon_model.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// A row of the form factor matrix: one or more patches that radiate as one.
struct PatchSurface {
  std::string name;
  std::uint32_t face = 0;    ///< the input polygon (its number over the whole input), the first when several are merged
  std::uint32_t object = 0;  ///< as Scene numbers its objects; 0 for a PolygonModel
  bool back = false;         ///< the reversed side of its face
  double area = 0;           ///< m^2, the sum over its patches
};

/// Planar convex polygons that radiate from their front, stored flat: the geometry on which form factors are defined.
///
/// A *patch* is one convex polygon; a *surface* is a row: the patches of one face (a concave face has several), of one
/// object, or of faces that were combined. Patches [0, radiating_count) belong to a surface, ordered by surface;
/// the rest only hide what lies behind them. A two-sided plate is a pair of coincident patches of opposite orientation.
struct PatchMesh {
  static constexpr std::uint32_t no_surface = 0xffffffffU;

  std::vector<Vec3d> vertices;                   ///< metres; equal positions are one vertex
  std::vector<std::uint32_t> corner_offsets{0};  ///< patch p has corners [corner_offsets[p], corner_offsets[p + 1])
  std::vector<std::uint32_t> corners;            ///< into vertices, counter-clockwise seen from the front
  std::vector<Vec3d> corner_positions;           ///< vertices[corners[k]], so that a patch is one span

  // Per patch.
  std::vector<double> areas;  ///< m^2, > 0
  std::vector<Vec3d> centroids;
  std::vector<Vec3d> normals;             ///< unit, to the side that radiates
  std::vector<std::uint32_t> surface_of;  ///< the row, or no_surface for an obstruction
  std::vector<std::uint32_t> face_of;     ///< the input polygon, numbered over the whole input
  std::size_t radiating_count = 0;
  /// Pairs of radiating patches that lie face to face: each sees the other and nothing else (View3D's masking
  /// surfaces). They coincide and look at each other as the sides of a plate look apart, so their polygons do not tell:
  /// see with_contacts().
  std::vector<std::pair<std::uint32_t, std::uint32_t>> contacts;

  // Per surface.
  std::vector<PatchSurface> surfaces;
  std::size_t bands = 3;            ///< linear Rec. 709 red, green, blue unless said otherwise
  std::vector<double> reflectance;  ///< [surface * bands + band], diffuse, 0..1
  std::vector<double> emission;     ///< [surface * bands + band], radiosity E = pi L of the surface itself, W/m^2

  [[nodiscard]] std::size_t patch_count() const { return areas.size(); }
  [[nodiscard]] std::size_t surface_count() const { return surfaces.size(); }
  [[nodiscard]] std::span<const Vec3d> polygon(std::size_t patch) const {
    return std::span(corner_positions)
        .subspan(corner_offsets[patch], corner_offsets[patch + 1] - corner_offsets[patch]);
  }
  [[nodiscard]] std::span<const std::uint32_t> patch_corners(std::size_t patch) const {
    return std::span(corners).subspan(corner_offsets[patch], corner_offsets[patch + 1] - corner_offsets[patch]);
  }
};

/// Appends a patch with its area, centroid and normal, and adds its area to its surface; returns its number. For
/// builders and subdividers: they keep the order that PatchMesh promises, radiating patches first and by surface.
/// @param corners into mesh.vertices. @param surface a row of the mesh or PatchMesh::no_surface.
/// @pre the polygon is planar, convex and has area.
std::uint32_t add_patch(PatchMesh& mesh, std::span<const std::uint32_t> corners, std::uint32_t surface,
                        std::uint32_t face);

/// What makes one row.
enum class SurfaceGrouping { face, object, material };

/// Which sides of a face radiate.
enum class PatchSides {
  front,
  both,  ///< each face without a reversed coincident twin gets a second row for its back, right after its own
};

/// What to do with a face without area.
enum class DegenerateFaces { refuse, drop };

/// What to do with a face that lies exactly on an earlier one of the same orientation.
enum class DuplicateFaces { refuse, drop };

struct PatchMeshOptions {
  SurfaceGrouping grouping = SurfaceGrouping::face;
  PatchSides sides = PatchSides::front;
  DegenerateFaces degenerate = DegenerateFaces::refuse;
  DuplicateFaces duplicates = DuplicateFaces::refuse;
  double planarity_tolerance =
      1e-6;  ///< of a polygon's size; beyond it a polygon is triangulated, with one warning for all
  int shape_segments =
      0;  ///< 3 or more: spheres, disks and cylinders become polygons, this many around; 0: they are refused
};

/// A mesh and what was done to the input to make it: each warning is one sentence.
struct MadePatchMesh {
  PatchMesh mesh;
  std::vector<std::string> warnings;
};

/// The faces of a scene in world space, instance by instance, face by face. Reflectance is the diffuse part
/// base colour (1 - metallic) (1 - transmission); emission is pi times the material's radiance (a back emits when the
/// material is double-sided). Textures are not looked at.
/// Throws std::invalid_argument, naming object and face (counted from 1), for a self-intersecting face, a face without
/// area, two coincident faces of the same orientation (unless the options drop them), or a shape that cannot be made of
/// polygons.
[[nodiscard]] MadePatchMesh make_patch_mesh(const Scene& scene, const PatchMeshOptions& options = {});

/// The polygons of a thermal model, with one band; a row for each radiating polygon that is not combined with another,
/// in input order. Subsurfaces are cut out of their bases. A polygon that covers its base has a row of its own and sees
/// only what it covers, which stays part of the base's row. Groupings by object or material do not apply. Throws
/// std::invalid_argument as above, naming the polygon's place, and for combinations that lead nowhere.
[[nodiscard]] MadePatchMesh make_patch_mesh(const PolygonModel& model, const PatchMeshOptions& options = {});

}  // namespace penumbra
