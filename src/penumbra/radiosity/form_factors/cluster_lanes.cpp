#include "penumbra/radiosity/form_factors/cluster_lanes.h"

#include <algorithm>
#include <cmath>

// Compiled once for each instruction set; the best one that the processor has is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "penumbra/radiosity/form_factors/cluster_lanes.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace penumbra::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr std::size_t lanes = PatchClusters::lanes;

HWY_INLINE V set(double v) { return hn::Set(D(), v); }

HWY_INLINE std::uint32_t bits_of(M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(D(), mask, bytes);
  return bytes[0] & ((1U << hn::Lanes(D())) - 1U);
}

// Error of the 4 x 4 rule: terms of fourth order in each patch's radius / r, and of third order for patches without a
// centre of symmetry, times a factor that keeps some weight where the cosines vanish, since their slopes do not.
// Measured against the closed form over random pairs (tests/radiosity/auto_open_test.cpp).
constexpr double fourth_order = 0.35;
constexpr double third_order = 1;
constexpr double sixth_order = 0.1;  // of the 9 x 9 rule; fifth order for triangles
constexpr double fifth_order = 0.4;
constexpr double turning = 0.4;

void far_exchange_lanes(const PatchClusters& c, std::size_t slot, std::size_t index, double tolerance,
                        LaneExchange& out) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const PatchClusters::Cluster& own = c.clusters[slot / lanes];
  const PatchClusters::Cluster& other = c.clusters[index];
  const std::size_t own_lane = slot % lanes;
  const V zero = hn::Zero(d);
  const V nx = set(c.normal[0][slot]), ny = set(c.normal[1][slot]), nz = set(c.normal[2][slot]);
  const V offset = set(c.offset[slot]);
  const V eps = set(tolerance), minus_eps = set(-tolerance);
  out.facing = 0;
  out.straddling = 0;
  for (std::size_t l = 0; l < lanes; l += n) {
    const std::size_t s = index * lanes + l;
    // Facing: how far the corners of each stand in front of the other's plane.
    V high = set(-1e300), low = set(1e300);
    for (std::size_t k = 0; k < other.corner_count; ++k) {
      const V x = hn::LoadU(d, c.corner(other, k, 0) + l), y = hn::LoadU(d, c.corner(other, k, 1) + l),
              z = hn::LoadU(d, c.corner(other, k, 2) + l);
      const V h = hn::MulAdd(nx, x, hn::MulAdd(ny, y, hn::MulSub(nz, z, offset)));
      high = hn::Max(high, h);
      low = hn::Min(low, h);
    }
    M faces = hn::Gt(high, eps);
    M cut = hn::Lt(low, minus_eps);
    if (hn::AllFalse(d, faces)) continue;
    const V mx = hn::LoadU(d, &c.normal[0][s]), my = hn::LoadU(d, &c.normal[1][s]), mz = hn::LoadU(d, &c.normal[2][s]);
    const V other_offset = hn::LoadU(d, &c.offset[s]);
    high = set(-1e300);
    low = set(1e300);
    for (std::size_t k = 0; k < own.corner_count; ++k) {
      const V x = set(c.corner(own, k, 0)[own_lane]), y = set(c.corner(own, k, 1)[own_lane]),
              z = set(c.corner(own, k, 2)[own_lane]);
      const V h = hn::MulAdd(mx, x, hn::MulAdd(my, y, hn::MulSub(mz, z, other_offset)));
      high = hn::Max(high, h);
      low = hn::Min(low, h);
    }
    faces = hn::And(faces, hn::Gt(high, eps));
    if (hn::AllFalse(d, faces)) continue;
    cut = hn::And(faces, hn::Or(cut, hn::Lt(low, minus_eps)));

    V sum = zero;
    for (std::size_t p = 0; p < PatchClusters::rule_points; ++p) {
      const V px = set(c.rule[p][0][slot]), py = set(c.rule[p][1][slot]), pz = set(c.rule[p][2][slot]);
      for (std::size_t q = 0; q < PatchClusters::rule_points; ++q) {
        const V rx = hn::Sub(hn::LoadU(d, &c.rule[q][0][s]), px), ry = hn::Sub(hn::LoadU(d, &c.rule[q][1][s]), py),
                rz = hn::Sub(hn::LoadU(d, &c.rule[q][2][s]), pz);
        const V r2 = hn::MulAdd(rx, rx, hn::MulAdd(ry, ry, hn::Mul(rz, rz)));
        const V leave = hn::MulAdd(nx, rx, hn::MulAdd(ny, ry, hn::Mul(nz, rz)));
        const V arrive = hn::MulAdd(mx, rx, hn::MulAdd(my, ry, hn::Mul(mz, rz)));
        const V product = hn::Mul(hn::Max(leave, zero), hn::Max(hn::Neg(arrive), zero));
        sum = hn::Add(sum, hn::Div(product, hn::Max(hn::Mul(r2, r2), set(1e-300))));
      }
    }
    const V areas = hn::Mul(set(c.area[slot] / 3.14159265358979323846), hn::LoadU(d, &c.area[s]));
    hn::StoreU(hn::Mul(hn::Mul(areas, set(1.0 / 16)), sum), d, out.exchange + l);

    const V rx = hn::Sub(hn::LoadU(d, &c.centroid[0][s]), set(c.centroid[0][slot])),
            ry = hn::Sub(hn::LoadU(d, &c.centroid[1][s]), set(c.centroid[1][slot])),
            rz = hn::Sub(hn::LoadU(d, &c.centroid[2][s]), set(c.centroid[2][slot]));
    const V r2 = hn::Max(hn::MulAdd(rx, rx, hn::MulAdd(ry, ry, hn::Mul(rz, rz))), set(1e-300));
    const V inverse = hn::Div(set(1), r2);
    const V inverse_r = hn::Sqrt(inverse);
    const V reach = hn::Add(set(c.radius[slot]), hn::LoadU(d, &c.radius[s]));
    const V ratio = hn::Mul(reach, inverse_r);
    const V own2 = hn::Mul(set(c.radius[slot] * c.radius[slot]), inverse);
    const V their_radius = hn::LoadU(d, &c.radius[s]);
    const V their2 = hn::Mul(hn::Mul(their_radius, their_radius), inverse);
    const V leave = hn::Abs(hn::MulAdd(nx, rx, hn::MulAdd(ny, ry, hn::Mul(nz, rz))));
    const V arrive = hn::Abs(hn::MulAdd(mx, rx, hn::MulAdd(my, ry, hn::Mul(mz, rz))));
    const V cosines = hn::Mul(hn::MulAdd(leave, inverse_r, set(turning)), hn::MulAdd(arrive, inverse_r, set(turning)));
    const V fourth = hn::MulAdd(own2, own2, hn::Mul(their2, their2));
    const V third = hn::MulAdd(hn::Mul(set(c.skew[slot]), hn::Sqrt(own2)), own2,
                               hn::Mul(hn::Mul(hn::LoadU(d, &c.skew[s]), hn::Sqrt(their2)), their2));
    V order = hn::MulAdd(set(fourth_order), fourth, hn::Mul(set(third_order), third));
    order = hn::IfThenElse(hn::Gt(ratio, set(0.9)), set(1e300), order);
    hn::StoreU(hn::Mul(hn::Mul(areas, inverse), hn::Mul(cosines, order)), d, out.error + l);
    out.facing |= bits_of(faces) << l;
    out.straddling |= bits_of(cut) << l;
  }
  const std::uint32_t used = (1U << other.count) - 1U;
  out.facing &= used;
  out.straddling &= used;
}

void refine_exchange_lanes(const PatchClusters& c, std::size_t slot, std::size_t index, std::uint32_t wanted,
                           LaneExchange& out) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const V zero = hn::Zero(d);
  const V nx = set(c.normal[0][slot]), ny = set(c.normal[1][slot]), nz = set(c.normal[2][slot]);
  if (c.fine[0][3][slot] == 0) return;
  for (std::size_t l = 0; l < lanes; l += n) {
    if (((wanted >> l) & ((1U << n) - 1U)) == 0) continue;
    const std::size_t s = index * lanes + l;
    const V mx = hn::LoadU(d, &c.normal[0][s]), my = hn::LoadU(d, &c.normal[1][s]), mz = hn::LoadU(d, &c.normal[2][s]);
    V sum = zero;
    for (std::size_t q = 0; q < PatchClusters::fine_points; ++q) {
      const V qx = hn::LoadU(d, &c.fine[q][0][s]), qy = hn::LoadU(d, &c.fine[q][1][s]),
              qz = hn::LoadU(d, &c.fine[q][2][s]);
      V part = zero;
      for (std::size_t p = 0; p < PatchClusters::fine_points; ++p) {
        const V rx = hn::Sub(qx, set(c.fine[p][0][slot])), ry = hn::Sub(qy, set(c.fine[p][1][slot])),
                rz = hn::Sub(qz, set(c.fine[p][2][slot]));
        const V r2 = hn::MulAdd(rx, rx, hn::MulAdd(ry, ry, hn::Mul(rz, rz)));
        const V leave = hn::MulAdd(nx, rx, hn::MulAdd(ny, ry, hn::Mul(nz, rz)));
        const V arrive = hn::MulAdd(mx, rx, hn::MulAdd(my, ry, hn::Mul(mz, rz)));
        const V product = hn::Mul(hn::Max(leave, zero), hn::Max(hn::Neg(arrive), zero));
        part = hn::MulAdd(set(c.fine[p][3][slot]), hn::Div(product, hn::Max(hn::Mul(r2, r2), set(1e-300))), part);
      }
      sum = hn::MulAdd(hn::LoadU(d, &c.fine[q][3][s]), part, sum);
    }
    const V areas = hn::Mul(set(c.area[slot] / 3.14159265358979323846), hn::LoadU(d, &c.area[s]));
    const V rx = hn::Sub(hn::LoadU(d, &c.centroid[0][s]), set(c.centroid[0][slot])),
            ry = hn::Sub(hn::LoadU(d, &c.centroid[1][s]), set(c.centroid[1][slot])),
            rz = hn::Sub(hn::LoadU(d, &c.centroid[2][s]), set(c.centroid[2][slot]));
    const V r2 = hn::Max(hn::MulAdd(rx, rx, hn::MulAdd(ry, ry, hn::Mul(rz, rz))), set(1e-300));
    const V inverse = hn::Div(set(1), r2);
    const V inverse_r = hn::Sqrt(inverse);
    const V own = hn::Mul(set(c.radius[slot]), inverse_r), their = hn::Mul(hn::LoadU(d, &c.radius[s]), inverse_r);
    const V own2 = hn::Mul(own, own), their2 = hn::Mul(their, their);
    const V leave = hn::Abs(hn::MulAdd(nx, rx, hn::MulAdd(ny, ry, hn::Mul(nz, rz))));
    const V arrive = hn::Abs(hn::MulAdd(mx, rx, hn::MulAdd(my, ry, hn::Mul(mz, rz))));
    const V cosines = hn::Mul(hn::MulAdd(leave, inverse_r, set(turning)), hn::MulAdd(arrive, inverse_r, set(turning)));
    const V sixth = hn::MulAdd(hn::Mul(own2, own2), own2, hn::Mul(hn::Mul(their2, their2), their2));
    const V fifth = hn::MulAdd(hn::Mul(hn::Mul(set(c.skew[slot]), own), own2), own2,
                               hn::Mul(hn::Mul(hn::Mul(hn::LoadU(d, &c.skew[s]), their), their2), their2));
    V order = hn::MulAdd(set(sixth_order), sixth, hn::Mul(set(fifth_order), fifth));
    const M unknown = hn::Or(hn::Gt(hn::Add(own, their), set(0.9)), hn::Le(hn::LoadU(d, &c.fine[0][3][s]), zero));
    order = hn::IfThenElse(unknown, set(1e300), order);
    const V error = hn::Mul(hn::Mul(areas, inverse), hn::Mul(cosines, order));
    const M better = hn::Lt(error, hn::LoadU(d, out.error + l));
    hn::StoreU(hn::IfThenElse(better, hn::Mul(areas, sum), hn::LoadU(d, out.exchange + l)), d, out.exchange + l);
    hn::StoreU(hn::IfThenElse(better, error, hn::LoadU(d, out.error + l)), d, out.error + l);
  }
}

void corner_distances_lanes(const PatchClusters& c, std::size_t index, std::span<const Plane3> planes, double* table) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const PatchClusters::Cluster& cluster = c.clusters[index];
  for (std::size_t k = 0; k < cluster.corner_count; ++k) {
    for (std::size_t l = 0; l < lanes; l += n) {
      const V x = hn::LoadU(d, c.corner(cluster, k, 0) + l), y = hn::LoadU(d, c.corner(cluster, k, 1) + l),
              z = hn::LoadU(d, c.corner(cluster, k, 2) + l);
      for (std::size_t p = 0; p < planes.size(); ++p) {
        const Plane3& plane = planes[p];
        const V h =
            hn::MulAdd(set(plane.normal.x), x,
                       hn::MulAdd(set(plane.normal.y), y, hn::MulSub(set(plane.normal.z), z, set(plane.offset))));
        hn::StoreU(h, d, table + (p * cluster.corner_count + k) * lanes + l);
      }
    }
  }
}

/// Where the polygon of lane `lane` meets an occluder's plane: the least and the most that its points there are inside
/// edge e.
struct Cut {
  double least = 1e300, most = -1e300;
  Cut(const double* table, std::size_t corners, std::size_t e, std::size_t lane) {
    for (std::size_t k = 0; k < corners; ++k) {
      const std::size_t next = k + 1 == corners ? 0 : k + 1;
      const double h0 = table[k * lanes + lane], h1 = table[next * lanes + lane];
      const double e0 = table[(e * corners + k) * lanes + lane], e1 = table[(e * corners + next) * lanes + lane];
      if (h0 == 0) grow(e0);
      if ((h0 < 0) != (h1 < 0)) grow(e0 + h0 / (h0 - h1) * (e1 - e0));
    }
  }
  void grow(double v) {
    least = std::min(least, v);
    most = std::max(most, v);
  }
};

/// The same in the lanes from l on.
struct LaneCuts {
  V least = set(1e300), most = set(-1e300);
  HWY_INLINE LaneCuts(const double* table, std::size_t corners, std::size_t e, std::size_t l) {
    const D d;
    const V zero = hn::Zero(d);
    for (std::size_t k = 0; k < corners; ++k) {
      const std::size_t next = k + 1 == corners ? 0 : k + 1;
      const V h0 = hn::LoadU(d, table + k * lanes + l), h1 = hn::LoadU(d, table + next * lanes + l);
      const V e0 = hn::LoadU(d, table + (e * corners + k) * lanes + l),
              e1 = hn::LoadU(d, table + (e * corners + next) * lanes + l);
      const M cut = hn::Xor(hn::Lt(h0, zero), hn::Lt(h1, zero)), on = hn::Eq(h0, zero);
      const V at = hn::IfThenElse(cut, hn::MulAdd(hn::Div(h0, hn::Sub(h0, h1)), hn::Sub(e1, e0), e0), e0);
      const M counts = hn::Or(cut, on);
      least = hn::IfThenElse(counts, hn::Min(least, at), least);
      most = hn::IfThenElse(counts, hn::Max(most, at), most);
      least = hn::IfThenElse(on, hn::Min(least, e0), least);
      most = hn::IfThenElse(on, hn::Max(most, e0), most);
    }
  }
};

/// Two patches of which an occluder's plane cuts one at least: lines cross it from parts on one side to parts on the
/// other, both bounded by the plane.
class Straddling {
 public:
  Straddling(const double* first_table, std::size_t na, std::size_t lane, const double* second_table, std::size_t nb,
             std::size_t l, double slack)
      : first_(first_table), second_(second_table), na_(na), nb_(nb), lane_(lane), l_(l), slack_(slack) {}

  /// Looks at the occluder's edge e. Returns the lanes where all lines pass inside it.
  HWY_INLINE M look(std::size_t e) {
    const D d;
    const V zero = hn::Zero(d), tiny = set(slack_);
    const Cut own(first_, na_, e, lane_);
    const LaneCuts their(second_, nb_, e, l_);
    const M never = hn::Lt(tiny, zero);
    const M outside = own.most <= slack_ ? hn::Le(their.most, tiny) : never;
    V high_forth = set(-1e300), high_back = high_forth, low = set(1e300);
    for (std::size_t a = 0; a < na_; ++a) {
      const double ha = first_[a * lanes + lane_];
      if (ha == 0) continue;
      const V wa = set(std::abs(ha)), ea = set(first_[(e * na_ + a) * lanes + lane_]);
      V& high = ha > 0 ? high_forth : high_back;
      for (std::size_t b = 0; b < nb_; ++b) {
        const V hb = hn::LoadU(d, second_ + b * lanes + l_), wb = hn::Abs(hb);
        const V eb = hn::LoadU(d, second_ + (e * nb_ + b) * lanes + l_);
        const M opposite = ha > 0 ? hn::Lt(hb, zero) : hn::Gt(hb, zero);
        const V side = hn::MulAdd(wb, ea, hn::Mul(wa, eb)), margin = hn::Mul(tiny, hn::Add(wa, wb));
        high = hn::IfThenElse(opposite, hn::Max(high, hn::Sub(side, margin)), high);
        low = hn::IfThenElse(opposite, hn::Min(low, hn::Add(side, margin)), low);
      }
    }
    forth_ = hn::Or(forth_, hn::And(outside, hn::Le(high_forth, zero)));
    back_ = hn::Or(back_, hn::And(outside, hn::Le(high_back, zero)));
    return hn::And(own.least >= -slack_ ? hn::Ge(their.least, hn::Neg(tiny)) : never, hn::Ge(low, zero));
  }

  [[nodiscard]] M visible() const { return hn::And(forth_, back_); }

 private:
  const double *first_, *second_;
  std::size_t na_, nb_, lane_, l_;
  double slack_;
  M forth_ = hn::Lt(hn::Zero(D()), hn::Zero(D())), back_ = forth_;  // from front to back, and from back to front
};

LaneVisibility lane_visibility_lanes(const PatchClusters& c, std::size_t first, std::size_t lane,
                                     const double* first_table, std::size_t second, const double* second_table,
                                     std::size_t planes, double slack, std::uint32_t wanted,
                                     std::uint32_t* inside_lanes) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const std::size_t na = c.clusters[first].corner_count, nb = c.clusters[second].corner_count;
  double low_a = 1e300, high_a = -1e300;
  for (std::size_t a = 0; a < na; ++a) {
    const double h = first_table[a * lanes + lane];
    low_a = std::min(low_a, h);
    high_a = std::max(high_a, h);
  }
  LaneVisibility out;
  out.side = static_cast<signed char>((low_a >= -slack ? 1 : 0) - (high_a <= slack ? 1 : 0));
  std::fill_n(inside_lanes, planes - 1, 0U);
  const V tiny = set(slack), minus_tiny = set(-slack), zero = hn::Zero(d);
  for (std::size_t l = 0; l < lanes; l += n) {
    if (((wanted >> l) & ((1U << n) - 1U)) == 0) continue;
    V low_b = set(1e300), high_b = set(-1e300);
    for (std::size_t b = 0; b < nb; ++b) {
      const V h = hn::LoadU(d, second_table + b * lanes + l);
      low_b = hn::Min(low_b, h);
      high_b = hn::Max(high_b, h);
    }
    const M none = hn::Lt(tiny, zero), all = hn::Not(none);
    const M b_front = hn::Ge(low_b, minus_tiny), b_back = hn::Le(high_b, tiny);
    const M a_front = low_a >= -slack ? all : none, a_back = high_a <= slack ? all : none;
    // What lies in the plane of one of them is behind its horizon.
    M visible = hn::Or(hn::Or(hn::And(a_front, b_front), hn::And(a_back, b_back)),
                       hn::Or(hn::And(a_front, a_back), hn::And(b_front, b_back)));
    const M across = hn::AndNot(visible, hn::Or(hn::And(a_front, b_back), hn::And(a_back, b_front)));
    const M straddling = hn::Not(hn::Or(visible, across));
    const bool any_straddling = !hn::AllFalse(d, straddling);
    M hidden = across;
    Straddling cut(first_table, na, lane, second_table, nb, l, slack);
    // All lines pass the occluder's plane between the edge distances of their ends, weighted by the ends' heights.
    for (std::size_t e = 1; e < planes; ++e) {
      double low_ea = 1e300, high_ea = -1e300;
      for (std::size_t a = 0; a < na; ++a) {
        const double ea = first_table[(e * na + a) * lanes + lane];
        low_ea = std::min(low_ea, ea);
        high_ea = std::max(high_ea, ea);
      }
      V low_eb = set(1e300), high_eb = set(-1e300);
      for (std::size_t b = 0; b < nb; ++b) {
        const V eb = hn::LoadU(d, second_table + (e * nb + b) * lanes + l);
        low_eb = hn::Min(low_eb, eb);
        high_eb = hn::Max(high_eb, eb);
      }
      if (high_ea <= slack) visible = hn::Or(visible, hn::Le(high_eb, tiny));
      M inside = low_ea >= -slack ? hn::Ge(low_eb, minus_tiny) : none;
      const M open = hn::AndNot(hn::Or(visible, inside), across);
      if (!hn::AllFalse(d, open)) {
        V low = set(1e300), high = set(-1e300);
        for (std::size_t a = 0; a < na; ++a) {
          const V wa = set(std::abs(first_table[a * lanes + lane])), ea = set(first_table[(e * na + a) * lanes + lane]);
          for (std::size_t b = 0; b < nb; ++b) {
            const V wb = hn::Abs(hn::LoadU(d, second_table + b * lanes + l));
            const V eb = hn::LoadU(d, second_table + (e * nb + b) * lanes + l);
            const V margin = hn::Mul(tiny, hn::Add(wa, wb));
            const V side = hn::MulAdd(wb, ea, hn::Mul(wa, eb));
            low = hn::Min(low, hn::Add(side, margin));
            high = hn::Max(high, hn::Sub(side, margin));
          }
        }
        visible = hn::Or(visible, hn::And(across, hn::Le(high, zero)));
        inside = hn::Or(inside, hn::Ge(low, zero));
      }
      hidden = hn::And(hidden, inside);
      if (any_straddling) {
        const M within = cut.look(e);
        inside = hn::Or(hn::And(straddling, within), hn::AndNot(straddling, inside));
      }
      inside_lanes[e - 1] |= bits_of(inside) << l;
      if (hn::AllTrue(d, visible)) break;
    }
    if (any_straddling) visible = hn::Or(visible, hn::And(straddling, cut.visible()));
    hidden = hn::AndNot(visible, hidden);
    out.visible |= bits_of(visible) << l;
    out.hidden |= bits_of(hidden) << l;
    out.front |= bits_of(b_front) << l;
    out.back |= bits_of(b_back) << l;
  }
  return out;
}

std::uint32_t hidden_centroids_lanes(const PatchClusters& c, const Vec3d& point, std::size_t cluster,
                                     std::span<const Plane3> planes, double slack) {
  const D d;
  const V zero = hn::Zero(d), minus_tiny = set(-slack);
  std::uint32_t out = 0;
  const double hp = planes[0].distance(point);
  for (std::size_t l = 0; l < lanes; l += hn::Lanes(d)) {
    const std::size_t s = cluster * lanes + l;
    const V x = hn::LoadU(d, &c.centroid[0][s]), y = hn::LoadU(d, &c.centroid[1][s]),
            z = hn::LoadU(d, &c.centroid[2][s]);
    const auto distance = [&](const Plane3& plane) {
      return hn::MulAdd(set(plane.normal.x), x,
                        hn::MulAdd(set(plane.normal.y), y, hn::MulSub(set(plane.normal.z), z, set(plane.offset))));
    };
    const V hq = distance(planes[0]);
    M hidden = hp < 0 ? hn::Ge(hq, zero) : hn::Lt(hq, zero);
    const V wp = set(std::abs(hp)), wq = hn::Abs(hq);
    const V least = hn::Mul(minus_tiny, hn::Add(wp, wq));
    for (std::size_t e = 1; e < planes.size() && !hn::AllFalse(d, hidden); ++e) {
      const V side = hn::MulAdd(wq, set(planes[e].distance(point)), hn::Mul(wp, distance(planes[e])));
      hidden = hn::And(hidden, hn::Ge(side, least));
    }
    out |= bits_of(hidden) << l;
  }
  return out;
}

}  // namespace penumbra::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra {

HWY_EXPORT(far_exchange_lanes);
HWY_EXPORT(refine_exchange_lanes);
HWY_EXPORT(corner_distances_lanes);
HWY_EXPORT(lane_visibility_lanes);
HWY_EXPORT(hidden_centroids_lanes);

void far_exchange(const PatchClusters& clusters, std::size_t slot, std::size_t cluster, double tolerance,
                  LaneExchange& out) {
  HWY_DYNAMIC_DISPATCH(far_exchange_lanes)(clusters, slot, cluster, tolerance, out);
}

void refine_exchange(const PatchClusters& clusters, std::size_t slot, std::size_t cluster, std::uint32_t wanted,
                     LaneExchange& out) {
  HWY_DYNAMIC_DISPATCH(refine_exchange_lanes)(clusters, slot, cluster, wanted, out);
}

void corner_distances(const PatchClusters& clusters, std::size_t cluster, std::span<const Plane3> planes,
                      double* table) {
  HWY_DYNAMIC_DISPATCH(corner_distances_lanes)(clusters, cluster, planes, table);
}

LaneVisibility lane_visibility(const PatchClusters& clusters, std::size_t first, std::size_t lane,
                               const double* first_table, std::size_t second, const double* second_table,
                               std::size_t planes, double slack, std::uint32_t wanted, std::uint32_t* inside) {
  return HWY_DYNAMIC_DISPATCH(lane_visibility_lanes)(clusters, first, lane, first_table, second, second_table, planes,
                                                     slack, wanted, inside);
}

std::uint32_t hidden_centroids(const PatchClusters& clusters, const Vec3d& point, std::size_t cluster,
                               std::span<const Plane3> planes, double slack) {
  return HWY_DYNAMIC_DISPATCH(hidden_centroids_lanes)(clusters, point, cluster, planes, slack);
}

}  // namespace penumbra
#endif
