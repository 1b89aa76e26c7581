// What holds for every method on every scene: reciprocity, closure, F_ii = 0, and that neither turning, nor scaling,
// nor renumbering a scene changes its factors.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "penumbra/io/vs3_reader.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "radiosity/polygon_makers.h"
#include "test_paths.h"

namespace penumbra {
namespace {

PolygonModel model_of(const std::vector<Polygon>& polygons) {
  PolygonModel model;
  for (const Polygon& polygon : polygons) {
    ModelPolygon p;
    for (const Vec3d& v : polygon) {
      p.corners.push_back(static_cast<std::uint32_t>(model.vertices.size()));
      model.vertices.push_back(v);
    }
    model.polygons.push_back(p);
  }
  return model;
}

PolygonModel model_of(const std::string& file) { return read_vs3(PENUMBRA_TEST_DATA "/view3d/" + file).model; }

// A closed room with a box on its floor; what it stands on is cut out of the floor.
PolygonModel furnished_room(Dice& dice) {
  const Vec3d size(dice.between(0.2, 0.5), dice.between(0.2, 0.5), dice.between(0.2, 0.8));
  const Vec3d at(dice.between(0.1, 0.4), dice.between(0.1, 0.4), 0);
  std::vector<Polygon> box = reversed(room(size));
  const Polygon footprint = moved(box.front(), at);
  box.erase(box.begin());
  std::vector<Polygon> all = room({1, 1, 1});
  for (const Polygon& face : box) all.push_back(moved(face, at));
  PolygonModel model = model_of(all);
  PolygonModel hole = model_of(std::vector<Polygon>{footprint});
  for (std::uint32_t& c : hole.polygons[0].corners) c += static_cast<std::uint32_t>(model.vertices.size());
  model.vertices.insert(model.vertices.end(), hole.vertices.begin(), hole.vertices.end());
  hole.polygons[0].role = PolygonRole::masks;
  hole.polygons[0].base = 0U;
  model.polygons.push_back(hole.polygons[0]);
  return model;
}

struct LawScene {
  std::string name;
  PolygonModel model;
  bool closed = true;
  bool convex = false;  // nothing hides anything
};

std::vector<LawScene> scenes() {
  Dice dice(11);
  std::vector<LawScene> all{{"unit cube", model_of(room({1, 1, 1})), true, true},
                            {"box with two cubes", model_of(std::string("box345_AB1.0.vs3"))},
                            {"L-room", model_of(std::string("l_room.vs3"))},
                            {"convex cavity", model_of(dice.convex_cavity(7)), true, true}};
  for (int k = 0; k < 3; ++k) all.push_back({"furnished room " + std::to_string(k), furnished_room(dice)});
  for (int k = 0; k < 3; ++k) {
    std::vector<Polygon> polygons;
    for (int p = 0; p < 9; ++p) polygons.push_back(dice.convex_polygon());
    all.push_back({"random polygons " + std::to_string(k), model_of(polygons), false});
  }
  return all;
}

constexpr double tolerance = 1e-4;

PatchMesh mesh_of(const PolygonModel& model) { return make_patch_mesh(model).mesh; }

FactorMatrix factors_of(const PatchMesh& mesh, std::string_view method) {
  FormFactorOptions options;
  options.tolerance = tolerance;
  options.rays = 1024;
  options.resolution = 64;
  return assemble_factor_matrix(*make_form_factor_method(method, mesh, options), mesh);
}

// Sum over j of |F_ij - G_kl|, where row and column i of F are row and column `of[i]` of G.
double difference(const FactorMatrix& f, const FactorMatrix& g, const std::vector<std::size_t>& of, std::size_t i) {
  double sum = 0;
  for (std::size_t j = 0; j < f.rows(); ++j) sum += std::abs(f.at(i, j) - g.at(of[i], of[j]));
  return sum;
}

bool keeps_tolerance(std::string_view method) { return method == "auto" || method == "adaptive"; }

class FormFactorLaws : public testing::TestWithParam<std::string_view> {
 protected:
  // The factors of a changed scene agree with the first ones within what both say of themselves.
  void expect_same(const LawScene& scene, const PolygonModel& changed, const std::vector<std::uint32_t>& new_number,
                   const char* how) {
    const PatchMesh mesh = mesh_of(scene.model), other = mesh_of(changed);
    const FactorMatrix f = factors_of(mesh, GetParam()), g = factors_of(other, GetParam());
    ASSERT_EQ(f.rows(), g.rows());
    std::vector<std::size_t> of(f.rows());
    for (std::size_t i = 0; i < f.rows(); ++i) {
      const std::uint32_t face = new_number[mesh.surfaces[i].face];
      of[i] = static_cast<std::size_t>(std::find_if(other.surfaces.begin(), other.surfaces.end(),
                                                    [&](const PatchSurface& s) { return s.face == face; }) -
                                       other.surfaces.begin());
      ASSERT_LT(of[i], f.rows());
    }
    // Without shadows these do the same arithmetic; with them a ray may pass an edge on either side.
    const bool exact = scene.convex && (GetParam() == "point" || GetParam() == "nusselt" || GetParam() == "analytic");
    // A hemicube's pixels turn with it, and its estimates do not count single pixels of slivers.
    const double rounding = GetParam() == "hemicube" ? 1e-6 : 1e-9;
    for (std::size_t i = 0; i < f.rows(); ++i) {
      double allowed = f.row_errors[i] + g.row_errors[of[i]] + rounding;
      if (keeps_tolerance(GetParam())) allowed = 2 * tolerance;
      if (exact) allowed = rounding;
      EXPECT_LE(difference(f, g, of, i), allowed) << scene.name << " " << how << ", row " << i;
    }
  }

  static std::vector<std::uint32_t> unchanged(const PolygonModel& model) {
    std::vector<std::uint32_t> numbers(model.polygons.size());
    std::iota(numbers.begin(), numbers.end(), 0U);
    return numbers;
  }
};

TEST_P(FormFactorLaws, ReciprocityAndNoPlanarRowSeesItself) {
  for (const LawScene& scene : scenes()) {
    const FactorMatrix f = factors_of(mesh_of(scene.model), GetParam());
    for (std::size_t i = 0; i < f.rows(); ++i) {
      EXPECT_EQ(f.at(i, i), 0) << scene.name;
      for (std::size_t j = 0; j < i; ++j) {
        const double exchange = f.areas[i] * f.at(i, j);
        EXPECT_GE(exchange, 0) << scene.name;
        EXPECT_NEAR(exchange, f.areas[j] * f.at(j, i), 1e-13 * exchange) << scene.name << " " << i << " " << j;
      }
    }
  }
}

TEST_P(FormFactorLaws, RowsOfClosedScenesSumToOne) {
  for (const LawScene& scene : scenes()) {
    const FactorMatrix f = factors_of(mesh_of(scene.model), GetParam());
    for (std::size_t i = 0; i < f.rows(); ++i) {
      double allowed = keeps_tolerance(GetParam()) ? tolerance : f.row_errors[i] + 1e-12;
      // Its header says so: a hemicube does not know of shadow edges that its centre does not see.
      if (GetParam() == "hemicube" && !scene.convex) allowed += 0.25;
      if (scene.closed) {
        EXPECT_NEAR(f.row_sum(i), 1, allowed) << scene.name << " " << i;
      } else {
        EXPECT_LE(f.row_sum(i), 1 + allowed) << scene.name << " " << i;
      }
    }
  }
}

TEST_P(FormFactorLaws, TurningChangesNothing) {
  Dice dice(23);
  for (const LawScene& scene : scenes()) {
    PolygonModel turned = scene.model;
    const Mat4d motion = dice.motion();
    for (Vec3d& v : turned.vertices) v = transform_point(motion, v);
    expect_same(scene, turned, unchanged(turned), "turned");
  }
}

TEST_P(FormFactorLaws, ScalingChangesNothing) {
  for (const LawScene& scene : scenes()) {
    for (const double scale : {1e-3, 1e3}) {
      PolygonModel scaled = scene.model;
      for (Vec3d& v : scaled.vertices) v *= scale;
      expect_same(scene, scaled, unchanged(scaled), scale < 1 ? "in millimetres" : "in kilometres");
    }
  }
}

TEST_P(FormFactorLaws, RenumberingChangesNothing) {
  Dice dice(31);
  for (const LawScene& scene : scenes()) {
    std::vector<std::uint32_t> old_number = unchanged(scene.model), new_number = old_number;
    for (std::size_t k = old_number.size(); k > 1; --k) {
      std::swap(old_number[k - 1], old_number[static_cast<std::size_t>(dice.between(0, static_cast<double>(k)))]);
    }
    for (std::uint32_t k = 0; k < old_number.size(); ++k) new_number[old_number[k]] = k;
    PolygonModel shuffled = scene.model;
    for (std::size_t k = 0; k < old_number.size(); ++k) {
      ModelPolygon p = scene.model.polygons[old_number[k]];
      if (p.base) p.base = new_number[*p.base];
      if (p.combines_with) p.combines_with = new_number[*p.combines_with];
      shuffled.polygons[k] = std::move(p);
    }
    expect_same(scene, shuffled, new_number, "renumbered");
  }
}

std::string method_label(const testing::TestParamInfo<std::string_view>& info) {
  std::string label(info.param);
  std::erase(label, '-');
  return label;
}

INSTANTIATE_TEST_SUITE_P(Methods, FormFactorLaws,
                         testing::Values("point", "nusselt", "hemicube", "analytic", "adaptive", "ray-cast", "auto"),
                         method_label);

}  // namespace
}  // namespace penumbra
