#pragma once

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace penumbra::bench {

/// The command line of a benchmark: `--json FILE`, `--quick` and options of its own, each with a value or without.
class BenchArguments {
 public:
  std::string json;  ///< the file for the results; empty: none
  bool quick = false;

  BenchArguments() {
    add("--json", "FILE", [this](const std::string& v) { json = v; });
    add_flag("--quick", [this] { quick = true; });
  }
  BenchArguments(const BenchArguments&) = delete;
  BenchArguments& operator=(const BenchArguments&) = delete;

  void add(const std::string& name, const std::string& value, std::function<void(const std::string&)> take) {
    known_ += (known_.empty() ? "" : " ") + name + " " + value;
    options_.emplace(name, Option{true, std::move(take)});
  }
  void add_flag(const std::string& name, std::function<void()> take) {
    known_ += (known_.empty() ? "" : " ") + name;
    options_.emplace(name, Option{false, [take = std::move(take)](const std::string&) { take(); }});
  }

  /// Throws std::invalid_argument for an unknown option or one without its value.
  void parse(int count, char** values) {
    for (int k = 1; k < count; ++k) {
      const std::string name = values[k];
      const auto option = options_.find(name);
      if (option == options_.end()) throw std::invalid_argument("unknown option " + name + "; known: " + known_);
      if (option->second.has_value && k + 1 >= count) throw std::invalid_argument(name + " needs a value");
      option->second.take(option->second.has_value ? values[++k] : "");
    }
  }

 private:
  struct Option {
    bool has_value;
    std::function<void(const std::string&)> take;
  };
  std::map<std::string, Option> options_;
  std::string known_;
};

}  // namespace penumbra::bench
