#include "exit_code.h"

#include <fmt/core.h>

#include <cstdio>
#include <new>
#include <stdexcept>
#include <string_view>

#include "penumbra/file/file_error.h"

namespace penumbra::cli {
namespace {

int say(int code, std::string_view sentence) {
  fmt::print(stderr, "penumbra: {}\n", sentence);
  return code;
}

}  // namespace

int report_failure(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const FileError& e) {
    return say(exit_bad_input, e.what());
  } catch (const std::invalid_argument& e) {
    return say(exit_bad_input, e.what());
  } catch (const std::bad_alloc&) {
    return say(exit_failed, "not enough memory; try a smaller picture or scene, or close other programs");
  } catch (const std::length_error&) {
    return say(exit_failed, "not enough memory; try a smaller picture or scene, or close other programs");
  } catch (const std::exception& e) {
    return say(exit_failed, e.what());
  }
}

}  // namespace penumbra::cli
