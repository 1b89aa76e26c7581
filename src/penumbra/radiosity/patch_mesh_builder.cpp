#include "penumbra/radiosity/patch_mesh_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "penumbra/math/polygon.h"
#include "penumbra/math/polygon_pieces.h"
#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

/// Share of the squared size below which an area is rounding.
constexpr double no_area = 1e-13;

bool has_area(std::span<const Vec3d> polygon) {
  const double size = polygon_size(polygon);
  return polygon.size() >= 3 && polygon_area(polygon) > no_area * size * size;
}

void drop_repeated_corners(std::vector<Vec3d>& polygon) {
  polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
  while (polygon.size() > 1 && polygon.back() == polygon.front()) polygon.pop_back();
}

std::vector<Vec3d> corners_of(std::span<const Vec3d> polygon, std::span<const std::uint32_t> ring) {
  std::vector<Vec3d> corners;
  for (const std::uint32_t v : ring) corners.push_back(polygon[v]);
  return corners;
}

void start_at_smallest(std::vector<std::uint32_t>& ring) {
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
}

std::vector<std::uint32_t> reversed(std::vector<std::uint32_t> ring) {
  std::reverse(ring.begin(), ring.end());
  start_at_smallest(ring);
  return ring;
}

}  // namespace

std::size_t PatchMeshBuilder::RingHash::operator()(const Ring& ring) const {
  std::uint64_t h = ring.size();
  for (const std::uint32_t v : ring) h = hash_key(h, v);
  return h;
}

std::size_t PatchMeshBuilder::PositionHash::operator()(const Vec3d& p) const {
  // + 0.0 makes one of the two zeros, which compare equal.
  return hash_key(std::bit_cast<std::uint64_t>(p.x + 0.0), std::bit_cast<std::uint64_t>(p.y + 0.0),
                  std::bit_cast<std::uint64_t>(p.z + 0.0));
}

PatchMeshBuilder::PatchMeshBuilder(std::size_t bands, const PatchMeshOptions& options,
                                   std::function<std::string(std::uint32_t)> place_of)
    : options_(options), place_of_(std::move(place_of)) {
  mesh_.bands = bands;
}

std::uint32_t PatchMeshBuilder::add_surface(PatchSurface surface) {
  surfaces_.push_back(std::move(surface));
  return static_cast<std::uint32_t>(surfaces_.size() - 1);
}

std::uint32_t PatchMeshBuilder::add_paint(PatchPaint paint) {
  paints_.push_back(std::move(paint));
  return static_cast<std::uint32_t>(paints_.size() - 1);
}

PatchMeshBuilder::Ring PatchMeshBuilder::weld(std::span<const Vec3d> polygon) {
  Ring ring;
  for (const Vec3d& p : polygon) {
    const auto [at, is_new] = vertex_of_.try_emplace(p, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(p);
    ring.push_back(at->second);
  }
  return ring;
}

/// Planar convex pieces with area.
std::vector<std::vector<Vec3d>> PatchMeshBuilder::split(std::span<const Vec3d> polygon,
                                                        std::span<const std::vector<Vec3d>> holes) {
  std::vector<std::vector<Vec3d>> pieces;
  if (planarity_error(polygon) > options_.planarity_tolerance * polygon_size(polygon)) {
    for (const auto& triangle : triangulate_polygon(polygon)) pieces.push_back(corners_of(polygon, triangle));
  } else {
    for (const auto& ring : convex_pieces(polygon)) pieces.push_back(corners_of(polygon, ring));
  }
  for (const std::vector<Vec3d>& hole : holes) {
    std::vector<std::vector<Vec3d>> rest;
    for (const std::vector<Vec3d>& piece : pieces) {
      for (std::vector<Vec3d>& part : subtract_convex(piece, hole)) rest.push_back(std::move(part));
    }
    pieces.swap(rest);
  }
  std::erase_if(pieces, [](const std::vector<Vec3d>& piece) { return !has_area(piece); });
  return pieces;
}

void PatchMeshBuilder::add_face(std::vector<Vec3d> polygon, std::uint32_t face, std::uint32_t surface,
                                std::uint32_t paint, std::span<const std::vector<Vec3d>> holes) {
  drop_repeated_corners(polygon);
  if (!has_area(polygon)) {
    // A figure of eight has no vector area either, and is the graver fault.
    if (polygon.size() > 3 && is_self_intersecting(polygon)) {
      throw std::invalid_argument(place_of_(face) + " crosses itself: split it into simple polygons.");
    }
    if (options_.degenerate == DegenerateFaces::refuse) {
      throw std::invalid_argument(place_of_(face) + " has no area: remove it from the model.");
    }
    if (dropped_++ == 0) first_dropped_ = face;
    return;
  }
  if (is_self_intersecting(polygon)) {
    throw std::invalid_argument(place_of_(face) + " crosses itself: split it into simple polygons.");
  }
  if (planarity_error(polygon) > options_.planarity_tolerance * polygon_size(polygon) && triangulated_++ == 0) {
    first_triangulated_ = face;
  }
  const bool radiates = surface != PatchMesh::no_surface;
  Face record{face, surface, {}, pieces_.size(), 0};
  if (radiates) {
    record.outline = weld(polygon);
    start_at_smallest(record.outline);
  }
  for (const std::vector<Vec3d>& piece : split(polygon, holes)) {
    pieces_.push_back({radiates ? 2 * surface : PatchMesh::no_surface, face, paint, weld(piece)});
  }
  record.end_piece = pieces_.size();
  faces_.push_back(std::move(record));
}

void PatchMeshBuilder::add_cover(const std::vector<Vec3d>& polygon, const Owner& cover, const Owner& base) {
  if (options_.sides == PatchSides::both) {
    throw std::invalid_argument(place_of_(cover.face) +
                                " covers another face, so its back has no place: let only fronts radiate.");
  }
  const std::size_t first = pieces_.size();
  add_face(polygon, cover.face, cover.surface, cover.paint);
  const std::size_t last = pieces_.size();
  for (std::size_t k = first; k < last; ++k) {
    pieces_[k].contact = contact_count_++;
    Piece covered = pieces_[k];
    std::reverse(covered.ring.begin(), covered.ring.end());
    covered.row_key = 2 * base.surface;
    covered.face = base.face;
    covered.paint = base.paint;
    pieces_.push_back(std::move(covered));
  }
}

/// Refuses faces that lie on an earlier one, or takes their pieces away.
void PatchMeshBuilder::find_duplicates() {
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    if (faces_[f].outline.empty()) continue;
    const auto [at, is_new] = face_with_.try_emplace(faces_[f].outline, f);
    if (is_new) continue;
    if (options_.duplicates == DuplicateFaces::drop) {
      if (duplicates_++ == 0) first_duplicate_ = faces_[f].face;
      for (std::size_t k = faces_[f].first_piece; k < faces_[f].end_piece; ++k) pieces_[k].ring.clear();
      faces_[f].outline.clear();
      continue;
    }
    throw std::invalid_argument(
        fmt::format("{} lies exactly on another one with the same orientation, {}: remove one, or reverse it for a "
                    "two-sided plate.",
                    place_of_(faces_[f].face), place_of_(faces_[at->second].face)));
  }
}

/// Reversed copies of the pieces of each face that has no reversed twin.
void PatchMeshBuilder::add_backs() {
  for (const Face& face : faces_) {
    if (face.outline.empty() || face_with_.contains(reversed(face.outline))) continue;
    for (std::size_t k = face.first_piece; k < face.end_piece; ++k) {
      Piece back = pieces_[k];
      back.row_key += 1;
      std::reverse(back.ring.begin(), back.ring.end());
      pieces_.push_back(std::move(back));
    }
  }
}

/// Sorts the pieces by row and gives the rows in use their final numbers, with the back of each after its front.
void PatchMeshBuilder::number_surfaces() {
  std::stable_sort(pieces_.begin(), pieces_.end(),
                   [](const Piece& a, const Piece& b) { return a.row_key < b.row_key; });
  std::uint32_t last_key = PatchMesh::no_surface;
  for (Piece& piece : pieces_) {
    if (piece.row_key == PatchMesh::no_surface) continue;
    if (piece.row_key != last_key) {
      last_key = piece.row_key;
      PatchSurface surface = surfaces_[last_key / 2];
      surface.back = last_key % 2 == 1;
      if (surface.back) surface.name += " (back)";
      mesh_.surfaces.push_back(std::move(surface));
    }
    piece.row_key = static_cast<std::uint32_t>(mesh_.surfaces.size() - 1);
  }
}

/// The patches, numbered as the pieces, that carry the same contact.
void PatchMeshBuilder::join_contacts() {
  constexpr std::uint32_t none = PatchMesh::no_surface;
  std::vector<std::uint32_t> first(contact_count_, none);
  for (std::uint32_t p = 0; p < pieces_.size(); ++p) {
    const std::uint32_t contact = pieces_[p].contact;
    if (contact == none) continue;
    if (first[contact] == none) {
      first[contact] = p;
    } else {
      mesh_.contacts.emplace_back(first[contact], p);
    }
  }
}

/// A row of several paints gets their mean by area.
void PatchMeshBuilder::average_paints(const std::vector<std::uint32_t>& paint_of_patch) {
  const std::size_t bands = mesh_.bands;
  mesh_.reflectance.assign(mesh_.surfaces.size() * bands, 0);
  mesh_.emission.assign(mesh_.surfaces.size() * bands, 0);
  for (std::size_t p = 0; p < mesh_.radiating_count; ++p) {
    const std::uint32_t s = mesh_.surface_of[p];
    const PatchPaint& paint = paints_[paint_of_patch[p]];
    const std::vector<double>& emission = mesh_.surfaces[s].back ? paint.back_emission : paint.emission;
    const double share = mesh_.areas[p] / mesh_.surfaces[s].area;
    for (std::size_t b = 0; b < bands; ++b) {
      mesh_.reflectance[s * bands + b] += share * paint.reflectance[b];
      mesh_.emission[s * bands + b] += share * emission[b];
    }
  }
}

MadePatchMesh PatchMeshBuilder::finish() {
  find_duplicates();
  if (options_.sides == PatchSides::both) add_backs();
  std::erase_if(pieces_, [](const Piece& piece) { return piece.ring.empty(); });
  number_surfaces();
  std::vector<std::uint32_t> paint_of_patch;
  for (const Piece& piece : pieces_) {
    add_patch(mesh_, piece.ring, piece.row_key, piece.face);
    paint_of_patch.push_back(piece.paint);
  }
  average_paints(paint_of_patch);
  join_contacts();

  MadePatchMesh made{std::move(mesh_), {}};
  if (triangulated_ > 0) {
    made.warnings.push_back(fmt::format("{} {} not planar and became triangles (the first: {}).", triangulated_,
                                        triangulated_ == 1 ? "polygon is" : "polygons are",
                                        place_of_(first_triangulated_)));
  }
  if (duplicates_ > 0) {
    made.warnings.push_back(
        fmt::format("{} exactly on another with the same orientation and {} left out (the first: {}).",
                    duplicates_ == 1 ? "1 face lies" : fmt::format("{} faces lie", duplicates_),
                    duplicates_ == 1 ? "was" : "were", place_of_(first_duplicate_)));
  }
  if (dropped_ > 0) {
    made.warnings.push_back(fmt::format("{} without area {} left out (the first: {}).",
                                        dropped_ == 1 ? "1 face" : fmt::format("{} faces", dropped_),
                                        dropped_ == 1 ? "was" : "were", place_of_(first_dropped_)));
  }
  return made;
}

}  // namespace penumbra
