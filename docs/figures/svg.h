#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra::figures {

/// How an outline is drawn; an empty `stroke` or `fill` is none.
struct Pen {
  std::string stroke = "#333";
  double width = 1;
  std::string fill;
  double opacity = 1;
  std::string dashes;
};

/// A drawing in pixels, y downwards, written as plain SVG with a white ground.
class Svg {
 public:
  Svg(double width, double height) : width_(width), height_(height) {}

  void line(const Vec2d& a, const Vec2d& b, const Pen& pen = {});
  void polyline(std::span<const Vec2d> points, const Pen& pen, bool closed = false);
  void circle(const Vec2d& centre, double radius, const Pen& pen);
  void arrow(const Vec2d& from, const Vec2d& to, const Pen& pen);
  /// @param anchor start, middle or end. @param turn degrees, counter-clockwise.
  void text(const Vec2d& at, std::string_view words, double size = 13, std::string_view anchor = "start",
            double turn = 0, std::string_view colour = "#222");

  /// Collects a rectangle; all of one colour become one path, which keeps pictures of many pixels small.
  void pixel(const Vec2d& corner, const Vec2d& size, const std::string& colour);
  /// The same for a polygon.
  void cell(std::span<const Vec2d> outline, const std::string& colour);
  void flush_pixels();

  void write(const std::filesystem::path& path);

 private:
  double width_, height_;
  std::string& path_of(const std::string& colour);
  std::string body_;
  std::vector<std::pair<std::string, std::string>> pixels_;  // colour, path
};

/// From dark blue (0) over green to yellow (1).
[[nodiscard]] std::string shade(double value);
/// Colours that are told apart, repeating after ten.
[[nodiscard]] std::string hue(std::size_t index);

/// Parallel projection onto a drawing: x to the lower right, y to the upper right, z up.
class Oblique {
 public:
  /// @param turn of the view about z, radians. @param lift of the eye above the horizon, radians.
  /// Scaled so that `points` fill the box from `corner`, `size` wide and high.
  Oblique(double turn, double lift, std::span<const Vec3d> points, const Vec2d& corner, const Vec2d& size);
  [[nodiscard]] Vec2d operator()(const Vec3d& p) const;
  [[nodiscard]] std::vector<Vec2d> operator()(std::span<const Vec3d> polygon) const;

 private:
  Vec3d right_, up_;
  double scale_ = 1;
  Vec2d origin_{0, 0};
};

/// Axes with logarithmic or even ticks, curves and their names.
class Plot {
 public:
  struct Axis {
    double from = 0, to = 1;
    std::string name;
    bool logarithmic = true;
    double base = 10;  ///< of the ticks on a logarithmic axis
    double step = 1;   ///< of the ticks: in powers of `base`, or in units on an even axis
  };
  Plot(Svg& svg, const Vec2d& corner, const Vec2d& size, Axis x, Axis y);

  void curve(std::span<const Vec2d> points, const std::string& colour, std::string_view name, bool dashed = false);
  /// A straight reference line through `through`, of the given slope on logarithms, between two abscissae.
  void slope(const Vec2d& through, double power, double from, double to, std::string_view name);
  [[nodiscard]] Vec2d place(const Vec2d& p) const;

 private:
  [[nodiscard]] double along(const Axis& axis, double value) const;
  void draw_axis_x();
  void draw_axis_y();
  Svg& svg_;
  Vec2d corner_, size_;
  Axis x_, y_;
  int named_ = 0;
};

}  // namespace penumbra::figures
