#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"

namespace penumbra::test {
namespace {

// The long triangular duct of the textbooks (Incropera: a paint oven), by its crossed-strings factors.
const std::string duct =
    "i,j,from,to,area,factor\n0,1,heater,panel,1,0.5\n0,2,heater,wall,1,0.5\n1,0,panel,heater,1,0.5\n"
    "1,2,panel,wall,1,0.5\n2,0,wall,heater,1,0.5\n2,1,wall,panel,1,0.5\n";

std::vector<std::string> words_of(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(name + ",")) continue;
    std::vector<std::string> words;
    std::istringstream in(line);
    for (std::string word; std::getline(in, word, ',');) words.push_back(word);
    return words;
  }
  return {};
}

TEST(ExchangeCommand, SolvesThePaintOven) {
  const Workshop shop;
  const std::string factors = shop.file("duct.csv", duct);
  // By name, in another order than the factors'.
  const std::string surfaces = shop.file(
      "surfaces.csv", "name,emissivity,temperature_K,heat_flux_W_m2\nwall,0.8,,0\nheater,0.8,1200,\npanel,0.4,500,\n");
  const Outcome run = penumbra({"exchange", factors, "--surfaces", surfaces, "-o", shop.path("heat.csv"), "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const std::string text = read_text(shop.path("heat.csv"));
  EXPECT_TRUE(
      text.starts_with("name,area_m2,emissivity,temperature_K,radiosity_W_m2,irradiance_W_m2,heat_flux_W_m2,heat_W\n"));
  EXPECT_NEAR(std::stod(words_of(text, "wall")[3]), 1102.17338, 1e-3);
  EXPECT_NEAR(std::stod(words_of(text, "heater")[7]), 36984.94, 0.5);
  const auto balance = run.report()["balance_W"];
  EXPECT_NEAR(balance["supplied"].get<double>(), -balance["removed"].get<double>(), 1e-6);
  EXPECT_LT(std::abs(balance["imbalance"].get<double>()), 1e-6);
}

// From geometry to heat: a black cube whose floor is warm and whose other walls are at 0 K gives away sigma T^4.
TEST(ExchangeCommand, TakesTheFactorsOfTheFactorsCommand) {
  const Workshop shop;
  for (const std::string name : {"f.npz", "f.mtx", "f.csv"}) {
    ASSERT_EQ(
        penumbra({"factors", "builtin:box345?cubes=0", "-o", shop.path(name), "--surfaces", "material", "-q"}).code, 0);
    const std::string surfaces = shop.file("s.csv", "name,emissivity,temperature_K\nwall,1,0\nlamp,1,1000\n");
    const Outcome run =
        penumbra({"exchange", shop.path(name), "--surfaces", surfaces, "--enclosure", "-o", shop.path("h.csv"), "-q"});
    ASSERT_EQ(run.code, 0) << run.err;
    const auto lamp = words_of(read_text(shop.path("h.csv")), "lamp");
    EXPECT_NEAR(std::stod(lamp[6]), 5.670374419e-8 * 1e12, 1e-6 * 5.67e4) << name;
  }
}

TEST(ExchangeCommand, SaysWhatIsWrongAndWhere) {
  const Workshop shop;
  const std::string factors = shop.file("duct.csv", duct);
  const auto refuses = [&](const std::string& table, const std::string& because) {
    const std::string surfaces = shop.file("s.csv", table);
    const Outcome run = penumbra({"exchange", factors, "--surfaces", surfaces, "-o", shop.path("h.csv")});
    EXPECT_EQ(run.code, 2) << table;
    EXPECT_NE(run.err.find(because), std::string::npos) << run.err;
  };
  refuses("name,emissivity,temperature_K\nheater,0.8,1200\npanel,0.4,500\n", "does not describe surface wall");
  refuses("name,emissivity,temperature_K\nheater,0.8,1200\npannel,0.4,500\nwall,1,1\n", "did you mean panel?");
  refuses("name,emissivity,temperature_K\nheater,0.8,hot\npanel,0.4,500\nwall,1,1\n", "line 2");
  refuses("name,emissivity,temperature_K\nheater,1.8,1200\npanel,0.4,500\nwall,1,1\n", "from 0 to 1");
  refuses("name,emissivity,temperature_K\nheater,0.8,1200\nheater,0.4,500\nwall,1,1\n", "described twice");
  refuses("name,emissivity\nheater,0.8\n", "temperature_K or heat_flux_W_m2");
  refuses("name,emissivity,temperature_K,heat_flux_W_m2\nheater,1,,1\npanel,1,,2\nwall,1,,-3\n", "give at least one");
  EXPECT_EQ(penumbra({"exchange", factors, "-o", shop.path("h.csv")}).code, 2);
  EXPECT_EQ(penumbra({"exchange", factors, "--surfaces", factors, "-o", shop.path("h.txt")}).code, 2);
}

}  // namespace
}  // namespace penumbra::test
