// CTB of Chitubox, of many printers with a masking display: greys of 7 bits. See print/chitubox.h.
#include "print/chitubox.h"

namespace gonio::print::archives {
const ArchiveFormat& ctb();

namespace {

bool begins_as_ctb(const std::filesystem::path&, std::string_view beginning) {
  const std::uint32_t magic = chitubox_magic(beginning);
  return magic == ctb_magic || magic == ctb4_magic || magic == locked_ctb_magic;
}
std::unique_ptr<ArchiveWriter> begin_ctb(const std::filesystem::path& path, const Job& job) {
  return begin_chitubox(ctb(), path, job, ctb_magic);
}
std::string encode_ctb(const Job&, std::span<const std::uint8_t> picture) {
  return encode_grey_runs(picture);
}

}  // namespace

const ArchiveFormat& ctb() {
  static const ArchiveFormat format{
      .name = "CTB",
      .sentence = ".ctb of Chitubox, version 2 without a key: 128 greys, layers of any thickness, lift",
      .extensions = {".ctb"},
      .holds = job_pixel_size | job_layers | job_each_layer | job_mirror | job_exposure | job_lift | job_printer |
               job_resin_density | job_resin_volume | job_time | job_previews,
      .greys = 128,
      .mine = begins_as_ctb,
      .open = open_chitubox,
      .begin = begin_ctb,
      .encode = encode_ctb,
      .order = 20};
  return format;
}

}  // namespace gonio::print::archives
