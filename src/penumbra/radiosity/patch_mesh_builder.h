#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// Diffuse reflectance (0..1) and radiosity emitted by either side (W/m^2), a value a band.
struct PatchPaint {
  std::vector<double> reflectance;
  std::vector<double> emission;
  std::vector<double> back_emission;
};

/// Turns faces as they come from a file into a PatchMesh: refuses what has no meaning, splits what is not planar and
/// convex, joins equal corners and finds two-sided plates.
class PatchMeshBuilder {
 public:
  /// @param place_of names an input face at the start of a sentence ("Face 3 of \"box\"").
  PatchMeshBuilder(std::size_t bands, const PatchMeshOptions& options,
                   std::function<std::string(std::uint32_t)> place_of);

  /// A row; in the mesh rows stand in the order of these calls. Rows that no face uses are left out.
  std::uint32_t add_surface(PatchSurface surface);
  std::uint32_t add_paint(PatchPaint paint);

  /// A simple polygon, counter-clockwise seen from its front. `holes` are convex coplanar polygons to cut out.
  /// Throws std::invalid_argument with one sentence when it crosses itself, or has no area and is not to be dropped.
  void add_face(std::vector<Vec3d> polygon, std::uint32_t face, std::uint32_t surface, std::uint32_t paint,
                std::span<const std::vector<Vec3d>> holes = {});

  /// What an input face gives its pieces.
  struct Owner {
    std::uint32_t face = 0, surface = 0, paint = 0;
  };
  /// A face that lies on another, front to front: the two see only each other there. The covered part becomes a patch
  /// of `base`, whose own add_face() should have this polygon among its holes. Throws as add_face, and when backs
  /// radiate too.
  void add_cover(const std::vector<Vec3d>& polygon, const Owner& cover, const Owner& base);

  /// Throws std::invalid_argument when two faces of the same orientation coincide and are not to be dropped. Call it
  /// once, last.
  [[nodiscard]] MadePatchMesh finish();

 private:
  using Ring = std::vector<std::uint32_t>;  // vertex numbers
  struct RingHash {
    std::size_t operator()(const Ring& ring) const;
  };
  struct PositionHash {
    std::size_t operator()(const Vec3d& p) const;
  };
  struct Piece {
    std::uint32_t row_key;  // twice the surface, plus 1 for its back
    std::uint32_t face;
    std::uint32_t paint;
    Ring ring;
    std::uint32_t contact = PatchMesh::no_surface;  // the pair of covering and covered piece that it belongs to
  };
  struct Face {
    std::uint32_t face, surface;
    Ring outline;  // starts at its smallest vertex number; empty for obstructions
    std::size_t first_piece, end_piece;
  };

  Ring weld(std::span<const Vec3d> polygon);
  std::vector<std::vector<Vec3d>> split(std::span<const Vec3d> polygon, std::span<const std::vector<Vec3d>> holes);
  void find_duplicates();
  void add_backs();
  void number_surfaces();
  void join_contacts();
  void average_paints(const std::vector<std::uint32_t>& paint_of_patch);

  PatchMeshOptions options_;
  std::function<std::string(std::uint32_t)> place_of_;
  std::unordered_map<Vec3d, std::uint32_t, PositionHash> vertex_of_;
  std::unordered_map<Ring, std::uint32_t, RingHash> face_with_;  // into faces_, by outline
  std::vector<PatchSurface> surfaces_;
  std::vector<PatchPaint> paints_;
  std::vector<Piece> pieces_;
  std::vector<Face> faces_;
  std::uint32_t contact_count_ = 0;
  std::size_t triangulated_ = 0;
  std::size_t dropped_ = 0;
  std::size_t duplicates_ = 0;
  std::uint32_t first_triangulated_ = 0;
  std::uint32_t first_dropped_ = 0;
  std::uint32_t first_duplicate_ = 0;
  PatchMesh mesh_;
};

}  // namespace penumbra
