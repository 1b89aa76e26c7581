#include "penumbra/io/npz_reader.h"

#include <stdexcept>

#include "penumbra/file/file_error.h"

namespace penumbra {

template <class Values>
Values NpzReader::take(const std::string& name, Values (*convert)(const NpyArray&)) const {
  if (!has(name)) throw FileError(zip_.path(), "", "has no array '" + name + "'; was it written by penumbra bake?");
  const std::vector<std::byte> bytes = zip_.read(name + ".npy");
  try {
    return convert(read_npy({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  } catch (const std::runtime_error& e) {
    throw FileError(zip_.path(), "array '" + name + "'", e.what());
  }
}

std::vector<double> NpzReader::doubles(const std::string& name) const { return take(name, doubles_of); }

std::vector<std::int64_t> NpzReader::integers(const std::string& name) const { return take(name, integers_of); }

std::vector<std::string> NpzReader::texts(const std::string& name) const { return take(name, texts_of); }

NpzReader::Reals NpzReader::reals(const std::string& name) const {
  return take<Reals>(name, [](const NpyArray& array) { return Reals{array.shape, reals_of(array)}; });
}

bool NpzReader::truth(const std::string& name) const {
  return take<bool>(name, [](const NpyArray& array) {
    if (array.type != "|b1" || array.bytes.empty()) throw std::runtime_error("is no truth value");
    return array.bytes[0] != '\0';
  });
}

}  // namespace penumbra
