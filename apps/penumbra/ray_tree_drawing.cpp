#include "ray_tree_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "penumbra/math/bounds.h"
#include "penumbra/math/frame.h"
#include "penumbra/radiosity/leaks/face_net.h"
#include "ray_tree_text.h"

namespace penumbra::cli {
namespace {

constexpr double page_width = 960;  // px
constexpr double text_height = 18;  // px, a line
constexpr double crease = 0.35;     // rad
constexpr std::size_t most_outlines = 20000;
constexpr int circle_corners = 72;

/// A flat view of the world: one axis is looked along.
class Sheet {
 public:
  Sheet(const RayTree& tree, double far) : far_(far) {
    Vec3d lost(0);
    for (const TreeRay& ray : tree.rays) {
      lost += std::sqrt(static_cast<double>(luminance(ray.weight))) * glm::abs(end_of(ray) - ray.origin);
    }
    // The axis looked along, and those that run right and up: a map from above, a front or a side view.
    axis_ = lost.y <= std::min(lost.x, lost.z) ? 1 : lost.z <= lost.x ? 2 : 0;
    right_ = axis_ == 0 ? 2 : 0;
    up_ = axis_ == 1 ? 2 : 1;
    down_ = axis_ == 1;  // a map has the far side (-z) at its top
    Vec2d low(1e300), high(-1e300);
    for (const TreeRay& ray : tree.rays) {
      for (const Vec3d& p : {ray.origin, end_of(ray)}) {
        low = glm::min(low, flat(p));
        high = glm::max(high, flat(p));
      }
    }
    const double margin = 0.12 * std::max({high.x - low.x, high.y - low.y, 1e-9});
    low_ = low - margin;
    const Vec2d size = high - low + 2 * margin;
    scale_ = page_width / size.x;
    height_ = std::clamp(size.y * scale_, 0.25 * page_width, 1.0 * page_width);
    scale_ = std::min(scale_, height_ / size.y);
    shift_ = (Vec2d(page_width, height_) - size * scale_) / 2.0;
  }

  [[nodiscard]] Vec3d end_of(const TreeRay& ray) const {
    return ray.origin + std::min(ray.length, far_) * ray.direction;
  }
  /// Pixels of the page.
  [[nodiscard]] Vec2d place(const Vec3d& p) const { return (flat(p) - low_) * scale_ + shift_; }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] int axis() const { return axis_; }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] bool shows(const Vec2d& a, const Vec2d& b) const {
    return std::max(a.x, b.x) >= 0 && std::min(a.x, b.x) <= page_width && std::max(a.y, b.y) >= 0 &&
           std::min(a.y, b.y) <= height_;
  }

 private:
  [[nodiscard]] Vec2d flat(const Vec3d& p) const { return {p[right_], down_ ? p[up_] : -p[up_]}; }

  double far_;
  int axis_ = 1, right_ = 0, up_ = 2;
  bool down_ = false;
  Vec2d low_{0}, shift_{0};
  double scale_ = 1, height_ = 0;
};

/// Lines of the scene, in pixels.
struct Outline {
  Vec2d a, b;
};

void add_circle(const Sheet& sheet, const Vec3d& centre, const Vec3d& normal, double radius,
                std::vector<Outline>& lines) {
  const Frame frame(normal);
  const auto at = [&](int k) {
    const double angle = 2 * std::numbers::pi * k / circle_corners;
    return sheet.place(centre + radius * (std::cos(angle) * frame.tangent + std::sin(angle) * frame.bitangent));
  };
  for (int k = 0; k < circle_corners; ++k) lines.push_back({at(k), at(k + 1)});
}

class ShapeOutlines {
 public:
  ShapeOutlines(const Sheet& sheet, std::vector<Outline>& lines) : sheet_(sheet), lines_(lines) {
    along_[sheet.axis()] = 1;
  }

  void operator()(const Sphere& s) const { add_circle(sheet_, s.centre, along_, s.radius, lines_); }
  void operator()(const Disk& d) const { add_circle(sheet_, d.centre, d.normal, d.radius, lines_); }
  void operator()(const Cylinder& c) const {
    const Vec3d axis = normalize(c.top - c.base);
    add_circle(sheet_, c.base, axis, c.radius, lines_);
    add_circle(sheet_, c.top, axis, c.radius, lines_);
    const Vec3d side = cross(axis, along_);
    if (length(side) < 1e-9) return;
    for (const double sign : {-1.0, 1.0}) {
      const Vec3d shift = sign * c.radius * normalize(side);
      lines_.push_back({sheet_.place(c.base + shift), sheet_.place(c.top + shift)});
    }
  }
  // A plane is a line where it is seen edge on.
  void operator()(const Plane& p) const {
    if (std::abs(dot(p.normal, along_)) > 1e-6) return;
    const Vec3d run = 1e4 * normalize(cross(p.normal, along_));
    lines_.push_back({sheet_.place(p.point - run), sheet_.place(p.point + run)});
  }

 private:
  const Sheet& sheet_;
  std::vector<Outline>& lines_;
  Vec3d along_{0};
};

// Borders, creases, and edges between what looks at the viewer and what looks away.
bool is_outline(const FaceNet& net, const FaceNet::Edge& edge, int axis) {
  if (edge.faces.size() != 2) return true;
  const Vec3d& a = net.normals[edge.faces[0]];
  const Vec3d& b = net.normals[edge.faces[1]];
  return dot(a, b) < std::cos(crease) || (a[axis] > 1e-9) != (b[axis] > 1e-9);
}

std::vector<Outline> outlines(const Scene& scene, const Sheet& sheet) {
  std::vector<Outline> lines;
  const FaceNet net = make_face_net(scene);
  for (const FaceNet::Edge& edge : net.edges) {
    if (!is_outline(net, edge, sheet.axis())) continue;
    const Outline line{sheet.place(net.vertices[edge.from]), sheet.place(net.vertices[edge.to])};
    if (sheet.shows(line.a, line.b)) lines.push_back(line);
  }
  for (const ShapeObject& object : scene.shapes) std::visit(ShapeOutlines(sheet, lines), object.shape);
  if (lines.size() > most_outlines) {
    const auto longer = [](const Outline& x, const Outline& y) { return length(x.b - x.a) > length(y.b - y.a); };
    std::nth_element(lines.begin(), lines.begin() + most_outlines, lines.end(), longer);
    lines.resize(most_outlines);
  }
  return lines;
}

const char* colour_of(const TreeRay& ray) {
  switch (ray.kind) {
    case TreeRay::Kind::primary:
      return "#222222";
    case TreeRay::Kind::reflection:
      return "#1f5fbf";
    case TreeRay::Kind::refraction:
      return "#1d8a3f";
    case TreeRay::Kind::shadow:
      return ray.end == TreeRay::End::light ? "#e08a00" : "#b0423a";
  }
  return "";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string draw_ray(const TreeRay& ray, std::size_t number, const Sheet& sheet) {
  const Vec2d a = sheet.place(ray.origin), b = sheet.place(sheet.end_of(ray));
  const Vec2d middle = 0.5 * (a + b);
  const bool shadow = ray.kind == TreeRay::Kind::shadow;
  // Thicker rays carry more; half of the dynamic range is shown by a factor of 4.
  const double width = 0.8 + 1.6 * std::sqrt(std::clamp<double>(luminance(ray.weight), 0, 1));
  return fmt::format(
      "<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" stroke=\"{}\" stroke-width=\"{:.2f}\"{} "
      "marker-end=\"url(#arrow)\"/>\n<text x=\"{:.2f}\" y=\"{:.2f}\" fill=\"{}\" paint-order=\"stroke\" "
      "stroke=\"white\" stroke-width=\"3\">{}</text>\n",
      a.x, a.y, b.x, b.y, colour_of(ray), width, shadow ? " stroke-dasharray=\"5 4\"" : "", middle.x + 3, middle.y - 3,
      colour_of(ray), number);
}

}  // namespace

std::string tree_as_svg(const RayTree& tree, const Scene& scene, const std::string& title) {
  double longest = 0;
  for (const TreeRay& ray : tree.rays) {
    if (std::isfinite(ray.length)) longest = std::max(longest, ray.length);
  }
  const Sheet sheet(tree, longest > 0 ? 0.6 * longest + 1e-6 : std::max(1.0, scene.bounds().diagonal()));
  std::string drawing;
  for (const Outline& line : outlines(scene, sheet)) {
    drawing += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", line.a.x, line.a.y, line.b.x, line.b.y);
  }
  drawing = fmt::format("<path d=\"{}\" stroke=\"#b8b8b8\" stroke-width=\"1\" fill=\"none\"/>\n", drawing);
  for (std::size_t i = 0; i < tree.rays.size(); ++i) {
    if (tree.rays[i].direction != Vec3d(0)) drawing += draw_ray(tree.rays[i], i, sheet);
  }
  const Vec2d eye = sheet.place(tree.rays[0].origin);
  drawing += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"5\" fill=\"#222222\"/>\n", eye.x, eye.y);

  std::string list;
  double y = sheet.height() + 2 * text_height;
  std::istringstream lines(tree_as_text(tree, scene));
  for (std::string line; std::getline(lines, line); y += text_height) {
    const std::size_t indent = line.find_first_not_of(' ');
    const auto number = static_cast<std::size_t>(std::stoul(line.substr(indent)));
    list += fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\" font-size=\"11\">{}</text>\n", 12 + 9 * indent, y,
                        colour_of(tree.rays[number]), escaped(line.substr(indent)));
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"13\">\n<title>{2}</title>\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"white\"/>\n<defs><marker id=\"arrow\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"7\" "
      "markerHeight=\"7\" markerUnits=\"userSpaceOnUse\" orient=\"auto\"><path d=\"M0 0L8 4L0 8z\" "
      "fill=\"#444444\"/></marker><clipPath id=\"sheet\"><rect width=\"{0}\" height=\"{3}\"/></clipPath></defs>\n"
      "<g clip-path=\"url(#sheet)\">\n{4}</g>\n<text x=\"12\" y=\"{5}\" font-weight=\"bold\">{2}</text>\n{6}</svg>\n",
      page_width, y + text_height, escaped(title), sheet.height(), drawing, sheet.height() + text_height, list);
}

}  // namespace penumbra::cli
