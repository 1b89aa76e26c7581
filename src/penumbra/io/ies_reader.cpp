#include "penumbra/io/ies_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/io/text_cursor.h"

namespace penumbra {
namespace {

constexpr std::int64_t most_angles = 10000;
constexpr double most_candela = 1e30;
constexpr std::size_t most_bytes = std::size_t{64} << 20;

/// Reads one file; the steps follow its layout.
class IesReader {
 public:
  IesReader(std::string_view text, const std::string& path) : cursor_(path, text) {}

  PhotometricWeb read() {
    read_head();
    read_sizes();
    web_.vertical = angles(vertical_count_, "vertical angle");
    check_vertical();
    web_.horizontal = angles(horizontal_count_, "horizontal angle");
    read_candela();
    unfold();
    return std::move(web_);
  }

 private:
  double number(std::string_view what) { return cursor_.number(cursor_.word(), what); }
  std::int64_t count(std::string_view what, std::int64_t least = 1) {
    return cursor_.integer(cursor_.word(), what, least, most_angles);
  }

  // Labels and keywords up to the line TILT=; files of 1986 have no first line of their own.
  void read_head() {
    while (cursor_.seek_word()) {
      const std::string line(cursor_.rest_of_line());
      if (line.starts_with("[LUMINAIRE]")) web_.name = line.substr(std::min(line.size(), std::size_t{12}));
      if (!line.starts_with("TILT=")) continue;
      if (line == "TILT=NONE") return;
      if (line != "TILT=INCLUDE") {
        cursor_.fail(in_quotes(line) + " names a file of tilt factors, which is not read; put TILT=NONE there");
      }
      (void)number("lamp-to-luminaire geometry");
      const auto pairs = static_cast<std::size_t>(count("number of tilt angles"));
      web_.tilt = angles(pairs, "tilt angle");
      for (std::size_t i = 0; i < pairs; ++i) {
        web_.tilt_factors.push_back(number("tilt factor"));
        if (!(web_.tilt_factors[i] >= 0)) cursor_.fail("a tilt factor is less than 0");
      }
      return;
    }
    cursor_.fail("has no line TILT=, so it is no photometric file of IES LM-63");
  }

  void read_sizes() {
    (void)number("number of lamps");
    (void)number("lumens per lamp");
    factor_ = number("candela multiplier");
    vertical_count_ = static_cast<std::size_t>(count("number of vertical angles"));
    horizontal_count_ = static_cast<std::size_t>(count("number of horizontal angles"));
    const std::int64_t type = count("photometric type");
    if (type != 1) {
      cursor_.fail(
          fmt::format("is photometry of type {}; only type C (1) is read, which luminaires for rooms and "
                      "streets have",
                      type == 2   ? "B (2)"
                      : type == 3 ? "A (3)"
                                  : std::to_string(type)));
    }
    (void)count("unit of length");
    for (const char* what : {"width", "length", "height"}) (void)number(what);
    factor_ *= number("ballast factor");
    const double later = number("ballast-lamp photometric factor");
    if (later > 0) factor_ *= later;  // of later editions a number for future use, which is 1
    (void)number("input watts");
    if (!(factor_ > 0)) cursor_.fail("its candela multiplier times its ballast factors must be more than 0");
  }

  std::vector<double> angles(std::size_t size, std::string_view what) {
    std::vector<double> all;
    for (std::size_t i = 0; i < size; ++i) {
      all.push_back(number(what));
      if (i > 0 && !(all[i] > all[i - 1])) {
        cursor_.fail(
            fmt::format("{} {} is {}, which does not follow {}; angles must ascend", what, i + 1, all[i], all[i - 1]));
      }
    }
    return all;
  }

  void check_vertical() {
    if (web_.vertical.front() < 0 || web_.vertical.back() > 180) {
      cursor_.fail("its vertical angles must lie within 0 to 180 degrees");
    }
  }

  void read_candela() {
    for (std::size_t i = 0; i < vertical_count_ * horizontal_count_; ++i) {
      const double candela = factor_ * number("candela value");
      if (!(candela >= 0)) cursor_.fail("a candela value is less than 0");
      if (!(candela <= most_candela)) cursor_.fail("a candela value is beyond 1e30");
      web_.candela.push_back(candela);
    }
  }

  // Planes from 90 to 270 degrees are mirrored at the plane through both; other symmetries stay as they are.
  void unfold() {
    const double first = web_.horizontal.front(), last = web_.horizontal.back();
    if (first == 0 && (last == 0 || last == 90 || last == 180 || last == 360)) return;
    if (first != 90 || last != 270) {
      cursor_.fail(
          fmt::format("its horizontal angles run from {} to {}; they must run from 0 to 0, 90, 180 or 360, or "
                      "from 90 to 270",
                      first, last));
    }
    std::map<double, std::size_t> plane_of;
    for (std::size_t h = 0; h < web_.horizontal.size(); ++h) {
      const double angle = web_.horizontal[h], mirrored = 180 - angle;
      plane_of.emplace(angle, h);
      plane_of.emplace(mirrored < 0 ? mirrored + 360 : mirrored, h);
    }
    if (!plane_of.contains(0)) {  // between the planes next to 180, of which both are mirrors
      cursor_.fail("its horizontal angles from 90 to 270 must have 180 among them");
    }
    plane_of.emplace(360, plane_of.at(0));
    PhotometricWeb whole{.name = web_.name,
                         .vertical = web_.vertical,
                         .horizontal = {},
                         .candela = {},
                         .tilt = web_.tilt,
                         .tilt_factors = web_.tilt_factors};
    for (const auto& [angle, h] : plane_of) {
      whole.horizontal.push_back(angle);
      const auto row = web_.candela.begin() + static_cast<std::ptrdiff_t>(h * vertical_count_);
      whole.candela.insert(whole.candela.end(), row, row + static_cast<std::ptrdiff_t>(vertical_count_));
    }
    web_ = std::move(whole);
  }

  TextCursor cursor_;
  PhotometricWeb web_;
  double factor_ = 1;
  std::size_t vertical_count_ = 0, horizontal_count_ = 0;
};

}  // namespace

PhotometricWeb parse_ies(std::string_view text, const std::filesystem::path& path) {
  PhotometricWeb web = IesReader(text, path.string()).read();
  if (web.name.empty()) web.name = path.filename().string();
  return web;
}

PhotometricWeb read_ies(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_file(path, most_bytes);
  return parse_ies({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
}

}  // namespace penumbra
