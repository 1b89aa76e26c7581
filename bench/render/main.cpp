// How fast is the renderer, against what people would pick instead? Three questions, each answered in one run:
//
//   rays     rays per second of the whole renderer (appel, whitted, path) against a bare loop over Embree's single
//            rays, the same rays, on atrium?triangles=1000000
//   povray   Whitted's still life in POV-Ray and here, file to PNG, plain and anti-aliased
//   cornell  noise and time of the Cornell box, against Blender's Cycles
//
// What is not installed is said to be absent. On a busy machine read the ratios of processor time (cpu).
//
//   bench_render [--json FILE] [--quick] [--only rays|povray|cornell]

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "section.h"

int main(int count, char** words) {
  using namespace penumbra::bench;
  Arguments a;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--json" && i + 1 < count) a.json = words[++i];
    if (word == "--only" && i + 1 < count) a.only = words[++i];
    if (word == "--quick") a.quick = true;
  }
  a.program = (std::filesystem::canonical("/proc/self/exe").parent_path() / "penumbra").string();

  nlohmann::json report;
  if (a.only.empty() || a.only == "rays") report["rays"] = compare_ray_rates(a);
  if (a.only.empty() || a.only == "povray") report["povray"] = compare_with_povray(a);
  if (a.only.empty() || a.only == "cornell") report["cornell"] = compare_cornell_box(a);
  if (!a.json.empty()) std::ofstream(a.json) << report.dump(2) << '\n';
  return 0;
}
