// Heads of volumes that are text: their words, numbers and names of data files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::io {

std::string_view trimmed(std::string_view text);
std::string lower(std::string_view text);
std::vector<std::string> words(std::string_view text);  // parted by blanks and commas

// Decimal numbers, all of the word; nothing where it is none. "nan" is a number that is none.
std::optional<double> number_of(std::string_view word);
std::optional<std::int64_t> integer_of(std::string_view word);
// As many as `count` of them in `text`; Error(data) at `place` naming `field` otherwise.
std::vector<double> numbers_of(std::string_view text, std::size_t count, const char* field, const std::string& place);
std::vector<std::int64_t> integers_of(std::string_view text, std::size_t count, const char* field,
                                      const std::string& place);
// What a message may show of a file's text: at most 40 characters, those that print.
std::string shown(std::string_view text);

// Metres of a unit of length as people and programs write it ("mm", "um", "microns", ...).
std::optional<double> metres_of_unit(std::string_view unit);

// A data file beside its head. Error(data) for a name that leads out of the head's folder: what a head asks to be read
// is no more trusted than the head.
std::filesystem::path beside(const std::filesystem::path& head, std::string_view name);
// Names by printf's pattern with one %d, %03d or %i for first, first + step, ... up to last. Error(data) for any other
// pattern, and for more than 2^20 files.
std::vector<std::string> names_of_pattern(std::string_view pattern, std::int64_t first, std::int64_t last,
                                          std::int64_t step, const std::string& place);

}  // namespace gonio::io
