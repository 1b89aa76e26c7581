#include "exit_code.h"

#include <fmt/core.h>

#include <new>
#include <stdexcept>
#include <string_view>

#include "penumbra/file/file_error.h"
#include "standard_error.h"

namespace penumbra::cli {
namespace {

constexpr std::string_view no_memory =
    "there is not enough memory (--max-memory, by default 80 % of what the machine has); try a smaller picture or "
    "scene, or allow more";

int say(int code, std::string_view sentence) {
  write_standard_error(fmt::format("penumbra: {}\n", sentence));
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
    return say(exit_failed, no_memory);
  } catch (const std::length_error&) {
    return say(exit_failed, no_memory);
  } catch (const std::exception& e) {
    return say(exit_failed, e.what());
  }
}

}  // namespace penumbra::cli
