// lib/LAYERS is the law: a folder of lib/ includes only itself and folders on lines above its own in that file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <regex>
#include <set>

#include "meta/source_tree.h"

namespace gonio::tests {
namespace {

std::map<std::string, int> level_of_folder() {
  std::map<std::string, int> level;
  const auto lines = layers();
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (const auto& folder : lines[i]) level[folder] = static_cast<int>(i);
  return level;
}

// "camera" of "lib/camera/camera_model.h" or of "camera/camera_model.h".
std::string room_of(std::string path) {
  if (path.starts_with("lib/")) path.erase(0, 4);
  return path.substr(0, path.find('/'));
}

// The innermost folder that has a line: "explain/images" of "explain/images/terms/x.cpp", "camera" of
// "camera/quality/x.h".
std::string folder_of(std::string path, const std::map<std::string, int>& level) {
  if (path.starts_with("lib/")) path.erase(0, 4);
  for (std::size_t end = path.rfind('/'); end != std::string::npos; end = end == 0 ? end : path.rfind('/', end - 1))
    if (level.contains(path.substr(0, end))) return path.substr(0, end);
  return room_of(path);
}

TEST(Layers, EveryFolderOfLibHasItsLine) {
  const auto level = level_of_folder();
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(GONIO_SOURCE) / "lib"))
    EXPECT_TRUE(!entry.is_directory() || level.contains(entry.path().filename().string()))
        << entry.path() << " is not in lib/LAYERS";
}

TEST(Layers, FoldersIncludeOnlyWhatLiesBelowThem) {
  const auto level = level_of_folder();
  for (const auto& file : source_files("lib", {".h", ".cpp"})) {
    const std::string own = folder_of(file.path, level);
    for (const auto& include : includes_of(file)) {
      if (!include.quoted) continue;
      const std::string other = folder_of(include.name, level);
      if (other == own || own.starts_with(other + "/")) continue;
      if (!level.contains(other)) {
        ADD_FAILURE() << place(file, include.line) << ": \"" << include.name << "\" is no folder of lib/";
        continue;
      }
      EXPECT_LT(level.at(other), level.at(own))
          << place(file, include.line) << ": " << own << " may not include " << include.name << " (lib/LAYERS)";
    }
  }
}

// What a program says, asks and writes is its own: the rooms have the science, whoever calls them.
TEST(Layers, NobodyInTheLibraryKnowsTheCommandLine) {
  int includes = 0;
  for (const auto& file : source_files("lib", {".h", ".cpp"})) {
    if (file.path.starts_with("lib/cli/")) continue;
    for (const auto& include : includes_of(file))
      if (include.name.starts_with("cli/") || include.name.starts_with("tools/")) {
        ++includes;
        ADD_FAILURE() << place(file, include.line) << ": what reads options belongs to tools/<program>";
      }
  }
  EXPECT_EQ(includes, 0);
}

TEST(Layers, AProgramKnowsTheLibraryAndItsOwnFolderAlone) {
  const auto level = level_of_folder();
  for (const auto& file : source_files("tools", {".h", ".cpp"})) {
    const std::string own = file.path.substr(0, file.path.find('/', 6) + 1);  // "tools/render/"
    for (const auto& include : includes_of(file))
      EXPECT_TRUE(!include.quoted || include.name.starts_with(own) || level.contains(folder_of(include.name, level)))
          << place(file, include.line) << ": \"" << include.name << "\" is neither in " << own << " nor in lib/";
  }
}

bool third_party(const Include& include) {  // standard headers have neither a folder nor an extension
  return !include.quoted && include.name.find_first_of("./") != std::string::npos;
}

// Headers that name a library, or include one that does: path and the reason. Those of linear and optim are excused:
// matrices are what they take and give, so whoever calls them sees <Eigen/Core> himself. `but`: with these words a
// library's headers begin that are excused everywhere.
std::map<std::string, std::string> headers_that_name_a_library(const std::string& but = "<none>") {
  const auto headers = source_files("lib", {".h"});
  std::map<std::string, std::string> tainted;
  for (std::size_t before = 1; before != tainted.size();) {
    before = tainted.size();
    for (const auto& header : headers) {
      if (header.path.starts_with("lib/linear/") || header.path.starts_with("lib/optim/")) continue;
      for (const auto& include : includes_of(header))
        if ((third_party(include) && !include.name.starts_with(but)) || tainted.contains("lib/" + include.name))
          tainted.emplace(header.path, place(header, include.line) + " includes " + include.name);
    }
    if (tainted.empty()) break;
  }
  return tainted;
}

// A header shows what a folder offers; the libraries behind it stay in the folder, so that they can be exchanged and
// the folders above compile quickly. A header for the folder's own sources may name them.
TEST(Layers, LibrariesStayInTheFolderThatUsesThem) {
  const auto tainted = headers_that_name_a_library();
  for (const auto& file : source_files("lib", {".h", ".cpp"}))
    for (const auto& include : includes_of(file)) {
      const auto reason = tainted.find("lib/" + include.name);
      EXPECT_TRUE(reason == tainted.end() || room_of(include.name) == room_of(file.path))
          << place(file, include.line) << ": " << include.name << " brings in a library: " << reason->second;
    }
}

// A program hands on what its room takes and gives, matrices among it; it names no library itself.
TEST(Layers, ProgramsSeeNoLibraryButTheMatricesOfTheirRoom) {
  const auto tainted = headers_that_name_a_library("Eigen/");
  for (const auto& file : source_files("tools", {".h", ".cpp"}))
    for (const auto& include : includes_of(file)) {
      EXPECT_FALSE(third_party(include)) << place(file, include.line) << ": <" << include.name << ">";
      const auto reason = tainted.find("lib/" + include.name);
      EXPECT_TRUE(reason == tainted.end())
          << place(file, include.line) << ": " << include.name << " brings in a library: " << reason->second;
    }
}

// Half a minute of every source that names one: linear/svd.h and its neighbours have them compiled once.
TEST(Layers, SlowDecompositionsAreCompiledOnce) {
  const std::regex slow(
      "Eigen::(BDCSVD|JacobiSVD|SelfAdjointEigenSolver|EigenSolver|ColPivHouseholderQR)<|(bdc|jacobi)Svd");
  for (const auto& folder : {"lib", "tools", "tests"})
    for (const auto& file : source_files(folder, {".h", ".cpp"})) {
      if (file.path.starts_with("lib/linear/") || file.path.starts_with("tests/linear/")) continue;
      if (file.path.starts_with("tests/sealed/")) continue;  // has mathematics of its own
      for (std::size_t i = 0; i < file.lines.size(); ++i)
        EXPECT_FALSE(std::regex_search(without_comment(file.lines[i]), slow))
            << place(file, i + 1) << ": compiled once in lib/linear";
    }
}

TEST(Layers, HeadersDoNotIncludeSources) {
  for (const auto& folder : {"lib", "tools", "tests"})
    for (const auto& file : source_files(folder, {".h", ".cpp"}))
      for (const auto& include : includes_of(file))
        EXPECT_FALSE(include.name.ends_with(".cpp")) << place(file, include.line);
}

TEST(Layers, NoIncludeCycleAmongHeaders) {
  std::map<std::string, std::vector<std::string>> next;
  for (const auto& file : source_files("lib", {".h"}))
    for (const auto& include : includes_of(file))
      if (include.quoted) next[file.path].push_back("lib/" + include.name);
  std::set<std::string> finished, open;
  const std::function<void(const std::string&)> visit = [&](const std::string& path) {
    if (finished.contains(path)) return;
    EXPECT_TRUE(open.insert(path).second) << path << ":1: includes itself by way of others";
    if (testing::Test::HasFailure()) return;
    for (const auto& other : next[path]) visit(other);
    open.erase(path);
    finished.insert(path);
  };
  for (const auto& file : source_files("lib", {".h"})) visit(file.path);
}

}  // namespace
}  // namespace gonio::tests
