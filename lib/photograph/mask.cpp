#include "photograph/mask.h"

#include "base/error.h"
#include "io/picture.h"

namespace gonio::photograph {

Mask read_mask(const std::filesystem::path& path) {
  const io::Image raw = io::read_picture(path);
  Mask mask{raw.width, raw.height, std::vector<std::uint8_t>(raw.pixels())};
  for (std::size_t i = 0; i < raw.pixels(); ++i) mask.counts[i] = raw.data[i * raw.channels.size()] > 0.5f;
  return mask;
}

std::vector<std::uint8_t> read_mask_of(const io::Image& picture, const std::filesystem::path& path,
                                       const std::string& place) {
  Mask mask = read_mask(path);
  if (mask.width != picture.width || mask.height != picture.height)
    throw Error(Exit::data, place, "has another size than the picture", "crop both alike");
  return std::move(mask.counts);
}

}  // namespace gonio::photograph
