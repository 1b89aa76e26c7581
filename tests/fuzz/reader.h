#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <span>

namespace penumbra::fuzz {

/// A reader's answer to bytes from anywhere: it reads them, or refuses them with a FileError (or, for decoders of bare
/// memory, std::invalid_argument). All else, whatever is thrown or crashes, is a defect.
///
/// Each tests/fuzz/NAME.cpp defines it for one format. With clang it is a libFuzzer target; in every build it is
/// replayed over its seeds and regressions.
void read(std::span<const std::byte> bytes);

/// Lends `bytes` as a file named input.EXTENSION, alone in a folder of this process's own.
void with_file(std::span<const std::byte> bytes, const char* extension,
               const std::function<void(const std::filesystem::path&)>& use);

/// Lends the NumPy arrays that stand one after another in `bytes`, by their magic, as a file named input.npz: the first
/// is called by the first of `names`, and so on. The archive is written here, so that its checksums hold whatever
/// becomes of the arrays.
void with_arrays(std::span<const std::byte> bytes, std::initializer_list<const char*> names,
                 const std::function<void(const std::filesystem::path&)>& use);

/// Whether `read` refused the bytes; it must not throw anything else.
[[nodiscard]] bool is_refused(std::span<const std::byte> bytes);

}  // namespace penumbra::fuzz
