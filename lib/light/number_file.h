// Text files of lamps: read whole, numbers taken apart without any locale.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::light {

inline constexpr std::uintmax_t largest_lamp_file = 16u << 20;

// Error(no_input | data) for files that cannot be read or are larger than largest_lamp_file.
std::string text_of(const std::filesystem::path& path, const std::string& place);

std::vector<std::string> lines_of(std::string_view text);  // without ends of lines (CR LF, LF, CR) and blanks around
std::optional<double> number_of(std::string_view word);    // finite, the whole word

}  // namespace gonio::light
