// Exact sums in files: shares of a picture that machines rendered apart, and checkpoints of one that goes on later.
//
// Layout: the line "gonio sums 1", one line of JSON (what the picture is, which passes, how it lies), the sums as they
// lie in memory (passes.h; 128-bit, 192-bit and 32-bit whole numbers, little-endian), a 64-bit checksum.
#pragma once
#include <filesystem>
#include <vector>

#include "render/passes.h"

namespace gonio::render {

void write_sums(const std::filesystem::path& path, const PassSums& sums, double spent_s);  // atomically

struct SumsHeader {
  PictureIdentity identity;
  std::uint32_t first_pass = 0, passes = 0;
  double spent_s = 0;  // working time so far
  std::int64_t first_sample() const { return std::int64_t{first_pass} * identity.samples_per_pass; }
  std::int64_t end_sample() const { return (std::int64_t{first_pass} + passes) * identity.samples_per_pass; }
};
// Error(no_input) where the file is missing, Error(data) where it is something else, damaged or cut off. Its length is
// checked against the header before memory is asked for.
SumsHeader read_sums_header(const std::filesystem::path& path);
PassSums read_sums(const std::filesystem::path& path);

// In which order shares of one picture follow each other. Error(data) where they are of different pictures, where two
// hold the same samples, or where some are missing in between.
std::vector<std::filesystem::path> ordered_shares(const std::vector<std::filesystem::path>& paths);
// One after the other, so that two are in memory at a time.
PassSums joined_shares(const std::vector<std::filesystem::path>& ordered);

}  // namespace gonio::render
