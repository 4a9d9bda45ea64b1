// SL1 and SL1S, the archives of PrusaSlicer: a zip with config.ini for the printer, prusaslicer.ini with all that the
// slicer was told, JOB00000.png, JOB00001.png, ... and thumbnail/thumbnailWxH.png.
//
// After PrusaSlicer, src/libslic3r/Format/SL1.cpp (keys, names, what a reader needs of prusaslicer.ini), and UVtools,
// SL1File.cs. Lengths are millimetres, times seconds, resin millilitres, density g/ml. A display in portrait has its
// pixels and lengths turned against its pictures. Only the lowest layer may differ in thickness, and exposures fall
// from expTimeFirst to expTime over numFade layers.
#include <algorithm>

#include "base/error.h"
#include "base/lower_case.h"
#include "base/text.h"
#include "print/archive_checks.h"
#include "print/archive_pictures.h"
#include "print/png_archive.h"

namespace gonio::print::archives {
const ArchiveFormat& sl1();

namespace {

using Keys = std::map<std::string, std::string>;

constexpr const char* config_file = "config.ini";
constexpr const char* slicer_file = "prusaslicer.ini";
constexpr std::uint64_t most_ini_bytes = 1 << 20;
constexpr std::size_t digits = 5, most_layers = 100000;

bool has_sl1_name(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return extension == ".sl1" || extension == ".sl1s";
}

bool begins_as_sl1(const std::filesystem::path& path, std::string_view beginning) {
  if (!io::begins_as_zip(beginning)) return has_sl1_name(path) && !beginning.empty();
  if (has_sl1_name(path)) return true;
  try {
    return io::ZipReader(path).has(config_file);
  } catch (const Error&) {
    return false;  // whoever takes any zip says what is wrong with it
  }
}

// Takes a key out: what stays is a format's own.
std::optional<std::string> taken(Keys& keys, const std::string& key) {
  const auto found = keys.find(key);
  if (found == keys.end()) return {};
  std::string value = found->second;
  keys.erase(found);
  return value;
}
std::optional<double> taken_number(Keys& keys, const std::string& key, double unit, const std::string& place) {
  const auto text = taken(keys, key);
  if (!text || text->empty()) return {};
  return archive_number(*text, key, place) * unit;
}

void read_config(Keys keys, const std::string& place, std::size_t layers, Job& job) {
  job.name = taken(keys, "jobDir").value_or("");
  if (job.name.find('/') != std::string::npos || job.name.find('\\') != std::string::npos || job.name == "..")
    refuse_archive(place, "states \"" + job.name.substr(0, 60) + "\" as jobDir", "a name belongs there, no path");
  job.printer = taken(keys, "printerModel").value_or("");
  job.resin = taken(keys, "materialName").value_or("");
  job.layer_m = taken_number(keys, "layerHeight", 1e-3, place);
  if (!job.layer_m) refuse_archive(place, "states no layerHeight", "slice it again");
  job.exposure_s = taken_number(keys, "expTime", 1, place);
  job.bottom_exposure_s = taken_number(keys, "expTimeFirst", 1, place);
  if (const auto fade = taken(keys, "numFade"))
    job.bottom_layers = static_cast<int>(archive_count(*fade, "numFade", place));
  job.resin_m3 = taken_number(keys, "usedMaterial", 1e-6, place);
  job.printing_s = taken_number(keys, "printTime", 1, place);
  if (keys.contains("numFast") || keys.contains("numSlow")) {
    std::int64_t stated = 0;
    for (const char* key : {"numFast", "numSlow"})
      if (keys.contains(key)) stated += archive_count(keys[key], key, place);
    if (stated != static_cast<std::int64_t>(layers))
      refuse_archive(place,
                     "counts " + std::to_string(stated) + " layers in numFast and numSlow, and there are " +
                         std::to_string(layers) + " pictures",
                     "copy or slice it again");
  }
  for (auto& [key, value] : keys) job.further["config.ini/" + key] = value;
}

// Of what the slicer was told: the display and the resin's density. The lowest layer's thickness comes back, 0 where it
// is not stated.
double read_slicer(const std::string& text, const std::string& place, Job& job) {
  Keys keys = read_ini(text, place);
  job.further[slicer_file] = text;
  const auto number = [&](const char* key, double unit) { return taken_number(keys, key, unit, place).value_or(0); };
  double width = number("display_pixels_x", 1), height = number("display_pixels_y", 1),
         width_m = number("display_width", 1e-3), height_m = number("display_height", 1e-3);
  if (taken(keys, "display_orientation").value_or("landscape") == "portrait")
    std::swap(width, height), std::swap(width_m, height_m);
  if (width != 0 || height != 0) {
    if (!(width >= 1 && width <= 1e6 && height >= 1 && height <= 1e6))
      refuse_archive(place, "states a display of " + archive_text(width) + " x " + archive_text(height) + " pixels",
                     "slice it again");
    job.width_px = static_cast<int>(width), job.height_px = static_cast<int>(height);
    if (width_m != 0 && height_m != 0) job.pixel_m = Vec2{width_m / width, height_m / height};
  }
  const auto flag = [&](const char* key, std::optional<bool>& to) {
    if (keys.contains(key)) to = number(key, 1) != 0;
  };
  flag("display_mirror_x", job.mirror_x), flag("display_mirror_y", job.mirror_y);
  if (const double density = number("material_density", 1e3); density != 0) job.resin_kg_per_m3 = density;
  return number("initial_layer_height", 1e-3);
}

// The pictures' names by their last five digits; other entries lose theirs.
std::vector<std::string> numbers_of(const io::ZipReader& zip) {
  std::vector<std::string> names = names_of(zip);
  for (std::string& name : names) {
    const std::size_t tail = digits + 4;
    const bool layer = name.size() >= tail && name.find('/') == std::string::npos && name.ends_with(".png") &&
                       name.find_first_not_of("0123456789", name.size() - tail) == name.size() - 4;
    name = layer ? name.substr(name.size() - tail) : std::string();
  }
  return names;
}

std::unique_ptr<ArchiveReader> open_sl1(const std::filesystem::path& path) {
  auto zip = std::make_unique<io::ZipReader>(path);
  const std::string place = path.string();
  const std::size_t config = zip->find(config_file), slicer = zip->find(slicer_file);
  if (config == zip->entries().size())
    refuse_archive(place, "has no config.ini in it", "an SL1 archive has one: slice or copy it again");
  std::vector<std::size_t> layers = numbered_pictures(numbers_of(*zip), place);
  Job job;
  read_config(read_ini(zip->read(config, most_ini_bytes), zip->place(config)), zip->place(config), layers.size(), job);
  double first_m = 0;
  if (slicer < zip->entries().size()) first_m = read_slicer(zip->read(slicer, most_ini_bytes), zip->place(slicer), job);
  check_pixels(std::max(1, job.width_px), std::max(1, job.height_px), place);
  job.tops_m = even_tops(layers.size(), first_m > 0 ? first_m : *job.layer_m, *job.layer_m);
  read_previews(*zip, "thumbnail/", job);
  return std::make_unique<PngZipReader>(std::move(zip), std::move(layers), std::move(job));
}

std::string config_text(const Job& job) {
  const std::string layers = std::to_string(job.tops_m.size());
  Keys keys{{"action", "print"},
            {"expUserProfile", "0"},
            {"fileCreationTimestamp", "1980-01-01 at 00:00:00 UTC"},
            {"hollow", "0"},
            {"numFast", layers},
            {"numSlow", "0"},
            {"printProfile", "gonio"},
            {"printerProfile", "gonio"},
            {"printerVariant", "default"},
            {"prusaSlicerVersion", "PrusaSlicer-2.5.0"}};
  Keys own;
  for (const auto& [key, value] : job.further)
    if (key.starts_with("config.ini/")) own[key.substr(11)] = value;
  const auto count = [&](const char* key) { return own.contains(key) ? archive_count(own[key], key, config_file) : 0; };
  if (count("numFast") + count("numSlow") != static_cast<std::int64_t>(job.tops_m.size()))
    own.erase("numFast"), own.erase("numSlow");
  for (const auto& [key, value] : own) keys[key] = value;
  keys["jobDir"] = job.name;
  keys["layerHeight"] = archive_text(*job.layer_m * 1e3);
  keys["expTime"] = archive_text(*job.exposure_s);
  keys["expTimeFirst"] = archive_text(job.bottom_exposure_s.value_or(*job.exposure_s));
  keys["numFade"] = std::to_string(job.bottom_layers.value_or(0));
  keys["materialName"] = job.resin;
  keys["printerModel"] = job.printer;
  keys["usedMaterial"] = archive_text(job.resin_m3.value_or(0) * 1e6);
  keys["printTime"] = archive_text(job.printing_s.value_or(0));
  std::string text;
  for (const auto& [key, value] : keys) text += key + " = " + value + "\n";
  return text;
}

// What of the job the slicer's settings repeat.
Keys slicer_keys(const Job& job, bool portrait) {
  const std::size_t x = portrait ? 1 : 0, y = 1 - x;
  const std::array<std::string, 2> pixels{std::to_string(job.width_px), std::to_string(job.height_px)},
      sides{archive_text(job.pixel_m->x * job.width_px * 1e3), archive_text(job.pixel_m->y * job.height_px * 1e3)};
  Keys keys{{"display_pixels_x", pixels[x]},
            {"display_pixels_y", pixels[y]},
            {"display_width", sides[x]},
            {"display_height", sides[y]},
            {"layer_height", archive_text(*job.layer_m * 1e3)},
            {"initial_layer_height", archive_text(job.tops_m[0] * 1e3)},
            {"exposure_time", archive_text(*job.exposure_s)},
            {"initial_exposure_time", archive_text(job.bottom_exposure_s.value_or(*job.exposure_s))},
            {"faded_layers", std::to_string(job.bottom_layers.value_or(0))}};
  if (job.mirror_x) keys["display_mirror_x"] = *job.mirror_x ? "1" : "0";
  if (job.mirror_y) keys["display_mirror_y"] = *job.mirror_y ? "1" : "0";
  if (job.resin_kg_per_m3) keys["material_density"] = archive_text(*job.resin_kg_per_m3 * 1e-3);
  return keys;
}

// The settings that came with the job, with what the job says put in.
std::string with_keys(std::string_view given, Keys keys) {
  std::string text;
  while (!given.empty()) {
    const std::size_t end = std::min(given.find('\n'), given.size());
    const std::string_view line = given.substr(0, end), key = trimmed(line.substr(0, line.find('=')));
    const auto own = keys.find(std::string(key));
    if (own == keys.end() || line.find('=') == std::string_view::npos)
      text += std::string(line);
    else
      text += own->first + " = " + own->second, keys.erase(own);
    given.remove_prefix(std::min(end + 1, given.size()));
    text += '\n';
  }
  for (const auto& [key, value] : keys) text += key + " = " + value + "\n";
  return text;
}

std::string slicer_text(const Job& job) {
  const auto given = job.further.find(slicer_file);
  if (given != job.further.end()) {
    Keys before = read_ini(given->second, slicer_file);
    return with_keys(given->second, slicer_keys(job, before["display_orientation"] == "portrait"));
  }
  Keys keys = slicer_keys(job, false);
  keys["display_orientation"] = "landscape";
  keys.try_emplace("display_mirror_x", "0");
  keys.try_emplace("display_mirror_y", "0");
  keys["gamma_correction"] = "1";
  keys["printer_model"] = job.printer;
  keys["printer_technology"] = "SLA";
  keys["sla_material_settings_id"] = job.resin;
  std::string text;
  for (const auto& [key, value] : keys) text += key + " = " + value + "\n";
  return text;
}

void close_sl1(io::ZipWriter& zip, const Job& job) {
  zip.add(config_file, config_text(job));
  zip.add(slicer_file, slicer_text(job));
  for (const JobPreview& preview : job.previews)
    zip.add(format("thumbnail/thumbnail%dx%d.png", preview.width_px, preview.height_px), png_of_preview(preview));
}

std::unique_ptr<ArchiveWriter> begin_sl1(const std::filesystem::path& path, const Job& asked) {
  Job job = asked;
  const std::string place = path.string();
  if (job.name.empty()) job.name = path.stem().string();
  job.name = file_stem(job.name);
  if (job.printer.empty()) job.printer = lower_case(path.extension().string()) == ".sl1s" ? "SL1S" : "SL1";
  if (!job.exposure_s) refuse_archive(place, "would have no exposure", "SL1 needs one: state the exposure of a layer");
  if (!job.pixel_m) refuse_archive(place, "would have no size of pixels", "SL1 needs it: state the size of a pixel");
  for (const std::string* word : {&job.printer, &job.resin})
    if (word->find('\n') != std::string::npos) refuse_archive(place, "has a name of two lines", "one line is a name");
  for (std::size_t i = 0; i < job.previews.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (job.previews[i].width_px == job.previews[j].width_px &&
          job.previews[i].height_px == job.previews[j].height_px)
        refuse_archive(place, "has two previews of one size", "SL1 tells them apart by their size");
  PngZipWriter::Naming naming{.prefix = job.name, .digits = digits, .first = 0, .most = most_layers};
  return std::make_unique<PngZipWriter>(sl1(), path, job, std::move(naming), close_sl1);
}

}  // namespace

const ArchiveFormat& sl1() {
  static const ArchiveFormat format{
      .name = "SL1",
      .sentence =
          ".sl1 and .sl1s, of Prusa's printers and whatever reads them: all but the lift; layers of one "
          "thickness, the lowest its own",
      .extensions = {".sl1", ".sl1s"},
      .holds = job_pixel_size | job_layers | job_mirror | job_exposure | job_name | job_printer | job_resin_name |
               job_resin_density | job_resin_volume | job_time | job_previews,
      .mine = begins_as_sl1,
      .open = open_sl1,
      .begin = begin_sl1,
      .encode = png_of_layer,
      .order = 10};
  return format;
}

}  // namespace gonio::print::archives
