// Slices as pictures: one TIFF of many pages, or a folder of TIFFs (their pages one after the other) or PNGs, in the
// order of the numbers in their names. By libtiff, page by page, classic and BigTIFF.
//
// Resolution tags count dots on paper and are no spacing. ImageJ's description is one where it names a unit:
// "unit=micron" with pixels per unit in the tags and "spacing=" between slices; what has more than 4 GiB it writes as
// one page with all samples behind it.
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <map>
#include <optional>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "io/slice_files.h"
#include "io/volume_bytes.h"
#include "io/volume_grid.h"
#include "io/volume_header.h"
#include "io/volume_picture.h"
#include "io/volume_samples.h"

namespace gonio::io::volumes {
namespace {

constexpr std::size_t most_pages = 1 << 20;
constexpr std::uint64_t most_tiff_squeezed = 4096;  // LZW's and deflate's best, several times over
constexpr tmsize_t largest_tiff_block = tmsize_t{1} << 30;

int remember_error(TIFF*, void* said, const char*, const char* pattern, va_list values) {
  char text[256];
  std::vsnprintf(text, sizeof text, pattern, values);
  *static_cast<std::string*>(said) = text;
  return 1;
}
int pass_over(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

// By SampleFormat and bits.
const std::map<std::pair<int, int>, VoxelType>& tiff_types() {
  static const std::map<std::pair<int, int>, VoxelType> types{
      {{SAMPLEFORMAT_UINT, 8}, VoxelType::u8},     {{SAMPLEFORMAT_INT, 8}, VoxelType::i8},
      {{SAMPLEFORMAT_UINT, 16}, VoxelType::u16},   {{SAMPLEFORMAT_INT, 16}, VoxelType::i16},
      {{SAMPLEFORMAT_UINT, 32}, VoxelType::u32},   {{SAMPLEFORMAT_INT, 32}, VoxelType::i32},
      {{SAMPLEFORMAT_IEEEFP, 32}, VoxelType::f32}, {{SAMPLEFORMAT_IEEEFP, 64}, VoxelType::f64}};
  return types;
}

struct TiffPage {
  std::size_t width = 0, height = 0;
  VoxelType type = VoxelType::u8;
  bool operator==(const TiffPage&) const = default;
};

// An open TIFF at one of its pages.
class TiffFile {
 public:
  explicit TiffFile(const std::filesystem::path& path) : place_(path.string()), length_(length_of_file(path)) {
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, largest_tiff_block);
    TIFFOpenOptionsSetErrorHandlerExtR(options, remember_error, &said_);
    TIFFOpenOptionsSetWarningHandlerExtR(options, pass_over, nullptr);
    tiff_ = TIFFOpenExt(path.c_str(), "rm", options);  // m: no mapping, so that a file that shrinks is an error
    TIFFOpenOptionsFree(options);
    if (tiff_ == nullptr) refuse("is no TIFF that can be read");
  }
  ~TiffFile() { TIFFClose(tiff_); }
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  bool next() { return TIFFReadDirectory(tiff_) == 1; }
  void go_to(std::uint64_t directory) {
    if (TIFFSetSubDirectory(tiff_, directory) != 1) refuse("has a page that cannot be read again");
  }
  std::uint64_t directory() { return TIFFCurrentDirOffset(tiff_); }
  // libtiff takes a directory whose last bytes, the place of the next one, are cut off for the last.
  void check_directory() {
    const auto bytes = bytes_of_files({{.path = place_}}, length_);
    std::array<char, 8> beginning{}, count{};
    bytes->read(0, std::span(beginning).first(4));
    const bool wide = beginning[2] == 43 || beginning[3] == 43;
    const std::uint64_t at = directory(), entry = wide ? 20 : 12, next = wide ? 8 : 4;
    const std::size_t head = wide ? 8 : 2;
    if (at > length_ || length_ - at < head) refuse("ends within a directory of its pages");
    bytes->read(at, std::span(count).first(head));
    std::uint64_t entries = 0;
    for (std::size_t n = 0; n < head; ++n)
      entries = entries << 8 | static_cast<unsigned char>(count[is_big() ? n : head - 1 - n]);
    if (entries > length_ / entry || length_ - at < head + entries * entry + next)
      refuse("ends within a directory of its pages: truncated");
  }
  void check_walk() {  // next() is false at the end and at damage
    if (!said_.empty()) refuse("has a page that cannot be read");
  }

  TiffPage page() {
    const auto samples = number<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL, 1),
               colours = number<std::uint16_t>(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    if (samples != 1 || (colours != PHOTOMETRIC_MINISBLACK && colours != PHOTOMETRIC_MINISWHITE))
      refuse_volume(place_, "has pages in colours, and a volume has one value a voxel",
                    "write its one channel in grey");
    check_compression(number<std::uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE));
    TiffPage page{number<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0), number<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0), type()};
    checked_side(static_cast<std::int64_t>(page.width), place_);
    checked_side(static_cast<std::int64_t>(page.height), place_);
    const std::uint64_t bytes = std::uint64_t{page.width} * page.height * bytes_of(page.type);
    if (bytes / most_tiff_squeezed > length_)
      refuse_volume(place_, "claims a page of " + std::to_string(page.width) + " x " + std::to_string(page.height) +
                                " pixels, more than its " + std::to_string(length_) + " bytes can hold");
    return page;
  }

  // Stored samples of the page, rows from the top.
  void read(const TiffPage& page, std::vector<char>& to) {
    const std::size_t row = page.width * bytes_of(page.type);
    to.resize(row * page.height);
    if (TIFFIsTiled(tiff_) != 0) return read_tiles(page, to);
    if (static_cast<std::size_t>(TIFFScanlineSize(tiff_)) != row)
      refuse("has rows of another length than their pixels");
    for (std::size_t y = 0; y < page.height; ++y)
      if (TIFFReadScanline(tiff_, to.data() + y * row, static_cast<std::uint32_t>(y), 0) != 1)
        refuse("ends within row " + std::to_string(y) + " of a page");
  }

  std::string description() {
    const char* text = nullptr;
    return TIFFGetField(tiff_, TIFFTAG_IMAGEDESCRIPTION, &text) == 1 && text != nullptr ? text : "";
  }
  double per_unit(std::uint32_t tag) {
    float n = 0;
    return TIFFGetField(tiff_, tag, &n) == 1 ? static_cast<double>(n) : 0;
  }
  bool is_big() { return TIFFIsBigEndian(tiff_) != 0; }
  bool is_plain() { return number<std::uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE) == COMPRESSION_NONE; }
  std::uint64_t first_byte() { return TIFFGetStrileOffset(tiff_, 0); }
  [[noreturn]] void refuse(const std::string& problem) const {
    std::string why = said_;
    constexpr std::string_view no_row = "Read error at scanline 4294967295; ";  // libtiff's, of a whole strip
    if (why.starts_with(no_row)) why.erase(0, no_row.size());
    for (char& c : why)
      if (c < ' ' || c > '~') c = ' ';
    refuse_volume(place_, problem + (why.empty() ? "" : " (" + why + ")"));
  }

 private:
  template <class T>
  T number(std::uint32_t tag, T otherwise) {
    T value = otherwise;
    return TIFFGetFieldDefaulted(tiff_, tag, &value) == 1 ? value : otherwise;
  }

  VoxelType type() {
    const auto bits = number<std::uint16_t>(TIFFTAG_BITSPERSAMPLE, 1),
               kind = number<std::uint16_t>(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    const auto found = tiff_types().find({kind == SAMPLEFORMAT_VOID ? SAMPLEFORMAT_UINT : kind, bits});
    if (found == tiff_types().end())
      refuse_volume(place_, "has samples of " + std::to_string(bits) + " bits of TIFF's format " + std::to_string(kind),
                    "integers of 8, 16 and 32 bits and floats are read");
    return found->second;
  }

  void check_compression(int compression) {
    for (const int known : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_DEFLATE,
                            COMPRESSION_PACKBITS, COMPRESSION_ZSTD, COMPRESSION_LZMA})
      if (compression == known) return;
    const bool jpeg = compression == COMPRESSION_JPEG || compression == COMPRESSION_OJPEG;
    refuse_volume(place_,
                  jpeg ? "is compressed by JPEG, which has lost what was measured"
                       : "is compressed by TIFF's method " + std::to_string(compression),
                  "write it without compression, or with LZW or deflate");
  }

  void read_tiles(const TiffPage& page, std::vector<char>& to) {
    const std::size_t sample = bytes_of(page.type), width = number<std::uint32_t>(TIFFTAG_TILEWIDTH, 0),
                      height = number<std::uint32_t>(TIFFTAG_TILELENGTH, 0);
    const tmsize_t size = TIFFTileSize(tiff_);
    if (width == 0 || height == 0 || size <= 0 || size > largest_tiff_block ||
        static_cast<std::size_t>(size) != width * height * sample)
      refuse("has tiles of no possible size");
    if (static_cast<std::uint64_t>(size) / most_tiff_squeezed > length_) refuse("claims tiles that it cannot hold");
    std::vector<char> tile(static_cast<std::size_t>(size));
    for (std::size_t y = 0; y < page.height; y += height)
      for (std::size_t x = 0; x < page.width; x += width) {
        if (TIFFReadTile(tiff_, tile.data(), static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0, 0) < 0)
          refuse("ends within a tile");
        const std::size_t rows = std::min(height, page.height - y), columns = std::min(width, page.width - x);
        for (std::size_t r = 0; r < rows; ++r)
          std::copy_n(tile.begin() + static_cast<std::ptrdiff_t>(r * width * sample), columns * sample,
                      to.begin() + static_cast<std::ptrdiff_t>(((y + r) * page.width + x) * sample));
      }
  }

  std::string place_, said_;
  std::uint64_t length_;
  TIFF* tiff_ = nullptr;
};

void check_same_page(const TiffPage& page, const TiffPage& first, const std::string& place) {
  if (page == first) return;
  const auto text = [](const TiffPage& p) {
    return std::to_string(p.width) + " x " + std::to_string(p.height) + " " + name_of(p.type);
  };
  refuse_volume(place, "has a slice of " + text(page) + ", and the first one has " + text(first),
                "leave out what is no slice of the volume");
}

// One slice: a page of a TIFF by the place of its directory, or a PNG (0).
struct PictureSlice {
  std::filesystem::path file{};
  std::uint64_t directory = 0;
};

class PictureStack : public VolumeSource {
 public:
  PictureStack(VolumeHead head, std::vector<PictureSlice> slices) : slices_(std::move(slices)) {
    head_ = std::move(head);
  }
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    check_slices(head_, first, count, to);
    const std::size_t slice = head_.size[0] * head_.size[1];
    for (std::size_t k = first; k < first + count; ++k) {
      throw_if_interrupted();
      read_stored(slices_[k]);
      decode_samples(stored_, head_.type, false, 1, 0, to.subspan((k - first) * slice, slice));
    }
    check_samples(to, head_, first);
  }

 private:
  void read_stored(const PictureSlice& slice) {
    const TiffPage expected{head_.size[0], head_.size[1], head_.type};
    TiffPage page;
    if (slice.directory == 0) {
      GreyCodes codes = decode_grey_codes(read_file(slice.file), slice.file.string());
      page = {codes.width, codes.height, codes.type};
      stored_ = std::move(codes.bytes);
    } else {
      if (!open_ || open_file_ != slice.file) {
        open_.reset();
        open_ = std::make_unique<TiffFile>(slice.file);
        open_file_ = slice.file;
      }
      if (open_->directory() != slice.directory) open_->go_to(slice.directory);
      page = open_->page();
      if (page == expected) open_->read(page, stored_);
    }
    check_same_page(page, expected, slice.file.string());
  }

  std::vector<PictureSlice> slices_;
  std::unique_ptr<TiffFile> open_;
  std::filesystem::path open_file_;
  std::vector<char> stored_;
};

bool may_be_stack(const std::filesystem::path& path, std::string_view beginning, const VolumeWish& wish) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return !slice_pictures(path).empty();
  return is_tiff(beginning) && !wish.tiles && !(wish.size && wish.type);
}

// "key=value" of ImageJ's description.
std::string imagej_value(const std::string& description, const std::string& key) {
  if (!description.starts_with("ImageJ=")) return {};
  const auto at = description.find("\n" + key + "=");
  if (at == std::string::npos) return {};
  const auto first = at + key.size() + 2, end = std::min(description.find('\n', first), description.size());
  return description.substr(first, end - first);
}

StatedGrid imagej_grid(TiffFile& tiff, VolumeHead& head) {
  const std::string description = tiff.description();
  StatedGrid grid;
  const auto metres = metres_of_unit(imagej_value(description, "unit"));
  const auto between = number_of(imagej_value(description, "spacing"));
  const double x = tiff.per_unit(TIFFTAG_XRESOLUTION), y = tiff.per_unit(TIFFTAG_YRESOLUTION);
  if (!metres || !(x > 0) || !(y > 0)) return grid;
  if (!between) {
    head.spacing_note = "ImageJ's " + format("%.6g x %.6g mm", 1e3 * *metres / x, 1e3 * *metres / y) + " in its slices";
    return grid;
  }
  grid.spacing = Vec3{1 / x, 1 / y, *between};
  grid.unit_m = *metres;
  return grid;
}

// ImageJ's way of more than 4 GiB: one page, and the other slices behind its samples.
std::unique_ptr<VolumeSource> open_long_imagej(TiffFile& tiff, VolumeHead head, std::int64_t images) {
  const std::string place = head.files[0].string();
  head.size[2] = checked_side(images, place);
  head.format = "TIFF stack of ImageJ";
  const std::uint64_t bytes = checked_volume_bytes(head, place);
  const std::filesystem::path file = head.files[0];
  return linear_volume(std::move(head), bytes_of_files({{.path = file, .first = tiff.first_byte()}}, bytes),
                       tiff.is_big());
}

// All pages of a TIFF, which must be like the first one; nothing is decoded.
void add_pages(const std::filesystem::path& file, const TiffPage& first, std::vector<PictureSlice>& slices) {
  TiffFile tiff(file);
  do {
    tiff.check_directory();
    check_same_page(tiff.page(), first, file.string());
    slices.push_back({file, tiff.directory()});
    if (slices.size() > most_pages) tiff.refuse("has more than 1048576 pages");
  } while (tiff.next());
  tiff.check_walk();
}

std::unique_ptr<VolumeSource> open_stack(const std::filesystem::path& path, const VolumeWish& wish) {
  const std::string place = path.string();
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(path, ignored);
  VolumeHead head;
  head.files = folder ? slice_pictures(path) : std::vector<std::filesystem::path>{path};
  if (folder) check_slice_numbers(head.files, place);
  std::vector<PictureSlice> slices;
  StatedGrid grid;
  TiffPage page;
  if (is_tiff(beginning_of_file(head.files[0], 32))) {
    TiffFile first(head.files[0]);
    page = first.page();
    for (const auto& file : head.files) add_pages(file, page, slices);
    head.size = {page.width, page.height, slices.size()};
    head.type = page.type;
    grid = imagej_grid(first, head);
    const auto images = integer_of(imagej_value(first.description(), "images"));
    if (images && *images > 1 && slices.size() == 1 && first.is_plain()) {
      settle_grid(grid, wish, head, place);
      auto source = open_long_imagej(first, head, *images);
      check_wish_of_described(source->head(), wish, place);
      return source;
    }
    head.format = folder ? "TIFF slices" : "TIFF stack";
  } else {
    for (const auto& file : head.files) slices.push_back({file, 0});
    const GreyCodes first = decode_grey_codes(read_file(head.files[0]), head.files[0].string());
    head.size = {first.width, first.height, slices.size()};
    head.type = first.type;
    head.format = "PNG slices";
  }
  checked_volume_bytes(head, place);
  check_wish_of_described(head, wish, place);
  settle_grid(grid, wish, head, place);
  return std::make_unique<PictureStack>(std::move(head), std::move(slices));
}

}  // namespace

const VolumeFormat& tiff_stack() {
  static const VolumeFormat format{
      .name = "TIFF stack",
      .sentence =
          "a TIFF of many pages, or a folder of TIFF or PNG slices in the order of their numbers: only ImageJ's "
          "description says lengths, else --voxel must",
      .mine = may_be_stack,
      .open = open_stack,
      .order = 30};
  return format;
}

}  // namespace gonio::io::volumes
