// What a call of dlp-slice works on; each step is a file of its own. Private to this folder.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/program.h"
#include "manifest/sections/print.h"
#include "print/archive.h"
#include "print/calibration_sample.h"
#include "print/compensation.h"
#include "print/design.h"
#include "print/prediction.h"
#include "print/slicer.h"
#include "report/mesh_view.h"
#include "tools/dlp-slice/options.h"

namespace gonio::tools::dlp_slice {

struct Section {  // a layer, or a cut through all, as grey values; rows from the top
  std::string title;
  int width = 0, height = 0;
  std::vector<std::uint8_t> greys;
};
struct Totals {
  std::size_t layers = 0;
  double solid_m3 = 0, structured_m2 = 0, unreached_m3 = 0, excess = 0, time_s = 0;
  print::Misfit before, after;
};

struct Work {
  explicit Work(cli::Invocation& asked) : call(asked) {}
  cli::Invocation& call;
  print::Printer printer;
  std::vector<print::SlicedBody> bodies;
  std::vector<io::TriangleMesh> meshes;  // as they are entered: metres, not yet set down
  std::optional<print::CalibrationSample> sample;
  std::filesystem::path archive;
  Totals totals;
  std::vector<Section> sections;
  std::optional<print::CuredSurface> predicted;
  std::optional<print::GrowthFit> growth;
  std::optional<print::Design> design;
  std::vector<std::string> notes;  // for the page
  manifest::Print& entry() { return call.document.prints.at(printer.name); }
};

void open_printer(Work& work);  // printer.cpp: --printer, --print, --layer, --layers
print::Job job_of(Work& work);  // what the process says of the job
double time_of(const Work& work, std::size_t layers);

void open_bodies(Work& work);   // bodies.cpp: meshes, their places and structures
void enter_bodies(Work& work);  // writes them
std::vector<print::JobPreview> previews_of(const Work& work);
// A mesh as reports show it: from the upper left, z up.
report::MeshView view_of(std::string name, std::span<const Vec3> positions_m,
                         std::vector<std::array<std::uint32_t, 3>> triangles);
report::MeshView view_of(const Work& work);  // all that stands on the platform

// send.cpp: layers into the archive.
void send_bodies(Work& work);
void send_sample(Work& work);

void predict(Work& work);           // predict.cpp: from the archive
void check_prediction(Work& work);  // what can be wrong with it, before anything is written
std::optional<print::GroundAt> ground_asked(Work& work);

void fit_growth(Work& work);   // growth.cpp
bool fulfil_wish(Work& work);  // wish.cpp; false: beyond reach, and the nearest was taken

std::string page(const Work& work);  // page.cpp

}  // namespace gonio::tools::dlp_slice
