#include "report.h"

#include <sys/resource.h>

#include "penumbra/file/output_file.h"
#include "standard_output.h"

namespace penumbra::cli {
namespace {

// Names of files and objects may hold any bytes; a report stays readable all the same.
std::string text_of(const Report& report) {
  return report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace

void check_report(const CommonOptions& options) {
  if (options.stats) check_creatable(*options.stats);
}

void write_report(const CommonOptions& options, const Report& report) {
  if (options.stats) {
    OutputFile file(*options.stats);
    file.write(text_of(report));
    file.commit();
  }
  if (options.json) write_standard_output(text_of(report));
}

long long peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  constexpr long long bytes_per_kilobyte = 1024;
  return usage.ru_maxrss * bytes_per_kilobyte;
}

}  // namespace penumbra::cli
