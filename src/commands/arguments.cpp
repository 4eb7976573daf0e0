#include "commands/arguments.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/ranges.h>

#include "commands/common.hpp"

namespace rabiline {
namespace {

std::vector<std::string> names_of(const CLI::App& app) {
  std::vector<std::string> out;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) out.push_back("--" + name);
  return out;
}

std::string meant(const std::string& near, const std::string& lists) {
  return near.empty() ? fmt::format("`{}` lists them", lists) : fmt::format("did you mean `{}`?", near);
}

/// What a letter is called that other programs have, and some of the commands.
std::string option_of_letter(char letter, const std::vector<std::string>& known) {
  const auto begins = [&](const std::string& name) { return name[2] == letter; };
  const std::string_view usual = letter == 'n' ? "--particles" : letter == 'j' ? "--threads" : "";
  if (std::ranges::find(known, usual) != known.end()) return std::string(usual);
  return std::ranges::count_if(known, begins) == 1 ? *std::ranges::find_if(known, begins) : std::string{};
}

/// Of an option that its command does not have, the one that may be meant.
void require_known_options(const CLI::App& verb, const std::vector<std::string>& arguments) {
  const std::vector<std::string> known = names_of(verb);
  bool is_value = true;
  for (const std::string& argument : arguments) {
    const std::string name = argument.substr(0, argument.find('='));
    if (name == "--") return;
    const bool is_letter =
        name.size() == 2 && name[0] == '-' && std::isalpha(static_cast<unsigned char>(name[1])) && !is_value;
    const CLI::Option* option = name.starts_with('-') ? verb.get_option_no_throw(name) : nullptr;
    is_value = option != nullptr && option->get_items_expected_min() > 0;
    const bool is_word =
        name.size() > 2 && name[0] == '-' && std::isalpha(static_cast<unsigned char>(name[1])) && !is_value;
    if (option != nullptr || !(is_letter || is_word || name.starts_with("--"))) continue;
    const std::string near =
        is_letter ? option_of_letter(name[1], known) : closest(is_word ? '-' + name : name, known);
    throw ArgumentError(fmt::format("`rabiline {}` has no option `{}`\n  help: {}", arguments.front(), name,
                                    meant(near, fmt::format("rabiline {} --help", arguments.front()))));
  }
}

/// An empty text is no value: a variable of a shell that is not set leaves one. Nor is what stands last
/// without one, which CLI11 would count.
void require_values(const CLI::App& verb, const std::vector<std::string>& arguments) {
  if (const std::string& last = arguments.back(); last.starts_with('-') && last.size() > 1)
    if (const CLI::Option* option = verb.get_option_no_throw(last);
        option != nullptr && option->get_items_expected_min() > 0)
      throw ArgumentError(
          fmt::format("`{0}` needs a value\n  help: write `{0} {1}`", last, option->get_type_name()));
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const bool joined = arguments[i].ends_with('=');  // `--threads=`
    if (!joined && !arguments[i].empty()) continue;
    const std::string name = joined ? arguments[i].substr(0, arguments[i].size() - 1) : arguments[i - 1];
    const CLI::Option* option = name.starts_with('-') ? verb.get_option_no_throw(name) : nullptr;
    if (option != nullptr && option->get_items_expected_min() > 0)
      throw ArgumentError(
          fmt::format("`{}` is set to nothing\n  help: write a value behind it, or omit it", name));
    if (!joined && option == nullptr)
      throw ArgumentError(fmt::format("one of the names for `rabiline {}` is empty", arguments.front()));
  }
}

/// CLI11 would only count.
void require_single(const CLI::App& verb, const std::vector<std::string>& arguments) {
  std::vector<const CLI::Option*> given;
  for (const std::string& argument : arguments) {
    if (argument == "--") return;
    const std::string name = argument.substr(0, argument.find('='));
    const CLI::Option* option = name.starts_with('-') ? verb.get_option_no_throw(name) : nullptr;
    if (option == nullptr || option->get_items_expected_max() != 1) continue;
    if (std::ranges::find(given, option) != given.end())
      throw ArgumentError(fmt::format("`{}` is given twice\n  help: keep one of them", name));
    given.push_back(option);
  }
}

/// `--set guide.field 3 mT`, as it may come from a shell.
void require_assignments(const CLI::App& verb, const std::vector<std::string>& arguments) {
  for (std::size_t i = 1; i + 1 < arguments.size(); ++i) {
    const CLI::Option* option =
        arguments[i].starts_with("--") ? verb.get_option_no_throw(arguments[i]) : nullptr;
    if (option == nullptr || option->get_type_name().find('=') == std::string::npos ||
        arguments[i + 1].find('=') != std::string::npos)
      continue;
    std::string value;
    for (std::size_t k = i + 2; k < arguments.size() && !arguments[k].starts_with('-'); ++k)
      value += (value.empty() ? "" : " ") + arguments[k];
    throw ArgumentError(fmt::format("`{} {}` has no `=`\n  help: write {} '{}={}'", arguments[i],
                                    arguments[i + 1], arguments[i], arguments[i + 1],
                                    value.empty() ? "VALUE" : value));
  }
}

}  // namespace

void require_known_verb(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty()) return;
  if (const std::string& first = arguments.front(); first.starts_with('-')) {
    if (app.get_option_no_throw(first) == nullptr)
      throw ArgumentError(fmt::format("there is no option `{}`\n  help: {}", first,
                                      meant(closest(first, names_of(app)), "rabiline --help")));
    return;
  }
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands({})) verbs.push_back(verb->get_name());
  if (std::find(verbs.begin(), verbs.end(), arguments.front()) != verbs.end()) return;
  if (arguments.front().ends_with(".yaml") || arguments.front().ends_with(".yml"))
    throw ArgumentError(
        fmt::format("there is no command `{0}`\n  help: write `rabiline check {0}` or `rabiline run {0}`",
                    arguments.front()));
  verbs.emplace_back("--help");
  const std::string near = closest(arguments.front(), verbs);
  verbs.pop_back();
  throw ArgumentError(fmt::format("there is no command `{}`\n  help: {}", arguments.front(),
                                  near.empty() ? fmt::format("the commands are {}", fmt::join(verbs, ", "))
                                               : fmt::format("did you mean `{}`?", near)));
}

void require_known_arguments(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments.front().starts_with('-')) return;
  const CLI::App& verb = *app.get_subcommand(arguments.front());
  require_known_options(verb, arguments);
  require_values(verb, arguments);
  require_assignments(verb, arguments);
  require_single(verb, arguments);
}

}  // namespace rabiline
