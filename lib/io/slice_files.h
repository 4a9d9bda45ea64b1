// Folders of slices as pictures: which files, and in which order.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonio::io {

// TIFFs, or other pictures, in a folder, in the order of the numbers in their names ("s9" before "s10"). Hidden files
// are none. Error(data) where both kinds are there.
std::vector<std::filesystem::path> slice_pictures(const std::filesystem::path& folder);
// A number that is left out between two others is a slice that is missing: Error(data).
void check_slice_numbers(const std::vector<std::filesystem::path>& files, const std::string& place);

}  // namespace gonio::io
