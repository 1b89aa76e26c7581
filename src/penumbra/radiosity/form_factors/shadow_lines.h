#pragma once

#include <span>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/math/vec.h"
#include "penumbra/radiosity/form_factors/silhouette.h"

namespace penumbra {

/// Where the view of one polygon, the source, from the points of another, the receiver, changes its law: lines on the
/// receiver across which what is seen has a kink.
///
/// They are the traces of planes through a corner of the source and an edge of the occluders' silhouette, or an edge
/// of the source and a corner of the silhouette (the EV events of an aspect graph, Gigus & Malik 1990; D1 and D2 lines
/// of Heckbert 1992), planes through a corner of the silhouette and one of its edges where gaps open and close, and
/// occluders' own planes. Edges close above the receiver add lines beside themselves, between which the view changes
/// by about as much.
///
/// One object a thread.
class ShadowLines {
 public:
  /// The line that cuts a piece most evenly: the share of the piece on its smaller side, and how many lines there are,
  /// counted up to two.
  struct Cut {
    const Plane3* line = nullptr;  ///< its trace on the receiver is the line; valid until the next find()
    double balance = 0;
    int lines = 0;
  };

  void clear();
  /// @param receiver, source convex, each in front of the other's plane.
  void find(std::span<const Vec3d> receiver, const Plane3& receiver_plane, std::span<const Vec3d> source,
            const Silhouette& silhouette);

  /// False: the silhouette has so many edges that some kinks may not be among the lines.
  [[nodiscard]] bool all_known() const { return all_known_; }
  /// The most even cut of a convex piece of the receiver by a line that matters in it.
  [[nodiscard]] Cut best_cut(std::span<const Vec3d> piece) const;

 private:
  struct Line {
    Plane3 plane;
    Vec3d pole;      // the corner, of source or occluder
    Vec3d from, to;  // the edge
    enum class Kind {
      shadow,
      edge_on,  // an occluder's own plane
      layer,    // no kink, but a quick change nearby
    } kind = Kind::shadow;
  };
  void find_meeting_lines();
  void find_rims();
  void find_layers(const Vec3d& from, const Vec3d& to);
  [[nodiscard]] bool matters(const Line& line, std::span<const Vec3d> piece) const;

  // What find() looks at.
  std::span<const Vec3d> receiver_, source_;
  Plane3 receiver_plane_;
  const Silhouette* silhouette_ = nullptr;

  std::vector<Line> lines_;
  std::vector<bool> turning_;  // per plane of the silhouette: an edge asks for it
  bool all_known_ = false;
};

}  // namespace penumbra
