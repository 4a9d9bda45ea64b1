// The command line: CLI11 splits it into options and operands; types, units, ranges and conflicts are checked here
// against the description, so that --check, the man page and the program mean the same.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "base/text.h"
#include "cli/common_options.h"
#include "cli/invocation.h"

namespace gonio::cli {
namespace {

std::string dashed(const Option& o, bool operand) {
  return operand ? o.name : "--" + o.name;
}

double plain_number(const std::string& text, const std::string& place, bool whole) {
  double v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(v) ||
      (whole && std::nearbyint(v) != v))
    throw Error(Exit::usage, place, "\"" + text + "\" is not a " + (whole ? "whole number" : "number"));
  return v;
}

std::string shown(double v) {
  std::ostringstream out;
  out << v;
  return out.str();
}

double checked_number(const Option& o, const std::string& text, const std::string& place) {
  const double v = o.type == Type::quantity ? parse_quantity(text, o.dimension, place)
                                            : plain_number(text, place, o.type == Type::integer);
  const std::string unit(o.type == Type::quantity ? si_unit(o.dimension) : "");
  const std::string suffix = unit.empty() ? "" : " " + unit;
  if (o.lower && !(v >= *o.lower))
    throw Error(Exit::usage, place, "is " + text + ", at least " + shown(*o.lower) + suffix + " is needed");
  if (o.upper && !(v <= *o.upper))
    throw Error(Exit::usage, place, "is " + text + ", at most " + shown(*o.upper) + suffix + " is allowed");
  return v;
}

void check_choice(const Option& o, const std::string& text, const std::string& place) {
  if (std::ranges::find(o.choices, text) != o.choices.end()) return;
  std::string list;
  for (const auto& c : o.choices) list += (list.empty() ? "" : ", ") + c;
  throw Error(Exit::usage, place, "is \"" + text + "\"", "choose one of " + list);
}

void interpret(Argument& a, bool operand) {
  const Option& o = *a.option;
  const std::string place = dashed(o, operand);
  if (!a.given && !o.preset.empty()) a.texts = {o.preset};
  for (const auto& text : a.texts) {
    if (o.type == Type::integer || o.type == Type::number || o.type == Type::quantity)
      a.numbers.push_back(checked_number(o, text, place));
    if (o.type == Type::choice) check_choice(o, text, place);
    if (o.type != Type::flag && o.type != Type::text && text.empty()) throw Error(Exit::usage, place, "is empty");
  }
  if (o.required && a.texts.empty()) throw Error(Exit::usage, place, "is missing", o.help);
}

void check_company(const Invocation::State& state) {
  for (const auto& [name, a] : state.arguments) {
    if (!a.given) continue;
    for (const auto& other : a.option->conflicts)
      if (const auto found = state.arguments.find(other); found != state.arguments.end() && found->second.given)
        throw Error(Exit::usage, option_text(name), "cannot stand beside " + option_text(other), "give one of them");
    for (const auto& other : a.option->needs)
      if (const auto found = state.arguments.find(other); found == state.arguments.end() || !found->second.given)
        throw Error(Exit::usage, option_text(name), "needs " + option_text(other));
  }
}

[[noreturn]] void unknown_option(const Invocation::State& state, const std::string& typed) {
  if (!typed.starts_with("-")) throw Error(Exit::usage, typed, "is an operand too many", "see --help");
  const std::string name = typed.substr(typed.find_first_not_of('-'), typed.find('=') - typed.find_first_not_of('-'));
  const Option* nearest = nullptr;
  for (const Option& o : state.options)
    if (nearest == nullptr || edit_distance(name, o.name) < edit_distance(name, nearest->name)) nearest = &o;
  const bool close = nearest != nullptr && edit_distance(name, nearest->name) <= 2;
  throw Error(Exit::usage, typed, "is no option of " + state.program->name,
              close ? "did you mean --" + nearest->name + "?" : "see --help");
}

}  // namespace

void parse_arguments(Invocation::State& state, int argc, char** argv) {
  const Program& program = *state.program;
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  std::map<std::string, std::int64_t> counts;
  for (const Option& o : state.options) {
    Argument& a = state.arguments[o.name];
    a.option = &o;
    std::string names = (o.letter != 0 ? std::string("-") + o.letter + "," : std::string()) + "--" + o.name;
    for (const std::string& alias : o.aliases) names += ",--" + alias;
    if (o.type == Type::flag)
      app.add_flag(names, counts[o.name]);
    else
      app.add_option(names, a.texts)->expected(1)->take_all()->allow_extra_args(false);
  }
  for (const Option& o : program.operands) {
    Argument& a = state.arguments[o.name];
    a.option = &o;
    // Of several operands each takes its own word; only a repeated one takes the rest.
    if (o.repeat)
      app.add_option(o.name, a.texts)->expected(0, CLI::detail::expected_max_vector_size);
    else
      app.add_option(o.name, a.texts)->expected(1)->allow_extra_args(false);
  }
  // Before CLI11 sees them: it would take an unknown option's value for an operand and complain about that one.
  for (int i = 1; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    const std::string word = argv[i], name = word.substr(0, word.find('='));
    if (word.starts_with("--") && std::ranges::none_of(state.options, [&](const Option& o) {
          return "--" + o.name == name ||
                 std::ranges::any_of(o.aliases, [&](const std::string& alias) { return "--" + alias == name; });
        }))
      unknown_option(state, word);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    throw Error(Exit::usage, program.name, e.what(), "see --help");
  }
  for (const auto& [name, count] : counts) state.arguments[name].given = count > 0;
  for (const Option& o : state.options)
    if (o.type != Type::flag) {
      Argument& a = state.arguments[o.name];
      a.given = !a.texts.empty();
      if (a.texts.size() > 1 && !o.repeat)
        throw Error(Exit::usage, "--" + o.name, "is given " + std::to_string(a.texts.size()) + " times",
                    "give it once");
    }
  for (const Option& o : program.operands) state.arguments[o.name].given = !state.arguments[o.name].texts.empty();
  if (const auto extra = app.remaining(); !extra.empty()) unknown_option(state, extra.front());
  const bool only_asks =
      state.arguments["help"].given || state.arguments["version"].given || state.arguments["describe"].given;
  if (only_asks) return;
  for (auto& [name, a] : state.arguments)
    interpret(a, std::ranges::any_of(program.operands, [&n = name](const Option& o) { return o.name == n; }));
  check_company(state);
}

}  // namespace gonio::cli
