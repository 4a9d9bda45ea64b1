#include "cli/reference.h"

#include <algorithm>

#include "cli/common_options.h"
#include "cli/help.h"
#include "cli/roff.h"

namespace gonio::cli {
namespace {

std::string upper(std::string s) {
  std::ranges::transform(s, s.begin(), [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  return s;
}

std::string option_item(const Option& o, const std::string& head) {
  const std::string remarks = remarks_of(o);
  return ".TP\n\\fB" + roff_text(head) + "\\fR\n" + roff_text(o.help) +
         (remarks.empty() ? "" : " " + roff_text("(" + remarks + ")")) + "\n";
}

std::string section_head(const std::string& name) {
  return ".SH " + (name.find(' ') == std::string::npos ? name : "\"" + name + "\"") + "\n";
}

std::string prose_of(std::string_view prose, const std::string& name) {
  return roff_from_markdown(section_of(prose, name));
}

// Sections that have a place of their own on every page.
const std::vector<std::string>& placed_sections() {
  static const std::vector<std::string> names{"NAME",        "SYNOPSIS",   "DESCRIPTION", "OPTIONS", "EXIT STATUS",
                                              "ENVIRONMENT", "FILES",      "NOTES",       "CAVEATS", "BUGS",
                                              "EXAMPLES",    "REFERENCES", "SEE ALSO"};
  return names;
}

std::vector<std::string> own_sections(std::string_view prose) {
  std::vector<std::string> own = headings_of(prose);
  std::erase_if(own, [](const std::string& name) { return std::ranges::count(placed_sections(), name) > 0; });
  return own;
}

std::string exit_items(const Program& program) {
  std::string out;
  for (const auto& row : exit_table()) {
    const auto own = std::ranges::find(program.exits, row.code, &std::pair<Exit, std::string>::first);
    out += ".TP\n\\fB" + std::to_string(static_cast<int>(row.code)) + "\\fR\n" +
           roff_text(own != program.exits.end() ? own->second : std::string(row.meaning)) + "\n";
  }
  return out;
}

std::string file_items(const Program& program) {
  std::string out;
  const auto sections = [&out](const char* verb, const std::vector<std::string>& names) {
    if (names.empty()) return;
    out += ".PP\n" + std::string(verb);
    for (std::size_t i = 0; i < names.size(); ++i) out += (i == 0 ? " \\fB" : ", \\fB") + roff_text(names[i]) + "\\fR";
    out += " of the manifest.\n";
  };
  sections("Reads the sections", program.sections_read);
  sections("Writes the sections", program.sections_written);
  for (const auto& [pattern, meaning] : program.files)
    out += ".TP\n\\fB" + roff_text(pattern) + "\\fR\n" + roff_text(meaning) + "\n";
  return out;
}

std::vector<Option> all_options(const Program& program) {
  std::vector<Option> all = program.options;
  for (const auto& o : common_options(program)) all.push_back(o);
  return all;
}

std::string without_apostrophes(std::string s) {
  std::erase(s, '\'');
  return s;
}

}  // namespace

std::string man_header(const std::string& name, int section, const std::string& sentence) {
  return "'\\\" t\n.\\\" Printed by scripts/regenerate; the prose lies in man/prose.\n.TH " + upper(name) + " " +
         std::to_string(section) + " \"\" \"gonio " GONIO_VERSION "\" \"gonio manual\"\n.SH NAME\n" + roff_text(name) +
         " \\- " + roff_text(sentence) + "\n";
}

std::string man_page(const Program& program, std::string_view prose) {
  std::string out = man_header(program.name, 1, program.sentence);
  const auto open = [&](const std::string& name) { out += section_head(name) + prose_of(prose, name); };
  const auto open_where_written = [&](const std::vector<std::string>& names) {
    for (const std::string& name : names)
      if (!section_of(prose, name).empty()) open(name);
  };
  open("SYNOPSIS");
  out += ".nf\n";
  for (const auto& form : program.synopsis) out += "\\fB" + roff_text(program.name) + "\\fR " + roff_text(form) + "\n";
  out += ".fi\n";
  open("DESCRIPTION");
  open_where_written(own_sections(prose));
  open("OPTIONS");
  for (const auto& o : program.operands) out += option_item(o, o.name);
  for (const auto& o : program.options) out += option_item(o, head_of(o));
  out += ".SS \"Options of every gonio program\"\n";
  for (const auto& o : common_options(program)) out += option_item(o, head_of(o));
  open("EXIT STATUS");
  out += exit_items(program);
  open_where_written({"ENVIRONMENT"});
  open("FILES");
  out += file_items(program);
  open_where_written({"NOTES", "CAVEATS", "BUGS", "EXAMPLES"});
  if (!program.references.empty()) open("REFERENCES");
  for (const auto& r : program.references) out += ".PP\n" + roff_text(r) + "\n";
  open("SEE ALSO");
  std::vector<std::string> also = program.see_also;
  for (const char* page : {"gonio(7)", "gonio-manifest(5)", "gonio-conventions(7)"})
    if (std::ranges::find(also, page) == also.end()) also.emplace_back(page);
  for (std::size_t i = 0; i < also.size(); ++i) out += (i == 0 ? "" : ", ") + roff_text(also[i]);
  return out + "\n";
}

std::string bash_completion(const Program& program) {
  std::string function = "_gonio_" + program.name, words, cases;
  std::ranges::replace(function, '-', '_');
  for (const auto& o : all_options(program)) {
    words += (words.empty() ? "" : " ") + ("--" + o.name);
    std::string action;
    if (o.type == Type::choice) {
      for (const auto& c : o.choices) action += (action.empty() ? "" : " ") + c;
      action = "COMPREPLY=($(compgen -W '" + action + "' -- \"$word\"))";
    } else if (o.type == Type::folder) {
      action = "COMPREPLY=($(compgen -d -- \"$word\"))";
    } else if (o.type == Type::input_file || o.type == Type::output_file) {
      action = "COMPREPLY=($(compgen -f -- \"$word\"))";
    } else if (o.type != Type::flag) {
      action = "COMPREPLY=()";
    }
    if (!action.empty())
      cases +=
          "    --" + o.name + (o.letter != 0 ? std::string("|-") + o.letter : "") + ") " + action + "; return ;;\n";
  }
  return "# bash completion of " + program.name + "; printed by scripts/regenerate\n" + function +
         "() {\n  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n  case $before in\n" +
         cases + "  esac\n  if [[ $word == -* ]]; then\n    COMPREPLY=($(compgen -W '" + words +
         "' -- \"$word\"))\n  else\n    COMPREPLY=($(compgen -f -- \"$word\"))\n  fi\n}\ncomplete -o filenames -F " +
         function + " " + program.name + "\n";
}

std::string zsh_completion(const Program& program) {
  std::string out = "#compdef " + program.name + "\n# printed by scripts/regenerate\n_arguments -s";
  for (const auto& o : all_options(program)) {
    std::string help = without_apostrophes(o.help);
    std::erase_if(help, [](char c) { return c == '[' || c == ']'; });
    std::string action;
    if (o.type == Type::choice) {
      for (const auto& c : o.choices) action += (action.empty() ? "" : " ") + c;
      action = ":" + o.name + ":(" + action + ")";
    } else if (o.type == Type::folder) {
      action = ":folder:_files -/";
    } else if (o.type == Type::input_file || o.type == Type::output_file) {
      action = ":file:_files";
    } else if (o.type != Type::flag) {
      action = ":" + o.name + ":";
    }
    out += " \\\n  '" + std::string(o.repeat ? "*" : "") + "--" + o.name + "[" + help + "]" + action + "'";
  }
  return out + " \\\n  '*:file:_files'\n";
}

std::string fish_completion(const Program& program) {
  std::string out = "# fish completion of " + program.name + "; printed by scripts/regenerate\n";
  for (const auto& o : all_options(program)) {
    out += "complete -c " + program.name + " -l " + o.name + (o.letter != 0 ? std::string(" -s ") + o.letter : "");
    if (o.type == Type::choice) {
      std::string list;
      for (const auto& c : o.choices) list += (list.empty() ? "" : " ") + c;
      out += " -x -a '" + list + "'";
    } else if (o.type == Type::input_file || o.type == Type::output_file || o.type == Type::folder) {
      out += " -r";
    } else if (o.type != Type::flag) {
      out += " -x";
    }
    out += " -d '" + without_apostrophes(o.help) + "'\n";
  }
  return out;
}

}  // namespace gonio::cli
