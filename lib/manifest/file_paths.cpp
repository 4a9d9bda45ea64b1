// See file_paths.h.
#include "manifest/file_paths.h"

#include "manifest/sections/file.h"

namespace gonio::manifest {
namespace {

namespace fs = std::filesystem;

fs::path absolute_by_letters(const fs::path& path) {
  return fs::absolute(path.empty() ? fs::path(".") : path).lexically_normal();
}

// Links followed as far as the place exists.
fs::path real_place(const fs::path& path) {
  std::error_code ignored;
  return fs::weakly_canonical(absolute_by_letters(path), ignored);
}

}  // namespace

fs::path place_of_entry(const fs::path& folder, const std::string& entry) {
  return (folder / entry).lexically_normal();
}

std::string entry_for(const fs::path& place, const fs::path& folder) {
  return absolute_by_letters(place).lexically_relative(absolute_by_letters(folder)).generic_string();
}

bool lies_within(const fs::path& place, const fs::path& folder) {
  const fs::path real = real_place(place), root = real_place(folder);
  if (real.empty() || root.empty()) return false;  // a place that cannot be looked at
  const fs::path way = real.lexically_relative(root);
  return !way.empty() && *way.begin() != "..";
}

void move_to_folder(Document& document, const fs::path& folder) {
  const fs::path before = absolute_by_letters(document.folder), after = absolute_by_letters(folder);
  if (before != after)
    for (auto& [id, file] : document.files) file.path = entry_for(place_of_entry(before, file.path), after);
  document.folder = folder.empty() ? fs::path(".") : folder;
}

}  // namespace gonio::manifest
