// Zips of layers as PNG files: what the formats that are zips have in common (archive.h).
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/zip_file.h"
#include "print/archive.h"

namespace gonio::print {

class PngZipWriter : public ArchiveWriter {
 public:
  struct Naming {
    std::string prefix{};
    int digits = 5;         // with zeros in front
    std::size_t first = 0;  // number of the lowest layer
    std::size_t most = 1000000;
  };
  // Adds what stands beside the layers, when all that the job says is known.
  using Closing = void (*)(io::ZipWriter& zip, const Job& job);
  PngZipWriter(const ArchiveFormat& format, const std::filesystem::path& path, const Job& job, Naming naming,
               Closing closing);
  void add_encoded(std::string_view encoded, double bottom_m, double top_m) override;
  void finish() override;

 private:
  io::ZipWriter zip_;
  Naming naming_;
  Closing closing_;
};

class PngZipReader : public ArchiveReader {
 public:
  // `layers`: entries of the zip from the lowest on. A job without pixels takes those of the first picture.
  PngZipReader(std::unique_ptr<io::ZipReader> zip, std::vector<std::size_t> layers, Job job);
  void read(std::size_t k, std::span<std::uint8_t> to) override;

 private:
  std::unique_ptr<io::ZipReader> zip_;
  std::vector<std::size_t> entries_;
};

std::vector<std::string> names_of(const io::ZipReader& zip);
// Of all PNG files in `folder` ("thumbnail/"), or of that name, which may be missing.
void read_previews(const io::ZipReader& zip, std::string_view folder, Job& job);
// Tops of layers that are all as thick, but the first.
std::vector<double> even_tops(std::size_t layers, double first_m, double layer_m);

// "key = value" lines, "#" and ";" before comments. Error(data) for a line of another kind.
std::map<std::string, std::string> read_ini(std::string_view text, const std::string& place);

}  // namespace gonio::print
