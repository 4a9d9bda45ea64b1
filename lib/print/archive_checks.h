// What every format of layer images checks (archive.h), and how it refuses.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "print/archive.h"

namespace gonio::print {

[[noreturn]] void refuse_archive(const std::string& place, const std::string& problem, const std::string& remedy);

// Sides of at most 65,535 pixels, 2^28 in all.
void check_pixels(std::int64_t width, std::int64_t height, const std::string& place);
// Every number that a job states is finite and within what can be meant.
void check_job(const Job& job, const std::string& place);

// A number of a configuration: all of `text`, finite. Error(data) that names `key`.
double archive_number(std::string_view text, const std::string& key, const std::string& place);
std::int64_t archive_count(std::string_view text, const std::string& key, const std::string& place);
std::string_view trimmed(std::string_view text);  // without blanks at its ends

std::string archive_text(double value);  // 12 digits

// Places in `names` of those that end in a number and ".png", by that number: 0, 1, ... or 1, 2, ... Error(data) for
// one that is missing, stands twice, or where there is none.
std::vector<std::size_t> numbered_pictures(const std::vector<std::string>& names, const std::string& place);

}  // namespace gonio::print
