// Both programs read a scene (here the built-in one, there the file that is written from it) and write a PNG of 800 x
// 600 pixels on two threads; the whole process is timed. Plain: one ray through the middle of each pixel, trees of rays
// up to 16 deep down to a weight of 1/1000. Anti-aliased: nine more rays in pixels that differ from a neighbour; how
// many those are is told, since the two measure contrast each in its own way.

#include <fmt/format.h>

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "penumbra/scene/builtin_scenes.h"
#include "section.h"

namespace penumbra::bench {
namespace {

std::string words(const Vec3d& v) { return fmt::format("<{:.6g},{:.6g},{:.6g}>", v.x, v.y, v.z); }
std::string words(const Rgb& c) { return words(Vec3d(c)); }

// POV-Ray's space is left-handed.
Vec3d left_handed(const Vec3d& v) { return {-v.x, v.y, v.z}; }

std::string texture(const Material& m, const Rgb& ambient) {
  if (m.transmission > 0) {
    const Rgb& c = m.base_colour;
    return fmt::format(
        "pigment {{ rgbf <{},{},{},1> }} finish {{ ambient 0 diffuse 0 reflection {{ 0,1 fresnel on }} conserve_energy "
        "}} interior {{ ior {} }}",
        c.x, c.y, c.z, m.ior);
  }
  // The square at the origin has the other colour there.
  const std::string pigment = m.checker_colour
                                  ? fmt::format("checker rgb {} rgb {}", words(*m.checker_colour), words(m.base_colour))
                                  : fmt::format("rgb {}", words(m.base_colour));
  const std::string gloss = m.specular > 0 ? "specular 0.8 roughness 0.02" : "";
  return fmt::format("pigment {{ {} }} finish {{ ambient {} diffuse 1 reflection {} {} }}", pigment, ambient.x,
                     m.mirror.x, gloss);
}

std::string povray_scene(const Scene& scene) {
  std::string out =
      "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 16 adc_bailout 0.001 ambient_light rgb 1 }\n";
  Rgb ambient(0);
  for (const Light& light : scene.lights) {
    if (const auto* point = std::get_if<PointLight>(&light.kind)) {
      out +=
          fmt::format("light_source {{ {} rgb {} }}\n", words(left_handed(point->position)), words(point->intensity));
    } else if (const auto* all = std::get_if<AmbientLight>(&light.kind)) {
      ambient += all->radiance;
    }
  }
  out += fmt::format("background {{ rgb {} }}\n", words(scene.environment->radiance));
  const Camera& camera = scene.cameras.at(0);
  const Vec3d eye(camera.to_world[3]);
  const Vec3d ahead = -Vec3d(camera.to_world[2]);
  const double vertical = std::get<PerspectiveLens>(camera.lens).vertical_fov;
  const double across = 2 * std::atan(std::tan(vertical / 2) * 4 / 3) * 180 / std::numbers::pi;
  out += fmt::format("camera {{ perspective location {} right x*4/3 up y angle {} look_at {} }}\n",
                     words(left_handed(eye)), across, words(left_handed(eye + ahead)));
  for (const ShapeObject& object : scene.shapes) {
    const std::string finish = texture(scene.materials[object.material], ambient);
    if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
      out += fmt::format("sphere {{ {}, {} {} }}\n", words(left_handed(sphere->centre)), sphere->radius, finish);
    } else if (const auto* plane = std::get_if<Plane>(&object.shape)) {
      out += fmt::format("plane {{ y, {} {} }}\n", plane->point.y, finish);
    }
  }
  return out;
}

bool is_installed(const char* program) {
  return std::system(fmt::format("command -v {} >/dev/null 2>&1", program).c_str()) == 0;
}

/// Samples beyond one a pixel, of all pixels: what POV-Ray says at its end, and what our report says.
double povray_extra(const std::string& log, double pixels) {
  std::ifstream in(log);
  double samples = 0;
  for (std::string word; in >> word;) {
    if (word == "Samples:") in >> samples;
  }
  return samples / pixels;
}
double our_extra(const std::string& stats) {
  const auto report = nlohmann::json::parse(std::ifstream(stats));
  return report["image"]["spp_mean"].get<double>() - 1;
}

Cost best_of(int runs, const std::string& command) {
  Cost best{1e30, 1e30};
  for (int i = 0; i < runs; ++i) {
    int status = 0;
    const Cost c = cost_of(RUSAGE_CHILDREN, [&] { status = std::system(command.c_str()); });
    if (status != 0) fmt::print("failed: {}\n", command);
    best = {std::min(best.wall, c.wall), std::min(best.cpu, c.cpu)};
  }
  return best;
}

}  // namespace

nlohmann::json compare_with_povray(const Arguments& a) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("bench_render_{}", getpid());
  std::filesystem::create_directories(folder);
  const std::string at = folder.string();
  std::ofstream(folder / "whitted.pov") << povray_scene(make_builtin_scene("whitted"));
  const bool has_povray = is_installed("povray");
  const int runs = a.quick ? 3 : 9;
  fmt::print("\nWhitted's still life, 800 x 600, two threads, whole process, best of {}\n", runs);
  if (!has_povray) fmt::print("povray is not installed; install Debian's package povray to compare\n");

  nlohmann::json report{{"povray_installed", has_povray}};
  struct Case {
    const char* name;
    const char* theirs;
    const char* ours;
  };
  const Case cases[] = {{"plain", "-A", "--spp 1"}, {"anti-aliased", "+A0.3 +R3", "--spp 9 --edge-contrast 0.4"}};
  for (const Case& c : cases) {
    const Cost ours =
        best_of(runs, fmt::format("{} render builtin:whitted --size 800x600 {} --threads 2 -q --stats {}/stats.json "
                                  "-o {}/{}.png",
                                  a.program, c.ours, at, at, c.name));
    fmt::print("{:>14}: penumbra {:.3f} s ({:.3f} cpu)", c.name, ours.wall, ours.cpu);
    nlohmann::json row{
        {"seconds", ours.wall}, {"cpu_seconds", ours.cpu}, {"extra_samples", our_extra(at + "/stats.json")}};
    if (has_povray) {
      const Cost theirs =
          best_of(a.quick ? 1 : 3, fmt::format("povray +I{}/whitted.pov +O{}/pov-{}.png +W800 +H600 +WT2 -D {} "
                                               ">{}/log 2>&1",
                                               at, at, c.name, c.theirs, at));
      fmt::print(", POV-Ray {:.3f} s ({:.3f} cpu): {:.1f} times faster ({:.1f} by cpu)", theirs.wall, theirs.cpu,
                 theirs.wall / ours.wall, theirs.cpu / ours.cpu);
      row["povray_extra_samples"] = povray_extra(at + "/log", 800.0 * 600.0);
      fmt::print("; {:.2f} samples more a pixel, POV-Ray {:.2f}", row["extra_samples"].get<double>(),
                 row["povray_extra_samples"].get<double>());
      row["povray_seconds"] = theirs.wall;
      row["povray_cpu_seconds"] = theirs.cpu;
      row["times_faster"] = theirs.wall / ours.wall;
      row["times_faster_cpu"] = theirs.cpu / ours.cpu;
    }
    fmt::print("\n");
    report[c.name] = row;
  }
  std::filesystem::remove_all(folder);
  return report;
}

}  // namespace penumbra::bench
