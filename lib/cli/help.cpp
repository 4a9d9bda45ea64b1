// --help and --describe, printed from the description.
#include "cli/help.h"

#include <algorithm>
#include <sstream>

#include "cli/common_options.h"

namespace gonio::cli {
namespace {

constexpr std::size_t width = 96, indent = 30;

void wrapped(std::ostream& out, const std::string& text, std::size_t column, std::size_t left) {
  std::istringstream words(text);
  std::string word;
  bool first = true;
  while (words >> word) {
    if (!first && column + 1 + word.size() > width) {
      out << '\n' << std::string(left, ' ');
      column = left;
      first = true;
    }
    if (!first) {
      out << ' ';
      ++column;
    }
    out << word;
    column += word.size();
    first = false;
  }
  out << '\n';
}

std::string number_text(double v) {
  std::ostringstream out;
  out << v;
  return out.str();
}

void item(std::ostream& out, const std::string& head, const std::string& text) {
  out << "  " << head;
  std::size_t column = 2 + head.size();
  if (column + 2 > indent) {
    out << '\n';
    column = 0;
  }
  out << std::string(indent - column, ' ');
  wrapped(out, text, indent, indent);
}

}  // namespace

std::string limits_of(const Option& o) {
  std::string out;
  const std::string unit(o.type == Type::quantity ? si_unit(o.dimension) : "");
  const std::string suffix = unit.empty() ? "" : " " + unit;
  if (o.lower && o.upper)
    out = number_text(*o.lower) + " to " + number_text(*o.upper) + suffix;
  else if (o.lower)
    out = "at least " + number_text(*o.lower) + suffix;
  else if (o.upper)
    out = "at most " + number_text(*o.upper) + suffix;
  return out;
}

std::string head_of(const Option& o) {
  std::string head = o.letter != 0 ? std::string("-") + o.letter + ", --" + o.name : "--" + o.name;
  if (o.type != Type::flag) head += " " + metavar_of(o);
  return head;
}

std::string remarks_of(const Option& o) {
  std::string out;
  const auto add = [&out](const std::string& s) { out += (out.empty() ? "" : "; ") + s; };
  if (!o.preset.empty()) add("default " + o.preset);
  if (const std::string limits = limits_of(o); !limits.empty()) add(limits);
  if (o.required) add("required");
  if (o.repeat) add("may be repeated");
  for (const auto& c : o.conflicts) add("not with " + option_text(c));
  for (const auto& n : o.needs) add("needs " + option_text(n));
  return out;
}

std::string help_text(const Program& program) {
  std::ostringstream out;
  out << program.name << " - " << program.sentence << "\n\n";
  const char* lead = "usage: ";
  for (const auto& form : program.synopsis) {
    out << lead << program.name << ' ' << form << '\n';
    lead = "       ";
  }
  const auto print = [&out](const Option& o, const std::string& head) {
    const std::string remarks = remarks_of(o);
    item(out, head, o.help + (remarks.empty() ? "" : " (" + remarks + ")"));
  };
  if (!program.operands.empty()) out << "\noperands:\n";
  for (const auto& o : program.operands) print(o, o.name);
  if (!program.options.empty()) out << "\noptions:\n";
  for (const auto& o : program.options) print(o, head_of(o));
  out << "\noptions of every gonio program:\n";
  for (const auto& o : common_options(program)) print(o, head_of(o));
  out << "\nexit status: 0 done";
  for (const auto& [code, meaning] : program.exits) out << "; " << static_cast<int>(code) << ' ' << meaning;
  out << "; from 64 on as in sysexits.h\nman " << program.name << " has examples and the method.\n";
  return out.str();
}

namespace {

const char* type_name(Type type) {
  switch (type) {
    case Type::flag: return "flag";
    case Type::integer: return "integer";
    case Type::number: return "number";
    case Type::quantity: return "quantity";
    case Type::text: return "text";
    case Type::choice: return "choice";
    case Type::input_file: return "input-file";
    case Type::output_file: return "output-file";
    case Type::folder: return "folder";
  }
  return "";
}

manifest::Value describe_option(const Option& o) {
  using manifest::Value;
  Value v = Value::object({{"name", o.name}, {"type", type_name(o.type)}, {"help", o.help}});
  if (o.letter != 0) v["letter"] = std::string(1, o.letter);
  if (o.type == Type::quantity) {
    v["dimension"] = dimension_name(o.dimension);
    v["unit"] = si_unit(o.dimension);
  }
  if (!o.preset.empty()) v["default"] = o.preset;
  if (o.lower) v["minimum"] = *o.lower;
  if (o.upper) v["maximum"] = *o.upper;
  if (!o.choices.empty()) v["choices"] = o.choices;
  if (o.repeat) v["repeat"] = true;
  if (o.required) v["required"] = true;
  if (!o.conflicts.empty()) v["conflicts"] = o.conflicts;
  if (!o.needs.empty()) v["needs"] = o.needs;
  return v;
}

}  // namespace

manifest::Value describe(const Program& program) {
  using manifest::Value;
  Value v = Value::object({{"name", program.name},
                           {"version", GONIO_VERSION},
                           {"sentence", program.sentence},
                           {"synopsis", program.synopsis}});
  Value operands = Value::array(), options = Value::array(), common = Value::array(), exits = Value::array(),
        files = Value::array();
  for (const auto& o : program.operands) operands.push_back(describe_option(o));
  for (const auto& o : program.options) options.push_back(describe_option(o));
  for (const auto& o : common_options(program)) common.push_back(describe_option(o));
  for (const auto& row : exit_table()) {
    const auto own = std::ranges::find(program.exits, row.code, &std::pair<Exit, std::string>::first);
    exits.push_back(Value::object({{"code", static_cast<int>(row.code)},
                                   {"name", row.name},
                                   {"meaning", own != program.exits.end() ? own->second : std::string(row.meaning)}}));
  }
  for (const auto& [pattern, meaning] : program.files)
    files.push_back(Value::object({{"pattern", pattern}, {"meaning", meaning}}));
  v["operands"] = std::move(operands);
  v["options"] = std::move(options);
  v["common_options"] = std::move(common);
  v["reads_manifest"] = program.reads == Reads::none       ? "no"
                        : program.reads == Reads::optional ? "optional"
                                                           : "required";
  v["writes_manifest"] = program.writes_manifest;
  v["sections_read"] = program.sections_read;
  v["sections_written"] = program.sections_written;
  v["files"] = std::move(files);
  v["exits"] = std::move(exits);
  v["references"] = program.references;
  v["see_also"] = program.see_also;
  return v;
}

}  // namespace gonio::cli
