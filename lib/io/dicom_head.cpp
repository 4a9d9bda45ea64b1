#include "io/dicom_head.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "io/little_endian.h"
#include "io/volume_bytes.h"
#include "io/volume_grid.h"
#include "io/volume_header.h"

namespace gonio::io {
namespace {

constexpr std::uint32_t unknown_length = 0xffffffff;
constexpr std::size_t longest_value = 1 << 20, dicom_block = 1 << 14;
constexpr int deepest_sequence = 32;
constexpr std::size_t most_frames = 1 << 20;

constexpr std::uint32_t tag(unsigned group, unsigned element) {
  return group << 16 | element;
}
constexpr std::uint32_t item = tag(0xfffe, 0xe000), item_end = tag(0xfffe, 0xe00d), sequence_end = tag(0xfffe, 0xe0dd);
constexpr std::uint32_t transfer_syntax = tag(2, 0x10), pixel_data = tag(0x7fe0, 0x10);

struct Syntax {
  const char* name;
  bool explicit_types = true, big = false;
  DicomPixels pixels = DicomPixels::plain;
  const char* refused = nullptr;
};
const char* const loses = "which loses what was measured";
const char* const not_read = "which is not read";

const Syntax* syntax_of(const std::string& uid) {
  using enum DicomPixels;
  static const std::map<std::string, Syntax> syntaxes = {
      {"1.2.840.10008.1.2", {"implicit", false}},
      {"1.2.840.10008.1.2.1", {"explicit"}},
      {"1.2.840.10008.1.2.1.99", {"deflated", true, false, plain, not_read}},
      {"1.2.840.10008.1.2.2", {"explicit, big endian", true, true}},
      {"1.2.840.10008.1.2.5", {"RLE", true, false, run_lengths}},
      {"1.2.840.10008.1.2.4.50", {"JPEG baseline", true, false, plain, loses}},
      {"1.2.840.10008.1.2.4.51", {"JPEG extended", true, false, plain, loses}},
      {"1.2.840.10008.1.2.4.57", {"JPEG lossless", true, false, jpeg_lossless}},
      {"1.2.840.10008.1.2.4.70", {"JPEG lossless", true, false, jpeg_lossless}},
      {"1.2.840.10008.1.2.4.80", {"JPEG-LS lossless", true, false, jpeg_ls}},
      {"1.2.840.10008.1.2.4.81", {"JPEG-LS near-lossless", true, false, plain, loses}},
      {"1.2.840.10008.1.2.4.90", {"JPEG 2000 lossless", true, false, jpeg_2000}},
      {"1.2.840.10008.1.2.4.91", {"JPEG 2000", true, false, plain, loses}}};
  const auto found = syntaxes.find(uid);
  return found == syntaxes.end() ? nullptr : &found->second;
}

struct Element {
  std::uint32_t tag = 0;
  std::string type;  // VR: two letters; empty where it is implicit
  std::uint32_t length = 0;
  std::uint64_t at = 0;  // its value
};

std::string tag_text(std::uint32_t t) {
  return format("(%04X,%04X)", t >> 16, t & 0xffff);
}

// A refusal that becomes DicomFile::fault.
struct Fault {
  std::string problem, remedy = "copy it again, or export the series anew";
};

class DicomHeadReader {
 public:
  explicit DicomHeadReader(DicomFile& file)
      : file_(file), length_(length_of_file(file.path)), bytes_(bytes_of_files({{.path = file.path}}, length_)) {}

  void read() {
    if (length_ < 132 || !begins_as_dicom(text(0, 132))) throw Fault{"is no DICOM file: DICM is not at byte 128"};
    const Syntax syntax = read_file_group();
    file_.syntax = syntax.name;
    file_.pixels = syntax.pixels;
    file_.big_endian = big_ = syntax.big;
    explicit_ = syntax.explicit_types;
    // A syntax that loses is refused, but the series is read first: neighbours ask which one the file belongs to.
    if (syntax.refused == nullptr || std::string(syntax.refused) == loses) read_dataset();
    if (syntax.refused != nullptr)
      throw Fault{"is stored as " + file_.syntax + ", " + syntax.refused, "export the series without compression"};
    if (lossy_) throw Fault{"was compressed with loss before it was stored", "get the series as it was reconstructed"};
    check_pixels();
  }

 private:
  std::string_view text(std::uint64_t at, std::size_t n) {
    if (n > longest_value) throw Fault{"has a value of " + std::to_string(n) + " bytes in its head"};
    if (at > length_ || length_ - at < n)
      throw Fault{"ends after " + std::to_string(length_) + " bytes, within its head: truncated"};
    if (at < block_at_ || at + n > block_at_ + block_.size()) {
      block_at_ = at;
      block_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(std::max(n, dicom_block), length_ - at)));
      bytes_->read(at, block_);
    }
    return std::string_view(block_).substr(static_cast<std::size_t>(at - block_at_), n);
  }
  std::uint32_t u16(std::uint64_t at) {
    const auto b = text(at, 2);
    const auto low = static_cast<unsigned char>(b[big_ ? 1 : 0]), high = static_cast<unsigned char>(b[big_ ? 0 : 1]);
    return static_cast<std::uint32_t>(high << 8 | low);
  }
  std::uint32_t u32(std::uint64_t at) { return big_ ? u16(at) << 16 | u16(at + 2) : u16(at + 2) << 16 | u16(at); }

  // PS3.5, 7.1: items and their ends have neither a type nor a choice of it.
  Element element_at(std::uint64_t at, bool explicit_types) {
    Element e{.tag = tag(u16(at), u16(at + 2)), .type = {}};
    if (!explicit_types || e.tag >> 16 == 0xfffe) {
      e.length = u32(at + 4);
      e.at = at + 8;
      return e;
    }
    e.type = text(at + 4, 2);
    for (const char* wide : {"OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"})
      if (e.type == wide) {
        e.length = u32(at + 8);
        e.at = at + 12;
        return e;
      }
    for (const char c : e.type)
      if (c < 'A' || c > 'Z') throw Fault{"has an element " + tag_text(e.tag) + " of no known type"};
    e.length = u16(at + 6);
    e.at = at + 8;
    return e;
  }

  // The transfer syntax, from the group before the data set, which is always explicit and little endian.
  Syntax read_file_group() {
    std::string uid;
    for (at_ = 132; at_ + 8 <= length_ && u16(at_) == 2;) {
      const Element e = element_at(at_, true);
      if (e.length == unknown_length) throw Fault{"has an element " + tag_text(e.tag) + " without a length"};
      if (e.tag == transfer_syntax) uid = word(e);
      at_ = e.at + e.length;
    }
    if (uid.empty())
      throw Fault{"names no transfer syntax (0002,0010), so that its bytes have no meaning",
                  "leave the file out, or export it anew"};
    const Syntax* syntax = syntax_of(uid);
    if (syntax == nullptr)
      throw Fault{"is stored in the transfer syntax " + shown(uid) + ", " + not_read,
                  "export the series without compression"};
    return *syntax;
  }

  void read_dataset() {
    while (at_ + 8 <= length_) {
      const Element e = element_at(at_, explicit_);
      if (e.tag == pixel_data) return found_pixels(e);
      if (e.length == unknown_length) {
        at_ = behind_items(e.at, explicit_ && e.type != "UN", 0);
        continue;
      }
      if (e.length > length_ - std::min(e.at, length_))
        throw Fault{"ends after " + std::to_string(length_) + " bytes, within its element " + tag_text(e.tag) +
                    ": truncated"};
      take(e);
      at_ = e.at + e.length;
    }
    throw Fault{"holds no pixels", "leave the file out"};
  }

  // Where a sequence of unknown length ends (PS3.5, 7.5): after its delimiter.
  std::uint64_t behind_items(std::uint64_t at, bool explicit_types, int depth) {
    if (depth > deepest_sequence) throw Fault{"has sequences within sequences, more than 32 deep"};
    while (true) {
      const Element e = element_at(at, explicit_types);
      if (e.tag == sequence_end) return e.at;
      if (e.tag != item) throw Fault{"has " + tag_text(e.tag) + " where an item of a sequence belongs"};
      at = e.length == unknown_length ? behind_item(e.at, explicit_types, depth) : e.at + e.length;
    }
  }
  std::uint64_t behind_item(std::uint64_t at, bool explicit_types, int depth) {
    while (true) {
      const Element e = element_at(at, explicit_types);
      if (e.tag == item_end) return e.at;
      at = e.length == unknown_length ? behind_items(e.at, explicit_types && e.type != "UN", depth + 1)
                                      : e.at + e.length;
    }
  }

  // A short text without the blank or zero that makes its length even.
  std::string word(const Element& e) {
    std::string value(text(e.at, e.length));
    while (!value.empty() && (value.back() == '\0' || value.back() == ' ')) value.pop_back();
    return std::string(trimmed(value));
  }
  std::vector<double> decimals(const Element& e) {
    std::vector<double> values;
    const std::string all = word(e);
    for (std::size_t at = 0; at <= all.size() && !all.empty();) {
      const auto end = std::min(all.find('\\', at), all.size());
      const auto value = number_of(trimmed(std::string_view(all).substr(at, end - at)));
      if (!value || !std::isfinite(*value))
        throw Fault{"has \"" + shown(all) + "\" in " + tag_text(e.tag) + ", which are no numbers"};
      values.push_back(*value);
      at = end + 1;
    }
    return values;
  }
  // As many as belong there, or none.
  std::optional<std::vector<double>> some(const Element& e, std::size_t count) {
    auto values = decimals(e);
    if (values.empty()) return {};
    if (values.size() != count)
      throw Fault{"has " + std::to_string(values.size()) + " numbers in " + tag_text(e.tag) + ", not " +
                  std::to_string(count)};
    return values;
  }
  int small(const Element& e) {
    if (e.length != 2) throw Fault{"has an element " + tag_text(e.tag) + " of another length than 2 bytes"};
    return static_cast<int>(u16(e.at));
  }

  void take(const Element& e) {
    switch (e.tag) {
      case tag(0x0008, 0x0018): file_.instance = word(e); break;
      case tag(0x0008, 0x0060): file_.modality = word(e); break;
      case tag(0x0018, 0x0088):
        if (const auto n = some(e, 1)) file_.between_mm = (*n)[0];
        break;
      case tag(0x0020, 0x000e): file_.series = word(e); break;
      case tag(0x0020, 0x0032):
        if (const auto n = some(e, 3)) file_.position_mm = Vec3{(*n)[0], (*n)[1], (*n)[2]};
        break;
      case tag(0x0020, 0x0037):
        if (const auto n = some(e, 6))
          file_.directions = std::array<Vec3, 2>{Vec3{(*n)[0], (*n)[1], (*n)[2]}, Vec3{(*n)[3], (*n)[4], (*n)[5]}};
        break;
      case tag(0x3004, 0x000c): file_.offsets_mm = decimals(e); break;
      default: take_of_pixels(e);
    }
  }
  void take_of_pixels(const Element& e) {
    switch (e.tag) {
      case tag(0x0028, 0x0002): file_.samples = small(e); break;
      case tag(0x0028, 0x0004): file_.photometric = word(e); break;
      case tag(0x0028, 0x0008):
        if (const auto n = some(e, 1)) {
          if (!((*n)[0] >= 1 && (*n)[0] <= most_frames)) throw Fault{"claims " + shortest_text((*n)[0]) + " frames"};
          file_.frames = static_cast<std::size_t>((*n)[0]);
        }
        break;
      case tag(0x0028, 0x0010): file_.rows = static_cast<std::size_t>(small(e)); break;
      case tag(0x0028, 0x0011): file_.columns = static_cast<std::size_t>(small(e)); break;
      case tag(0x0028, 0x0030):
        if (const auto n = some(e, 2)) file_.spacing_mm = std::array<double, 2>{(*n)[0], (*n)[1]};
        break;
      case tag(0x0028, 0x0100): file_.bits_allocated = small(e); break;
      case tag(0x0028, 0x0101): file_.bits_stored = small(e); break;
      case tag(0x0028, 0x0102): file_.high_bit = small(e); break;
      case tag(0x0028, 0x0103): file_.is_signed = small(e) == 1; break;
      case tag(0x0028, 0x1052):
      case tag(0x0028, 0x1053):
        if (const auto n = some(e, 1)) {
          (e.tag == tag(0x0028, 0x1053) ? file_.slope : file_.intercept) = (*n)[0];
          file_.rescaled = true;
        }
        break;
      case tag(0x0028, 0x1054): file_.rescale_type = word(e); break;
      case tag(0x0028, 0x2110): lossy_ = word(e) == "01"; break;
      default: break;
    }
  }

  void found_pixels(const Element& e) {
    file_.pixels_at = e.at;
    const bool plain = file_.pixels == DicomPixels::plain;
    if (e.length != unknown_length && e.length > length_ - std::min(e.at, length_))
      throw Fault{"has " + std::to_string(length_ - std::min(e.at, length_)) + " bytes of pixels where " +
                  std::to_string(e.length) + " are stated: truncated"};
    file_.pixels_bytes = e.length == unknown_length ? length_ - std::min(e.at, length_) : e.length;
    encapsulated_ = e.length == unknown_length;
    if (plain && file_.big_endian && file_.bits_allocated == 8 && e.type == "OW")
      throw Fault{"has bytes as words of big endian, which is not read"};
  }

  void check_pixels() {
    DicomFile& f = file_;
    if (f.samples != 1)
      throw Fault{"has " + std::to_string(f.samples) + " samples a pixel (" + shown(f.photometric) +
                      "), and a volume has one value a voxel",
                  "leave the file out"};
    if (f.photometric.starts_with("PALETTE")) throw Fault{"has numbers of colours for pixels", "leave the file out"};
    if (f.rows == 0 || f.columns == 0) throw Fault{"claims a picture without rows or columns"};
    if (f.bits_allocated != 8 && f.bits_allocated != 16 && f.bits_allocated != 32)
      throw Fault{"has pixels of " + std::to_string(f.bits_allocated) + " bits, and 8, 16 and 32 are read"};
    if (f.bits_stored < 1 || f.bits_stored > f.bits_allocated || f.high_bit != f.bits_stored - 1)
      throw Fault{"has " + std::to_string(f.bits_stored) + " bits up to bit " + std::to_string(f.high_bit) +
                  " in pixels of " + std::to_string(f.bits_allocated) + ", and the lowest ones are read"};
    if (f.slope == 0) throw Fault{"states a slope of 0 for its values"};
    const bool plain = f.pixels == DicomPixels::plain;
    if (plain == encapsulated_)
      throw Fault{"is stored as " + f.syntax + ", and its pixels are " + (plain ? "" : "not ") + "in fragments"};
    const std::uint64_t wanted = std::uint64_t{f.frame_bytes()} * f.frames;  // below 2^16 * 2^16 * 2^2 * 2^20
    if (plain && f.pixels_bytes < wanted)
      throw Fault{"has " + std::to_string(f.pixels_bytes) + " bytes of pixels where its head promises " +
                  std::to_string(wanted)};
    // Of the codecs, runs of lengths squeeze least (by 64), JPEG 2000 most: nothing but zeros in some hundred bytes.
    constexpr std::uint64_t most_squeezed = std::uint64_t{1} << 14;
    if (!plain && wanted / most_squeezed > f.pixels_bytes)
      throw Fault{"has " + std::to_string(f.pixels_bytes) + " bytes of pixels, too few for the " +
                  std::to_string(wanted) + " that its head promises"};
  }

  DicomFile& file_;
  std::uint64_t length_;
  std::unique_ptr<ByteSource> bytes_;
  std::string block_;
  std::uint64_t block_at_ = 0, at_ = 0;
  bool big_ = false, explicit_ = true, lossy_ = false, encapsulated_ = false;
};

}  // namespace

VoxelType DicomFile::type() const {
  if (bits_allocated == 8) return is_signed ? VoxelType::i8 : VoxelType::u8;
  if (bits_allocated == 16) return is_signed ? VoxelType::i16 : VoxelType::u16;
  return is_signed ? VoxelType::i32 : VoxelType::u32;
}

bool begins_as_dicom(std::string_view beginning) {
  return beginning.size() >= 132 && beginning.substr(128, 4) == "DICM";
}

DicomFile read_dicom_head(const std::filesystem::path& path) {
  DicomFile file{.path = path};
  try {
    DicomHeadReader(file).read();
  } catch (const Fault& fault) {
    file.fault = fault.problem;
    file.remedy = fault.remedy;
  }
  return file;
}

}  // namespace gonio::io
