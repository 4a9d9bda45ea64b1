// SHA-256 as 64 lower-case hexadecimal digits.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace gonio {

std::string sha256(std::string_view bytes);
// The contents are read once as long as the file stays what it is (device, inode, size, time of the last change).
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace gonio
