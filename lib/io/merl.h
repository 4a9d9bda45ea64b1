// Measured isotropic reflectance in the file format of the MERL database (Matusik et al. 2003): three little-endian
// int32, the numbers of bins of theta_h, theta_d and phi_d (90, 90 and 180 in the database; any are read), then as many
// doubles for red, for green and for blue, phi_d running fastest. A stored number times 1/1500, 1.15/1500, 1.66/1500
// (red, green, blue) is the BRDF in 1/sr; negative numbers mean that nothing was measured there.
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string_view>
#include <vector>

namespace gonio::io {

struct MerlTable {
  std::array<std::size_t, 3> bins{};  // theta_h, theta_d, phi_d
  std::vector<float> brdf_per_sr;     // [theta_h][theta_d][phi_d][red, green, blue]; negative: not measured
  std::size_t cells() const { return bins[0] * bins[1] * bins[2]; }
};

// Error(data | no_input). The file's length is checked against its numbers of bins before anything is allocated.
MerlTable read_merl(const std::filesystem::path& path);
MerlTable parse_merl(std::string_view file, const std::string& place);
void write_merl(const std::filesystem::path& path, const MerlTable& table);

// Parts of a table, for callers that work on many tables at once. The constructor checks the head and the length as
// read_merl() does; rings() checks the numbers. May be shared by threads.
class MerlFile {
 public:
  explicit MerlFile(const std::filesystem::path& path);
  const std::array<std::size_t, 3>& bins() const { return bins_; }
  // One colour (0 red, 1 green, 2 blue) of the rings first <= theta_h bin < last, [theta_h][theta_d][phi_d], in 1/sr.
  std::vector<float> rings(std::size_t colour, std::size_t first, std::size_t last) const;

 private:
  std::filesystem::path path_;
  std::array<std::size_t, 3> bins_{};
  mutable std::mutex mutex_;
  mutable std::ifstream file_;
};

}  // namespace gonio::io
