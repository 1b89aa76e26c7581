#include "penumbra/radiosity/form_factors/contact_factors.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "penumbra/radiosity/form_factors/adaptive.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/scene/polygon_model.h"
#include "radiosity/polygon_makers.h"

namespace penumbra {
namespace {

void add(PolygonModel& model, const Polygon& polygon, PolygonRole role = PolygonRole::radiates,
         std::optional<std::uint32_t> base = std::nullopt) {
  ModelPolygon p;
  p.role = role;
  p.base = base;
  for (const Vec3d& v : polygon) {
    p.corners.push_back(static_cast<std::uint32_t>(model.vertices.size()));
    model.vertices.push_back(v);
  }
  model.polygons.push_back(p);
}

const Polygon under_box = reversed(floor_rectangle(0.2, 0.5, 0.3, 0.8));

// A room and a box that stands on its floor (row 0) without a bottom of its own; what closes it is of kind `bottom`.
PolygonModel room_with_standing_box(PolygonRole bottom) {
  PolygonModel model;
  for (const Polygon& wall : room({1, 1, 1})) add(model, wall);
  std::vector<Polygon> box = reversed(room({0.3, 0.5, 0.4}));
  box.erase(box.begin());
  for (const Polygon& face : box) add(model, moved(face, {0.2, 0.3, 0}));
  add(model, under_box, bottom, 0U);
  return model;
}

FactorMatrix matrix_of(const PatchMesh& mesh, std::string_view method, double tolerance = 1e-6) {
  FormFactorOptions options;
  options.tolerance = tolerance;
  options.rays = 4096;
  return assemble_factor_matrix(*make_form_factor_method(method, mesh, options), mesh);
}

TEST(ContactFactors, AMaskSeesItsBaseAloneByEveryMethod) {
  const PatchMesh mesh = make_patch_mesh(room_with_standing_box(PolygonRole::covers)).mesh;
  ASSERT_EQ(mesh.surface_count(), 12U);
  EXPECT_NEAR(mesh.surfaces[0].area, 1, 1e-12);  // what is covered stays part of the floor
  EXPECT_NEAR(mesh.surfaces[11].area, 0.15, 1e-12);
  for (const std::string_view method : form_factor_method_names()) {
    const FactorMatrix m = matrix_of(mesh, method, 1e-3);
    for (std::size_t j = 0; j < m.rows(); ++j) {
      EXPECT_NEAR(m.at(11, j), j == 0 ? 1 : 0, 1e-12) << method << " " << j;
      EXPECT_NEAR(m.at(j, 11), j == 0 ? 0.15 : 0, 1e-12) << method << " " << j;
    }
  }
}

TEST(ContactFactors, RoomStaysClosed) {
  const PatchMesh mesh = make_patch_mesh(room_with_standing_box(PolygonRole::covers)).mesh;
  AdaptiveOptions options;
  options.tolerance = 1e-4;
  options.visibility = AdaptiveVisibility::bsp_tree;
  const FactorMatrix m = assemble_factor_matrix(*with_contacts(make_adaptive(mesh, options), mesh), mesh);
  for (std::size_t i = 0; i < m.rows(); ++i) EXPECT_NEAR(m.row_sum(i), 1, 1e-4) << i;
}

// A null surface takes the covered part out of the floor, a mask leaves it in: all other exchange is the same.
TEST(ContactFactors, OtherExchangeIsThatOfANullSurface) {
  const FactorMatrix masked = matrix_of(make_patch_mesh(room_with_standing_box(PolygonRole::covers)).mesh, "adaptive");
  const FactorMatrix nulled = matrix_of(make_patch_mesh(room_with_standing_box(PolygonRole::masks)).mesh, "adaptive");
  ASSERT_EQ(nulled.rows(), 11U);
  EXPECT_NEAR(nulled.areas[0], 0.85, 1e-12);
  for (std::size_t i = 0; i < 11; ++i) {
    for (std::size_t j = 0; j < 11; ++j) {
      EXPECT_NEAR(masked.areas[i] * masked.at(i, j), nulled.areas[i] * nulled.at(i, j), 1e-6) << i << " " << j;
    }
  }
}

std::string complaint(const PolygonModel& model, PatchSides sides = PatchSides::front) {
  PatchMeshOptions options;
  options.sides = sides;
  try {
    (void)make_patch_mesh(model, options);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(ContactFactors, MasksThatCannotBeAreRefused) {
  const auto room_with = [](const Polygon& mask) {
    PolygonModel model;
    for (const Polygon& wall : room({1, 1, 1})) add(model, wall);
    add(model, mask, PolygonRole::covers, 0U);
    return model;
  };
  EXPECT_NE(complaint(room_with(reversed(under_box))).find("reverse"), std::string::npos);
  EXPECT_NE(complaint(room_with(moved(under_box, {0.6, 0, 0}))).find("beyond"), std::string::npos);
  EXPECT_NE(complaint(room_with(moved(under_box, {0, 0, 0.1}))).find("plane"), std::string::npos);
  PolygonModel without_base = room_with(under_box);
  without_base.polygons.back().base.reset();
  EXPECT_NE(complaint(without_base).find("base"), std::string::npos);
  EXPECT_NE(complaint(room_with(under_box), PatchSides::both).find("fronts"), std::string::npos);
  EXPECT_EQ(complaint(room_with(under_box)), "");
}

TEST(ContactFactors, AMeshWithoutContactsKeepsItsMethod) {
  const PatchMesh mesh = make_patch_mesh(room_with_standing_box(PolygonRole::masks)).mesh;
  EXPECT_TRUE(mesh.contacts.empty());
  auto method = make_form_factor_method("auto", mesh);
  const FormFactorMethod* const inner = method.get();
  EXPECT_EQ(with_contacts(std::move(method), mesh).get(), inner);
}

}  // namespace
}  // namespace penumbra
