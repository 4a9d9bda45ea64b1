// NRRD, version 5, with lengths in millimetres and said to be: others than gonio read them without asking for units.
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "io/volume.h"
#include "io/volume_grid.h"
#include "io/volume_samples.h"

namespace gonio::io {
namespace {

constexpr int gzip_head = 15 + 16;

std::string vector_text(Vec3 v) {
  return "(" + shortest_text(v.x) + "," + shortest_text(v.y) + "," + shortest_text(v.z) + ")";
}

std::string nrrd_head_text(const VolumeHead& head, bool gzip) {
  std::string text = "NRRD0005\ntype: " + std::string(name_of(head.type)) + "\ndimension: 3\n";
  if (head.type == VoxelType::f32) text = "NRRD0005\ntype: float\ndimension: 3\n";
  if (head.type == VoxelType::f64) text = "NRRD0005\ntype: double\ndimension: 3\n";
  text += "sizes: " + std::to_string(head.size[0]) + " " + std::to_string(head.size[1]) + " " +
          std::to_string(head.size[2]) + "\n";
  constexpr double mm = 1e3;
  if (head.spacing_m && (head.axes || head.origin_m)) {
    const Mat3 axes = head.axes.value_or(Mat3{});
    text += "space dimension: 3\nspace units: \"mm\" \"mm\" \"mm\"\nspace directions:";
    for (int c = 0; c < 3; ++c)
      text += " " + vector_text(Vec3{axes(0, c), axes(1, c), axes(2, c)} * ((*head.spacing_m)[c] * mm));
    text += "\n";
    if (head.origin_m) text += "space origin: " + vector_text(*head.origin_m * mm) + "\n";
  } else if (head.spacing_m) {
    text += "spacings: " + shortest_text(head.spacing_m->x * mm) + " " + shortest_text(head.spacing_m->y * mm) + " " +
            shortest_text(head.spacing_m->z * mm) + "\nunits: \"mm\" \"mm\" \"mm\"\n";
  }
  if (bytes_of(head.type) > 1) text += std::endian::native == std::endian::big ? "endian: big\n" : "endian: little\n";
  text += gzip ? "encoding: gzip\n" : "encoding: raw\n";
  if (!head.value.empty()) text += "value:=" + head.value.substr(0, head.value.find('\n')) + "\n";
  return text + "\n";
}

// The bytes of `values`; Error(data) where one is no number of the type.
template <class T>
void encode_all(std::span<const float> values, std::string& to, const VolumeHead& head, std::size_t k,
                const std::string& place) {
  to.resize(values.size() * sizeof(T));
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double value = static_cast<double>(values[n]);
    if constexpr (std::numeric_limits<T>::is_integer)
      if (!(value >= static_cast<double>(std::numeric_limits<T>::min()) &&
            value <= static_cast<double>(std::numeric_limits<T>::max()) && value == std::floor(value)))
        throw Error(Exit::data, place + "#slice " + std::to_string(k),
                    "sample (" + std::to_string(n % head.size[0]) + ", " + std::to_string(n / head.size[0]) + ") is " +
                        shortest_text(value) + ", which " + name_of(head.type) + " does not hold",
                    "write the volume as float32");
    const T stored = static_cast<T>(value);
    std::memcpy(to.data() + n * sizeof(T), &stored, sizeof(T));
  }
}

void encode_slice(std::span<const float> values, std::string& to, const VolumeHead& head, std::size_t k,
                  const std::string& place) {
  switch (head.type) {
    case VoxelType::u8: return encode_all<std::uint8_t>(values, to, head, k, place);
    case VoxelType::i8: return encode_all<std::int8_t>(values, to, head, k, place);
    case VoxelType::u16: return encode_all<std::uint16_t>(values, to, head, k, place);
    case VoxelType::i16: return encode_all<std::int16_t>(values, to, head, k, place);
    case VoxelType::u32: return encode_all<std::uint32_t>(values, to, head, k, place);
    case VoxelType::i32: return encode_all<std::int32_t>(values, to, head, k, place);
    case VoxelType::f32: return encode_all<float>(values, to, head, k, place);
    case VoxelType::f64: return encode_all<double>(values, to, head, k, place);
  }
}

// Bytes to a file, deflated or as they are. No time is written into gzip's head: same volume, same bytes.
class NrrdFile {
 public:
  NrrdFile(const std::filesystem::path& file, bool gzip, const std::string& place)
      : out_(file, std::ios::binary | std::ios::trunc), gzip_(gzip), place_(place) {
    if (gzip && deflateInit2(&stream_, Z_BEST_SPEED + 2, Z_DEFLATED, gzip_head, 8, Z_DEFAULT_STRATEGY) != Z_OK)
      throw Error(Exit::internal, place, "zlib cannot be started");
  }
  ~NrrdFile() {
    if (gzip_) deflateEnd(&stream_);
  }
  NrrdFile(const NrrdFile&) = delete;
  NrrdFile& operator=(const NrrdFile&) = delete;

  void head(const std::string& text) { put(text); }
  void samples(std::string& bytes) {
    if (gzip_)
      squeeze(bytes, Z_NO_FLUSH);
    else
      put(bytes);
  }
  void finish() {
    std::string nothing;
    if (gzip_) squeeze(nothing, Z_FINISH);
    out_.close();
    if (!out_) fail();
  }

 private:
  void squeeze(std::string& bytes, int flush) {
    stream_.next_in = reinterpret_cast<Bytef*>(bytes.data());
    stream_.avail_in = static_cast<uInt>(bytes.size());  // a slice: write_nrrd() has checked it
    int result = Z_OK;
    do {
      squeezed_.resize(std::size_t{1} << 18);
      stream_.next_out = reinterpret_cast<Bytef*>(squeezed_.data());
      stream_.avail_out = static_cast<uInt>(squeezed_.size());
      result = deflate(&stream_, flush);
      squeezed_.resize(squeezed_.size() - stream_.avail_out);
      put(squeezed_);
    } while (stream_.avail_out == 0 || (flush == Z_FINISH && result == Z_OK));
  }
  void put(const std::string& bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out_) fail();
  }
  [[noreturn]] void fail() const {
    throw Error(Exit::io, place_, "writing failed",
                "free some space or choose another folder; nothing was left behind");
  }

  std::ofstream out_;
  bool gzip_;
  std::string place_;
  z_stream stream_{};
  std::string squeezed_;
};

}  // namespace

void write_nrrd(const std::filesystem::path& path, const VolumeHead& head,
                const std::function<void(std::size_t k, std::span<float> slice)>& slice, bool gzip) {
  const std::string place = path.string();
  checked_volume_bytes(head, place);
  const std::size_t samples = head.size[0] * head.size[1];
  if (samples * bytes_of(head.type) >= std::numeric_limits<uInt>::max())
    refuse_volume(place, "has slices of more than 4 GiB", "turn it, so that its longest axis is k");
  VolumeHead named = head;
  named.files = {path};
  write_file_through(path, [&](const std::filesystem::path& temporary) {
    NrrdFile file(temporary, gzip, place);
    file.head(nrrd_head_text(head, gzip));
    std::vector<float> values(samples);
    std::string bytes;
    for (std::size_t k = 0; k < head.size[2]; ++k) {
      throw_if_interrupted();
      slice(k, values);
      check_samples(values, named, k);
      encode_slice(values, bytes, head, k, place);
      file.samples(bytes);
    }
    file.finish();
  });
}

void write_nrrd(const std::filesystem::path& path, const VolumeData& volume, bool gzip) {
  const std::size_t slice = volume.head.size[0] * volume.head.size[1];
  if (volume.values.size() != volume.head.voxels())
    throw Error(
        Exit::internal, path.string(),
        std::to_string(volume.values.size()) + " values are given for " + size_text(volume.head.size) + " voxels");
  write_nrrd(
      path, volume.head,
      [&](std::size_t k, std::span<float> to) {
        std::copy_n(volume.values.begin() + static_cast<std::ptrdiff_t>(k * slice), slice, to.begin());
      },
      gzip);
}

}  // namespace gonio::io
