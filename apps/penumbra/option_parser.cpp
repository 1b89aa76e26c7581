#include "option_parser.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "standard_output.h"

namespace penumbra::cli {
namespace {

/// The name that users know best: the last of "-o,--output".
std::string long_name(const std::string& names) { return names.substr(names.rfind(',') + 1); }

std::string spaced(std::string names) {
  const std::size_t comma = names.find(',');
  if (comma != std::string::npos) names.insert(comma + 1, " ");
  return names;
}

/// `text` broken at spaces into lines that fit, the first one after `head`, the others indented alike.
std::string wrapped(const std::string& head, const std::string& text) {
  constexpr std::size_t indent = 30;
  constexpr std::size_t width = 100;
  std::string out =
      head.size() + 2 > indent ? head + "\n" + std::string(indent, ' ') : head + std::string(indent - head.size(), ' ');
  std::size_t column = indent;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (column > indent && column + 1 + word.size() > width) {
      out += "\n" + std::string(indent, ' ');
      column = indent;
    }
    if (column > indent) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
    at = end + 1;
  }
  return out + "\n";
}

bool asks_for_help(const std::vector<std::string>& arguments) {
  return std::any_of(arguments.begin(), arguments.end(), [](const auto& a) { return a == "--help" || a == "-h"; });
}

}  // namespace

OptionParser::OptionParser(std::string command, std::string usage, std::string summary)
    : command_(std::move(command)), usage_(std::move(usage)), summary_(std::move(summary)) {}

void OptionParser::group(std::string title) { group_ = std::move(title); }

void OptionParser::positional(std::string name, std::string help, std::string& target) {
  entries_.push_back({Kind::positional, "", std::move(name), "", std::move(help),
                      [&target](const OptionValue& v) { target = v.text; }});
}

void OptionParser::positionals(std::string name, std::string help, std::vector<std::string>& target) {
  entries_.push_back({Kind::positional, "", std::move(name), "", std::move(help),
                      [&target](const OptionValue& v) { target.push_back(v.text); }, true});
}

void OptionParser::flag(std::string names, std::string help, bool& target) {
  entries_.push_back(
      {Kind::flag, group_, std::move(names), "", std::move(help), [&target](const OptionValue&) { target = true; }});
}

void OptionParser::value(std::string names, std::string metavar, std::string help, Take take) {
  entries_.push_back({Kind::value, group_, std::move(names), std::move(metavar), std::move(help), std::move(take)});
}

void OptionParser::values(std::string names, std::string metavar, std::string help, std::vector<std::string>& target) {
  entries_.push_back({Kind::value, group_, std::move(names), std::move(metavar), std::move(help),
                      [&target](const OptionValue& v) { target.push_back(v.text); }, true});
}

void OptionParser::repeated(std::string names, std::string metavar, std::string help, Take take) {
  entries_.push_back(
      {Kind::value, group_, std::move(names), std::move(metavar), std::move(help), std::move(take), false, true});
}

void OptionParser::examples(std::vector<std::string> lines) { examples_ = std::move(lines); }

bool OptionParser::parse(const std::vector<std::string>& arguments) const {
  if (asks_for_help(arguments)) {
    write_standard_output(help());
    return false;
  }
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  std::vector<CLI::Option*> options;
  for (const Entry& entry : entries_) {
    CLI::Option* option = entry.kind == Kind::flag ? app.add_flag(entry.names) : app.add_option(entry.names);
    if (entry.many) {
      option->expected(1, CLI::detail::expected_max_vector_size);
    } else if (entry.repeated) {
      option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    } else if (entry.kind == Kind::value) {
      option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    }
    options.push_back(option);
  }
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ArgumentMismatch&) {  // only the last argument can lack its value: others take what follows them
    throw UsageError(fmt::format("{} needs a value; see penumbra {} --help", arguments.back(), command_));
  } catch (const CLI::ParseError& e) {
    throw UsageError(fmt::format("{}; see penumbra {} --help", e.what(), command_));
  }
  if (!app.remaining().empty()) refuse_extras(app.remaining());
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (options[i]->count() == 0) continue;
    const std::vector<std::string> results = options[i]->results();
    for (const std::string& text : entries_[i].many || entries_[i].repeated ? results : std::vector{results.back()}) {
      entries_[i].take({long_name(entries_[i].names), text});
    }
  }
  return true;
}

void OptionParser::refuse_extras(const std::vector<std::string>& extras) const {
  const auto is_option = [](const std::string& a) { return a.size() > 1 && a[0] == '-'; };
  const auto found = std::find_if(extras.begin(), extras.end(), is_option);
  if (found == extras.end()) {
    throw UsageError(
        fmt::format("'{}' is one argument too many; the form is: penumbra {} {}", extras.front(), command_, usage_));
  }
  std::vector<std::string> known{"--help"};
  for (const Entry& entry : entries_) {
    if (entry.kind != Kind::positional) known.push_back(long_name(entry.names));
  }
  const std::string given = found->substr(0, found->find('='));
  const std::string nearest = did_you_mean(given, known);
  throw UsageError(
      fmt::format("unknown option {}{}", given, nearest.empty() ? "; see penumbra " + command_ + " --help" : nearest));
}

std::string OptionParser::help() const {
  std::string text = fmt::format("penumbra {}: {}\n\nUsage: penumbra {} {}\n\n", command_, summary_, command_, usage_);
  for (const Entry& entry : entries_) {
    if (entry.kind == Kind::positional) text += wrapped("  " + entry.names, entry.help);
  }
  std::string group;
  for (const Entry& entry : entries_) {
    if (entry.kind == Kind::positional) continue;
    if (entry.group != group) text += fmt::format("\n{}\n", group = entry.group);
    text += wrapped("  " + spaced(entry.names) + (entry.metavar.empty() ? "" : " " + entry.metavar), entry.help);
  }
  text += "\nExamples\n";
  for (const std::string& line : examples_) text += "  " + line + "\n";
  return text;
}

}  // namespace penumbra::cli
