#include "ray_tree_text.h"

#include <fmt/format.h>

#include <cmath>

#include "penumbra/scene/object_label.h"
#include "penumbra/tracing/shading/light_sampling.h"

namespace penumbra::cli {
namespace {

std::string colour(const Rgb& c) { return fmt::format("{:.4g} {:.4g} {:.4g}", c.x, c.y, c.z); }

Report json_of(const Rgb& c) { return {c.x, c.y, c.z}; }
Report json_of(const Vec3d& v) { return {v.x, v.y, v.z}; }

std::string light_name(std::int32_t light, const Scene& scene) {
  const LightSampler lights(scene);
  const LightSampler::Source& source = lights.light(static_cast<std::size_t>(light));
  switch (source.kind) {
    case LightSampler::Kind::environment:
      return "the environment";
    case LightSampler::Kind::punctual:
      return scene.lights[source.index].name.empty() ? fmt::format("light {}", source.index + 1)
                                                     : "'" + scene.lights[source.index].name + "'";
    case LightSampler::Kind::mesh:
    case LightSampler::Kind::shape:
      return object_label(scene, source.index);
  }
  return "";
}

std::string split_text(const TreeRay::Split& s) {
  std::string text;
  const auto add = [&](const char* what, const Rgb& share) {
    if (is_black(share)) return;
    text += fmt::format("{}{} {:.3g} %", text.empty() ? "" : ", ", what, 100 * luminance(share));
  };
  add("reflects", s.reflected);
  add("refracts", s.refracted);
  add("scatters", s.diffuse);
  add("absorbs", s.absorbed);
  return text;
}

std::string line_of(const TreeRay& ray, const Scene& scene) {
  std::string text = fmt::format("{}: ", name_of(ray.kind));
  if (ray.direction == Vec3d(0)) return text + fmt::format("{} (weight {})", name_of(ray.end), colour(ray.weight));
  if (std::isfinite(ray.length)) text += fmt::format("{:.4g} m to ", ray.length);
  text += met_by(ray, scene);
  if (ray.kind == TreeRay::Kind::shadow) {
    return text + (ray.end == TreeRay::End::light ? fmt::format(", adds {}", colour(ray.radiance)) : std::string());
  }
  text += fmt::format("; weight {}; sees {}", colour(ray.weight), colour(ray.radiance));
  if (ray.split) text += fmt::format("; {}", split_text(*ray.split));
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

std::string met_by(const TreeRay& ray, const Scene& scene) {
  const auto named = [&] { return object_label(scene, static_cast<std::size_t>(ray.object)); };
  switch (ray.end) {
    case TreeRay::End::left_scene:
      return "the environment";
    case TreeRay::End::light:
      return fmt::format("the light {}", light_name(ray.light, scene));
    case TreeRay::End::hidden:
      return fmt::format("{}, which hides the light {}", ray.object == TreeRay::none ? "glass" : named(),
                         light_name(ray.light, scene));
    case TreeRay::End::surface:
      return ray.object == TreeRay::none ? std::string("a black back")
                                         : fmt::format("{} ({})", named(), ray.front ? "front" : "back");
    case TreeRay::End::energy_spent:
    case TreeRay::End::too_deep:
      break;
  }
  return std::string(name_of(ray.end));
}

std::string tree_as_text(const RayTree& tree, const Scene& scene) {
  std::string text;
  std::vector<int> indent(tree.rays.size(), 0);
  for (std::size_t i = 0; i < tree.rays.size(); ++i) {
    const TreeRay& ray = tree.rays[i];
    if (ray.parent != TreeRay::none) indent[i] = indent[static_cast<std::size_t>(ray.parent)] + 1;
    text += fmt::format("{:{}}{} {}\n", "", 2 * indent[i], i, line_of(ray, scene));
  }
  return text;
}

Report tree_as_json(const RayTree& tree, const Scene& scene) {
  Report rays = Report::array();
  for (const TreeRay& ray : tree.rays) {
    Report json{{"parent", ray.parent == TreeRay::none ? Report(nullptr) : Report(ray.parent)},
                {"kind", name_of(ray.kind)},
                {"end", name_of(ray.end)},
                {"depth", ray.depth},
                {"origin", json_of(ray.origin)},
                {"direction", ray.direction == Vec3d(0) ? Report(nullptr) : json_of(ray.direction)},
                {"length", std::isfinite(ray.length) ? Report(ray.length) : Report(nullptr)},
                {"weight", json_of(ray.weight)},
                {"radiance", json_of(ray.radiance)},
                {"met", met_by(ray, scene)}};
    if (ray.object != TreeRay::none) json["object"] = object_label(scene, static_cast<std::size_t>(ray.object));
    if (ray.material != TreeRay::none) json["material"] = scene.materials[static_cast<std::size_t>(ray.material)].name;
    if (ray.split) {
      json["split"] = {{"reflected", json_of(ray.split->reflected)},
                       {"refracted", json_of(ray.split->refracted)},
                       {"diffuse", json_of(ray.split->diffuse)},
                       {"absorbed", json_of(ray.split->absorbed)}};
    }
    rays.push_back(std::move(json));
  }
  return rays;
}

std::string tree_as_dot(const RayTree& tree, const Scene& scene) {
  std::string text = "digraph rays {\n  node [shape=box, fontname=\"sans-serif\"];\n  eye [shape=ellipse];\n";
  for (std::size_t i = 0; i < tree.rays.size(); ++i) {
    const TreeRay& ray = tree.rays[i];
    const std::string from = ray.parent == TreeRay::none ? std::string("eye") : fmt::format("n{}", ray.parent);
    const char* style = ray.kind == TreeRay::Kind::shadow ? ", style=dashed" : "";
    text += fmt::format("  n{} [label=\"{}\"{}];\n", i, escaped(met_by(ray, scene)), style);
    text +=
        fmt::format("  {} -> n{} [label=\"{} {:.3g}\"{}];\n", from, i, name_of(ray.kind), luminance(ray.weight), style);
  }
  return text + "}\n";
}

}  // namespace penumbra::cli
