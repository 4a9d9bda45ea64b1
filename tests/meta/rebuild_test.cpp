// What has to be compiled again after a change, told from the includes alone: who adds a field to one section of the
// manifest, or edits a mechanism, a surface, a light or a law, waits for one source in twenty and no more.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "meta/source_tree.h"

namespace gonio::tests {
namespace {

constexpr double largest_share = 0.05;

class Tree {
 public:
  Tree() {
    for (const char* folder : {"lib", "tools", "tests"})
      for (const auto& file : source_files(folder, {".h", ".cpp"})) files_[file.path] = file;
    for (const auto& [path, file] : files_)
      for (const Include& include : includes_of(file))
        if (const std::string target = found(path, include.name); include.quoted && !target.empty()) {
          includes_[path].insert(target);
          included_by_[target].insert(path);
        }
  }
  // Sources (.cpp) that see `path`, itself among them.
  std::set<std::string> touched_by(const std::string& path) const {
    std::set<std::string> sources;
    for (const auto& file : reached(path, included_by_))
      if (file.ends_with(".cpp")) sources.insert(file);
    return sources;
  }
  std::set<std::string> seen_by(const std::string& path) const { return reached(path, includes_); }
  std::size_t sources() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(files_, [](const auto& file) { return file.first.ends_with(".cpp"); }));
  }
  const std::map<std::string, SourceFile>& files() const { return files_; }

 private:
  using Edges = std::map<std::string, std::set<std::string>>;
  // As the compiler looks it up: beside the source, then below lib/, tests/ and the root. Empty: no file of the tree.
  std::string found(const std::string& from, const std::string& name) const {
    const auto beside = (std::filesystem::path(from).parent_path() / name).lexically_normal().generic_string();
    for (const std::string& candidate : {beside, "lib/" + name, "tests/" + name, name})
      if (files_.contains(candidate)) return candidate;
    return {};
  }
  static std::set<std::string> reached(const std::string& start, const Edges& edges) {
    std::set<std::string> seen{start};
    for (std::vector<std::string> open{start}; !open.empty();) {
      const std::string path = open.back();
      open.pop_back();
      if (const auto next = edges.find(path); next != edges.end())
        for (const auto& other : next->second)
          if (seen.insert(other).second) open.push_back(other);
    }
    return seen;
  }

  std::map<std::string, SourceFile> files_;
  Edges includes_, included_by_;
};

const Tree& tree() {
  static const Tree the_tree;
  return the_tree;
}

std::size_t allowed() {
  return static_cast<std::size_t>(largest_share * static_cast<double>(tree().sources()));
}

bool is_section(const std::string& path) {
  return path.starts_with("lib/manifest/sections/") && path != "lib/manifest/sections/forward.h";
}

// Sections, and whatever lies in the folders of the registries: models, laws, mechanisms.
std::vector<std::string> edited_often() {
  std::vector<std::string> paths;
  for (const auto& [path, file] : tree().files())
    if (is_section(path) || (path.starts_with("lib/") &&
                             (path.find("/mechanisms/") != std::string::npos ||
                              path.find("/models/") != std::string::npos || path.find("/laws/") != std::string::npos)))
      paths.push_back(path);
  return paths;
}

std::string worst_of(const std::vector<std::string>& paths) {
  std::vector<std::pair<std::size_t, std::string>> counts;
  for (const auto& path : paths) counts.emplace_back(tree().touched_by(path).size(), path);
  std::ranges::sort(counts, std::greater{});
  std::ostringstream text;
  for (std::size_t i = 0; i < std::min<std::size_t>(counts.size(), 10); ++i)
    text << "\n  " << counts[i].first << " " << counts[i].second;
  return text.str();
}

TEST(Rebuild, AChangeOfOneSectionMechanismOrModelTouchesOneSourceInTwenty) {
  const auto paths = edited_often();
  ASSERT_GT(paths.size(), 100U);
  for (const auto& path : paths)
    EXPECT_LE(tree().touched_by(path).size(), allowed())
        << path << ": too many of " << tree().sources() << " sources see it. Those that only pass a section on include "
        << "manifest/sections/forward.h; names_in(), has_entry() (manifest/document.h) ask who is in it, and "
        << "manifest/image_list.h has what most ask of images. The worst:" << worst_of(paths);
}

// Where one of these saw a section, that section's fields would be everybody's.
TEST(Rebuild, WhatManyIncludeSeesNoSection) {
  for (const char* path :
       {"lib/manifest/document.h", "lib/manifest/model.h", "lib/manifest/section_tables.h",
        "lib/manifest/field_makers.h", "lib/mechanism/mechanism.h", "lib/surface/surface.h", "lib/light/light.h",
        "lib/camera/camera_model.h", "lib/scene/scene.h", "lib/cli/program.h", "lib/inference/problem.h"}) {
    ASSERT_TRUE(tree().files().contains(path)) << path;
    for (const auto& seen : tree().seen_by(path)) EXPECT_FALSE(is_section(seen)) << path << " sees " << seen;
  }
}

}  // namespace
}  // namespace gonio::tests
