// NumPy's .npy: an array of three axes, [k][j][i] as NumPy's users index volumes, whichever way its bytes lie. The
// format knows neither spacing nor origin.
#include <algorithm>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/npy_head.h"
#include "io/volume_grid.h"
#include "io/volume_samples.h"

namespace gonio::io::volumes {
namespace {

constexpr std::size_t longest_npy_head = (1 << 16) + 12;
constexpr std::uint64_t most_npy_samples = std::uint64_t{1} << 46;
constexpr std::size_t kept_floats = std::size_t{1} << 26;

bool begins_as_npy(const std::filesystem::path&, std::string_view beginning, const VolumeWish&) {
  return beginning.starts_with("\x93NUMPY");
}

VoxelType npy_type(const NpyHead& head, const std::string& place) {
  const std::string type = std::string(1, head.kind) + std::to_string(head.bytes);
  if (type == "u1" || type == "b1") return VoxelType::u8;
  if (type == "i1") return VoxelType::i8;
  if (type == "u2") return VoxelType::u16;
  if (type == "i2") return VoxelType::i16;
  if (type == "u4") return VoxelType::u32;
  if (type == "i4") return VoxelType::i32;
  if (type == "f4") return VoxelType::f32;
  if (type == "f8") return VoxelType::f64;
  refuse_volume(place, "has samples of NumPy's type " + type, "integers of 8, 16 and 32 bits, f4 and f8 are read");
}

// fortran_order: k fastest, so that a slice lies all over the file. One walk through the file fills as many slices as
// may be kept (256 MiB), and reading forwards takes them from there.
class SlicesAcross : public VolumeSource {
 public:
  SlicesAcross(VolumeHead head, std::unique_ptr<ByteSource> bytes, bool big_endian)
      : bytes_(std::move(bytes)), swapped_(is_swapped(big_endian)) {
    head_ = std::move(head);
  }
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    check_slices(head_, first, count, to);
    const std::size_t slice = head_.size[0] * head_.size[1];
    for (std::size_t k = first; k < first + count; ++k) {
      if (k < kept_first_ || k >= kept_first_ + kept_count_) keep_from(k);
      std::copy_n(kept_.begin() + static_cast<std::ptrdiff_t>((k - kept_first_) * slice), slice,
                  to.begin() + static_cast<std::ptrdiff_t>((k - first) * slice));
    }
    check_samples(to, head_, first);
  }

 private:
  void keep_from(std::size_t first) {
    const auto [nx, ny, nz] = head_.size;
    const std::size_t slice = nx * ny, sample = bytes_of(head_.type);
    kept_count_ = std::min(nz - first, std::max<std::size_t>(1, kept_floats / slice));
    kept_first_ = first;
    kept_.resize(kept_count_ * slice);
    // [k][j][i] in Fortran's order: column n = i * ny + j of nz samples each.
    const std::size_t columns_at_once = std::max<std::size_t>(1, (std::size_t{1} << 20) / nz);
    std::vector<char> stored;
    std::vector<float> values;
    for (std::size_t column = 0; column < slice; column += columns_at_once) {
      throw_if_interrupted();
      const std::size_t some = std::min(columns_at_once, slice - column);
      stored.resize(some * nz * sample);
      values.resize(some * nz);
      bytes_->read(std::uint64_t{column} * nz * sample, stored);
      decode_samples(stored, head_.type, swapped_, 1, 0, values);
      for (std::size_t n = 0; n < some; ++n) {
        const std::size_t i = (column + n) / ny, j = (column + n) % ny;
        for (std::size_t k = 0; k < kept_count_; ++k) kept_[k * slice + j * nx + i] = values[n * nz + first + k];
      }
    }
  }

  std::unique_ptr<ByteSource> bytes_;
  bool swapped_;
  std::vector<float> kept_;
  std::size_t kept_first_ = 0, kept_count_ = 0;
};

std::unique_ptr<VolumeSource> open_npy(const std::filesystem::path& path, const VolumeWish& wish) {
  const std::string place = path.string(), beginning = beginning_of_file(path, longest_npy_head);
  std::string_view rest = beginning;
  const NpyHead stated = npy_head(rest, place, most_npy_samples);
  if (stated.size.size() != 3)
    refuse_volume(place, "has " + std::to_string(stated.size.size()) + " axes, and a volume has 3",
                  "save one array [slices, rows, columns]");
  VolumeHead head{
      .type = npy_type(stated, place), .format = stated.fortran ? "NumPy, Fortran's order" : "NumPy", .files = {path}};
  for (std::size_t a = 0; a < 3; ++a) head.size[a] = checked_side(static_cast<std::int64_t>(stated.size[2 - a]), place);
  const std::uint64_t bytes = checked_volume_bytes(head, place);
  check_wish_of_described(head, wish, place);
  settle_grid({}, wish, head, place);
  const std::uint64_t first = beginning.size() - rest.size(), length = length_of_file(path);
  if (length - first != bytes)
    refuse_volume(place, "has " + std::to_string(length - first) + " bytes of data where its head makes " +
                             std::to_string(bytes));
  auto data = bytes_of_files({{.path = path, .first = first}}, bytes);
  if (stated.fortran) return std::make_unique<SlicesAcross>(std::move(head), std::move(data), stated.swapped);
  return linear_volume(std::move(head), std::move(data), stated.swapped);
}

}  // namespace

const VolumeFormat& npy() {
  static const VolumeFormat format{
      .name = "NumPy",
      .sentence =
          ".npy, an array [slices, rows, columns] in either order: says no lengths, so the spacing must be said "
          "with --voxel",
      .mine = begins_as_npy,
      .open = open_npy,
      .order = 10};
  return format;
}

}  // namespace gonio::io::volumes
