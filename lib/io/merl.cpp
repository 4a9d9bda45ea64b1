#include "io/merl.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "base/atomic_file.h"
#include "base/error.h"

namespace gonio::io {
namespace {

constexpr std::array<double, 3> per_code = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};
constexpr std::size_t head = 3 * sizeof(std::int32_t), most_bins = 4096;

template <class T>
T stored(const char* at) {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), at, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T>
void append(std::string& bytes, T value) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

[[noreturn]] void refuse(const std::string& place, const std::string& problem) {
  throw Error(Exit::data, place, problem, "copy it again, or export it in the MERL format");
}

}  // namespace

MerlTable read_merl(const std::filesystem::path& path) {
  return parse_merl(read_file(path), path.string());
}

MerlTable parse_merl(std::string_view file, const std::string& place) {
  if (file.size() < head) refuse(place, "is too short for a MERL table");
  MerlTable table;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto bins = stored<std::int32_t>(file.data() + 4 * i);
    if (bins < 2 || bins > static_cast<std::int32_t>(most_bins))
      refuse(place,
             "claims " + std::to_string(bins) + " bins of a MERL table's angle, between 2 and 4096 are possible");
    table.bins[i] = static_cast<std::size_t>(bins);
  }
  const std::size_t cells = table.cells(), wanted = head + 3 * cells * sizeof(double);
  if (file.size() != wanted)
    refuse(place, "has " + std::to_string(file.size()) + " bytes where " + std::to_string(wanted) + " hold its " +
                      std::to_string(cells) + " cells");
  table.brdf_per_sr.resize(3 * cells);
  for (std::size_t band = 0; band < 3; ++band)
    for (std::size_t i = 0; i < cells; ++i) {
      const auto code = stored<double>(file.data() + head + (band * cells + i) * sizeof(double));
      const double value = code * per_code[band];
      if (!std::isfinite(value) || std::abs(value) > 1e30)
        refuse(place, "entry " + std::to_string(band * cells + i) + " is not a finite reflectance");
      table.brdf_per_sr[3 * i + band] = static_cast<float>(value);
    }
  return table;
}

void write_merl(const std::filesystem::path& path, const MerlTable& table) {
  std::string bytes;
  bytes.reserve(head + 3 * table.cells() * sizeof(double));
  for (const std::size_t bins : table.bins) append(bytes, static_cast<std::int32_t>(bins));
  for (std::size_t band = 0; band < 3; ++band)
    for (std::size_t i = 0; i < table.cells(); ++i) {
      const double value = static_cast<double>(table.brdf_per_sr.at(3 * i + band));
      append(bytes, value / per_code[band]);
    }
  write_file(path, bytes);
}

}  // namespace gonio::io
