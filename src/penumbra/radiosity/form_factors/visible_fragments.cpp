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

/// Intervals of an edge that occluders cover, kept sorted by their start, lane by lane.
struct CoveredStretches {
  double* starts;
  double* ends;
  std::size_t count = 0;

  HWY_INLINE void insert(V lo, V hi) {
    const D d;
    const std::size_t n = hn::Lanes(d);
    for (std::size_t k = 0; k < count; ++k) {
      const V s = hn::LoadU(d, starts + k * n), e = hn::LoadU(d, ends + k * n);
      const M before = hn::Lt(lo, s);
      hn::StoreU(hn::IfThenElse(before, lo, s), d, starts + k * n);
      hn::StoreU(hn::IfThenElse(before, hi, e), d, ends + k * n);
      lo = hn::IfThenElse(before, s, lo);
      hi = hn::IfThenElse(before, e, hi);
    }
    hn::StoreU(lo, d, starts + count * n);
    hn::StoreU(hi, d, ends + count * n);
    ++count;
  }

  /// The angle of what is left of [lo, hi].
  HWY_INLINE V open_angle(const Arc& arc, V lo, V hi) const {
    const D d;
    const std::size_t n = hn::Lanes(d);
    V sum = hn::Zero(d);
    for (std::size_t k = 0; k < count; ++k) {
      const V end = hn::Min(hn::LoadU(d, starts + k * n), hi);
      if (!hn::AllFalse(d, hn::Gt(end, lo))) sum = hn::Add(sum, stretch_angle(arc, lo, end));
      lo = hn::Max(lo, hn::LoadU(d, ends + k * n));
    }
    if (!hn::AllFalse(d, hn::Gt(hi, lo))) sum = hn::Add(sum, stretch_angle(arc, lo, hi));
    return sum;
  }
};

/// Scratch doubles for one vector of points.
std::size_t scratch_size(std::size_t source_corners, std::size_t occluder_corners, std::size_t occluders) {
  const std::size_t lanes = 8;
  const std::size_t vectors = 6 * source_corners + 6 * occluder_corners + 2 * source_corners * occluders +
                              2 * occluders + source_corners * occluder_corners;
  return vectors * lanes;
}

struct Pyramids {
  double* source;        ///< corners relative to the point
  double* source_sides;  ///< inward normals of the planes through point and edge
  double* corners;       ///< likewise for the occluders
  double* corner_sides;
  double* stretch_starts;  ///< [source edge][occluder]
  double* stretch_ends;
  double* starts;
  double* ends;
};

void evaluate_vector(const VisibleFragments::Input& in, const double* px, const double* py, const double* pz,
                     const Vec3d& normal, double* scratch, std::uint32_t* active, double* out) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const std::size_t ns = in.source.size(), no = in.corners.size(), nk = in.planes.size();
  Pyramids w;
  w.source = scratch;
  w.source_sides = w.source + 3 * n * ns;
  w.corners = w.source_sides + 3 * n * ns;
  w.corner_sides = w.corners + 3 * n * no;
  w.stretch_starts = w.corner_sides + 3 * n * no;
  w.stretch_ends = w.stretch_starts + n * ns * nk;
  w.starts = w.stretch_ends + n * ns * nk;
  w.ends = w.starts + n * nk;
  double* const sides_at = w.ends + n * nk;  // [source edge][corner]

  const V3 point{hn::LoadU(d, px), hn::LoadU(d, py), hn::LoadU(d, pz)};
  const V3 up{set(normal.x), set(normal.y), set(normal.z)};
  const V zero = hn::Zero(d), one = set(1);

  for (std::size_t a = 0; a < ns; ++a)
    store3(minus3({set(in.source[a].x), set(in.source[a].y), set(in.source[a].z)}, point), w.source + 3 * n * a);
  for (std::size_t a = 0; a < ns; ++a)
    store3(cross3(load3(w.source + 3 * n * (a + 1 == ns ? 0 : a + 1)), load3(w.source + 3 * n * a)),
           w.source_sides + 3 * n * a);

  // Which occluders stand before the source at all, and where they cover its edges.
  std::size_t active_count = 0;
  for (std::size_t k = 0; k < nk; ++k) {
    const std::size_t first = in.offsets[k], last = in.offsets[k + 1];
    for (std::size_t b = first; b < last; ++b)
      store3(minus3({set(in.corners[b].x), set(in.corners[b].y), set(in.corners[b].z)}, point), w.corners + 3 * n * b);
    bool apart = false;
    for (std::size_t a = 0; a < ns && !apart; ++a) {
      const V3 side = load3(w.source_sides + 3 * n * a);
      M any = hn::Lt(one, zero);
      for (std::size_t b = first; b < last; ++b) {
        const V g = dot3(side, load3(w.corners + 3 * n * b));
        hn::StoreU(g, d, sides_at + n * (a * no + b));
        any = hn::Or(any, hn::Gt(g, zero));
      }
      apart = hn::AllFalse(d, any);
    }
    if (apart) continue;
    const Plane3& plane = in.planes[k];
    const V height =
        hn::Sub(dot3({set(plane.normal.x), set(plane.normal.y), set(plane.normal.z)}, point), set(plane.offset));
    const M front = hn::Gt(height, zero);  // from the front the corners turn the other way
    for (std::size_t b = first; b < last; ++b) {
      V3 side = cross3(load3(w.corners + 3 * n * b), load3(w.corners + 3 * n * (b + 1 == last ? first : b + 1)));
      side.x = hn::IfThenElse(front, hn::Neg(side.x), side.x);
      side.y = hn::IfThenElse(front, hn::Neg(side.y), side.y);
      side.z = hn::IfThenElse(front, hn::Neg(side.z), side.z);
      store3(side, w.corner_sides + 3 * n * b);
    }
    double* starts = w.stretch_starts + n * ns * active_count;
    double* ends = w.stretch_ends + n * ns * active_count;
    for (std::size_t a = 0; a < ns; ++a) {
      hn::StoreU(zero, d, starts + n * a);
      hn::StoreU(one, d, ends + n * a);
    }
    for (std::size_t b = first; b < last && !apart; ++b) {
      const V3 side = load3(w.corner_sides + 3 * n * b);
      M any = hn::Lt(one, zero);
      V f0 = dot3(side, load3(w.source));
      const V f_first = f0;
      for (std::size_t a = 0; a < ns; ++a) {
        any = hn::Or(any, hn::Gt(f0, zero));
        const V f1 = a + 1 == ns ? f_first : dot3(side, load3(w.source + 3 * n * (a + 1)));
        V lo = hn::LoadU(d, starts + n * a), hi = hn::LoadU(d, ends + n * a);
        cut_interval(f0, f1, lo, hi);
        hn::StoreU(lo, d, starts + n * a);
        hn::StoreU(hi, d, ends + n * a);
        f0 = f1;
      }
      apart = hn::AllFalse(d, any);
    }
    if (!apart) active[active_count++] = static_cast<std::uint32_t>(k);
  }

  V sum = zero;
  CoveredStretches covered{w.starts, w.ends};
  for (std::size_t a = 0; a < ns; ++a) {
    covered.count = 0;
    for (std::size_t k = 0; k < active_count; ++k) {
      const V lo = hn::LoadU(d, w.stretch_starts + n * (k * ns + a)),
              hi = hn::LoadU(d, w.stretch_ends + n * (k * ns + a));
      const M some = hn::Gt(hi, lo);
      if (!hn::AllFalse(d, some)) covered.insert(hn::IfThenElse(some, lo, set(2)), hn::IfThenElse(some, hi, set(2)));
    }
    const Arc arc = make_arc(load3(w.source + 3 * n * a), load3(w.source + 3 * n * (a + 1 == ns ? 0 : a + 1)),
                             load3(w.source_sides + 3 * n * a), up);
    sum = hn::MulAdd(arc.weight, covered.open_angle(arc, zero, one), sum);
  }
  for (std::size_t i = 0; i < active_count; ++i) {
    const std::size_t k = active[i];
    const std::size_t first = in.offsets[k], last = in.offsets[k + 1];
    for (std::size_t b = first; b < last; ++b) {
      const std::size_t b1 = b + 1 == last ? first : b + 1;
      V lo = zero, hi = one;
      for (std::size_t a = 0; a < ns; ++a)
        cut_interval(hn::LoadU(d, sides_at + n * (a * no + b)), hn::LoadU(d, sides_at + n * (a * no + b1)), lo, hi);
      if (hn::AllFalse(d, hn::Gt(hi, lo))) continue;
      const V3 p = load3(w.corners + 3 * n * b), q = load3(w.corners + 3 * n * b1);
      covered.count = 0;
      for (std::size_t j = 0; j < active_count; ++j) {
        if (j == i) continue;
        const std::size_t l = active[j];
        V start = zero, end = one;
        for (std::size_t c = in.offsets[l]; c < in.offsets[l + 1]; ++c) {
          const V3 side = load3(w.corner_sides + 3 * n * c);
          cut_interval(dot3(side, p), dot3(side, q), start, end);
        }
        const M some = hn::Gt(end, start);
        if (!hn::AllFalse(d, some))
          covered.insert(hn::IfThenElse(some, start, set(2)), hn::IfThenElse(some, end, set(2)));
      }
      const Arc arc = make_arc(p, q, load3(w.corner_sides + 3 * n * b), up);
      sum = hn::NegMulAdd(arc.weight, covered.open_angle(arc, lo, hi), sum);
    }
  }
  hn::StoreU(hn::Max(zero, hn::Mul(sum, set(0.15915494309189533577))), d, out);
}

void evaluate_points(const VisibleFragments::Input& in, const double* x, const double* y, const double* z,
                     std::size_t count, const Vec3d& normal, double* scratch, std::uint32_t* active, double* out) {
  const D d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d))
    evaluate_vector(in, x + i, y + i, z + i, normal, scratch, active, out + i);
}

}  // namespace penumbra::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra {

HWY_EXPORT(evaluate_points);
HWY_EXPORT(scratch_size);

VisibleFragments::VisibleFragments() = default;
VisibleFragments::~VisibleFragments() = default;

void VisibleFragments::set_source(std::span<const Vec3d> polygon) {
  source_.assign(polygon.begin(), polygon.end());
  corners_.clear();
  offsets_.assign(1, 0);
  planes_.clear();
}

void VisibleFragments::add_occluder(std::span<const Vec3d> polygon, const Plane3& plane) {
  corners_.insert(corners_.end(), polygon.begin(), polygon.end());
  offsets_.push_back(static_cast<std::uint32_t>(corners_.size()));
  planes_.push_back(plane);
}

void VisibleFragments::evaluate(const double* x, const double* y, const double* z, std::size_t count,
                                const Vec3d& normal, double* factors) {
  assert(count % group == 0);
  assert(source_.size() >= 3);
  const std::size_t size = HWY_DYNAMIC_DISPATCH(scratch_size)(source_.size(), corners_.size(), planes_.size());
  if (scratch_.size() < size) scratch_.resize(size);
  if (active_.size() < planes_.size()) active_.resize(planes_.size());
  HWY_DYNAMIC_DISPATCH(evaluate_points)
  ({source_, corners_, offsets_, planes_}, x, y, z, count, normal, scratch_.data(), active_.data(), factors);
}

}  // namespace penumbra
#endif
