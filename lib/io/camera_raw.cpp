// See camera_raw.h. LibRaw is loaded when the first raw file is read: it brings colour management and OpenMP along, and
// most runs of most programs never open one. CMake says which file the library is (GONIO_LIBRAW).
#include "io/camera_raw.h"

#include <libraw/libraw.h>

#include <algorithm>
#include <array>
#include <bit>
#include <memory>

#include "base/error.h"
#include "base/loaded_library.h"
#include "base/lower_case.h"
#include "base/text.h"

namespace gonio::io {
namespace {

constexpr std::array raw_extensions{".3fr", ".arw", ".cr2", ".cr3", ".crw", ".dcr", ".dng", ".erf", ".iiq",
                                    ".kdc", ".mef", ".mos", ".mrw", ".nef", ".nrw", ".orf", ".pef", ".raf",
                                    ".raw", ".rw2", ".rwl", ".sr2", ".srf", ".srw", ".x3f"};

// LibRaw's functions by their own declarations.
struct RawLibrary {
  decltype(&libraw_init) init;
  decltype(&libraw_close) close;
  decltype(&libraw_open_buffer) open_buffer;
  decltype(&libraw_unpack) unpack;
  decltype(&libraw_COLOR) colour;
  decltype(&libraw_strerror) words;
  decltype(&libraw_set_dataerror_handler) on_damage;
};

const RawLibrary& raw_library() {
  static const RawLibrary loaded = [] {
    RawLibrary all{};
    const auto find = [](auto& function, const char* name) {
      load(function, GONIO_LIBRAW, name, "install LibRaw as it was when this was built");
    };
    find(all.init, "libraw_init");
    find(all.close, "libraw_close");
    find(all.open_buffer, "libraw_open_buffer");
    find(all.unpack, "libraw_unpack");
    find(all.colour, "libraw_COLOR");
    find(all.words, "libraw_strerror");
    find(all.on_damage, "libraw_set_dataerror_handler");
    return all;
  }();
  return loaded;
}

constexpr const char* fetch_again = "fetch it from the camera again";

Error no_raw(const std::string& place, const std::string& problem, const std::string& remedy) {
  return {Exit::data, place, problem, remedy};
}

// Of the 2 x 2 filters at the corner of what sees light; empty: they are no Bayer grid.
std::string mosaic_at_corner(libraw_data_t* raw) {
  const libraw_iparams_t& said = raw->idata;
  if (said.filters == 0) return said.colors == 1 ? "Mono" : "";
  if (said.filters < 1000 || said.colors != 3) return "";  // 9: Fujifilm's grid of 6 x 6; others: LibRaw's own codes
  if (raw->rawdata.ioparams.fuji_width != 0) return "";    // a grid that stands on its corner
  std::string corner;
  for (const int at : {0, 1, 2, 3}) {
    const int colour = raw_library().colour(raw, at / 2, at % 2);
    if (colour < 0 || colour > 3) return "";
    corner += said.cdesc[colour];
  }
  for (const std::string order : {"RGGB", "GRBG", "GBRG", "BGGR"})
    if (corner == order) return "Bayer" + order.substr(0, 2);
  return "";
}

void take_samples(const libraw_data_t& raw, CameraRaw& picture, const std::string& place) {
  const libraw_image_sizes_t& sizes = raw.sizes;
  const std::uint16_t* all = raw.rawdata.raw_image;
  if (all == nullptr) throw no_raw(place, "holds colours: it is not as the sensor saw it", "let the camera write RAW");
  if (sizes.left_margin + sizes.width > sizes.raw_width || sizes.top_margin + sizes.height > sizes.raw_height)
    throw no_raw(place, "says that more of it sees light than it has pixels", {});
  picture.width = sizes.width;
  picture.height = sizes.height;
  const std::size_t stride = sizes.raw_pitch / sizeof *all;
  picture.samples.reserve(std::size_t{sizes.width} * sizes.height);
  for (std::size_t y = 0; y < sizes.height; ++y) {
    const std::uint16_t* row = all + (y + sizes.top_margin) * stride + sizes.left_margin;
    picture.samples.insert(picture.samples.end(), row, row + sizes.width);
  }
  if (picture.samples.empty()) throw no_raw(place, "has no pixels", {});
  const auto [least, most] = std::ranges::minmax(picture.samples);
  if (least == most)
    throw no_raw(place, format("holds %u in every pixel: it is cut off", unsigned{least}), fetch_again);
  const unsigned largest = std::max<unsigned>(raw.color.maximum, most);
  picture.bits = std::max(8, static_cast<int>(std::bit_width(std::min(largest, 65535U))));
}

// What the camera says of black, full scale and colours. LibRaw states black as a number for all, plus one for each
// colour, plus a grid.
void take_colour(libraw_data_t* raw, CameraRaw& picture) {
  const libraw_colordata_t& said = raw->color;
  for (const unsigned at : {0U, 1U, 2U, 3U}) {
    const unsigned row = at / 2, column = at % 2;
    const int colour =
        raw->idata.filters == 0 ? 0 : raw_library().colour(raw, static_cast<int>(row), static_cast<int>(column));
    double black = said.black;
    if (colour >= 0 && colour < 4) black += said.cblack[colour];
    if (const unsigned rows = said.cblack[4], columns = said.cblack[5];
        rows > 0 && columns > 0 && rows * columns <= LIBRAW_CBLACK_SIZE - 6)
      black += said.cblack[6 + row % rows * columns + column % columns];
    picture.black[at] = black;
  }
  picture.white = said.maximum;
  if (said.cam_mul[0] > 0 && said.cam_mul[1] > 0 && said.cam_mul[2] > 0)
    for (const std::size_t c : {0, 1, 2}) picture.neutral[c] = static_cast<double>(said.cam_mul[1]) / said.cam_mul[c];
}

}  // namespace

bool is_camera_raw(const std::filesystem::path& path) {
  return std::ranges::find(raw_extensions, lower_case(path.extension().string())) != raw_extensions.end();
}

CameraRaw decode_camera_raw(const std::string& bytes, const std::string& place) {
  const RawLibrary& library = raw_library();
  const std::unique_ptr<libraw_data_t, decltype(&libraw_close)> raw(library.init(0), library.close);
  if (!raw) throw Error(Exit::internal, place, "finds no memory", {});
  bool damaged = false;
  // The last is the place in the file, whose type differs between versions.
  library.on_damage(
      raw.get(), [](void* note, const char*, auto) { *static_cast<bool*>(note) = true; }, &damaged);
  const auto check = [&](int answer) {
    if (answer != LIBRAW_SUCCESS)
      throw no_raw(place, std::string("is no raw file that can be read: ") + library.words(answer),
                   "let the camera write RAW, or convert it to DNG");
  };
  check(library.open_buffer(raw.get(), const_cast<char*>(bytes.data()), bytes.size()));
  check(library.unpack(raw.get()));
  if (damaged) throw no_raw(place, "is damaged or cut off", fetch_again);
  CameraRaw picture;
  picture.mosaic = mosaic_at_corner(raw.get());
  take_samples(*raw, picture, place);
  if (picture.mosaic.empty()) throw no_raw(place, "has no Bayer grid of filters", "a camera with one, or with none");
  take_colour(raw.get(), picture);
  if (raw->other.shutter > 0) picture.exposure_s = raw->other.shutter;
  if (raw->other.iso_speed > 0) picture.iso = raw->other.iso_speed;
  picture.camera = std::string(raw->idata.make) + " " + raw->idata.model;
  return picture;
}

}  // namespace gonio::io
