// See archive.h.
#include "print/archive.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/lower_case.h"
#include "base/text.h"
#include "io/volume_bytes.h"
#include "print/archive_checks.h"

namespace gonio::print {
namespace {

constexpr double same_m = 1e-9;  // heights that differ by less are the same
constexpr double tallest_m = 100;

struct PartWords {
  JobPart part;
  const char* words;
  bool (*stated)(const Job& job);
};
const PartWords parts[] = {
    {job_pixel_size, "the size of a pixel", [](const Job& j) { return j.pixel_m.has_value(); }},
    {job_layers, "the thickness of layers", [](const Job& j) { return j.layer_m.has_value(); }},
    {job_mirror, "whether pictures are mirrored",
     [](const Job& j) { return j.mirror_x.has_value() || j.mirror_y.has_value(); }},
    {job_exposure, "the exposure", [](const Job& j) { return j.exposure_s.has_value(); }},
    {job_lift, "the lift between layers", [](const Job& j) { return j.lift_m || j.lift_m_per_s || j.retract_m_per_s; }},
    {job_name, "the job's name", [](const Job& j) { return !j.name.empty(); }},
    {job_printer, "the printer's name", [](const Job& j) { return !j.printer.empty(); }},
    {job_resin_name, "the resin's name", [](const Job& j) { return !j.resin.empty(); }},
    {job_resin_density, "the resin's density", [](const Job& j) { return j.resin_kg_per_m3.has_value(); }},
    {job_resin_volume, "how much resin it takes", [](const Job& j) { return j.resin_m3.has_value(); }},
    {job_time, "how long it takes", [](const Job& j) { return j.printing_s.has_value(); }},
    {job_previews, "previews", [](const Job& j) { return !j.previews.empty(); }}};

std::string names_of_formats() {
  std::string names;
  for (const ArchiveFormat* format : all_archive_formats()) {
    names += names.empty() ? "" : ", ";
    names += format->name;
    for (const std::string& extension : format->extensions)
      names += extension.empty() ? " (a folder)" : " " + extension;
  }
  return names;
}

}  // namespace

ArchiveWriter::ArchiveWriter(const ArchiveFormat& format, Job job, std::string place)
    : format_(format), job_(std::move(job)), place_(std::move(place)) {
  check_job(job_, place_);
  job_.tops_m.clear();
}

void ArchiveWriter::add(std::span<const std::uint8_t> picture, double bottom_m, double top_m) {
  if (picture.size() != static_cast<std::size_t>(job_.width_px) * static_cast<std::size_t>(job_.height_px))
    refuse_archive(place_ + ": layer " + std::to_string(job_.tops_m.size()),
                   "has " + std::to_string(picture.size()) + " pixels, and the job " + std::to_string(job_.width_px) +
                       " x " + std::to_string(job_.height_px),
                   "draw all layers on one grid");
  add_encoded(format_.encode(job_, picture), bottom_m, top_m);
}

std::size_t ArchiveWriter::count_layer(double bottom_m, double top_m) {
  const std::size_t k = job_.tops_m.size();
  const std::string place = place_ + ": layer " + std::to_string(k);
  const double below_m = k == 0 ? 0 : job_.tops_m.back(), thickness_m = top_m - bottom_m;
  if (!(std::isfinite(bottom_m) && std::isfinite(top_m) && thickness_m > 0 && top_m <= tallest_m))
    refuse_archive(place, "reaches from " + shortest_text(bottom_m) + " to " + shortest_text(top_m) + " m",
                   "layers have a thickness above 0");
  if (!(std::abs(bottom_m - below_m) <= same_m))
    refuse_archive(
        place,
        "begins at " + shortest_text(bottom_m) + " m, and what is below it ends at " + shortest_text(below_m) + " m",
        "give layers one after the other, the first from 0 on");
  if (k > 0 && !job_.layer_m) job_.layer_m = thickness_m;
  if (k > 0 && (format_.holds & job_layers) != 0 && (format_.holds & job_each_layer) == 0 &&
      std::abs(thickness_m - *job_.layer_m) > same_m)
    refuse_archive(place,
                   "is " + shortest_text(thickness_m) + " m thick and others " + shortest_text(*job_.layer_m) +
                       ", and " + format_.name + " has one thickness for all but the first",
                   "slice evenly, or choose a format that states each layer's");
  job_.tops_m.push_back(top_m);
  return k;
}

void ArchiveWriter::close_layers() {
  if (job_.tops_m.empty()) refuse_archive(place_, "has no layer", "slice something");
  if (!job_.layer_m) job_.layer_m = job_.tops_m[0];
  check_job(job_, place_);
}

const ArchiveFormat& archive_format(const std::filesystem::path& path, const std::string& wanted) {
  const std::string extension = path.has_filename() ? lower_case(path.extension().string()) : std::string();
  for (const ArchiveFormat* format : all_archive_formats())
    if (wanted.empty() ? std::ranges::find(format->extensions, extension) != format->extensions.end()
                       : lower_case(wanted) == lower_case(format->name))
      return *format;
  throw Error(Exit::usage, wanted.empty() ? path.string() : wanted, "is no format of layer images",
              "these are: " + names_of_formats());
}

std::unique_ptr<ArchiveReader> open_archive(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw Error(Exit::no_input, path.string(), "is not there", "check the path");
  const std::string beginning =
      std::filesystem::is_directory(path, ignored) ? std::string() : io::beginning_of_file(path, 1024);
  std::vector<const ArchiveFormat*> formats(all_archive_formats().begin(), all_archive_formats().end());
  std::ranges::stable_sort(formats, {}, &ArchiveFormat::order);
  for (const ArchiveFormat* format : formats)
    if (format->mine(path, beginning)) return format->open(path);
  refuse_archive(path.string(), "is no archive of layer images", "these are read: " + names_of_formats());
}

std::vector<std::string> left_out(const ArchiveFormat& format, const Job& job) {
  std::vector<std::string> words;
  for (const PartWords& part : parts)
    if ((format.holds & part.part) == 0 && part.stated(job)) words.push_back(part.words);
  return words;
}

}  // namespace gonio::print
