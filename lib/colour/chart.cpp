// See chart.h.
#include "colour/chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "manifest/fields.h"
#include "optics/spectrum.h"

namespace gonio::colour {
namespace {

using manifest::Field, manifest::field;
using optics::Lab;

struct Edition {
  const char* name;
  std::array<Lab, 24> lab;
};
constexpr std::array<const char*, 24> classic_names = {
    "dark skin", "light skin",    "blue sky",     "foliage",   "blue flower",  "bluish green",
    "orange",    "purplish blue", "moderate red", "purple",    "yellow green", "orange yellow",
    "blue",      "green",         "red",          "yellow",    "magenta",      "cyan",
    "white",     "neutral 8",     "neutral 6.5",  "neutral 5", "neutral 3.5",  "black"};
// X-Rite, "New color specifications for ColorChecker SG and Classic charts", 2016: L*a*b*, D50, 2 degrees, M0.
constexpr std::array<Edition, 2> editions = {{
    {"after-2014", {{{37.54, 14.37, 14.92},  {64.66, 19.27, 17.5},    {49.32, -3.82, -22.54}, {43.46, -12.74, 22.72},
                     {54.94, 9.61, -24.79},  {70.48, -32.26, -0.37},  {62.73, 35.83, 56.5},   {39.43, 10.75, -45.17},
                     {50.57, 48.64, 16.67},  {30.1, 22.54, -20.87},   {71.77, -24.13, 58.19}, {71.51, 18.24, 67.37},
                     {28.37, 15.42, -49.8},  {54.38, -39.72, 32.27},  {42.43, 51.05, 28.62},  {81.8, 2.67, 80.41},
                     {50.63, 51.28, -14.12}, {49.57, -29.71, -28.32}, {95.19, -1.03, 2.93},   {81.29, -0.57, 0.44},
                     {66.89, -0.75, -0.06},  {50.76, -0.13, 0.14},    {35.63, -0.46, -0.48},  {20.64, 0.07, -0.46}}}},
    {"before-2014",
     {{{37.986, 13.555, 14.059},  {65.711, 18.13, 17.81},     {49.927, -4.88, -21.905},  {43.139, -13.095, 21.905},
       {55.112, 8.844, -25.399},  {70.719, -33.397, -0.199},  {62.661, 36.067, 57.096},  {40.02, 10.41, -45.964},
       {51.124, 48.239, 16.248},  {30.325, 22.976, -21.587},  {72.532, -23.709, 57.255}, {71.941, 19.363, 67.857},
       {28.778, 14.179, -50.297}, {55.261, -38.342, 31.37},   {42.101, 53.378, 28.19},   {81.733, 4.039, 79.819},
       {51.935, 49.986, -14.574}, {51.038, -28.631, -28.638}, {96.539, -0.425, 1.186},   {81.257, -0.638, -0.335},
       {66.766, -0.734, -0.504},  {50.867, -0.153, -0.27},    {35.656, -0.421, -1.231},  {20.461, -0.079, -0.973}}}},
}};

// What a chart's file says.
struct PatchRecord {
  std::string name;
  std::vector<double> lab, xyz, reflectance, centre, size;
};
struct ChartRecord {
  std::string name, edition;
  std::vector<int> grid;
  std::optional<double> patch_share, aspect;
  std::vector<double> white, wavelengths_nm;
  std::vector<manifest::Value> patches;
};

const std::vector<Field<PatchRecord>>& patch_record_fields() {
  static const std::vector<Field<PatchRecord>> table{
      field("name", &PatchRecord::name, "", "of the patch").needed(),
      field("lab", &PatchRecord::lab, "", "L*, a*, b*").range(-200, 200),
      field("xyz", &PatchRecord::xyz, "", "X, Y, Z over the perfect diffuser's Y").range(0, 2),
      field("reflectance", &PatchRecord::reflectance, "", "one number a wavelength").range(0, 2),
      field("centre", &PatchRecord::centre, "", "[u, v]").range(0, 1),
      field("size", &PatchRecord::size, "", "[du, dv]").range(1e-4, 1)};
  return table;
}
const std::vector<Field<ChartRecord>>& chart_record_fields() {
  static const std::vector<Field<ChartRecord>> table{
      field("name", &ChartRecord::name, "", "of the chart").needed(),
      field("edition", &ChartRecord::edition, "", "of its reference values"),
      field("grid", &ChartRecord::grid, "", "[columns, rows]").range(2, 100),
      field("patch_share", &ChartRecord::patch_share, "", "width of a patch over the distance of centres")
          .range(0.3, 1),
      field("aspect", &ChartRecord::aspect, "", "height over width").range(0.02, 50),
      field("white", &ChartRecord::white, "", "[X, Y, Z]").range(1e-3, 10),
      field("wavelengths_nm", &ChartRecord::wavelengths_nm, "nm", "of reflectances").range(200, 2500),
      field("patches", &ChartRecord::patches, "", "row by row").needed()};
  return table;
}

void needs(std::size_t count, std::size_t wanted, const std::string& at, const std::string& remedy) {
  if (count != wanted) throw Error(Exit::data, at, format("has %zu numbers, needs %zu", count, wanted), remedy);
}

// Places of the patches of a grid; square patches where `aspect` is not stated.
void lay_out(Chart& chart, double share, std::optional<double> aspect) {
  const double across = chart.columns - 1 + share, down = chart.rows - 1 + share;
  chart.height_over_width = aspect.value_or(down / across);
  for (std::size_t i = 0; i < chart.patches.size(); ++i) {
    const auto column = static_cast<double>(i % static_cast<std::size_t>(chart.columns));
    const auto row = static_cast<double>(i / static_cast<std::size_t>(chart.columns));
    chart.patches[i].centre = {(column + share / 2) / across, (row + share / 2) / down};
    chart.patches[i].size = {share / across, share / down};
  }
}

void set_lab(Patch& patch, Lab lab) {
  patch.lab = lab;
  patch.xyz = optics::xyz_from_lab(lab, optics::white_d50);
  patch.neutral = std::hypot(lab.y, lab.z) < 6;
}

class Reader {
 public:
  Reader(const ChartRecord& record, std::string place, const std::function<double(double)>& light)
      : record_(record), place_(std::move(place)), light_(light) {
    if (!record.white.empty()) {
      needs(record.white.size(), 3, place_ + "/white", "give X, Y, Z");
      white_ = {record.white[0], record.white[1], record.white[2]};
    }
  }
  Patch patch(const manifest::Value& value, const std::string& at) {
    const auto r = manifest::read_record(value, patch_record_fields(), at);
    Patch patch;
    patch.name = r.name;
    if (!r.lab.empty() + !r.xyz.empty() + !r.reflectance.empty() != 1)
      throw Error(Exit::data, at, "needs exactly one of \"lab\", \"xyz\", \"reflectance\"");
    if (!r.reflectance.empty()) {
      lit_ = true;
      patch.reflectance = reflectance_of(r.reflectance, at + "/reflectance");
    }
    const optics::Xyz xyz = r.reflectance.empty() ? tristimulus(r, at) : optics::xyz_of(patch.reflectance, light_);
    const optics::Xyz white = r.reflectance.empty() ? white_ : optics::xyz_of([](double) { return 1.0; }, light_);
    set_lab(patch, optics::lab_from_xyz(optics::bradford(white, optics::white_d50) * xyz, optics::white_d50));
    if (record_.grid.empty()) {
      needs(r.centre.size(), 2, at + "/centre", "without a grid give [u, v]");
      needs(r.size.size(), 2, at + "/size", "without a grid give [du, dv]");
      patch.centre = {r.centre[0], r.centre[1]}, patch.size = {r.size[0], r.size[1]};
    } else if (!r.centre.empty() || !r.size.empty()) {
      throw Error(Exit::data, at, "has a place of its own beside \"grid\"", "take one of them out");
    }
    return patch;
  }
  bool lit() const { return lit_; }

 private:
  optics::Xyz tristimulus(const PatchRecord& r, const std::string& at) const {
    if (!r.lab.empty()) {
      needs(r.lab.size(), 3, at + "/lab", "give L*, a*, b*");
      return optics::xyz_from_lab({r.lab[0], r.lab[1], r.lab[2]}, white_);
    }
    needs(r.xyz.size(), 3, at + "/xyz", "give X, Y, Z");
    return {r.xyz[0], r.xyz[1], r.xyz[2]};
  }
  std::function<double(double)> reflectance_of(const std::vector<double>& reflectance, const std::string& at) const {
    const auto& nm = record_.wavelengths_nm;
    needs(reflectance.size(), nm.size(), at, "one number for each of \"wavelengths_nm\"");
    if (nm.front() > 400 || nm.back() < 700)
      throw Error(Exit::data, place_ + "/wavelengths_nm", format("cover %g to %g nm", nm.front(), nm.back()),
                  "400 to 700 nm are needed");
    std::vector<double> metres;
    for (const double w : nm) metres.push_back(w * 1e-9);
    const optics::Spectrum spectrum(metres, reflectance, at);
    return [spectrum](double w) { return spectrum.at(std::clamp(w, spectrum.first_m(), spectrum.last_m())); };
  }
  const ChartRecord& record_;
  std::string place_;
  const std::function<double(double)>& light_;
  optics::Xyz white_ = optics::white_d50;
  bool lit_ = false;
};

}  // namespace

std::vector<std::string> colorchecker_editions() {
  std::vector<std::string> names;
  for (const Edition& edition : editions) names.emplace_back(edition.name);
  return names;
}

Chart colorchecker_classic(const std::string& edition, const std::string& place) {
  const auto found = std::ranges::find(editions, edition, &Edition::name);
  if (found == editions.end())
    throw Error(Exit::usage, place, "is no edition of the ColorChecker: " + edition, "say after-2014 or before-2014");
  Chart chart;
  chart.name = "colorchecker-24", chart.edition = edition, chart.light = "D50";
  chart.columns = 6, chart.rows = 4;
  for (std::size_t i = 0; i < found->lab.size(); ++i) {
    chart.patches.push_back({.name = classic_names[i]});
    set_lab(chart.patches.back(), found->lab[i]);
  }
  lay_out(chart, 0.87, {});
  return chart;
}

Chart parse_chart(const std::string& json, const std::string& place, const std::function<double(double)>& light,
                  const std::string& light_name) {
  const std::string root = place + "#";
  const auto record = manifest::read_record(manifest::parse_json(json, place), chart_record_fields(), root);
  Chart chart;
  chart.name = record.name, chart.edition = record.edition;
  if (!record.grid.empty()) {
    needs(record.grid.size(), 2, root + "/grid", "give [columns, rows]");
    chart.columns = record.grid[0], chart.rows = record.grid[1];
    const auto cells = static_cast<std::size_t>(chart.columns * chart.rows);
    if (record.patches.size() != cells)
      throw Error(Exit::data, root + "/patches", format("are %zu, and the grid has %zu", record.patches.size(), cells),
                  "give one for each cell");
  }
  if (record.patches.size() < 6)
    throw Error(Exit::data, root + "/patches", format("are %zu, 6 or more are needed", record.patches.size()));
  Reader reader(record, root, light);
  for (std::size_t i = 0; i < record.patches.size(); ++i) {
    const std::string at = manifest::item(root + "/patches", i);
    chart.patches.push_back(reader.patch(record.patches[i], at));
    for (std::size_t j = 0; j < i; ++j)
      if (chart.patches[j].name == chart.patches[i].name)
        throw Error(Exit::data, at + "/name", "\"" + chart.patches[i].name + "\" stands twice",
                    "give every patch its own name");
  }
  chart.light = reader.lit() ? light_name : "as stated";
  if (chart.columns > 0)
    lay_out(chart, record.patch_share.value_or(0.85), record.aspect);
  else
    chart.height_over_width = record.aspect.value_or(1);
  return chart;
}

Chart read_chart(const std::filesystem::path& path, const std::function<double(double)>& light,
                 const std::string& light_name) {
  return parse_chart(read_file(path, 1 << 24), path.string(), light, light_name);
}

}  // namespace gonio::colour
