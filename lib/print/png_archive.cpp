// See png_archive.h.
#include "print/png_archive.h"

#include <utility>

#include "print/archive_checks.h"
#include "print/archive_pictures.h"

namespace gonio::print {
namespace {

constexpr std::uint64_t most_preview_bytes = std::uint64_t{1} << 26;
constexpr std::size_t most_previews = 16;

}  // namespace

PngZipWriter::PngZipWriter(const ArchiveFormat& format, const std::filesystem::path& path, const Job& job,
                           Naming naming, Closing closing)
    : ArchiveWriter(format, job, path.string()), zip_(path), naming_(std::move(naming)), closing_(closing) {}

void PngZipWriter::add_encoded(std::string_view encoded, double bottom_m, double top_m) {
  const std::size_t k = count_layer(bottom_m, top_m);
  if (k >= naming_.most)
    refuse_archive(place_, "has more than " + std::to_string(naming_.most) + " layers, and its names no more digits",
                   "slice more coarsely, or in parts");
  std::string number = std::to_string(k + naming_.first);
  number.insert(0, std::max(0, naming_.digits - static_cast<int>(number.size())), '0');
  zip_.add(naming_.prefix + number + ".png", encoded);
}

void PngZipWriter::finish() {
  close_layers();
  closing_(zip_, job_);
  zip_.commit();
}

PngZipReader::PngZipReader(std::unique_ptr<io::ZipReader> zip, std::vector<std::size_t> layers, Job job)
    : zip_(std::move(zip)), entries_(std::move(layers)) {
  job_ = std::move(job);
  layers_ = entries_.size();
  int width_px = 0, height_px = 0;
  const std::string place = zip_->place(entries_[0]);
  read_png_sides(zip_->beginning(entries_[0], 64), place, width_px, height_px);
  if (job_.width_px == 0) job_.width_px = width_px, job_.height_px = height_px;
  if (job_.width_px != width_px || job_.height_px != height_px)
    refuse_archive(place,
                   "has " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                       " pixels, and the display that the archive states " + std::to_string(job_.width_px) + " x " +
                       std::to_string(job_.height_px),
                   "slice again for this display");
  check_job(job_, place);
}

void PngZipReader::read(std::size_t k, std::span<std::uint8_t> to) {
  const std::string png = zip_->read(entries_[k], most_png_bytes(job_));
  read_png_layer(png, job_, zip_->place(entries_[k]), to);
}

std::vector<std::string> names_of(const io::ZipReader& zip) {
  std::vector<std::string> names;
  for (const io::ZipEntry& entry : zip.entries()) names.push_back(entry.name);
  return names;
}

void read_previews(const io::ZipReader& zip, std::string_view folder, Job& job) {
  for (std::size_t i = 0; i < zip.entries().size(); ++i) {
    const std::string& name = zip.entries()[i].name;
    if (!name.starts_with(folder) || !name.ends_with(".png")) continue;
    if (job.previews.size() == most_previews)
      refuse_archive(zip.place(i), "is preview number " + std::to_string(most_previews + 1),
                     std::to_string(most_previews) + " are read");
    job.previews.push_back(read_png_preview(zip.read(i, most_preview_bytes), zip.place(i)));
  }
}

std::vector<double> even_tops(std::size_t layers, double first_m, double layer_m) {
  std::vector<double> tops;
  for (std::size_t k = 0; k < layers; ++k) tops.push_back(first_m + static_cast<double>(k) * layer_m);
  return tops;
}

std::map<std::string, std::string> read_ini(std::string_view text, const std::string& place) {
  std::map<std::string, std::string> values;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.empty() || line[0] == '#' || line[0] == ';') continue;
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos || trimmed(line.substr(0, equals)).empty())
      refuse_archive(place, "has \"" + std::string(line.substr(0, 40)) + "\" in line " + std::to_string(number),
                     "lines are \"key = value\"");
    values[std::string(trimmed(line.substr(0, equals)))] = std::string(trimmed(line.substr(equals + 1)));
  }
  return values;
}

}  // namespace gonio::print
