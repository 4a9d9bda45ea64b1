// See chitubox.h. Places of the head, and of what it leads to, are offsets in bytes.
#include "print/chitubox.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/growing_file.h"
#include "io/little_endian.h"
#include "io/volume_bytes.h"
#include "print/archive_checks.h"
#include "print/chitubox_runs.h"

namespace gonio::print {
namespace {

constexpr std::size_t head_bytes = 0x70, settings_bytes = 0x3c, slicer_bytes = 0x4c, row_bytes = 36,
                      preview_head_bytes = 32, most_levels = 64;
constexpr std::int64_t most_layers = 1000000, most_preview_px = 1 << 22;
constexpr double mm = 1e-3, mm_per_min = 1e-3 / 60, ml = 1e-6;

template <class T>
T at(std::string_view bytes, std::size_t offset) {
  return io::stored_at<T>(bytes, offset);
}

class Reader : public ArchiveReader {
 public:
  explicit Reader(const std::filesystem::path& path) : place_(path.string()), length_(io::length_of_file(path)) {
    if (length_ < head_bytes) refuse("has " + std::to_string(length_) + " bytes, and its head alone takes 112");
    bytes_ = io::bytes_of_files({{.path = path}}, length_);
    const std::string head = part(0, head_bytes, "head");
    magic_ = at<std::uint32_t>(head, 0);
    if (magic_ == locked_ctb_magic) refuse("is locked by its maker (CTB of the locked kind)", "slice it as plain CTB");
    read_head(head);
    read_table(head);
    read_settings(head);
    for (const std::size_t offset : {std::size_t{0x3c}, std::size_t{0x48}})
      if (const auto where = at<std::uint32_t>(head, offset); where != 0) read_preview(where);
    check_job(job_, place_);
  }

  void read(std::size_t k, std::span<std::uint8_t> to) override {
    const std::string place = place_ + "#layer " + std::to_string(k);
    if (magic_ != cbddlp_magic) {
      std::string runs = part(rows_[k].at, rows_[k].bytes, place);
      turn_with_key(runs, key_, static_cast<std::uint32_t>(k));
      return decode_grey_runs(runs, to, place);
    }
    std::fill(to.begin(), to.end(), std::uint8_t{0});
    for (std::size_t set = 0; set < levels_; ++set) {
      const Row& row = rows_[set * layers_ + k];
      count_level_set(part(row.at, row.bytes, place), to, place);
    }
    for (std::uint8_t& grey : to) grey = grey_of_levels(grey, levels_);
  }

 private:
  struct Row {
    std::uint32_t at = 0, bytes = 0;
  };

  [[noreturn]] void refuse(const std::string& problem, const std::string& remedy = "copy or slice it again") const {
    refuse_archive(place_, problem, remedy);
  }
  std::string part(std::uint64_t from, std::uint64_t bytes, const std::string& what) const {
    if (from > length_ || bytes > length_ - from)
      refuse("says that its " + what.substr(what.find('#') + 1) + " has " + std::to_string(bytes) + " bytes from " +
             std::to_string(from) + " on, and the file has " + std::to_string(length_));
    std::string text(bytes, '\0');
    if (bytes > 0) bytes_->read(from, text);
    return text;
  }
  double number(std::string_view bytes, std::size_t offset, const char* what) const {
    const float value = at<float>(bytes, offset);
    if (!std::isfinite(value)) refuse(std::string("states no number as its ") + what);
    return static_cast<double>(value);
  }
  std::optional<double> amount(std::string_view bytes, std::size_t offset, double unit, const char* what) const {
    const double value = number(bytes, offset, what);
    return value > 0 ? std::optional(value * unit) : std::nullopt;
  }

  void read_head(const std::string& head) {
    const auto width = at<std::uint32_t>(head, 0x34), height = at<std::uint32_t>(head, 0x38);
    check_pixels(width, height, place_);
    job_.width_px = static_cast<int>(width), job_.height_px = static_cast<int>(height);
    const double across = number(head, 0x08, "display's width"), along = number(head, 0x0c, "display's height");
    if (across > 0 && along > 0) job_.pixel_m = Vec2{across * mm / width, along * mm / height};
    if (const double layer = number(head, 0x20, "layer height"); layer > 0) job_.layer_m = layer * mm;
    job_.exposure_s = number(head, 0x24, "exposure");
    job_.bottom_exposure_s = number(head, 0x28, "bottom exposure");
    job_.bottom_layers = static_cast<int>(std::min<std::uint32_t>(at<std::uint32_t>(head, 0x30), 0x7fffffff));
    job_.printing_s = at<std::uint32_t>(head, 0x4c);
    job_.mirror_x = at<std::uint32_t>(head, 0x50) != 0, job_.mirror_y = false;
    key_ = at<std::uint32_t>(head, 0x64);
  }

  void read_table(const std::string& head) {
    const auto count = at<std::uint32_t>(head, 0x44);
    levels_ = magic_ == cbddlp_magic ? at<std::uint32_t>(head, 0x5c) : 1;
    if (count == 0 || count > most_layers) refuse("counts " + std::to_string(count) + " layers");
    if (levels_ == 0 || levels_ > most_levels) refuse("counts " + std::to_string(levels_) + " level sets");
    layers_ = count;
    const std::string table =
        part(at<std::uint32_t>(head, 0x40), std::uint64_t{row_bytes} * count * levels_, "layer table");
    for (std::size_t row = 0; row < layers_ * levels_; ++row) {
      rows_.push_back({at<std::uint32_t>(table, row * row_bytes + 12), at<std::uint32_t>(table, row * row_bytes + 16)});
      if (row < layers_) job_.tops_m.push_back(number(table, row * row_bytes, "layer's height") * mm);
    }
    // Some state where a layer ends, some where it begins.
    if (job_.layer_m && job_.tops_m[0] < *job_.layer_m / 2)
      for (double& top : job_.tops_m) top += *job_.layer_m;
  }

  void read_settings(const std::string& head) {
    const auto settings_at = at<std::uint32_t>(head, 0x54), slicer_at = at<std::uint32_t>(head, 0x68);
    if (settings_at != 0 && at<std::uint32_t>(head, 0x58) >= settings_bytes) {
      const std::string settings = part(settings_at, settings_bytes, "settings");
      job_.lift_m = amount(settings, 8, mm, "lift");
      job_.lift_m_per_s = amount(settings, 12, mm_per_min, "lift's speed");
      job_.retract_m_per_s = amount(settings, 16, mm_per_min, "speed back");
      job_.resin_m3 = amount(settings, 20, ml, "resin's volume");
      const double kg = number(settings, 24, "resin's mass") * 1e-3;
      if (job_.resin_m3 && kg > 0) job_.resin_kg_per_m3 = kg / *job_.resin_m3;
    }
    if (slicer_at != 0 && at<std::uint32_t>(head, 0x6c) >= slicer_bytes) {
      const std::string slicer = part(slicer_at, slicer_bytes, "slicer's record");
      const auto size = at<std::uint32_t>(slicer, 0x20);
      if (size > 1024) refuse("has a printer's name of " + std::to_string(size) + " bytes");
      job_.printer = part(at<std::uint32_t>(slicer, 0x1c), size, "printer's name");
    }
  }

  void read_preview(std::uint32_t where) {
    const std::string record = part(where, 16, "preview");
    const auto width = at<std::uint32_t>(record, 0), height = at<std::uint32_t>(record, 4);
    if (width == 0 || height == 0) return;
    check_pixels(width, height, place_ + "#preview");
    if (std::int64_t{width} * height > most_preview_px)
      refuse("has a preview of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
    JobPreview preview{.width_px = static_cast<int>(width), .height_px = static_cast<int>(height)};
    decode_preview(part(at<std::uint32_t>(record, 8), at<std::uint32_t>(record, 12), "preview"), preview,
                   place_ + "#preview");
    job_.previews.push_back(std::move(preview));
  }

  std::string place_;
  std::uint64_t length_;
  std::unique_ptr<io::ByteSource> bytes_;
  std::uint32_t magic_ = 0, key_ = 0;
  std::size_t levels_ = 1;
  std::vector<Row> rows_;  // level set by level set
};

class Writer : public ArchiveWriter {
 public:
  Writer(const ArchiveFormat& format, const std::filesystem::path& path, const Job& job, std::uint32_t magic)
      : ArchiveWriter(format, job, path.string()), file_(path), magic_(magic), rows_(sets()) {
    file_.append(std::string(head_bytes, '\0'));
  }

  void add_encoded(std::string_view encoded, double bottom_m, double top_m) override {
    count_layer(bottom_m, top_m);
    if (magic_ == ctb_magic) return add_row(0, encoded);
    for (std::size_t set = 0; set < sets(); ++set) {
      const auto size = at<std::uint32_t>(encoded, 0);
      add_row(set, encoded.substr(4, size));
      encoded.remove_prefix(4 + size);
    }
  }

  void finish() override {
    close_layers();
    std::string head(head_bytes, '\0');
    const auto put = [&head](std::size_t offset, auto value) { io::store_at(head, offset, value); };
    const auto count = static_cast<std::uint32_t>(job_.tops_m.size());
    put(0x00, magic_), put(0x04, std::uint32_t{2});
    put(0x08, single(job_.pixel_m->x * job_.width_px / mm)), put(0x0c, single(job_.pixel_m->y * job_.height_px / mm));
    put(0x10, single(job_.tops_m.back() / mm)), put(0x1c, single(job_.tops_m.back() / mm));
    put(0x20, single(*job_.layer_m / mm)), put(0x24, single(*job_.exposure_s)), put(0x28, single(bottom_exposure_s()));
    put(0x30, bottom_layers());
    put(0x34, static_cast<std::uint32_t>(job_.width_px)), put(0x38, static_cast<std::uint32_t>(job_.height_px));
    if (!job_.previews.empty()) put(0x3c, add_preview(job_.previews[0]));
    if (job_.previews.size() > 1) put(0x48, add_preview(job_.previews[1]));
    put(0x44, count), put(0x4c, static_cast<std::uint32_t>(std::lround(job_.printing_s.value_or(0))));
    put(0x50, std::uint32_t{job_.mirror_x.value_or(false) ? 1u : 0u});
    put(0x54, add_settings()), put(0x58, std::uint32_t{settings_bytes});
    put(0x5c, static_cast<std::uint32_t>(sets()));
    put(0x60, std::uint16_t{255}), put(0x62, std::uint16_t{255});
    put(0x68, add_slicer()), put(0x6c, std::uint32_t{slicer_bytes});
    put(0x40, add_table());
    file_.overwrite(0, head);
    file_.commit();
  }

 private:
  struct Row {
    std::uint32_t at = 0, bytes = 0;
  };
  static float single(double value) { return static_cast<float>(value); }
  std::size_t sets() const { return magic_ == ctb_magic ? 1 : written_level_sets; }
  double bottom_exposure_s() const { return job_.bottom_exposure_s.value_or(*job_.exposure_s); }
  std::uint32_t bottom_layers() const { return static_cast<std::uint32_t>(job_.bottom_layers.value_or(0)); }

  std::uint32_t add_part(std::string_view bytes) {
    const std::uint64_t where = file_.size();
    if (where + bytes.size() > 0xffffffffu)
      refuse_archive(place_, "would have more than 4 GiB, and its format can say no more", "slice it in parts");
    file_.append(bytes);
    return static_cast<std::uint32_t>(where);
  }
  void add_row(std::size_t set, std::string_view runs) {
    const std::uint32_t where = add_part(runs);
    rows_[set].push_back({where, static_cast<std::uint32_t>(runs.size())});
  }

  std::uint32_t add_preview(const JobPreview& preview) {
    const std::string runs = encode_preview(preview);
    const std::uint32_t where = add_part(runs);
    std::string record(preview_head_bytes, '\0');
    io::store_at(record, 0, static_cast<std::uint32_t>(preview.width_px));
    io::store_at(record, 4, static_cast<std::uint32_t>(preview.height_px));
    io::store_at(record, 8, where), io::store_at(record, 12, static_cast<std::uint32_t>(runs.size()));
    return add_part(record);
  }

  std::uint32_t add_settings() {
    std::string record(settings_bytes, '\0');
    const double lift = job_.lift_m.value_or(0) / mm, speed = job_.lift_m_per_s.value_or(0) / mm_per_min,
                 volume = job_.resin_m3.value_or(0);
    io::store_at(record, 0, single(lift)), io::store_at(record, 4, single(speed));
    io::store_at(record, 8, single(lift)), io::store_at(record, 12, single(speed));
    io::store_at(record, 16, single(job_.retract_m_per_s.value_or(0) / mm_per_min));
    io::store_at(record, 20, single(volume / ml));
    io::store_at(record, 24, single(volume * job_.resin_kg_per_m3.value_or(0) * 1e3));
    io::store_at(record, 40, bottom_layers());
    return add_part(record);
  }

  std::uint32_t add_slicer() {
    const std::uint32_t name = add_part(job_.printer);
    std::string record(slicer_bytes, '\0');
    io::store_at(record, 0x1c, name), io::store_at(record, 0x20, static_cast<std::uint32_t>(job_.printer.size()));
    io::store_at(record, 0x24, std::uint32_t{magic_ == ctb_magic ? 0xfu : 8u});
    io::store_at(record, 0x2c, static_cast<std::uint32_t>(sets()));
    io::store_at(record, 0x30, std::uint32_t{0x01060300}), io::store_at(record, 0x34, std::uint32_t{0x200});
    return add_part(record);
  }

  std::uint32_t add_table() {
    std::string table;
    for (const std::vector<Row>& set : rows_)
      for (std::size_t k = 0; k < set.size(); ++k) {
        std::string row(row_bytes, '\0');
        io::store_at(row, 0, single(job_.tops_m[k] / mm));
        io::store_at(row, 4, single(k < bottom_layers() ? bottom_exposure_s() : *job_.exposure_s));
        io::store_at(row, 12, set[k].at), io::store_at(row, 16, set[k].bytes);
        table += row;
      }
    return add_part(table);
  }

  GrowingFile file_;
  std::uint32_t magic_;
  std::vector<std::vector<Row>> rows_;  // of every level set
};

}  // namespace

std::uint32_t chitubox_magic(std::string_view beginning) {
  return beginning.size() < 4 ? 0 : at<std::uint32_t>(beginning, 0);
}

std::unique_ptr<ArchiveReader> open_chitubox(const std::filesystem::path& path) {
  return std::make_unique<Reader>(path);
}

std::unique_ptr<ArchiveWriter> begin_chitubox(const ArchiveFormat& format, const std::filesystem::path& path,
                                              const Job& job, std::uint32_t magic) {
  const std::string place = path.string(), name = format.name;
  if (!job.exposure_s) refuse_archive(place, "would have no exposure", name + " needs one: state that of a layer");
  if (!job.pixel_m) refuse_archive(place, "would have no size of pixels", name + " needs it: state it");
  if (job.previews.size() > 2)
    refuse_archive(place, "would have " + std::to_string(job.previews.size()) + " previews", "two are the most");
  if (job.mirror_y.value_or(false))
    refuse_archive(place, "would be mirrored top to bottom", name + " knows left to right alone");
  if (job.printer.size() > 1024) refuse_archive(place, "has a printer's name of more than 1024 bytes", "shorten it");
  return std::make_unique<Writer>(format, path, job, magic);
}

}  // namespace gonio::print
