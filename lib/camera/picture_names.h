// Whose picture a file is, by its name: left01.jpg or left/01.jpg of a camera that is called left.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonio::camera {

// The camera that a name speaks of; nothing where that is none or several. A longer name beats one that it contains.
std::string camera_in_name(const std::string& name, const std::vector<std::string>& cameras);
// That of the file's name without its extension, else of its folder's.
std::string camera_of_picture(const std::filesystem::path& path, const std::vector<std::string>& cameras);

}  // namespace gonio::camera
