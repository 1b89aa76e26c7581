#include "penumbra/io/probe_file.h"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "penumbra/file/output_file.h"
#include "penumbra/io/npy_array.h"
#include "penumbra/io/zip_writer.h"

namespace penumbra {
namespace {

template <class T>
std::string npy(std::string_view type, const std::string& shape, std::span<const T> values) {
  std::string array = npy_header(type, shape);
  return array.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

}  // namespace

void write_probe_arrays(const std::filesystem::path& path, const ProbeArrays& probes) {
  const std::size_t n = probes.positions.size();
  const std::vector<std::int64_t> count(probes.count.begin(), probes.count.end());
  OutputFile out(path);
  ZipWriter zip(out);
  zip.add("count.npy", npy_array(count));
  zip.add("positions.npy", npy("<f8", fmt::format("({}, 3)", n), probes.positions));
  zip.add("coefficients.npy", npy("<f4", fmt::format("({}, 9, 3)", n), probes.coefficients));
  zip.add("inside.npy", npy("|b1", fmt::format("({},)", n), probes.inside));
  zip.add("partial.npy", npy_truth(probes.partial));
  zip.finish();
  out.commit();
}

}  // namespace penumbra
