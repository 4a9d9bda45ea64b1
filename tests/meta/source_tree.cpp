#include "meta/source_tree.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace gonio::tests {
namespace {

const std::filesystem::path root = GONIO_SOURCE;

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

}  // namespace

std::vector<SourceFile> source_files(const std::string& folder, const std::vector<std::string>& extensions) {
  std::vector<SourceFile> files;
  if (!std::filesystem::exists(root / folder)) return files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
    const auto extension = entry.path().extension().string();
    if (entry.is_regular_file() && std::find(extensions.begin(), extensions.end(), extension) != extensions.end())
      files.push_back({std::filesystem::relative(entry.path(), root).generic_string(), lines_of(entry.path())});
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return files;
}

std::vector<Include> includes_of(const SourceFile& file) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*([<"])([^>"]+)[>"])re");
  std::vector<Include> includes;
  for (std::size_t i = 0; i < file.lines.size(); ++i)
    if (std::smatch match; std::regex_search(file.lines[i], match, pattern))
      includes.push_back({match[2], match[1] == "\"", static_cast<int>(i) + 1});
  return includes;
}

std::string without_comment(const std::string& line) {
  return line.substr(0, line.find("//"));
}

std::string place(const SourceFile& file, int line) {
  return file.path + ":" + std::to_string(line);
}

std::vector<std::vector<std::string>> layers() {
  std::vector<std::vector<std::string>> result;
  for (const auto& line : lines_of(root / "lib/LAYERS")) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    result.emplace_back();
    for (std::string word; words >> word;) result.back().push_back(word);
  }
  return result;
}

}  // namespace gonio::tests
