// Archives of layer images: what printers that cure layers by light are fed with.
//
// One file a format in print/archives/, gathered by the build, each with the source of what it knows in its head. A
// writer takes layers one at a time from the platform on and keeps none of them; the archive appears whole or not at
// all, and the same layers and job give the same bytes: files within zips are of 1 January 1980. Zips are written by
// io/zip_file.h, for libzip keeps all that it is given until it closes.
//
// A layer is a picture of 8-bit greys, row by row from the top, width_px x height_px bytes, 0 dark and 255 full light,
// as the display shows it: a mirrored one is mirrored by who draws it. Heights are metres above the platform.
//
//   const ArchiveFormat& format = archive_format(path);
//   const auto writer = format.begin(path, job);
//   for (...) writer->add(picture, bottom_m, top_m);    // or, pictures encoded in parallel:
//   for (...) writer->add_encoded(encoded[k], bottom_m, top_m);   // encoded[k] = format.encode(job, picture)
//   writer->job().resin_m3 = ...;                       // what is known only now
//   writer->finish();
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geom/vector.h"

namespace gonio::print {

struct JobPreview {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgb{};  // sRGB, row by row from the top
};

// Of all but the pixels: nothing where it is not said. What a format cannot hold is left out: see left_out().
struct Job {
  int width_px = 0, height_px = 0;
  std::optional<Vec2> pixel_m{};               // along the rows, along the columns
  std::optional<double> layer_m{};             // thickness; a writer without it takes that of the second layer
  std::optional<bool> mirror_x{}, mirror_y{};  // pictures are mirrored, left to right and top to bottom
  std::optional<double> exposure_s{}, bottom_exposure_s{};
  std::optional<int> bottom_layers{};  // exposed longer; with SL1 the exposure falls to the common one over them
  std::optional<double> lift_m{}, lift_m_per_s{}, retract_m_per_s{};  // between layers
  std::string name{}, printer{}, resin{};
  std::optional<double> resin_kg_per_m3{}, resin_m3{}, printing_s{};
  std::vector<JobPreview> previews{};
  // Of readers: tops of the layers, where the format says heights; writers are told by add().
  std::vector<double> tops_m{};
  // What a format states beside all this under names of its own, as it was read. The same format writes it back.
  std::map<std::string, std::string> further{};
};

class ArchiveWriter {
 public:
  virtual ~ArchiveWriter() = default;  // without finish() nothing is left
  // The next layer. Error(data) naming the layer where heights do not follow upon those before, or the format cannot
  // state them.
  void add(std::span<const std::uint8_t> picture, double bottom_m, double top_m);
  virtual void add_encoded(std::string_view encoded, double bottom_m, double top_m) = 0;
  virtual void finish() = 0;   // Error(data) where there was no layer
  Job& job() { return job_; }  // all but the pixels may still change until finish()

 protected:
  ArchiveWriter(const struct ArchiveFormat& format, Job job, std::string place);
  // Checks and counts; the layer's number.
  std::size_t count_layer(double bottom_m, double top_m);
  void close_layers();  // Error(data) where there was none

  const struct ArchiveFormat& format_;
  Job job_;  // with tops_m of what was added
  std::string place_;
};

class ArchiveReader {
 public:
  virtual ~ArchiveReader() = default;
  const Job& job() const { return job_; }
  std::size_t layers() const { return layers_; }
  // Layer k, in any order, into width_px x height_px bytes. Error(data) naming the layer. Not from two threads at once.
  virtual void read(std::size_t k, std::span<std::uint8_t> to) = 0;

 protected:
  Job job_;
  std::size_t layers_ = 0;
};

// What of a job a format holds; bits of ArchiveFormat::holds.
enum JobPart : unsigned {
  job_pixel_size = 1,
  job_layers = 2,      // thickness, all the same
  job_each_layer = 4,  // thickness, each its own
  job_mirror = 8,
  job_exposure = 16,
  job_lift = 32,
  job_name = 64,
  job_printer = 128,
  job_resin_name = 256,
  job_resin_density = 512,
  job_resin_volume = 1024,
  job_time = 2048,
  job_previews = 4096
};

// A member of the family: print/archives/NAME.cpp defines `const ArchiveFormat& NAME()`.
struct ArchiveFormat {
  const char* name;                     // "SL1"
  const char* sentence;                 // one line for the man page
  std::vector<std::string> extensions;  // ".sl1", lower case; "" a folder
  unsigned holds = 0;                   // of JobPart
  int greys = 256;                      // that it tells apart
  // Is it mine? `beginning` holds up to 1024 bytes of a file; empty for a folder.
  bool (*mine)(const std::filesystem::path& path, std::string_view beginning) = nullptr;
  // Sizes are checked before anything is allocated. Error(no_input | data).
  std::unique_ptr<ArchiveReader> (*open)(const std::filesystem::path& path) = nullptr;
  // Error(data) for a job that it cannot hold, Error(cannot_create).
  std::unique_ptr<ArchiveWriter> (*begin)(const std::filesystem::path& path, const Job& job) = nullptr;
  // One layer as it stands in the file. Pure: from as many threads as one likes.
  std::string (*encode)(const Job& job, std::span<const std::uint8_t> picture) = nullptr;
  int order = 0;  // asked in ascending order
};
std::span<const ArchiveFormat* const> all_archive_formats();

// By the name's extension, or by a format's own name where `wanted` says one. Error(usage) that lists them.
const ArchiveFormat& archive_format(const std::filesystem::path& path, const std::string& wanted = {});
// By its beginning. Error(no_input | data).
std::unique_ptr<ArchiveReader> open_archive(const std::filesystem::path& path);
// What the job says and the format does not hold, in words: "the resin's density". Empty: nothing is lost.
std::vector<std::string> left_out(const ArchiveFormat& format, const Job& job);

}  // namespace gonio::print
