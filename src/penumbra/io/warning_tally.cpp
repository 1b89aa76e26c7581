#include "penumbra/io/warning_tally.h"

#include <fmt/format.h>

namespace penumbra {

void WarningTally::count(std::string_view sentence, std::string_view place, std::size_t cases) {
  if (cases == 0) return;
  auto found = kind_of_sentence_.find(sentence);
  if (found == kind_of_sentence_.end()) {
    found = kind_of_sentence_.emplace(sentence, kinds_.size()).first;
    kinds_.push_back({std::string(sentence), std::string(place), 0});
  }
  kinds_[found->second].cases += cases;
}

std::vector<std::string> WarningTally::sentences() const {
  std::vector<std::string> all;
  for (const Kind& kind : kinds_) {
    if (kind.cases > 1) {
      const std::string first = kind.first_place.empty() ? "" : ", the first in " + kind.first_place;
      all.push_back(fmt::format("{}: {} ({} cases{})", file_, kind.sentence, kind.cases, first));
    } else if (kind.first_place.empty()) {
      all.push_back(fmt::format("{}: {}", file_, kind.sentence));
    } else {
      all.push_back(fmt::format("{}: {}: {}", file_, kind.first_place, kind.sentence));
    }
  }
  return all;
}

}  // namespace penumbra
