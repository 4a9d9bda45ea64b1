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

struct Shape {
  std::array<std::size_t, 3> bins{};
  std::size_t cells = 0;
};

// From the head, held against the file's length.
Shape shape_of(std::string_view start, std::uintmax_t length, const std::string& place) {
  if (length < head || start.size() < head) refuse(place, "is too short for a MERL table");
  Shape shape{{}, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto bins = stored<std::int32_t>(start.data() + 4 * i);
    if (bins < 2 || bins > static_cast<std::int32_t>(most_bins))
      refuse(place,
             "claims " + std::to_string(bins) + " bins of a MERL table's angle, between 2 and 4096 are possible");
    shape.bins[i] = static_cast<std::size_t>(bins);
    shape.cells *= shape.bins[i];
  }
  const std::size_t wanted = head + 3 * shape.cells * sizeof(double);
  if (length != wanted)
    refuse(place, "has " + std::to_string(length) + " bytes where " + std::to_string(wanted) + " hold its " +
                      std::to_string(shape.cells) + " cells");
  return shape;
}

float reflectance(const char* code, std::size_t band, std::size_t cell, const std::string& place) {
  const double value = stored<double>(code) * per_code[band];
  if (!std::isfinite(value) || std::abs(value) > 1e30)
    refuse(place, "entry " + std::to_string(cell) + " is not a finite reflectance");
  return static_cast<float>(value);
}

}  // namespace

MerlTable read_merl(const std::filesystem::path& path) {
  return parse_merl(read_file(path), path.string());
}

MerlTable parse_merl(std::string_view file, const std::string& place) {
  const Shape shape = shape_of(file, file.size(), place);
  MerlTable table{shape.bins, std::vector<float>(3 * shape.cells)};
  for (std::size_t band = 0; band < 3; ++band)
    for (std::size_t i = 0; i < shape.cells; ++i) {
      const std::size_t entry = band * shape.cells + i;
      table.brdf_per_sr[3 * i + band] = reflectance(file.data() + head + entry * sizeof(double), band, entry, place);
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

MerlFile::MerlFile(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary) {
  std::error_code missing;
  const auto length = std::filesystem::file_size(path, missing);
  if (!file_ || missing) throw Error(Exit::no_input, path.string(), "cannot be read");
  std::string start(std::min<std::uintmax_t>(length, head), 0);
  file_.read(start.data(), static_cast<std::streamsize>(start.size()));
  bins_ = shape_of(start, length, path.string()).bins;
}

std::vector<float> MerlFile::rings(std::size_t colour, std::size_t first, std::size_t last) const {
  const std::size_t ring = bins_[1] * bins_[2], begin = (colour * bins_[0] + first) * ring;
  std::string bytes((last - first) * ring * sizeof(double), 0);
  {
    const std::lock_guard lock(mutex_);
    file_.seekg(static_cast<std::streamoff>(head + begin * sizeof(double)));
    if (!file_.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
      throw Error(Exit::io, path_.string(), "could not be read to its end");
  }
  std::vector<float> values((last - first) * ring);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = reflectance(bytes.data() + i * sizeof(double), colour, begin + i, path_.string());
  return values;
}

}  // namespace gonio::io
