#include <fmt/core.h>

#include <optional>

#include "command.h"
#include "common_options.h"
#include "exit_code.h"
#include "penumbra/file/file_error.h"
#include "penumbra/image/compare.h"
#include "penumbra/image/image_io.h"
#include "report.h"
#include "run_limits.h"
#include "standard_error.h"
#include "standard_output.h"

namespace penumbra::cli {
namespace {

struct CompareArguments {
  std::string a, b;
  std::optional<double> max_rmse;
  CommonOptions common;
};

std::optional<CompareArguments> parse(const std::vector<std::string>& arguments) {
  CompareArguments result;
  OptionParser parser("compare", "A B [--max-rmse X] [options]", "measures how far two pictures lie apart");
  parser.positional("A", "the reference: a .png, .exr or .hdr picture", result.a);
  parser.positional("B", "the picture to judge, of the same size", result.b);
  parser.group("Comparing");
  parser.value(
      "--max-rmse", "X",
      "exit with code 3 when the root mean square error of the linear values is above this (default: no limit)",
      [&](const OptionValue& v) {
        result.max_rmse = real_number(v, "a number of 0 or more");
        if (*result.max_rmse < 0) throw UsageError("--max-rmse takes a number of 0 or more, not '" + v.text + "'");
      });
  add_common_options(parser, result.common);
  parser.examples(
      {"penumbra compare reference.exr picture.exr", "penumbra compare before.png after.png --max-rmse 0.01 --json"});
  if (!parser.parse(arguments)) return std::nullopt;
  if (result.b.empty()) throw UsageError("compare needs two pictures: penumbra compare A B");
  check_report(result.common);
  return result;
}

ImageDifference difference(const CompareArguments& arguments) {
  const Image a = read_image(arguments.a);
  const Image b = read_image(arguments.b);
  if (a.width != b.width || a.height != b.height) {
    throw FileError(arguments.b, "",
                    fmt::format("is {}x{} pixels, but {} is {}x{}; pictures to compare are of one size", b.width,
                                b.height, arguments.a, a.width, a.height));
  }
  return compare(a, b);
}

Report report_on(const ImageDifference& d) {
  return {{"rmse", d.rmse},
          {"relative_rmse", d.relative_rmse},
          {"psnr", d.psnr ? Report(*d.psnr) : Report(nullptr)},
          {"ssim", d.ssim},
          {"max", d.max},
          {"mean_a", d.mean_a},
          {"mean_b", d.mean_b}};
}

std::string table(const ImageDifference& d) {
  return fmt::format(
      "rmse           {:.9g}\nrelative_rmse  {:.9g}\npsnr           {}\nssim           {:.9g}\nmax            {:.9g}\n"
      "mean_a         {:.9g}\nmean_b         {:.9g}\n",
      d.rmse, d.relative_rmse, d.psnr ? fmt::format("{:.6g} dB", *d.psnr) : "none (the pictures are equal)", d.ssim,
      d.max, d.mean_a, d.mean_b);
}

}  // namespace

int run_compare(const std::vector<std::string>& arguments) {
  const auto parsed = parse(arguments);
  if (!parsed) return exit_done;
  const RunLimits limits(parsed->common);
  const ImageDifference apart = difference(*parsed);
  write_report(parsed->common, report_on(apart));
  if (!parsed->common.json) write_standard_output(table(apart));
  if (!parsed->max_rmse || apart.rmse <= *parsed->max_rmse) return exit_done;
  write_standard_error(fmt::format("penumbra: rmse {:.6g} is over --max-rmse {:g}: {} is too far from {}\n", apart.rmse,
                                   *parsed->max_rmse, parsed->b, parsed->a));
  return exit_finding;
}

}  // namespace penumbra::cli
