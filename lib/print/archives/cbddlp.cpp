// CBDDLP of Chitubox, the older one, also called .photon: 9 greys, as 8 sets of pixels above a threshold. See
// print/chitubox.h.
#include "print/chitubox.h"

namespace gonio::print::archives {
const ArchiveFormat& cbddlp();

namespace {

bool begins_as_cbddlp(const std::filesystem::path&, std::string_view beginning) {
  return chitubox_magic(beginning) == cbddlp_magic;
}
std::unique_ptr<ArchiveWriter> begin_cbddlp(const std::filesystem::path& path, const Job& job) {
  return begin_chitubox(cbddlp(), path, job, cbddlp_magic);
}
std::string encode_cbddlp(const Job&, std::span<const std::uint8_t> picture) {
  return encode_level_sets(picture);
}

}  // namespace

const ArchiveFormat& cbddlp() {
  static const ArchiveFormat format{
      .name = "CBDDLP",
      .sentence = ".cbddlp and .photon of Chitubox, version 2: 9 greys, layers of any thickness, lift",
      .extensions = {".cbddlp", ".photon"},
      .holds = job_pixel_size | job_layers | job_each_layer | job_mirror | job_exposure | job_lift | job_printer |
               job_resin_density | job_resin_volume | job_time | job_previews,
      .greys = 9,
      .mine = begins_as_cbddlp,
      .open = open_chitubox,
      .begin = begin_cbddlp,
      .encode = encode_cbddlp,
      .order = 20};
  return format;
}

}  // namespace gonio::print::archives
