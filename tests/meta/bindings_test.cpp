// One equation, many bindings: a mechanism is its own file and at most one more for each simulator that has it. Nobody
// keeps a list of ids.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "mechanism/mechanism.h"
#include "meta/source_tree.h"

namespace gonio::tests {
namespace {

// The folders of bindings, one a simulator; the build gathers them (cmake/rooms.cmake).
const std::vector<std::string> simulators = {"lib/scene/edits/",
                                             "lib/render/links/",
                                             "lib/relighting/terms/",
                                             "lib/explain/tables/terms/",
                                             "lib/explain/tables/reflectance/",
                                             "lib/explain/stacks/exposures/",
                                             "lib/explain/stacks/lights/",
                                             "lib/explain/volumes/terms/",
                                             "lib/explain/prints/terms/",
                                             "lib/explain/polarization/terms/"};

// Reasons why a domain cannot ask for a mechanism stand beside the domain; explain/product_test holds their ids against
// the registry.
bool is_declaration(const std::string& path) {
  return path.find("/mechanisms/") != std::string::npos || path.find("lib/explain/domains/") != std::string::npos;
}

std::string stem_of(std::string id) {
  for (char& c : id)
    if (c == '.' || c == '-') c = '_';
  return id;
}

std::set<std::string> stems() {
  std::set<std::string> all;
  for (const mechanism::Mechanism* m : mechanism::all_mechanisms()) all.insert(stem_of(m->id));
  return all;
}

// In code, not in the help that a field or an option prints: an id alone between quotes, or in front of a full stop.
TEST(Bindings, NoSourceQuotesAnIdThatAFileDeclares) {
  std::vector<std::string> quoted;
  for (const mechanism::Mechanism* m : mechanism::all_mechanisms())
    for (const char* end : {"\"", ".\""}) quoted.push_back("\"" + m->id + end);
  for (const char* folder : {"lib", "tools"})
    for (const auto& file : source_files(folder, {".h", ".cpp"})) {
      if (is_declaration(file.path)) continue;
      for (std::size_t i = 0; i < file.lines.size(); ++i) {
        const std::string code = without_comment(file.lines[i]);
        if (code.find('"') == std::string::npos) continue;
        for (const std::string& id : quoted)
          EXPECT_EQ(code.find(id), std::string::npos)
              << place(file, static_cast<int>(i) + 1) << ": say mechanism::NAME().id, and where it is one of several, "
              << "give each a file in a folder of bindings: " << file.lines[i];
      }
    }
}

// The file's name is the mechanism's: there cannot be a second one in the same folder.
TEST(Bindings, EveryFileOfASimulatorBindsTheMechanismOfItsName) {
  const auto known = stems();
  for (const std::string& folder : simulators) {
    const auto files = source_files(folder.substr(0, folder.size() - 1), {".cpp"});
    EXPECT_GE(files.size(), 5U) << folder;
    for (const auto& file : files) {
      const std::string stem = std::filesystem::path(file.path).stem().string();
      EXPECT_TRUE(known.contains(stem)) << file.path << " is called after no mechanism";
      std::set<std::string> named;
      const std::regex bound("\\.mechanism = mechanism::([a-z_0-9]+)");
      for (const auto& line : file.lines)
        if (std::smatch match; std::regex_search(line, match, bound)) named.insert(match[1].str());
      for (const std::string& name : named) EXPECT_EQ(name, stem) << file.path;
    }
  }
}

// An equation that a header of lib/*/mechanisms has is used by name. These would write it anew; a line that lacks the
// word cannot.
TEST(Bindings, NobodyWritesAnEquationAgain) {
  struct Anew {
    const char *id, *word;
    std::regex pattern;
  };
  const std::vector<Anew> equations = {
      {"optics.vignetting", "falloff", std::regex("1 - [a-z_.]*falloff")},
      {"light.drift", "std::exp", std::regex("1 \\+ [a-z_.]*(amplitude|drift)[a-z_.]* \\* std::exp")},
      {"sensor.row-pattern", "row", std::regex("2 \\* (std::numbers::)?pi \\* [a-z_.]*row")},
      {"sensor.saturation", "std::min(", std::regex("std::min\\([a-z_.]+, [a-z_.]*full_scale\\)")},
      {"reference.tile", "1 + ", std::regex("1 \\+ [a-z_.]*(incidence|falls_in)[a-z_.]* \\*")}};
  for (const char* folder : {"lib", "tools"})
    for (const auto& file : source_files(folder, {".h", ".cpp"})) {
      if (is_declaration(file.path)) continue;
      for (std::size_t i = 0; i < file.lines.size(); ++i)
        for (const Anew& anew : equations)
          EXPECT_FALSE(file.lines[i].find(anew.word) != std::string::npos &&
                       std::regex_search(without_comment(file.lines[i]), anew.pattern))
              << place(file, static_cast<int>(i) + 1) << ": " << anew.id << " again: " << file.lines[i];
    }
}

// "Saturated" is one word: half a code below the highest is said in lib/photograph alone, and files of photographs are
// read there.
TEST(Bindings, OnlyThePhotographsReaderSaysWhatIsSaturated) {
  const std::regex half_code("0\\.5f? ?/ ?(255|65535)"), reader("\\b(read_linear|read_mask)\\(const");
  for (const auto& file : source_files("lib", {".h", ".cpp"})) {
    if (file.path.starts_with("lib/photograph/")) continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::string code = without_comment(file.lines[i]);
      const bool may = code.find("0.5") != std::string::npos || code.find("read_") != std::string::npos;
      EXPECT_FALSE(may && (std::regex_search(code, half_code) || std::regex_search(code, reader)))
          << place(file, static_cast<int>(i) + 1) << ": " << file.lines[i];
    }
  }
}

}  // namespace
}  // namespace gonio::tests
