// Sizes, names and heads of files: what keeps the house readable.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>
#include <string>

#include "meta/source_tree.h"

namespace gonio::tests {
namespace {

constexpr std::size_t longest_source = 400, longest_header = 250, longest_program = 150, longest_line = 120;
constexpr std::size_t longest_function = 60;

// Style sheets inside sources: lines of CSS are not broken.
const std::set<std::string>& with_style_sheets() {
  static const std::set<std::string> files{"lib/report/page_style.cpp"};
  return files;
}

// What is still to be brought into the limit of lines; nothing new may join.
constexpr std::size_t longest_line_for_now = 140;
bool is_excused(const std::string& path) {
  for (const char* folder : {"tests/manifest/", "tests/scene/", "tests/stats/", "lib/camera/", "lib/explain/",
                             "lib/mechanism/", "lib/manifest/", "lib/robot/", "tests/bench/", "tests/camera/",
                             "tests/explain/", "tests/prove/", "tests/robot/"})
    if (path.starts_with(folder)) return true;
  return false;
}

std::vector<SourceFile> all_sources() {
  std::vector<SourceFile> files;
  for (const char* folder : {"lib", "tools", "tests"})
    for (auto& file : source_files(folder, {".h", ".cpp"})) files.push_back(std::move(file));
  return files;
}

// The table of a program's options is data: its entries count neither for the file nor for the function around them.
std::size_t length_without_options(const std::vector<std::string>& lines) {
  const std::regex begins("^ +(add\\()?\\{+\\.name = .*"), continues("^ +\\.[a-z_]+ = .*[,});]$");
  std::size_t length = 0;
  bool in_option = false;
  for (const auto& line : lines) {
    in_option = std::regex_match(line, begins) || (in_option && std::regex_match(line, continues));
    if (!in_option) ++length;
  }
  return length;
}

// Where a program is described: tools/<name>/program.cpp.
bool is_program(const std::string& path) {
  return path.starts_with("tools/") && path.ends_with("/program.cpp");
}

TEST(Files, NoneIsTooLong) {
  for (const auto& file : all_sources()) {
    const bool program = is_program(file.path);
    const std::size_t limit = program ? longest_program : file.path.ends_with(".h") ? longest_header : longest_source;
    const std::size_t length = program ? length_without_options(file.lines) : file.lines.size();
    EXPECT_LE(length, limit) << place(file, static_cast<int>(limit)) << ": " << length << " lines";
  }
}

// The layout gives functions away: a body opens at the end of a line and closes alone in the column where that line
// began.
TEST(Files, NoFunctionIsTooLong) {
  const std::regex opens(
      "^( {0,4})(?!namespace|struct|class|enum|union|if |for |while |switch |do |else|extern)[^ /#}].* \\{$");
  for (const auto& file : all_sources())
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      std::smatch match;
      if (!std::regex_match(file.lines[i], match, opens)) continue;
      // The initializers of a constructor stand four further in than its end.
      const std::size_t indent = file.lines[i].starts_with("    : ") ? 0 : static_cast<std::size_t>(match.length(1));
      const std::string closing = std::string(indent, ' ').append(1, '}');
      const auto from = file.lines.begin() + static_cast<std::ptrdiff_t>(i);
      const auto end =
          std::find_if(from, file.lines.end(), [&](const std::string& line) { return line.starts_with(closing); });
      if (end == file.lines.end()) continue;
      EXPECT_LE(length_without_options({from, end}) + 1, longest_function)
          << place(file, static_cast<int>(i) + 1) << ": " << file.lines[i];
    }
}

// Characters, not bytes: UTF-8 continuation bytes do not count.
TEST(Files, LinesFitTheColumnLimit) {
  for (const auto& file : all_sources()) {
    const std::size_t limit = is_excused(file.path) ? longest_line_for_now : longest_line;
    if (with_style_sheets().contains(file.path)) continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const auto width = std::count_if(file.lines[i].begin(), file.lines[i].end(),
                                       [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
      EXPECT_LE(width, static_cast<std::ptrdiff_t>(limit)) << place(file, static_cast<int>(i) + 1);
    }
  }
}

TEST(Files, FoldersAndFilesAreNamedAfterTheirSubject) {
  const std::regex nameless("^(utils?|common|helpers?|misc|tools?_?lib|shared|stuff)(\\..*)?$");
  for (const char* folder : {"lib", "tools", "tests", "scripts"}) {
    const auto root = std::filesystem::path(GONIO_SOURCE) / folder;
    if (!std::filesystem::exists(root)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
      EXPECT_FALSE(std::regex_match(entry.path().filename().string(), nameless)) << entry.path();
  }
}

TEST(Files, SourcesAreSnakeCase) {
  const std::regex snake("^[a-z0-9_]+\\.(h|cpp)$"), kebab("^[a-z0-9-]+\\.(h|cpp)$");
  for (const auto& file : all_sources()) {
    const auto name = std::filesystem::path(file.path).filename().string();
    const bool mechanism = file.path.find("/mechanisms/") != std::string::npos;
    EXPECT_TRUE(std::regex_match(name, snake) || (mechanism && std::regex_match(name, kebab))) << file.path;
  }
}

// Adding a program is adding a folder, called as users type it.
TEST(Files, EveryFolderOfToolsIsAProgram) {
  const std::regex kebab("^[a-z0-9-]+$");
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(GONIO_SOURCE) / "tools")) {
    EXPECT_TRUE(std::filesystem::exists(entry.path() / "program.cpp")) << entry.path();
    EXPECT_TRUE(std::regex_match(entry.path().filename().string(), kebab)) << entry.path();
  }
}

TEST(Files, EveryHeaderIsIncludedOnceAndSaysWhatItIsFor) {
  for (const char* folder : {"lib", "tools"})
    for (const auto& file : source_files(folder, {".h"})) {
      ASSERT_FALSE(file.lines.empty()) << file.path;
      EXPECT_TRUE(file.lines[0].starts_with("// ")) << place(file, 1) << ": no word about the file's purpose";
      EXPECT_THAT(file.lines, testing::Contains("#pragma once")) << place(file, 1);
    }
}

// A source may leave that to the header of its name.
TEST(Files, EverySourceOfLibAndToolsBeginsWithItsPurpose) {
  for (const char* folder : {"lib", "tools"})
    for (const auto& file : source_files(folder, {".cpp"})) {
      ASSERT_FALSE(file.lines.empty()) << file.path;
      const auto header =
          std::filesystem::path(GONIO_SOURCE) / std::filesystem::path(file.path).replace_extension(".h");
      EXPECT_TRUE(file.lines[0].starts_with("// ") || std::filesystem::exists(header))
          << place(file, 1) << ": no word about the file's purpose";
    }
}

TEST(Files, NothingIsLeftForLater) {
  const std::regex leftover(std::string("\\b(TO") + "DO|FIX" + "ME|XX" + "X|HA" + "CK)\\b");
  for (const auto& file : all_sources())
    for (std::size_t i = 0; i < file.lines.size(); ++i)
      EXPECT_FALSE(std::regex_search(file.lines[i], leftover)) << place(file, static_cast<int>(i) + 1);
}

}  // namespace
}  // namespace gonio::tests
