#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// What a reader has to say about a file that it could read: like cases are counted into one sentence.
class WarningTally {
 public:
  explicit WarningTally(std::string file) : file_(std::move(file)) {}

  /// Counts `cases` more of the kind that `sentence` tells; of each kind the place of the first is kept.
  void count(std::string_view sentence, std::string_view place, std::size_t cases = 1);

  /// One sentence a kind, in order of first appearance: "file: place: sentence", or with several cases
  /// "file: sentence (12 cases, the first in place)".
  [[nodiscard]] std::vector<std::string> sentences() const;

 private:
  struct Kind {
    std::string sentence;
    std::string first_place;
    std::size_t cases = 0;
  };
  std::string file_;
  std::vector<Kind> kinds_;
  std::map<std::string, std::size_t, std::less<>> kind_of_sentence_;
};

}  // namespace penumbra
