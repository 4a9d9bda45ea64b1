// The project's own source tree as the tests of its rules see it.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonio::tests {

struct SourceFile {
  std::string path;                // relative to the root of the tree, with forward slashes
  std::vector<std::string> lines;  // without line ends
};

// Files below root/`folder` with one of `extensions`, sorted by path.
std::vector<SourceFile> source_files(const std::string& folder, const std::vector<std::string>& extensions);

std::string without_comment(const std::string& line);

struct Include {
  std::string name;  // as between the quotes or angle brackets
  bool quoted;
  int line;
};
std::vector<Include> includes_of(const SourceFile& file);

// "path:line" as editors understand it.
std::string place(const SourceFile& file, int line);

// The line of lib/LAYERS on which each folder stands, from 0 at the bottom.
std::vector<std::vector<std::string>> layers();

}  // namespace gonio::tests
