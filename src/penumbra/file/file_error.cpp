#include "penumbra/file/file_error.h"

namespace penumbra {
namespace {

std::string compose(std::string_view path, std::string_view place, std::string_view sentence) {
  std::string text(path);
  text += ": ";
  if (!place.empty()) {
    text += place;
    text += ": ";
  }
  text += sentence;
  return text;
}

}  // namespace

FileError::FileError(std::string_view path, std::string_view place, std::string_view sentence)
    : std::runtime_error(compose(path, place, sentence)), path_(path), place_(place) {}

}  // namespace penumbra
