// An atlas: one grey picture of slices as tiles, row after row from the top left. The wish says how many; where not all
// tiles are slices, its size does.

#include "base/atomic_file.h"
#include "io/raster_header.h"
#include "io/volume_bytes.h"
#include "io/volume_grid.h"
#include "io/volume_picture.h"
#include "io/volume_samples.h"

namespace gonio::io::volumes {
namespace {

bool may_be_atlas(const std::filesystem::path&, std::string_view beginning, const VolumeWish& wish) {
  return is_picture(beginning) && (wish.tiles || !is_tiff(beginning)) && !(wish.size && wish.type && !wish.tiles);
}

class Atlas : public VolumeSource {
 public:
  Atlas(VolumeHead head, GreyCodes picture, std::size_t columns) : picture_(std::move(picture)), columns_(columns) {
    head_ = std::move(head);
  }
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    check_slices(head_, first, count, to);
    const auto [nx, ny, nz] = head_.size;
    const std::size_t sample = bytes_of(head_.type);
    for (std::size_t k = first; k < first + count; ++k)
      for (std::size_t j = 0; j < ny; ++j) {
        const std::size_t row = k / columns_ * ny + j, at = row * picture_.width + k % columns_ * nx;
        decode_samples(std::span(picture_.bytes).subspan(at * sample, nx * sample), head_.type, false, 1, 0,
                       to.subspan(((k - first) * ny + j) * nx, nx));
      }
    check_samples(to, head_, first);
  }

 private:
  GreyCodes picture_;
  std::size_t columns_;
};

std::unique_ptr<VolumeSource> open_atlas(const std::filesystem::path& path, const VolumeWish& wish) {
  const std::string place = path.string(), bytes = read_file(path);
  const RasterHeader picture = read_raster_header(bytes, place);
  if (!wish.tiles)
    refuse_volume(place,
                  "is one picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                      " pixels; a volume of it has tiles, and it does not say how many",
                  "say them with --tiles 16x16, columns and rows");
  const auto [columns, rows] = *wish.tiles;
  if (columns == 0 || rows == 0 || columns > picture.width || rows > picture.height || picture.width % columns != 0 ||
      picture.height % rows != 0)
    refuse_volume(place,
                  "has " + std::to_string(picture.width) + " x " + std::to_string(picture.height) + " pixels, which " +
                      std::to_string(columns) + " x " + std::to_string(rows) + " tiles do not divide",
                  "correct --tiles");
  VolumeHead head{.size = {static_cast<std::size_t>(picture.width / columns),
                           static_cast<std::size_t>(picture.height / rows), columns * rows},
                  .format = "atlas",
                  .files = {path}};
  if (wish.size && (*wish.size)[2] >= 1 && (*wish.size)[2] < head.size[2])
    head.size[2] = (*wish.size)[2];  // the last tiles are none of the volume
  GreyCodes codes = decode_grey_codes(bytes, place);
  head.type = codes.type;
  checked_volume_bytes(head, place);
  VolumeWish rest = wish;
  rest.tiles.reset();
  check_wish_of_described(head, rest, place);
  settle_grid({}, wish, head, place);
  return std::make_unique<Atlas>(std::move(head), std::move(codes), columns);
}

}  // namespace

const VolumeFormat& atlas() {
  static const VolumeFormat format{
      .name = "atlas",
      .sentence =
          "one grey picture of slices as tiles, row after row from the top left: --tiles and --voxel say the "
          "rest, and --size where the last tiles are empty",
      .mine = may_be_atlas,
      .open = open_atlas,
      .order = 40};
  return format;
}

}  // namespace gonio::io::volumes
