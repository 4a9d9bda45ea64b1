// A folder of layers as PNG files and nothing else, numbered from 0: 00000.png, 00001.png, ...
//
// Read: any names that end in a number, from 0 or from 1 on. Nothing is known of a job but its pixels.
#include <algorithm>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/growing_folder.h"
#include "base/text.h"
#include "io/volume_bytes.h"
#include "print/archive_checks.h"
#include "print/archive_pictures.h"

namespace gonio::print::archives {
const ArchiveFormat& png_stack();

namespace {

bool is_folder(const std::filesystem::path& path, std::string_view) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

bool is_layer(const std::string& name) {
  return name.ends_with(".png") && name.find_first_not_of("0123456789") == name.size() - 4 && name.size() > 4;
}

class PngStackWriter : public ArchiveWriter {
 public:
  PngStackWriter(const std::filesystem::path& path, const Job& job)
      : ArchiveWriter(png_stack(), job, path.string()), folder_(path, is_layer) {}
  void add_encoded(std::string_view encoded, double bottom_m, double top_m) override {
    const std::size_t k = count_layer(bottom_m, top_m);
    write_file(folder_.filling() / format("%05zu.png", k), encoded);
  }
  void finish() override {
    close_layers();
    folder_.commit();
  }

 private:
  GrowingFolder folder_;
};

class PngStackReader : public ArchiveReader {
 public:
  explicit PngStackReader(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code failure;
    for (std::filesystem::directory_iterator at(folder, failure), end; !failure && at != end; at.increment(failure))
      if (const std::string name = at->path().filename().string(); !name.starts_with('.')) names.push_back(name);
    if (failure) throw Error(Exit::no_input, folder.string(), failure.message(), "check its permissions");
    std::ranges::sort(names);  // whatever the order of the file system
    for (const std::size_t i : numbered_pictures(names, folder.string())) files_.push_back(folder / names[i]);
    layers_ = files_.size();
    read_png_sides(io::beginning_of_file(files_[0], 64), files_[0].string(), job_.width_px, job_.height_px);
  }
  void read(std::size_t k, std::span<std::uint8_t> to) override {
    read_png_layer(read_file(files_[k], most_png_bytes(job_)), job_, files_[k].string(), to);
  }

 private:
  std::vector<std::filesystem::path> files_;
};

std::unique_ptr<ArchiveReader> open_stack(const std::filesystem::path& path) {
  return std::make_unique<PngStackReader>(path);
}
std::unique_ptr<ArchiveWriter> begin_stack(const std::filesystem::path& path, const Job& job) {
  return std::make_unique<PngStackWriter>(path, job);
}

}  // namespace

const ArchiveFormat& png_stack() {
  static const ArchiveFormat format{.name = "PNG",
                                    .sentence = "a folder of numbered PNG files and nothing else",
                                    .extensions = {""},
                                    .holds = 0,
                                    .mine = is_folder,
                                    .open = open_stack,
                                    .begin = begin_stack,
                                    .encode = png_of_layer,
                                    .order = 0};
  return format;
}

}  // namespace gonio::print::archives
