#include "penumbra/io/ies_reader.h"

#include <gtest/gtest.h>

#include <numbers>

#include "penumbra/file/file_error.h"
#include "penumbra/math/sampling.h"
#include "penumbra/scene/luminaire.h"

namespace penumbra {
namespace {

using std::numbers::pi;

std::string file(const std::string& sizes, const std::string& rest) {
  return "IESNA:LM-63-2002\r\n[TEST] none\r\n[LUMINAIRE] a lamp\r\nTILT=NONE\r\n" + sizes + "\r\n1 1 40\r\n" + rest;
}

std::string message(const std::string& text) {
  try {
    (void)parse_ies(text, "lamp.ies");
  } catch (const FileError& e) {
    return e.what();
  }
  return "";
}

// An even 100 cd in all directions is 400 pi lm.
TEST(IesReader, AnEvenPointOfOneHundredCandela) {
  const PhotometricWeb web = parse_ies(file("1 1000 1 3 1 1 2 0 0 0", "0 90 180\n0\n100 100 100\n"), "lamp.ies");
  EXPECT_EQ(web.name, "a lamp");
  EXPECT_EQ(web.vertical.size(), std::size_t{3});
  EXPECT_EQ(web.candela, (std::vector<double>{100, 100, 100}));
  EXPECT_NEAR(luminous_flux(web), 400 * pi, 1e-9);
}

// A Lambertian luminaire, I = I0 cos(theta) below its horizon: flux pi I0.
TEST(IesReader, FluxOfALambertianLuminaire) {
  std::string vertical, candela;
  for (int v = 0; v <= 180; ++v) {
    vertical += std::to_string(v) + (v % 10 == 0 ? "\n" : " ");
    candela += std::to_string(v < 90 ? 500 * std::cos(v * pi / 180) : 0.0) + " ";
  }
  const PhotometricWeb web = parse_ies(file("1 -1 1 181 1 1 2 0 0 0", vertical + "\n0\n" + candela), "lamp.ies");
  EXPECT_NEAR(luminous_flux(web), 500 * pi, 1e-4 * 500 * pi);
  EXPECT_NEAR(candela_at(web, 60, 123), 250, 1e-6);
}

// Candela multiplier, ballast factor and ballast-lamp factor all multiply.
TEST(IesReader, FactorsMultiply) {
  const std::string text =
      "IESNA91\nTILT=INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8\n1 1000 2 2 1 1 2 0 0 0\n0.9 0.5 40\n0 90\n0\n100 50\n";
  EXPECT_EQ(parse_ies(text, "lamp.ies").candela, (std::vector<double>{90, 45}));
}

// A lamp that loses light as it is tilted: full upright, 0.9 at 45 degrees, 0.8 lying; linear between.
TEST(IesReader, TiltedLuminairesLoseWhatTheirFactorsSay) {
  const std::string text =
      "IESNA91\nTILT=INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8\n1 1000 1 2 1 1 2 0 0 0\n1 1 40\n0 90\n0\n683 683\n";
  const PhotometricWeb web = parse_ies(text, "lamp.ies");
  const auto strength = [&](double degrees) {
    const double a = degrees * pi / 180;
    Scene scene;
    scene.lights = {{.name = "spot", .kind = SpotLight{.position = {}, .direction = {std::sin(a), -std::cos(a), 0}}}};
    wear_web(scene, 0, web);
    const auto& lamp = std::get<PointLight>(scene.lights[0].kind);
    return luminance(lamp.intensity) * candela_towards(scene.webs[0], *lamp.web, lamp.web->nadir);
  };
  EXPECT_NEAR(strength(0), 1, 1e-6);
  EXPECT_NEAR(strength(22.5), 0.95, 1e-6);
  EXPECT_NEAR(strength(60), 0.9 - 0.1 / 3, 1e-6);
  EXPECT_NEAR(strength(120), 0.8, 1e-6);
  EXPECT_NE(message("TILT=INCLUDE\n1\n2\n0 90\n1 -1\n1 1 1 2 1 1 2 0 0 0\n").find("tilt factor"), std::string::npos);
}

// Files of 1986 begin with whatever was written down.
TEST(IesReader, TheFirstEditionHasNoFirstLine) {
  const std::string text = "A street lantern\nmeasured in spring\nTILT=NONE\n1 1 1 2 1 1 1 0 0 0 1 1 70 0 180 0 7 8";
  EXPECT_EQ(parse_ies(text, "lamp.ies").candela, (std::vector<double>{7, 8}));
}

TEST(IesReader, SymmetricPlanesStandForTheOthers) {
  const PhotometricWeb quarter =
      parse_ies(file("1 1 1 2 3 1 2 0 0 0", "0 90 0 45 90  10 20  10 30  10 40"), "lamp.ies");
  for (const double h : {30.0, 150.0, 210.0, 330.0, -30.0}) {
    EXPECT_NEAR(candela_at(quarter, 90, h), 20 + 10 * 30.0 / 45, 1e-9) << h;
  }
  const PhotometricWeb half = parse_ies(file("1 1 1 2 3 1 2 0 0 0", "0 90 0 90 180  10 20  10 30  10 60"), "lamp.ies");
  EXPECT_NEAR(candela_at(half, 90, 135), 45, 1e-9);
  EXPECT_NEAR(candela_at(half, 90, 225), 45, 1e-9);
  const PhotometricWeb whole =
      parse_ies(file("1 1 1 2 5 1 2 0 0 0", "0 90 0 90 180 270 360  1 20  1 30  1 60  1 50  1 20"), "lamp.ies");
  EXPECT_NEAR(candela_at(whole, 90, 225), 55, 1e-9);
  EXPECT_NEAR(candela_at(whole, 45, 315), 0.5 * (1 + 35), 1e-9);
  const PhotometricWeb turned = parse_ies(file("1 1 1 2 3 1 2 0 0 0", "0 90 90 180 270  1 20  1 30  1 60"), "lamp.ies");
  EXPECT_NEAR(candela_at(turned, 90, 0), 30, 1e-9);
  EXPECT_NEAR(candela_at(turned, 90, 45), 25, 1e-9);
  EXPECT_NEAR(candela_at(turned, 90, 315), 45, 1e-9);
}

// The sum over directions of the sphere is the flux, whatever the web and however it hangs.
TEST(IesReader, CandelaOverTheSphereAreItsLumens) {
  const PhotometricWeb web = parse_ies(
      file("1 1 1 4 3 1 2 0 0 0", "0 30 60 90  0 45 90  900 500 200 0  900 600 100 20  900 300 250 10"), "lamp.ies");
  const WebPlacement placed{.web = 0, .nadir = normalize(Vec3d(1, -2, 0.5)), .zero = normalize(Vec3d(2, 1, 0))};
  double sum = 0;
  constexpr int n = 400;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      sum += candela_towards(web, placed, sample_sphere({(i + 0.5) / n, (j + 0.5) / n})) * 4 * pi / (n * n);
    }
  }
  EXPECT_NEAR(sum, luminous_flux(web), 2e-4 * sum);
  EXPECT_NEAR(candela_towards(web, placed, placed.nadir), 900, 1e-6);
}

TEST(IesReader, WhatIsWrongIsSaidWithItsLine) {
  EXPECT_NE(message("nothing of the kind\n").find("TILT="), std::string::npos);
  EXPECT_NE(message("TILT=lamp.tlt\n1").find("line 1"), std::string::npos);
  EXPECT_NE(message(file("1 1 1 2 1 2 2 0 0 0", "0 90 0 1 1")).find("type B"), std::string::npos);
  EXPECT_NE(message(file("1 1 1 2 1 1 2 0 0 0", "0 90\n0\n1 x\n")).find("line 9"), std::string::npos);
  EXPECT_NE(message(file("1 1 1 2 1 1 2 0 0 0", "0 90\n0\n1\n")).find("missing"), std::string::npos);
  EXPECT_NE(message(file("1 1 1 2 1 1 2 0 0 0", "90 0\n0\n1 1\n")).find("ascend"), std::string::npos);
  EXPECT_NE(message(file("1 1 1 2 2 1 2 0 0 0", "0 90\n0 77\n1 1 1 1\n")).find("horizontal"), std::string::npos);
  EXPECT_NE(message(file("1 1 1 2 1 1 2 0 0 0", "0 90\n0\n1 -1\n")).find("less than 0"), std::string::npos);
  EXPECT_NE(message(file("1 1 1 99999999 1 1 2 0 0 0", "0")).find("99999999"), std::string::npos);
}

TEST(IesReader, SpotLightsGiveTheirAxisAndTint) {
  Scene scene;
  scene.lights = {
      {.name = "spot", .kind = SpotLight{.position = {1, 2, 3}, .direction = {1, 0, 0}, .intensity = Rgb(2, 0, 0)}}};
  wear_web(scene, 0, parse_ies(file("1 1 1 2 1 1 2 0 0 0", "0 90 0 683 0"), "lamp.ies"));
  const auto& lamp = std::get<PointLight>(scene.lights[0].kind);
  ASSERT_TRUE(lamp.web);
  EXPECT_EQ(lamp.web->nadir, Vec3d(1, 0, 0));
  EXPECT_NEAR(dot(lamp.web->nadir, lamp.web->zero), 0, 1e-12);
  EXPECT_NEAR(luminance(lamp.intensity) * candela_towards(scene.webs[0], *lamp.web, {1, 0, 0}), 1, 1e-6);
  EXPECT_EQ(lamp.intensity.y, 0);
  EXPECT_NO_THROW(validate(scene));
}

}  // namespace
}  // namespace penumbra
