// Which format a file has, and volumes in memory.
#include "io/volume.h"

#include <algorithm>
#include <new>

#include "base/error.h"
#include "io/volume_bytes.h"
#include "io/volume_grid.h"
#include "io/volume_samples.h"

namespace gonio::io {
namespace {

constexpr std::size_t beginning_bytes = 1024;

class VolumeInMemory : public VolumeSource {
 public:
  explicit VolumeInMemory(VolumeData data) : values_(std::move(data.values)) { head_ = std::move(data.head); }
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    check_slices(head_, first, count, to);
    const std::size_t slice = head_.size[0] * head_.size[1];
    std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(first * slice), to.size(), to.begin());
    check_samples(to, head_, first);
  }

 private:
  std::vector<float> values_;
};

std::vector<const VolumeFormat*> formats_in_order() {
  const auto all = all_volume_formats();
  std::vector<const VolumeFormat*> formats(all.begin(), all.end());
  std::stable_sort(formats.begin(), formats.end(), [](const auto* a, const auto* b) { return a->order < b->order; });
  return formats;
}

}  // namespace

std::size_t bytes_of(VoxelType type) {
  switch (type) {
    case VoxelType::u8:
    case VoxelType::i8: return 1;
    case VoxelType::u16:
    case VoxelType::i16: return 2;
    case VoxelType::f64: return 8;
    default: return 4;
  }
}

const char* name_of(VoxelType type) {
  switch (type) {
    case VoxelType::u8: return "uint8";
    case VoxelType::i8: return "int8";
    case VoxelType::u16: return "uint16";
    case VoxelType::i16: return "int16";
    case VoxelType::u32: return "uint32";
    case VoxelType::i32: return "int32";
    case VoxelType::f32: return "float32";
    case VoxelType::f64: break;
  }
  return "float64";
}

std::unique_ptr<VolumeSource> open_volume(const std::filesystem::path& path, const VolumeWish& wish) {
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(path, ignored);
  if (!folder) length_of_file(path);  // there, and a plain file?
  const std::string beginning = folder ? std::string() : beginning_of_file(path, beginning_bytes);
  for (const VolumeFormat* format : formats_in_order())
    if (format->mine(path, beginning, wish)) return format->open(path, wish);
  if (folder)
    refuse_volume(path.string(), "holds no slices of a volume",
                  "name a folder of DICOM files, or of TIFF or PNG slices");
  refuse_volume(path.string(), "begins like no volume that gonio reads",
                "where it holds raw samples, say --size 512x512x400 and --type uint16");
}

VolumeData read_volume(const std::filesystem::path& path, const VolumeWish& wish) {
  const auto source = open_volume(path, wish);
  VolumeData data{source->head(), {}};
  try {
    data.values.resize(data.head.voxels());
  } catch (const std::bad_alloc&) {
    throw Error(Exit::unavailable, path.string(), size_text(data.head.size) + " voxels do not fit into memory",
                "read it slice by slice, or a part of it");
  }
  source->read(0, data.head.size[2], data.values);
  return data;
}

std::unique_ptr<VolumeSource> source_of(VolumeData data) {
  if (data.values.size() != data.head.voxels())
    throw Error(Exit::internal, "volume",
                std::to_string(data.values.size()) + " values are given for " + size_text(data.head.size) + " voxels");
  return std::make_unique<VolumeInMemory>(std::move(data));
}

}  // namespace gonio::io
