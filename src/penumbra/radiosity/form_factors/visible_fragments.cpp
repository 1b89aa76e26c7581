#include "penumbra/radiosity/form_factors/visible_fragments.h"

#include <algorithm>
#include <cassert>

// Compiled once for each instruction set; the best one that the processor has is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "penumbra/radiosity/form_factors/visible_fragments.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace penumbra::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
// At most a group wide, so that a group is a whole number of vectors.
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

HWY_INLINE V set(double v) { return hn::Set(D(), v); }

/// The angle of the vector (den, num) for num >= 0, in [0, pi]: Cephes' rational approximation of the arc tangent
/// (Moshier 1984), error below 2e-16 of the result.
HWY_INLINE V angle_of(V num, V den) {
  const V ad = hn::Abs(den);
  const M steep = hn::Gt(num, ad);
  const V low = hn::Min(num, ad);
  const V high = hn::Max(hn::Max(num, ad), set(1e-300));
  const M far = hn::Gt(low, hn::Mul(high, set(0.41421356237309503)));
  const V x = hn::Div(hn::IfThenElse(far, hn::Sub(low, high), low), hn::IfThenElse(far, hn::Add(low, high), high));
  const V z = hn::Mul(x, x);
  V p = set(-8.750608600031904122785E-1);
  p = hn::MulAdd(p, z, set(-1.615753718733365076637E1));
  p = hn::MulAdd(p, z, set(-7.500855792314704667340E1));
  p = hn::MulAdd(p, z, set(-1.228866684490136173410E2));
  p = hn::MulAdd(p, z, set(-6.485021904942025371773E1));
  V q = hn::Add(z, set(2.485846490142306297962E1));
  q = hn::MulAdd(q, z, set(1.650270098316988542046E2));
  q = hn::MulAdd(q, z, set(4.328810604912902668951E2));
  q = hn::MulAdd(q, z, set(4.853903996359136964868E2));
  q = hn::MulAdd(q, z, set(1.945506571482613964425E2));
  V r = hn::MulAdd(hn::Mul(x, z), hn::Div(p, q), x);
  r = hn::Add(r, hn::IfThenElseZero(far, set(0.78539816339744830962)));
  r = hn::IfThenElse(steep, hn::Sub(set(1.57079632679489661923), r), r);
  return hn::IfThenElse(hn::Lt(den, hn::Zero(D())), hn::Sub(set(3.14159265358979323846), r), r);
}

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 load3(const double* p) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  return {hn::LoadU(d, p), hn::LoadU(d, p + n), hn::LoadU(d, p + 2 * n)};
}
HWY_INLINE void store3(const V3& v, double* p) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  hn::StoreU(v.x, d, p);
  hn::StoreU(v.y, d, p + n);
  hn::StoreU(v.z, d, p + 2 * n);
}
HWY_INLINE V dot3(const V3& a, const V3& b) { return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z))); }
HWY_INLINE V3 cross3(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE V3 minus3(const V3& a, const V3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }

/// An edge as a point sees it: what an arc of it adds to Lambert's sum.
struct Arc {
  V weight;  ///< cosine between the element's normal and that of the plane through point and edge
  V height;  ///< |p x q|
  V height2;
  V start;  ///< p . (q - p)
  V length2;
};

HWY_INLINE Arc make_arc(const V3& p, const V3& q, const V3& side, const V3& normal) {
  const V3 along = minus3(q, p);
  Arc a;
  a.height2 = hn::Max(dot3(side, side), set(1e-300));
  a.height = hn::Sqrt(a.height2);
  a.weight = hn::Div(dot3(side, normal), a.height);
  a.start = dot3(p, along);
  a.length2 = dot3(along, along);
  return a;
}

/// The angle that the stretch [t0, t1] of the edge spans, 0 where t1 <= t0.
HWY_INLINE V stretch_angle(const Arc& a, V t0, V t1) {
  const V s0 = hn::MulAdd(t0, a.length2, a.start);
  const V s1 = hn::MulAdd(t1, a.length2, a.start);
  const V num = hn::Mul(a.height, hn::Mul(a.length2, hn::Sub(t1, t0)));
  const V angle = angle_of(num, hn::MulAdd(s0, s1, a.height2));
  return hn::IfThenElseZero(hn::Gt(t1, t0), angle);
}

/// Cuts [lo, hi] to where the linear function from f0 (at 0) to f1 (at 1) is not negative.
HWY_INLINE void cut_interval(V f0, V f1, V& lo, V& hi) {
  const V zero = hn::Zero(D());
  const M neg0 = hn::Lt(f0, zero), neg1 = hn::Lt(f1, zero);
  const M crossing = hn::Xor(neg0, neg1);
  hi = hn::IfThenElse(hn::And(neg0, neg1), set(-1), hi);
  if (hn::AllFalse(D(), crossing)) return;
  const V t = hn::Div(f0, hn::Sub(f0, f1));
  lo = hn::IfThenElse(hn::And(crossing, neg0), hn::Max(lo, t), lo);
  hi = hn::IfThenElse(hn::And(crossing, neg1), hn::Min(hi, t), hi);
}

/// Where the silhouette crosses a stretch, and by how much the number of covering polygons changes there; sorted lane
/// by lane.
struct Crossings {
  double* places;
  double* changes;
  std::size_t count = 0;

  HWY_INLINE void insert(V place, V change) {
    const D d;
    const std::size_t n = hn::Lanes(d);
    for (std::size_t k = 0; k < count; ++k) {
      const V p = hn::LoadU(d, places + k * n), c = hn::LoadU(d, changes + k * n);
      const M before = hn::Lt(place, p);
      if (hn::AllFalse(d, before)) continue;
      hn::StoreU(hn::IfThenElse(before, place, p), d, places + k * n);
      hn::StoreU(hn::IfThenElse(before, change, c), d, changes + k * n);
      place = hn::IfThenElse(before, p, place);
      change = hn::IfThenElse(before, c, change);
    }
    hn::StoreU(place, d, places + count * n);
    hn::StoreU(change, d, changes + count * n);
    ++count;
  }

  /// The angle of [lo, hi] less what is covered, when `covering` polygons cover its start at 0.
  HWY_INLINE V open_angle(const Arc& arc, V covering, V lo, V hi) const {
    const D d;
    const std::size_t n = hn::Lanes(d);
    const V half = set(0.5);
    V sum = hn::Zero(d);
    for (std::size_t k = 0; k < count; ++k) {
      const V place = hn::LoadU(d, places + k * n);
      const V end = hn::Min(place, hi);
      const M open = hn::And(hn::Lt(covering, half), hn::Gt(end, lo));
      if (!hn::AllFalse(d, open)) sum = hn::Add(sum, hn::IfThenElseZero(open, stretch_angle(arc, lo, end)));
      lo = hn::Max(lo, place);
      covering = hn::Add(covering, hn::LoadU(d, changes + k * n));
    }
    const M open = hn::And(hn::Lt(covering, half), hn::Gt(hi, lo));
    if (!hn::AllFalse(d, open)) sum = hn::Add(sum, hn::IfThenElseZero(open, stretch_angle(arc, lo, hi)));
    return sum;
  }
};

/// Scratch doubles for one vector of points, at most.
std::size_t scratch_size(std::size_t source_corners, std::size_t vertices, std::size_t edges, std::size_t planes) {
  const std::size_t lanes = 8;
  return lanes * (6 * source_corners + 3 * vertices + source_corners * (vertices + edges) + 8 * edges + planes);
}

/// One vector of points and what it sees.
class View {
 public:
  View(const VisibleFragments::Input& in, V3 point, const Vec3d& normal, double* scratch, std::uint32_t* before)
      : in_(in),
        ns_(in.source.size()),
        nv_(in.vertices.size()),
        ne_(in.edges.size()),
        point_(point),
        before_source_(before) {
    up_ = {set(normal.x), set(normal.y), set(normal.z)};
    const auto take = [&](std::size_t vectors) {
      double* const taken = scratch;
      scratch += vectors * n_;
      return taken;
    };
    source_ = take(3 * ns_);
    source_sides_ = take(3 * ns_);
    vertices_ = take(3 * nv_);
    vertex_sides_ = take(ns_ * nv_);
    sides_ = take(3 * ne_);
    steps_ = take(ne_);
    source_in_ = take(ns_ * ne_);
    starts_ = take(ne_);
    ends_ = take(ne_);
    signs_ = take(in.planes.size());
    crossings_.places = take(ne_);
    crossings_.changes = take(ne_);
  }

  /// @param open receives the factor without occluders.
  HWY_INLINE V factor(V& open) {
    look();
    const V covering = in_.reference ? covering_since_reference() : covering_first_corner();
    open = hn::Zero(D());
    V sum = source_edges(covering, open);
    for (std::size_t n = 0; n < before_count_; ++n) sum = hn::Sub(sum, silhouette_edge(before_source_[n], covering));
    const V scale = set(0.15915494309189533577);
    open = hn::Max(hn::Zero(D()), hn::Mul(open, scale));
    // No more than without occluders: of slivers at the horizon winding numbers may lose count.
    return hn::Max(hn::Zero(D()), hn::Min(hn::Mul(sum, scale), open));
  }

 private:
  HWY_INLINE V load(const double* table, std::size_t k) const { return hn::LoadU(D(), table + n_ * k); }
  HWY_INLINE V3 vector(const double* table, std::size_t k) const { return load3(table + 3 * n_ * k); }
  HWY_INLINE V3 from_point(const Vec3d& p) const { return minus3({set(p.x), set(p.y), set(p.z)}, point_); }

  void look() {
    const D d;
    for (std::size_t a = 0; a < ns_; ++a) store3(from_point(in_.source[a]), source_ + 3 * n_ * a);
    for (std::size_t a = 0; a < ns_; ++a)
      store3(cross3(vector(source_, a + 1 == ns_ ? 0 : a + 1), vector(source_, a)), source_sides_ + 3 * n_ * a);
    for (std::size_t v = 0; v < nv_; ++v) {
      const V3 p = from_point(in_.vertices[v]);
      store3(p, vertices_ + 3 * n_ * v);
      for (std::size_t a = 0; a < ns_; ++a)
        hn::StoreU(dot3(vector(source_sides_, a), p), d, vertex_sides_ + n_ * (a * nv_ + v));
    }
    for (std::size_t k = 0; k < in_.planes.size(); ++k) {
      const Plane3& plane = in_.planes[k];
      const V height =
          hn::Sub(dot3({set(plane.normal.x), set(plane.normal.y), set(plane.normal.z)}, point_), set(plane.offset));
      hn::StoreU(hn::IfThenElse(hn::Lt(height, hn::Zero(d)), set(-1), set(1)), d, signs_ + n_ * k);
    }
    for (std::size_t e = 0; e < ne_; ++e) {
      const Silhouette::Edge& edge = in_.edges[e];
      const V3 side = cross3(vector(vertices_, edge.to), vector(vertices_, edge.from));
      store3(side, sides_ + 3 * n_ * e);
      V step = set(edge.step);
      for (std::uint32_t t = edge.first; t < edge.last; ++t)
        step = hn::MulAdd(set(in_.turning[t].direction), load(signs_, in_.turning[t].plane), step);
      hn::StoreU(step, d, steps_ + n_ * e);
      for (std::size_t a = 0; a < ns_; ++a)
        hn::StoreU(dot3(side, vector(source_, a)), d, source_in_ + n_ * (a * ne_ + e));
      V lo = hn::Zero(d), hi = hn::IfThenElse(hn::Eq(step, hn::Zero(d)), set(-1), set(1));
      for (std::size_t a = 0; a < ns_; ++a)
        cut_interval(load(vertex_sides_, a * nv_ + edge.from), load(vertex_sides_, a * nv_ + edge.to), lo, hi);
      if (hn::AllFalse(d, hn::Gt(hi, lo))) continue;
      hn::StoreU(lo, d, starts_ + n_ * e);
      hn::StoreU(hi, d, ends_ + n_ * e);
      before_source_[before_count_++] = static_cast<std::uint32_t>(e);
    }
  }

  /// How many polygons cover the source's first corner: the winding number of the steps about it, from their crossings
  /// with the half-plane from the normal through the corner (Sunday 2001).
  HWY_INLINE V covering_first_corner() const {
    const V zero = hn::Zero(D());
    V3 across = cross3(vector(source_, in_.first_corner), up_);
    across.x = hn::Add(across.x, set(1e-290));  // right above any half-plane does
    V covering = zero;
    for (std::size_t e = 0; e < ne_; ++e) {
      const M from = hn::Gt(dot3(across, vector(vertices_, in_.edges[e].from)), zero);
      const M to = hn::Gt(dot3(across, vector(vertices_, in_.edges[e].to)), zero);
      const M left = hn::Gt(load(source_in_, in_.first_corner * ne_ + e), zero);
      const V step = load(steps_, e);
      const M upwards = hn::And(hn::AndNot(from, to), left), downwards = hn::AndNot(hn::Or(to, left), from);
      covering = hn::Add(covering, hn::IfThenElseZero(upwards, step));
      covering = hn::Sub(covering, hn::IfThenElseZero(downwards, step));
    }
    return covering;
  }

  /// The same when only some edges are known, from the covering of the reference line: what changes while the line's
  /// start moves to the point, and then its end to the corner.
  HWY_INLINE V covering_since_reference() const {
    const V zero = hn::Zero(D());
    const V3 end = from_point(in_.reference->to);
    const V3 swept = cross3(from_point(in_.reference->from), end), way = cross3(end, vector(source_, in_.first_corner));
    V covering = set(in_.reference->covering);
    for (std::size_t e = 0; e < ne_; ++e) {
      const Silhouette::Edge& edge = in_.edges[e];
      const V3 p = vector(vertices_, edge.from), q = vector(vertices_, edge.to);
      const V at_end = dot3(vector(sides_, e), end);
      const M left = hn::Gt(at_end, zero), meets = hn::Xor(hn::Gt(dot3(swept, p), zero), hn::Gt(dot3(swept, q), zero));
      const V step = set(edge.reference_step);
      if (edge.left_of)
        covering = hn::Sub(covering, hn::IfThenElseZero(hn::AndNot(left, meets), step));
      else
        covering = hn::Add(covering, hn::IfThenElseZero(hn::And(left, meets), step));
      covering = hn::Add(
          covering, change_across(e, at_end, load(source_in_, in_.first_corner * ne_ + e), dot3(way, p), dot3(way, q)));
    }
    return covering;
  }

  /// How the covering changes along a stretch that crosses edge e: f0 and f1 say whether its ends are left of the edge,
  /// g0 and g1 on which side of it the edge's ends are.
  HWY_INLINE V change_across(std::size_t e, V f0, V f1, V g0, V g1) const {
    const V zero = hn::Zero(D());
    const M in0 = hn::Gt(f0, zero), in1 = hn::Gt(f1, zero);
    const M crosses = hn::And(hn::Xor(in0, in1), hn::Xor(hn::Gt(g0, zero), hn::Gt(g1, zero)));
    const V step = load(steps_, e);
    return hn::IfThenElseZero(crosses, hn::IfThenElse(in1, step, hn::Neg(step)));
  }

  HWY_INLINE void add_crossing(V change, V f0, V f1) {
    const M crosses = hn::Ne(change, hn::Zero(D()));
    if (hn::AllFalse(D(), crosses)) return;
    crossings_.insert(hn::IfThenElse(crosses, hn::Div(f0, hn::Sub(f0, f1)), set(2)), change);
  }

  /// @param open receives the sum when nothing covers anything.
  HWY_INLINE V source_edges(V covering, V& open) {
    V sum = hn::Zero(D());
    std::size_t a = in_.first_corner;
    for (std::size_t turn = 0; turn < ns_; ++turn) {
      const std::size_t b = a + 1 == ns_ ? 0 : a + 1;
      crossings_.count = 0;
      V change = hn::Zero(D());
      for (std::size_t n = 0; n < before_count_; ++n) {
        const std::size_t e = before_source_[n];
        const V f0 = load(source_in_, a * ne_ + e), f1 = load(source_in_, b * ne_ + e);
        const V entered = change_across(e, f0, f1, load(vertex_sides_, a * nv_ + in_.edges[e].from),
                                        load(vertex_sides_, a * nv_ + in_.edges[e].to));
        add_crossing(entered, f0, f1);
        change = hn::Add(change, entered);
      }
      const Arc arc = make_arc(vector(source_, a), vector(source_, b), vector(source_sides_, a), up_);
      const V whole = stretch_angle(arc, hn::Zero(D()), set(1));
      open = hn::MulAdd(arc.weight, whole, open);
      const V angle = crossings_.count == 0 ? hn::IfThenElseZero(hn::Lt(covering, set(0.5)), whole)
                                            : crossings_.open_angle(arc, covering, hn::Zero(D()), set(1));
      sum = hn::MulAdd(arc.weight, angle, sum);
      covering = hn::Add(covering, change);
      a = b;
    }
    return sum;
  }

  /// What the part of edge e that is a rim of the visible part takes from Lambert's sum, when `covering` polygons cover
  /// the source's first corner. From there a straight way within the source leads to the middle of the part before it.
  HWY_INLINE V silhouette_edge(std::size_t e, V covering) {
    const V zero = hn::Zero(D());
    const V step = load(steps_, e);
    const V3 p = vector(vertices_, in_.edges[e].from), q = vector(vertices_, in_.edges[e].to), side = vector(sides_, e);
    const V lo = load(starts_, e), hi = load(ends_, e);
    const V between = hn::Mul(set(0.5), hn::Add(lo, hi));
    const V3 along = minus3(q, p);
    const V3 middle{hn::MulAdd(between, along.x, p.x), hn::MulAdd(between, along.y, p.y),
                    hn::MulAdd(between, along.z, p.z)};
    const V3 way = cross3(vector(source_, in_.first_corner), middle);
    // To the right of the edge.
    covering = hn::Sub(covering, hn::IfThenElseZero(hn::Gt(load(source_in_, in_.first_corner * ne_ + e), zero), step));
    crossings_.count = 0;
    for (std::size_t n = 0; n < before_count_; ++n) {
      const std::size_t k = before_source_[n];
      if (k == e) continue;
      const std::uint32_t from = in_.edges[k].from, to = in_.edges[k].to;
      const V3 other = vector(sides_, k), v0 = vector(vertices_, from), v1 = vector(vertices_, to);
      const V f0 = dot3(other, p), f1 = dot3(other, q);
      const V at_middle = hn::MulAdd(between, hn::Sub(f1, f0), f0);
      const V at_corner = load(source_in_, in_.first_corner * ne_ + k);
      covering = hn::Add(covering, change_across(k, at_corner, at_middle, dot3(way, v0), dot3(way, v1)));
      if (from == in_.edges[e].from || from == in_.edges[e].to || to == in_.edges[e].from || to == in_.edges[e].to)
        continue;  // they only meet in that vertex
      const V entered = change_across(k, f0, f1, dot3(side, v0), dot3(side, v1));
      add_crossing(entered, f0, f1);
      // Back from the middle to the start.
      const M first_half = hn::Xor(hn::Gt(f0, zero), hn::Gt(at_middle, zero));
      covering = hn::Sub(covering, hn::IfThenElseZero(first_half, entered));
    }
    // The side that the edge's own polygons leave open.
    const M left_open = hn::Lt(step, zero);
    covering = hn::Add(covering, hn::IfThenElseZero(left_open, step));
    const Arc arc = make_arc(p, q, side, up_);
    const V angle = crossings_.open_angle(arc, covering, lo, hi);
    return hn::Mul(hn::IfThenElse(left_open, hn::Neg(arc.weight), arc.weight), angle);
  }

  const VisibleFragments::Input& in_;
  std::size_t n_ = hn::Lanes(D());
  std::size_t ns_, nv_, ne_;
  V3 point_, up_;
  double *source_, *source_sides_;    // corners from the point, and inward normals of the planes through its edges
  double *vertices_, *vertex_sides_;  // vertices from the point, and [source edge][vertex]: inside it
  double *sides_, *steps_;            // per edge: normal of the plane through it, to its left, and its step
  double* source_in_;                 // [source corner][edge]: left of it
  double *starts_, *ends_;            // per edge: the part of it before the source
  std::uint32_t* before_source_;      // the edges of which a part is before the source, for some point
  std::size_t before_count_ = 0;
  double* signs_;  // per turning plane
  Crossings crossings_{};
};

void evaluate_points(const VisibleFragments::Input& in, const double* x, const double* y, const double* z,
                     std::size_t count, const Vec3d& normal, double* scratch, std::uint32_t* before, double* factors,
                     double* open_factors) {
  const D d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    View view(in, {hn::LoadU(d, x + i), hn::LoadU(d, y + i), hn::LoadU(d, z + i)}, normal, scratch, before);
    V open;
    hn::StoreU(view.factor(open), d, factors + i);
    hn::StoreU(open, d, open_factors + i);
  }
}

}  // namespace penumbra::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra {

HWY_EXPORT(evaluate_points);
HWY_EXPORT(scratch_size);

void VisibleFragments::evaluate(const Silhouette& silhouette, const double* x, const double* y, const double* z,
                                std::size_t count, const Vec3d& normal, double* factors, double* open_factors) {
  assert(count % group == 0);
  assert(source_.size() >= 3);
  const std::size_t size = HWY_DYNAMIC_DISPATCH(scratch_size)(source_.size(), silhouette.vertices().size(),
                                                              silhouette.edges().size(), silhouette.planes().size());
  if (scratch_.size() < size) scratch_.resize(size);
  if (before_.size() < silhouette.edges().size()) before_.resize(silhouette.edges().size());
  // The walk around the source starts at the corner that is farthest from the horizon, where winding numbers end.
  std::size_t highest = 0;
  for (std::size_t a = 1; a < source_.size(); ++a)
    if (dot(normal, source_[a]) > dot(normal, source_[highest])) highest = a;
  HWY_DYNAMIC_DISPATCH(evaluate_points)
  ({source_, highest, silhouette.vertices(), silhouette.edges(), silhouette.turning(), silhouette.planes(),
    silhouette.reference()},
   x, y, z, count, normal, scratch_.data(), before_.data(), factors, open_factors);
}

}  // namespace penumbra
#endif
