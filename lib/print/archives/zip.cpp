// A plain zip of layers as PNG files, 1.png, 2.png, ..., with preview.png and preview_cropping.png, and
// manifest.uvtools that states the display and the layers' thickness in XML: after UVtools, GenericZIPFile.cs, which
// Phrozen's printers read too. Lengths are millimetres.
//
// Read: any zip whose pictures' names end in a number, from 0 or from 1 on; where there is a manifest, what it says.
#include <algorithm>

#include "base/lower_case.h"
#include "print/archive_checks.h"
#include "print/archive_pictures.h"
#include "print/png_archive.h"

namespace gonio::print::archives {
const ArchiveFormat& zip();

namespace {

constexpr const char* manifest_file = "manifest.uvtools";
constexpr std::uint64_t most_manifest_bytes = 1 << 20;

bool begins_as_any_zip(const std::filesystem::path& path, std::string_view beginning) {
  return io::begins_as_zip(beginning) || (lower_case(path.extension().string()) == ".zip" && !beginning.empty());
}

// Text of the first element of that name, which has no elements within and no attributes: all that the manifest has.
std::optional<double> element(std::string_view xml, const std::string& name, const std::string& place) {
  const std::string opening = "<" + name + ">", closing = "</" + name + ">";
  const std::size_t at = xml.find(opening);
  if (at == std::string_view::npos) return {};
  const std::size_t from = at + opening.size(), end = xml.find(closing, from);
  if (end == std::string_view::npos) refuse_archive(place, "does not close its " + name, "write or copy it again");
  return archive_number(trimmed(xml.substr(from, end - from)), name, place);
}

void read_manifest(const std::string& xml, const std::string& place, std::size_t layers, Job& job) {
  const auto number = [&](const char* name) {
    const auto value = element(xml, name, place);
    return value && *value > 0 ? value : std::nullopt;  // 0 where the writer did not know
  };
  const auto width = number("ResolutionX"), height = number("ResolutionY");
  if (width && height) {
    check_pixels(static_cast<std::int64_t>(std::min(*width, 1e6)), static_cast<std::int64_t>(std::min(*height, 1e6)),
                 place);
    job.width_px = static_cast<int>(*width), job.height_px = static_cast<int>(*height);
    const auto across = number("DisplayWidth"), along = number("DisplayHeight");
    if (across && along) job.pixel_m = Vec2{*across * 1e-3 / *width, *along * 1e-3 / *height};
  }
  if (const auto layer = number("LayerHeight")) {
    job.layer_m = *layer * 1e-3;
    job.tops_m = even_tops(layers, *job.layer_m, *job.layer_m);
  }
}

std::unique_ptr<ArchiveReader> open_zip(const std::filesystem::path& path) {
  auto archive = std::make_unique<io::ZipReader>(path);
  std::vector<std::string> names = names_of(*archive);
  for (std::string& name : names)
    if (name.find("preview") != std::string::npos || name.find("thumbnail") != std::string::npos) name.clear();
  std::vector<std::size_t> layers = numbered_pictures(names, path.string());
  Job job;
  if (const std::size_t manifest = archive->find(manifest_file); manifest < archive->entries().size())
    read_manifest(archive->read(manifest, most_manifest_bytes), archive->place(manifest), layers.size(), job);
  read_previews(*archive, "preview", job);
  return std::make_unique<PngZipReader>(std::move(archive), std::move(layers), std::move(job));
}

void close_zip(io::ZipWriter& archive, const Job& job) {
  const char* names[] = {"preview.png", "preview_cropping.png"};
  for (std::size_t i = 0; i < job.previews.size(); ++i) archive.add(names[i], png_of_preview(job.previews[i]));
  const Vec2 pixel_m = job.pixel_m.value_or(Vec2{});
  const auto line = [](const char* name, const std::string& value) {
    return std::string("  <") + name + ">" + value + "</" + name + ">\n";
  };
  archive.add(manifest_file, "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Manifest>\n" + line("CreatedBy", "gonio") +
                                 line("UpdatedBy", "gonio") + line("LayerHeight", archive_text(*job.layer_m * 1e3)) +
                                 line("ResolutionX", std::to_string(job.width_px)) +
                                 line("ResolutionY", std::to_string(job.height_px)) +
                                 line("DisplayWidth", archive_text(pixel_m.x * job.width_px * 1e3)) +
                                 line("DisplayHeight", archive_text(pixel_m.y * job.height_px * 1e3)) +
                                 line("MachineZ", "0") + "</Manifest>\n");
}

std::unique_ptr<ArchiveWriter> begin_zip(const std::filesystem::path& path, const Job& job) {
  if (job.previews.size() > 2)
    refuse_archive(path.string(), "would have " + std::to_string(job.previews.size()) + " previews",
                   "such a zip has two at most");
  return std::make_unique<PngZipWriter>(zip(), path, job, PngZipWriter::Naming{.digits = 1, .first = 1}, close_zip);
}

}  // namespace

const ArchiveFormat& zip() {
  static const ArchiveFormat format{
      .name = "zip",
      .sentence = ".zip, numbered PNG files with the display's size and the layers' one thickness",
      .extensions = {".zip"},
      .holds = job_pixel_size | job_layers | job_previews,
      .mine = begins_as_any_zip,
      .open = open_zip,
      .begin = begin_zip,
      .encode = png_of_layer,
      .order = 100};
  return format;
}

}  // namespace gonio::print::archives
