// Raw samples: nothing but numbers, which the wish describes.
#include "base/error.h"
#include "io/volume_grid.h"
#include "io/volume_samples.h"

namespace gonio::io::volumes {
namespace {

bool may_be_raw(const std::filesystem::path&, std::string_view beginning, const VolumeWish& wish) {
  return wish.size && wish.type && !beginning.empty();
}

// All of the file: a length that is not that of the samples means a size or a type that is not the file's.
std::unique_ptr<VolumeSource> open_raw(const std::filesystem::path& path, const VolumeWish& wish) {
  const std::string place = path.string();
  VolumeHead head{.size = *wish.size, .type = *wish.type, .format = "raw", .files = {path}};
  if (wish.tiles) refuse_volume(place, "is read as raw samples, which have no tiles", "leave --tiles out");
  const std::uint64_t wanted = checked_volume_bytes(head, place), length = length_of_file(path);
  if (length < wish.skip_bytes || length - wish.skip_bytes != wanted)
    refuse_volume(place,
                  "has " + std::to_string(length) + " bytes, and " + size_text(head.size) + " voxels of " +
                      name_of(head.type) +
                      (wish.skip_bytes > 0 ? " behind the " + std::to_string(wish.skip_bytes) + " skipped" : "") +
                      " are " + std::to_string(wanted),
                  "correct --size, --type or --skip");
  settle_grid({}, wish, head, place);
  return linear_volume(std::move(head), bytes_of_files({{.path = path, .first = wish.skip_bytes}}, wanted),
                       wish.big_endian);
}

}  // namespace

const VolumeFormat& raw() {
  static const VolumeFormat format{
      .name = "raw samples",
      .sentence = "nothing but numbers: --size, --type and --voxel say the rest, and the file's length must agree",
      .mine = may_be_raw,
      .open = open_raw,
      .order = 100};
  return format;
}

}  // namespace gonio::io::volumes
