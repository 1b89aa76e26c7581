#include "svg.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "penumbra/file/output_file.h"

namespace penumbra::figures {
namespace {

// One digit after the point is a tenth of a pixel.
std::string in_tenths(double value) {
  std::string s = fmt::format("{:.1f}", value);
  if (s.size() > 2 && s.ends_with(".0")) s.resize(s.size() - 2);
  return s == "-0" ? "0" : s;
}

std::string style(const Pen& pen) {
  std::string s = pen.fill.empty() ? " fill=\"none\"" : fmt::format(" fill=\"{}\"", pen.fill);
  if (!pen.stroke.empty()) s += fmt::format(" stroke=\"{}\" stroke-width=\"{}\"", pen.stroke, pen.width);
  if (!pen.dashes.empty()) s += fmt::format(" stroke-dasharray=\"{}\"", pen.dashes);
  if (pen.opacity < 1) s += fmt::format(" opacity=\"{}\"", pen.opacity);
  return s;
}

std::string escaped(std::string_view words) {
  std::string s;
  for (const char c : words) {
    if (c == '<') {
      s += "&lt;";
    } else if (c == '&') {
      s += "&amp;";
    } else {
      s += c;
    }
  }
  return s;
}

std::string tick_label(const Plot::Axis& axis, double value, double power) {
  if (!axis.logarithmic) return fmt::format("{:g}", value);
  if (axis.base == 10 && (power < -2 || power > 3)) {
    return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{:g}</tspan>", power);
  }
  return fmt::format("{:g}", value);
}

}  // namespace

void Svg::line(const Vec2d& a, const Vec2d& b, const Pen& pen) {
  body_ += fmt::format("<path d=\"M{} {}L{} {}\"{}/>\n", in_tenths(a.x), in_tenths(a.y), in_tenths(b.x), in_tenths(b.y),
                       style(pen));
}

void Svg::polyline(std::span<const Vec2d> points, const Pen& pen, bool closed) {
  std::string d;
  for (const Vec2d& p : points) d += fmt::format("{}{} {}", d.empty() ? 'M' : 'L', in_tenths(p.x), in_tenths(p.y));
  body_ += fmt::format("<path d=\"{}{}\"{} stroke-linejoin=\"round\"/>\n", d, closed ? "Z" : "", style(pen));
}

void Svg::circle(const Vec2d& centre, double radius, const Pen& pen) {
  body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>\n", in_tenths(centre.x), in_tenths(centre.y),
                       in_tenths(radius), style(pen));
}

void Svg::arrow(const Vec2d& from, const Vec2d& to, const Pen& pen) {
  const Vec2d d = to - from;
  const double l = std::hypot(d.x, d.y);
  if (!(l > 0)) return;
  const Vec2d u = d / l, v(-u.y, u.x);
  const double head = 5 + pen.width;
  line(from, to - 0.8 * head * u, pen);
  const std::array<Vec2d, 3> tip{to, to - head * u + 0.45 * head * v, to - head * u - 0.45 * head * v};
  polyline(tip, {"", 0, pen.stroke, pen.opacity, ""}, true);
}

void Svg::text(const Vec2d& at, std::string_view words, double size, std::string_view anchor, double turn,
               std::string_view colour) {
  const bool marked = words.find("<tspan") != std::string_view::npos;
  body_ +=
      fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{}\"{}>{}</text>\n",
                  in_tenths(at.x), in_tenths(at.y), size, anchor, colour,
                  turn == 0 ? std::string()
                            : fmt::format(" transform=\"rotate({} {} {})\"", -turn, in_tenths(at.x), in_tenths(at.y)),
                  marked ? std::string(words) : escaped(words));
}

std::string& Svg::path_of(const std::string& colour) {
  auto found = std::find_if(pixels_.begin(), pixels_.end(), [&](const auto& p) { return p.first == colour; });
  if (found == pixels_.end()) found = pixels_.insert(pixels_.end(), {colour, ""});
  return found->second;
}

void Svg::pixel(const Vec2d& corner, const Vec2d& size, const std::string& colour) {
  path_of(colour) += fmt::format("M{} {}h{}v{}h-{}z", in_tenths(corner.x), in_tenths(corner.y), in_tenths(size.x),
                                 in_tenths(size.y), in_tenths(size.x));
}

void Svg::cell(std::span<const Vec2d> outline, const std::string& colour) {
  std::string& path = path_of(colour);
  char step = 'M';
  for (const Vec2d& p : outline) {
    path += fmt::format("{}{} {}", step, in_tenths(p.x), in_tenths(p.y));
    step = 'L';
  }
  path += 'z';
}

void Svg::flush_pixels() {
  for (const auto& [colour, path] : pixels_) {
    body_ += fmt::format("<path d=\"{}\" fill=\"{}\" shape-rendering=\"crispEdges\"/>\n", path, colour);
  }
  pixels_.clear();
}

void Svg::write(const std::filesystem::path& path) {
  OutputFile file(path);
  file.write(
      fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
                  "{1}\" font-family=\"DejaVu Sans,Arial,sans-serif\">\n<rect width=\"{0}\" height=\"{1}\" "
                  "fill=\"#fff\"/>\n{2}</svg>\n",
                  width_, height_, body_));
  file.commit();
}

std::string shade(double value) {
  constexpr std::array<std::array<double, 3>, 6> stops{
      {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}, {253, 231, 37}}};
  const double at = std::clamp(value, 0.0, 1.0) * 5;
  const auto k = std::min<std::size_t>(4, static_cast<std::size_t>(at));
  const double t = at - static_cast<double>(k);
  std::array<int, 3> c{};
  for (std::size_t i = 0; i < 3; ++i) c[i] = static_cast<int>(std::lround((1 - t) * stops[k][i] + t * stops[k + 1][i]));
  return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
}

std::string hue(std::size_t index) {
  constexpr std::array<const char*, 10> colours{"#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#76b7b2",
                                                "#edc948", "#b07aa1", "#ff9da7", "#9c755f", "#bab0ac"};
  return colours[index % colours.size()];
}

Oblique::Oblique(double turn, double lift, std::span<const Vec3d> points, const Vec2d& corner, const Vec2d& size)
    : right_(-std::sin(turn), std::cos(turn), 0),
      up_(-std::sin(lift) * std::cos(turn), -std::sin(lift) * std::sin(turn), std::cos(lift)) {
  Vec2d lower(1e300), upper(-1e300);
  for (const Vec3d& p : points) {
    const Vec2d q = (*this)(p);
    lower = Vec2d(std::min(lower.x, q.x), std::min(lower.y, q.y));
    upper = Vec2d(std::max(upper.x, q.x), std::max(upper.y, q.y));
  }
  scale_ = std::min(size.x / (upper.x - lower.x), size.y / (upper.y - lower.y));
  origin_ = corner + 0.5 * size - 0.5 * scale_ * (lower + upper);
}

Vec2d Oblique::operator()(const Vec3d& p) const {
  return {origin_.x + scale_ * dot(right_, p), origin_.y - scale_ * dot(up_, p)};
}

std::vector<Vec2d> Oblique::operator()(std::span<const Vec3d> polygon) const {
  std::vector<Vec2d> out;
  for (const Vec3d& p : polygon) out.push_back((*this)(p));
  return out;
}

Plot::Plot(Svg& svg, const Vec2d& corner, const Vec2d& size, Axis x, Axis y)
    : svg_(svg), corner_(corner), size_(size), x_(std::move(x)), y_(std::move(y)) {
  draw_axis_x();
  draw_axis_y();
  const std::array<Vec2d, 4> frame{corner, corner + Vec2d(size.x, 0), corner + size, corner + Vec2d(0, size.y)};
  svg_.polyline(frame, {"#888", 1, "", 1, ""}, true);
}

double Plot::along(const Axis& axis, double value) const {
  if (!axis.logarithmic) return (value - axis.from) / (axis.to - axis.from);
  return std::log(value / axis.from) / std::log(axis.to / axis.from);
}

Vec2d Plot::place(const Vec2d& p) const {
  return {corner_.x + size_.x * along(x_, p.x), corner_.y + size_.y * (1 - along(y_, p.y))};
}

namespace {

struct Tick {
  double value, power;
};

std::vector<Tick> ticks_of(const Plot::Axis& axis) {
  std::vector<Tick> ticks;
  if (axis.logarithmic) {
    const double scale = std::log(axis.base);
    for (double p = std::ceil(std::log(axis.from) / scale - 1e-9); p <= std::log(axis.to) / scale + 1e-9;
         p += axis.step) {
      ticks.push_back({std::pow(axis.base, p), p});
    }
  } else {
    for (double v = axis.from; v <= axis.to + 1e-9 * axis.step; v += axis.step) ticks.push_back({v, 0});
  }
  return ticks;
}

}  // namespace

void Plot::draw_axis_x() {
  for (const Tick& tick : ticks_of(x_)) {
    const double x = corner_.x + size_.x * along(x_, tick.value);
    svg_.line({x, corner_.y}, {x, corner_.y + size_.y}, {"#e4e4e4", 1, "", 1, ""});
    svg_.text({x, corner_.y + size_.y + 17}, tick_label(x_, tick.value, tick.power), 12, "middle");
  }
  svg_.text({corner_.x + size_.x / 2, corner_.y + size_.y + 37}, x_.name, 13, "middle");
}

void Plot::draw_axis_y() {
  for (const Tick& tick : ticks_of(y_)) {
    const double y = corner_.y + size_.y * (1 - along(y_, tick.value));
    svg_.line({corner_.x, y}, {corner_.x + size_.x, y}, {"#e4e4e4", 1, "", 1, ""});
    svg_.text({corner_.x - 7, y + 4}, tick_label(y_, tick.value, tick.power), 12, "end");
  }
  svg_.text({corner_.x - 46, corner_.y + size_.y / 2}, y_.name, 13, "middle", 90);
}

void Plot::curve(std::span<const Vec2d> points, const std::string& colour, std::string_view name, bool dashed) {
  std::vector<Vec2d> placed;
  for (const Vec2d& p : points) placed.push_back(place(p));
  svg_.polyline(placed, {colour, 2, "", 1, dashed ? "6 4" : ""});
  if (!dashed) {
    for (const Vec2d& p : placed) svg_.circle(p, 3, {"", 0, colour, 1, ""});
  }
  // The names stand to the right of the plot, in the order of the curves.
  const Vec2d at(corner_.x + size_.x + 14, corner_.y + 14 + 22 * named_++);
  svg_.line(at - Vec2d(0, 4), at + Vec2d(22, -4), {colour, 2, "", 1, dashed ? "6 4" : ""});
  svg_.text(at + Vec2d(28, 0), name, 12);
}

void Plot::slope(const Vec2d& through, double power, double from, double to, std::string_view name) {
  const auto at = [&](double x) { return Vec2d(x, through.y * std::pow(x / through.x, power)); };
  svg_.line(place(at(from)), place(at(to)), {"#999", 1.2, "", 1, "3 3"});
  svg_.text(place(at(to)) + Vec2d(-4, -7), name, 11, "end", 0, "#666");
}

}  // namespace penumbra::figures
